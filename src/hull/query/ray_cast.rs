//! Rays against the hull: for ODE's ray class, for picking, and to draw what stands before what.

use super::interval_merge::{Crossing, IntervalMerge};
use super::window_search::NearestEdge;
use crate::camera::{Ray, floor_pixel};
use crate::hull::{EdgeModel, Hull, View};
use nalgebra::{Point3, Vector3};

/// Where a ray crosses the hull's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// Metres along the ray.
    pub t: f64,
    /// Unit outward normal of the hull there.
    pub normal: Vector3<f64>,
}

impl Hull {
    /// The first stretch of `ray` inside the hull: where it enters (`None` where it starts inside) and where it
    /// leaves. `None` where it misses.
    pub fn ray_cast(&self, ray: &Ray) -> Option<(Option<RayHit>, RayHit)> {
        let mut sweep = IntervalMerge::new(self, &ray.origin, &ray.direction, EdgeModel::Coverage)?;
        let entry = sweep.entry()?;
        let exit = sweep.exit();
        let hit = |crossing: &Crossing| self.hit(ray, crossing);
        Some(((entry.t > 0.0).then(|| hit(&entry)), hit(&exit)))
    }

    fn hit(&self, ray: &Ray, crossing: &Crossing) -> RayHit {
        let at = ray.at(crossing.t);
        let edge = crossing.view.and_then(|view| nearest_edge_in(view, &at));
        let normal = edge.map_or(crossing.wall, |edge| self.contact_normal(&edge));
        RayHit { t: crossing.t, normal }
    }
}

/// The edge beside a point on the surface.
fn nearest_edge_in<'a>(view: &'a View, p: &Point3<f64>) -> Option<NearestEdge<'a>> {
    let a = view.project(p)?;
    let (i, j) = floor_pixel(a.u, a.v);
    // A crossing lies in an edge pixel or beside one.
    let b = view.silhouette().nearest_background(i, j, 2)?;
    Some(NearestEdge { view, a, b })
}
