//! Where the views see many points.

use super::super::batch::lookup::Distances;
use super::super::lanes::{bits, either, floor, index, ones};
use super::super::points::LANES;
use super::super::view::Footprint;
use super::super::{Aabb, EdgeModel, View};
use super::Wide;
use crate::camera::MIN_DEPTH;
use crate::silhouette::HALF_COVERAGE;
use nalgebra::Point3;

/// What of a view every point needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    pub(super) view: &'a View,
    pub(super) index: usize,
    pub(super) p: [[f64; 4]; 3],
    /// Width and height of the image.
    size: [f64; 2],
    /// The columns and rows of the silhouette's rectangle: the first, and the one behind the last.
    low: [f64; 2],
    high: [f64; 2],
    /// Column and row of the first pixel of the silhouette's region.
    pub(super) corner: (i32, i32),
    /// Chebyshev distances, a row's pixels, and the place that pixel (0, 0) would have.
    distance: &'a [u8],
    /// The same, four a word.
    distance_words: &'a [u32],
    stride: f64,
    origin: f64,
    /// Whether its edge is taken inside pixels.
    pub(super) by_coverage: bool,
    /// Cells are pixels (0), or the squares between four pixel centres (one half).
    pub(super) shift: f64,
    pub(super) edge: EdgeModel,
    pub(super) footprint: Footprint,
}

/// Points asked together, and where each view sees them.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub(super) point: [Wide; 3],
    pub(super) sightings: Vec<Sighting>,
}

/// Where one view sees them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sighting {
    /// Homogeneous image coordinates.
    pub(super) at: [Wide; 3],
    pub(super) column: Wide,
    pub(super) row: Wide,
    /// Chebyshev distance to the background.
    pub(super) clear: Wide,
    /// Metres that a pixel covers there, once that is asked.
    pub(super) footprint: Wide,
}

impl<'a> Field<'a> {
    pub(super) fn new(index: usize, view: &'a View, edge: EdgeModel) -> Self {
        let silhouette = view.silhouette();
        let (tables, image, rect) = (silhouette.tables(), silhouette.image(), silhouette.rect());
        let p = view.projection();
        let stride = tables.width as f64;
        let by_coverage = edge == EdgeModel::Coverage && silhouette.has_coverage();
        Self {
            view,
            index,
            p: std::array::from_fn(|r| std::array::from_fn(|c| p[(r, c)])),
            size: [f64::from(image.x1), f64::from(image.y1)],
            low: [f64::from(rect.x0), f64::from(rect.y0)],
            high: [f64::from(rect.x1), f64::from(rect.y1)],
            corner: tables.corner,
            distance: tables.distance,
            distance_words: tables.distance_words,
            stride,
            origin: -(stride * f64::from(tables.corner.1) + f64::from(tables.corner.0)),
            by_coverage,
            shift: if by_coverage { 0.5 } else { 0.0 },
            edge,
            footprint: *view.footprint(),
        }
    }

    /// The distance at a place of the table.
    fn distance(&self, place: u32) -> u16 {
        match self.distance.get(place as usize) {
            Some(&u8::MAX) => self.view.silhouette().distance_at(place as usize),
            Some(&near) => u16::from(near),
            None => 0,
        }
    }

    /// The half-widths and a half of the largest squares around cells on which the view sees subject alone; 0 where
    /// there is none. Cells are pixels, or the squares between the centres of four.
    #[inline(always)]
    pub(super) fn find_clear(&self, column: &Wide, row: &Wide, clear: &mut Wide) {
        self.find_distances(column, row, 0.0, clear);
        if self.by_coverage {
            for beside in [1.0, self.stride, self.stride + 1.0] {
                let mut distances = [0.0; LANES];
                self.find_distances(column, row, beside, &mut distances);
                for k in 0..LANES {
                    clear[k] = either(distances[k] < clear[k], distances[k], clear[k]);
                }
            }
        }
    }

    /// The distances to the background of the pixels so many places behind these; of what lies beyond the region, some.
    #[inline(always)]
    pub(super) fn find_distances(&self, column: &Wide, row: &Wide, behind: f64, distances: &mut Wide) {
        let (origin, mut places) = (self.origin + behind, [0; LANES]);
        for k in 0..LANES {
            places[k] = index(row[k] * self.stride + column[k] + origin);
        }
        self.look_up(&places, distances);
    }

    /// The distances at places of the table.
    #[inline(always)]
    fn look_up(&self, places: &[u32; LANES], distances: &mut Wide) {
        let (table, mut narrow) = (Distances::new(self.distance_words, self.stride as usize), [0; LANES]);
        for k in 0..LANES {
            narrow[k] = table.at_place(places[k]);
        }
        for k in 0..LANES {
            distances[k] = f64::from(narrow[k]);
        }
        if narrow.iter().any(|&narrow| narrow == u32::from(u8::MAX)) {
            for k in 0..LANES {
                distances[k] = f64::from(self.distance(places[k]));
            }
        }
    }

    /// Where the view sees points; and a bit for each that it sees inside.
    #[inline(always)]
    fn sight(&self, [x, y, z]: &[Wide; 3], sighting: &mut Sighting) -> u32 {
        for (row, at) in self.p.iter().zip(&mut sighting.at) {
            for k in 0..LANES {
                at[k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k] + row[3];
            }
        }
        let mut places = [0; LANES];
        let (mut visible, at) = ([0; LANES], &sighting.at);
        for k in 0..LANES {
            let (u, v) = (at[0][k] / at[2][k], at[1][k] / at[2][k]);
            let within = (u >= 0.0) & (u < self.size[0]) & (v >= 0.0) & (v < self.size[1]);
            let seen = within & (at[2][k] > MIN_DEPTH);
            let (i, j) = (floor(either(seen, u, 0.0)), floor(either(seen, v, 0.0)));
            let in_columns = (i >= self.low[0]) & (i < self.high[0]);
            let in_rows = (j >= self.low[1]) & (j < self.high[1]);
            // The table's first place is background.
            places[k] = index(either(in_columns & in_rows, j * self.stride + i + self.origin, 0.0));
            (sighting.column[k], sighting.row[k]) = (i, j);
            visible[k] = u32::from(seen);
        }
        self.look_up(&places, &mut sighting.clear);
        let least = if self.by_coverage { 1.0 } else { 0.0 };
        let mut clear = [0; LANES];
        for k in 0..LANES {
            clear[k] = u32::from(sighting.clear[k] > least);
        }
        let (visible, clear) = (bits(&visible), bits(&clear));
        visible & (clear | if self.by_coverage { self.covered(sighting, visible & !clear) } else { 0 })
    }

    /// Which of `doubtful` points beside the edge, or beyond, are inside by coverage.
    fn covered(&self, sighting: &Sighting, doubtful: u32) -> u32 {
        let mut inside = 0;
        for k in ones(doubtful) {
            let pixel = (sighting.column[k] as i32, sighting.row[k] as i32);
            let (u, v) = (sighting.at[0][k] / sighting.at[2][k], sighting.at[1][k] / sighting.at[2][k]);
            if self.view.may_hold(pixel) && self.view.silhouette().coverage(u, v) >= HALF_COVERAGE {
                inside |= 1 << k;
            }
        }
        inside
    }
}

impl Block {
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
        bits(&within) & asked
    }

    /// Takes up where the views see the points, as long as any of those `inside` is seen inside; which all see inside.
    #[inline(always)]
    pub(super) fn sight_inside(&mut self, fields: &[Field], mut inside: u32) -> u32 {
        self.sightings.resize(fields.len(), Sighting::default());
        for (field, sighting) in fields.iter().zip(&mut self.sightings) {
            inside &= field.sight(&self.point, sighting);
            if inside == 0 {
                break;
            }
        }
        inside
    }

    pub(super) fn point(&self, k: usize) -> Point3<f64> {
        Point3::new(self.point[0][k], self.point[1][k], self.point[2][k])
    }
}
