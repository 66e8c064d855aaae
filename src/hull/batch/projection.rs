//! The projections of a block of points into the views, and the inside test.

use super::Wide;
use crate::camera::{Footprint, MIN_DEPTH};
use crate::hull::{Aabb, EdgeModel, Hull, Unseen, View};
use crate::math::lanes::{floor, index, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;
use crate::silhouette::{Distances, HALF_COVERAGE, NO_EDGE};
use nalgebra::Point3;

/// The distance in an image without background, and of a point that the view does not see: the view has no edge then.
const NOWHERE: f64 = NO_EDGE as f64;

/// A view in the form that loops over points read: plain numbers and slices of tables.
#[derive(Debug, Clone, Copy)]
pub(super) struct ViewKernel<'a> {
    pub(super) view: &'a View,
    /// Index of the view in the hull.
    pub(super) index: usize,
    /// The projection matrix, by rows.
    pub(super) p: [[f64; 4]; 3],
    /// Width and height of the image, in pixels.
    pub(super) size: [f64; 2],
    /// The silhouette's rectangle: its first column and row, and one past its last ones.
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    /// Column and row of the first pixel of the silhouette's crop.
    pub(super) corner: (i32, i32),
    /// Chebyshev distances of the crop's pixels to the background.
    distances: Distances<'a>,
    /// Chebyshev distances of cells.
    cell_distances: Distances<'a>,
    /// Number of entries in a row of the tables.
    pub(super) stride: f64,
    /// The index in the tables that pixel (0, 0) would have.
    pub(super) origin: f64,
    /// The mask's bytes at the indices of the tables; empty without coverage.
    coverage_bytes: &'a [u8],
    /// Whether the edge is where coverage crosses one half, not at pixels' borders.
    pub(super) by_coverage: bool,
    /// Cells are pixels (0), or the squares between four pixel centres (one half).
    pub(super) shift: f64,
    pub(super) edge: EdgeModel,
    pub(super) footprint: Footprint,
    /// Whether every point that the view does not see is outside, so that it can be treated as background.
    pub(super) is_closed: bool,
    /// Whether a line from inside the silhouette may leave the field of view before it reaches background.
    pub(super) may_lose_sight: bool,
}

/// A block of points, and their projections into each view.
#[derive(Debug, Default)]
pub(super) struct PointBlock {
    pub(super) point: [Wide; 3],
    pub(super) samples: Vec<ProjectedBlock>,
}

/// The projections of a block of points into one view.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct ProjectedBlock {
    /// Homogeneous image coordinates; depth 0 where the view does not see a point and abstains.
    pub(super) at: [Wide; 3],
    pub(super) column: Wide,
    pub(super) row: Wide,
    /// Chebyshev distance to the background, in pixels.
    pub(super) distance: Wide,
    /// Metres that a pixel covers at the point; written when the view that decides is selected.
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

    /// Writes the Chebyshev distances of cells, which are pixels or squares between four pixel centres. A cell at
    /// distance `d > 0` is the middle of a square of half-width `d - 1/2` that holds subject only; at 0 there is none.
    #[inline(always)]
    pub(super) fn find_cell_distances(&self, column: &Wide, row: &Wide, distances: &mut Wide) {
        let places = self.places(column, row, 0.0);
        look_up(&self.cell_distances, &places, distances, |place| self.long_cell_distance(place));
    }

    /// The Chebyshev distance of the cell at index `place` of the table.
    #[inline(always)]
    pub(super) fn cell_distance_at(&self, place: u32) -> f64 {
        let byte = self.cell_distances.at_place(place);
        if byte < u32::from(u8::MAX) { f64::from(byte) } else { self.long_cell_distance(place) }
    }

    /// The Chebyshev distance of a cell where it is 255 or more, and the table of bytes holds 255.
    #[cold]
    fn long_cell_distance(&self, place: u32) -> f64 {
        let silhouette = self.view.silhouette();
        f64::from(if self.by_coverage {
            silhouette.cell_distance_at(place as usize)
        } else {
            silhouette.distance_at(place as usize)
        })
    }

    /// The mask's bytes at the corners of a cell off the rim: upper left, upper right, lower left, lower right.
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

    /// Writes the distances of the pixels `offset` table entries after these; arbitrary for pixels beyond the crop.
    #[inline(always)]
    pub(super) fn find_distances(&self, column: &Wide, row: &Wide, offset: f64, distances: &mut Wide) {
        self.look_up_pixels(&self.places(column, row, offset), distances);
    }

    /// Writes the distances of pixels, given by their indices in the table.
    #[inline(always)]
    fn look_up_pixels(&self, places: &[u32; LANES], distances: &mut Wide) {
        look_up(&self.distances, places, distances, |place| {
            f64::from(self.view.silhouette().distance_at(place as usize))
        });
    }

    /// The indices of pixels in the table, plus `offset`.
    #[inline(always)]
    fn places(&self, column: &Wide, row: &Wide, offset: f64) -> [u32; LANES] {
        let (origin, mut places) = (self.origin + offset, [0; LANES]);
        for k in 0..LANES {
            places[k] = index(row[k] * self.stride + column[k] + origin);
        }
        places
    }

    /// Projects points. Returns bit masks of the points that the view sees, and of those that it sees inside. Both are
    /// exact only for the points in the bit mask `active`.
    #[inline(always)]
    fn project(&self, [x, y, z]: &[Wide; 3], active: u32, sample: &mut ProjectedBlock) -> (u32, u32) {
        for (row, at) in self.p.iter().zip(&mut sample.at) {
            for k in 0..LANES {
                at[k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k] + row[3];
            }
        }

        // The pixel of each point, and its index in the table; index 0 where it lies outside the silhouette's
        // rectangle.
        let (mut places, mut visible, mut in_rect) = ([0; LANES], [0; LANES], [0; LANES]);
        for k in 0..LANES {
            let (u, v) = (sample.at[0][k] / sample.at[2][k], sample.at[1][k] / sample.at[2][k]);
            let in_image = (u >= 0.0) & (u < self.size[0]) & (v >= 0.0) & (v < self.size[1]);
            let is_visible = in_image & (sample.at[2][k] > MIN_DEPTH);
            let (i, j) = (floor(select(is_visible, u, 0.0)), floor(select(is_visible, v, 0.0)));
            let in_columns = (i >= self.low[0]) & (i < self.high[0]);
            let in_rows = (j >= self.low[1]) & (j < self.high[1]);
            places[k] = index(select(in_columns & in_rows, j * self.stride + i + self.origin, 0.0));
            (sample.column[k], sample.row[k]) = (i, j);
            (visible[k], in_rect[k]) = (u32::from(is_visible), u32::from(in_columns & in_rows));
        }

        self.look_up_pixels(&places, &mut sample.distance);
        if !self.is_closed {
            // Entry 0 of the table may lie beyond an open border, where it is not background.
            for k in 0..LANES {
                sample.distance[k] = select(in_rect[k] != 0, sample.distance[k], 0.0);
            }
        }

        // Between four centres of subject pixels bilinear coverage is at least one half.
        let surely_inside_above = if self.by_coverage { 1.0 } else { 0.0 };
        let mut deeper = [0; LANES];
        for k in 0..LANES {
            deeper[k] = u32::from(sample.distance[k] > surely_inside_above);
        }
        let (mut visible, deeper) = (lane_mask(&visible), lane_mask(&deeper));
        let mut inside = visible & deeper;
        if self.by_coverage {
            inside |= self.covered(sample, visible & !deeper & active);
        }
        if !self.is_closed {
            visible &= !self.in_blind_spots(sample, inside & active);
            sample.forget_unseen(visible);
        }
        (visible, inside & visible)
    }

    /// Which of the `unresolved` points are inside by coverage.
    #[inline(always)]
    fn covered(&self, sample: &ProjectedBlock, unresolved: u32) -> u32 {
        let mut inside = 0;
        for k in set_bits(unresolved) {
            let pixel = (sample.column[k] as i32, sample.row[k] as i32);
            let (u, v) = (sample.at[0][k] / sample.at[2][k], sample.at[1][k] / sample.at[2][k]);
            if self.view.may_contain_subject(pixel) && self.coverage(u, v) >= HALF_COVERAGE {
                inside |= 1 << k;
            }
        }
        inside
    }

    /// [`Silhouette::coverage`](crate::silhouette::Silhouette::coverage) at an image position.
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

    /// Which of the `active` points lie in pixels that the lens did not see. The mask shows subject there.
    fn in_blind_spots(&self, sample: &ProjectedBlock, active: u32) -> u32 {
        let Some(field_of_view) = self.view.blind_spots() else { return 0 };
        let is_unseen = |k: usize| !field_of_view.is_subject(sample.column[k] as i32, sample.row[k] as i32);
        set_bits(active).filter(|&k| is_unseen(k)).fold(0, |unseen, k| unseen | 1 << k)
    }
}

/// Writes the distances at indices of a table of bytes; `long` returns those of 255 or more, for which it holds 255.
#[inline(always)]
fn look_up(table: &Distances, places: &[u32; LANES], distances: &mut Wide, long: impl Fn(u32) -> f64) {
    let mut bytes = [0; LANES];
    for k in 0..LANES {
        bytes[k] = table.at_place(places[k]);
    }
    for k in 0..LANES {
        distances[k] = f64::from(bytes[k]);
    }
    if bytes.iter().any(|&byte| byte == u32::from(u8::MAX)) {
        for k in (0..LANES).filter(|&k| bytes[k] == u32::from(u8::MAX)) {
            distances[k] = long(places[k]);
        }
    }
}

impl ProjectedBlock {
    /// Makes the view irrelevant for points that it does not see: depth 0, and no edge.
    #[inline(always)]
    fn forget_unseen(&mut self, visible: u32) {
        for k in 0..LANES {
            let is_visible = visible >> k & 1 != 0;
            self.at[2][k] = select(is_visible, self.at[2][k], 0.0);
            self.distance[k] = select(is_visible, self.distance[k], NOWHERE);
        }
    }

    /// Whether the view has a silhouette edge for point k.
    #[inline(always)]
    pub(super) fn has_edge(&self, k: usize) -> bool {
        self.distance[k] < NOWHERE
    }
}

impl PointBlock {
    /// Sets the points to `count` of them, at most `LANES`, padded with the last one.
    #[inline(always)]
    pub(super) fn place(&mut self, count: usize, point: impl Fn(usize) -> Point3<f64>) {
        for k in 0..LANES {
            let point = point(k.min(count - 1));
            (self.point[0][k], self.point[1][k], self.point[2][k]) = (point.x, point.y, point.z);
        }
    }

    /// Which of the `active` points lie in a box, faces included.
    #[inline(always)]
    pub(super) fn within(&self, aabb: &Aabb, active: u32) -> u32 {
        let mut within = [1; LANES];
        for axis in 0..3 {
            let (min, max, at) = (aabb.min[axis], aabb.max[axis], &self.point[axis]);
            for k in 0..LANES {
                within[k] &= u32::from((at[k] >= min) & (at[k] <= max));
            }
        }
        lane_mask(&within) & active
    }

    /// Projects the points into the views until none of the `active` ones may be inside. Returns which of them are, and
    /// which one view sees outside: such points count as inside here if `may_overrule`.
    #[inline(always)]
    pub(super) fn project_if_inside(
        &mut self,
        kernels: &[ViewKernel],
        unseen: Unseen,
        may_overrule: bool,
        active: u32,
    ) -> (u32, u32) {
        self.samples.resize(kernels.len(), ProjectedBlock::default());
        let (mut inside, mut seen_by) = (active, [0; LANES]);
        let may_abstain = if unseen == Unseen::Outside { 0 } else { u32::MAX };
        let (mut outside, may_miss) = (0, if may_overrule { u32::MAX } else { 0 });

        for (kernel, sample) in kernels.iter().zip(&mut self.samples) {
            let (visible, in_subject) = kernel.project(&self.point, inside, sample);
            let admitted = in_subject | (!visible & may_abstain);
            inside &= admitted | (visible & !outside & may_miss);
            outside |= !admitted;
            if inside == 0 {
                return (0, 0);
            }
            if may_abstain != 0 {
                for k in 0..LANES {
                    seen_by[k] += visible >> k & 1;
                }
            }
        }
        if may_abstain == 0 {
            return (if kernels.is_empty() { 0 } else { inside }, outside);
        }

        let (mut enough, min_views) = ([0; LANES], unseen.min_views(kernels.len()) as u32);
        for k in 0..LANES {
            enough[k] = u32::from(seen_by[k] >= min_views);
        }
        (inside & lane_mask(&enough), outside)
    }

    pub(super) fn point(&self, k: usize) -> Point3<f64> {
        Point3::new(self.point[0][k], self.point[1][k], self.point[2][k])
    }
}
