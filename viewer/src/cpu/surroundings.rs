//! What is behind subject and bodies: a floor with a grid and a sky, or the image of a real camera.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::blend::sample;
use super::march::{LANES, Ray};
use super::shadow::{GroundLight, shaded};
use crate::picture::Colour;

/// The floor's colour, that of its lines, and that of the sky at the horizon and above.
const FLOOR: [f32; 3] = [186.0, 188.0, 190.0];
const LINES: [f32; 3] = [158.0, 161.0, 165.0];
const HORIZON: [f32; 3] = [214.0, 220.0, 226.0];
const ZENITH: [f32; 3] = [150.0, 168.0, 190.0];

/// Distance of the lines in metres, and half their width.
const SPACING: f32 = 0.5;
const HALF_WIDTH: f32 = 0.008;

/// Distance from the viewpoint at which the floor has half faded into the horizon, in metres.
const FADE: f32 = 12.0;

/// Added to a number and taken away again, it leaves the nearest whole one.
const WHOLE: f32 = 12_582_912.0;

/// Where `ray` meets the floor at height `floor`: its distance in metres.
pub fn floor_distance(ray: &Ray, floor: f32) -> Option<f32> {
    let t = (floor - ray.origin.z) / ray.direction.z;
    (t > 0.0 && t.is_finite()).then_some(t)
}

/// Floor and sky, as a packet of rays sees them.
pub struct Backdrop {
    /// Red, green and blue.
    colour: [[f32; LANES]; 3],
    /// The distance of the floor along each ray in metres; infinite for a ray that does not meet it.
    t: [f32; LANES],
}

impl Backdrop {
    /// What ray number `k` of the packet sees: a colour, and the floor's distance.
    pub fn seen(&self, k: usize) -> (Colour, f32) {
        (Colour::from(self.colour.map(|channel| channel[k])), self.t[k])
    }
}

/// What `rays` see of the floor at height `floor`, on which `light` falls, and of the sky; the rays of neighbouring pixels
/// differ by `spread` radians.
#[multiversion::multiversion(targets("x86_64+avx2+fma+bmi1+bmi2+popcnt+lzcnt"))]
pub fn backdrop(
    rays: &[Ray; LANES],
    floor: Option<f32>,
    spread: f32,
    light: Option<&GroundLight>,
) -> Backdrop {
    let floor = floor.unwrap_or(f32::NAN);
    let (mut t, mut on_floor) = ([0.0; LANES], [[0.0; LANES]; 3]);
    for k in 0..LANES {
        let Ray { origin, direction } = &rays[k];
        let distance = (floor - origin.z) / direction.z;
        let is_met = (distance > 0.0) & (distance < f32::INFINITY);
        t[k] = if is_met { distance } else { f32::INFINITY };
        let distance = if is_met { distance } else { 0.0 };
        on_floor[0][k] = origin.x + direction.x * distance;
        on_floor[1][k] = origin.y + direction.y * distance;
        on_floor[2][k] = origin.z + direction.z * distance;
    }
    let mut lit = [1.0; LANES];
    if let Some(light) = light {
        lit = light.at_many(&on_floor);
    }

    let mut colour = [[0.0; LANES]; 3];
    for k in 0..LANES {
        let down = -rays[k].direction.z;
        let is_floor = (down > 0.0) & (t[k] < f32::INFINITY);
        // A pixel covers more of a floor that is seen at a small angle.
        let footprint = t[k] * spread / down;
        let line = line(on_floor[0][k], footprint).max(line(on_floor[1][k], footprint));
        let faded = t[k] / FADE;
        let haze = faded * faded / (1.0 + faded * faded);
        let height = down.abs().sqrt();
        for c in 0..3 {
            let of_floor = (FLOOR[c] + (LINES[c] - FLOOR[c]) * line) * shaded(lit[k]);
            let of_floor = of_floor + (HORIZON[c] - of_floor) * haze;
            let of_sky = HORIZON[c] + (ZENITH[c] - HORIZON[c]) * height;
            colour[c][k] = if is_floor { of_floor } else { of_sky };
        }
    }
    Backdrop { colour, t }
}

/// The part of a pixel that a line of the grid covers.
#[inline(always)]
fn line(x: f32, footprint: f32) -> f32 {
    let nearest = (x / SPACING + WHOLE) - WHOLE;
    let to_line = (x - SPACING * nearest).abs();
    let half = 0.5 * footprint;
    let covered = (HALF_WIDTH - to_line + half).max(0.0).min(2.0 * HALF_WIDTH.min(half));
    covered / footprint.max(1e-6)
}

/// The colour that `photo` has at homogeneous image coordinates `h`; `None` outside it.
pub fn photo_colour(photo: &image::RgbImage, h: &nalgebra::Vector3<f32>) -> Option<Colour> {
    let (u, v) = (h.x / h.z, h.y / h.z);
    let is_inside =
        h.z > 0.0 && u >= 0.0 && v >= 0.0 && u < photo.width() as f32 && v < photo.height() as f32;
    is_inside.then(|| sample(photo, u, v))
}
