//! Which of many rays provably leave the hull before a given distance: some view sees background at that point of the
//! ray.

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
    /// Adds to `kept` the indices of the `rays` that are not provably outside at their `t`, in metres; the first of
    /// them has index `base`. Views are tested in turn from `first` on, which becomes the view that rejected the last
    /// ray: it is likely to reject the next ones too.
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

        // Where a view is overruled, background is no proof.
        let mut overruled = [0; LANES];
        for (overruled, ray) in overruled.iter_mut().zip(rays) {
            *overruled = u32::from(ray.overrules);
        }
        let overruled = lane_mask(&overruled);

        let mut remaining = u32::MAX >> (LANES - rays.len());
        for place in (*first..kernels.len()).chain(0..*first) {
            remaining &= !kernels[place].sees_background(&ends, remaining) | overruled;
            if remaining == 0 {
                *first = place;
                return;
            }
        }

        for k in set_bits(remaining) {
            kept.push(base + k);
        }
    }
}

impl ViewKernel<'_> {
    /// Which of the points in the bit mask `active` the view sees outside, regardless of rounding in the projection.
    #[inline(always)]
    fn sees_background(&self, [x, y, z]: &[Wide; 3], active: u32) -> u32 {
        let (mut column, mut row, mut is_sure) = ([0.0; LANES], [0.0; LANES], [0; LANES]);
        let (mut in_reach, mut at) = ([0; LANES], [[0.0; LANES]; 2]);

        // The cell of each point, whether rounding could place the point in another, and whether the cell is in reach
        // of the silhouette's rectangle.
        for k in 0..LANES {
            let [pu, pv, pd] = &self.p;
            let pu = pu[0] * x[k] + pu[1] * y[k] + pu[2] * z[k] + pu[3];
            let pv = pv[0] * x[k] + pv[1] * y[k] + pv[2] * z[k] + pv[3];
            let pd = pd[0] * x[k] + pd[1] * y[k] + pd[2] * z[k] + pd[3];

            let (u, v) = (pu / pd, pv / pd);
            let in_image = (u >= ROUNDING_PX)
                & (u < self.size[0] - ROUNDING_PX)
                & (v >= ROUNDING_PX)
                & (v < self.size[1] - ROUNDING_PX);
            let in_image = in_image & (pd > MIN_DEPTH);
            let (u, v) = (select(in_image, u, 0.5) - self.shift, select(in_image, v, 0.5) - self.shift);
            let (i, j) = (floor(u), floor(v));

            // Only at pixels' borders does the verdict jump; bilinear coverage is continuous.
            let off_border = |x: f64, i: f64| (x - i > ROUNDING_PX) & (x - i < 1.0 - ROUNDING_PX);
            is_sure[k] = u32::from(in_image & (self.by_coverage | (off_border(u, i) & off_border(v, j))));

            // Everything farther out is background.
            let reach = 2.0 * self.shift;
            let in_columns = (i >= self.low[0] - reach) & (i < self.high[0]);
            let in_rows = (j >= self.low[1] - reach) & (j < self.high[1]);
            in_reach[k] = u32::from(in_columns & in_rows);
            (column[k], row[k]) = (i, j);
            (at[0][k], at[1][k]) = (u, v);
        }

        let (background, on_edge) = self.classify(&column, &row);
        let (in_reach, is_sure) = (lane_mask(&in_reach), lane_mask(&is_sure) & active);
        let mut outside = (background | !in_reach) & is_sure;

        // In a cell that an edge crosses, coverage decides.
        for k in set_bits(on_edge & in_reach & is_sure) {
            let (u, v) = (at[0][k] + self.shift, at[1][k] + self.shift);
            let is_outside = self.coverage(u, v) < HALF_COVERAGE - 255.0 * ROUNDING_PX;
            outside |= u32::from(is_outside) << k;
        }
        outside
    }

    /// Which cells have no subject pixel at any corner, and which have some but not all, as bit masks. Cells are
    /// pixels, which count as one corner, or squares between four pixel centres.
    #[inline(always)]
    fn classify(&self, column: &Wide, row: &Wide) -> (u32, u32) {
        // The least distance to the background over the corners, and the largest.
        let mut least = [0.0; LANES];
        self.find_cell_distances(column, row, &mut least);
        let mut largest = least;
        if self.by_coverage {
            for offset in [0.0, 1.0, self.stride, self.stride + 1.0] {
                let mut distance = [0.0; LANES];
                self.find_distances(column, row, offset, &mut distance);
                for k in 0..LANES {
                    largest[k] = select(distance[k] > largest[k], distance[k], largest[k]);
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
