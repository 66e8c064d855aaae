//! Which of many points are inside, as many at a time as a vector register holds.

use super::body_view::{BodyPlacement, BodyView, MaskDilation, NEAREST, Volume};
use crate::hull::Unseen;
use crate::math::lanes::{floor_clamped, lane_mask, select, set_bits};
use crate::math::point_cloud::{BLOCKS_PER_GROUP, Block, BoundingSpheres, LANES, Points};
use crate::math::vectorised;

/// So few blocks are sooner asked point by point than in further views by the spheres around them.
const FEW_POINTS: u32 = 2;

/// Points inside.
#[derive(Debug, Default)]
pub(super) struct Found {
    /// Their places in the blocks, ascending.
    pub(super) places: Vec<u32>,
    /// For each view the blocks of which it surely sees all inside, a bit each.
    fully_inside: Vec<u32>,
}

/// What is asked of points.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filter<'a> {
    pub(super) dilation: MaskDilation,
    pub(super) unseen: Unseen,
    /// The work volume, and the points' placement in it, where it may cut points off.
    pub(super) cut: Option<(&'a Volume, &'a BodyPlacement)>,
}

/// What a view says of a block of points, a bit each.
#[derive(Clone, Copy)]
struct ViewVerdict {
    /// It does not make them outside.
    admitted: u32,
    /// It sees them inside.
    seen_inside: u32,
}

vectorised! {
    /// Whether the sphere around a body's points may be inside by every view.
    pub(super) fn may_be_inside(views: &[BodyView], placement: &BodyPlacement, filter: &Filter) -> bool {
        let mut may_be = true;
        for view in views {
            let tables = (&view.tables.occupancy.lookup(), &view.distances());
            let (middle, radius) = (placement.middle(), placement.radius);
            let (touches, _) = view.sphere(tables, middle, radius, filter.dilation.pixels());
            may_be = may_be && (touches || filter.may_abstain_on(view, middle, radius));
        }
        may_be
    }
}

vectorised! {
    /// Adds the places of the points inside, in their order.
    pub(super) fn find(points: &Points, views: &[BodyView], filter: &Filter, found: &mut Found) {
        let Found { places, fully_inside } = found;
        // The view that rejected the last ones is likely to reject their neighbours: it is asked first.
        let (mut first_of_spheres, mut first_of_points) = (0, 0);
        for (group, (spheres, blocks)) in points.blocks().enumerate() {
            let mut asked = u32::MAX >> (u32::BITS as usize - blocks.len());
            fully_inside.clear();
            fully_inside.resize(views.len(), 0);
            for view in round(first_of_spheres, views.len()) {
                let (touched, inside) = classify_spheres(&views[view], spheres, filter);
                asked &= touched;
                fully_inside[view] = inside;
                if asked.count_ones() <= FEW_POINTS {
                    first_of_spheres = view;
                    break;
                }
            }

            for k in set_bits(asked) {
                let (block, index) = (&blocks[k], group * BLOCKS_PER_GROUP + k);
                let lanes = u32::MAX >> (LANES - points.active_lanes(index));
                let is_inside = |view: usize| fully_inside[view] >> k & 1 != 0;
                let mut inside = filter.of_block(views, block, lanes, is_inside, &mut first_of_points);
                if inside != 0 && let Some((volume, placement)) = filter.cut {
                    inside &= volume.contains(placement, block);
                }
                let (mut found, mut count) = ([0; LANES], 0);
                for lane in set_bits(inside) {
                    found[count] = (index * LANES + lane) as u32;
                    count += 1;
                }
                places.extend_from_slice(&found[..count]);
            }
        }
    }
}

impl Filter<'_> {
    /// Which points `asked` of a block are inside; of which views that holds for all of them, is known. The view that
    /// rejects the last one is noted as the one to be asked first.
    #[inline(always)]
    fn of_block(
        &self,
        views: &[BodyView],
        block: &Block,
        queried: u32,
        is_inside: impl Fn(usize) -> bool,
        first: &mut usize,
    ) -> u32 {
        let may_abstain = self.unseen != Unseen::Outside;
        let (mut inside, mut seen_by) = (queried, [0; LANES]);
        for view in round(*first, views.len()) {
            let mut verdict = ViewVerdict { admitted: u32::MAX, seen_inside: u32::MAX };
            if !is_inside(view) {
                verdict = self.verdict(&views[view], block);
            }
            inside &= verdict.admitted;
            if inside == 0 {
                *first = view;
                return 0;
            }
            if may_abstain {
                for k in 0..LANES {
                    seen_by[k] += verdict.seen_inside >> k & 1;
                }
            }
        }
        if !may_abstain {
            return inside;
        }

        let (mut enough, least) = ([0; LANES], self.unseen.min_views(views.len()) as u32);
        for k in 0..LANES {
            enough[k] = u32::from(seen_by[k] >= least);
        }
        inside & lane_mask(&enough)
    }

    /// Whether a view may abstain on some of what lies within `radius` of a point.
    #[inline(always)]
    fn may_abstain_on(&self, view: &BodyView, centre: [f32; 3], radius: f32) -> bool {
        match &view.field_of_view {
            Some(sight) => self.unseen != Unseen::Outside && !view.sees_sphere(sight, centre, radius),
            None => false,
        }
    }

    /// What a view says of a block of points.
    #[inline(always)]
    fn verdict(&self, view: &BodyView, block: &Block) -> ViewVerdict {
        let Some(sight) = &view.field_of_view else {
            let inside = subject(view, block, self.dilation);
            return ViewVerdict { admitted: inside, seen_inside: inside };
        };
        let mut at = [[0.0; 3]; LANES];
        for k in 0..LANES {
            at[k] = view.project(block, k);
        }
        let (surely_visible, maybe_visible) = sight.visible(&at, self.dilation);
        let mut seen_inside = subject(view, block, self.dilation) & maybe_visible;
        let mut unseen = !surely_visible;
        if self.dilation == MaskDilation::None {
            // A lens's mask shows subject where the lens did not see.
            let blind = set_bits(seen_inside).filter(|&k| !sight.lens_sees(at[k]));
            let blind = blind.fold(0, |blind, k| blind | 1 << k);
            (seen_inside, unseen) = (seen_inside & !blind, unseen | blind);
        }
        let abstained = if self.unseen == Unseen::Outside { 0 } else { unseen };
        ViewVerdict { admitted: seen_inside | abstained, seen_inside }
    }
}

/// All of so many places, from `first` on round.
#[inline(always)]
fn round(first: usize, count: usize) -> impl Iterator<Item = usize> {
    (first..count).chain(0..first)
}

/// Which of many spheres may be inside by a view, and which surely are as a whole, a bit each.
#[inline(always)]
fn classify_spheres(view: &BodyView, spheres: &BoundingSpheres, filter: &Filter) -> (u32, u32) {
    let tiles = view.tables.occupancy.lookup();
    let distances = view.distances();
    let (dilation, mut touched, mut inside) =
        (filter.dilation.pixels(), [0; BLOCKS_PER_GROUP], [0; BLOCKS_PER_GROUP]);
    for k in 0..BLOCKS_PER_GROUP {
        let centre = [spheres.x[k], spheres.y[k], spheres.z[k]];
        let (touches, is_inside) = view.sphere((&tiles, &distances), centre, spheres.radius[k], dilation);
        (touched[k], inside[k]) = (u32::from(touches), u32::from(is_inside));
    }
    let (touched, inside) = (lane_mask(&touched), lane_mask(&inside));
    let Some(sight) = &view.field_of_view else { return (touched, inside) };

    // What the view may not see it neither rejects nor surely sees.
    let mut seen = [0; BLOCKS_PER_GROUP];
    for k in 0..BLOCKS_PER_GROUP {
        let centre = [spheres.x[k], spheres.y[k], spheres.z[k]];
        seen[k] = u32::from(view.sees_sphere(sight, centre, spheres.radius[k]));
    }
    let seen = lane_mask(&seen);
    let abstained = if filter.unseen == Unseen::Outside { 0 } else { !seen };
    (touched | abstained, if sight.has_blind_spots() { 0 } else { inside & seen })
}

/// Which points of a block appear in the silhouette, a bit each.
///
/// One loop over all that happens to a point, so that the compiler turns it into vector instructions as a whole.
#[inline(always)]
fn subject(view: &BodyView, block: &Block, dilation: MaskDilation) -> u32 {
    let (bits, [pu, pv, pd]) = (view.mask_bits(dilation), &view.p);
    let [right, below] = view.last_pixel();
    let mut hit = [0; LANES];
    for k in 0..LANES {
        let (x, y, z) = (block.x[k], block.y[k], block.z[k]);
        let depth = pd[0].mul_add(x, pd[1].mul_add(y, pd[2].mul_add(z, pd[3])));
        let u = pu[0].mul_add(x, pu[1].mul_add(y, pu[2].mul_add(z, pu[3])));
        let v = pv[0].mul_add(x, pv[1].mul_add(y, pv[2].mul_add(z, pv[3])));
        let per_depth = select(depth > NEAREST, 1.0 / depth, 0.0);
        hit[k] = bits.at(floor_clamped(u * per_depth, right), floor_clamped(v * per_depth, below));
    }
    lane_mask(&hit)
}
