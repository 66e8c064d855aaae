//! The pose that puts points of a rim back onto the edges of silhouettes: Gauss-Newton on their distances.
//!
//! Each point is compared with the nearest edge that faces as the point does, so that the two sides of a finger are not
//! taken for one another, along that edge's normal. Edges of other parts, and points that have gone out of sight, do not
//! fit and lose their weight.

use super::rim::{RimPoint, centre_of, clear_edge_pixels, compute_missing_edges};
use crate::hull::{Hull, View};
use crate::math::rect::Rect;
use crate::silhouette::EdgePixel;
use nalgebra::{Isometry3, Matrix6, Point2, Point3, Translation3, UnitQuaternion, Vector2, Vector3, Vector6};

/// For each step of the search: how far from a point its edge is looked for, and the distance that halves the weight of an
/// equation, both in pixels. The first are wide, since the predicted pose may be off.
const STEPS: [(f64, f64); 8] =
    [(16.0, 8.0), (12.0, 4.0), (8.0, 2.0), (6.0, 1.5), (5.0, 1.0), (5.0, 1.0), (5.0, 1.0), (5.0, 1.0)];

/// The least cosine between the normal of a point and that of its edge, in the image.
const FACING: f64 = 0.6;

/// A point fits if it is at most this far from its edge, in pixels: 2.5 standard deviations of noisy masks.
const FITS_PX: f64 = 2.5;

/// The least number of points that fit, and the least part of all points in sight.
const LEAST_FITTING: usize = 16;
const LEAST_PART_FITTING: f64 = 0.4;

/// The weight of the predicted pose, as a part of the weight of all points: enough to decide where no edge tells, as along a
/// forearm, and too little to matter elsewhere.
const WEIGHT_OF_PREDICTION: f64 = 3e-3;

/// A turn counts as a shift at this distance in the comparison with the predicted pose, in metres.
const ARM: f64 = 0.08;

/// What an edge tells of the pose, in metres.
struct Equation {
    /// By how much the point moves along the edge's normal, for each component of a shift and of a turn about the centre.
    row: Vector6<f64>,
    /// How far the point is outside the edge, in metres.
    distance: f64,
    /// How far the point is outside the edge, in pixels of its view.
    pixels: f64,
}

/// The edges of one view around the rim.
struct NearEdges<'h> {
    view: &'h View,
    index: usize,
    /// Edge pixels, row by row, with the normals of their surroundings.
    pixels: Vec<((i32, i32), Vector2<f64>)>,
}

/// A point of the rim in the image of its view.
struct Projected {
    at: Point3<f64>,
    image: Point2<f64>,
    /// In metres in front of the camera.
    depth: f64,
    /// Its unit normal in the image.
    normal: Vector2<f64>,
}

/// The pose, later from earlier, that puts the points of `rim` onto the edges of `hull`, near the pose `predicted`; `None`
/// where too few fit.
pub(super) fn locate(rim: &[RimPoint], hull: &Hull, predicted: &Isometry3<f64>) -> Option<Isometry3<f64>> {
    let sum = rim.iter().fold(Vector3::zeros(), |sum, point| sum + point.at.coords);
    let centre_before = Point3::from(sum / rim.len().max(1) as f64);
    let edges = edges_near(rim, hull, predicted);
    let mut pose = *predicted;

    for (reach, scale) in STEPS {
        let centre = pose * centre_before;
        let (equations, _) = compare(rim, &edges, &pose, &centre, reach);
        let off_prediction = Vector6::from_iterator(
            (centre - predicted * centre_before)
                .iter()
                .chain((pose.rotation * predicted.rotation.inverse()).scaled_axis().iter())
                .copied(),
        );
        let change = solve(&equations, scale, &off_prediction)?;
        let turn = UnitQuaternion::from_scaled_axis(change.fixed_rows::<3>(3).into_owned());
        let moved = centre + change.fixed_rows::<3>(0);
        pose = Translation3::from(moved.coords) * turn * Translation3::from(-centre.coords) * pose;
    }

    let (equations, in_sight) =
        compare(rim, &edges, &pose, &(pose * centre_before), STEPS[STEPS.len() - 1].0);
    let fitting = equations.iter().filter(|equation| equation.pixels.abs() <= FITS_PX).count();
    let is_found = fitting >= LEAST_FITTING && fitting as f64 >= LEAST_PART_FITTING * in_sight as f64;
    is_found.then_some(pose)
}

/// The edges in each view that may be compared with points of the rim.
fn edges_near<'h>(rim: &[RimPoint], hull: &'h Hull, predicted: &Isometry3<f64>) -> Vec<NearEdges<'h>> {
    let near = |(index, view): (usize, &'h View)| {
        let of_view = rim.iter().filter(|point| point.view == index);
        let images = of_view.filter_map(|point| view.project(&(predicted * point.at)));
        let around = images.map(|at| Rect::window(at.u as i32, at.v as i32, 2 * STEPS[0].0 as i32));
        let window = around.reduce(|all, one| all.union(&one))?;

        let silhouette = view.silhouette();
        let with_normal = |at: (i32, i32)| Some((at, silhouette.paper_normal(at.0, at.1)?));
        let pixels = clear_edge_pixels(silhouette, window).filter_map(with_normal).collect();
        Some(NearEdges { view, index, pixels })
    };
    let views = hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
    views.filter_map(near).collect()
}

/// The equations of all points that have an edge within `reach` pixels, and how many points are in sight.
fn compare(
    rim: &[RimPoint],
    edges: &[NearEdges],
    pose: &Isometry3<f64>,
    centre: &Point3<f64>,
    reach: f64,
) -> (Vec<Equation>, usize) {
    let (mut equations, mut in_sight) = (Vec::with_capacity(rim.len()), 0);
    let mut pairs: Vec<(Projected, EdgePixel)> = Vec::new();
    for near in edges {
        let silhouette = near.view.silhouette();
        pairs.clear();
        for point in rim.iter().filter(|point| point.view == near.index) {
            let Some(projected) = project(near.view, point, pose) else { continue };
            in_sight += 1;
            let edge = near.facing(&projected, reach);
            pairs.extend(edge.map(|at| (projected, silhouette.edge_pixel(at))));
        }
        let pixels: Vec<_> = pairs.iter().map(|(_, pixel)| *pixel).collect();
        compute_missing_edges(silhouette, &pixels);

        let with_edge = |(point, pixel): &(Projected, EdgePixel)| {
            let edge = silhouette.edge_at(pixel)?;
            let pixels = edge.normal.dot(&(point.image - edge.point));
            let along = near.view.image_motion_along(point.depth, &point.image, &edge.normal);
            let scale = along.norm();
            let direction = along / scale;
            let turning = (point.at - centre).cross(&direction);
            let row = Vector6::from_iterator(direction.iter().chain(turning.iter()).copied());
            (scale > 0.0).then(|| Equation { row, distance: pixels / scale, pixels })
        };
        equations.extend(pairs.iter().filter_map(with_edge));
    }
    (equations, in_sight)
}

/// A point of the rim in its view, at the pose; `None` where the view does not see it.
fn project(view: &View, point: &RimPoint, pose: &Isometry3<f64>) -> Option<Projected> {
    let (at, normal) = (pose * point.at, pose * point.normal);
    let pixel = view.project(&at)?;
    if !view.judges(pixel.u.floor() as i32, pixel.v.floor() as i32) {
        return None;
    }
    let image = Point2::new(pixel.u, pixel.v);
    let across = |axis: Vector2<f64>| view.image_motion_along(pixel.depth, &image, &axis).dot(&normal);
    let normal = Vector2::new(across(Vector2::x()), across(Vector2::y())).try_normalize(0.0)?;
    Some(Projected { at, image, depth: pixel.depth, normal })
}

impl NearEdges<'_> {
    /// The nearest edge pixel within `reach` pixels that faces as the point does.
    fn facing(&self, point: &Projected, reach: f64) -> Option<(i32, i32)> {
        let row = |y: f64| self.pixels.partition_point(|((_, j), _)| f64::from(*j) + 0.5 < y);
        let rows = row(point.image.y - reach)..row(point.image.y + reach);
        let mut nearest = (reach * reach, None);
        for (at, normal) in &self.pixels[rows] {
            let squared = (centre_of(*at) - point.image).norm_squared();
            if squared < nearest.0 && normal.dot(&point.normal) >= FACING {
                nearest = (squared, Some(*at));
            }
        }
        nearest.1
    }
}

/// The shift and the turn that take most points to their edges, by weighted least squares, where the pose is off the predicted
/// one by `off_prediction`.
fn solve(equations: &[Equation], scale: f64, off_prediction: &Vector6<f64>) -> Option<Vector6<f64>> {
    if equations.len() < LEAST_FITTING {
        return None;
    }
    let (mut matrix, mut right, mut total) = (Matrix6::zeros(), Vector6::zeros(), 0.0);
    for Equation { row, distance, pixels } in equations {
        let weight = 1.0 / (1.0 + (pixels / scale).powi(2));
        matrix += row * row.transpose() * weight;
        right -= row * (distance * weight);
        total += weight;
    }
    let of_turn = ARM * ARM;
    let prediction = Vector6::new(1.0, 1.0, 1.0, of_turn, of_turn, of_turn) * (WEIGHT_OF_PREDICTION * total);
    matrix += Matrix6::from_diagonal(&prediction);
    right -= prediction.component_mul(off_prediction);
    Some(matrix.cholesky()?.solve(&right))
}
