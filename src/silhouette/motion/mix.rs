//! How the distances of one or two images become the distance of a warped mask.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::distance_image::DistanceImage;
use crate::math::lanes::select;

/// A distance image that takes part in a warp: read where the flow leads, times a factor, and weighted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Term<'a> {
    pub(super) image: &'a DistanceImage,
    /// Whether it is the later of the flow's two images.
    pub(super) is_later: bool,
    pub(super) weight: f32,
    pub(super) along_flow: f32,
}

/// How the distances of two images are put together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Mix {
    /// Their weighted sum.
    Sum,
    /// Their weighted sum as far as they agree: the weight of the earlier image falls to zero where it differs by
    /// [`DISAGREEMENT`], as where the flow has lost a part of the subject.
    Agreement,
}

/// The difference of two distances, in pixels, from which on they are of different edges.
const DISAGREEMENT: f32 = 6.0;

impl Mix {
    /// The distance that follows from those of all terms.
    #[inline(always)]
    pub(super) fn distance<const N: usize>(self, terms: &[Term; N], distances: [f32; N]) -> f32 {
        let mut sum = 0.0;
        for k in 0..N {
            sum += terms[k].weight * distances[k];
        }
        if self == Self::Sum {
            return sum;
        }
        let (first, last) = (distances[0], distances[N - 1]);
        let part = (first - last) * (1.0 / DISAGREEMENT);
        let agreement = 1.0 - part * part;
        last + terms[0].weight * select(agreement > 0.0, agreement, 0.0) * (first - last)
    }

    /// A distance at most as large as that of any pixel of a cell, in the same sense, but for [`SPREAD`](super::warp::SPREAD); `distances`
    /// are the cell's means.
    #[inline(always)]
    pub(super) fn of_cell<const N: usize>(self, terms: &[Term; N], distances: [f32; N]) -> f32 {
        if self == Self::Sum {
            return self.distance(terms, distances);
        }
        let (first, last) = (distances[0], distances[N - 1]);
        let nearer = select(first.abs() < last.abs(), first, last);
        select(first * last > 0.0, nearer, 0.0)
    }
}
