//! Lines in a picture: clipped, with soft edges, and with the depth of each of their pixels.

use super::pen::Pen;
use super::{Ink, Line};
use nalgebra::Point3;
use ode_visual_hull::camera::{Camera, Lens, Pixel};

/// Lines are cut off nearer to the viewpoint than this, in metres.
pub(super) const NEAR: f64 = 0.02;

/// Pieces of a line seen through a lens, where it is not straight.
const PIECES: u32 = 24;

impl Line {
    pub(super) fn draw(&self, pen: &mut Pen<'_>, viewpoint: &Camera) {
        let Some([from, to]) = before_camera(viewpoint, self.ends) else { return };
        let pieces = if *viewpoint.lens() == Lens::none() { 1 } else { PIECES };
        let at = |k: u32| viewpoint.project(&(from + (to - from) * (f64::from(k) / f64::from(pieces))));
        for k in 0..pieces {
            if let (Some(from), Some(to)) = (at(k), at(k + 1)) {
                draw_piece(pen, [from, to], self.width, self.ink);
            }
        }
    }
}

/// The part of a line that is in front of the camera, at least at [`NEAR`].
fn before_camera(camera: &Camera, [from, to]: [Point3<f64>; 2]) -> Option<[Point3<f64>; 2]> {
    let depth = |point: &Point3<f64>| (camera.cam_from_world() * point).z - NEAR;
    let (a, b) = (depth(&from), depth(&to));
    let cut = || from + (to - from) * (a / (a - b));
    match (a >= 0.0, b >= 0.0) {
        (true, true) => Some([from, to]),
        (true, false) => Some([from, cut()]),
        (false, true) => Some([cut(), to]),
        // Points that are not finite end here too.
        (false, false) => None,
    }
}

/// Draws a straight line between two image positions, `width` times as wide as plain ones.
///
/// It is drawn column by column where it is flatter than 45 degrees, otherwise row by row. In each of them it covers some pixels
/// partly; 1 / depth is linear in the image.
fn draw_piece(pen: &mut Pen<'_>, ends: [Pixel; 2], width: f64, ink: Ink) {
    let width = width * pen.width;
    let Some([from, to]) = inside(ends, pen.size(), width) else { return };
    let (du, dv) = (to.u - from.u, to.v - from.v);
    let is_flat = du.abs() >= dv.abs();
    let along_across = |pixel: &Pixel| if is_flat { (pixel.u, pixel.v) } else { (pixel.v, pixel.u) };
    let (start, _) = along_across(&from);
    let (end, _) = along_across(&to);
    let thickness = width * du.hypot(dv) / (end - start).abs().max(1e-9);
    let (first, last) = (start.min(end).floor() as i64, start.max(end).ceil() as i64);

    for column in first..last {
        // Both ends may lie within one column.
        let t = ((column as f64 + 0.5 - start) / (end - start)).clamp(0.0, 1.0);
        let t = if t.is_nan() { 0.0 } else { t };
        let (_, across) = along_across(&between(&from, &to, t));
        let depth = between(&from, &to, t).depth;
        let covered =
            (start.max(end).min(column as f64 + 1.0) - start.min(end).max(column as f64)).clamp(0.0, 1.0);
        let (low, high) = (across - 0.5 * thickness, across + 0.5 * thickness);
        for row in low.floor() as i64..high.ceil() as i64 {
            let part = high.min(row as f64 + 1.0) - low.max(row as f64);
            let (x, y) = if is_flat { (column, row) } else { (row, column) };
            pen.draw(x, y, depth, covered * part, ink);
        }
    }
}

/// The position at a part `t` of the way in the image, with its depth.
fn between(from: &Pixel, to: &Pixel, t: f64) -> Pixel {
    let mix = |a: f64, b: f64| a + t * (b - a);
    Pixel { u: mix(from.u, to.u), v: mix(from.v, to.v), depth: 1.0 / mix(1.0 / from.depth, 1.0 / to.depth) }
}

/// The part of a line inside the picture, with a margin around it (Liang and Barsky); `None` where there is none.
fn inside([from, to]: [Pixel; 2], (width, height): (f64, f64), margin: f64) -> Option<[Pixel; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (start, end, size) in [(from.u, to.u, width), (from.v, to.v, height)] {
        let way = end - start;
        if way == 0.0 && !(-margin..=size + margin).contains(&start) {
            return None;
        }
        // A way of zero gives infinities of opposite signs, or NaN on a border, which `max` and `min` leave out.
        let (a, b) = ((-margin - start) / way, (size + margin - start) / way);
        (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
    }
    let ends = [between(&from, &to, enter), between(&from, &to, leave)];
    (enter <= leave && ends.iter().all(|end| end.u.is_finite() && end.v.is_finite())).then_some(ends)
}
