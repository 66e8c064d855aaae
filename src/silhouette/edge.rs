//! Normals at the edge of a silhouette: the paper's, and the one that contacts use.

use super::neighbours::Neighbours;
use super::region::{Region, WORD, Word};
use super::{Silhouette, contact_edge};
use crate::math::vectorised;
use nalgebra::{Point2, Vector2};
use std::sync::atomic::{AtomicU8, AtomicU64, Ordering};

/// A mean vector shorter than this, in pixels, has no direction worth trusting (paper, section 4.2; design value).
pub(crate) const SHORTEST_MEAN: f64 = 0.3;

/// A silhouette's edge at one of its background pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// A point of the edge, in image coordinates.
    pub point: Point2<f64>,
    /// Unit normal in the image, from the subject to the background.
    pub normal: Vector2<f64>,
}

/// A background pixel whose contact edge is asked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgePixel {
    pub(crate) at: (i32, i32),
    /// Its rank among the edge pixels, if it is one: only their edges are remembered.
    rank: Option<u32>,
}

/// The contact edges of a silhouette's edge pixels, row-major, each once somebody asked for it.
#[derive(Debug, Default)]
pub(super) struct EdgeTable {
    /// Edge pixels before each block of words.
    before: Vec<u32>,
    state: Vec<AtomicU8>,
    /// Point and normal, as bits.
    edges: Vec<[AtomicU64; 4]>,
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
    pub(super) fn fill(&mut self, neighbours: &Neighbours) {
        let count = ranks(neighbours.edges(), &mut self.before);
        if self.edges.len() < count {
            self.state.resize_with(count, AtomicU8::default);
            self.edges.resize_with(count, Default::default);
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
                for (place, number) in self.edges[rank].iter().zip([point.x, point.y, normal.x, normal.y]) {
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
                let number = |k: usize| f64::from_bits(self.edges[rank][k].load(Ordering::Relaxed));
                let (point, normal) = (Point2::new(number(0), number(1)), Vector2::new(number(2), number(3)));
                Some(Some(Edge { point, normal }))
            }
        }
    }

    /// Whether the edge of this rank was neither known nor claimed by anybody.
    #[inline(always)]
    fn claim(&self, rank: u32) -> bool {
        let state = &self.state[rank as usize];
        state.load(Ordering::Relaxed) == UNKNOWN
            && state.compare_exchange(UNKNOWN, CLAIMED, Ordering::Relaxed, Ordering::Relaxed).is_ok()
    }

    /// Rank of an edge pixel among all.
    #[inline(always)]
    fn rank(&self, neighbours: &Neighbours, region: &Region, (i, j): (i32, i32)) -> Option<u32> {
        let (rect, words) = (region.rect(), region.words());
        if !rect.contains(i, j) {
            return None;
        }
        let (x, y) = ((i - rect.x0) as usize, (j - rect.y0) as usize);
        let (place, bit) = (y * words + x / WORD, x % WORD);
        let edges = neighbours.edges();
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
        4 * self.before.capacity() + self.state.capacity() + 32 * self.edges.capacity()
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

impl Silhouette {
    /// The contact normal and edge point at background pixel `(i, j)`, computed once a pixel.
    pub fn edge(&self, i: i32, j: i32) -> Option<Edge> {
        self.edge_at(&self.edge_pixel((i, j)))
    }

    /// A background pixel whose edge is to be asked for more than once.
    #[inline(always)]
    pub(crate) fn edge_pixel(&self, at: (i32, i32)) -> EdgePixel {
        let tables = self.derived_tables();
        EdgePixel { at, rank: tables.edges.rank(&tables.neighbours, &self.region, at) }
    }

    /// [`Self::edge`] at a pixel.
    #[inline(always)]
    pub(crate) fn edge_at(&self, pixel: &EdgePixel) -> Option<Edge> {
        self.derived_tables().edges.get(pixel, || contact_edge::at(self, pixel.at))
    }

    /// Whether the caller is the first to ask for the edge at a pixel, and should see to it that it becomes known.
    #[inline(always)]
    pub(crate) fn claim_edge(&self, pixel: &EdgePixel) -> bool {
        pixel.rank.is_some_and(|rank| self.derived_tables().edges.claim(rank))
    }

    /// The paper's normal (section 4.2) at background pixel `(i, j)`: the mean vector from there to the background
    /// pixels of the 5x5 window around, of 7x7 or 9x9 where that mean is short; `None` where all are.
    pub fn paper_normal(&self, i: i32, j: i32) -> Option<Vector2<f64>> {
        [2, 3, 4].into_iter().find_map(|half| {
            let (x, y, count) = self.paper_sum(i, j, half);
            let mean = Vector2::new(f64::from(x), f64::from(y)) / f64::max(f64::from(count), 1.0);
            (mean.norm() >= SHORTEST_MEAN).then(|| mean.normalize())
        })
    }

    /// The sum of the vectors from `(i, j)` to the background pixels of the window around, and their number: whole
    /// numbers, exact in any order.
    #[inline(always)]
    fn paper_sum(&self, i: i32, j: i32, half: i32) -> (i32, i32, i32) {
        let rect = self.region.rect();
        if !rect.contains(i - half, j - half) || !rect.contains(i + half, j + half) {
            return self.paper_sum_anywhere(i, j, half);
        }
        let rows = self.region.rows_from(i - half, j - half);
        let (mut x, mut y, mut count) = (0, 0, 0);
        for dy in -half..=half {
            let (pixels, offsets) = sums(!rows.row(dy + half) & ((2 << (2 * half)) - 1));
            x += offsets - half * pixels;
            y += dy * pixels;
            count += pixels;
        }
        (x, y, count)
    }

    #[cold]
    fn paper_sum_anywhere(&self, i: i32, j: i32, half: i32) -> (i32, i32, i32) {
        let offsets = (-half..=half).flat_map(|dy| (-half..=half).map(move |dx| (dx, dy)));
        let background = offsets.filter(|(dx, dy)| !self.is_subject(i + dx, j + dy));
        background.fold((0, 0, 0), |(x, y, count), (dx, dy)| (x + dx, y + dy, count + 1))
    }
}

/// How many of the low nine bits are set, and the sum of their positions.
#[inline(always)]
fn sums(bits: u32) -> (i32, i32) {
    const TABLE: [(u8, u8); 512] = {
        let mut table = [(0, 0); 512];
        let mut bits = 0;
        while bits < 512 {
            let mut place = 0;
            while place < 9 {
                if bits >> place & 1 == 1 {
                    table[bits].0 += 1;
                    table[bits].1 += place;
                }
                place += 1;
            }
            bits += 1;
        }
        table
    };
    let (count, places) = TABLE[(bits & 511) as usize];
    (i32::from(count), i32::from(places))
}
