//! The traversal of one mask along the image of a half-line: where the verdict changes.
//!
//! ```text
//!      :   ....########....   :     one row of a mask; the line crosses it from left to right
//!   U  : O         I      O   : U   unseen, outside, inside
//! ```
//!
//! Inside the silhouette a step crosses the largest square of subject pixels, whose size the distance table gives.

use crate::camera::{CellExit, ImageLine, MIN_DEPTH, floor};
use crate::hull::{EdgeModel, Verdict};
use crate::silhouette::{HALF_COVERAGE, Rect, Silhouette};

/// The state of a traversal: the verdict that holds now, and up to which `t` it surely holds.
#[derive(Debug)]
pub(in crate::hull) struct MaskTraversal<'a> {
    silhouette: &'a Silhouette,
    line: ImageLine,
    /// Cells are pixels (0), or the squares between four pixel centres (one half).
    shift: f64,
    /// The crop: the part of the image in which the verdict may be other than outside.
    crop: Rect,
    /// The intervals in which the line is in the image and in the crop, computed when first needed.
    visible_span: Option<VisibleSpan>,
    segment: Option<Segment>,
    verdict: Verdict,
    until: f64,
}

/// The intervals of `t`, in metres, in which a line is in the image and in the crop.
#[derive(Debug, Clone, Copy)]
struct VisibleSpan {
    in_image: (f64, f64),
    in_crop: (f64, f64),
}

/// The part of a traversal in one square of cells with one verdict, or in one cell that an edge crosses.
#[derive(Debug)]
struct Segment {
    cells: Rect,
    leave: CellExit,
    /// Whether the next cell surely lies in the crop too.
    stays_in_crop: bool,
    /// The crossings of one half that lie ahead in the cell, the nearest first.
    crossings: [Option<f64>; 2],
}

impl<'a> MaskTraversal<'a> {
    /// The traversal of `silhouette` from the start of `line`.
    pub(super) fn from_start(silhouette: &'a Silhouette, line: ImageLine, edge: EdgeModel) -> Self {
        let mut traversal = Self::before_start(silhouette, line, edge);
        traversal.resume_at(0.0);
        traversal
    }

    /// The traversal from where the line enters cell `(i, j)`, at `t` metres.
    pub(in crate::hull) fn from_cell(
        silhouette: &'a Silhouette,
        line: ImageLine,
        (i, j): (i32, i32),
        t: f64,
        edge: EdgeModel,
    ) -> Self {
        let mut traversal = Self::before_start(silhouette, line, edge);
        traversal.enter_cell(i, j, t);
        traversal
    }

    /// A traversal that has not begun: the caller sets where.
    fn before_start(silhouette: &'a Silhouette, line: ImageLine, edge: EdgeModel) -> Self {
        let by_coverage = edge == EdgeModel::Coverage && silhouette.has_coverage();
        let shift = if by_coverage { 0.5 } else { 0.0 };
        let (crop, verdict, until) = (silhouette.rect(), Verdict::Unseen, 0.0);
        Self { silhouette, line, shift, crop, visible_span: None, segment: None, verdict, until }
    }

    fn visible_span(&mut self) -> VisibleSpan {
        *self.visible_span.get_or_insert_with(|| {
            let never = (f64::INFINITY, f64::INFINITY);
            let in_image = within(&self.line, &self.silhouette.image(), 0.0).unwrap_or(never);
            let in_crop = within(&self.line, &self.crop, self.shift)
                .map(|(t0, t1)| (t0.max(in_image.0), t1.min(in_image.1)));
            let in_crop = in_crop.filter(|(t0, t1)| t0 < t1).unwrap_or((in_image.1, in_image.1));
            VisibleSpan { in_image, in_crop }
        })
    }

    /// The verdict since the last step.
    pub(super) fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// The `t`, in metres, up to which the verdict surely holds.
    pub(super) fn until(&self) -> f64 {
        self.until
    }

    /// Steps until the verdict is no longer inside. Returns the `t` at which that changed, at most `limit`; it is
    /// `from` if the verdict is not inside to begin with.
    pub(in crate::hull) fn advance_until_exit(&mut self, from: f64, limit: f64) -> f64 {
        let mut exit = from;
        while self.verdict == Verdict::Inside && self.until < limit {
            exit = self.until;
            self.step();
        }
        if self.verdict == Verdict::Inside { limit } else { exit.min(limit) }
    }

    /// Advances to the verdict that holds after `until`.
    pub(super) fn step(&mut self) {
        let t = self.until;
        match self.segment.take() {
            // At a crossing of one half within the cell the verdict flips.
            Some(segment) if segment.crossings[0].is_some() => {
                self.verdict =
                    if self.verdict == Verdict::Inside { Verdict::Outside } else { Verdict::Inside };
                let segment = Segment { crossings: [segment.crossings[1], None], ..segment };
                self.until = segment.crossings[0].unwrap_or(segment.leave.t);
                self.segment = Some(segment);
            }

            // Into the next cell.
            Some(segment) if segment.stays_in_crop || t < self.visible_span().in_crop.1 => {
                let (i, j) = self.line.entered(&segment.leave, &segment.cells, self.shift);
                self.enter_cell(i, j, t);
            }

            // Out of the crop.
            Some(_) => {
                let end = self.visible_span().in_crop.1;
                self.resume_at(end);
            }

            // From outside the crop or the image.
            None => self.resume_at(t),
        }
    }

    /// Continues at `t` from the position of the line alone.
    fn resume_at(&mut self, t: f64) {
        let VisibleSpan { in_image, in_crop } = self.visible_span();
        let mut hold = |verdict, until| (self.verdict, self.until) = (verdict, until);

        if t < in_image.0 {
            hold(Verdict::Unseen, in_image.0);
        } else if t < in_crop.0 {
            hold(Verdict::Outside, in_crop.0);
        } else if t < in_crop.1 {
            let (u, v) = self.line.at(t);
            self.start_at(u, v, t);
        } else if t < in_image.1 {
            hold(Verdict::Outside, in_image.1);
        } else {
            hold(Verdict::Unseen, f64::INFINITY);
        }
    }

    /// Enters the cell at image position `(u, v)`, at `t` metres.
    fn start_at(&mut self, u: f64, v: f64, t: f64) {
        let image = self.silhouette.image();
        // Where a line enters the image, rounding may place it just beyond the border. There is no pixel; the first
        // square between pixel centres, however, begins half a pixel before the border.
        let first = if self.shift == 0.0 { 0 } else { -1 };
        let cell = |x: f64, count: i32| floor(x - self.shift).clamp(first, count - 1);
        self.enter_cell(cell(u, image.x1), cell(v, image.y1), t);
    }

    /// Enters cell `(i, j)` at `t` metres.
    fn enter_cell(&mut self, i: i32, j: i32, t: f64) {
        // The square of cells with one verdict, and where the line leaves it.
        let (verdict, half) = self.cell_verdict(i, j);
        let cells = Rect::window(i, j, half);
        let mut leave = self.line.leave(&cells, self.shift, t);
        let stays_in_crop = self.stays_in_crop(&cells, leave.t);
        if !stays_in_crop {
            leave.t = leave.t.min(self.visible_span().in_crop.1);
        }

        // In a cell that an edge crosses, the verdict changes at the crossings.
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
        self.segment = Some(Segment { cells, leave, stays_in_crop, crossings });
    }

    /// Whether the line, as it leaves `cells` at `t`, surely stays in the crop for one more pixel and in front of the
    /// camera. The visible span then need not be computed.
    fn stays_in_crop(&self, cells: &Rect, t: f64) -> bool {
        let crop = &self.crop;
        let is_inner = cells.x0 > crop.x0 && cells.x1 < crop.x1 && cells.y0 > crop.y0 && cells.y1 < crop.y1;
        is_inner && t < f64::INFINITY && self.line.depth(t) > 2.0 * MIN_DEPTH
    }

    /// The verdict of cell `(i, j)`, `None` if an edge crosses it, and the half-width of a square around it in which
    /// all cells have this verdict.
    fn cell_verdict(&self, i: i32, j: i32) -> (Option<Verdict>, i32) {
        // A pixel has one distance to the background, a square between pixel centres that of its four corners.
        let distances = |i: i32, j: i32| i32::from(self.silhouette.distance(i, j));
        let (nearest, farthest) = if self.shift == 0.0 {
            (distances(i, j), distances(i, j))
        } else {
            let corners =
                [distances(i, j), distances(i + 1, j), distances(i, j + 1), distances(i + 1, j + 1)];
            (corners.into_iter().min().unwrap_or(0), corners.into_iter().max().unwrap_or(0))
        };

        if nearest > 0 {
            (Some(Verdict::Inside), nearest - 1)
        } else if farthest == 0 {
            (Some(Verdict::Outside), 0)
        } else {
            (None, 0)
        }
    }

    /// Whether the line, between `t0` and `t1` in the bilinear cell `(i, j)`, starts inside, and where it then crosses
    /// one half. Along a straight line bilinear coverage is a quadratic.
    fn crossings(&self, i: i32, j: i32, t0: f64, t1: f64) -> (bool, [Option<f64>; 2]) {
        // Positions in the cell where the line enters it (a) and leaves it (b).
        let local = |t: f64| {
            let (u, v) = self.line.at(t);
            (u - self.shift - f64::from(i), v - self.shift - f64::from(j))
        };
        let ((xa, ya), (xb, yb)) = (local(t0), local(t1));
        let (dx, dy) = (xb - xa, yb - ya);

        // Coverage less one half is start + slope s + bend s^2, from s = 0 at a to 1 at b.
        let [c00, c10, c01, c11] = self.silhouette.cell(i, j);
        let (right, down, twist) = (c10 - c00, c01 - c00, c00 - c10 - c01 + c11);
        let start = c00 + right * xa + down * ya + twist * xa * ya - HALF_COVERAGE;
        let slope = (right + twist * ya) * dx + (down + twist * xa) * dy;
        let bend = twist * dx * dy;
        let roots = roots_within_unit(start, slope, bend);

        // From s to t, by the coordinate that changes faster.
        let when = |s: f64| {
            let t = if dx.abs() > dy.abs() {
                self.line.at_column(f64::from(i) + self.shift + xa + s * dx)
            } else {
                self.line.at_row(f64::from(j) + self.shift + ya + s * dy)
            };
            // Where rounding leaves no number, the crossing is anywhere in the cell.
            if t > t0 { t.min(t1) } else { t0 }
        };

        // The sign before the first crossing, evaluated halfway to it: away from the roots.
        let s = 0.5 * roots[0].unwrap_or(1.0);
        let starts_inside = start + s * (slope + s * bend) >= 0.0;
        (starts_inside, roots.map(|root| root.map(when)))
    }
}

/// The interval of `t` in which `line` lies in front of the camera and its image in `cells` grown by `shift` on every
/// side.
fn within(line: &ImageLine, cells: &Rect, shift: f64) -> Option<(f64, f64)> {
    let low = (f64::from(cells.x0) - shift, f64::from(cells.y0) - shift);
    let high = (f64::from(cells.x1) + shift, f64::from(cells.y1) + shift);
    if cells.is_empty() { None } else { line.interval(MIN_DEPTH, low, high) }
}

/// The sign changes of `c + b s + a s^2` in `0 < s < 1`, ascending.
fn roots_within_unit(c: f64, b: f64, a: f64) -> [Option<f64>; 2] {
    let discriminant = b * b - 4.0 * a * c;
    if discriminant <= 0.0 {
        return [None, None];
    }

    // The numerically stable formula, in which b and the root of the discriminant do not cancel.
    let q = -0.5 * (b + b.signum() * discriminant.sqrt());
    let inside = |s: f64| (s > 0.0 && s < 1.0).then_some(s);
    let (r1, r2) = (inside(q / a), inside(c / q));
    match (r1, r2) {
        (Some(x), Some(y)) => [Some(x.min(y)), Some(x.max(y))],
        (root, None) | (None, root) => [root, None],
    }
}

#[cfg(test)]
mod tests;
