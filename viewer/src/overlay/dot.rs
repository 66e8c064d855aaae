//! Points and labels in a picture.

use super::line::NEAR;
use super::pen::Pen;
use super::text::Lettering;
use super::{Dot, Label};
use ode_visual_hull::camera::Camera;

impl Dot {
    /// Draws a disc with a soft edge.
    pub(super) fn draw(&self, pen: &mut Pen<'_>, viewpoint: &Camera) {
        let Some(centre) = viewpoint.project(&self.at).filter(|pixel| pixel.depth > NEAR) else { return };
        let most = self.most * viewpoint.intrinsics()[(0, 0)] / centre.depth;
        let (radius, (width, height)) = ((self.radius * pen.width).min(most), pen.size());
        let reach = |middle: f64, size: f64| {
            let (low, high) = ((middle - radius - 1.0).max(0.0), (middle + radius + 1.0).min(size));
            low.floor() as i64..high.ceil() as i64
        };
        for y in reach(centre.v, height) {
            for x in reach(centre.u, width) {
                let distance = (x as f64 + 0.5 - centre.u).hypot(y as f64 + 0.5 - centre.v);
                pen.draw(x, y, centre.depth, radius + 0.5 - distance, self.ink);
            }
        }
    }
}

impl Label {
    /// Writes the words to the right of the point, as a whole faintly where the point lies behind a surface.
    pub(super) fn draw(&self, pen: &mut Pen<'_>, viewpoint: &Camera) {
        let Some(at) = viewpoint.project(&self.at).filter(|pixel| pixel.depth > NEAR) else { return };
        let (width, height) = pen.size();
        if !(0.0..width).contains(&at.u) || !(0.0..height).contains(&at.v) {
            return;
        }
        let lettering = Lettering::for_labels(pen.image.width());
        let (u, v) = (at.u.floor() as i64, at.v.floor() as i64);
        // Words as faint as lines could not be read.
        let opacity = 0.6 + 0.4 * pen.opacity(u, v, at.depth, self.ink);
        let left = u + i64::from(lettering.advance());
        let top = v - i64::from(lettering.height()) / 2;
        let room = (pen.image.width() as i64 - left).max(0) as u32;
        let text = lettering.fit(&self.text, room);
        lettering.write_on_ground(pen.image, (left, top), &text, self.ink.colour, opacity);
    }
}
