//! Approximate signed distances of a grid's points from the surface of a hull.
//!
//! The distance of a point from the cone of a silhouette is its distance from the silhouette's edge in the image, in
//! pixels, times the size of a pixel at the point's depth. The hull is the intersection of the cones, so its signed
//! distance is the maximum over the views. It is continuous, so the surface through its zeros has no steps.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::{Hull, Unseen, View};
use ode_visual_hull::silhouette::SignedDistance;
use ode_visual_hull::{Error, Result};

/// Margin around the hull's bounding box, in cells, so that the surface closes.
const MARGIN: f64 = 2.0;

/// Greatest number of grid points, which take a gigabyte.
const MAX_POINTS: f64 = 2.5e8;

/// Signed distances on a grid, in metres, negative inside the hull. The index of x varies fastest.
pub struct SignedField {
    /// First grid point, in the world.
    pub origin: Point3<f64>,
    /// Edge length of a cell, in metres.
    pub cell: f64,
    /// Number of grid points along x, y and z.
    pub counts: [u32; 3],
    pub distances: Vec<f32>,
}

/// A view and the signed distance of each pixel from the edge of its silhouette.
struct Map<'h> {
    view: &'h View,
    /// Size of a pixel at a depth of 1 m, in metres.
    metres_per_pixel_at_one: f64,
    /// In pixels.
    distances: SignedDistance,
}

impl SignedField {
    /// Fills a grid around `hull` with cells of `cell` metres. The grid has no points if the hull is empty.
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
                "--resolution: expected at most {MAX_POINTS:e} grid points in the hull's box, found {:.1e}; take \
                 larger cells than {cell} m, or smaller --bounds",
                counts.product()
            )));
        }

        // Distances in the images are computed once per view, then sampled at each grid point.
        let maps: Vec<Map> = hull.views().iter().filter(|view| view.is_enabled()).map(Map::new).collect();
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

/// Approximate signed distance of `p` from the hull in metres, negative inside, clamped to two cells.
fn distance(hull: &Hull, maps: &[Map], p: &Point3<f64>, cell: f64) -> f64 {
    // The work volume bounds the hull too.
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
        // Further views can only increase the distance, which is clamped.
        if farthest > 2.0 * cell {
            return 2.0 * cell;
        }
    }

    let is_bounded = hull.unseen().decides_inside(seeing, 0, maps.len());
    if is_bounded { farthest.max(-2.0 * cell) } else { 2.0 * cell }
}

impl<'h> Map<'h> {
    fn new(view: &'h View) -> Self {
        let k = view.camera().intrinsics();
        let metres_per_pixel_at_one = 1.0 / k[(0, 0)].max(k[(1, 1)]);
        let silhouette = view.silhouette();
        Self { view, metres_per_pixel_at_one, distances: silhouette.signed_distance(&silhouette.image()) }
    }

    /// Approximate signed distance of `p` from the cone of the silhouette, in metres; `None` where the view does not
    /// see `p`.
    fn distance(&self, p: &Point3<f64>) -> Option<f64> {
        self.view.pixel(p)?;
        let projected = self.view.project(p)?;
        Some(self.distances.sample(projected.u, projected.v) * projected.depth * self.metres_per_pixel_at_one)
    }
}
