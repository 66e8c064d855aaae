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

use super::bit_image::BitImage;
use super::{PackedMask, Rect, SUBJECT};
use crate::math::lanes::set_bits;
use crate::{Error, Result};
use bitstream_io::{BigEndian, BitRead, BitReader, BitWrite, BitWriter};
use std::io;

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
        let mut encoder =
            Encoder { bits: BitWriter::endian(bytes, BigEndian), above: Vec::new(), ends: Vec::new() };
        // Writing to memory does not fail.
        encoder.write(self, &rect, with_coverage).map_err(|e| Error::argument(format!("mask: {e}")))?;
        Ok(encoder.bits.into_writer())
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

/// Writes the runs of a mask.
struct Encoder {
    bits: BitWriter<Vec<u8>, BigEndian>,
    /// The columns in which runs of subject begin and end, in the row above and in this one.
    above: Vec<u32>,
    ends: Vec<u32>,
}

impl Encoder {
    fn write(&mut self, mask: &PackedMask, rect: &Rect, with_coverage: bool) -> io::Result<()> {
        let mut covered = BitImage::default();
        for y in rect.y0 as usize..rect.y1 as usize {
            std::mem::swap(&mut self.above, &mut self.ends);
            self.ends.clear();
            self.ends.extend(ends_of(mask.subject(), y));
            self.write_ends(rect)?;
            if !with_coverage {
                continue;
            }
            covered.resize(mask.subject().width(), 1);
            covered.words_mut().fill(0);
            mask.coverage().columns(y).iter().for_each(|&x| covered.set(x as usize, 0, true));
            self.write_covered(&mut covered, rect)?;
            for bytes in mask.coverage().bytes(y).chunks(EIGHT) {
                let low = bytes.iter().fold(0, |low, byte| low << 7 | u64::from(byte & !SUBJECT));
                self.bits.write_var(7 * bytes.len() as u32, low)?;
            }
        }
        self.bits.byte_align()
    }

    fn write_ends(&mut self, rect: &Rect) -> io::Result<()> {
        let is_alike = self.ends.len() == self.above.len();
        self.bits.write_bit(is_alike)?;
        if is_alike {
            for (&end, &above) in self.ends.iter().zip(&self.above) {
                let moved = i64::from(end) - i64::from(above);
                write_rice(&mut self.bits, (moved << 1 ^ moved >> 63) as u32, MOVED)?;
            }
            return Ok(());
        }
        write_rice(&mut self.bits, self.ends.len() as u32 / 2, ENDS)?;
        let mut last = rect.x0 as u32;
        for &end in &self.ends {
            write_rice(&mut self.bits, end - last, GAP)?;
            last = end;
        }
        Ok(())
    }

    /// Writes where the pixels `covered` of a row lie, which are cleared.
    fn write_covered(&mut self, covered: &mut BitImage, rect: &Rect) -> io::Result<()> {
        let mut take = |x: u32| {
            let is_covered = covered.get(x as usize, 0);
            covered.set(x as usize, 0, false);
            is_covered
        };
        let nexts = self.ends.iter().skip(1).copied().chain([rect.x1 as u32]);
        for (&end, next) in self.ends.iter().zip(nexts) {
            let before = (rect.x0 as u32..end).rev().take_while(|&x| take(x)).count();
            let behind = (end..next).take_while(|&x| take(x)).count();
            write_rice(&mut self.bits, before as u32, COUNT)?;
            write_rice(&mut self.bits, behind as u32, COUNT)?;
        }

        // The ends of all other runs, in pairs.
        let others: Vec<u32> = ends_of(covered, 0).collect();
        write_rice(&mut self.bits, others.len() as u32 / 2, COUNT)?;
        let mut last = rect.x0 as u32;
        for run in others.as_chunks::<2>().0 {
            write_rice(&mut self.bits, run[0] - last, COVERAGE_GAP)?;
            write_rice(&mut self.bits, run[1] - run[0] - 1, COUNT)?;
            last = run[1];
        }
        Ok(())
    }
}

/// The columns in which runs of pixels that are set begin, and those behind which they end, ascending.
fn ends_of(image: &BitImage, y: usize) -> impl Iterator<Item = u32> {
    let row = image.row(y);
    let last = row.last().is_some_and(|word| word >> 63 == 1).then_some(64 * row.len() as u32);
    let inner = row.iter().enumerate().flat_map(move |(k, &word)| {
        let before = if k > 0 { row[k - 1] >> 63 } else { 0 };
        set_bits(word ^ (word << 1 | before)).map(move |bit| (64 * k + bit) as u32)
    });
    inner.chain(last)
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

/// Reads the runs of a mask.
struct Decoder<'a> {
    bits: BitReader<&'a [u8], BigEndian>,
    length: usize,
    header: Header,
    mask: &'a mut PackedMask,
    above: Vec<u32>,
    ends: Vec<u32>,
    /// The pixels of the row that have coverage.
    covered: BitImage,
}

impl<'a> Decoder<'a> {
    /// A decoder of bytes that begin with `header`.
    fn new(bytes: &'a [u8], header: Header, mask: &'a mut PackedMask) -> Self {
        let bits = BitReader::endian(&bytes[HEADER..], BigEndian);
        let (above, ends, covered) = (Vec::new(), Vec::new(), BitImage::default());
        Self { bits, length: bytes.len(), header, mask, above, ends, covered }
    }

    fn decode(mut self) -> std::result::Result<(), String> {
        let Rect { y0, y1, .. } = self.header.rect;
        self.mask.clear(self.header.size);
        for y in y0 as usize..y1 as usize {
            self.read_row(y).map_err(|e| match e {
                RunError::Early => ended_early(self.length),
                RunError::Outside(what) => format!("row {y}: {what}; the bytes have changed on their way"),
            })?;
        }
        self.bits.byte_align();
        let left = self.bits.aligned_reader().len();
        if left > 0 {
            return Err(format!(
                "expected {} bytes, found {left} more behind the last row",
                self.length - left
            ));
        }
        self.mask.finish();
        Ok(())
    }

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

    /// Reads the ends of a row's runs: ascending columns of the rectangle, or the one behind it.
    fn read_ends(&mut self) -> std::result::Result<(), RunError> {
        let (x0, x1) = (i64::from(self.header.rect.x0), i64::from(self.header.rect.x1));
        let is_alike = self.bits.read_bit()?;
        let count = match is_alike {
            true => self.above.len(),
            false => 2 * read_rice(&mut self.bits, ENDS)? as usize,
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
                    let code = i64::from(read_rice(&mut self.bits, MOVED)?);
                    i64::from(self.above[k]) + (code >> 1 ^ -(code & 1))
                }
                false => last.max(x0) + i64::from(read_rice(&mut self.bits, GAP)?),
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
        for k in 0..self.ends.len() {
            let end = u64::from(self.ends[k]);
            let (before, behind) = (read_rice(&mut self.bits, COUNT)?, read_rice(&mut self.bits, COUNT)?);
            let start = end.checked_sub(u64::from(before)).unwrap_or(u64::MAX);
            self.cover(start, end)?;
            self.cover(end, end + u64::from(behind))?;
        }
        let mut last = self.header.rect.x0 as u64;
        for _ in 0..read_rice(&mut self.bits, COUNT)? {
            let start = last + u64::from(read_rice(&mut self.bits, COVERAGE_GAP)?);
            last = start + u64::from(read_rice(&mut self.bits, COUNT)?) + 1;
            self.cover(start, last)?;
        }
        Ok(())
    }

    /// Marks a run of pixels that have coverage.
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
        let (mut left, mut low, mut ready) = (self.covered.count(), 0u64, 0);
        for (k, &word) in self.covered.row(0).iter().enumerate() {
            for bit in set_bits(word) {
                if ready == 0 {
                    ready = left.min(EIGHT);
                    left -= ready;
                    low = self.bits.read_var(7 * ready as u32)?;
                }
                ready -= 1;
                let x = 64 * k + bit;
                let side = if self.mask.subject().get(x, y) { SUBJECT } else { 0 };
                let byte = side | (low >> (7 * ready)) as u8 & !SUBJECT;
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

/// What is wrong with coded runs.
enum RunError {
    /// The bytes end before the last row.
    Early,
    /// They tell of pixels where none can be.
    Outside(String),
}

impl From<io::Error> for RunError {
    /// Reading from memory fails at its end alone.
    fn from(_: io::Error) -> Self {
        Self::Early
    }
}

fn ended_early(length: usize) -> String {
    format!("expected more bytes, found an end after {length}; send or copy all of them")
}

fn write_rice(bits: &mut impl BitWrite, number: u32, low: u32) -> io::Result<()> {
    bits.write_unary::<1>(number >> low)?;
    bits.write_var(low, number & ((1 << low) - 1))
}

fn read_rice(bits: &mut impl BitRead, low: u32) -> std::result::Result<u32, RunError> {
    let high = bits.read_unary::<1>()?;
    let number = high.checked_mul(1 << low);
    let number = number
        .ok_or_else(|| RunError::Outside(format!("expected a number below 2^32, found {high} << {low}")))?;
    Ok(number | bits.read_var::<u32>(low)?)
}

#[cfg(test)]
mod tests;
