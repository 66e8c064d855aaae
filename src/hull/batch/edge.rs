//! The edges nearest to many points, and their normals (paper, section 4.2).

use super::super::lanes::{bits_of, either};
use super::super::points::{Block, LANES};
use super::fold::Folded;
use super::inside::Within;
use super::lookup::{Bits, Distances};
use super::pool::Pool;
use super::rings;
use crate::silhouette::Tables;
use crate::vectorised::vectorised;

/// Whole numbers of as many points as are asked together.
pub(in crate::hull) type Whole = [i32; LANES];

/// Up to this Chebyshev distance the nearest background pixel is in sight of a row's word: it lies at most 14 pixels
/// away.
pub(in crate::hull) const NEAR: i32 = 10;

/// Pixels left of the middle one in a word around it.
const SIGHT: i32 = 15;

/// Half-width of the normal's window.
const WINDOW: i32 = 2;

/// Pixels of one view, from the corner of its silhouette's region.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::hull) struct Pixels {
    pub(in crate::hull) column: Whole,
    pub(in crate::hull) row: Whole,
}

vectorised! {
    /// The unit normals, outwards, of the edges nearest to the points that `view`, at `place` among all, decides:
    /// written to `normals`, in the volume's frame. Zero where there is none.
    pub(super) fn normals(view: &Folded, place: usize, pool: &Pool, normals: &mut [Block]) {
        for points in pool.decided_by(place).chunks(LANES) {
            let (mut middle, mut first, mut half) = (Pixels::default(), [0; LANES], [0; LANES]);
            for k in 0..LANES {
                let point = points[k.min(points.len() - 1)] as usize;
                let (block, lane) = (point / LANES, point % LANES);
                let sighting = pool.sighting(block, place);
                middle.column[k] = bits_of(sighting.column[lane]) as i32;
                middle.row[k] = bits_of(sighting.row[lane]) as i32;
                half[k] = bits_of(pool.decisions[block].half[lane]) as i32;
                first[k] = bits_of(sighting.clear[lane]) as i32;
            }
            let nearest = nearest(&view.tables, &middle, &first, &half);
            let normal = normals_at(view, &nearest, &tangents(view, &middle, &nearest));
            for (k, &point) in points.iter().enumerate() {
                normals[point as usize / LANES].set(point as usize % LANES, normal.get(k));
            }
        }
    }
}

/// The background pixel nearest to each middle (Euclidean, then row-major) within its window of half-width `half`,
/// where `first` is the Chebyshev distance of the nearest ones.
#[inline(always)]
pub(in crate::hull) fn nearest(tables: &Tables, middle: &Pixels, first: &Whole, half: &Whole) -> Pixels {
    if first.iter().all(|&first| first <= NEAR) {
        nearest_in_sight(Bits::new(tables.subject, tables.words), middle, half)
    } else {
        rings::nearest(Distances::new(tables.distance_words, tables.width), middle, first, half)
    }
}

/// The same for pixels near background, by rows outwards.
#[inline(always)]
fn nearest_in_sight(bits: Bits, middle: &Pixels, half: &Whole) -> Pixels {
    let (mut squared, mut nearest) = ([i32::MAX; LANES], *middle);
    for away in 0..=SIGHT {
        let mut left_to_see = 0;
        for k in 0..LANES {
            let half = half[k].min(SIGHT);
            let within = u32::MAX >> (2 * (SIGHT - half) + 1) << (SIGHT - half);
            for (dy, handicap) in [(-away, 0), (away, 1)] {
                let background = !bits.from(middle.column[k] - SIGHT, middle.row[k] + dy) & within;
                let left = (background << (SIGHT + 1)).leading_zeros() as i32;
                let right = (background >> SIGHT).trailing_zeros() as i32;
                // The left one wins among equals, and so does the upper one.
                let dx = if left <= right { -left } else { right };
                let rank = dx * dx + dy * dy;
                let better = (background != 0) & (away <= half) & (rank + handicap <= squared[k]);
                squared[k] = if better { rank } else { squared[k] };
                nearest.column[k] = if better { middle.column[k] + dx } else { nearest.column[k] };
                nearest.row[k] = if better { middle.row[k] + dy } else { nearest.row[k] };
            }
            left_to_see |= u32::from((away < half) & ((away + 1) * (away + 1) <= squared[k]));
        }
        if left_to_see == 0 {
            break;
        }
    }
    nearest
}

/// The directions in the image of the paper's normals: the sums over 5x5 windows, or what stands in for them.
#[inline(always)]
fn tangents(view: &Folded, middle: &Pixels, nearest: &Pixels) -> Pixels {
    let bits = view.bits(Within::Subject);
    let (mut sum, mut short) = (Pixels { column: [0; LANES], row: [0; LANES] }, [0_u32; LANES]);
    for k in 0..LANES {
        let (mut x, mut y, mut count) = (0, 0, 0);
        for dy in [-2, -1, 0, 1, 2] {
            let row = !bits.from(nearest.column[k] - WINDOW, nearest.row[k] + dy);
            let [a, b, c, d, e] = [0, 1, 2, 3, 4].map(|bit| (row >> bit & 1) as i32);
            let pixels = a + b + c + d + e;
            x += 2 * (e - a) + d - b;
            y += dy * pixels;
            count += pixels;
        }
        // A mean of less than three tenths of a pixel has no direction.
        short[k] = u32::from(100 * (x * x + y * y) < 9 * count * count);
        (sum.column[k], sum.row[k]) = (x, y);
    }
    if short.iter().any(|&short| short != 0) {
        let corner = view.tables.corner;
        for k in (0..LANES).filter(|&k| short[k] != 0) {
            let (i, j) = (nearest.column[k] + corner.0, nearest.row[k] + corner.1);
            let towards = (nearest.column[k] - middle.column[k], nearest.row[k] - middle.row[k]);
            (sum.column[k], sum.row[k]) = view.silhouette.paper_direction(i, j).unwrap_or(towards);
        }
    }
    sum
}

/// The unit normals of the planes through the camera and the edges at `nearest`.
#[inline(always)]
fn normals_at(view: &Folded, nearest: &Pixels, tangents: &Pixels) -> Block {
    let [p0, p1, p2] = &view.p;
    let mut normal = Block::default();
    for k in 0..LANES {
        let (u, v) = (nearest.column[k] as f32 + 0.5, nearest.row[k] as f32 + 0.5);
        let (along_u, along_v) = (tangents.column[k] as f32, tangents.row[k] as f32);
        let across = |axis: usize| (p0[axis] - u * p2[axis]) * along_u + (p1[axis] - v * p2[axis]) * along_v;
        let (x, y, z) = (across(0), across(1), across(2));
        let length = (x * x + y * y + z * z).sqrt();
        let per_length = either(length > 0.0, 1.0 / length, 0.0);
        (normal.x[k], normal.y[k], normal.z[k]) = (x * per_length, y * per_length, z * per_length);
    }
    normal
}
