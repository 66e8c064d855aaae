//! Which of many points provably leave the hull before they have gone so far: a look at where they would be then.

use super::projection::ViewKernel;
use super::{ExitRay, Wide};
use crate::camera::MIN_DEPTH;
use crate::math::lanes::{floor, lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;
use crate::math::vectorised;
use crate::silhouette::HALF_COVERAGE;

/// Far more than rounding, in pixels.
const ROUNDING_PX: f64 = 1e-6;

vectorised! {
    /// Adds the places of those of `rays` to `kept` that are not provably outside at their `t`, since no view sees
    /// background there; the first has the place `base`. The view that rejected the last ones is asked first.
    pub(super) fn keep(
        kernels: &[ViewKernel],
        rays: &[ExitRay],
        t: &[f64],
        base: usize,
        first: &mut usize,
        kept: &mut Vec<usize>,
    ) {
        let mut ends = [[0.0; LANES]; 3];
        for k in 0..LANES {
            let (ray, t) = (&rays[k.min(rays.len() - 1)], t[k.min(rays.len() - 1)]);
            for axis in 0..3 {
                ends[axis][k] = ray.point[axis] + ray.direction[axis] * t;
            }
        }
        let mut left = u32::MAX >> (LANES - rays.len());
        for place in (*first..kernels.len()).chain(0..*first) {
            left &= !kernels[place].sees_background(&ends, left);
            if left == 0 {
                *first = place;
                return;
            }
        }
        for k in set_bits(left) {
            kept.push(base + k);
        }
    }
}

impl ViewKernel<'_> {
    /// Which of the points `asked` the view sees outside, however their places are rounded.
    #[inline(always)]
    fn sees_background(&self, [x, y, z]: &[Wide; 3], asked: u32) -> u32 {
        let (mut column, mut row, mut may_be) = ([0.0; LANES], [0.0; LANES], [0; LANES]);
        let (mut in_reach, mut at) = ([0; LANES], [[0.0; LANES]; 2]);
        for k in 0..LANES {
            let [pu, pv, pd] = &self.p;
            let pu = pu[0] * x[k] + pu[1] * y[k] + pu[2] * z[k] + pu[3];
            let pv = pv[0] * x[k] + pv[1] * y[k] + pv[2] * z[k] + pv[3];
            let pd = pd[0] * x[k] + pd[1] * y[k] + pd[2] * z[k] + pd[3];
            let (u, v) = (pu / pd, pv / pd);
            let within = (u >= ROUNDING_PX)
                & (u < self.size[0] - ROUNDING_PX)
                & (v >= ROUNDING_PX)
                & (v < self.size[1] - ROUNDING_PX);
            let within = within & (pd > MIN_DEPTH);
            let (u, v) = (select(within, u, 0.5) - self.shift, select(within, v, 0.5) - self.shift);
            let (i, j) = (floor(u), floor(v));
            // Bilinear coverage is continuous, so that only whole pixels have a rim.
            let off_rim = |x: f64, i: f64| (x - i > ROUNDING_PX) & (x - i < 1.0 - ROUNDING_PX);
            let is_sure = self.by_coverage | (off_rim(u, i) & off_rim(v, j));
            may_be[k] = u32::from(within & is_sure);
            // Farther out all is background.
            let reach = 2.0 * self.shift;
            let in_columns = (i >= self.low[0] - reach) & (i < self.high[0]);
            let in_rows = (j >= self.low[1] - reach) & (j < self.high[1]);
            in_reach[k] = u32::from(in_columns & in_rows);
            (column[k], row[k]) = (i, j);
            (at[0][k], at[1][k]) = (u, v);
        }
        let (background, on_edge) = self.classify(&column, &row);
        let (in_reach, may_be) = (lane_mask(&in_reach), lane_mask(&may_be) & asked);
        let mut outside = (background | !in_reach) & may_be;
        for k in set_bits(on_edge & in_reach & may_be) {
            let (u, v) = (at[0][k] + self.shift, at[1][k] + self.shift);
            let is_outside = self.coverage(u, v) < HALF_COVERAGE - 255.0 * ROUNDING_PX;
            outside |= u32::from(is_outside) << k;
        }
        outside
    }

    /// Which cells have no subject pixel at any corner, and which some but not all. Cells are pixels, which have one
    /// corner, or squares between the centres of four.
    #[inline(always)]
    fn classify(&self, column: &Wide, row: &Wide) -> (u32, u32) {
        let mut least = [0.0; LANES];
        self.find_cell_distances(column, row, &mut least);
        let mut largest = least;
        if self.by_coverage {
            for corner in [0.0, 1.0, self.stride, self.stride + 1.0] {
                let mut of_corner = [0.0; LANES];
                self.find_distances(column, row, corner, &mut of_corner);
                for k in 0..LANES {
                    largest[k] = select(of_corner[k] > largest[k], of_corner[k], largest[k]);
                }
            }
        }
        let (mut none, mut some) = ([0; LANES], [0; LANES]);
        for k in 0..LANES {
            none[k] = u32::from(largest[k] == 0.0);
            some[k] = u32::from((least[k] == 0.0) & (largest[k] > 0.0));
        }
        (lane_mask(&none), lane_mask(&some))
    }
}
