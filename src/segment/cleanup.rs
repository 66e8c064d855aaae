//! What a person would correct in a mask: ragged edges, gaps, specks and holes.

use super::morphology::Morphology;
use super::regions::Regions;
use crate::silhouette::PackedMask;
use crate::silhouette::bit_image::BitImage;
use crate::{Error, Result};
use image::GrayImage;

/// How a mask is cleaned up, in this order: opening, closing, holes, small regions, margin.
///
/// ```
/// use image::{GrayImage, Luma};
/// use ode_visual_hull::segment::Cleanup;
///
/// let mut mask = GrayImage::from_fn(64, 48, |x, y| Luma([if x < 30 && y < 40 { 255 } else { 0 }]));
/// mask.put_pixel(50, 10, Luma([255]));
/// mask.put_pixel(15, 20, Luma([0]));
/// Cleanup::default().apply(&mut mask)?;
/// assert_eq!((mask.get_pixel(50, 10).0, mask.get_pixel(15, 20).0), ([0], [255]));
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cleanup {
    /// Parts of the subject less than about twice this wide go (an opening, by an octagon). Default 1: noise of single
    /// pixels and lines; parts that are two pixels wide are lost too.
    pub open_px: u32,
    /// Gaps less than about twice this wide close (a closing). Default 2; less for
    /// images in which limbs are but a few pixels apart.
    pub close_px: u32,
    /// A smaller hole is filled, in pixels of area. Default 100: holes that a person makes, between arm and side, are
    /// larger in all but their last moment.
    pub smallest_hole_px: u32,
    /// A smaller separate region of the subject is dropped, in pixels of area. Default 40.
    pub smallest_region_px: u32,
    /// And one of less than this share of the largest region's area, 0 to 1. Default 0.3: a person is one piece,
    /// and what else differs is a reflection, or a thing that was moved. 1 leaves the largest alone; choose 0.02 where
    /// masks come in pieces, or several people are to be seen.
    pub smallest_region_share: f64,
    /// At last the subject grows by so many pixels on all sides. Default 0. A hull lacks whatever any of its silhouettes
    /// lacks: where that is worse than a hull that is too large, a margin makes silhouettes conservative.
    pub margin_px: u32,
}

impl Default for Cleanup {
    fn default() -> Self {
        Self {
            open_px: 1,
            close_px: 2,
            smallest_hole_px: 100,
            smallest_region_px: 40,
            smallest_region_share: 0.3,
            margin_px: 0,
        }
    }
}

impl Cleanup {
    /// Nothing is changed.
    pub const NONE: Self = Self {
        open_px: 0,
        close_px: 0,
        smallest_hole_px: 0,
        smallest_region_px: 0,
        smallest_region_share: 0.0,
        margin_px: 0,
    };

    /// Cleans up a mask from elsewhere. Pixels whose side changes become 0 or 255, the others keep their coverage.
    ///
    /// # Errors
    /// A share that is not from 0 to 1.
    pub fn apply(&self, mask: &mut GrayImage) -> Result<()> {
        self.check()?;
        let before = PackedMask::new(&*mask);
        let mut bits = before.subject().clone();
        Cleaner::default().clean(self, &mut bits);
        for (after, before) in bits.words_mut().iter_mut().zip(before.subject().words()) {
            *after ^= before;
        }
        let width = mask.width() as usize;
        let bytes: &mut [u8] = mask;
        bits.for_each(|x, y| {
            let byte = &mut bytes[y * width + x];
            *byte = if *byte >= 128 { 0 } else { 255 };
        });
        Ok(())
    }

    /// # Errors
    /// A share that is not from 0 to 1.
    pub(super) fn check(&self) -> Result<()> {
        if (0.0..=1.0).contains(&self.smallest_region_share) {
            return Ok(());
        }
        Err(Error::argument(format!(
            "expected a smallest region from 0 to 1 of the largest, found {}; 0 leaves regions of any size",
            self.smallest_region_share
        )))
    }
}

/// The memory in which masks are cleaned up.
#[derive(Debug, Clone, Default)]
pub(super) struct Cleaner {
    pub(super) morphology: Morphology,
    regions: Regions,
}

impl Cleaner {
    pub(super) fn clean(&mut self, cleanup: &Cleanup, bits: &mut BitImage) {
        let Self { morphology, regions } = self;
        morphology.shrink(bits, cleanup.open_px);
        morphology.grow(bits, cleanup.open_px);
        morphology.grow(bits, cleanup.close_px);
        morphology.shrink(bits, cleanup.close_px);
        if cleanup.smallest_hole_px > 1 {
            regions.fill_holes(bits, cleanup.smallest_hole_px);
        }
        if cleanup.smallest_region_px > 1 || cleanup.smallest_region_share > 0.0 {
            regions.drop_small(bits, cleanup.smallest_region_px, cleanup.smallest_region_share);
        }
        morphology.grow(bits, cleanup.margin_px);
    }
}

#[cfg(test)]
mod tests;
