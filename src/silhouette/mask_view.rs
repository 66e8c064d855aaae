//! A mask that is borrowed from the buffer that holds its bytes.

use crate::{Error, Result};
use image::GrayImage;

/// A borrowed mask with one byte per pixel, from 0 (background) to 255 (subject), row by row from the top.
///
/// Rows may be followed by padding, as in buffers of camera drivers, OpenCV and numpy. The *stride* is the number of
/// bytes from the first byte of a row to the first byte of the next.
///
/// ```
/// use ode_visual_hull::silhouette::MaskView;
///
/// // Two rows of three pixels, each followed by a byte of padding.
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
    /// A mask of `size` pixels (width, height) whose rows begin `stride` bytes apart. The last row needs no padding.
    ///
    /// # Errors
    /// If `stride` is less than the width, or if there are fewer bytes than the rows take.
    pub fn new(bytes: &'a [u8], size: (u32, u32), stride: usize) -> Result<Self> {
        let (width, height) = (size.0 as usize, size.1 as usize);
        if stride < width {
            return Err(Error::argument(format!(
                "stride: expected at least the width of {width} pixels, found {stride}; give the bytes from one row's \
                 first pixel to the next row's"
            )));
        }

        // `None` if there are no rows, or on overflow.
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

    /// Bytes from the first pixel of a row to the first pixel of the next.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// The bytes of row `y`.
    ///
    /// # Panics
    /// If `y` is not less than the height.
    pub fn row(&self, y: usize) -> &'a [u8] {
        assert!(y < self.size.1 as usize, "expected a row below the height of {}, found {y}", self.size.1);
        &self.bytes[y * self.stride..][..self.size.0 as usize]
    }

    /// The bytes of all rows, from the top.
    pub fn rows(&self) -> impl DoubleEndedIterator<Item = &'a [u8]> + ExactSizeIterator {
        let view = *self;
        (0..self.size.1 as usize).map(move |y| view.row(y))
    }

    /// All bytes, including the padding of rows.
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
