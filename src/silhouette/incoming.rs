//! A mask in either form in which it may be passed in, before a silhouette is prepared from it.

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
