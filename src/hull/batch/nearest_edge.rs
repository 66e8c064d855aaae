//! The silhouette edges nearest to many points.
//!
//! Points are grouped by the view that decides the window search, so that many searches in one silhouette run side by
//! side.

use super::directions::{find_contact_directions, find_paper_directions};
use super::edge_query::{EdgeQuery, OPEN_LIST};
use super::overruled::overrule;
use super::projection::{PointBlock, ViewKernel};
use super::{ExitRay, Wide};
use crate::hull::query::{ROUNDING, extent, window_half_width};
use crate::hull::{EdgeModel, Hull};
use crate::math::lanes::{floor, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;
use crate::math::vectorised;
use crate::silhouette::ring_search::{Pixels, nearest};
use crate::silhouette::{self, EdgePixel, Silhouette};
use nalgebra::Vector3;

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

/// The decision of the window search for each point.
pub(super) struct Decision {
    /// Index of the kernel of the view that decides.
    kernel: Wide,
    /// The iteration; infinite where no view has an edge.
    iteration: Wide,
    /// How fast the window of that view grows: `d_max / d_i`.
    growth: Wide,
}

impl Decision {
    /// Replaces the decision for point k: index of the view's kernel and half-width of its window; `None` where no view
    /// has an edge.
    pub(super) fn replace(&mut self, k: usize, window: Option<(usize, i32)>) {
        self.iteration[k] = f64::INFINITY;
        if let Some((kernel, half)) = window {
            // A window that grows by a pixel an iteration has this half-width after one iteration less.
            (self.kernel[k], self.iteration[k], self.growth[k]) = (kernel as f64, f64::from(half - 1), 1.0);
        }
    }
}

impl EdgeQueries {
    /// Adds queries for the points of a block in the bit mask `inside` for which some view has an edge, and their rays
    /// to `rays`; [`Self::find_directions`] computes the directions. Returns a bit mask of these points. One view sees
    /// those in `outside` outside: they count only if it is overruled.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        hull: &Hull,
        kernels: &[ViewKernel],
        block: &mut PointBlock,
        (inside, outside): (u32, u32),
        rays: &mut Vec<ExitRay>,
    ) -> u32 {
        self.queries.resize_with(self.queries.len().max(kernels.len()), Default::default);
        let mut decision = select_view(kernels, block);
        let (inside, overrules) = match hull.overrule_depth() {
            Some(depth) => overrule(hull, kernels, block, depth, (inside, outside), &mut decision),
            None => (inside, 0),
        };
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

            let overrules = overrules >> k & 1 == 1;
            let ray =
                ExitRay { point: block.point(k), direction: Vector3::zeros(), view: kernel.index, overrules };
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

            // New edges are computed side by side, each once in the life of a silhouette. Contact normals need them
            // all.
            silhouette::compute_edges(silhouette, new_edges);
            for (queries, nearest) in lists.iter_mut().zip(nearest.iter()) {
                find_contact_directions(kernel, queries, nearest, rays);
                queries.clear();
            }
        }
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

/// Decides the window search for each point of a block, as [`Hull::nearest_edge`](super::super::Hull::nearest_edge)
/// does: the view whose window, `1 + floor(k d_max / d_i)`, is the first to reach its distance; at one iteration the one whose
/// distance is the least in metres.
#[inline(always)]
fn select_view(kernels: &[ViewKernel], block: &mut PointBlock) -> Decision {
    let mut d_max = [0.0; LANES];
    for (kernel, sample) in kernels.iter().zip(&mut block.samples) {
        kernel.footprint.at_each(&sample.at[2], &mut sample.footprint);
        for k in 0..LANES {
            d_max[k] = select(sample.footprint[k] > d_max[k], sample.footprint[k], d_max[k]);
        }
    }

    let mut least = [f64::INFINITY; LANES];
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

            let extent = extent(sample.distance[k], sample.footprint[k]);
            let nearer = (iteration == decision.iteration[k]) & (extent < (1.0 - ROUNDING) * least[k]);
            let sooner = (iteration < decision.iteration[k]) | nearer;
            least[k] = select(sooner, extent, least[k]);
            decision.iteration[k] = select(sooner, iteration, decision.iteration[k]);
            decision.growth[k] = select(sooner, growth, decision.growth[k]);
            decision.kernel[k] = select(sooner, place as f64, decision.kernel[k]);
        }
    }
    decision
}
