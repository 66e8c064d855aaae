//! The paper's algorithm to the letter, as one would write it for speed: the yardstick.
//!
//! Everything is in `f32` and reads the masks' bytes. A point is projected by each view's matrix and looked up; the
//! search for the nearest edge grows a window ring by ring, and scans only what is new; the exit is walked pixel by
//! pixel along the ray's image. Of the culls those are kept that help: the hull's box, and in each view the
//! silhouette's bounding rectangle, which also stands for the image's borders. (The four planes of a frustum cost more
//! than the projection that they would save.)
//!
//! Section 4 of the design decides where the paper is silent, as in `ode_visual_hull::hull::reference`. A view that
//! does not see a point makes it outside, as in the paper.

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

/// The most views: sightings of a point fit into an array.
pub const MAX_VIEWS: usize = 32;

/// One frame.
#[derive(Debug, Clone)]
pub struct LiteralHull<'a> {
    views: Vec<LiteralView<'a>>,
    /// A box around the hull.
    aabb: [Vec3; 2],
    /// The work volume.
    bounds: [Vec3; 2],
}

/// The paper's response of a point inside.
#[derive(Debug, Clone, Copy)]
pub struct LiteralResponse {
    /// Index of the view that decides.
    pub view: usize,
    /// Unit outward normal.
    pub normal: Vec3,
    /// Metres along it to the exit.
    pub depth: f32,
}

impl<'a> LiteralHull<'a> {
    /// Prepares a frame: finds each silhouette's rectangle. `aabb` is the box around the hull that the paper takes
    /// from the frustums; the caller has it already.
    pub fn new(scene: &'a Scene, aabb: &Aabb) -> Self {
        assert!(scene.cameras.len() <= MAX_VIEWS, "{} views, at most {MAX_VIEWS}", scene.cameras.len());
        let views =
            scene.cameras.iter().zip(&scene.masks).map(|(camera, mask)| LiteralView::new(camera, mask));
        Self { views: views.collect(), aabb: corners(aabb), bounds: corners(&scene.bounds) }
    }

    /// Section 4.1: the point projects to a subject pixel in every view.
    pub fn inside(&self, p: &Vec3) -> bool {
        within(&self.aabb, p) && self.views.iter().all(|view| view.sees_subject(p))
    }

    /// Section 4.2: from the point along the normal of the nearest edge to the exit; `None` outside.
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

    /// Metres from `a` along `direction` to where some view first sees background, or the work volume ends. The view
    /// asked `first` is likely to decide, so that the others need not walk far.
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

/// Where the half-line leaves the box.
fn bounds_face([min, max]: &[Vec3; 2], a: &Vec3, direction: &Vec3) -> f32 {
    let along = |axis: usize| {
        let wall = if direction[axis] > 0.0 { max[axis] } else { min[axis] };
        if direction[axis] == 0.0 { f32::INFINITY } else { (wall - a[axis]) / direction[axis] }
    };
    along(0).min(along(1)).min(along(2)).max(0.0)
}
