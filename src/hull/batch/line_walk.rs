//! The traversal of many lines side by side, each through the silhouette of one view.
//!
//! A step is that of [`MaskTraversal`]: from the entered cell to the side of the largest square of subject cells around
//! it. A line ends in background, at an edge that crosses its cell, or at `t_max`; in rare cases [`MaskTraversal`]
//! finishes it. Most lines end after two steps, and new ones take their lanes.

use super::Wide;
use super::image_lines::ImageLines;
use super::projection::ViewKernel;
use crate::camera::{ImageLine, MIN_DEPTH, border_ahead};
use crate::hull::query::MaskTraversal;
use crate::math::lanes::{floor, index, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;
use crate::math::vectorised;
use crate::silhouette::HALF_COVERAGE;
use nalgebra::Vector3;

/// At this number of lines or fewer, finishing them one by one is faster than further steps of all lanes.
const SCALAR_BELOW: usize = 4;

/// Where a line first crosses one half in a cell that an edge crosses.
enum Crossing {
    /// At this `t`, in metres: where the line enters the cell, if it is outside there.
    At(f64),
    /// Nowhere: the line stays inside.
    None,
    /// Not computed here: the cell is on the rim, or the line leaves it near the camera, or never.
    Unknown,
}

/// Lines that are being traversed, one a lane, each in one view.
#[derive(Debug, Default)]
pub(super) struct RayQueue {
    lines: ImageLines,
    /// Index of the kernel of each line's view.
    place: [u32; LANES],
    /// The kernel's `shift`, copied for the steps.
    shift: Wide,
    /// The kernel's `stride`, copied for the steps.
    stride: Wide,
    /// The kernel's `origin`, copied for the steps.
    origin: Wide,
    /// Bit mask of the lanes that hold a line.
    used: u32,
}

/// The nearest exit of each ray so far.
#[derive(Debug)]
pub(super) struct NearestExits<'a> {
    /// In metres.
    pub(super) exits: &'a mut [f64],
    /// Index of the kernel of the view that gave each exit.
    pub(super) deciders: &'a mut [u32],
}

impl RayQueue {
    /// Prepares the queue, which is empty, for other kernels.
    pub(super) fn restart(&mut self) {
        // Lanes without a line take part in every step, and so need a valid index.
        self.place = [0; LANES];
    }

    /// Adds the `lines` in the bit mask `which`, in the view of the kernel at `place`, and traverses whenever all lanes
    /// are taken. Lowers the exits of rays that leave.
    #[inline(always)]
    pub(super) fn push(
        &mut self,
        kernels: &[ViewKernel],
        place: usize,
        lines: &ImageLines,
        which: u32,
        nearest: &mut NearestExits,
    ) {
        for k in set_bits(which) {
            self.set(self.used.trailing_ones() as usize, &kernels[place], place, lines, k);
            if self.used == u32::MAX {
                trace_until(self, kernels, LANES - 1, nearest);
            }
        }
    }

    /// Traverses all remaining lines to their ends.
    pub(super) fn drain(&mut self, kernels: &[ViewKernel], nearest: &mut NearestExits) {
        trace_until(self, kernels, SCALAR_BELOW, nearest);
        for k in set_bits(self.used) {
            let exit = self.lines.finish_scalar(k, &kernels[self.place[k] as usize]);
            nearest.lower(self.lines.point[k] as usize, exit, self.place[k]);
        }
        self.used = 0;
    }
}

vectorised! {
    /// Traverses until at most `remaining` lines are left.
    fn trace_until(queue: &mut RayQueue, kernels: &[ViewKernel], remaining: usize, nearest: &mut NearestExits) {
        while queue.used.count_ones() > remaining as u32 {
            let mut ended = queue.step(kernels) & queue.used;
            ended &= !queue.cross_edges(ended, kernels);
            queue.write_exits(ended, kernels, nearest);
            queue.used &= !ended;
        }
    }
}

impl RayQueue {
    /// Sets lane k to line j of `lines`, in the view of the kernel at `place`.
    #[inline(always)]
    fn set(&mut self, k: usize, kernel: &ViewKernel, place: usize, lines: &ImageLines, j: usize) {
        self.lines.copy_lane(k, lines, j);
        self.place[k] = place as u32;
        (self.shift[k], self.stride[k], self.origin[k]) = (kernel.shift, kernel.stride, kernel.origin);
        self.used |= 1 << k;

        if kernel.by_coverage {
            // The cell begins at the centre of the start's pixel, or of the pixel before.
            let cell = |x: f64, pixel: f64| select(x - kernel.shift < pixel, pixel - 1.0, pixel);
            let (u, v) = lines.position(j);
            let (column, row) = (cell(u, lines.column[j]), cell(v, lines.row[j]));
            (self.lines.column[k], self.lines.row[k]) = (column, row);
            let at = index(row * kernel.stride + column + kernel.origin);
            self.lines.distance[k] = kernel.cell_distance_at(at);
        }
    }

    /// Updates the distances of the lines' cells to the background.
    #[inline(always)]
    fn find_distances(&mut self, kernels: &[ViewKernel]) {
        let (ImageLines { column, row, distance, .. }, mut places) = (&mut self.lines, [0; LANES]);
        for k in 0..LANES {
            places[k] = index(row[k] * self.stride[k] + column[k] + self.origin[k]);
        }
        for k in 0..LANES {
            distance[k] = kernels[self.place[k] as usize].cell_distance_at(places[k]);
        }
    }

    /// Steps all lines. Returns a bit mask of the lines that have ended: in background or in a cell that an edge
    /// crosses, at `t_max`, or where they cannot step because the camera is near.
    ///
    /// No bounds test is needed: the margin around the silhouette's rectangle is background, where a line ends.
    #[inline(always)]
    fn step(&mut self, kernels: &[ViewKernel]) -> u32 {
        let mut continues = [0; LANES];
        for k in 0..LANES {
            continues[k] = u32::from(self.lines.advance(k, self.shift[k]));
        }
        self.find_distances(kernels);
        let ImageLines { distance, t, t_max, .. } = &self.lines;
        for k in 0..LANES {
            continues[k] &= u32::from((distance[k] > 0.0) & (t[k] < t_max[k]));
        }
        !lane_mask(&continues)
    }

    /// Searches the cells of the lines in the bit mask `ended` for a crossing of one half, where an edge crosses the
    /// cell, and moves the line there. Returns a bit mask of the lines whose cells have none, which continue.
    #[inline(always)]
    fn cross_edges(&mut self, ended: u32, kernels: &[ViewKernel]) -> u32 {
        let (lines, mut continuing) = (&mut self.lines, 0);
        for k in set_bits(ended) {
            // Only a line that has ended in a cell by coverage, before its limit.
            let kernel = &kernels[self.place[k] as usize];
            if !kernel.by_coverage || lines.distance[k] > 0.0 || lines.t[k] >= lines.t_max[k] {
                continue;
            }

            let crossing = if kernel.is_on_rim(lines.column[k], lines.row[k]) {
                Crossing::Unknown
            } else {
                lines.crossing(k, &kernel.cell_corners(lines.column[k], lines.row[k]), kernel.shift)
            };

            match crossing {
                Crossing::At(t) => lines.t[k] = t,
                // A positive distance makes `write_exits` finish the line on its own.
                Crossing::Unknown => lines.distance[k] = 1.0,
                Crossing::None => {
                    lines.distance[k] = 1.0;
                    continuing |= 1 << k;
                }
            }
        }

        continuing
    }

    /// Lowers the exits of the rays whose lines, in the bit mask `ended`, have ended before `t_max`.
    #[inline(always)]
    fn write_exits(&self, ended: u32, kernels: &[ViewKernel], nearest: &mut NearestExits) {
        let lines = &self.lines;
        for k in set_bits(ended) {
            if lines.t[k] >= lines.t_max[k] {
                continue;
            }
            let mut exit = lines.t[k];
            if lines.distance[k] > 0.0 {
                exit = lines.finish_scalar(k, &kernels[self.place[k] as usize]);
            }
            nearest.lower(lines.point[k] as usize, exit, self.place[k]);
        }
    }
}

impl NearestExits<'_> {
    /// Lowers the exit of a ray to `exit`, which the view of the kernel at `place` gives, if that is nearer.
    #[inline(always)]
    fn lower(&mut self, point: usize, exit: f64, place: u32) {
        if exit < self.exits[point] {
            (self.exits[point], self.deciders[point]) = (exit, place);
        }
    }
}

impl ImageLines {
    /// Moves line k to the side of the square of subject cells around it, into the next cell. Returns whether it could.
    #[inline(always)]
    fn advance(&mut self, k: usize, shift: f64) -> bool {
        let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
        let [x1, y1, z1] = [self.direction[0][k], self.direction[1][k], self.direction[2][k]];

        // The nearer of the crossings with the two sides ahead.
        let half = self.distance[k] - 1.0;
        let (left, above) = (self.column[k] - half, self.row[k] - half);
        let (right, below) = (self.column[k] + half + 1.0, self.row[k] + half + 1.0);
        let (rightward, downward) = (x1 * z0 - x0 * z1, y1 * z0 - y0 * z1);
        let (rightwards, downwards) = (rightward > 0.0, downward > 0.0);
        let (column, row) = (select(rightwards, right, left), select(downwards, below, above));
        let by_column = border_ahead(column + shift, [x0, z0], [x1, z1], rightward);
        let by_row = border_ahead(row + shift, [y0, z0], [y1, z1], downward);
        let first = by_column <= by_row;
        let t = select(first, by_column, by_row);
        let t = select(t > self.t[k], t, self.t[k]);

        // The test for a camera that is near uses the part of the line up to `t_max`, which lies in the work volume.
        let z = z0 + z1 * select(t < self.t_max[k], t, self.t_max[k]);
        let is_going = (self.distance[k] > 0.0) & (self.t[k] < self.t_max[k]) & (z > 2.0 * MIN_DEPTH);

        // The side fixes one coordinate of the next cell; the position of the line gives the other.
        let beside = select(first, y0 + y1 * t, x0 + x1 * t) / z - shift;
        let cell = within(beside, select(first, above, left), select(first, below, right));
        let i = select(first, select(rightwards, column, column - 1.0), cell);
        let j = select(first, cell, select(downwards, row, row - 1.0));

        self.column[k] = select(is_going, i, self.column[k]);
        self.row[k] = select(is_going, j, self.row[k]);
        self.t[k] = select(is_going, t, self.t[k]);
        is_going
    }

    /// Where line k first crosses one half in its bilinear cell with the values `corners`, with the arithmetic of
    /// [`MaskTraversal`].
    #[inline(always)]
    fn crossing(&self, k: usize, corners: &[f64; 4], shift: f64) -> Crossing {
        let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
        let [x1, y1, z1] = [self.direction[0][k], self.direction[1][k], self.direction[2][k]];
        let (i, j, t0) = (self.column[k], self.row[k], self.t[k]);
        let by_column = |u: f64| (u * z0 - x0) / (x1 - u * z1);
        let by_row = |v: f64| (v * z0 - y0) / (y1 - v * z1);

        // Where the line leaves the cell.
        let (rightward, downward) = (x1 * z0 - x0 * z1, y1 * z0 - y0 * z1);
        let (column, row) = (select(rightward > 0.0, i + 1.0, i), select(downward > 0.0, j + 1.0, j));
        let t_column = border_ahead(column + shift, [x0, z0], [x1, z1], rightward);
        let t_row = border_ahead(row + shift, [y0, z0], [y1, z1], downward);
        let t1 = select(t_column <= t_row, t_column, t_row);
        let t1 = select(t1 > t0, t1, t0);
        if t1 == f64::INFINITY || z0 + z1 * t1 <= 2.0 * MIN_DEPTH {
            return Crossing::Unknown;
        }

        // Along a straight line the coverage is c + b s + a s^2, from s = 0 as it enters to 1 as it leaves.
        let local = |x0: f64, x1: f64, cell: f64, t: f64| (x0 + x1 * t) / (z0 + z1 * t) - shift - cell;
        let (xa, ya) = (local(x0, x1, i, t0), local(y0, y1, j, t0));
        let (dx, dy) = (local(x0, x1, i, t1) - xa, local(y0, y1, j, t1) - ya);
        let [c00, c10, c01, c11] = *corners;
        let (right, down, twist) = (c10 - c00, c01 - c00, c00 - c10 - c01 + c11);
        let c = c00 + right * xa + down * ya + twist * xa * ya - HALF_COVERAGE;
        let b = (right + twist * ya) * dx + (down + twist * xa) * dy;
        let a = twist * dx * dy;
        let discriminant = b * b - 4.0 * a * c;
        let q = -0.5 * (b + 1.0_f64.copysign(b) * discriminant.sqrt());
        let root = |s: f64| select((discriminant > 0.0) & (s > 0.0) & (s < 1.0), s, f64::INFINITY);
        let (r1, r2) = (root(q / a), root(c / q));
        let s = select(r1 < r2, r1, r2);

        // The sign before the crossing, evaluated halfway to it: away from the roots.
        let halfway = 0.5 * select(s < 1.0, s, 1.0);
        if c + halfway * (b + halfway * a) < 0.0 {
            return Crossing::At(t0);
        }
        if s >= 1.0 {
            return Crossing::None;
        }

        // From s to t, by the coordinate that changes faster.
        let (u, v) = (i + shift + xa + s * dx, j + shift + ya + s * dy);
        let t = if dx.abs() > dy.abs() { by_column(u) } else { by_row(v) };
        Crossing::At(select(t > t0, select(t > t1, t1, t), t0))
    }

    /// The exit of line k, by the single query's traversal from its current cell; infinite if not before `t_max`.
    fn finish_scalar(&self, k: usize, kernel: &ViewKernel) -> f64 {
        let (t, t_max) = (self.t[k], self.t_max[k]);
        let cell = (self.column[k] as i32, self.row[k] as i32);
        let mut traversal =
            MaskTraversal::from_cell(kernel.view.silhouette(), self.line(k), cell, t, kernel.edge);
        let exit = traversal.advance_until_exit(t, t_max);
        if exit < t_max { exit } else { f64::INFINITY }
    }

    fn line(&self, k: usize) -> ImageLine {
        let vector = |of: &[Wide; 3]| Vector3::from(of.map(|of| of[k]));
        ImageLine::new(vector(&self.start), vector(&self.direction))
    }
}

/// The cell of position `x`, clamped to the cells from `first` to one before `end`.
#[inline(always)]
fn within(x: f64, first: f64, end: f64) -> f64 {
    let x = select(x > first, x, first);
    floor(select(x < end - 0.5, x, end - 0.5))
}
