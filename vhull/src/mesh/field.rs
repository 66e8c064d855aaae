//! The hull as approximate signed distances on a grid.
//!
//! A view's signed distance of a point is that of its image from the silhouette's edge, in pixels, times the size of a
//! pixel at the point. The hull's is the largest of all views. It changes smoothly between grid points, so that a
//! surface through its zeros has no steps.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::{Hull, Unseen, View};
use ode_visual_hull::silhouette::SignedDistance;
use ode_visual_hull::{Error, Result};

/// Cells added around the hull's box, so that the surface closes.
const MARGIN: f64 = 2.0;

/// Limit of grid points: they take a gigabyte.
const MAX_POINTS: f64 = 2.5e8;

/// Distances on a grid, in metres, negative inside, x fastest.
pub struct SignedField {
    pub origin: Point3<f64>,
    pub cell: f64,
    pub counts: [u32; 3],
    pub distances: Vec<f32>,
}

/// A view and the signed distances of its pixels from the silhouette's edge.
struct DistanceMap<'h> {
    view: &'h View,
    /// Size of a pixel at a depth of 1 m, in metres.
    pixel_size_at_one: f64,
    distances: SignedDistance,
}

impl SignedField {
    /// The grid around `hull` with cells of `cell` metres, without points for an empty hull.
    ///
    /// # Errors
    /// More than 250 million grid points.
    pub fn of(hull: &Hull, cell: f64) -> Result<Self> {
        if hull.aabb().is_empty() {
            return Ok(Self { origin: Point3::origin(), cell, counts: [0; 3], distances: Vec::new() });
        }
        let aabb = hull.aabb().grown(MARGIN * cell);
        let counts = ((aabb.max - aabb.min) / cell).map(|n| n.ceil() + 1.0);

        if counts.product() > MAX_POINTS {
            return Err(Error::argument(format!(
                "--resolution: expected at most {MAX_POINTS:e} grid points in the hull's box, found {:.1e}; take larger \
                 cells than {cell} m, or smaller --bounds",
                counts.product()
            )));
        }

        let maps: Vec<DistanceMap> =
            hull.views().iter().filter(|view| view.is_enabled()).map(DistanceMap::new).collect();
        let counts: [u32; 3] = counts.map(|n| n as u32).into();
        let [nx, ny, nz] = counts;
        let mut distances = Vec::with_capacity((nx * ny * nz) as usize);
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let p = aabb.min + Vector3::new(f64::from(i), f64::from(j), f64::from(k)) * cell;
                    distances.push(distance(hull, &maps, &p, cell) as f32);
                }
            }
        }

        Ok(Self { origin: aabb.min, cell, counts, distances })
    }
}

/// Approximate signed distance of `p` from the hull, negative inside, clamped to two cells.
fn distance(hull: &Hull, maps: &[DistanceMap], p: &Point3<f64>, cell: f64) -> f64 {
    let (low, high) = (hull.bounds().min - p, p - hull.bounds().max);
    let mut farthest = low.max().max(high.max());
    let mut seeing = 0;
    for map in maps {
        match map.distance(p) {
            Some(distance) => {
                seeing += 1;
                farthest = farthest.max(distance);
            }
            None if hull.unseen() == Unseen::Outside => return 2.0 * cell,
            None => {}
        }
        if farthest > 2.0 * cell {
            return 2.0 * cell;
        }
    }

    let is_bounded = hull.unseen().decides_inside(seeing, 0, maps.len());
    if is_bounded { farthest.max(-2.0 * cell) } else { 2.0 * cell }
}

impl<'h> DistanceMap<'h> {
    fn new(view: &'h View) -> Self {
        let k = view.camera().intrinsics();
        let pixel_size_at_one = 1.0 / k[(0, 0)].max(k[(1, 1)]);
        let silhouette = view.silhouette();
        Self { view, pixel_size_at_one, distances: silhouette.signed_distance(&silhouette.image()) }
    }

    /// Approximate signed distance of `p` from the cone of the silhouette, in metres; `None` where the view does not see
    /// it.
    fn distance(&self, p: &Point3<f64>) -> Option<f64> {
        self.view.pixel(p)?;
        let pixel = self.view.project(p)?;
        Some(self.distances.sample(pixel.u, pixel.v) * pixel.depth * self.pixel_size_at_one)
    }
}
