//! The rim: where lines of sight graze the real surface, and each camera sees an edge of the silhouette.
//!
//! ```text
//!   camera >- - - - - - - - - - o- - -        o  a point of the rim: the middle of the part of the line of sight just
//!                            .-###-.             inside the edge that lies in the hull, which the other views bound
//!                           ########
//! ```

use crate::camera::Ray;
use crate::hull::{Hull, View};
use crate::math::rect::Rect;
use crate::silhouette::{Edge, EdgePixel, Silhouette, compute_edges};
use nalgebra::{Point2, Point3, Vector3};

/// Points of the rim within this distance of a place are taken to move as it does, in metres: about a hand's.
pub(super) const REACH: f64 = 0.15;

/// The most edge points of a view whose place is sought.
const MAX_EDGES: usize = 48;

/// How far inside the edge the hull is looked for along a line of sight, in pixels. At the edge itself there is none.
const INSIDE_PX: f64 = 0.75;

/// Edges this near to the image's border are left out, in pixels, since the border may be an edge itself.
const BORDER_PX: i32 = 4;

/// The least way from one part of a line of sight inside the hull to the next, in metres.
const LEAST_GAP: f64 = 1e-3;

/// A point of the rim, in the hull's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct RimPoint {
    /// The index of the view that sees it as an edge.
    pub(super) view: usize,
    pub(super) at: Point3<f64>,
    /// The unit outward normal of the surface, which is perpendicular to the line of sight.
    pub(super) normal: Vector3<f64>,
}

/// The points of the rim within [`REACH`] of `centre`, as all views that take part see it.
pub(super) fn rim_around(hull: &Hull, centre: &Point3<f64>) -> Vec<RimPoint> {
    let views = hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
    views.flat_map(|(index, view)| rim_in(hull, index, view, centre)).collect()
}

/// The points of the rim in one view.
fn rim_in(hull: &Hull, index: usize, view: &View, centre: &Point3<f64>) -> Vec<RimPoint> {
    let Some(pixel) = view.project(centre) else { return Vec::new() };
    let reach = REACH / view.footprint().at(pixel.depth);
    let window = Rect::window(pixel.u as i32, pixel.v as i32, reach.min(1e6) as i32 + 1);
    let middle = Point2::new(pixel.u, pixel.v);

    let is_near = |at: &(i32, i32)| (centre_of(*at) - middle).norm() <= reach;
    let near = || clear_edge_pixels(view.silhouette(), window).filter(is_near);
    let stride = near().count().div_ceil(MAX_EDGES).max(1);
    let pixels: Vec<_> = near().step_by(stride).map(|at| view.silhouette().edge_pixel(at)).collect();
    compute_missing_edges(view.silhouette(), &pixels);

    let point = |edge: Edge| {
        let at = place_on_sight(hull, view, &edge, centre)?;
        let is_near = (at - centre).norm() <= REACH;
        is_near.then(|| RimPoint { view: index, at, normal: view.backproject_edge(&edge) })
    };
    pixels.iter().filter_map(|pixel| view.silhouette().edge_at(pixel).and_then(point)).collect()
}

/// The place of an edge point on its line of sight: of all parts of the hull there, the one nearest to `centre`.
fn place_on_sight(hull: &Hull, view: &View, edge: &Edge, centre: &Point3<f64>) -> Option<Point3<f64>> {
    let inside = edge.point - edge.normal * INSIDE_PX;
    let sight = view.camera().ray(inside.x, inside.y)?;
    let nearest = (centre - sight.origin).dot(&sight.direction);
    let end = nearest + REACH;

    let (mut from, mut found) = ((nearest - REACH).max(0.0), None::<f64>);
    while from < end {
        let rest = Ray { origin: sight.at(from), direction: sight.direction };
        let Some((entry, exit)) = hull.ray_cast(&rest) else { break };
        let (first, last) = (from + entry.map_or(0.0, |entry| entry.t), from + exit.t);
        let middle = 0.5 * (first + last.min(end));
        if first < end && found.is_none_or(|found| (middle - nearest).abs() < (found - nearest).abs()) {
            found = Some(middle);
        }
        from = last + LEAST_GAP;
    }
    let depth = view.project(&sight.at(found?))?.depth;
    view.camera().unproject(edge.point.x, edge.point.y, depth)
}

/// The edge pixels in a window that are not beside the image's border.
pub(super) fn clear_edge_pixels(silhouette: &Silhouette, window: Rect) -> impl Iterator<Item = (i32, i32)> {
    silhouette.edge_pixels_in(window.intersection(&silhouette.image().grown(-BORDER_PX)))
}

/// Computes those edges that are not known yet, side by side.
pub(super) fn compute_missing_edges(silhouette: &Silhouette, pixels: &[EdgePixel]) {
    let missing: Vec<_> = pixels.iter().copied().filter(|pixel| silhouette.claim_edge(pixel)).collect();
    compute_edges(silhouette, &missing);
}

/// The image position of a pixel's centre.
pub(super) fn centre_of((i, j): (i32, i32)) -> Point2<f64> {
    Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5)
}
