//! What is behind subject and bodies: a floor with a grid and a sky, or the image of a real camera.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::eye::Eye;
use super::lanes::LANES;
use super::march::{MarchView, PacketLines, Ray};
use super::photos::Photos;
use super::shadow::{GroundLight, shaded};
use crate::picture::Colour;
use nalgebra::Point3;

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

/// Pixels next to one another that show floor and sky alone.
pub struct BarePixels {
    /// Their colours.
    pub rgb: [[u8; 3]; LANES],
    /// Metres along the camera's axis.
    pub depth: [f32; LANES],
}

/// The pixels of a picture from `eye` from column `x` on in row `y`, where they show nothing but the floor at height `floor`, on
/// which `light` falls, and the sky.
#[multiversion::multiversion(targets("x86_64+avx2+fma+bmi1+bmi2+popcnt+lzcnt"))]
pub fn bare_pixels(
    eye: &Eye,
    (x, y): (usize, usize),
    floor: Option<f32>,
    light: Option<&GroundLight>,
) -> BarePixels {
    let (directions, forward) = (eye.directions((x, y)), eye.forward());
    let Backdrop { colour, t } =
        seen_along(&eye.origin(), &directions, floor, eye.radians_per_pixel(), light);
    let mut pixels = BarePixels { rgb: [[0; 3]; LANES], depth: t };
    for k in 0..LANES {
        let along = |axis: usize| directions[axis][k] * forward[axis];
        pixels.depth[k] *= along(0) + along(1) + along(2);
        for c in 0..3 {
            pixels.rgb[k][c] = (colour[c][k].clamp(0.0, 255.0) + WHOLE).to_bits() as u8;
        }
    }
    pixels
}

/// What `rays` of one origin see of the floor at height `floor`, on which `light` falls, and of the sky; the rays of
/// neighbouring pixels differ by `spread` radians.
#[multiversion::multiversion(targets("x86_64+avx2+fma+bmi1+bmi2+popcnt+lzcnt"))]
pub fn backdrop(
    rays: &[Ray; LANES],
    floor: Option<f32>,
    spread: f32,
    light: Option<&GroundLight>,
) -> Backdrop {
    let mut directions = [[0.0; LANES]; 3];
    for k in 0..LANES {
        for axis in 0..3 {
            directions[axis][k] = rays[k].direction[axis];
        }
    }
    seen_along(&rays[0].origin, &directions, floor, spread, light)
}

/// [`backdrop`] along rays from `origin` in these unit directions, which are given axis by axis.
#[inline(always)]
fn seen_along(
    origin: &Point3<f32>,
    directions: &[[f32; LANES]; 3],
    floor: Option<f32>,
    spread: f32,
    light: Option<&GroundLight>,
) -> Backdrop {
    let floor = floor.unwrap_or(f32::NAN);
    let (mut t, mut on_floor) = ([0.0; LANES], [[0.0; LANES]; 3]);
    for k in 0..LANES {
        let distance = (floor - origin.z) / directions[2][k];
        let is_met = (distance > 0.0) & (distance < f32::INFINITY);
        t[k] = if is_met { distance } else { f32::INFINITY };
        let distance = if is_met { distance } else { 0.0 };
        for axis in 0..3 {
            on_floor[axis][k] = origin[axis] + directions[axis][k] * distance;
        }
    }
    let mut lit = [1.0; LANES];
    if let Some(light) = light {
        lit = light.at_many(&on_floor);
    }

    let mut colour = [[0.0; LANES]; 3];
    for k in 0..LANES {
        let down = -directions[2][k];
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

/// The colours that `photo`, the image of `view`, has along `rays` from the place of its camera; `None` beside it.
#[multiversion::multiversion(targets("x86_64+avx2+fma+bmi1+bmi2+popcnt+lzcnt"))]
pub fn photo_colours(
    photo: &image::RgbImage,
    view: &MarchView,
    rays: &[Ray; LANES],
) -> [Option<Colour>; LANES] {
    let [u, v, depth] = PacketLines::new(rays, view).images_at(&[1.0; LANES]);
    let colours = Photos::new([photo; LANES]).colours(&u, &v);
    let (width, height) = (photo.width() as f32, photo.height() as f32);
    let is_inside = |k: usize| depth[k] > 0.0 && u[k] >= 0.0 && v[k] >= 0.0 && u[k] < width && v[k] < height;
    std::array::from_fn(|k| is_inside(k).then(|| Colour::from(colours.map(|channel| channel[k]))))
}
