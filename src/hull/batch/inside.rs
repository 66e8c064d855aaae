//! Which of many points are inside, as many at a time as a vector register holds.

use super::super::points::{Block, LANES, Points, Spheres};
use super::fold::{Folded, FoldedBox, NEAREST, either, whole};
use crate::silhouette::{LOW, Word};
use crate::vectorised::vectorised;

/// What counts as inside a silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Within {
    /// A subject pixel.
    Subject,
    /// A subject pixel or one beside it: nothing that any edge model calls inside is missed.
    NearSubject,
}

vectorised! {
    /// Adds the places of the points that all views see `within` the silhouette, in their order.
    ///
    /// `volume` is the work volume where it may cut points off.
    pub(super) fn find(
        points: &Points,
        views: &[Folded],
        volume: Option<&FoldedBox>,
        within: Within,
        found: &mut Vec<u32>,
    ) {
        let near = f32::from(u8::from(within == Within::NearSubject));
        for (group, (spheres, blocks)) in points.blocks().enumerate() {
            let mut asked = u32::MAX >> (LANES - blocks.len());
            for view in views {
                asked &= touched(view, spheres, near);
                if asked == 0 {
                    break;
                }
            }
            while asked != 0 {
                let k = asked.trailing_zeros() as usize;
                asked &= asked - 1;
                let (block, index) = (&blocks[k], group * LANES + k);
                let mut inside = u32::MAX >> (LANES - points.filled(index));
                for view in views {
                    inside &= seen(view, block, within);
                    if inside == 0 {
                        break;
                    }
                }
                if inside != 0 && let Some(volume) = volume {
                    inside &= volume.contains(&block.x, &block.y, &block.z);
                }
                while inside != 0 {
                    found.push((index * LANES + inside.trailing_zeros() as usize) as u32);
                    inside &= inside - 1;
                }
            }
        }
    }
}

/// Which of many spheres may appear in a view's silhouette, a bit each.
#[inline(always)]
fn touched(view: &Folded, spheres: &Spheres, near: f32) -> u32 {
    let (tiles, mut touched) = (view.tables.tiles.lookup(), [0; LANES]);
    for k in 0..LANES {
        let centre = [spheres.x[k], spheres.y[k], spheres.z[k]];
        touched[k] = u32::from(view.may_touch(&tiles, centre, spheres.radius[k], near));
    }
    bits(&touched)
}

/// Zeros and ones as bits.
#[inline(always)]
fn bits(ones: &[u32; LANES]) -> u32 {
    ones.iter().enumerate().fold(0, |bits, (k, one)| bits | one << k)
}

/// Which points of a block a view sees within the silhouette, a bit each.
///
/// One loop over all that happens to a point, so that the compiler turns it into vector instructions as a whole.
#[inline(always)]
fn seen(view: &Folded, block: &Block, within: Within) -> u32 {
    let tables = &view.tables;
    let table = if within == Within::Subject { tables.subject } else { tables.near };
    let (right, below) = (tables.width as f32 - 0.5, tables.height as f32 - 0.5);
    let (words, [pu, pv, pd]) = (tables.words as u32, &view.p);
    let mut hit = [0; LANES];
    let Some(last) = table.len().checked_sub(1) else { return 0 };
    let last = last as u32 & LOW;
    let table = &table[..=last as usize];
    for k in 0..LANES {
        let (x, y, z) = (block.x[k], block.y[k], block.z[k]);
        let depth = pd[0] * x + pd[1] * y + pd[2] * z + pd[3];
        let u = pu[0] * x + pu[1] * y + pu[2] * z + pu[3];
        let v = pv[0] * x + pv[1] * y + pv[2] * z + pv[3];
        let per_depth = either(depth > NEAREST, 1.0 / depth, 0.0);
        let (column, row) = (whole(u * per_depth, right), whole(v * per_depth, below));
        let place = (row * words + column / Word::BITS).min(last);
        hit[k] = table[place as usize] >> (column % Word::BITS) & 1;
    }
    bits(&hit)
}
