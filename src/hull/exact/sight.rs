//! Where the views see many points.

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
    pub(super) stride: f64,
    pub(super) origin: f64,
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
            stride,
            origin: -(stride * f64::from(tables.corner.1) + f64::from(tables.corner.0)),
            by_coverage,
            shift: if by_coverage { 0.5 } else { 0.0 },
            edge,
            footprint: *view.footprint(),
        }
    }

    /// How the homogeneous coordinates change along `direction`, as [`View::homogeneous_direction`] has it.
    #[inline(always)]
    pub(super) fn ahead(&self, [x, y, z]: &[Wide; 3], ahead: &mut [Wide; 3]) {
        for (row, ahead) in self.p.iter().zip(ahead) {
            for k in 0..LANES {
                ahead[k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k];
            }
        }
    }

    /// The distance at a place of the table.
    #[inline(always)]
    pub(super) fn distance(&self, place: u32) -> u16 {
        match self.distance.get(place as usize) {
            Some(&u8::MAX) => self.view.silhouette().distance_at(place as usize),
            Some(&near) => u16::from(near),
            None => 0,
        }
    }

    /// The half-width and a half of the largest square of cells around the one at `place` on which the view sees
    /// subject alone; 0 where there is none. Cells are pixels, or the squares between the centres of four.
    #[inline(always)]
    pub(super) fn clear(&self, place: u32) -> u16 {
        let here = self.distance(place);
        if !self.by_coverage {
            return here;
        }
        let below = place + self.stride as u32;
        here.min(self.distance(place + 1)).min(self.distance(below)).min(self.distance(below + 1))
    }

    /// The cell in which a walk from point `k` begins, and its distance to background.
    #[inline(always)]
    pub(super) fn first_cell(&self, sighting: &Sighting, k: usize) -> (f64, f64, f64) {
        let (column, row, clear) = (sighting.column[k], sighting.row[k], sighting.clear[k]);
        if !self.by_coverage || clear == 0.0 {
            return (column, row, clear);
        }
        // The cell begins at a pixel's centre: at that of the point's pixel, or of the one before.
        let cell = |x: f64, pixel: f64| if x - self.shift < pixel { pixel - 1.0 } else { pixel };
        let [x, y, depth] = sighting.at.map(|at| at[k]);
        let (column, row) = (cell(x / depth, column), cell(y / depth, row));
        (column, row, f64::from(self.clear(index(row * self.stride + column + self.origin))))
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
        for k in 0..LANES {
            sighting.clear[k] = f64::from(self.distance(places[k]));
        }
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

    /// Takes up where all views see the points.
    #[inline(always)]
    pub(super) fn sight(&mut self, fields: &[Field]) {
        self.sightings.resize(fields.len(), Sighting::default());
        for (field, sighting) in fields.iter().zip(&mut self.sightings) {
            field.sight(&self.point, sighting);
        }
    }

    /// The same, as long as any of the points `inside` is seen inside by all views; which are.
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
