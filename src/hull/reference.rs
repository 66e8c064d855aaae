//! The paper's section 4 in the order of its sentences, slow and without tables: the judge of what is in use.
//!
//! It reads masks pixel by pixel. What it shares with the code in use is the camera, the normals of an edge pixel and
//! the policy for unseen points; the search, the distances and the walk are its own.

use super::query::window_half_width;
use super::{Hull, Unseen, View};
use crate::camera::MIN_DEPTH;
use crate::silhouette::Rect;
use nalgebra::{Point2, Point3, Vector2, Vector3};

/// The paper's response of one point.
#[derive(Debug, Clone, Copy)]
pub struct ReferenceResponse {
    /// Index of the view that decides.
    pub view: usize,
    /// The background pixel that is the projection of b.
    pub b: (i32, i32),
    /// Unit outward normal.
    pub normal: Vector3<f64>,
    /// Metres along the normal to the exit.
    pub depth: f64,
}

/// Section 4.1: the point projects to a subject pixel in every view.
pub fn inside(hull: &Hull, p: &Point3<f64>) -> bool {
    let enabled = || hull.views().iter().filter(|view| view.is_enabled());
    let seen = enabled().filter_map(|view| view.pixel(p).map(|(i, j)| view.silhouette().is_subject(i, j)));
    let (subject, background): (Vec<bool>, Vec<bool>) = seen.partition(|&is_subject| is_subject);
    let enough = match hull.unseen() {
        Unseen::Outside => subject.len() == enabled().count() && !subject.is_empty(),
        Unseen::Abstain { min_views } => subject.len() >= min_views.max(1),
    };
    hull.bounds().contains(p) && background.is_empty() && enough
}

/// Section 4.2: `w = c - a` for a point inside; `None` outside, and where no view has an edge.
pub fn respond(hull: &Hull, a: &Point3<f64>) -> Option<ReferenceResponse> {
    if !inside(hull, a) {
        return None;
    }
    let (view, b) = window_search(hull, a)?;
    let deciding = &hull.views()[view];
    let silhouette = deciding.silhouette();
    let tangent = silhouette.paper_normal(b.0, b.1).unwrap_or_else(|| {
        let (i, j) = deciding.pixel(a).unwrap_or(b);
        Vector2::new(f64::from(b.0 - i), f64::from(b.1 - j)).normalize()
    });
    let centre = Point2::new(f64::from(b.0) + 0.5, f64::from(b.1) + 0.5);
    let normal = deciding.backproject_normal(&centre, &tangent);
    Some(ReferenceResponse { view, b, normal, depth: exit(hull, a, &normal) })
}

/// "For every iteration of the search algorithm, a square window around the projection of a is considered for every
/// input image": the first view with background in its window, and the background pixel nearest to a's.
fn window_search(hull: &Hull, a: &Point3<f64>) -> Option<(usize, (i32, i32))> {
    let pixel_size = |view: &View| -> Option<f64> {
        view.pixel(a)?;
        let (camera, at) = (view.camera(), view.project(a)?);
        let right = camera.unproject(at.u + 1.0, at.v, at.depth)?;
        let below = camera.unproject(at.u, at.v + 1.0, at.depth)?;
        Some((right - a).norm().min((below - a).norm()))
    };
    let enabled = || hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
    let sizes: Vec<_> =
        enabled().filter_map(|(index, view)| Some((index, view, pixel_size(view)?))).collect();
    let d_max = sizes.iter().map(|&(.., d)| d).fold(0.0, f64::max);
    let largest =
        hull.views().iter().map(|view| view.silhouette().image()).map(|r| r.width() + r.height()).max()?;
    for k in 0..largest as i64 {
        for &(index, view, d) in &sizes {
            let (i, j) = view.pixel(a)?;
            let window = Rect::window(i, j, window_half_width(k, d_max / d));
            let pixels = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
            let background = pixels.filter(|&(x, y)| !view.silhouette().is_subject(x, y));
            let nearest = background.min_by_key(|&(x, y)| ((x - i).pow(2) + (y - j).pow(2), y, x));
            if let Some(b) = nearest {
                return Some((index, b));
            }
        }
    }
    None
}

/// Metres along `direction` to the first point that is not inside: every pixel border that the ray crosses in any
/// view is a candidate, and between two neighbouring candidates nothing can change.
pub fn exit(hull: &Hull, a: &Point3<f64>, direction: &Vector3<f64>) -> f64 {
    let (wall, _) = hull.bounds().exit(a, direction);
    let mut candidates = vec![0.0, wall];
    for view in hull.views().iter().filter(|view| view.is_enabled()) {
        candidates.extend(pixel_borders(view, a, direction).filter(|&t| t > 0.0 && t < wall));
    }
    candidates.sort_by(f64::total_cmp);
    let outside_between = |pair: &[f64]| {
        let middle = a + direction * (0.5 * (pair[0] + pair[1]));
        pair[1] > pair[0] && !inside(hull, &middle)
    };
    candidates.windows(2).find(|pair| outside_between(pair)).map_or(wall, |pair| pair[0])
}

/// The t at which the ray crosses a column or row border of the view's image, or the camera's plane.
fn pixel_borders(view: &View, a: &Point3<f64>, direction: &Vector3<f64>) -> impl Iterator<Item = f64> {
    let (x0, x1) = (view.homogeneous(a), view.homogeneous_direction(direction));
    let image = view.silhouette().image();
    let columns = (image.x0..=image.x1).map(f64::from).map(move |u| (u * x0.z - x0.x) / (x1.x - u * x1.z));
    let rows = (image.y0..=image.y1).map(f64::from).map(move |v| (v * x0.z - x0.y) / (x1.y - v * x1.z));
    let plane = (MIN_DEPTH - x0.z) / x1.z;
    columns.chain(rows).chain([plane]).filter(|t| t.is_finite())
}
