//! A silhouette's table of contact edges, which are computed by the first query that needs them and then remembered.

use super::boundary::Boundary;
use super::edge::Edge;
use super::mask_crop::{MaskCrop, WORD, Word};
use crate::math::vectorised;
use nalgebra::{Point2, Vector2};
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

/// A background pixel and the position of its contact edge in the table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgePixel {
    /// Column and row in the image.
    pub(crate) at: (i32, i32),
    /// Rank among the edge pixels, row-major. `None` if it is not an edge pixel, whose edge is not remembered.
    pub(super) rank: Option<u32>,
}

/// The contact edges of a silhouette's edge pixels, by their row-major rank.
#[derive(Debug, Default)]
pub(super) struct EdgeTable {
    /// Number of edge pixels before each block of words.
    before: Vec<u32>,
    /// The state of each edge: [`UNKNOWN`], [`NONE`], [`KNOWN`] or [`CLAIMED`].
    state: Vec<AtomicU8>,
    /// Point and normal of each edge, as the bits of four `f64`.
    stored: Vec<[AtomicU64; 4]>,
}

/// Words of bits whose edge pixels are counted together.
const BLOCK: usize = 4;

/// The edge has not been computed.
const UNKNOWN: u8 = 0;

/// There is no edge: the mean vector has no reliable direction.
const NONE: u8 = 1;

/// The edge is stored.
const KNOWN: u8 = 2;

/// The edge has not been computed, but a caller has claimed to compute it.
const CLAIMED: u8 = 3;

impl EdgeTable {
    /// Sets the edge pixels of another mask. All edges become unknown.
    pub(super) fn fill(&mut self, boundary: &Boundary) {
        let count = ranks(boundary.boundary_pixels(), &mut self.before);
        if self.stored.len() < count {
            self.state.resize_with(count, AtomicU8::default);
            self.stored.resize_with(count, Default::default);
        }
        self.state[..count].iter_mut().for_each(|state| *state.get_mut() = UNKNOWN);
    }

    /// The edge at `pixel`, which is computed by `edge` if it is not known yet.
    #[inline(always)]
    pub(super) fn get(&self, pixel: &EdgePixel, edge: impl FnOnce() -> Option<Edge>) -> Option<Edge> {
        let Some(rank) = pixel.rank else { return edge() };
        let rank = rank as usize;

        self.known(rank).unwrap_or_else(|| {
            // Two threads may compute the same edge. They store the same bits, and each publishes them afterwards.
            let found = edge();
            if let Some(Edge { point, normal }) = found {
                for (stored, number) in self.stored[rank].iter().zip([point.x, point.y, normal.x, normal.y]) {
                    stored.store(number.to_bits(), Ordering::Relaxed);
                }
            }

            // The release pairs with the acquire in `known`.
            self.state[rank].store(if found.is_some() { KNOWN } else { NONE }, Ordering::Release);
            found
        })
    }

    /// The edge of this rank; `None` if it is not known whether there is one.
    #[inline(always)]
    fn known(&self, rank: usize) -> Option<Option<Edge>> {
        match self.state[rank].load(Ordering::Acquire) {
            UNKNOWN | CLAIMED => None,
            NONE => Some(None),
            _ => {
                let number = |k: usize| f64::from_bits(self.stored[rank][k].load(Ordering::Relaxed));
                let (point, normal) = (Point2::new(number(0), number(1)), Vector2::new(number(2), number(3)));
                Some(Some(Edge { point, normal }))
            }
        }
    }

    /// Claims the edge of this rank. Returns `false` if it is known or claimed already.
    #[inline(always)]
    pub(super) fn try_claim(&self, rank: u32) -> bool {
        let state = &self.state[rank as usize];
        state.load(Ordering::Relaxed) == UNKNOWN
            && state.compare_exchange(UNKNOWN, CLAIMED, Ordering::Relaxed, Ordering::Relaxed).is_ok()
    }

    /// Row-major rank of pixel `(i, j)` among the edge pixels; `None` if it is not one.
    #[inline(always)]
    pub(super) fn rank(&self, boundary: &Boundary, crop: &MaskCrop, (i, j): (i32, i32)) -> Option<u32> {
        let (rect, words) = (crop.rect(), crop.words());
        if !rect.contains(i, j) {
            return None;
        }

        let (x, y) = ((i - rect.x0) as usize, (j - rect.y0) as usize);
        let (index, bit) = (y * words + x / WORD, x % WORD);
        let edges = boundary.boundary_pixels();
        let word = edges[index];
        if word >> bit & 1 == 0 {
            return None;
        }

        // Count the edge pixels before the block, in the block before the word, and in the word before the bit.
        let block = index / BLOCK;
        let before = self.before[block] + count_ones(&edges[block * BLOCK..index]);
        Some(before + (word & ((1 << bit) - 1)).count_ones())
    }

    /// Bytes of memory of the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.before.capacity() + self.state.capacity() + 32 * self.stored.capacity()
    }
}

vectorised! {
    /// Writes the number of bits that are set before each block of words, and returns the total.
    fn ranks(bits: &[Word], before: &mut Vec<u32>) -> usize {
        before.resize(bits.len().div_ceil(BLOCK), 0);
        let mut count = 0;
        for (words, before) in bits.chunks(BLOCK).zip(before) {
            *before = count;
            count += count_ones(words);
        }
        count as usize
    }
}

/// The number of bits that are set.
#[inline(always)]
fn count_ones(words: &[Word]) -> u32 {
    let mut count = 0;
    for word in words {
        count += word.count_ones();
    }
    count
}
