//! A mask in either form in which it may be passed in, before a silhouette is prepared from it.

use super::bit_image::BitImage;
use super::regions::Regions;
use super::{MaskView, PackedMask, TileMask};
use image::GrayImage;

/// A mask as it is passed in.
#[derive(Debug, Clone, Copy)]
pub(crate) enum IncomingMask<'a> {
    Bytes(MaskView<'a>),
    Packed(&'a PackedMask),
}

/// Memory for converting a mask before a silhouette is prepared from it.
#[derive(Debug, Default)]
pub(crate) struct MaskScratch {
    /// A mask of a camera without a lens model, packed from bytes.
    pub(crate) packed: PackedMask,
    /// A mask of a camera with a lens model, unpacked to bytes.
    pub(crate) bytes: GrayImage,
    /// A mask of a camera with a lens model, undistorted.
    pub(crate) tiles: TileMask,
    pub(crate) holes: HoleScratch,
}

/// Memory for filling the holes of a mask.
#[derive(Debug, Default)]
pub(crate) struct HoleScratch {
    packed: PackedMask,
    subject: BitImage,
    regions: Regions,
    filled: PackedMask,
}

impl HoleScratch {
    /// The mask with its holes of fewer than `smallest_px` pixels filled.
    pub(crate) fn fill(&mut self, mask: IncomingMask, smallest_px: u32) -> &PackedMask {
        let Self { packed, subject, regions, filled } = self;
        let mask = mask.packed(packed);
        subject.copy(mask.subject());
        regions.fill_holes(subject, smallest_px);
        filled.copy_with_bits(mask, subject);
        filled
    }
}

impl<'a> IncomingMask<'a> {
    /// Width and height in pixels.
    pub(crate) fn size(self) -> (u32, u32) {
        match self {
            Self::Bytes(view) => view.size(),
            Self::Packed(packed) => packed.size(),
        }
    }

    /// The mask as bytes; a packed mask is unpacked to `memory`.
    pub(crate) fn bytes(self, memory: &'a mut GrayImage) -> MaskView<'a> {
        match self {
            Self::Bytes(view) => view,
            Self::Packed(packed) => {
                packed.write_to(memory);
                MaskView::from(&*memory)
            }
        }
    }

    /// The mask as a packed mask; bytes are packed to `memory`.
    pub(crate) fn packed<'m>(self, memory: &'m mut PackedMask) -> &'m PackedMask
    where
        'a: 'm,
    {
        match self {
            Self::Bytes(view) => {
                memory.pack(view);
                memory
            }
            Self::Packed(packed) => packed,
        }
    }
}
