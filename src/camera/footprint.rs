//! The size of a pixel's footprint in the scene, which sets the windows' growth in the window search.

use nalgebra::Matrix3;

/// How many metres a pixel covers, as a function of depth: the smaller of the steps that one pixel to the right and one
/// pixel down make on a plane of constant depth.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Footprint {
    fx: f64,
    fy: f64,
    /// The length of the step down, in units of 1 / fy. On the plane at depth 1 the step is (-s / (fx fy), 1 / fy); the
    /// skew s is zero for most cameras.
    down_stretch: f64,
    /// Whether the step to the right is surely the smaller one at every depth.
    is_right: bool,
}

impl Footprint {
    pub(crate) fn new(k: &Matrix3<f64>) -> Self {
        let (fx, fy) = (k[(0, 0)], k[(1, 1)]);
        let down_stretch = (k[(0, 1)] / fx).hypot(1.0);
        // Either both steps have the same bits at every depth, or they differ by more than rounding.
        let is_right = (fx == fy && down_stretch == 1.0) || fx * down_stretch > fy * (1.0 + 1e-9);
        Self { fx, fy, down_stretch, is_right }
    }

    /// Computes [`Self::at`] for many depths.
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

    /// Metres that a pixel covers at `depth` metres: `d_i` of the window search (paper, section 4.2).
    #[inline(always)]
    pub(crate) fn at(&self, depth: f64) -> f64 {
        let right = depth / self.fx;
        let down = depth / self.fy * self.down_stretch;
        if down < right { down } else { right }
    }
}
