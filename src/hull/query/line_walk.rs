//! A half-line walked through one view's mask: where along it the view's verdict changes.
//!
//! ```text
//!      :   ....########....   :     one row of a mask; the line crosses it from left to right
//!   U  : O         I      O   : U   unseen, outside, inside
//! ```
//!
//! Inside the silhouette a step jumps the largest square of subject pixels, which the distance table gives.

use crate::camera::{CellExit, ImageLine, MIN_DEPTH, floor};
use crate::hull::{EdgeModel, Verdict, View};
use crate::silhouette::{HALF_COVERAGE, Rect};
use nalgebra::{Point3, Vector3};

/// A view's walk along a half-line: the verdict that holds now, and until when it surely holds.
#[derive(Debug)]
pub(in crate::hull) struct MaskTraversal<'a> {
    view: &'a View,
    line: ImageLine,
    /// Cells are pixels (0), or the squares between four pixel centres (one half).
    shift: f64,
    /// Where subject pixels may be.
    region: Rect,
    /// When the line is in the image and in the region, once that is asked.
    visible_span: Option<VisibleSpan>,
    segment: Option<Segment>,
    verdict: Verdict,
    until: f64,
}

/// When a line is in the image, and in the region.
#[derive(Debug, Clone, Copy)]
struct VisibleSpan {
    in_image: (f64, f64),
    in_region: (f64, f64),
}

/// The part of a walk in one square of cells that are alike, or in one cell that an edge crosses.
#[derive(Debug)]
struct Segment {
    cells: Rect,
    leave: CellExit,
    /// Whether the next cell surely lies in the region too.
    stays_in_region: bool,
    /// Crossings of one half still ahead in the cell, the last one first.
    crossings: [Option<f64>; 2],
}

impl<'a> MaskTraversal<'a> {
    pub(in crate::hull) fn new(
        view: &'a View,
        origin: &Point3<f64>,
        direction: &Vector3<f64>,
        edge: EdgeModel,
    ) -> Self {
        let line = ImageLine::new(view.homogeneous(origin), view.homogeneous_direction(direction));
        Self::from_start(view, line, edge)
    }

    /// The walk along a line whose image is known.
    pub(in crate::hull) fn from_start(view: &'a View, line: ImageLine, edge: EdgeModel) -> Self {
        let mut march = Self::before_start(view, line, edge);
        march.resume_at(0.0);
        march
    }

    /// The walk from where it enters cell `(i, j)`, `t` metres on; so far it has been inside.
    pub(in crate::hull) fn from_cell(
        view: &'a View,
        line: ImageLine,
        (i, j): (i32, i32),
        t: f64,
        edge: EdgeModel,
    ) -> Self {
        let mut march = Self::before_start(view, line, edge);
        march.enter_cell(i, j, t);
        march
    }

    fn before_start(view: &'a View, line: ImageLine, edge: EdgeModel) -> Self {
        let silhouette = view.silhouette();
        let by_coverage = edge == EdgeModel::Coverage && silhouette.has_coverage();
        let shift = if by_coverage { 0.5 } else { 0.0 };
        // Pixels that a lens did not see lie anywhere in the image, so that there the whole image has to be walked.
        let region = if view.blind_spots().is_some() { silhouette.image() } else { silhouette.rect() };
        let (verdict, until) = (Verdict::Unseen, 0.0);
        Self { view, line, shift, region, visible_span: None, segment: None, verdict, until }
    }

    fn visible_span(&mut self) -> VisibleSpan {
        *self.visible_span.get_or_insert_with(|| {
            let never = (f64::INFINITY, f64::INFINITY);
            let in_image = within(&self.line, &self.view.silhouette().image(), 0.0).unwrap_or(never);
            let in_region = within(&self.line, &self.region, self.shift)
                .map(|(t0, t1)| (t0.max(in_image.0), t1.min(in_image.1)));
            let in_region = in_region.filter(|(t0, t1)| t0 < t1).unwrap_or((in_image.1, in_image.1));
            VisibleSpan { in_image, in_region }
        })
    }

    pub(in crate::hull) fn view(&self) -> &'a View {
        self.view
    }

    /// What the view says from the last step on.
    pub(in crate::hull) fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// The verdict holds up to this `t`, and may change there.
    pub(in crate::hull) fn until(&self) -> f64 {
        self.until
    }

    /// Goes on as long as the verdict is inside: where it began to be another, at most `limit`; `from` where it is from the
    /// start.
    pub(in crate::hull) fn advance_until_exit(&mut self, from: f64, limit: f64) -> f64 {
        let mut left = from;
        while self.verdict == Verdict::Inside && self.until < limit {
            left = self.until;
            self.step();
        }
        if self.verdict == Verdict::Inside { limit } else { left.min(limit) }
    }

    /// Goes on to what holds after `until`.
    pub(in crate::hull) fn step(&mut self) {
        let t = self.until;
        match self.segment.take() {
            Some(walk) if walk.crossings[0].is_some() => {
                self.verdict =
                    if self.verdict == Verdict::Inside { Verdict::Outside } else { Verdict::Inside };
                let walk = Segment { crossings: [walk.crossings[1], None], ..walk };
                self.until = walk.crossings[0].unwrap_or(walk.leave.t);
                self.segment = Some(walk);
            }
            Some(walk) if walk.stays_in_region || t < self.visible_span().in_region.1 => {
                let (i, j) = self.line.entered(&walk.leave, &walk.cells, self.shift);
                self.enter_cell(i, j, t);
            }
            Some(_) => {
                let end = self.visible_span().in_region.1;
                self.resume_at(end);
            }
            None => self.resume_at(t),
        }
    }

    /// Takes the walk up at `t` by position alone.
    fn resume_at(&mut self, t: f64) {
        let VisibleSpan { in_image, in_region } = self.visible_span();
        let mut rest = |verdict, until| (self.verdict, self.until) = (verdict, until);
        if t < in_image.0 {
            rest(Verdict::Unseen, in_image.0);
        } else if t < in_region.0 {
            rest(Verdict::Outside, in_region.0);
        } else if t < in_region.1 {
            let (u, v) = self.line.at(t);
            self.start_at(u, v, t);
        } else if t < in_image.1 {
            rest(Verdict::Outside, in_image.1);
        } else {
            rest(Verdict::Unseen, f64::INFINITY);
        }
    }

    /// Starts in the cell of image position `(u, v)`.
    fn start_at(&mut self, u: f64, v: f64, t: f64) {
        let image = self.view.silhouette().image();
        // Where a line enters the image, rounding may leave it beyond the border. No pixel is there; the first square
        // between pixel centres begins half a pixel before.
        let first = if self.shift == 0.0 { 0 } else { -1 };
        let cell = |x: f64, count: i32| floor(x - self.shift).clamp(first, count - 1);
        self.enter_cell(cell(u, image.x1), cell(v, image.y1), t);
    }

    fn enter_cell(&mut self, i: i32, j: i32, t: f64) {
        let (verdict, half) = self.cell_verdict(i, j);
        let cells = Rect::window(i, j, half);
        let mut leave = self.line.leave(&cells, self.shift, t);
        let goes_on = self.stays_in_region(&cells, leave.t);
        if !goes_on {
            leave.t = leave.t.min(self.visible_span().in_region.1);
        }
        let mut crossings = [None, None];
        self.verdict = match verdict {
            Some(verdict) => verdict,
            None => {
                let starts_inside;
                (starts_inside, crossings) = self.crossings(i, j, t, leave.t);
                if starts_inside { Verdict::Inside } else { Verdict::Outside }
            }
        };
        self.until = crossings[0].unwrap_or(leave.t);
        self.segment = Some(Segment { cells, leave, stays_in_region: goes_on, crossings });
    }

    /// Whether the line, as it leaves `cells` at `t`, surely stays in the region for a pixel more, and before the
    /// camera: then it need not be asked when exactly it leaves that.
    fn stays_in_region(&self, cells: &Rect, t: f64) -> bool {
        let region = &self.region;
        let inner =
            cells.x0 > region.x0 && cells.x1 < region.x1 && cells.y0 > region.y0 && cells.y1 < region.y1;
        inner && t < f64::INFINITY && self.line.depth(t) > 2.0 * MIN_DEPTH
    }

    /// The verdict of cell `(i, j)`, `None` where an edge crosses it, and the half-width of the square around it in
    /// which the verdict is the same.
    fn cell_verdict(&self, i: i32, j: i32) -> (Option<Verdict>, i32) {
        let silhouette = self.view.silhouette();
        if !self.view.judges(i.max(0), j.max(0)) && self.view.blind_spots().is_some() {
            return (Some(Verdict::Unseen), 0);
        }
        let distances = |i: i32, j: i32| i32::from(silhouette.distance(i, j));
        let (nearest, farthest) = if self.shift == 0.0 {
            (distances(i, j), distances(i, j))
        } else {
            let corners =
                [distances(i, j), distances(i + 1, j), distances(i, j + 1), distances(i + 1, j + 1)];
            (corners.into_iter().min().unwrap_or(0), corners.into_iter().max().unwrap_or(0))
        };
        if nearest > 0 {
            let seen =
                self.view.blind_spots().map_or(i32::MAX, |seen| i32::from(seen.distance(i.max(0), j.max(0))));
            (Some(Verdict::Inside), nearest.min(seen) - 1)
        } else if farthest == 0 {
            (Some(Verdict::Outside), 0)
        } else {
            (None, 0)
        }
    }

    /// Whether the walk from `t0` to `t1` through the bilinear cell `(i, j)` starts inside, and where it then
    /// crosses one half: along a straight line the coverage is a quadratic.
    fn crossings(&self, i: i32, j: i32, t0: f64, t1: f64) -> (bool, [Option<f64>; 2]) {
        let [c00, c10, c01, c11] = self.view.silhouette().cell(i, j);
        let local = |t: f64| {
            let (u, v) = self.line.at(t);
            (u - self.shift - f64::from(i), v - self.shift - f64::from(j))
        };
        let ((xa, ya), (xb, yb)) = (local(t0), local(t1));
        let (dx, dy) = (xb - xa, yb - ya);
        let (right, down, twist) = (c10 - c00, c01 - c00, c00 - c10 - c01 + c11);
        let start = c00 + right * xa + down * ya + twist * xa * ya - HALF_COVERAGE;
        let slope = (right + twist * ya) * dx + (down + twist * xa) * dy;
        let bend = twist * dx * dy;
        let when = |s: f64| {
            let t = if dx.abs() > dy.abs() {
                self.line.at_column(f64::from(i) + self.shift + xa + s * dx)
            } else {
                self.line.at_row(f64::from(j) + self.shift + ya + s * dy)
            };
            t.clamp(t0, t1)
        };
        let roots = roots_within_unit(start, slope, bend);
        // The sign before the first crossing, taken where it is largest: halfway there.
        let s = 0.5 * roots[0].unwrap_or(1.0);
        let starts_inside = start + s * (slope + s * bend) >= 0.0;
        (starts_inside, roots.map(|root| root.map(when)))
    }
}

/// When the image of `line` lies in `cells` grown by half a pixel where cells are shifted, in front of the camera.
fn within(line: &ImageLine, cells: &Rect, shift: f64) -> Option<(f64, f64)> {
    let low = (f64::from(cells.x0) - shift, f64::from(cells.y0) - shift);
    let high = (f64::from(cells.x1) + shift, f64::from(cells.y1) + shift);
    if cells.is_empty() { None } else { line.interval(MIN_DEPTH, low, high) }
}

/// The sign changes of `c + b s + a s^2` in `0 < s < 1`, in order.
fn roots_within_unit(c: f64, b: f64, a: f64) -> [Option<f64>; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant <= 0.0 {
        return [None, None];
    }
    // The stable pair: no cancellation between b and the root.
    let q = -0.5 * (b + b.signum() * discriminant.sqrt());
    let inside = |s: f64| (s > 0.0 && s < 1.0).then_some(s);
    let (r1, r2) = (inside(q / a), inside(c / q));
    match (r1, r2) {
        (Some(x), Some(y)) => [Some(x.min(y)), Some(x.max(y))],
        (root, None) | (None, root) => [root, None],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::tests::{Random, cameras};
    use crate::silhouette::{Border, Silhouette};
    use image::{GrayImage, Luma};
    use std::sync::Arc;

    #[test]
    fn a_line_that_enters_the_image_at_an_open_border_starts_in_its_first_pixel() {
        // Subject in the first column, and one pixel far off.
        let mask =
            GrayImage::from_fn(160, 120, |i, j| Luma([if i == 0 || (i, j) == (50, 60) { 255 } else { 0 }]));
        let (camera, silhouette) = (cameras().swap_remove(0), Silhouette::new(&mask, Border::Unknown));
        let view = View::new(Arc::new(camera), Arc::new(silhouette), None);
        let mut random = Random(5);
        for _ in 0..300 {
            let row = 1.0 + 118.0 * random.unit();
            let mut place = |u: f64| view.camera().unproject(u, row, 1.0 + random.unit());
            let (Some(from), Some(to)) = (place(-20.0), place(40.0)) else { panic!("a pinhole sees both") };
            let mut march = MaskTraversal::new(&view, &from, &(to - from).normalize(), EdgeModel::Pixel);
            assert_eq!(march.verdict(), Verdict::Unseen);
            march.step();
            assert_eq!(march.verdict(), Verdict::Inside);
            let left = march.advance_until_exit(0.0, f64::INFINITY);
            let u = march.line.at(left).0;
            assert!((u - 1.0).abs() < 1e-9, "left at column {u}, entered in row {row}");
        }
    }

    #[test]
    fn roots_are_the_sign_changes_in_order() {
        assert_eq!(roots_within_unit(-1.0, 2.0, 0.0), [Some(0.5), None]);
        assert_eq!(roots_within_unit(1.0, -2.0, 0.0), [Some(0.5), None]);
        assert_eq!(roots_within_unit(3.0, -16.0, 16.0), [Some(0.25), Some(0.75)]);
        assert_eq!(roots_within_unit(1.0, 0.0, 1.0), [None, None]);
        assert_eq!(roots_within_unit(1.0, 0.0, 0.0), [None, None]);
    }
}
