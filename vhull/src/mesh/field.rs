//! A hull as numbers on a grid: about how far inside or outside each point lies.
//!
//! A point's distance from a silhouette's edge in the image, in pixels, times what a pixel covers at the point, tells how
//! far a view lets it lie inside; of all views the least counts. Between grid points that changes evenly, so a surface
//! through its zeros has no steps.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::{Hull, Unseen, View};
use ode_visual_hull::silhouette::SignedDistance;
use ode_visual_hull::{Error, Result};

/// Cells around the hull's box, so that the surface closes.
const MARGIN: f64 = 2.0;

/// The most grid points: a gigabyte.
const MOST: f64 = 2.5e8;

/// Distances on a grid, in metres, negative inside, x fastest.
pub struct SignedField {
    pub origin: Point3<f64>,
    pub cell: f64,
    pub counts: [u32; 3],
    pub distances: Vec<f32>,
}

/// A view and how far each of its pixels lies from the silhouette's edge.
struct Map<'h> {
    view: &'h View,
    metres_per_pixel_at_one: f64,
    distances: SignedDistance,
}

impl SignedField {
    /// The grid around `hull` with cells of `cell` metres; without any points for a hull that is empty.
    ///
    /// # Errors
    /// More than 250 million grid points.
    pub fn of(hull: &Hull, cell: f64) -> Result<Self> {
        if hull.aabb().is_empty() {
            return Ok(Self { origin: Point3::origin(), cell, counts: [0; 3], distances: Vec::new() });
        }
        let aabb = hull.aabb().grown(MARGIN * cell);
        let counts = ((aabb.max - aabb.min) / cell).map(|n| n.ceil() + 1.0);
        if counts.product() > MOST {
            return Err(Error::argument(format!(
                "--resolution: expected at most {MOST:e} grid points in the hull's box, found {:.1e}; take larger \
                 cells than {cell} m, or smaller --bounds",
                counts.product()
            )));
        }
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

/// About how far `p` lies outside the hull, negative inside; never more than a few cells.
fn distance(hull: &Hull, maps: &[Map], p: &Point3<f64>, cell: f64) -> f64 {
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

impl<'h> Map<'h> {
    fn new(view: &'h View) -> Self {
        let k = view.camera().intrinsics();
        let metres_per_pixel_at_one = 1.0 / k[(0, 0)].max(k[(1, 1)]);
        let silhouette = view.silhouette();
        Self { view, metres_per_pixel_at_one, distances: silhouette.signed_distance(&silhouette.image()) }
    }

    /// About how far `p` lies outside the cone of the silhouette, in metres; `None` where the view does not see it.
    fn distance(&self, p: &Point3<f64>) -> Option<f64> {
        self.view.pixel(p)?;
        let at = self.view.project(p)?;
        Some(self.distances.sample(at.u, at.v) * at.depth * self.metres_per_pixel_at_one)
    }
}
