//! Reading the runs of a mask, from bytes that need not be well formed.

use super::{COUNT, COVERAGE_GAP, EIGHT, ENDS, GAP, HEADER, Header, MOVED, ended_early};
use crate::math::lanes::set_bits;
use crate::silhouette::bit_image::{BitImage, WORD};
use crate::silhouette::{PackedMask, Rect, SUBJECT};
use bitstream_io::{BigEndian, BitRead, BitReader};
use std::io;

/// Reads the runs of one mask.
pub(super) struct Decoder<'a> {
    reader: BitReader<&'a [u8], BigEndian>,
    /// Number of bytes, with the header.
    length: usize,
    header: Header,
    mask: &'a mut PackedMask,
    /// [`Self::ends`] of the row above.
    above: Vec<u32>,
    /// The first and past-the-last columns of the row's runs of subject, ascending.
    ends: Vec<u32>,
    /// The pixels of the row that have coverage, as an image of one row.
    covered: BitImage,
}

impl<'a> Decoder<'a> {
    /// A decoder of bytes that begin with `header`, which writes to `mask`.
    pub(super) fn new(bytes: &'a [u8], header: Header, mask: &'a mut PackedMask) -> Self {
        let bits = BitReader::endian(&bytes[HEADER..], BigEndian);
        let (above, ends, covered) = (Vec::new(), Vec::new(), BitImage::default());
        Self { reader: bits, length: bytes.len(), header, mask, above, ends, covered }
    }

    /// Reads all rows, or returns what is wrong with the bytes.
    pub(super) fn decode(mut self) -> std::result::Result<(), String> {
        let Rect { y0, y1, .. } = self.header.rect;
        self.mask.restart(self.header.size);
        for y in y0 as usize..y1 as usize {
            self.read_row(y).map_err(|e| match e {
                RunError::Early => ended_early(self.length),
                RunError::Outside(what) => {
                    format!("row {y}: {what}; the bytes are damaged, send or copy them again")
                }
            })?;
        }

        // Only the bits that fill the last byte may remain.
        self.reader.byte_align();
        let extra = self.reader.aligned_reader().len();
        if extra > 0 {
            return Err(format!(
                "expected {} bytes, found {extra} more after the last row; pass the bytes of one mask",
                self.length - extra
            ));
        }
        self.mask.close_mask();
        Ok(())
    }

    /// Reads a row's runs and its coverage.
    fn read_row(&mut self, y: usize) -> std::result::Result<(), RunError> {
        std::mem::swap(&mut self.above, &mut self.ends);
        self.read_ends()?;
        for run in self.ends.as_chunks::<2>().0 {
            self.mask.subject_mut().flip_run(y, run[0] as usize, run[1] as usize);
        }
        if self.header.has_coverage {
            self.read_covered()?;
            self.read_bytes(y)?;
        }
        Ok(())
    }

    /// Reads the ends of a row's runs: ascending columns of the rectangle or the column after it.
    fn read_ends(&mut self) -> std::result::Result<(), RunError> {
        let (x0, x1) = (i64::from(self.header.rect.x0), i64::from(self.header.rect.x1));
        let is_alike = self.reader.read_bit()?;
        let count = match is_alike {
            true => self.above.len(),
            false => 2 * read_rice(&mut self.reader, ENDS)? as usize,
        };
        if count as i64 > x1 - x0 + 1 {
            return Err(RunError::Outside(format!(
                "expected at most {} ends of runs, found {count}",
                x1 - x0 + 1
            )));
        }

        self.ends.clear();
        for k in 0..count {
            let last = self.ends.last().map_or(x0 - 1, |&last| i64::from(last));
            let end = match is_alike {
                true => {
                    // A movement in zigzag code.
                    let code = i64::from(read_rice(&mut self.reader, MOVED)?);
                    i64::from(self.above[k]) + (code >> 1 ^ -(code & 1))
                }
                false => last.max(x0) + i64::from(read_rice(&mut self.reader, GAP)?),
            };

            if end <= last || end > x1 {
                let problem =
                    format!("expected the end of a run in columns {}..={x1}, found {end}", last + 1);
                return Err(RunError::Outside(problem));
            }
            self.ends.push(end as u32);
        }
        Ok(())
    }

    /// Reads which pixels of a row have coverage.
    fn read_covered(&mut self) -> std::result::Result<(), RunError> {
        self.covered.resize(self.header.size.0 as usize, 1);
        self.covered.words_mut().fill(0);

        // Pixels adjacent to the ends of runs. A start below column 0 is replaced by one that is refused.
        for k in 0..self.ends.len() {
            let end = u64::from(self.ends[k]);
            let (before, after) = (read_rice(&mut self.reader, COUNT)?, read_rice(&mut self.reader, COUNT)?);
            let start = end.checked_sub(u64::from(before)).unwrap_or(u64::MAX);
            self.cover(start, end)?;
            self.cover(end, end + u64::from(after))?;
        }

        // All other pixels, as runs.
        let mut last = self.header.rect.x0 as u64;
        for _ in 0..read_rice(&mut self.reader, COUNT)? {
            let start = last + u64::from(read_rice(&mut self.reader, COVERAGE_GAP)?);
            last = start + u64::from(read_rice(&mut self.reader, COUNT)?) + 1;
            self.cover(start, last)?;
        }
        Ok(())
    }

    /// Marks the columns `start..end` as pixels with coverage.
    fn cover(&mut self, start: u64, end: u64) -> std::result::Result<(), RunError> {
        let Rect { x0, x1, .. } = self.header.rect;
        if start < x0 as u64 || end > x1 as u64 || start > end {
            let problem = format!("expected coverage in columns {x0}..{x1}, found some in {start}..{end}");
            return Err(RunError::Outside(problem));
        }

        for x in start as usize..end as usize {
            if self.covered.get(x, 0) {
                return Err(RunError::Outside(format!(
                    "expected coverage once in column {x}, found it twice"
                )));
            }
            self.covered.set(x, 0, true);
        }
        Ok(())
    }

    /// Reads the bytes of a row's coverage.
    fn read_bytes(&mut self, y: usize) -> std::result::Result<(), RunError> {
        let (mut remaining, mut low, mut buffered) = (self.covered.count(), 0u64, 0);
        for (k, &word) in self.covered.row(0).iter().enumerate() {
            for bit in set_bits(word) {
                // The lower seven bits of the next bytes, up to eight of them.
                if buffered == 0 {
                    buffered = remaining.min(EIGHT);
                    remaining -= buffered;
                    low = self.reader.read_var(7 * buffered as u32)?;
                }
                buffered -= 1;

                // The highest bit tells whether the pixel is subject.
                let x = WORD * k + bit;
                let high = if self.mask.subject().get(x, y) { SUBJECT } else { 0 };
                let byte = high | (low >> (7 * buffered)) as u8 & !SUBJECT;
                if byte == 0 || byte == 255 {
                    let problem = format!("expected coverage of 1 to 254 in column {x}, found {byte}");
                    return Err(RunError::Outside(problem));
                }
                self.mask.push_coverage(x, y, byte);
            }
        }
        Ok(())
    }
}

/// What is wrong with a row of coded runs.
enum RunError {
    /// The bytes end before the last row does.
    Early,
    /// A number is out of range; the message names what was expected and what was found.
    Outside(String),
}

impl From<io::Error> for RunError {
    /// Reading from memory fails only at the end of the bytes.
    fn from(_: io::Error) -> Self {
        Self::Early
    }
}

/// Reads a Rice code with `low` lowest bits.
fn read_rice(bits: &mut impl BitRead, low: u32) -> std::result::Result<u32, RunError> {
    let high = bits.read_unary::<1>()?;
    let number = high.checked_mul(1 << low);
    let number = number
        .ok_or_else(|| RunError::Outside(format!("expected a number below 2^32, found {high} << {low}")))?;
    Ok(number | bits.read_var::<u32>(low)?)
}
