//! Memory that batch queries use again and again.

use super::super::Hull;
use super::super::points::Points;
use super::bodies::Verdicts;
use super::fold::Folded;
use super::folded_hull::FoldedHull;
use super::inside::Found;
use super::pool::Pool;
use super::respond::Responses;
use nalgebra::Vector3;

/// Memory for batch queries. Whoever keeps it from call to call allocates nothing once it has grown; it holds no
/// answer beyond the next call, and may be used with any hull and any points.
#[derive(Debug, Default)]
pub struct Workspace {
    folded: [Vec<Folded<'static>>; 2],
    pub(super) found: Found,
    pub(super) pool: Pool,
    pub(super) ways: Responses,
    pub(super) verdicts: Verdicts,
    pub(super) responses: Vec<PointResponse>,
    inside: Vec<u64>,
}

/// Which points of a batch are inside.
#[derive(Debug, Clone, Copy)]
pub struct Inside<'w> {
    words: &'w [u64],
    count: usize,
}

/// The paper's response of a point of a batch, in the world's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointResponse {
    /// Index of the point, as given.
    pub point: usize,
    /// Index of the view whose edge gave the normal.
    pub view: usize,
    /// Unit outward normal.
    pub normal: Vector3<f32>,
    /// Metres along the normal to the exit.
    pub depth: f32,
}

impl PointResponse {
    /// The response vector, in metres.
    pub fn w(&self) -> Vector3<f32> {
        self.normal * self.depth
    }
}

impl Inside<'_> {
    /// How many.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Whether the point of this index, as given, is inside; false beyond the last.
    pub fn contains(&self, point: usize) -> bool {
        self.words.get(point / 64).is_some_and(|word| word >> (point % 64) & 1 == 1)
    }

    /// The indices of the points inside, ascending.
    pub fn iter(&self) -> impl Iterator<Item = usize> {
        let bits = |word: u64| {
            std::iter::successors(Some(word), |word| Some(word & word.wrapping_sub(1)))
                .take_while(|&word| word != 0)
                .map(|word| word.trailing_zeros() as usize)
        };
        self.words.iter().enumerate().flat_map(move |(k, &word)| bits(word).map(move |bit| 64 * k + bit))
    }
}

impl Workspace {
    /// Empty; grows with what it is used for.
    pub fn new() -> Self {
        Self::default()
    }

    /// What was found as bits, in the order given.
    pub(super) fn mark(&mut self, points: &Points) -> Inside<'_> {
        self.inside.clear();
        self.inside.resize(points.len().div_ceil(64), 0);
        for &place in &self.found.places {
            let point = points.given(place as usize);
            self.inside[point / 64] |= 1 << (point % 64);
        }
        Inside { words: &self.inside, count: self.found.places.len() }
    }

    /// Folds `hull` in the memory of the last one.
    pub(super) fn fold<'a>(&mut self, hull: &'a Hull) -> FoldedHull<'a> {
        FoldedHull::new(hull, std::mem::take(&mut self.folded))
    }

    /// Takes the memory back: it may outlive the hull.
    pub(super) fn take_back(&mut self, folded: FoldedHull) {
        self.folded = folded.into_lists().map(|mut views| {
            views.clear();
            // Collected in place: nothing is left to convert but the lifetime.
            views.into_iter().map(|_| unreachable!("it was cleared")).collect()
        });
    }
}
