//! Writing the runs of a mask.

use super::{COUNT, COVERAGE_GAP, EIGHT, ENDS, GAP, MOVED};
use crate::math::lanes::set_bits;
use crate::silhouette::bit_image::{BitImage, WORD};
use crate::silhouette::{PackedMask, Rect, SUBJECT};
use bitstream_io::{BigEndian, BitWrite, BitWriter};
use std::io;

/// Writes the runs of one mask.
pub(super) struct Encoder {
    writer: BitWriter<Vec<u8>, BigEndian>,
    /// [`Self::ends`] of the row above.
    above: Vec<u32>,
    /// The first and past-the-last columns of the row's runs of subject, ascending.
    ends: Vec<u32>,
}

impl Encoder {
    /// An encoder that appends to `bytes`.
    pub(super) fn new(bytes: Vec<u8>) -> Self {
        Self { writer: BitWriter::endian(bytes, BigEndian), above: Vec::new(), ends: Vec::new() }
    }

    /// Writes the rows of `rect`, and returns all bytes.
    pub(super) fn write(
        mut self,
        mask: &PackedMask,
        rect: &Rect,
        with_coverage: bool,
    ) -> io::Result<Vec<u8>> {
        let mut covered = BitImage::default();
        for y in rect.y0 as usize..rect.y1 as usize {
            std::mem::swap(&mut self.above, &mut self.ends);
            self.ends.clear();
            self.ends.extend(ends_of(mask.subject(), y));
            self.write_ends(rect)?;
            if !with_coverage {
                continue;
            }

            // First which pixels of the row have coverage, then their bytes.
            covered.resize(mask.subject().width(), 1);
            covered.words_mut().fill(0);
            mask.coverage().columns(y).iter().for_each(|&x| covered.set(x as usize, 0, true));
            self.write_covered(&mut covered, rect)?;
            for bytes in mask.coverage().bytes(y).chunks(EIGHT) {
                let low = bytes.iter().fold(0, |low, byte| low << 7 | u64::from(byte & !SUBJECT));
                self.writer.write_var(7 * bytes.len() as u32, low)?;
            }
        }

        self.writer.byte_align()?;
        Ok(self.writer.into_writer())
    }

    /// Writes the ends of the row's runs.
    fn write_ends(&mut self, rect: &Rect) -> io::Result<()> {
        let is_alike = self.ends.len() == self.above.len();
        self.writer.write_bit(is_alike)?;
        if is_alike {
            // Movements in zigzag code, which has no sign.
            for (&end, &above) in self.ends.iter().zip(&self.above) {
                let moved = i64::from(end) - i64::from(above);
                write_rice(&mut self.writer, (moved << 1 ^ moved >> 63) as u32, MOVED)?;
            }
            return Ok(());
        }

        write_rice(&mut self.writer, self.ends.len() as u32 / 2, ENDS)?;
        let mut last = rect.x0 as u32;
        for &end in &self.ends {
            write_rice(&mut self.writer, end - last, GAP)?;
            last = end;
        }
        Ok(())
    }

    /// Writes which pixels of a row have coverage, given as the bits of `covered`, which are cleared.
    fn write_covered(&mut self, covered: &mut BitImage, rect: &Rect) -> io::Result<()> {
        // Pixels adjacent to the ends of runs, up to the next end.
        let mut take = |x: u32| {
            let is_covered = covered.get(x as usize, 0);
            covered.set(x as usize, 0, false);
            is_covered
        };
        let nexts = self.ends.iter().skip(1).copied().chain([rect.x1 as u32]);
        for (&end, next) in self.ends.iter().zip(nexts) {
            let before = (rect.x0 as u32..end).rev().take_while(|&x| take(x)).count();
            let after = (end..next).take_while(|&x| take(x)).count();
            write_rice(&mut self.writer, before as u32, COUNT)?;
            write_rice(&mut self.writer, after as u32, COUNT)?;
        }

        // All other pixels, as runs.
        let others: Vec<u32> = ends_of(covered, 0).collect();
        write_rice(&mut self.writer, others.len() as u32 / 2, COUNT)?;
        let mut last = rect.x0 as u32;
        for run in others.as_chunks::<2>().0 {
            write_rice(&mut self.writer, run[0] - last, COVERAGE_GAP)?;
            write_rice(&mut self.writer, run[1] - run[0] - 1, COUNT)?;
            last = run[1];
        }
        Ok(())
    }
}

/// The first and past-the-last columns of the runs of pixels that are set in row `y`, ascending.
fn ends_of(image: &BitImage, y: usize) -> impl Iterator<Item = u32> {
    let row = image.row(y);
    // A run that reaches the end of the last word has no change of bits after it.
    let last = row.last().is_some_and(|word| word >> 63 == 1).then_some((WORD * row.len()) as u32);
    let inner = row.iter().enumerate().flat_map(move |(k, &word)| {
        let before = if k > 0 { row[k - 1] >> 63 } else { 0 };
        set_bits(word ^ (word << 1 | before)).map(move |bit| (WORD * k + bit) as u32)
    });
    inner.chain(last)
}

/// Writes a Rice code with `low` lowest bits.
fn write_rice(bits: &mut impl BitWrite, number: u32, low: u32) -> io::Result<()> {
    bits.write_unary::<1>(number >> low)?;
    bits.write_var(low, number & ((1 << low) - 1))
}
