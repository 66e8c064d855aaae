//! One bit a pixel: 64 pixels of a row are looked at together.

use crate::vectorised::vectorised;

/// Pixels in a word, the first in the lowest bit.
pub(super) const WORD: usize = 64;

/// A binary image; bits beyond a row's end are zero.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct Bits {
    width: usize,
    height: usize,
    words: Vec<u64>,
}

impl Bits {
    /// Takes the size, in the memory that it has. What the pixels are is the caller's to write.
    pub(super) fn resize(&mut self, width: usize, height: usize) {
        (self.width, self.height) = (width, height);
        self.words.resize(width.div_ceil(WORD) * height, 0);
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    /// Words in a row.
    pub(super) fn stride(&self) -> usize {
        self.width.div_ceil(WORD)
    }

    /// The pixels of a row's last word.
    pub(super) fn last_word(&self) -> u64 {
        u64::MAX >> (self.stride() * WORD - self.width)
    }

    pub(super) fn words(&self) -> &[u64] {
        &self.words
    }

    pub(super) fn words_mut(&mut self) -> &mut [u64] {
        &mut self.words
    }

    pub(super) fn row(&self, y: usize) -> &[u64] {
        &self.words[y * self.stride()..][..self.stride()]
    }

    /// Makes this a copy of `other`.
    pub(super) fn copy(&mut self, other: &Self) {
        self.resize(other.width, other.height);
        self.words.copy_from_slice(&other.words);
    }

    /// The pixels `x - 2 ..= x + 2` of row `y` as five bits; zero where they lie outside the image.
    #[inline]
    pub(super) fn five(&self, x: usize, y: usize) -> u64 {
        let row = self.row(y);
        let (at, shift) = (x / WORD, x % WORD);
        let before = if at > 0 { row[at - 1] } else { 0 };
        let after = row.get(at + 1).copied().unwrap_or(0);
        let wide =
            u128::from(before >> (WORD - 2)) | u128::from(row[at]) << 2 | u128::from(after & 3) << (WORD + 2);
        (wide >> shift) as u64 & 0b11111
    }

    /// Calls `visit` with the place of each pixel that is set.
    pub(super) fn for_each(&self, mut visit: impl FnMut(usize, usize)) {
        for (y, row) in self.words.chunks_exact(self.stride().max(1)).enumerate() {
            for (k, &word) in row.iter().enumerate() {
                let mut left = word;
                while left != 0 {
                    visit(k * WORD + left.trailing_zeros() as usize, y);
                    left &= left - 1;
                }
            }
        }
    }

    /// Writes 255 where a pixel is set, else 0.
    pub(super) fn write_bytes(&self, bytes: &mut [u8]) {
        let rows = self.words.chunks_exact(self.stride().max(1));
        for (row, bytes) in rows.zip(bytes.chunks_exact_mut(self.width.max(1))) {
            expand(row, bytes);
        }
    }

    /// Sets the pixels whose byte is at least 128.
    pub(super) fn read_bytes(&mut self, width: usize, bytes: &[u8]) {
        let width = width.max(1);
        self.resize(width, bytes.len() / width);
        let stride = self.stride();
        for (row, bytes) in self.words.chunks_exact_mut(stride).zip(bytes.chunks_exact(width)) {
            for (word, bytes) in row.iter_mut().zip(bytes.chunks(WORD)) {
                let mut block = [0; WORD];
                block[..bytes.len()].copy_from_slice(bytes);
                *word = pack(&block);
            }
        }
    }
}

/// The highest bits of 64 bytes.
#[inline(always)]
pub(super) fn pack(bytes: &[u8; WORD]) -> u64 {
    let (eights, mut packed) = (bytes.as_chunks::<8>().0, [0; 8]);
    for k in 0..8 {
        // Byte m's highest bit comes to stand at m.
        let tops = u64::from_le_bytes(eights[k]) >> 7 & 0x0101_0101_0101_0101;
        packed[k] = (tops.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8;
    }
    u64::from_le_bytes(packed)
}

vectorised! {
    /// A row's bits as bytes.
    fn expand(words: &[u64], bytes: &mut [u8]) {
        for (&word, bytes) in words.iter().zip(bytes.chunks_mut(WORD)) {
            if word == 0 || word == u64::MAX {
                bytes.fill(word as u8);
                continue;
            }
            for (k, byte) in bytes.iter_mut().enumerate() {
                *byte = 0u8.wrapping_sub((word >> k & 1) as u8);
            }
        }
    }
}
