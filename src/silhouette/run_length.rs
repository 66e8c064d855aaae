//! Masks as run lengths, for a network or a file (paper, section 6.1).
//!
//! ```text
//!   row above    . . . # # # # # . . . .        its runs begin and end in columns 3 and 8
//!   row          . . + # # # # # # + . .        coded: as many ends as above, which move by 0 and 1; one pixel of
//!                                               coverage (+) before the first end, and one after the last
//! ```
//!
//! An outline seldom moves by more than a pixel or two from one row to the next, so an end of a run takes about three
//! bits. A byte of coverage takes seven bits, since the runs tell whether its pixel is subject.
//!
//! The header consists of the format's mark, a byte of flags, and six little-endian numbers of 16 bits: width, height,
//! and the rectangle outside which all bytes are 0, as first and past-the-last column, first and past-the-last row.
//! Then follow bits, the highest of each byte first. For each row of the rectangle these are:
//!
//! 1. The ends of the row's runs of subject, ascending. If there are as many as in the row above: a 1, and the movement
//!    of each end. Otherwise: a 0, half of their number, and the gap before each end.
//! 2. If coverage is kept: for each end the number of pixels with coverage directly before and directly after it; the
//!    number of other runs of such pixels, and for each run the gap before it and its length less 1; the lower seven
//!    bits of each byte of coverage.
//!
//! Numbers are Rice codes: `n >> k` in unary, then the lowest `k` bits of `n`. A movement `m` is coded as `2 m`, or as
//! `-2 m - 1` if it is negative.

mod decoder;
mod encoder;

use super::{PackedMask, Rect};
use crate::{Error, Result};
use decoder::Decoder;
use encoder::Encoder;

/// The first bytes of every coded mask: the format's name and version.
pub(crate) const MARK: [u8; 4] = *b"VHR1";

/// The flag of a mask with coverage.
const COVERAGE: u8 = 1;

/// Length of the header in bytes.
const HEADER: usize = MARK.len() + 1 + 2 * 6;

/// Largest number of pixels in a mask. It bounds the memory that a few malformed bytes can demand.
const MOST_PIXELS: u64 = 1 << 28;

// The parameters `k` of the Rice codes, chosen for masks of people at 640 x 480 pixels.

/// Rice parameter of the movements of ends.
const MOVED: u32 = 0;

/// Rice parameter of the gaps before ends.
const GAP: u32 = 5;

/// Rice parameter of the number of runs in a row.
const ENDS: u32 = 1;

/// Rice parameter of the gaps before other runs of coverage.
const COVERAGE_GAP: u32 = 5;

/// Rice parameter of the numbers of pixels and of runs with coverage, which are thus unary.
const COUNT: u32 = 0;

/// Bytes of coverage whose lower seven bits are written as one number.
const EIGHT: usize = 8;

impl PackedMask {
    /// Encodes the mask with its coverage as run lengths. [`decode`](Self::decode) returns the same mask.
    ///
    /// # Errors
    /// If the mask has more than 65,535 pixels on a side, or more than 2^28 in all.
    pub fn encode(&self) -> Result<Vec<u8>> {
        self.encode_as(self.has_coverage())
    }

    /// Encodes the mask without its coverage, as by [`binary`](Self::binary), as run lengths. That takes about a sixth
    /// of the bytes.
    ///
    /// # Errors
    /// See [`encode`](Self::encode).
    pub fn encode_binary(&self) -> Result<Vec<u8>> {
        self.encode_as(false)
    }

    /// Decodes a mask from run lengths.
    ///
    /// # Errors
    /// If [`encode`](Self::encode) does not write such bytes: they have another format or version, end early, continue
    /// after the last row, or hold runs that leave the image or overlap.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        let mut mask = Self::default();
        mask.decode_from(bytes)?;
        Ok(mask)
    }

    /// Decodes a mask from run lengths in the memory of the last one. After an error the mask is empty.
    ///
    /// # Errors
    /// See [`decode`](Self::decode).
    pub fn decode_from(&mut self, bytes: &[u8]) -> Result<()> {
        let result = Header::read(bytes).and_then(|header| Decoder::new(bytes, header, self).decode());
        result.map_err(|problem| {
            *self = Self::default();
            Error::argument(format!("run lengths of a mask: {problem}"))
        })
    }

    /// Encodes the mask with or without its coverage.
    fn encode_as(&self, with_coverage: bool) -> Result<Vec<u8>> {
        let (width, height) = self.size();
        if width.max(height) > u32::from(u16::MAX) || u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(Error::argument(format!(
                "expected a mask of at most 65,535 pixels a side and 2^28 in all, found {width} x {height}; scale it \
                 down"
            )));
        }

        let rect = if with_coverage { self.occupied() } else { self.rect() };
        let mut bytes = Vec::with_capacity(HEADER);
        bytes.extend(MARK);
        bytes.push(if with_coverage { COVERAGE } else { 0 });
        let corners = [rect.x0, rect.x1, rect.y0, rect.y1].map(|side| side as u16);
        for number in [width as u16, height as u16].into_iter().chain(corners) {
            bytes.extend(number.to_le_bytes());
        }

        let encoded = Encoder::new(bytes).write(self, &rect, with_coverage);
        // Writing to memory does not fail.
        encoded.map_err(|e| Error::argument(format!("mask: {e}")))
    }

    /// The smallest rectangle around the bytes that are not 0.
    fn occupied(&self) -> Rect {
        let mut rect = self.rect();
        for y in 0..self.size().1 as usize {
            let columns = self.coverage().columns(y);
            if let (Some(&first), Some(&last)) = (columns.first(), columns.last()) {
                let y = y as i32;
                rect = rect.union(&Rect { x0: first as i32, y0: y, x1: last as i32 + 1, y1: y + 1 });
            }
        }
        rect
    }
}

/// The header of a coded mask.
struct Header {
    size: (u32, u32),
    rect: Rect,
    has_coverage: bool,
}

impl Header {
    /// Reads and checks the header, or returns what is wrong with it.
    fn read(bytes: &[u8]) -> std::result::Result<Self, String> {
        if !bytes.starts_with(&MARK) {
            return Err(format!(
                "expected bytes that begin with {:?}, found others; check that a mask was coded, by this version",
                String::from_utf8_lossy(&MARK)
            ));
        }

        let Some((flags, numbers)) = bytes.get(MARK.len()..HEADER).and_then(<[u8]>::split_first) else {
            return Err(ended_early(bytes.len()));
        };
        let [width, height, x0, x1, y0, y1] =
            [0, 2, 4, 6, 8, 10].map(|k| u32::from(u16::from_le_bytes([numbers[k], numbers[k + 1]])));

        if *flags > COVERAGE {
            return Err(format!("expected flags of 0 or 1, found {flags}; a newer version wrote them"));
        }
        if u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(format!("expected at most 2^28 pixels, found {width} x {height}"));
        }
        if x0 > x1 || y0 > y1 || x1 > width || y1 > height {
            return Err(format!(
                "expected a rectangle within {width} x {height} pixels, found columns {x0}..{x1} and rows {y0}..{y1}"
            ));
        }

        let rect = Rect { x0: x0 as i32, y0: y0 as i32, x1: x1 as i32, y1: y1 as i32 };
        Ok(Self { size: (width, height), rect, has_coverage: *flags == COVERAGE })
    }
}

/// The message for bytes that end before the last row.
fn ended_early(length: usize) -> String {
    format!("expected more bytes, found an end after {length}; send or copy all of them")
}

#[cfg(test)]
mod tests;
