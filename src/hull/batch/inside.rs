//! Which of many points are inside, as many at a time as a vector register holds.

use super::super::lanes::{bits, either, ones, whole};
use super::super::points::{Block, GROUP, LANES, Points, Spheres};
use super::fold::{Folded, NEAREST, Posed, Volume};
use crate::vectorised::vectorised;

/// So few blocks are sooner asked point by point than in further views by the spheres around them.
const FEW: u32 = 2;

/// What counts as inside a silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Within {
    /// A subject pixel.
    Subject,
    /// A subject pixel or one beside it: nothing that any edge model calls inside is missed.
    NearSubject,
}

/// Points inside.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Their places in the blocks, ascending.
    pub(super) places: Vec<u32>,
    /// Scratch: for each view the blocks of which it surely sees all within, a bit each.
    whole: Vec<u32>,
}

impl Within {
    /// By how many pixels it reaches beyond the subject.
    pub(super) fn more_pixels(self) -> f32 {
        f32::from(u8::from(self == Self::NearSubject))
    }
}

vectorised! {
    /// Whether the sphere around a body's points may appear `within` every view's silhouette.
    pub(super) fn may_be_seen(views: &[Folded], posed: &Posed, within: Within) -> bool {
        let mut is_seen = true;
        for view in views {
            let tables = (&view.tables.tiles.lookup(), &view.distances());
            is_seen = is_seen && view.sphere(tables, posed.middle(), posed.radius, within.more_pixels()).0;
        }
        is_seen
    }
}

vectorised! {
    /// Adds the places of the points that all views see `within` the silhouette, in their order.
    ///
    /// `volume` is the work volume, and the points' pose in it, where it may cut points off.
    pub(super) fn find(
        points: &Points,
        views: &[Folded],
        volume: Option<(&Volume, &Posed)>,
        within: Within,
        found: &mut Found,
    ) {
        let Found { places, whole } = found;
        // The view that ruled the last ones out is likely to rule out their neighbours: it is asked first.
        let (mut sharp, mut sharpest) = (0, 0);
        for (group, (spheres, blocks)) in points.blocks().enumerate() {
            let mut asked = u32::MAX >> (u32::BITS as usize - blocks.len());
            whole.clear();
            whole.resize(views.len(), 0);
            for view in round(sharp, views.len()) {
                let (touched, inside) = spheres_seen(&views[view], spheres, within);
                asked &= touched;
                whole[view] = inside;
                if asked.count_ones() <= FEW {
                    sharp = view;
                    break;
                }
            }
            for k in ones(asked) {
                let (block, index) = (&blocks[k], group * GROUP + k);
                let mut inside = u32::MAX >> (LANES - points.filled(index));
                for view in round(sharpest, views.len()) {
                    if whole[view] >> k & 1 == 0 {
                        inside &= seen(&views[view], block, within);
                    }
                    if inside == 0 {
                        sharpest = view;
                        break;
                    }
                }
                if inside != 0 && let Some((volume, posed)) = volume {
                    inside &= volume.contains(posed, block);
                }
                let (mut found, mut count) = ([0; LANES], 0);
                for lane in ones(inside) {
                    found[count] = (index * LANES + lane) as u32;
                    count += 1;
                }
                places.extend_from_slice(&found[..count]);
            }
        }
    }
}

vectorised! {
    /// Which points of a block lie inside, a bit each.
    pub(super) fn of_block(views: &[Folded], block: &Block) -> u32 {
        let mut inside = u32::MAX;
        for view in views {
            inside &= seen(view, block, Within::Subject);
            if inside == 0 {
                break;
            }
        }
        inside
    }
}

/// All of so many places, from `first` on round.
#[inline(always)]
fn round(first: usize, count: usize) -> impl Iterator<Item = usize> {
    (first..count).chain(0..first)
}

/// Which of many spheres may appear in a view's silhouette, and which surely do as a whole, a bit each.
#[inline(always)]
fn spheres_seen(view: &Folded, spheres: &Spheres, within: Within) -> (u32, u32) {
    let tiles = view.tables.tiles.lookup();
    let distances = view.distances();
    let (near, mut touched, mut inside) = (within.more_pixels(), [0; GROUP], [0; GROUP]);
    for k in 0..GROUP {
        let centre = [spheres.x[k], spheres.y[k], spheres.z[k]];
        let (touches, is_inside) = view.sphere((&tiles, &distances), centre, spheres.radius[k], near);
        (touched[k], inside[k]) = (u32::from(touches), u32::from(is_inside));
    }
    (bits(&touched), bits(&inside))
}

/// Which points of a block a view sees within the silhouette, a bit each.
///
/// One loop over all that happens to a point, so that the compiler turns it into vector instructions as a whole.
#[inline(always)]
fn seen(view: &Folded, block: &Block, within: Within) -> u32 {
    let (bits_within, [pu, pv, pd]) = (view.bits(within), &view.p);
    let [right, below] = view.last_pixel();
    let mut hit = [0; LANES];
    for k in 0..LANES {
        let (x, y, z) = (block.x[k], block.y[k], block.z[k]);
        let depth = pd[0].mul_add(x, pd[1].mul_add(y, pd[2].mul_add(z, pd[3])));
        let u = pu[0].mul_add(x, pu[1].mul_add(y, pu[2].mul_add(z, pu[3])));
        let v = pv[0].mul_add(x, pv[1].mul_add(y, pv[2].mul_add(z, pv[3])));
        let per_depth = either(depth > NEAREST, 1.0 / depth, 0.0);
        hit[k] = bits_within.at(whole(u * per_depth, right), whole(v * per_depth, below));
    }
    bits(&hit)
}
