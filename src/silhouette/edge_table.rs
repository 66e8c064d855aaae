//! The contact edges of a silhouette, each computed once a query asks for it and then remembered.

use super::boundary::Boundary;
use super::edge::Edge;
use super::mask_crop::{MaskCrop, WORD, Word};
use crate::math::vectorised;
use nalgebra::{Point2, Vector2};
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

/// A background pixel whose contact edge is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgePixel {
    pub(crate) at: (i32, i32),
    /// Its rank among the edge pixels, if it is one: only their edges are remembered.
    pub(super) rank: Option<u32>,
}

/// The contact edges of a silhouette's edge pixels, row-major, each once somebody asked for it.
#[derive(Debug, Default)]
pub(super) struct EdgeTable {
    /// Edge pixels before each block of words.
    before: Vec<u32>,
    state: Vec<AtomicU8>,
    /// Point and normal, as bits.
    stored: Vec<[AtomicU64; 4]>,
}

/// Words of bits whose edge pixels are counted together.
const BLOCK: usize = 4;

const UNKNOWN: u8 = 0;
const NONE: u8 = 1;
const KNOWN: u8 = 2;
/// Not known, but somebody is about to find out.
const CLAIMED: u8 = 3;

impl EdgeTable {
    /// Makes room for the edge pixels, none of them known.
    pub(super) fn fill(&mut self, neighbours: &Boundary) {
        let count = ranks(neighbours.boundary_pixels(), &mut self.before);
        if self.stored.len() < count {
            self.state.resize_with(count, AtomicU8::default);
            self.stored.resize_with(count, Default::default);
        }
        self.state[..count].iter_mut().for_each(|state| *state.get_mut() = UNKNOWN);
    }

    /// The edge at `pixel`, computed by `edge` where it is not known yet.
    #[inline(always)]
    pub(super) fn get(&self, pixel: &EdgePixel, edge: impl FnOnce() -> Option<Edge>) -> Option<Edge> {
        let Some(rank) = pixel.rank else { return edge() };
        let rank = rank as usize;
        self.known(rank).unwrap_or_else(|| {
            // Two threads may both get here. They store the same bits, before either says that they are known.
            let found = edge();
            if let Some(Edge { point, normal }) = found {
                for (place, number) in self.stored[rank].iter().zip([point.x, point.y, normal.x, normal.y]) {
                    place.store(number.to_bits(), Ordering::Relaxed);
                }
            }
            self.state[rank].store(if found.is_some() { KNOWN } else { NONE }, Ordering::Release);
            found
        })
    }

    /// The edge of this rank, if it is known whether there is one.
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

    /// Whether the edge of this rank was neither known nor claimed by anybody.
    #[inline(always)]
    pub(super) fn try_claim(&self, rank: u32) -> bool {
        let state = &self.state[rank as usize];
        state.load(Ordering::Relaxed) == UNKNOWN
            && state.compare_exchange(UNKNOWN, CLAIMED, Ordering::Relaxed, Ordering::Relaxed).is_ok()
    }

    /// Rank of an edge pixel among all.
    #[inline(always)]
    pub(super) fn rank(&self, neighbours: &Boundary, region: &MaskCrop, (i, j): (i32, i32)) -> Option<u32> {
        let (rect, words) = (region.rect(), region.words());
        if !rect.contains(i, j) {
            return None;
        }
        let (x, y) = ((i - rect.x0) as usize, (j - rect.y0) as usize);
        let (place, bit) = (y * words + x / WORD, x % WORD);
        let edges = neighbours.boundary_pixels();
        let word = edges[place];
        if word >> bit & 1 == 0 {
            return None;
        }
        let block = place / BLOCK;
        let before = self.before[block] + count_ones(&edges[block * BLOCK..place]);
        Some(before + (word & ((1 << bit) - 1)).count_ones())
    }

    /// Bytes of memory behind the table.
    pub(super) fn working_memory(&self) -> usize {
        4 * self.before.capacity() + self.state.capacity() + 32 * self.stored.capacity()
    }
}

vectorised! {
    /// How many bits are set before each block of words, and in all.
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

/// How many bits of some words are set.
#[inline(always)]
fn count_ones(words: &[Word]) -> u32 {
    let mut count = 0;
    for word in words {
        count += word.count_ones();
    }
    count
}
