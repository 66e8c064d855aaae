//! Masks as run lengths, for a network or a file (paper, section 6.1).
//!
//! ```text
//!   row above    . . . # # # # # . . . .        its runs begin and end in columns 3 and 8
//!   row          . . + # # # # # # + . .        coded: as many ends as above, which move by 0 and 1;
//!                                               before the first end and behind the last lies one pixel of coverage
//! ```
//!
//! An outline seldom moves by more than a pixel or two from one row to the next, so that an end of a run takes about three
//! bits. A byte of coverage takes seven: whether its pixel is subject is known.
//!
//! The first bytes are the format's mark, a byte of flags, and as numbers of 16 bits, the lower byte first, width, height,
//! and the rectangle outside which all bytes are 0: first and past-the-last column, first and past-the-last row. Then come
//! bits, the highest of a byte first, for each row of the rectangle:
//!
//! 1. The ends of its runs of subject, ascending. A 1 and how far each has moved, if they are as many as in the row
//!    above; else a 0, their number and the gaps between them.
//! 2. Where coverage is kept: for each end how many pixels with coverage lie straight before and straight behind it; the
//!    number of other runs of such pixels, and for each the gap before it and its length less 1; and the lower seven bits
//!    of each byte.
//!
//! Numbers are Rice codes: what is left of `n` without its lowest `k` bits in unary, then these bits. A movement `m` is
//! coded as `2 m`, or `-2 m - 1` where it is negative.

mod decoder;
mod encoder;

use super::{PackedMask, Rect};
use crate::{Error, Result};
use decoder::Decoder;
use encoder::Encoder;

/// What begins every coded mask: the format's name and version.
pub(crate) const MARK: [u8; 4] = *b"VHR1";

/// The flag of a mask with coverage.
const COVERAGE: u8 = 1;

/// Bytes before the runs.
const HEADER: usize = MARK.len() + 1 + 2 * 6;

/// The most pixels that are decoded: a few bytes can tell of any number.
const MOST_PIXELS: u64 = 1 << 28;

/// The lowest bits of Rice codes, for masks of people at 640 x 480 pixels: of movements, of gaps between ends, of numbers
/// of ends, and of gaps before other runs of coverage. Counts of pixels with coverage are unary.
const MOVED: u32 = 0;
const GAP: u32 = 5;
const ENDS: u32 = 1;
const COVERAGE_GAP: u32 = 5;
const COUNT: u32 = 0;

/// Bytes of coverage whose lower seven bits are written together.
const EIGHT: usize = 8;

impl PackedMask {
    /// The mask as run lengths, coverage kept: [`decode`](Self::decode) gives it back.
    ///
    /// # Errors
    /// More than 65,535 pixels a side, or 2^28 in all.
    pub fn encode(&self) -> Result<Vec<u8>> {
        self.encode_as(self.has_coverage())
    }

    /// The mask as run lengths without its coverage, as [`binary`](Self::binary) leaves it; about a sixth of the bytes.
    ///
    /// # Errors
    /// As [`encode`](Self::encode).
    pub fn encode_binary(&self) -> Result<Vec<u8>> {
        self.encode_as(false)
    }

    /// The mask of run lengths.
    ///
    /// # Errors
    /// Bytes that [`encode`](Self::encode) does not write: of another format or version, that end early, go on behind the
    /// last row, or hold runs that leave the image or overlap.
    pub fn decode(bytes: &[u8]) -> Result<Self> {
        let mut mask = Self::default();
        mask.decode_from(bytes)?;
        Ok(mask)
    }

    /// Takes the mask of run lengths, in the memory of the last one. After an error it is empty.
    ///
    /// # Errors
    /// As [`decode`](Self::decode).
    pub fn decode_from(&mut self, bytes: &[u8]) -> Result<()> {
        let result = Header::read(bytes).and_then(|header| Decoder::new(bytes, header, self).decode());
        result.map_err(|problem| {
            *self = Self::default();
            Error::argument(format!("run lengths of a mask: {problem}"))
        })
    }

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

/// What stands before the runs.
struct Header {
    size: (u32, u32),
    rect: Rect,
    has_coverage: bool,
}

impl Header {
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

fn ended_early(length: usize) -> String {
    format!("expected more bytes, found an end after {length}; send or copy all of them")
}

#[cfg(test)]
mod tests;
