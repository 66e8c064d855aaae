//! The silhouette edges nearest to many points, and the exit directions that they give.
//!
//! Points are grouped by the view that decides the window search, so that many searches in one silhouette run side by
//! side.

use super::super::EdgeModel;
use super::super::query::{towards, window_half_width};
use super::projection::{PointBlock, ViewKernel};
use super::{ExitRay, Wide};
use crate::math::lanes::{floor, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;
use crate::math::vectorised;
use crate::silhouette::ring_search::{NEAR, Pixels, nearest};
use crate::silhouette::{self, Bits, Edge, EdgePixel, SHORTEST_MEAN, Silhouette};
use nalgebra::{Point2, Vector3};

/// Points inside, grouped by the view that decides the window search and by how the background is searched for.
#[derive(Debug, Default)]
pub(super) struct EdgeQueries {
    /// Three lists for each view, indexed by `NEAR_LIST`, `FAR_LIST` and `OPEN_LIST`.
    queries: Vec<[Vec<EdgeQuery>; 3]>,
    /// The background pixels nearest to the points of one list.
    found: Vec<(i32, i32)>,
    /// The edge pixels nearest to the points of each list of one view.
    nearest: [Vec<EdgePixel>; 3],
    /// The edge pixels of one view whose edges have not been computed yet.
    new_edges: Vec<EdgePixel>,
}

/// Index of the list of points whose background is near.
const NEAR_LIST: usize = 0;
/// Index of the list of points whose background is farther away.
const FAR_LIST: usize = 1;
/// Index of the list of points whose search may reach beyond an open border.
const OPEN_LIST: usize = 2;

/// A point, as projected into the view that decides.
#[derive(Debug, Clone, Copy)]
struct EdgeQuery {
    /// Index of the point's ray.
    ray: u32,
    pixel: (i32, i32),
    /// Chebyshev distance to the background, in pixels: half-width of the first window that holds any.
    first: i32,
    /// Half-width of the window in which the nearest background is searched for, in pixels.
    half: i32,
}

/// The decision of the window search for each point.
struct Decision {
    /// Index of the kernel of the view that decides.
    kernel: Wide,
    /// The iteration; infinite where no view has an edge.
    iteration: Wide,
    /// How fast the window of that view grows: `d_max / d_i`.
    growth: Wide,
}

/// Lines in the image, each given by a point on it and its unit normal.
struct ImageLines {
    u: Wide,
    v: Wide,
    normal_u: Wide,
    normal_v: Wide,
}

impl EdgeQueries {
    /// Adds queries for the points of a block in the bit mask `inside` for which some view has an edge, and their rays to
    /// `rays`; [`Self::find_directions`] computes the directions. Returns a bit mask of these points.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        kernels: &[ViewKernel],
        block: &mut PointBlock,
        inside: u32,
        rays: &mut Vec<ExitRay>,
    ) -> u32 {
        self.queries.resize_with(self.queries.len().max(kernels.len()), Default::default);
        let decision = select_view(kernels, block);
        let mut has_edge = [0; LANES];
        for k in 0..LANES {
            has_edge[k] = u32::from(decision.iteration[k] < f64::INFINITY);
        }
        let decided = inside & lane_mask(&has_edge);

        for k in set_bits(decided) {
            let place = decision.kernel[k] as usize;
            let (kernel, sample) = (&kernels[place], &block.samples[place]);
            let distance = sample.distance[k] as i32;
            let half = window_half_width(decision.iteration[k] as i64, decision.growth[k]);
            let query = EdgeQuery {
                ray: rays.len() as u32,
                pixel: (sample.column[k] as i32, sample.row[k] as i32),
                first: distance,
                half: half.max(distance),
            };
            self.queries[place][query.list(kernel)].push(query);

            let ray = ExitRay { point: block.point(k), direction: Vector3::zeros(), view: kernel.index };
            rays.push(ray);
        }

        decided
    }

    /// Writes the directions of the rays of all queries, and removes the queries.
    pub(super) fn find_directions(&mut self, kernels: &[ViewKernel], edge: EdgeModel, rays: &mut [ExitRay]) {
        let Self { queries, nearest, found, new_edges } = self;
        for (kernel, lists) in kernels.iter().zip(queries) {
            let silhouette = kernel.view.silhouette();
            new_edges.clear();

            // The nearest background pixels. The paper's normals follow from them at once.
            for (list, (queries, nearest)) in lists.iter_mut().zip(nearest.iter_mut()).enumerate() {
                found.clear();
                if list == OPEN_LIST {
                    found.extend(queries.iter().map(|query| query.find_nearest_scalar(kernel)));
                } else {
                    find_nearest(kernel, queries, found);
                }
                if edge == EdgeModel::Pixel {
                    find_paper_directions(kernel, queries, found, rays);
                    queries.clear();
                } else {
                    find_edge_pixels(silhouette, found, nearest, new_edges);
                }
            }

            // New edges are computed side by side, each once in the life of a silhouette. Contact normals need them all.
            silhouette::compute_edges(silhouette, new_edges);
            for (queries, nearest) in lists.iter_mut().zip(nearest.iter()) {
                find_contact_directions(kernel, queries, nearest, rays);
                queries.clear();
            }
        }
    }
}

impl EdgeQuery {
    /// Index of the list that the query belongs to.
    #[inline(always)]
    fn list(&self, kernel: &ViewKernel) -> usize {
        // The nearest background lies within sqrt(2) times the Chebyshev distance.
        let reach = self.first + self.first / 2 + 1;
        if !kernel.is_closed && !kernel.view.silhouette().keeps_window(self.pixel, reach) {
            OPEN_LIST
        } else if self.first > NEAR {
            FAR_LIST
        } else {
            NEAR_LIST
        }
    }

    /// The background pixel nearest to the point, found by the search of the single query.
    fn find_nearest_scalar(&self, kernel: &ViewKernel) -> (i32, i32) {
        let (i, j) = self.pixel;
        kernel.view.silhouette().nearest_background(i, j, self.half).unwrap_or(self.pixel)
    }
}

vectorised! {
    /// Adds to `found` the background pixels nearest to the points of `queries`.
    fn find_nearest(kernel: &ViewKernel, queries: &[EdgeQuery], found: &mut Vec<(i32, i32)>) {
        let (tables, (x, y)) = (kernel.view.silhouette().tables(), kernel.corner);
        for queries in queries.chunks(LANES) {
            // Tables are indexed from the crop's first pixel; unused lanes repeat the last query.
            let (mut middle, mut first, mut half) = (Pixels::default(), [0; LANES], [0; LANES]);
            for k in 0..LANES {
                let query = queries[k.min(queries.len() - 1)];
                (middle.column[k], middle.row[k]) = (query.pixel.0 - x, query.pixel.1 - y);
                (first[k], half[k]) = (query.first, query.half);
            }

            let nearest = nearest(&tables, &middle, &first, &half);
            for k in 0..queries.len() {
                found.push((nearest.column[k] + x, nearest.row[k] + y));
            }
        }
    }
}

vectorised! {
    /// Writes the pixels `found` to `nearest` as edge pixels, and adds to `new_edges` those whose edges have not been
    /// computed yet.
    fn find_edge_pixels(
        silhouette: &Silhouette,
        found: &[(i32, i32)],
        nearest: &mut Vec<EdgePixel>,
        new_edges: &mut Vec<EdgePixel>,
    ) {
        nearest.clear();
        for &at in found {
            let pixel = silhouette.edge_pixel(at);
            nearest.push(pixel);
            if silhouette.claim_edge(&pixel) {
                new_edges.push(pixel);
            }
        }
    }
}

vectorised! {
    /// Writes the contact directions of `queries`: the back-projected normals of the edges at the pixels `nearest`.
    fn find_contact_directions(
        kernel: &ViewKernel,
        queries: &[EdgeQuery],
        nearest: &[EdgePixel],
        rays: &mut [ExitRay],
    ) {
        for (queries, nearest) in queries.chunks(LANES).zip(nearest.chunks(LANES)) {
            // An edge without a normal of its own is replaced by a line across the offset to it.
            let mut lines = ImageLines::default();
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
    fn find_paper_directions(
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

impl EdgeQuery {
    /// The replacement of an edge without a normal: a line through pixel `(i, j)` across the offset from the point's pixel.
    #[inline(always)]
    fn edge_towards(&self, (i, j): (i32, i32)) -> Edge {
        Edge {
            point: Point2::new(f64::from(i) + 0.5, f64::from(j) + 0.5),
            normal: towards(i - self.pixel.0, j - self.pixel.1),
        }
    }
}

impl Default for ImageLines {
    fn default() -> Self {
        let (zero, one) = ([0.0; LANES], [1.0; LANES]);
        Self { u: zero, v: zero, normal_u: zero, normal_v: one }
    }
}

impl ImageLines {
    #[inline(always)]
    fn set(&mut self, k: usize, Edge { point, normal }: &Edge) {
        (self.u[k], self.v[k]) = (point.x, point.y);
        (self.normal_u[k], self.normal_v[k]) = (normal.x, normal.y);
    }
}

impl ViewKernel<'_> {
    /// Lines through the centres of background pixels with the paper's 5x5 normals: the mean offset to the background
    /// pixels of the window, as in [`Silhouette::paper_normal`]. Also returns a bit mask of the pixels for which the mean is
    /// too short.
    #[inline(always)]
    fn paper_lines(&self, pixels: &[(i32, i32)]) -> (ImageLines, u32) {
        let tables = self.view.silhouette().tables();
        let bits = Bits::new(tables.subject, tables.words);
        let (mut column, mut row) = ([0; LANES], [0; LANES]);
        for k in 0..LANES {
            (column[k], row[k]) = pixels[k.min(pixels.len() - 1)];
        }

        let (mut lines, mut short) = (ImageLines::default(), [0; LANES]);
        for k in 0..LANES {
            // The sum of the offsets to background pixels, row by row. Rows are an array because a loop over a range would
            // not be unrolled.
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
    /// `lines`, with the arithmetic of [`View::backproject_normal`](super::super::View::backproject_normal).
    #[inline(always)]
    fn write_directions(&self, lines: &ImageLines, queries: &[EdgeQuery], rays: &mut [ExitRay]) {
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

/// Decides the window search for each point of a block, as [`Hull::nearest_edge`](super::super::Hull::nearest_edge) does:
/// the view whose window, `1 + floor(k d_max / d_i)`, is the first to reach its distance; ties go to the first view.
#[inline(always)]
fn select_view(kernels: &[ViewKernel], block: &mut PointBlock) -> Decision {
    let mut d_max = [0.0; LANES];
    for (kernel, sample) in kernels.iter().zip(&mut block.samples) {
        kernel.footprint.at_each(&sample.at[2], &mut sample.footprint);
        for k in 0..LANES {
            d_max[k] = select(sample.footprint[k] > d_max[k], sample.footprint[k], d_max[k]);
        }
    }

    let mut decision =
        Decision { kernel: [0.0; LANES], iteration: [f64::INFINITY; LANES], growth: [0.0; LANES] };
    for (place, sample) in block.samples.iter().enumerate() {
        for k in 0..LANES {
            // The smallest k with k growth >= distance - 1, in closed form: the whole number below the quotient, or one
            // more. It is -1 where the point's own pixel is background.
            let growth = d_max[k] / sample.footprint[k];
            let needed = sample.distance[k] - 1.0;
            let whole = floor(select(needed > 0.0, needed / growth, 0.0));
            let iteration = select(whole * growth < needed, whole + 1.0, whole);
            let iteration = select(needed < 0.0, -1.0, iteration);
            let iteration = select(sample.has_edge(k), iteration, f64::INFINITY);

            let sooner = iteration < decision.iteration[k];
            decision.iteration[k] = select(sooner, iteration, decision.iteration[k]);
            decision.growth[k] = select(sooner, growth, decision.growth[k]);
            decision.kernel[k] = select(sooner, place as f64, decision.kernel[k]);
        }
    }
    decision
}
