//! Walks of many points through one silhouette, each along its own line.
//!
//! As in [`march`](super::super::march): a step leads to the side of the largest square of subject pixels around, and
//! crosses into the pixel behind it. All lanes step together.
//!
//! The image of a line is straight. Where the depth is `d0 + t d`, the pixel at `t` metres lies `s` times the slope at
//! the start away from the start, `s = t d0 / (d0 + t d)`: so walks go by `s`, and divide by nothing.

use super::super::lanes::{bits, bits_of, either, ones, whole};
use super::super::points::{Block, LANES, Lane};
use super::fold::Folded;
use super::lookup::Distances;
use super::pool::{Pool, Sighting};
use crate::vectorised::vectorised;

/// Steps after which is first asked who has arrived,
const YOUNG: usize = 3;

/// and then again and again.
const STEPS: usize = 2;

/// So few lines are sooner walked one by one.
const FEW: u32 = 5;

/// No line takes more steps; one through the largest image takes fewer.
const MOST_STEPS: usize = 1 << 18;

/// Points on their way out, as one view sees them.
pub(super) struct Route<'a> {
    pub(super) view: &'a Folded<'a>,
    /// The view's place among all.
    pub(super) place: usize,
    pub(super) pool: &'a Pool,
    pub(super) directions: &'a [Block],
}

/// The lines that are walked together: in pixels `start + s slope`.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
struct Lines {
    /// Which points walk them.
    points: [u32; LANES],
    start: Plane,
    slope: Plane,
    per_slope: Plane,
    /// The pixel that each is in, and when it entered it.
    pixel: Plane,
    s: Lane,
    /// After which nobody cares.
    limit: Lane,
    /// The change of the depth per metre, over the depth at the start.
    deeper: Lane,
}

/// One of them.
#[derive(Clone, Copy)]
struct Line {
    start: [f32; 2],
    slope: [f32; 2],
    per_slope: [f32; 2],
}

/// Where a walk is: a pixel, and when it entered it.
#[derive(Clone, Copy)]
struct Place {
    column: f32,
    row: f32,
    s: f32,
}

/// Columns and rows, in the region.
#[derive(Debug, Clone, Copy, Default)]
struct Plane {
    u: Lane,
    v: Lane,
}

/// Points that set out together, at most as many as are asked together; lanes left over are the last one's.
pub(super) struct Party<'a> {
    pub(super) view: &'a Folded<'a>,
    pub(super) points: &'a [u32],
    pub(super) start: &'a Sighting,
    pub(super) direction: &'a Block,
    /// Where they need not go on, in metres.
    pub(super) most: &'a Lane,
}

/// The walks of many lines through one silhouette. Most have arrived after a few steps. The others go on with one
/// another, each in a lane that is free.
pub(super) struct Walks {
    young: Lines,
    old: Lines,
    /// The lanes of `old` in which nobody walks.
    free: u32,
}

vectorised! {
    /// Lowers the exits of `points`, in `metres`, to where they leave the view. Its distances come as a slice of their
    /// own: the compiler has to know that nothing here writes to them.
    pub(super) fn walk(route: &Route, points: &[u32], distance_words: &[u32], metres: &mut [Lane]) {
        let table = Distances::new(distance_words, route.view.tables.width);
        let mut walks = Walks::new();
        for points in points.chunks(LANES) {
            let (mut direction, mut most) = (Block::default(), [0.0; LANES]);
            for k in 0..LANES {
                let point = points[k.min(points.len() - 1)] as usize;
                direction.set(k, route.directions[point / LANES].get(point % LANES));
                most[k] = metres[point / LANES][point % LANES];
            }
            let start = route.pool.sightings_of(points, route.place);
            let party =
                Party { view: route.view, points, start: &start, direction: &direction, most: &most };
            walks.set_out(&party, &table, metres);
        }
        walks.finish(&table, metres);
    }
}

impl Walks {
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self { young: Lines::default(), old: Lines::default(), free: u32::MAX }
    }

    /// More points set out, and walk until their exits, in metres, are reached.
    #[inline(always)]
    pub(super) fn set_out(&mut self, party: &Party, table: &Distances, metres: &mut [Lane]) {
        let Self { young, old, free } = self;
        young.begin(party);
        let filled = u32::MAX >> (LANES - party.points.len());
        let arrived = young.step(YOUNG, table);
        young.report(arrived & filled, metres);
        let mut left = !arrived & filled;
        while left != 0 {
            if *free == 0 {
                *free = old.step(STEPS, table);
                old.report(*free, metres);
                continue;
            }
            old.take(free.trailing_zeros() as usize, young, left.trailing_zeros() as usize);
            (*free, left) = (*free & (*free - 1), left & (left - 1));
        }
    }

    /// All arrive.
    #[inline(always)]
    pub(super) fn finish(&mut self, table: &Distances, metres: &mut [Lane]) {
        let Self { old, free, .. } = self;
        while *free != u32::MAX {
            let few = free.count_zeros() <= FEW;
            let arrived = !*free & if few { old.finish(!*free, table) } else { old.step(STEPS, table) };
            old.report(arrived, metres);
            *free |= arrived;
        }
    }
}

impl Lines {
    /// Begins where the view sees the points; ends at their exits so far.
    #[inline(always)]
    fn begin(&mut self, party: &Party) {
        let Party { view, points, start, direction, most } = party;
        self.points[..points.len()].copy_from_slice(points);
        let changes = view.changes(direction);
        let [right, below] = view.last_pixel();
        for k in 0..LANES {
            let (u, v) = (start.u[k], start.v[k]);
            let deeper = changes.depth[k] * start.per_depth[k];
            let slope_u = changes.u[k].mul_add(start.per_depth[k], -u * deeper);
            let slope_v = changes.v[k].mul_add(start.per_depth[k], -v * deeper);
            (self.start.u[k], self.start.v[k]) = (u, v);
            (self.slope.u[k], self.slope.v[k]) = (slope_u, slope_v);
            (self.per_slope.u[k], self.per_slope.v[k]) = (1.0 / slope_u, 1.0 / slope_v);
            (self.pixel.u[k], self.pixel.v[k]) = (whole(u, right) as f32, whole(v, below) as f32);
            self.deeper[k] = deeper;
            self.s[k] = 0.0;
            // Where the depth comes to nothing the line has left the image; one that leads away from the camera comes
            // to its vanishing point at infinity, and may see subject there.
            let endless = either(deeper > 0.0, 1.0 / deeper, f32::INFINITY);
            let depth = most[k].mul_add(deeper, 1.0);
            let ends = (depth > 0.0) & (most[k] < f32::INFINITY);
            self.limit[k] = either(ends, most[k] / depth, endless);
        }
    }

    /// Line k goes on where line j of `other` is.
    #[inline(always)]
    fn take(&mut self, k: usize, other: &Self, j: usize) {
        self.points[k] = other.points[j];
        let planes = [
            (&mut self.start, &other.start),
            (&mut self.slope, &other.slope),
            (&mut self.per_slope, &other.per_slope),
            (&mut self.pixel, &other.pixel),
        ];
        for (plane, other) in planes {
            (plane.u[k], plane.v[k]) = (other.u[j], other.v[j]);
        }
        (self.s[k], self.limit[k], self.deeper[k]) = (other.s[j], other.limit[j], other.deeper[j]);
    }

    /// Lowers the exits of the lines that have arrived before their limit.
    #[inline(always)]
    fn report(&self, arrived: u32, metres: &mut [Lane]) {
        let mut exit = [0.0; LANES];
        for k in 0..LANES {
            exit[k] = self.s[k] / (1.0 - self.s[k] * self.deeper[k]);
        }
        for k in ones(arrived) {
            if self.s[k] < self.limit[k] {
                let point = self.points[k] as usize;
                metres[point / LANES][point % LANES] = exit[k];
            }
        }
    }

    /// Some steps of all; which lines have arrived at background or at their limit, a bit each.
    #[inline(always)]
    fn step(&mut self, steps: usize, table: &Distances) -> u32 {
        let mut walks = [0_u32; LANES];
        for _ in 0..steps {
            for k in 0..LANES {
                let here = self.place(k);
                let pixels = table.at(bits_of(here.column), bits_of(here.row));
                let goes = (pixels > 0) & (here.s < self.limit[k]);
                let next = self.line(k).step(&here, pixels as f32);
                self.pixel.u[k] = either(goes, next.column, here.column);
                self.pixel.v[k] = either(goes, next.row, here.row);
                self.s[k] = either(goes, next.s, here.s);
                walks[k] = u32::from(goes);
            }
        }
        !bits(&walks)
    }

    /// Those that are left go on one by one until they arrive.
    #[inline(always)]
    fn finish(&mut self, left: u32, table: &Distances) -> u32 {
        for k in ones(left) {
            let (line, mut here) = (self.line(k), self.place(k));
            for _ in 0..MOST_STEPS {
                let pixels = table.at(bits_of(here.column), bits_of(here.row));
                if pixels == 0 || here.s >= self.limit[k] {
                    break;
                }
                here = line.step(&here, pixels as f32);
            }
            self.s[k] = here.s;
        }
        left
    }

    #[inline(always)]
    fn line(&self, k: usize) -> Line {
        Line {
            start: [self.start.u[k], self.start.v[k]],
            slope: [self.slope.u[k], self.slope.v[k]],
            per_slope: [self.per_slope.u[k], self.per_slope.v[k]],
        }
    }

    #[inline(always)]
    fn place(&self, k: usize) -> Place {
        Place { column: self.pixel.u[k], row: self.pixel.v[k], s: self.s[k] }
    }
}

impl Line {
    /// From `here` into the pixel behind the square of `clear` pixels around.
    #[inline(always)]
    fn step(&self, here: &Place, clear: f32) -> Place {
        let ([u, v], [across, down]) = (self.start, self.slope);
        let (rightwards, downwards) = (across > 0.0, down > 0.0);
        let right = here.column + either(rightwards, clear, 1.0 - clear);
        let below = here.row + either(downwards, clear, 1.0 - clear);
        let by_column = either(across != 0.0, (right - u) * self.per_slope[0], f32::INFINITY);
        let by_row = either(down != 0.0, (below - v) * self.per_slope[1], f32::INFINITY);
        let first = by_column <= by_row;
        let s = either(first, by_column, by_row);
        let s = either(s > here.s, s, here.s);
        let beside = clear - 1.0;
        let (column, row) =
            (within(s.mul_add(across, u), here.column, beside), within(s.mul_add(down, v), here.row, beside));
        Place {
            column: either(first, either(rightwards, right, right - 1.0), column),
            row: either(first, row, either(downwards, below, below - 1.0)),
            s,
        }
    }
}

/// The pixel of position `x`, within `reach` of the pixel `middle`.
#[inline(always)]
fn within(x: f32, middle: f32, reach: f32) -> f32 {
    // Bounded first: what is left is small and not negative, where adding a large number rounds to whole ones.
    let x = either(x > middle - reach + 0.5, x, middle - reach + 0.5);
    let x = either(x < middle + reach + 0.5, x, middle + reach + 0.5);
    bits_of(x - 0.5) as f32
}
