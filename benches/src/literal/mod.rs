//! The paper's algorithm, implemented literally and written for speed: the baseline of the benchmarks.
//!
//! All numbers are `f32`, and masks are read as bytes. A point is projected by each view's matrix and looked up. The
//! search for the nearest edge grows a window ring by ring and scans only the new ring. The exit is found by traversing
//! the ray's image pixel by pixel. Two culls are used because they help: the hull's bounding box, and in each view the
//! silhouette's bounding rectangle, which also replaces the test of the image's borders. (Testing a frustum's four
//! planes costs more than the projection that it saves.)
//!
//! Where the paper leaves a detail open, this follows `ode_visual_hull::hull::reference`. A point that some view does
//! not see is outside, as in the paper.

mod body;
mod line_walk;
mod search;
mod view;

pub use body::{BodyVector, LiteralBodies};
pub use view::LiteralView;

use crate::scene::Scene;
use ode_visual_hull::hull::Aabb;
use search::NearestEdge;
use view::scaled;

/// A point or vector of the world, in metres.
pub type Vec3 = [f32; 3];

/// Maximum number of views, so that the search windows of a point fit into an array.
pub const MAX_VIEWS: usize = 32;

/// The hull of one frame.
#[derive(Debug, Clone)]
pub struct LiteralHull<'a> {
    views: Vec<LiteralView<'a>>,
    /// Bounding box of the hull.
    aabb: [Vec3; 2],
    /// The work volume.
    bounds: [Vec3; 2],
}

/// The paper's response of a point inside the hull.
#[derive(Debug, Clone, Copy)]
pub struct LiteralResponse {
    /// Index of the deciding view.
    pub view: usize,
    /// Unit outward normal.
    pub normal: Vec3,
    /// Metres along the normal to the exit.
    pub depth: f32,
}

impl<'a> LiteralHull<'a> {
    /// Prepares a frame: finds each silhouette's bounding rectangle. `aabb` is the hull's bounding box, which the paper
    /// computes from the frustums.
    pub fn new(scene: &'a Scene, aabb: &Aabb) -> Self {
        assert!(scene.cameras.len() <= MAX_VIEWS, "{} views, at most {MAX_VIEWS}", scene.cameras.len());
        let views =
            scene.cameras.iter().zip(&scene.masks).map(|(camera, mask)| LiteralView::new(camera, mask));
        Self { views: views.collect(), aabb: corners(aabb), bounds: corners(&scene.bounds) }
    }

    /// Whether the point projects to a subject pixel in every view (section 4.1).
    pub fn inside(&self, p: &Vec3) -> bool {
        within(&self.aabb, p) && self.views.iter().all(|view| view.sees_subject(p))
    }

    /// The response of a point along the normal of the nearest edge to the exit (section 4.2); `None` outside.
    pub fn respond(&self, a: &Vec3) -> Option<LiteralResponse> {
        if !self.inside(a) {
            return None;
        }
        let NearestEdge { view, pixel, b } = self.nearest_edge(a)?;

        let deciding = &self.views[view];
        let tangent = deciding.normal_2d(b).unwrap_or_else(|| {
            let (du, dv) = ((b.0 - pixel.0) as f32, (b.1 - pixel.1) as f32);
            let length = du.hypot(dv);
            (du / length, dv / length)
        });
        let normal = deciding.backproject_normal(b, tangent);
        Some(LiteralResponse { view, normal, depth: self.exit(a, &normal, view) })
    }

    /// Metres from `a` along `direction` to the first background pixel of any view, or to the end of the work volume.
    /// The search starts with the view `first`: if it gives the nearest exit, the traversals of the others are short.
    pub fn exit(&self, a: &Vec3, direction: &Vec3, first: usize) -> f32 {
        let mut nearest = bounds_face(&self.bounds, a, direction);
        let others = (0..self.views.len()).filter(|&view| view != first);
        for view in [first].into_iter().chain(others) {
            nearest = self.views[view].walk_line(a, direction, nearest);
        }
        nearest
    }
}

impl LiteralResponse {
    /// The response vector, in metres.
    pub fn w(&self) -> Vec3 {
        scaled(&self.normal, self.depth)
    }
}

fn corners(aabb: &Aabb) -> [Vec3; 2] {
    [aabb.min, aabb.max].map(|corner| [corner.x as f32, corner.y as f32, corner.z as f32])
}

fn within([min, max]: &[Vec3; 2], p: &Vec3) -> bool {
    (0..3).all(|axis| min[axis] <= p[axis] && p[axis] <= max[axis])
}

/// Metres along the half-line to where it leaves the box.
fn bounds_face([min, max]: &[Vec3; 2], a: &Vec3, direction: &Vec3) -> f32 {
    let along = |axis: usize| {
        let face = if direction[axis] > 0.0 { max[axis] } else { min[axis] };
        if direction[axis] == 0.0 { f32::INFINITY } else { (face - a[axis]) / direction[axis] }
    };
    along(0).min(along(1)).min(along(2)).max(0.0)
}
