//! How one point leaves the hull: the paper's response (section 4.2), and the exit vector that contacts use.

use super::projection::ViewSamples;
use super::window_search::NearestEdge;
use crate::camera::floor_pixel;
use crate::hull::{EdgeModel, Hull};
use nalgebra::{Point2, Point3, Vector2, Vector3};

/// The paper's response of a point inside (section 4.2): `w = c - a`, from the point to where it leaves the hull along
/// the normal of the nearest silhouette edge.
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
    /// The response vector `w`, in metres.
    pub fn w(&self) -> Vector3<f64> {
        self.normal * self.depth
    }
}

/// How a point leaves the hull in a contact: along the contact normal, up to the coverage edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExitVector {
    /// Unit outward direction.
    pub direction: Vector3<f64>,
    /// Metres along the direction to the exit; may be zero.
    pub depth: f64,
}

impl Hull {
    /// The paper's response of `p` (section 4.2), with binary silhouettes and 5x5 normals. `None` if `p` is outside, or
    /// if no view has a silhouette edge.
    pub fn respond(&self, p: &Point3<f64>) -> Option<Response<'_>> {
        if !self.in_boxes(p) {
            return None;
        }

        ViewSamples::with(|samples| {
            if !samples.project_if_inside(self, p, EdgeModel::Pixel) {
                return None;
            }

            let nearest = self.nearest_edge_among(samples)?;
            let (i, j) = nearest.b;
            let image_normal = nearest.view.silhouette().paper_normal(i, j);
            let image_normal = image_normal.unwrap_or_else(|| towards_b(&nearest));
            let centre = Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5);
            let normal = nearest.view.backproject_normal(&centre, &image_normal);

            let depth = self.exit(p, &normal, EdgeModel::Pixel);
            Some(Response { nearest, normal, depth })
        })
    }

    /// The exit vector of `p` for a contact. `None` if `p` is outside by the coverage edge, or if no view has a
    /// silhouette edge.
    pub fn exit_vector(&self, p: &Point3<f64>) -> Option<ExitVector> {
        if !self.in_boxes(p) {
            return None;
        }
        ViewSamples::with(|samples| {
            if !samples.project_if_inside(self, p, EdgeModel::Coverage) {
                return None;
            }
            let direction = self.contact_normal(&self.nearest_edge_among(samples)?);
            Some(ExitVector { direction, depth: self.exit(p, &direction, EdgeModel::Coverage) })
        })
    }

    /// The unit normal in the world that a silhouette edge gives to a contact.
    pub(in crate::hull) fn contact_normal(&self, nearest: &NearestEdge) -> Vector3<f64> {
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

/// The unit direction in the image from a's pixel to b, which replaces an edge's normal where that is undefined.
fn towards_b(nearest: &NearestEdge) -> Vector2<f64> {
    let (i, j) = floor_pixel(nearest.a.u, nearest.a.v);
    towards(nearest.b.0 - i, nearest.b.1 - j)
}

/// The unit direction of an offset in the image, in pixels; upwards for a zero offset.
pub(in crate::hull) fn towards(right: i32, down: i32) -> Vector2<f64> {
    let offset = Vector2::new(f64::from(right), f64::from(down));
    offset.try_normalize(0.0).unwrap_or_else(|| -Vector2::y())
}
