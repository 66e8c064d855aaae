//! The solids and cameras of the accuracy figures.

use super::analytic::AnalyticHull;
use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3, point, vector};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, Hull, Unseen, View};
use ode_visual_hull::silhouette::{Border, Silhouette};
use ode_visual_hull::synthetic::{self, Placed, Solid, Subject, Texture, layout};
use std::sync::Arc;

const SIZE: (u32, u32) = (640, 480);
const FIELD_OF_VIEW: f64 = 0.55;
const TARGET: Point3<f64> = Point3::new(0.0, 0.0, 0.5);

/// Heights of the seven cameras in metres, from below the middle of the solid to far above its top.
const HEIGHTS: [f64; 7] = [0.15, 1.1, 0.45, 1.7, 0.0, 1.35, 0.8];

/// The names of the solids, each half a metre wide.
pub const SHAPES: [&str; 3] = ["sphere", "box", "torus"];

/// A solid in front of cameras: its analytic hull, and its hulls from pixels.
pub struct Scene {
    /// Name made of the shape and the number of cameras, as in `torus_7`.
    pub name: String,
    /// Hull of the exact contours.
    pub analytic: AnalyticHull,
    /// Hull of binary masks.
    pub binary: Hull,
    /// Hull of masks with coverage.
    pub coverage: Hull,
}

/// Scenes of a sphere, a box and a torus, each with five cameras on a hemisphere and with seven around at various
/// heights.
pub fn all() -> impl Iterator<Item = Scene> {
    SHAPES.into_iter().flat_map(|shape| [5, 7].map(|n| scene(shape, n)))
}

/// The scene of `shape` (sphere, box or torus) and `n` (5 or 7) cameras.
pub fn scene(shape: &str, n: usize) -> Scene {
    let solid = placed(shape);
    let cameras = cameras(n);
    let subject = Subject::new(vec![solid.clone()]);
    Scene {
        name: format!("{shape}_{n}"),
        analytic: AnalyticHull::new(&cameras, &solid),
        binary: hull(&cameras, |camera| synthetic::silhouette(camera, &subject)),
        coverage: hull(&cameras, |camera| synthetic::coverage(camera, &subject)),
    }
}

/// The solid `shape` at the place that the cameras look at.
pub fn placed(shape: &str) -> Placed {
    let (solid, turn) = match shape {
        "sphere" => (Solid::sphere(0.25), Vector3::zeros()),
        "box" => (Solid::cuboid(vector![0.5, 0.4, 0.3]), vector![0.35, -0.2, 0.6]),
        _ => (Solid::torus(0.25, 0.09), vector![0.5, 0.3, 0.0]),
    };
    // A little off the cameras' target, so that no silhouette is symmetric about the image's centre.
    let pose = Isometry3::new(vector![0.031, -0.017, 0.489], turn);
    Placed::new(solid.expect("positive lengths"), pose, Texture::plain([200; 3]))
}

fn cameras(n: usize) -> Vec<Camera> {
    let cameras = match n {
        5 => layout::hemisphere(5, 2.75, TARGET, SIZE, FIELD_OF_VIEW),
        _ => layout::staggered(n, 2.6, &HEIGHTS, TARGET, SIZE, FIELD_OF_VIEW),
    };
    cameras.expect("a valid layout")
}

fn hull(cameras: &[Camera], mask: impl Fn(&Camera) -> GrayImage) -> Hull {
    let view = |camera: &Camera| {
        let silhouette = Silhouette::new(&mask(camera), Border::Background);
        View::new(Arc::new(camera.clone()), Arc::new(silhouette), None)
    };
    let bounds = Aabb::new(point![-0.8, -0.8, -0.3], point![0.8, 0.8, 1.3]).expect("a valid volume");
    let hull = Hull::new(cameras.iter().map(view).collect(), bounds, Unseen::Outside, 0.0);
    // The analytic hull has no work volume.
    assert!(bounds.grown(-1e-3).intersection(hull.aabb()) == *hull.aabb(), "the work volume cuts the hull");
    hull
}
