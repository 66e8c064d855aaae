//! Rays against the hull, as needed by ODE's ray class, by picking and by rendering with occlusion.

use super::interval_merge::{Crossing, IntervalMerge};
use super::window_search::NearestEdge;
use crate::camera::{Ray, floor_pixel};
use crate::hull::{EdgeModel, Hull, View};
use nalgebra::{Point3, Vector3};

/// The shortest interval inside, as a share of the distance to it: far more than the rounding of a crossing, and at 10 m
/// a hundredth of a nanometre.
const ROUNDING: f64 = 1e-12;

/// Where a ray crosses the hull's surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// Metres along the ray.
    pub t: f64,
    /// Unit outward normal of the hull at that point. Where no silhouette ends the hull but a view's sight does, it is
    /// the ray's direction, or its opposite at an entry.
    pub normal: Vector3<f64>,
}

impl Hull {
    /// The first interval of `ray` inside the hull: its entry (`None` if the ray starts inside) and its exit. `None` if
    /// the ray misses the hull. No view is overruled along a ray.
    pub fn ray_cast(&self, ray: &Ray) -> Option<(Option<RayHit>, RayHit)> {
        let mut merge = IntervalMerge::new(self, None, &ray.origin, &ray.direction, EdgeModel::Coverage)?;
        let (entry, exit) = loop {
            let (entry, exit) = (merge.entry()?, merge.exit());
            if exit.t - entry.t > ROUNDING * exit.t {
                break (entry, exit);
            }
            // The ray touches the hull in a point: views change at the same place, and rounding gives their order.
            exit.view?;
        };

        let into = (entry.t > 0.0).then(|| self.hit(ray, &entry, -ray.direction));
        Some((into, self.hit(ray, &exit, ray.direction)))
    }

    /// The hit at `crossing`, where `outward` points out of the hull along the ray.
    fn hit(&self, ray: &Ray, crossing: &Crossing, outward: Vector3<f64>) -> RayHit {
        let at = ray.at(crossing.t);
        let edge = crossing.view.and_then(|view| nearest_edge_in(view, &at));
        let normal = match edge {
            Some(edge) => self.contact_normal(&edge),
            // A view gains or loses sight of the ray, at its image's border or its camera.
            None if crossing.face == Vector3::zeros() => outward,
            None => crossing.face,
        };
        RayHit { t: crossing.t, normal }
    }
}

/// The edge of a view's silhouette beside `p`, a point on the hull's surface.
pub(in crate::hull) fn nearest_edge_in<'a>(view: &'a View, p: &Point3<f64>) -> Option<NearestEdge<'a>> {
    let a = view.project(p)?;
    let (i, j) = floor_pixel(a.u, a.v);
    // A point on the surface projects to an edge pixel or to one beside it.
    let b = view.silhouette().nearest_background(i, j, 2)?;
    Some(NearestEdge { view, a, b })
}
