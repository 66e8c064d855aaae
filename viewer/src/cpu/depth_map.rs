//! How far the hull is from each real camera, at a quarter of the resolution: whether a camera sees a point of it.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::eye::Eye;
use super::lanes::{LANES, Lanes, whole};
use super::march::{March, Packets, Ray};
use crate::scene::SceneView;
use rayon::prelude::*;

/// Pixels of the image along a side of a cell.
pub const CELL: i32 = 4;

/// A point up to this far behind the hull's surface, as a camera sees it, counts as seen, in metres: the hull of few cameras is
/// much larger than the subject. From there on it is seen less and less, and not at all from twice as far.
pub const VISIBILITY_BIAS: f32 = 0.10;

/// The hull's depths in one real camera.
#[derive(Debug)]
pub struct DepthMap {
    /// First column and row, in cells.
    first: [i32; 2],
    columns: i32,
    rows: i32,
    /// Depths along the camera's axis in metres; infinite where the camera does not see the hull.
    depths: Vec<f32>,
}

impl DepthMap {
    /// The depths of the hull `march` in its view number `index`, which is `view`.
    pub fn new(march: &March, view: &SceneView, index: usize) -> Self {
        let rect = view.rect();
        let first = [rect.x0.div_euclid(CELL), rect.y0.div_euclid(CELL)];
        let cells = |from: i32, to: i32| ((to + CELL - 1).div_euclid(CELL) - from).max(0);
        let (columns, rows) = (cells(first[0], rect.x1), cells(first[1], rect.y1));
        let mut depths = vec![f32::INFINITY; columns as usize * rows as usize];
        let eye = Eye::new(view.camera());

        let row = |(y, depths): (usize, &mut [f32])| {
            let mut packets = Packets::default();
            let v = centre(first[1] + y as i32);
            for (x, depths) in (0..).step_by(LANES).zip(depths.chunks_mut(LANES)) {
                let u: [f32; LANES] = std::array::from_fn(|k| centre(first[0] + x + k as i32));
                let rays = u.map(|u| eye.ray(u, v));
                let is_asked =
                    |k: usize| k < depths.len() && march.views()[index].distance(u[k], v) <= CELL as f32;
                let range = |k: usize| if is_asked(k) { 0.0..f32::MAX } else { f32::INFINITY..0.0 };
                let entries = march.entries(&rays, &std::array::from_fn(range), &mut packets);
                for ((depth, ray), entry) in depths.iter_mut().zip(&rays).zip(entries) {
                    *depth = entry.map_or(f32::INFINITY, |entry| depth_of(&eye, ray, entry.t));
                }
            }
        };
        depths.par_chunks_mut(columns.max(1) as usize).enumerate().for_each(row);
        Self { first, columns, rows, depths }
    }

    /// How well the camera sees points at these image positions and depths, 0 to 1.
    #[inline(always)]
    pub fn visibilities(&self, u: &Lanes, v: &Lanes, depth: &Lanes) -> Lanes {
        let cell = |position: f32, first: i32, count: i32| {
            // Within the last cell, so that its number is found whatever the position.
            whole((position / CELL as f32 - first as f32).max(0.0).min(count as f32 - 0.5))
        };
        let mut index = [0; LANES];
        for k in 0..LANES {
            let (x, y) = (cell(u[k], self.first[0], self.columns), cell(v[k], self.first[1], self.rows));
            index[k] = y * self.columns + x;
        }
        let mut surface = [f32::NEG_INFINITY; LANES];
        for k in 0..LANES {
            if let Some(depth) = self.depths.get(index[k] as usize) {
                surface[k] = *depth;
            }
        }
        let mut visibilities = [0.0; LANES];
        for k in 0..LANES {
            visibilities[k] = (2.0 - (depth[k] - surface[k]) / VISIBILITY_BIAS).clamp(0.0, 1.0);
        }
        visibilities
    }
}

/// The image coordinate of the middle of a cell.
fn centre(cell: i32) -> f32 {
    CELL as f32 * (cell as f32 + 0.5)
}

fn depth_of(eye: &Eye, ray: &Ray, t: f32) -> f32 {
    t * eye.depth_per_metre(&ray.direction)
}
