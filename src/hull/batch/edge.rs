//! The edges nearest to many points, and their normals (paper, section 4.2).

use super::super::lanes::{bits_of, either, whole};
use super::super::points::{Block, LANES, Lane};
use super::fold::Folded;
use super::inside::Within;
use super::pool::Sighting;
use super::rings::{Pixels, nearest};

/// Half-width of the normal's window.
const WINDOW: i32 = 2;

/// The unit normals, outwards, of the edges nearest to points that the view decides, with windows of half-width
/// `half`, in the volume's frame. Zero where there is none.
#[inline(always)]
pub(super) fn normals(view: &Folded, sighting: &Sighting, half: &Lane) -> Block {
    let [right, below] = view.last_pixel();
    let (mut middle, mut first, mut window) = (Pixels::default(), [0; LANES], [0; LANES]);
    for k in 0..LANES {
        middle.column[k] = whole(sighting.u[k], right) as i32;
        middle.row[k] = whole(sighting.v[k], below) as i32;
        (first[k], window[k]) = (bits_of(sighting.clear[k]) as i32, bits_of(half[k]) as i32);
    }
    let nearest = nearest(&view.tables, &middle, &first, &window);
    normals_at(view, &nearest, &tangents(view, &middle, &nearest))
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
