//! Many lines in one view, which points inside follow as they leave: where they start, and how far the view surely sees
//! subject along them.

use super::Wide;
use super::projection::ViewKernel;
use crate::camera::MIN_DEPTH;
use crate::math::lanes::{floor, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;

/// Where points are, and where they go.
#[derive(Debug, Clone, Copy)]
pub(super) struct RayBlock {
    pub(super) point: [Wide; 3],
    pub(super) direction: [Wide; 3],
    /// The place of each point's first view among the kernels.
    pub(super) first: [u32; LANES],
    /// How many points are no filling.
    pub(super) count: usize,
}

impl RayBlock {
    pub(super) fn empty(count: usize) -> Self {
        Self { point: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3], first: [0; LANES], count }
    }
}

/// Lines in one view: where they are at `t` metres is `start + t ahead`, in homogeneous image coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct ImageLines {
    /// The places of the points that walk them.
    pub(super) point: [u32; LANES],
    pub(super) start: [Wide; 3],
    pub(super) direction: [Wide; 3],
    /// The cell that each is in, when it entered it, and its distance to background. Cells are pixels; where the view's
    /// edge is taken inside pixels, the squares between four pixel centres, once a line sets out.
    pub(super) column: Wide,
    pub(super) row: Wide,
    pub(super) distance: Wide,
    pub(super) t: Wide,
    /// In metres: another view has given a nearer exit, or this view may lose sight of the line.
    pub(super) t_max: Wide,
    /// Where each starts in the image; not taken over from others.
    u: Wide,
    v: Wide,
}

impl Default for ImageLines {
    fn default() -> Self {
        let (vector, lane) = ([[0.0; LANES]; 3], [0.0; LANES]);
        Self {
            point: [0; LANES],
            start: vector,
            direction: vector,
            column: lane,
            row: lane,
            distance: lane,
            t: lane,
            t_max: lane,
            u: lane,
            v: lane,
        }
    }
}

impl ImageLines {
    /// Begins at the points of `block`, all of them inside: in the pixel where the view sees each. Which points it sees;
    /// `sight_ends` come down to where that may change.
    #[inline(always)]
    pub(super) fn project(&mut self, kernel: &ViewKernel, block: &RayBlock, sight_ends: &mut [f64]) -> u32 {
        let ([x, y, z], [dx, dy, dz]) = (&block.point, &block.direction);
        for (axis, row) in kernel.p.iter().enumerate() {
            for k in 0..LANES {
                self.start[axis][k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k] + row[3];
                self.direction[axis][k] = row[0] * dx[k] + row[1] * dy[k] + row[2] * dz[k];
            }
        }
        for k in 0..LANES {
            let [x, y, depth] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            (self.u[k], self.v[k]) = (x / depth, y / depth);
            (self.column[k], self.row[k], self.t[k]) = (floor(self.u[k]), floor(self.v[k]), 0.0);
        }
        let visible = if kernel.is_closed { u32::MAX } else { self.limit_to_sight(kernel, sight_ends) };
        kernel.find_distances(&self.column, &self.row, 0.0, &mut self.distance);
        visible
    }

    /// Ends lines where the view may lose sight of them; which it sees as they start. `sight_ends` come down to there,
    /// and to where it may come to see the others.
    #[inline(always)]
    fn limit_to_sight(&mut self, kernel: &ViewKernel, sight_ends: &mut [f64]) -> u32 {
        let [width, height] = kernel.size;
        let (mut low, mut high): ([Wide; 2], [Wide; 2]) =
            ([[0.0; LANES]; 2], [[width; LANES], [height; LANES]]);
        let mut visible = [0; LANES];
        for k in 0..LANES {
            let within = (self.column[k] >= 0.0) & (self.column[k] < width);
            let within = within & (self.row[k] >= 0.0) & (self.row[k] < height);
            visible[k] = u32::from(within & (self.start[2][k] > MIN_DEPTH));
        }
        let mut visible = lane_mask(&visible);
        if let Some(field_of_view) = kernel.view.blind_spots() {
            for k in set_bits(visible) {
                let (i, j) = (self.column[k], self.row[k]);
                let reach = f64::from(field_of_view.distance(i as i32, j as i32)) - 1.0;
                if reach < 0.0 {
                    visible &= !(1 << k);
                    continue;
                }
                // Around a pixel that the lens sees, it sees a square.
                for (axis, pixel) in [(0, i), (1, j)] {
                    low[axis][k] = low[axis][k].max(pixel - reach);
                    high[axis][k] = high[axis][k].min(pixel + reach + 1.0);
                }
            }
        }

        for k in 0..LANES {
            let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            let [x1, y1, z1] = [self.direction[0][k], self.direction[1][k], self.direction[2][k]];
            let ([u0, v0], [u1, v1]) = ([low[0][k], low[1][k]], [high[0][k], high[1][k]]);
            // Times the depth each side of what is seen is linear in t: seen where no `constant + slope t` is negative.
            let sides = [
                (z0 - MIN_DEPTH, z1),
                (x0 - u0 * z0, x1 - u0 * z1),
                (u1 * z0 - x0, u1 * z1 - x1),
                (y0 - v0 * z0, y1 - v0 * z1),
                (v1 * z0 - y0, v1 * z1 - y1),
            ];
            let (mut leaves, mut enters) = (f64::INFINITY, 0.0);
            for (constant, slope) in sides {
                let t = -constant / slope;
                leaves = select((slope < 0.0) & (t < leaves), t, leaves);
                let beyond_until = select(slope > 0.0, t, f64::INFINITY);
                enters = select((constant < 0.0) & (beyond_until > enters), beyond_until, enters);
            }
            let is_visible = visible >> k & 1 != 0;
            let leaves = select(kernel.may_lose_sight, leaves, f64::INFINITY);
            // A little sooner, for rounding.
            let end = select(is_visible, leaves, enters) * (1.0 - 1e-9);
            self.t_max[k] = select(is_visible & (end < self.t_max[k]), end, self.t_max[k]);
            let sight_end = &mut sight_ends[self.point[k] as usize];
            *sight_end = select(end < *sight_end, end, *sight_end);
        }
        visible
    }

    /// Which lines the view surely sees inside up to their limits: those ends lie in the square of subject pixels
    /// around the start, and so does all between, since a line's image is straight.
    #[inline(always)]
    pub(super) fn stay_inside(&self, kernel: &ViewKernel) -> u32 {
        let (rim, mut stays, [x, y, z], [dx, dy, dz]) =
            (kernel.rim(), [0; LANES], &self.start, &self.direction);
        for k in 0..LANES {
            let (reach, t) = (self.distance[k] - rim, self.t_max[k]);
            let (end_x, end_y, end_z) = (x[k] + dx[k] * t, y[k] + dy[k] * t, z[k] + dz[k] * t);
            let (du, dv) = (end_x - (self.column[k] + 0.5) * end_z, end_y - (self.row[k] + 0.5) * end_z);
            // Both sides times the depth.
            let near = (du.abs() < reach * end_z) & (dv.abs() < reach * end_z);
            stays[k] = u32::from((end_z > 0.0) & near & (reach > 0.0));
        }
        lane_mask(&stays)
    }

    /// Which lines the view surely sees inside up to their limits, since the squares of subject pixels around their starts
    /// and ends meet: an image that is straight lies in the one until it is in the other.
    #[inline(always)]
    pub(super) fn end_inside(&self, kernel: &ViewKernel) -> u32 {
        let rim = kernel.rim();
        let (mut column, mut row, mut end_distance) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let (mut longest, mut offsets, mut in_rect) = ([0.0; LANES], [[0.0; LANES]; 2], [0; LANES]);
        for k in 0..LANES {
            let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            let [x1, y1, z1] = [self.direction[0][k], self.direction[1][k], self.direction[2][k]];
            let t = self.t_max[k];
            let (x, y, z) = (x0 + x1 * t, y0 + y1 * t, z0 + z1 * t);
            let (u0, v0, u1, v1) = (self.u[k], self.v[k], x / z, y / z);
            let in_columns = (u1 >= kernel.low[0]) & (u1 < kernel.high[0]);
            let in_rows = (v1 >= kernel.low[1]) & (v1 < kernel.high[1]);
            let is_in_rect = in_columns & in_rows & (z > MIN_DEPTH);
            in_rect[k] = u32::from(is_in_rect);
            (column[k], row[k]) =
                (floor(select(is_in_rect, u1, kernel.low[0])), floor(select(is_in_rect, v1, kernel.low[1])));

            // How far the start lies ahead of its pixel's centre, and the end behind its own, along either axis.
            let along = |by: f64, offset: f64| select(by > 0.0, offset, -offset);
            let (du, dv) = (u1 - u0, v1 - v0);
            let (start_u, start_v) = (u0 - 0.5 - self.column[k], v0 - 0.5 - self.row[k]);
            let (end_u, end_v) = (column[k] + 0.5 - u1, row[k] + 0.5 - v1);
            offsets[0][k] = larger(along(du, start_u), along(dv, start_v));
            offsets[1][k] = larger(along(du, end_u), along(dv, end_v));
            longest[k] = larger(du.abs(), dv.abs());
        }
        kernel.find_distances(&column, &row, 0.0, &mut end_distance);
        let mut stays = [0; LANES];
        for k in 0..LANES {
            let from_start = self.distance[k] - rim - offsets[0][k];
            let from_end = end_distance[k] - rim - offsets[1][k];
            let meet = longest[k] <= from_start + from_end;
            stays[k] = in_rect[k] & u32::from((from_start >= 0.0) & (from_end >= 0.0) & meet);
        }
        lane_mask(&stays)
    }

    /// Where line k starts in the image.
    #[inline(always)]
    pub(super) fn position(&self, k: usize) -> (f64, f64) {
        (self.u[k], self.v[k])
    }

    /// Line k is line j of `other`.
    #[inline(always)]
    pub(super) fn copy_lane(&mut self, k: usize, other: &Self, j: usize) {
        for axis in 0..3 {
            self.start[axis][k] = other.start[axis][j];
            self.direction[axis][k] = other.direction[axis][j];
        }
        (self.point[k], self.t[k], self.t_max[k]) = (other.point[j], other.t[j], other.t_max[j]);
        (self.column[k], self.row[k], self.distance[k]) = (other.column[j], other.row[j], other.distance[j]);
    }
}

impl ViewKernel<'_> {
    /// By how much the square of subject around a pixel's centre is smaller than its distance to the background.
    #[inline(always)]
    fn rim(&self) -> f64 {
        // Beyond the pixels' centres there may be an edge by coverage; the rest is far more than rounding.
        0.5 + self.shift + 1e-6
    }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    select(a > b, a, b)
}
