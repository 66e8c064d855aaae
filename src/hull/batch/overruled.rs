//! Points at which a view is overruled. Which they are is decided side by side; the single queries do the rest.

use super::nearest_edge::Decision;
use super::projection::{PointBlock, ViewKernel};
use crate::hull::Hull;
use crate::hull::query::{ViewSamples, deciding_window};
use crate::math::lanes::{lane_mask, select, set_bits};
use crate::math::point_cloud::LANES;

/// Decides again for the points of a block at which a view is overruled. `inside` holds the points that at most one view
/// sees outside, and `outside` those that one does. Returns bit masks of the points that are inside, and of those of them
/// at which a view is overruled.
#[inline(always)]
pub(super) fn overrule(
    hull: &Hull,
    kernels: &[ViewKernel],
    block: &PointBlock,
    depth: f64,
    (inside, outside): (u32, u32),
    decision: &mut Decision,
) -> (u32, u32) {
    let differ = differ_by(block, depth);
    let (mut inside, mut overrules) = (inside & (differ | !outside), 0);
    for k in set_bits(inside & differ) {
        ViewSamples::with(|samples| {
            if !samples.project_if_inside(hull, &block.point(k), kernels[0].edge) {
                inside &= !(1 << k);
            } else if samples.overruled.is_some() {
                overrules |= 1 << k;
                let window = deciding_window(samples).and_then(|(sample, half)| {
                    let place = kernels.iter().position(|kernel| kernel.index == sample.index)?;
                    Some((place, half))
                });
                decision.replace(k, window);
            }
        });
    }
    (inside, overrules)
}

/// The points whose least depth over the views lies by `depth` metres below that in all others.
#[inline(always)]
fn differ_by(block: &PointBlock, depth: f64) -> u32 {
    let (mut least, mut second) = ([f64::INFINITY; LANES], [f64::INFINITY; LANES]);
    for sample in &block.samples {
        for k in 0..LANES {
            // A view that abstains has the point at depth 0 from the camera.
            let of_view = sample.distance[k] * sample.footprint[k];
            let of_view = select(sample.at[2][k] > 0.0, of_view, f64::INFINITY);
            let is_less = of_view < least[k];
            let other = select(is_less, least[k], of_view);
            second[k] = select(other < second[k], other, second[k]);
            least[k] = select(is_less, of_view, least[k]);
        }
    }
    let mut differ = [0; LANES];
    for k in 0..LANES {
        differ[k] = u32::from(second[k] - least[k] >= depth);
    }
    lane_mask(&differ)
}
