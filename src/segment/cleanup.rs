//! Correction of masks: ragged edges, gaps, specks and holes.

use super::morphology::Morphology;
use crate::silhouette::PackedMask;
use crate::silhouette::bit_image::BitImage;
use crate::silhouette::regions::Regions;
use crate::{Error, Result};
use image::GrayImage;

/// The steps of a mask's clean-up, in this order: opening, closing, holes, small regions, margin.
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
    /// Parts of the subject narrower than about twice this are removed (an opening by an octagon), in pixels. Default
    /// 1, which removes noise of single pixels and lines, and parts that are two pixels wide.
    pub open_px: u32,
    /// Gaps narrower than about twice this are closed (a closing by an octagon), in pixels. Default 2; choose less for
    /// images in which limbs are only a few pixels apart.
    pub close_px: u32,
    /// Holes smaller than this are filled, in pixels of area. Default 100: the holes between a person's arm and side
    /// are larger except just before they close.
    pub smallest_hole_px: u32,
    /// Separate regions of the subject smaller than this are dropped, in pixels of area. Default 40.
    pub smallest_region_px: u32,
    /// Regions smaller than this share of the largest region's area are dropped too, from 0 to 1. Default 0.3: a
    /// person is one region, and others are reflections or objects that were moved. With 1 only the largest remains;
    /// choose 0.02 for masks in pieces or for several people.
    pub smallest_region_share: f64,
    /// The subject finally grows by this many pixels on all sides. Default 0. A hull lacks whatever any of its
    /// silhouettes lacks: if that is worse than a hull that is too large, a margin makes silhouettes conservative.
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
    /// No clean-up.
    pub const NONE: Self = Self {
        open_px: 0,
        close_px: 0,
        smallest_hole_px: 0,
        smallest_region_px: 0,
        smallest_region_share: 0.0,
        margin_px: 0,
    };

    /// Cleans up any mask in place. Pixels that change sides become 0 or 255, the others keep their coverage.
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

        // A set bit is now a pixel that changes sides.
        let width = mask.width() as usize;
        let bytes: &mut [u8] = mask;
        bits.for_each(|x, y| {
            let byte = &mut bytes[y * width + x];
            *byte = if *byte >= 128 { 0 } else { 255 };
        });
        Ok(())
    }

    /// Checks the share.
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

/// Buffers for the clean-up of masks.
#[derive(Debug, Clone, Default)]
pub(super) struct Cleaner {
    pub(super) morphology: Morphology,
    regions: Regions,
}

impl Cleaner {
    /// Applies the clean-up to `bits`.
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
