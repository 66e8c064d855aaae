//! The images of many rays in one view: where they start, and how far the view surely sees subject along them.

use super::Wide;
use super::projection::ViewKernel;
use crate::camera::MIN_DEPTH;
use crate::math::lanes::{floor, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;

/// A block of rays from points inside.
#[derive(Debug, Clone, Copy)]
pub(super) struct RayBlock {
    pub(super) point: [Wide; 3],
    pub(super) direction: [Wide; 3],
    /// Index of the kernel of each ray's first view: the one that is likely to give the exit.
    pub(super) first: [u32; LANES],
    /// Number of rays; the lanes beyond are padding.
    pub(super) count: usize,
}

impl RayBlock {
    pub(super) fn empty(count: usize) -> Self {
        Self { point: [[0.0; LANES]; 3], direction: [[0.0; LANES]; 3], first: [0; LANES], count }
    }
}

/// The images of rays in one view: at `t` metres, `start + t direction` in homogeneous image coordinates.
#[derive(Debug, Clone, Copy)]
pub(super) struct ImageLines {
    /// Index of each line's ray.
    pub(super) point: [u32; LANES],
    pub(super) start: [Wide; 3],
    pub(super) direction: [Wide; 3],
    /// Column of the cell that each line is in. Cells are pixels; for views by coverage they become the squares between
    /// four pixel centres when a line enters the queue.
    pub(super) column: Wide,
    /// Row of the cell that each line is in.
    pub(super) row: Wide,
    /// Chebyshev distance of that cell to the background.
    pub(super) distance: Wide,
    /// Where each line entered that cell, in metres.
    pub(super) t: Wide,
    /// Where each line ends, in metres: another view has given a nearer exit, or this view may lose sight of it.
    pub(super) t_max: Wide,
    /// Column position of each start in the image; [`Self::copy_lane`] leaves it out.
    u: Wide,
    /// Row position of each start in the image; [`Self::copy_lane`] leaves it out.
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
    /// Sets the lines to the images of `block`, whose points are inside, each in the pixel of its start. Returns a bit
    /// mask of the points that the view sees, and lowers `sight_ends` to where that may change.
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

    /// Ends lines where the view may lose sight of them. Returns a bit mask of the lines whose starts it sees, and
    /// lowers `sight_ends` to where it may lose sight of these, or gain sight of the others.
    #[inline(always)]
    fn limit_to_sight(&mut self, kernel: &ViewKernel, sight_ends: &mut [f64]) -> u32 {
        let (visible, low, high) = self.visible_rects(kernel);

        for k in 0..LANES {
            let [x0, y0, z0] = [self.start[0][k], self.start[1][k], self.start[2][k]];
            let [x1, y1, z1] = [self.direction[0][k], self.direction[1][k], self.direction[2][k]];
            let ([u0, v0], [u1, v1]) = ([low[0][k], low[1][k]], [high[0][k], high[1][k]]);

            // Multiplied by the depth, each side of the rectangle is linear in t: the view sees the line as long as
            // every `constant + slope t` is at least 0.
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

            // Sight ends slightly sooner than computed, to allow for rounding.
            let is_visible = visible >> k & 1 != 0;
            let leaves = select(kernel.may_lose_sight, leaves, f64::INFINITY);
            let end = select(is_visible, leaves, enters) * (1.0 - 1e-9);
            self.t_max[k] = select(is_visible & (end < self.t_max[k]), end, self.t_max[k]);
            let sight_end = &mut sight_ends[self.point[k] as usize];
            *sight_end = select(end < *sight_end, end, *sight_end);
        }

        visible
    }

    /// A bit mask of the lines whose starts the view sees, and for each line a rectangle around its start, in pixels
    /// from `low` to `high`, in which the view sees everything.
    #[inline(always)]
    fn visible_rects(&self, kernel: &ViewKernel) -> (u32, [Wide; 2], [Wide; 2]) {
        let [width, height] = kernel.size;
        let (mut low, mut high): ([Wide; 2], [Wide; 2]) =
            ([[0.0; LANES]; 2], [[width; LANES], [height; LANES]]);
        let mut visible = [0; LANES];
        for k in 0..LANES {
            let in_image = (self.column[k] >= 0.0) & (self.column[k] < width);
            let in_image = in_image & (self.row[k] >= 0.0) & (self.row[k] < height);
            visible[k] = u32::from(in_image & (self.start[2][k] > MIN_DEPTH));
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
                // A lens sees a square around a pixel that it sees, of the half-width that its mask's distance gives.
                for (axis, pixel) in [(0, i), (1, j)] {
                    low[axis][k] = low[axis][k].max(pixel - reach);
                    high[axis][k] = high[axis][k].min(pixel + reach + 1.0);
                }
            }
        }
        (visible, low, high)
    }

    /// Which lines the view surely sees inside up to `t_max`: their ends lie in the square of subject pixels around the
    /// start. So does all between, since a line's image is straight.
    #[inline(always)]
    pub(super) fn stay_inside(&self, kernel: &ViewKernel) -> u32 {
        let (rim, mut stays, [x, y, z], [dx, dy, dz]) =
            (kernel.rim(), [0; LANES], &self.start, &self.direction);
        for k in 0..LANES {
            let (reach, t) = (self.distance[k] - rim, self.t_max[k]);
            let (end_x, end_y, end_z) = (x[k] + dx[k] * t, y[k] + dy[k] * t, z[k] + dz[k] * t);
            // The offset from the centre of the start's pixel, multiplied by the depth as is the reach.
            let (du, dv) = (end_x - (self.column[k] + 0.5) * end_z, end_y - (self.row[k] + 0.5) * end_z);
            let near = (du.abs() < reach * end_z) & (dv.abs() < reach * end_z);
            stays[k] = u32::from((end_z > 0.0) & near & (reach > 0.0));
        }
        lane_mask(&stays)
    }

    /// Which lines the view surely sees inside up to `t_max`, because the squares of subject pixels around their starts
    /// and ends overlap along them: a straight image leaves the one only after it has entered the other.
    #[inline(always)]
    pub(super) fn end_inside(&self, kernel: &ViewKernel) -> u32 {
        let rim = kernel.rim();
        let (mut column, mut row, mut end_distance) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let (mut longest, mut offsets, mut in_rect) = ([0.0; LANES], [[0.0; LANES]; 2], [0; LANES]);

        for k in 0..LANES {
            // Start and end of the image, and the end's pixel if it lies in the silhouette's rectangle.
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

            // How far the start lies ahead of its pixel's centre, and the end short of its own, along either axis.
            let along = |by: f64, offset: f64| select(by > 0.0, offset, -offset);
            let (du, dv) = (u1 - u0, v1 - v0);
            let (start_u, start_v) = (u0 - 0.5 - self.column[k], v0 - 0.5 - self.row[k]);
            let (end_u, end_v) = (column[k] + 0.5 - u1, row[k] + 0.5 - v1);
            offsets[0][k] = larger(along(du, start_u), along(dv, start_v));
            offsets[1][k] = larger(along(du, end_u), along(dv, end_v));
            longest[k] = larger(du.abs(), dv.abs());
        }

        // The lengths of the image in the two squares have to add up to all of it.
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

    /// The image position of the start of line k.
    #[inline(always)]
    pub(super) fn position(&self, k: usize) -> (f64, f64) {
        (self.u[k], self.v[k])
    }

    /// Sets line k to line j of `other`, except for the position of its start.
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
    /// The difference between a pixel's distance to the background and the half-width of the square of subject around
    /// it.
    #[inline(always)]
    fn rim(&self) -> f64 {
        // By coverage an edge may lie half a pixel within the subject's pixels. The last term is far more than
        // rounding.
        0.5 + self.shift + 1e-6
    }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    select(a > b, a, b)
}
