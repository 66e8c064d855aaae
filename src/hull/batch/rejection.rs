//! Which of many points provably leave the hull before they have gone so far: a look at where they would be then.

use super::super::lanes::{floor, lane_mask, select, set_bits};
use super::super::points::LANES;
use super::projection::ViewKernel;
use super::{ExitRay, Wide};
use crate::camera::MIN_DEPTH;
use crate::vectorised::vectorised;

/// Far more than rounding, in pixels.
const RIM: f64 = 1e-6;

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
            left &= !kernels[place].sees_background(&ends);
            if left == 0 {
                *first = place;
                return;
            }
        }
        kept.extend(set_bits(left).map(|k| base + k));
    }
}

impl ViewKernel<'_> {
    /// Which points the view sees outside, however their places are rounded.
    #[inline(always)]
    fn sees_background(&self, [x, y, z]: &[Wide; 3]) -> u32 {
        let (mut column, mut row, mut may_be) = ([0.0; LANES], [0.0; LANES], [0; LANES]);
        let mut in_reach = [0; LANES];
        for k in 0..LANES {
            let [pu, pv, pd] = self.p.each_ref().map(|p| p[0] * x[k] + p[1] * y[k] + p[2] * z[k] + p[3]);
            let (u, v) = (pu / pd, pv / pd);
            let within = (u >= RIM) & (u < self.size[0] - RIM) & (v >= RIM) & (v < self.size[1] - RIM);
            let within = within & (pd > MIN_DEPTH);
            let (u, v) = (select(within, u, 0.5) - self.shift, select(within, v, 0.5) - self.shift);
            let (i, j) = (floor(u), floor(v));
            // Bilinear coverage is continuous, so that only whole pixels have a rim.
            let off_rim = |x: f64, i: f64| (x - i > RIM) & (x - i < 1.0 - RIM);
            let is_sure = self.by_coverage | (off_rim(u, i) & off_rim(v, j));
            may_be[k] = u32::from(within & is_sure);
            // Farther out all is background.
            let reach = 2.0 * self.shift;
            let in_columns = (i >= self.low[0] - reach) & (i < self.high[0]);
            let in_rows = (j >= self.low[1] - reach) & (j < self.high[1]);
            in_reach[k] = u32::from(in_columns & in_rows);
            (column[k], row[k]) = (i, j);
        }
        let mut background = self.have_no_subject(&column, &row);
        background |= !lane_mask(&in_reach);
        background & lane_mask(&may_be)
    }

    /// Which cells have no subject pixel at any corner; cells are pixels, or squares between the centres of four.
    #[inline(always)]
    fn have_no_subject(&self, column: &Wide, row: &Wide) -> u32 {
        let mut largest = [0.0; LANES];
        self.find_distances(column, row, 0.0, &mut largest);
        if self.by_coverage {
            for beside in self.other_corners() {
                let mut of_corner = [0.0; LANES];
                self.find_distances(column, row, beside, &mut of_corner);
                for k in 0..LANES {
                    largest[k] = select(of_corner[k] > largest[k], of_corner[k], largest[k]);
                }
            }
        }
        let mut none = [0; LANES];
        for k in 0..LANES {
            none[k] = u32::from(largest[k] == 0.0);
        }
        lane_mask(&none)
    }
}
