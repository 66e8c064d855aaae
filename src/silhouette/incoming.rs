//! A mask on its way to a silhouette, in the form in which it comes.

use super::{MaskView, PackedMask, TileMask};
use image::GrayImage;

/// A mask as it comes in.
#[derive(Debug, Clone, Copy)]
pub(crate) enum IncomingMask<'a> {
    Bytes(MaskView<'a>),
    Packed(&'a PackedMask),
}

/// Memory for a mask on its way to a silhouette.
#[derive(Debug, Default)]
pub(crate) struct MaskScratch {
    /// Of bytes that a pinhole saw.
    pub(crate) packed: PackedMask,
    /// Of packed pixels that a lens saw.
    pub(crate) bytes: GrayImage,
    /// Of what a lens saw, as its pinhole would see it.
    pub(crate) tiles: TileMask,
}

impl<'a> IncomingMask<'a> {
    pub(crate) fn size(self) -> (u32, u32) {
        match self {
            Self::Bytes(view) => view.size(),
            Self::Packed(packed) => packed.size(),
        }
    }

    /// The mask as bytes, for which there is `memory`.
    pub(crate) fn bytes(self, memory: &'a mut GrayImage) -> MaskView<'a> {
        match self {
            Self::Bytes(view) => view,
            Self::Packed(packed) => {
                packed.write_to(memory);
                MaskView::from(&*memory)
            }
        }
    }

    /// The mask packed, for which there is `memory`.
    pub(crate) fn packed(self, memory: &'a mut PackedMask) -> &'a PackedMask {
        match self {
            Self::Bytes(view) => {
                memory.pack(view);
                memory
            }
            Self::Packed(packed) => packed,
        }
    }
}
