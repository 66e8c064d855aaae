//! Where the views see many points.

use super::super::{Aabb, EdgeModel, Hull, Unseen, View};
use super::Wide;
use crate::camera::{Footprint, MIN_DEPTH};
use crate::math::lanes::{floor, index, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;
use crate::silhouette::{Distances, HALF_COVERAGE, NO_EDGE};
use nalgebra::Point3;

/// The distance of a pixel without any background, and of a point that the view does not see: it decides no search.
const NOWHERE: f64 = NO_EDGE as f64;

/// What of a view every point needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewKernel<'a> {
    pub(super) view: &'a View,
    pub(super) index: usize,
    pub(super) p: [[f64; 4]; 3],
    /// Width and height of the image.
    pub(super) size: [f64; 2],
    /// The columns and rows of the silhouette's rectangle: the first, and the one behind the last.
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    /// Column and row of the first pixel of the silhouette's region.
    pub(super) corner: (i32, i32),
    /// Chebyshev distances, a row's pixels, and the place that pixel (0, 0) would have.
    distances: Distances<'a>,
    /// Distances of cells.
    cell_distances: Distances<'a>,
    pub(super) stride: f64,
    pub(super) origin: f64,
    /// The mask's bytes at the places of the table, where there is coverage.
    coverage_bytes: &'a [u8],
    /// Whether its edge is taken inside pixels.
    pub(super) by_coverage: bool,
    /// Cells are pixels (0), or the squares between four pixel centres (one half).
    pub(super) shift: f64,
    pub(super) edge: EdgeModel,
    pub(super) footprint: Footprint,
    /// Whether what the view does not see is outside, as its mask's background says.
    pub(super) is_closed: bool,
    /// Whether a line may leave what the view sees before it comes to background.
    pub(super) may_lose_sight: bool,
}

/// A block of points, and where each view sees them.
#[derive(Debug, Default)]
pub(super) struct PointBlock {
    pub(super) point: [Wide; 3],
    pub(super) samples: Vec<ProjectedBlock>,
}

/// Where one view sees a block of points.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ProjectedBlock {
    /// Homogeneous image coordinates; depth 0 where the view does not see a point and abstains.
    pub(super) at: [Wide; 3],
    pub(super) column: Wide,
    pub(super) row: Wide,
    /// Chebyshev distance to the background.
    pub(super) distance: Wide,
    /// Metres that a pixel covers there, once that is asked.
    pub(super) footprint: Wide,
}

impl<'a> ViewKernel<'a> {
    pub(super) fn new(hull: &Hull, index: usize, view: &'a View, edge: EdgeModel) -> Self {
        let silhouette = view.silhouette();
        let (tables, image, rect) = (silhouette.tables(), silhouette.image(), silhouette.rect());
        let p = view.projection();
        let stride = tables.width as f64;
        let by_coverage = edge == EdgeModel::Coverage && silhouette.has_coverage();
        let is_closed = hull.is_closed(view);
        Self {
            view,
            index,
            p: std::array::from_fn(|r| std::array::from_fn(|c| p[(r, c)])),
            size: [f64::from(image.x1), f64::from(image.y1)],
            low: [f64::from(rect.x0), f64::from(rect.y0)],
            high: [f64::from(rect.x1), f64::from(rect.y1)],
            corner: tables.corner,
            distances: Distances::new(tables.distance_words, tables.width),
            cell_distances: Distances::new(
                if by_coverage { tables.cell_distance_words } else { tables.distance_words },
                tables.width,
            ),
            stride,
            origin: -(stride * f64::from(tables.corner.1) + f64::from(tables.corner.0)),
            coverage_bytes: tables.coverage,
            by_coverage,
            shift: if by_coverage { 0.5 } else { 0.0 },
            edge,
            footprint: *view.footprint(),
            is_closed,
            may_lose_sight: !is_closed
                && (view.blind_spots().is_some() || !silhouette.is_framed_by_background()),
        }
    }

    /// The half-widths and a half of the largest squares around cells on which the view sees subject alone; 0 where
    /// there is none. Cells are pixels, or the squares between the centres of four.
    #[inline(always)]
    pub(super) fn find_cell_distances(&self, column: &Wide, row: &Wide, distances: &mut Wide) {
        let places = self.places(column, row, 0.0);
        look_up(&self.cell_distances, &places, distances, |place| self.long_cell_distance(place));
    }

    /// The half-width and a half of the largest square of subject around the cell at a place of the table.
    #[inline(always)]
    pub(super) fn cell_distance_at(&self, place: u32) -> f64 {
        let narrow = self.cell_distances.at_place(place);
        if narrow < u32::from(u8::MAX) { f64::from(narrow) } else { self.long_cell_distance(place) }
    }

    /// A distance of 255 or more, which a byte does not hold.
    #[cold]
    fn long_cell_distance(&self, place: u32) -> f64 {
        let silhouette = self.view.silhouette();
        f64::from(if self.by_coverage {
            silhouette.cell_distance_at(place as usize)
        } else {
            silhouette.distance_at(place as usize)
        })
    }

    /// The bytes at the corners of a cell that is not on the rim: upper left, upper right, lower left, lower right.
    #[inline(always)]
    pub(super) fn cell_corners(&self, column: f64, row: f64) -> [f64; 4] {
        let (place, stride) =
            (index(row * self.stride + column + self.origin) as usize, self.stride as usize);
        let (upper, lower) =
            (&self.coverage_bytes[place..][..2], &self.coverage_bytes[place + stride..][..2]);
        [upper[0], upper[1], lower[0], lower[1]].map(f64::from)
    }

    /// Whether a cell, a square between four pixel centres, reaches beyond the silhouette's rectangle.
    #[inline(always)]
    pub(super) fn is_on_rim(&self, column: f64, row: f64) -> bool {
        column < self.low[0] || column >= self.high[0] - 1.0 || row < self.low[1] || row >= self.high[1] - 1.0
    }

    /// The distances to the background of the pixels so many places behind these; of what lies beyond the region, some.
    #[inline(always)]
    pub(super) fn find_distances(&self, column: &Wide, row: &Wide, behind: f64, distances: &mut Wide) {
        self.look_up_pixels(&self.places(column, row, behind), distances);
    }

    /// The distances of pixels at places of the table.
    #[inline(always)]
    fn look_up_pixels(&self, places: &[u32; LANES], distances: &mut Wide) {
        look_up(&self.distances, places, distances, |place| {
            f64::from(self.view.silhouette().distance_at(place as usize))
        });
    }

    /// The places in the table so far behind those of pixels.
    #[inline(always)]
    fn places(&self, column: &Wide, row: &Wide, behind: f64) -> [u32; LANES] {
        let (origin, mut places) = (self.origin + behind, [0; LANES]);
        for k in 0..LANES {
            places[k] = index(row[k] * self.stride + column[k] + origin);
        }
        places
    }

    /// Where the view sees points. A bit for each that it sees, and for each that it sees inside, of those `asked`.
    #[inline(always)]
    fn project(&self, [x, y, z]: &[Wide; 3], asked: u32, sample: &mut ProjectedBlock) -> (u32, u32) {
        for (row, at) in self.p.iter().zip(&mut sample.at) {
            for k in 0..LANES {
                at[k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k] + row[3];
            }
        }
        let (mut places, mut visible, mut in_rect) = ([0; LANES], [0; LANES], [0; LANES]);
        for k in 0..LANES {
            let (u, v) = (sample.at[0][k] / sample.at[2][k], sample.at[1][k] / sample.at[2][k]);
            let within = (u >= 0.0) & (u < self.size[0]) & (v >= 0.0) & (v < self.size[1]);
            let seen = within & (sample.at[2][k] > MIN_DEPTH);
            let (i, j) = (floor(select(seen, u, 0.0)), floor(select(seen, v, 0.0)));
            let in_columns = (i >= self.low[0]) & (i < self.high[0]);
            let in_rows = (j >= self.low[1]) & (j < self.high[1]);
            places[k] = index(select(in_columns & in_rows, j * self.stride + i + self.origin, 0.0));
            (sample.column[k], sample.row[k]) = (i, j);
            (visible[k], in_rect[k]) = (u32::from(seen), u32::from(in_columns & in_rows));
        }
        self.look_up_pixels(&places, &mut sample.distance);
        if !self.is_closed {
            // The table's first place is background only where it does not lie beyond an open border.
            for k in 0..LANES {
                sample.distance[k] = select(in_rect[k] != 0, sample.distance[k], 0.0);
            }
        }

        // Between four centres of subject pixels coverage cannot fall below one half.
        let least = if self.by_coverage { 1.0 } else { 0.0 };
        let mut deeper = [0; LANES];
        for k in 0..LANES {
            deeper[k] = u32::from(sample.distance[k] > least);
        }
        let (mut visible, deeper) = (lane_mask(&visible), lane_mask(&deeper));
        let mut inside = visible & deeper;
        if self.by_coverage {
            inside |= self.covered(sample, visible & !deeper & asked);
        }
        if !self.is_closed {
            visible &= !self.in_blind_spots(sample, inside & asked);
            sample.forget_unseen(visible);
        }
        (visible, inside & visible)
    }

    /// Which of `doubtful` points beside the edge, or beyond, are inside by coverage.
    #[inline(always)]
    fn covered(&self, sample: &ProjectedBlock, doubtful: u32) -> u32 {
        let mut inside = 0;
        for k in set_bits(doubtful) {
            let pixel = (sample.column[k] as i32, sample.row[k] as i32);
            let (u, v) = (sample.at[0][k] / sample.at[2][k], sample.at[1][k] / sample.at[2][k]);
            if self.view.may_contain_subject(pixel) && self.coverage(u, v) >= HALF_COVERAGE {
                inside |= 1 << k;
            }
        }
        inside
    }

    /// [`Silhouette::coverage`] at an image position.
    #[inline(always)]
    pub(super) fn coverage(&self, u: f64, v: f64) -> f64 {
        let (column, row) = (floor(u - 0.5), floor(v - 0.5));
        if self.is_on_rim(column, row) {
            return self.view.silhouette().coverage(u, v);
        }
        let (x, y) = (u - 0.5 - column, v - 0.5 - row);
        let [c00, c10, c01, c11] = self.cell_corners(column, row);
        (c00 * (1.0 - x) + c10 * x) * (1.0 - y) + (c01 * (1.0 - x) + c11 * x) * y
    }

    /// Which of the points `asked` lie in pixels that the lens did not see. Its mask shows subject there.
    fn in_blind_spots(&self, sample: &ProjectedBlock, asked: u32) -> u32 {
        let Some(field_of_view) = self.view.blind_spots() else { return 0 };
        let is_unseen = |k: usize| !field_of_view.is_subject(sample.column[k] as i32, sample.row[k] as i32);
        set_bits(asked).filter(|&k| is_unseen(k)).fold(0, |unseen, k| unseen | 1 << k)
    }
}

/// The distances at places of a table; `exact` gives those of 255 and more, which a byte does not hold.
#[inline(always)]
fn look_up(table: &Distances, places: &[u32; LANES], distances: &mut Wide, exact: impl Fn(u32) -> f64) {
    let mut narrow = [0; LANES];
    for k in 0..LANES {
        narrow[k] = table.at_place(places[k]);
    }
    for k in 0..LANES {
        distances[k] = f64::from(narrow[k]);
    }
    if narrow.iter().any(|&narrow| narrow == u32::from(u8::MAX)) {
        for k in (0..LANES).filter(|&k| narrow[k] == u32::from(u8::MAX)) {
            distances[k] = exact(places[k]);
        }
    }
}

impl ProjectedBlock {
    /// Lets the view decide nothing for points that it does not see.
    #[inline(always)]
    fn forget_unseen(&mut self, visible: u32) {
        for k in 0..LANES {
            let is_visible = visible >> k & 1 != 0;
            self.at[2][k] = select(is_visible, self.at[2][k], 0.0);
            self.distance[k] = select(is_visible, self.distance[k], NOWHERE);
        }
    }

    /// Whether a search in this view ends for point k.
    #[inline(always)]
    pub(super) fn has_edge(&self, k: usize) -> bool {
        self.distance[k] < NOWHERE
    }
}

impl PointBlock {
    /// Takes up to `LANES` points, the last one again and again where there are fewer.
    #[inline(always)]
    pub(super) fn place(&mut self, count: usize, point: impl Fn(usize) -> Point3<f64>) {
        for k in 0..LANES {
            let point = point(k.min(count - 1));
            (self.point[0][k], self.point[1][k], self.point[2][k]) = (point.x, point.y, point.z);
        }
    }

    /// Which of the points `asked` lie in a box, faces included.
    #[inline(always)]
    pub(super) fn within(&self, aabb: &Aabb, asked: u32) -> u32 {
        let mut within = [1; LANES];
        for axis in 0..3 {
            let (min, max, at) = (aabb.min[axis], aabb.max[axis], &self.point[axis]);
            for k in 0..LANES {
                within[k] &= u32::from((at[k] >= min) & (at[k] <= max));
            }
        }
        lane_mask(&within) & asked
    }

    /// Projects the points into the views, as long as any of those `asked` may be inside; which of them are, by the
    /// policy for views that do not see a point.
    #[inline(always)]
    pub(super) fn project_if_inside(&mut self, kernels: &[ViewKernel], unseen: Unseen, asked: u32) -> u32 {
        self.samples.resize(kernels.len(), ProjectedBlock::default());
        let (mut inside, mut seen_by) = (asked, [0; LANES]);
        let may_abstain = if unseen == Unseen::Outside { 0 } else { u32::MAX };
        for (kernel, sample) in kernels.iter().zip(&mut self.samples) {
            let (visible, in_subject) = kernel.project(&self.point, inside, sample);
            inside &= in_subject | (!visible & may_abstain);
            if inside == 0 {
                return 0;
            }
            if may_abstain != 0 {
                for k in 0..LANES {
                    seen_by[k] += in_subject >> k & 1;
                }
            }
        }
        if may_abstain == 0 {
            return if kernels.is_empty() { 0 } else { inside };
        }

        let (mut enough, least) = ([0; LANES], unseen.min_views(kernels.len()) as u32);
        for k in 0..LANES {
            enough[k] = u32::from(seen_by[k] >= least);
        }
        inside & lane_mask(&enough)
    }

    pub(super) fn point(&self, k: usize) -> Point3<f64> {
        Point3::new(self.point[0][k], self.point[1][k], self.point[2][k])
    }
}
