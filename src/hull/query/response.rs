//! The exit vector of one point (paper, section 4.2).

use super::projection::ViewSamples;
use super::window_search::NearestEdge;
use crate::camera::floor_pixel;
use crate::hull::{EdgeModel, Hull};
use nalgebra::{Point2, Point3, Vector2, Vector3};

/// The paper's response of a point inside: `w = c - a`, from the point to where it leaves the hull along the normal
/// of the nearest silhouette edge.
#[derive(Debug, Clone, Copy)]
pub struct Response<'a> {
    /// The edge that gave the normal.
    pub nearest: NearestEdge<'a>,
    /// Unit outward normal.
    pub normal: Vector3<f64>,
    /// Metres along the normal to the exit.
    pub depth: f64,
}

impl Response<'_> {
    /// The response vector, in metres.
    pub fn w(&self) -> Vector3<f64> {
        self.normal * self.depth
    }
}

/// The exit that contacts use: the contact normal, and the exit at the coverage edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExitVector {
    /// Unit outward direction.
    pub direction: Vector3<f64>,
    /// Metres along it to the exit; may be zero.
    pub depth: f64,
}

impl Hull {
    /// The paper's response of `p`: binary silhouettes, 5x5 normals. `None` outside, and inside a hull none of whose
    /// views has an edge.
    pub fn respond(&self, p: &Point3<f64>) -> Option<Response<'_>> {
        if !self.in_boxes(p) {
            return None;
        }
        ViewSamples::with(|sightings| {
            if !sightings.project_if_inside(self, p, EdgeModel::Pixel) {
                return None;
            }
            let nearest = self.nearest_edge_among(sightings)?;
            let (i, j) = nearest.b;
            let normal = nearest.view.silhouette().paper_normal(i, j);
            let centre = Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
            let normal = normal.unwrap_or_else(|| towards_b(&nearest));
            let normal = nearest.view.backproject_normal(&centre, &normal);
            let depth = self.exit(p, &normal, EdgeModel::Pixel);
            Some(Response { nearest, normal, depth })
        })
    }

    /// The exit of `p` that contacts use; `None` where `p` is outside by the coverage edge.
    pub fn exit_vector(&self, p: &Point3<f64>) -> Option<ExitVector> {
        if !self.in_boxes(p) {
            return None;
        }
        ViewSamples::with(|sightings| {
            if !sightings.project_if_inside(self, p, EdgeModel::Coverage) {
                return None;
            }
            let direction = self.contact_normal(&self.nearest_edge_among(sightings)?);
            Some(ExitVector { direction, depth: self.exit(p, &direction, EdgeModel::Coverage) })
        })
    }

    pub(super) fn contact_normal(&self, nearest: &NearestEdge) -> Vector3<f64> {
        let (i, j) = nearest.b;
        match nearest.view.silhouette().edge(i, j) {
            Some(edge) => nearest.view.backproject_edge(&edge),
            None => {
                let centre = Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
                nearest.view.backproject_normal(&centre, &towards_b(nearest))
            }
        }
    }
}

/// The image direction from a's pixel to b's, where the mean over a window has none.
fn towards_b(nearest: &NearestEdge) -> Vector2<f64> {
    let (i, j) = floor_pixel(nearest.a.u, nearest.a.v);
    towards(nearest.b.0 - i, nearest.b.1 - j)
}

/// The unit direction of an offset in the image; upwards where there is none.
pub(in crate::hull) fn towards(across: i32, down: i32) -> Vector2<f64> {
    let offset = Vector2::new(f64::from(across), f64::from(down));
    offset.try_normalize(0.0).unwrap_or_else(|| -Vector2::y())
}
