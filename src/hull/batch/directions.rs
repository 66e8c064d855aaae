//! The exit directions that silhouette edges give, for many points at once: the back-projected normals of the edges.

use super::edge_query::EdgeQuery;
use super::projection::ViewKernel;
use super::{ExitRay, Wide};
use crate::math::lanes::{lane_mask, set_bits};
use crate::math::point_cloud::LANES;
use crate::math::vectorised;
use crate::silhouette::{Bits, Edge, EdgePixel, SHORTEST_MEAN};
use nalgebra::Vector3;

/// Lines in the image, each given by a point on it and its unit normal.
struct EdgeLines {
    u: Wide,
    v: Wide,
    normal_u: Wide,
    normal_v: Wide,
}

vectorised! {
    /// Writes the contact directions of `queries`: the back-projected normals of the edges at the pixels `nearest`.
    pub(super) fn find_contact_directions(
        kernel: &ViewKernel,
        queries: &[EdgeQuery],
        nearest: &[EdgePixel],
        rays: &mut [ExitRay],
    ) {
        for (queries, nearest) in queries.chunks(LANES).zip(nearest.chunks(LANES)) {
            // An edge without a normal of its own is replaced by a line across the offset to it.
            let mut lines = EdgeLines::default();
            for (k, (query, nearest)) in queries.iter().zip(nearest).enumerate() {
                let edge = kernel.view.silhouette().edge_at(nearest);
                lines.set(k, &edge.unwrap_or_else(|| query.edge_towards(nearest.at)));
            }
            kernel.write_directions(&lines, queries, rays);
        }
    }
}

vectorised! {
    /// Writes the paper's directions of `queries`: the back-projected 5x5 normals at the pixels `nearest`.
    pub(super) fn find_paper_directions(
        kernel: &ViewKernel,
        queries: &[EdgeQuery],
        nearest: &[(i32, i32)],
        rays: &mut [ExitRay],
    ) {
        let silhouette = kernel.view.silhouette();
        for (queries, nearest) in queries.chunks(LANES).zip(nearest.chunks(LANES)) {
            let (mut lines, short) = kernel.paper_lines(nearest);

            // Where the mean is too short for a normal, the single query decides.
            for k in set_bits(short & (u32::MAX >> (LANES - nearest.len()))) {
                let (i, j) = nearest[k];
                let edge = queries[k].edge_towards((i, j));
                let normal = silhouette.paper_normal(i, j).unwrap_or(edge.normal);
                lines.set(k, &Edge { normal, ..edge });
            }

            kernel.write_directions(&lines, queries, rays);
        }
    }
}

impl Default for EdgeLines {
    fn default() -> Self {
        let (zero, one) = ([0.0; LANES], [1.0; LANES]);
        Self { u: zero, v: zero, normal_u: zero, normal_v: one }
    }
}

impl EdgeLines {
    #[inline(always)]
    fn set(&mut self, k: usize, Edge { point, normal }: &Edge) {
        (self.u[k], self.v[k]) = (point.x, point.y);
        (self.normal_u[k], self.normal_v[k]) = (normal.x, normal.y);
    }
}

impl ViewKernel<'_> {
    /// Lines through the centres of background pixels with the paper's 5x5 normals: the mean offset to the background
    /// pixels of the window, as in [`Silhouette::paper_normal`](crate::silhouette::Silhouette::paper_normal). Also
    /// returns a bit mask of the pixels for which the mean is too short.
    #[inline(always)]
    fn paper_lines(&self, pixels: &[(i32, i32)]) -> (EdgeLines, u32) {
        let tables = self.view.silhouette().tables();
        let bits = Bits::new(tables.subject, tables.words);
        let (mut column, mut row) = ([0; LANES], [0; LANES]);
        for k in 0..LANES {
            (column[k], row[k]) = pixels[k.min(pixels.len() - 1)];
        }

        let (mut lines, mut short) = (EdgeLines::default(), [0; LANES]);
        for k in 0..LANES {
            // The sum of the offsets to background pixels, row by row. Rows are an array because a loop over a range
            // would not be unrolled.
            let (mut x, mut y, mut count) = (0, 0, 0);
            for dy in [-2, -1, 0, 1, 2] {
                let bits = !bits.from(column[k] - self.corner.0 - 2, row[k] - self.corner.1 + dy);
                let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|bit| (bits >> bit & 1) as i32);
                let background = a + b + c + d + e;
                x += 2 * (e - a) + d - b;
                y += dy * background;
                count += background;
            }

            let (mean_u, mean_v) = (f64::from(x) / f64::from(count), f64::from(y) / f64::from(count));
            let length = (mean_u * mean_u + mean_v * mean_v).sqrt();
            short[k] = u32::from(length < SHORTEST_MEAN);
            (lines.u[k], lines.v[k]) = (f64::from(column[k]) + 0.5, f64::from(row[k]) + 0.5);
            (lines.normal_u[k], lines.normal_v[k]) = (mean_u / length, mean_v / length);
        }
        (lines, lane_mask(&short))
    }

    /// Writes to the rays of `queries` the unit normals, in the world, of the planes through the camera's centre and
    /// `lines`, with the arithmetic of [`View::backproject_normal`](crate::hull::View::backproject_normal).
    #[inline(always)]
    fn write_directions(&self, lines: &EdgeLines, queries: &[EdgeQuery], rays: &mut [ExitRay]) {
        let ([p0, p1, p2], mut normal) = (&self.p, [[0.0; LANES]; 3]);
        for k in 0..LANES {
            let across = |axis: usize| {
                (p0[axis] - p2[axis] * lines.u[k]) * lines.normal_u[k]
                    + (p1[axis] - p2[axis] * lines.v[k]) * lines.normal_v[k]
            };
            let [x, y, z] = [across(0), across(1), across(2)];
            let length = (x * x + y * y + z * z).sqrt();
            (normal[0][k], normal[1][k], normal[2][k]) = (x / length, y / length, z / length);
        }

        let [x, y, z] = normal;
        for (k, query) in queries.iter().enumerate() {
            rays[query.ray as usize].direction = Vector3::new(x[k], y[k], z[k]);
        }
    }
}
