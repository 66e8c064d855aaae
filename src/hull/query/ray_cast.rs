//! Rays against the hull, as needed by ODE's ray class, by picking and by rendering with occlusion.

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
    /// Unit outward normal of the hull at that point.
    pub normal: Vector3<f64>,
}

impl Hull {
    /// The first interval of `ray` inside the hull: its entry (`None` if the ray starts inside) and its exit. `None` if
    /// the ray misses the hull.
    pub fn ray_cast(&self, ray: &Ray) -> Option<(Option<RayHit>, RayHit)> {
        let mut merge = IntervalMerge::new(self, &ray.origin, &ray.direction, EdgeModel::Coverage)?;
        let entry = merge.entry()?;
        let exit = merge.exit();
        let hit = |crossing: &Crossing| self.hit(ray, crossing);
        Some(((entry.t > 0.0).then(|| hit(&entry)), hit(&exit)))
    }

    fn hit(&self, ray: &Ray, crossing: &Crossing) -> RayHit {
        let at = ray.at(crossing.t);
        let edge = crossing.view.and_then(|view| nearest_edge_in(view, &at));
        let normal = edge.map_or(crossing.face, |edge| self.contact_normal(&edge));
        RayHit { t: crossing.t, normal }
    }
}

/// The edge of a view's silhouette beside `p`, a point on the hull's surface.
fn nearest_edge_in<'a>(view: &'a View, p: &Point3<f64>) -> Option<NearestEdge<'a>> {
    let a = view.project(p)?;
    let (i, j) = floor_pixel(a.u, a.v);
    // A point on the surface projects to an edge pixel or to one beside it.
    let b = view.silhouette().nearest_background(i, j, 2)?;
    Some(NearestEdge { view, a, b })
}
