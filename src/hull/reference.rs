//! The paper's section 4, sentence by sentence, slow and without tables. Tests compare the optimised queries with it.
//!
//! It reads masks pixel by pixel. It shares the camera, the normals of edge pixels and the policy for unseen points
//! with the optimised code, but has its own window search and its own exits.

use super::query::{ROUNDING, window_half_width};
use super::{Hull, Unseen, View};
use crate::camera::MIN_DEPTH;
use crate::silhouette::Rect;
use nalgebra::{Point2, Point3, Vector2, Vector3};

/// The paper's response of one point.
#[derive(Debug, Clone, Copy)]
pub struct ReferenceResponse {
    /// Index of the view that decides.
    pub view: usize,
    /// The background pixel to which the paper's point b projects.
    pub b: (i32, i32),
    /// Unit outward normal.
    pub normal: Vector3<f64>,
    /// Metres along the normal to the exit.
    pub depth: f64,
}

/// Whether `p` is inside (paper, section 4.1): it projects to a subject pixel in every view. Views that do not see it
/// follow the hull's [`Unseen`] policy.
pub fn inside(hull: &Hull, p: &Point3<f64>) -> bool {
    let enabled = || hull.views().iter().filter(|view| view.is_enabled());
    let verdicts =
        enabled().filter_map(|view| view.pixel(p).map(|(i, j)| view.silhouette().is_subject(i, j)));
    let (subject, background): (Vec<bool>, Vec<bool>) = verdicts.partition(|&is_subject| is_subject);
    let enough = match hull.unseen() {
        Unseen::Outside => subject.len() == enabled().count() && !subject.is_empty(),
        Unseen::Abstain { min_views } => subject.len() >= min_views.max(1),
    };
    hull.bounds().contains(p) && background.is_empty() && enough
}

/// The response `w = c - a` of a point inside (paper, section 4.2); `None` outside, and where no view has an edge.
pub fn respond(hull: &Hull, a: &Point3<f64>) -> Option<ReferenceResponse> {
    if !inside(hull, a) {
        return None;
    }
    let (view, b) = window_search(hull, a)?;

    // The 5x5 normal in the image; where there is none, the direction from a's pixel to b.
    let deciding = &hull.views()[view];
    let silhouette = deciding.silhouette();
    let image_normal = silhouette.paper_normal(b.0, b.1).unwrap_or_else(|| {
        let (i, j) = deciding.pixel(a).unwrap_or(b);
        Vector2::new(f64::from(b.0 - i), f64::from(b.1 - j)).normalize()
    });

    let centre = Point2::new(f64::from(b.0) + 0.5, f64::from(b.1) + 0.5);
    let normal = deciding.backproject_normal(&centre, &image_normal);
    Some(ReferenceResponse { view, b, normal, depth: exit(hull, a, &normal) })
}

/// The first view with background in its window, and the background pixel in it that is nearest to a's pixel. "For
/// every iteration of the search algorithm, a square window around the projection of a is considered for every input
/// image" (paper, section 4.2). Of several views at one iteration, the one whose smallest window with background is the
/// smallest in metres.
fn window_search(hull: &Hull, a: &Point3<f64>) -> Option<(usize, (i32, i32))> {
    // d_i: metres that a pixel covers at a, in each view that sees it.
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

    // Windows grow until they hold a whole image.
    let last =
        hull.views().iter().map(|view| view.silhouette().image()).map(|r| r.width() + r.height()).max()?;
    for k in 0..last as i64 {
        let mut found: Option<(f64, usize, (i32, i32))> = None;
        for &(index, view, d) in &sizes {
            let (i, j) = view.pixel(a)?;
            let window = Rect::window(i, j, window_half_width(k, d_max / d));
            let pixels = (window.y0..window.y1).flat_map(|y| (window.x0..window.x1).map(move |x| (x, y)));
            let background = pixels.filter(|&(x, y)| !view.silhouette().is_subject(x, y));
            let half_width = background.clone().map(|(x, y)| (x - i).abs().max((y - j).abs())).min();
            let nearest = background.min_by_key(|&(x, y)| ((x - i).pow(2) + (y - j).pow(2), y, x));
            if let (Some(half_width), Some(b)) = (half_width, nearest) {
                let extent = (f64::from(half_width) + 0.5) * d;
                if found.is_none_or(|(least, ..)| extent < (1.0 - ROUNDING) * least) {
                    found = Some((extent, index, b));
                }
            }
        }
        if let Some((_, index, b)) = found {
            return Some((index, b));
        }
    }
    None
}

/// Metres from `a` along the unit `direction` to the first point that is not inside. Every pixel border that the
/// half-line crosses in any view is a candidate, since no verdict changes between two neighbouring ones.
pub fn exit(hull: &Hull, a: &Point3<f64>, direction: &Vector3<f64>) -> f64 {
    let (bounds_exit, _) = hull.bounds().exit(a, direction);
    let mut candidates = vec![0.0, bounds_exit];
    for view in hull.views().iter().filter(|view| view.is_enabled()) {
        candidates.extend(pixel_borders(view, a, direction).filter(|&t| t > 0.0 && t < bounds_exit));
    }
    candidates.sort_by(f64::total_cmp);

    // The first interval between two candidates whose middle is outside.
    let outside_between = |pair: &[f64]| {
        let middle = a + direction * (0.5 * (pair[0] + pair[1]));
        pair[1] > pair[0] && !inside(hull, &middle)
    };
    candidates.windows(2).find(|pair| outside_between(pair)).map_or(bounds_exit, |pair| pair[0])
}

/// The `t`, in metres, at which the ray crosses a border between columns or rows of the view's image, or the plane of
/// least depth in front of the camera.
fn pixel_borders(view: &View, a: &Point3<f64>, direction: &Vector3<f64>) -> impl Iterator<Item = f64> {
    let (x0, x1) = (view.homogeneous(a), view.homogeneous_direction(direction));
    let image = view.silhouette().image();
    let columns = (image.x0..=image.x1).map(f64::from).map(move |u| (u * x0.z - x0.x) / (x1.x - u * x1.z));
    let rows = (image.y0..=image.y1).map(f64::from).map(move |v| (v * x0.z - x0.y) / (x1.y - v * x1.z));
    let plane = (MIN_DEPTH - x0.z) / x1.z;
    columns.chain(rows).chain([plane]).filter(|t| t.is_finite())
}
