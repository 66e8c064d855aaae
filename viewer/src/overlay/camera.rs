//! Real cameras as pyramids over their images.

use super::Overlay;
use ode_visual_hull::camera::Camera;

/// How far the mark at the upper edge of an image rises above it, as a part of the image's height.
const MARK: f64 = 0.12;

impl Overlay {
    /// Adds a real camera: lines from its centre to the corners of its image at a depth of `length` metres, a mark at the image's
    /// upper edge, and its name `label` at the centre.
    pub fn add_camera(&mut self, camera: &Camera, length: f64, colour: [u8; 3], label: &str) {
        let (width, height) = camera.size();
        let (w, h) = (f64::from(width), f64::from(height));
        let at = |u: f64, v: f64| camera.unproject(u, v, length);
        let corners = [at(0.0, 0.0), at(w, 0.0), at(w, h), at(0.0, h)];

        // A corner beyond the lens model has no place.
        for (corner, next) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            if let Some(corner) = corner {
                self.add_line(camera.centre(), *corner, colour);
            }
            if let (Some(corner), Some(next)) = (corner, next) {
                self.add_line(*corner, *next, colour);
            }
        }
        if let [Some(left), Some(right), _, Some(lower)] = corners {
            let top = left + 0.5 * (right - left) + MARK * (left - lower);
            let [from, to] = [0.4, 0.6].map(|part| left + part * (right - left));
            self.add_line(from, top, colour);
            self.add_line(top, to, colour);
        }
        self.add_label(camera.centre(), label, colour);
    }
}
