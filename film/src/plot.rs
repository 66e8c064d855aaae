//! A plot of the bodies' heights over time, as SVG.

use crate::log::Log;
use ode_visual_hull::{Error, Result};
use plotters::prelude::*;
use std::path::Path;

/// Writes the plot of a log to a file. The subject moves from `still_until` on, in seconds.
pub(crate) fn write(path: &Path, log: &Log, still_until: f64) -> Result<()> {
    draw(path, log, still_until)
        .map_err(|e| Error::file(path, format!("expected to write the plot, found: {e}")))
}

fn draw(path: &Path, log: &Log, still_until: f64) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let end = log.entries.last().map_or(1.0, |entry| entry.time);
    let heights = log.entries.iter().flat_map(|entry| &entry.states).map(|state| state.pose.translation.z);
    let top = heights.fold(0.0, f64::max);
    let area = SVGBackend::new(path, (800, 450)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(16)
        .x_label_area_size(42)
        .y_label_area_size(56)
        .build_cartesian_2d(0.0..end, 0.0..1.08 * top)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc("time (s)")
        .y_desc("height of the centre (m)")
        .x_label_formatter(&|x| format!("{x:.1}"))
        .y_label_formatter(&|y| format!("{y:.1}"))
        .draw()?;

    for line in lines(log, still_until, end, top) {
        chart
            .draw_series(LineSeries::new(line.points, line.style))?
            .label(line.name)
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], line.style));
    }

    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::UpperRight)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .draw()?;
    area.present()?;
    Ok(())
}

/// A line of the plot.
struct Line {
    name: String,
    style: ShapeStyle,
    /// Time in seconds and height in metres.
    points: Vec<(f64, f64)>,
}

/// The lines of the bodies, of the subject's top where it is known, and of the time from which it moves.
fn lines(log: &Log, still_until: f64, end: f64, top: f64) -> Vec<Line> {
    let of_body = |(i, (name, [r, g, b])): (usize, &(String, [u8; 3]))| Line {
        name: name.clone(),
        style: on_white(*r, *g, *b).stroke_width(2),
        points: log.entries.iter().map(|entry| (entry.time, entry.states[i].pose.translation.z)).collect(),
    };
    let mut lines: Vec<Line> = log.bodies.iter().enumerate().map(of_body).collect();
    let real: Vec<_> = log.entries.iter().filter_map(|entry| Some((entry.time, entry.real_top?))).collect();
    if !real.is_empty() {
        let name = format!("top of the {}", log.subject);
        lines.push(Line { name, style: BLACK.stroke_width(1), points: real });
    }

    if still_until < end {
        let name = "the subject moves from here on".into();
        let style = RGBColor(150, 150, 150).stroke_width(1);
        lines.push(Line { name, style, points: vec![(still_until, 0.0), (still_until, 1.08 * top)] });
    }

    lines
}

/// A colour that is visible on white: pale ones are darkened.
fn on_white(r: u8, g: u8, b: u8) -> RGBColor {
    let pale = r.min(g).min(b) > 180;
    let dim = |c: u8| if pale { (u16::from(c) * 6 / 10) as u8 } else { c };
    RGBColor(dim(r), dim(g), dim(b))
}
