//! Plots of cost over size as SVG, with logarithmic axes.

use plotters::prelude::*;
use std::error::Error;
use std::path::Path;

/// The lines' colours in order, distinguishable with colour blindness too.
const COLOURS: [RGBColor; 4] =
    [RGBColor(0, 90, 181), RGBColor(220, 90, 30), RGBColor(90, 90, 90), RGBColor(120, 60, 150)];

/// A plot of several lines.
pub struct Plot<'a> {
    /// Label of the x axis.
    pub x: &'a str,
    /// Label of the y axis.
    pub y: &'a str,
    /// The sizes and their labels on the x axis.
    pub ticks: Vec<(f64, String)>,
    pub lines: Vec<Line>,
}

/// One candidate's costs at the sizes.
pub struct Line {
    pub name: String,
    pub points: Vec<(f64, f64)>,
}

impl Plot<'_> {
    /// Draws the plot into the SVG file `path`.
    pub fn write(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let area = SVGBackend::new(path, (640, 400)).into_drawing_area();
        area.fill(&WHITE)?;

        let (left, right) = range(self.ticks.iter().map(|(x, _)| *x), 1.15);
        let (low, high) = range(self.lines.iter().flat_map(|line| &line.points).map(|p| p.1), 1.6);
        let sizes = self.ticks.iter().map(|(x, _)| *x).collect();

        let mut chart = ChartBuilder::on(&area)
            .margin(14)
            .x_label_area_size(44)
            .y_label_area_size(64)
            .build_cartesian_2d(
                (left..right).log_scale().with_key_points(sizes),
                (low..high).log_scale().with_key_points(decades(low, high)),
            )?;

        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(self.x)
            .y_desc(self.y)
            .x_label_formatter(&|x| self.tick(*x))
            .y_label_formatter(&|y| y.to_string())
            .label_style(("sans-serif", 14))
            .draw()?;

        for (line, colour) in self.lines.iter().zip(COLOURS) {
            let style = colour.stroke_width(2);

            chart
                .draw_series(LineSeries::new(line.points.clone(), style).point_size(3))?
                .label(&line.name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], style));
        }

        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .label_font(("sans-serif", 14))
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(200, 200, 200))
            .draw()?;
        area.present()?;
        Ok(())
    }

    fn tick(&self, x: f64) -> String {
        self.ticks.iter().find(|(at, _)| *at == x).map(|(_, name)| name.clone()).unwrap_or_default()
    }
}

/// The smallest value divided by `margin`, and the largest multiplied by it.
fn range(values: impl Iterator<Item = f64>, margin: f64) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
    (low / margin, high * margin)
}

/// 1, 2 and 5 times the powers of ten between `low` and `high`, or the powers alone over more than three decades.
fn decades(low: f64, high: f64) -> Vec<f64> {
    let wide = high / low > 1e3;
    let digits: &[f64] = if wide { &[1.0] } else { &[1.0, 2.0, 5.0] };
    let powers = (low.log10().floor() as i32)..=(high.log10().ceil() as i32);
    // Parsed from text, so that 5e-2 is printed as 0.05.
    let values =
        powers.flat_map(|power| digits.iter().filter_map(move |d| format!("{d}e{power}").parse().ok()));
    values.filter(|value| (low..=high).contains(value)).collect()
}
