//! What is behind subject and bodies: a floor with a grid and a sky, or the image of a real camera.

use super::blend::sample;
use super::march::Ray;
use crate::picture::Colour;
use nalgebra::Point3;

/// The floor's colour, that of its lines, and that of the sky at the horizon and above.
const FLOOR: Colour = Colour::new(186.0, 188.0, 190.0);
const LINES: Colour = Colour::new(158.0, 161.0, 165.0);
const HORIZON: Colour = Colour::new(214.0, 220.0, 226.0);
const ZENITH: Colour = Colour::new(150.0, 168.0, 190.0);

/// Distance of the lines in metres, and half their width.
const SPACING: f32 = 0.5;
const HALF_WIDTH: f32 = 0.008;

/// Distance from the viewpoint at which the floor has half faded into the horizon, in metres.
const FADE: f32 = 12.0;

/// Where `ray` meets the floor at height `floor`: its distance in metres.
pub fn floor_distance(ray: &Ray, floor: f32) -> Option<f32> {
    let t = (floor - ray.origin.z) / ray.direction.z;
    (t > 0.0 && t.is_finite()).then_some(t)
}

/// The colour of the floor at `point`, `distance` metres from the viewpoint, where `light` of the light arrives; a pixel covers
/// `footprint` metres there.
pub fn floor_colour(point: &Point3<f32>, distance: f32, footprint: f32, light: f32) -> Colour {
    let line = line(point.x, footprint).max(line(point.y, footprint));
    let colour = FLOOR.lerp(&LINES, line) * light;
    let faded = distance / FADE;
    colour.lerp(&HORIZON, faded * faded / (1.0 + faded * faded))
}

/// The part of a pixel that a line of the grid covers.
fn line(x: f32, footprint: f32) -> f32 {
    // A conversion to integers is an instruction on every processor, a rounding is not.
    let nearest = (x / SPACING + 0.5_f32.copysign(x)) as i32;
    let to_line = (x - SPACING * nearest as f32).abs();
    let half = 0.5 * footprint;
    let covered = (HALF_WIDTH - to_line + half).clamp(0.0, 2.0 * HALF_WIDTH.min(half));
    covered / footprint.max(1e-6)
}

/// The colour of the sky along `ray`.
pub fn sky_colour(ray: &Ray) -> Colour {
    HORIZON.lerp(&ZENITH, ray.direction.z.abs().sqrt())
}

/// The colour that `photo` has at homogeneous image coordinates `h`; `None` outside it.
pub fn photo_colour(photo: &image::RgbImage, h: &nalgebra::Vector3<f32>) -> Option<Colour> {
    let (u, v) = (h.x / h.z, h.y / h.z);
    let is_inside =
        h.z > 0.0 && u >= 0.0 && v >= 0.0 && u < photo.width() as f32 && v < photo.height() as f32;
    is_inside.then(|| sample(photo, u, v))
}
