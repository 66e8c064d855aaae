//! How many metres a pixel covers.

use nalgebra::Matrix3;

/// How many metres a pixel covers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Footprint {
    fx: f64,
    fy: f64,
    /// One pixel down moves (-s / (fx fy), 1 / fy) on the plane at depth 1: this many times 1 / fy. The skew s is zero
    /// for most cameras.
    down_stretch: f64,
    /// Whether the step to the right is the smaller one at every depth.
    is_right: bool,
}

impl Footprint {
    pub(crate) fn new(k: &Matrix3<f64>) -> Self {
        let (fx, fy) = (k[(0, 0)], k[(1, 1)]);
        let down_stretch = (k[(0, 1)] / fx).hypot(1.0);
        // The same bits, or far from them.
        let is_right = (fx == fy && down_stretch == 1.0) || fx * down_stretch > fy * (1.0 + 1e-9);
        Self { fx, fy, down_stretch, is_right }
    }

    /// [`Self::at`] each of many depths.
    #[inline(always)]
    pub(crate) fn at_each<const N: usize>(&self, depths: &[f64; N], footprints: &mut [f64; N]) {
        if self.is_right {
            for (footprint, depth) in footprints.iter_mut().zip(depths) {
                *footprint = depth / self.fx;
            }
        } else {
            for (footprint, depth) in footprints.iter_mut().zip(depths) {
                *footprint = self.at(*depth);
            }
        }
    }

    /// At a depth: the smaller of the steps to the right and down (design: d_i of the window search).
    #[inline(always)]
    pub(crate) fn at(&self, depth: f64) -> f64 {
        let right = depth / self.fx;
        let down = depth / self.fy * self.down_stretch;
        if down < right { down } else { right }
    }
}
