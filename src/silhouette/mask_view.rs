//! A mask that is borrowed from whatever holds its bytes.

use crate::{Error, Result};
use image::GrayImage;

/// A mask that is borrowed: a byte a pixel, 0 background .. 255 subject, row by row from the upper one on.
///
/// Between the ends of two rows there may be other bytes, as camera drivers, OpenCV and numpy leave them: the *stride* is
/// the distance of two rows' first bytes.
///
/// ```
/// use ode_visual_hull::silhouette::MaskView;
///
/// // Two rows of three pixels, each followed by a byte that is none.
/// let bytes = [0, 255, 0, 99, 255, 255, 255, 99];
/// let mask = MaskView::new(&bytes, (3, 2), 4)?;
/// assert_eq!(mask.row(1), [255, 255, 255]);
/// # Ok::<(), ode_visual_hull::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MaskView<'a> {
    bytes: &'a [u8],
    size: (u32, u32),
    stride: usize,
}

impl<'a> MaskView<'a> {
    /// A mask of `size` pixels, width and height, whose rows begin `stride` bytes apart. What follows the last row is
    /// not looked at, and need not be there.
    ///
    /// # Errors
    /// A stride below the width; fewer bytes than the rows take.
    pub fn new(bytes: &'a [u8], size: (u32, u32), stride: usize) -> Result<Self> {
        let (width, height) = (size.0 as usize, size.1 as usize);
        if stride < width {
            return Err(Error::argument(format!(
                "stride: expected at least the width of {width} pixels, found {stride}; give the bytes from one row's \
                 first pixel to the next row's"
            )));
        }
        let needed = height.checked_sub(1).and_then(|rows| rows.checked_mul(stride)?.checked_add(width));
        match needed {
            Some(needed) if bytes.len() < needed => Err(Error::argument(format!(
                "mask: expected at least {needed} bytes for {height} rows of {width} pixels, {stride} bytes apart, \
                 found {}",
                bytes.len()
            ))),
            None if height > 0 => Err(Error::argument(format!(
                "stride: expected one that memory can hold, found {stride} bytes"
            ))),
            _ => Ok(Self { bytes, size, stride }),
        }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Bytes from one row's first pixel to the next row's.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The bytes of row `y`.
    ///
    /// # Panics
    /// On a row that is not below the height.
    pub fn row(&self, y: usize) -> &'a [u8] {
        assert!(y < self.size.1 as usize, "a row below the height of {}, not {y}", self.size.1);
        &self.bytes[y * self.stride..][..self.size.0 as usize]
    }

    /// The rows, from the upper one on.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = &'a [u8]> + ExactSizeIterator {
        let view = *self;
        (0..self.size.1 as usize).map(move |y| view.row(y))
    }

    /// All bytes, those between the rows too.
    pub(super) fn bytes(&self) -> &'a [u8] {
        self.bytes
    }
}

impl<'a> From<&'a GrayImage> for MaskView<'a> {
    fn from(mask: &'a GrayImage) -> Self {
        Self { bytes: mask.as_raw(), size: mask.dimensions(), stride: mask.width() as usize }
    }
}

#[cfg(test)]
mod tests;
