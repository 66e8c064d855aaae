//! Lines, points and words drawn over a finished picture: what was computed, in its place in space.
//!
//! ```text
//!   add_axes, add_box, add_camera, add_contact, add_sample ─► Overlay ─► draw: Picture, Camera
//!   draw_panel, draw_banner: words on an image, in a corner or across it
//! ```
//!
//! What lies behind the picture's surfaces is drawn faintly, so that one sees what is in front. Points are in the world, in
//! metres; colours are red, green, blue.

mod camera;
mod contact;
mod dot;
mod frame;
mod line;
mod panel;
mod pen;
mod text;

pub use panel::{Corner, Severity, draw_banner, draw_panel};

use crate::picture::Picture;
use nalgebra::Point3;
use ode_visual_hull::camera::Camera;
use pen::Pen;

/// Opacity of what lies behind a surface of the picture.
const HIDDEN: f32 = 0.25;

/// Lines, points and labels in the world.
#[derive(Debug, Clone, Default)]
pub struct Overlay {
    lines: Vec<Line>,
    points: Vec<Dot>,
    labels: Vec<Label>,
}

/// A straight line.
#[derive(Debug, Clone, Copy)]
struct Line {
    ends: [Point3<f64>; 2],
    /// As a multiple of the width of plain lines.
    width: f64,
    ink: Ink,
}

/// A point, drawn as a disc.
#[derive(Debug, Clone, Copy)]
struct Dot {
    at: Point3<f64>,
    /// In widths of a plain line.
    radius: f64,
    /// The largest radius, in metres.
    most: f64,
    ink: Ink,
}

/// Words beside a point.
#[derive(Debug, Clone)]
struct Label {
    at: Point3<f64>,
    text: String,
    ink: Ink,
}

/// How something is drawn.
#[derive(Debug, Clone, Copy)]
struct Ink {
    colour: [u8; 3],
    /// Opacity behind a surface.
    hidden: f32,
}

impl Ink {
    /// An ink that is faint behind a surface.
    fn new(colour: [u8; 3]) -> Self {
        Self { colour, hidden: HIDDEN }
    }
}

impl Overlay {
    /// An overlay that shows nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a straight line.
    pub fn add_line(&mut self, from: Point3<f64>, to: Point3<f64>, colour: [u8; 3]) {
        self.lines.push(Line { ends: [from, to], width: 1.0, ink: Ink::new(colour) });
    }

    /// Adds a point, drawn as a small disc.
    pub fn add_point(&mut self, at: Point3<f64>, colour: [u8; 3]) {
        self.points.push(Dot { at, radius: 2.0, most: f64::INFINITY, ink: Ink::new(colour) });
    }

    /// Adds words to the right of a point. Letters beyond ISO 8859-1 become question marks.
    pub fn add_label(&mut self, at: Point3<f64>, text: impl Into<String>, colour: [u8; 3]) {
        self.labels.push(Label { at, text: text.into(), ink: Ink::new(colour) });
    }

    /// Draws lines, then points, then labels over `picture`, which was drawn from `viewpoint` and has its size. Its contents and
    /// depths remain.
    pub fn draw(&self, picture: &mut Picture, viewpoint: &Camera) {
        let mut pen = Pen::new(picture);
        for line in &self.lines {
            line.draw(&mut pen, viewpoint);
        }
        for point in &self.points {
            point.draw(&mut pen, viewpoint);
        }
        for label in &self.labels {
            label.draw(&mut pen, viewpoint);
        }
    }
}

#[cfg(test)]
mod tests;
