//! The filter: which of many points are inside, tested by bounding spheres and then by blocks of points side by side.

use super::body_view::{BodyPlacement, BodyView, MaskDilation, NEAREST, Volume};
use crate::hull::Unseen;
use crate::math::lanes::{floor_clamped, lane_mask, select, set_bits};
use crate::math::point_cloud::{BLOCKS_PER_GROUP, Block, BoundingSpheres, LANES, Points};
use crate::math::vectorised;

/// At this number of blocks or fewer, testing their points is faster than testing their spheres in further views.
const FEW_BLOCKS: u32 = 2;

/// The points found.
#[derive(Debug, Default)]
pub(super) struct FoundPoints {
    /// The places of the points in the blocks, ascending.
    pub(super) places: Vec<u32>,
    /// For each view a bit mask of the blocks of a group of which it surely sees every point inside.
    fully_inside: Vec<u32>,
}

/// The conditions under which a point is found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Filter<'a> {
    pub(super) dilation: MaskDilation,
    pub(super) unseen: Unseen,
    /// Whether one view may be overruled, so that a point is found although that view sees it outside.
    pub(super) may_overrule: bool,
    /// The work volume and the points' placement in it; `None` if no point has to be tested against it.
    pub(super) cut: Option<(&'a Volume, &'a BodyPlacement)>,
}

/// The verdicts of a view on a block of points, as bit masks.
#[derive(Clone, Copy)]
struct ViewVerdict {
    /// The points that the view sees inside, and those on which it abstains.
    admitted: u32,
    /// The points that the view sees inside.
    seen_inside: u32,
}

vectorised! {
    /// Whether any point in the sphere around a body's points may be inside.
    pub(super) fn may_be_inside(views: &[BodyView], placement: &BodyPlacement, filter: &Filter) -> bool {
        let mut rejecting = 0;
        for view in views {
            let tables = (&view.tables.occupancy.lookup(), &view.distances());
            let (middle, radius) = (placement.middle(), placement.radius);
            let (touches, _) = view.sphere(tables, middle, radius, filter.dilation.pixels());
            rejecting += u32::from(!touches && !filter.may_abstain_on(view, middle, radius));
        }
        rejecting <= u32::from(filter.may_overrule)
    }
}

vectorised! {
    /// Adds the places of the points inside, in ascending order.
    pub(super) fn find(points: &Points, views: &[BodyView], filter: &Filter, found: &mut FoundPoints) {
        let FoundPoints { places, fully_inside } = found;
        // The view that rejected the last spheres or points is tested first: it is likely to reject their neighbours.
        let (mut first_for_spheres, mut first_for_points) = (0, 0);

        for (group, (spheres, blocks)) in points.blocks().enumerate() {
            // The blocks whose spheres may be inside.
            let mut active = u32::MAX >> (u32::BITS as usize - blocks.len());
            let mut rejected = filter.rejected_at_first();
            fully_inside.clear();
            fully_inside.resize(views.len(), 0);
            for view in cyclic(first_for_spheres, views.len()) {
                let (touched, inside) = classify_spheres(&views[view], spheres, filter);
                active &= touched | !rejected;
                rejected |= !touched;
                fully_inside[view] = inside;
                if active.count_ones() <= FEW_BLOCKS {
                    first_for_spheres = view;
                    break;
                }
            }

            // Their points.
            for k in set_bits(active) {
                let (block, index) = (&blocks[k], group * BLOCKS_PER_GROUP + k);
                let lanes = u32::MAX >> (LANES - points.active_lanes(index));
                let is_inside = |view: usize| fully_inside[view] >> k & 1 != 0;
                let mut inside = filter.of_block(views, block, lanes, is_inside, &mut first_for_points);
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
    /// Which of the points of a block in the bit mask `active` are inside. `is_inside` names the views that surely see
    /// all of them inside. Views are tested in turn from `first` on, which becomes the view that rejected the last
    /// point.
    #[inline(always)]
    fn of_block(
        &self,
        views: &[BodyView],
        block: &Block,
        active: u32,
        is_inside: impl Fn(usize) -> bool,
        first: &mut usize,
    ) -> u32 {
        let may_abstain = self.unseen != Unseen::Outside;
        let (mut inside, mut seen_by) = (active, [0; LANES]);
        let mut rejected = self.rejected_at_first();

        for view in cyclic(*first, views.len()) {
            let mut verdict = ViewVerdict { admitted: u32::MAX, seen_inside: u32::MAX };
            if !is_inside(view) {
                verdict = self.verdict(&views[view], block);
            }
            inside &= verdict.admitted | !rejected;
            rejected |= !verdict.admitted;
            if inside == 0 {
                *first = view;
                return 0;
            }

            if may_abstain {
                for k in 0..LANES {
                    seen_by[k] += (verdict.seen_inside | !verdict.admitted) >> k & 1;
                }
            }
        }
        if !may_abstain {
            return inside;
        }

        let (mut enough, min_views) = ([0; LANES], self.unseen.min_views(views.len()) as u32);
        for k in 0..LANES {
            enough[k] = u32::from(seen_by[k] >= min_views);
        }
        inside & lane_mask(&enough)
    }

    /// A bit mask of the points that no view may reject any more, before the first view.
    #[inline(always)]
    fn rejected_at_first(&self) -> u32 {
        if self.may_overrule { 0 } else { u32::MAX }
    }

    /// Whether a view may abstain on some part of a sphere.
    #[inline(always)]
    fn may_abstain_on(&self, view: &BodyView, centre: [f32; 3], radius: f32) -> bool {
        match &view.field_of_view {
            Some(image) => self.unseen != Unseen::Outside && !view.sees_sphere(image, centre, radius),
            None => false,
        }
    }

    /// The verdicts of a view on a block of points.
    #[inline(always)]
    fn verdict(&self, view: &BodyView, block: &Block) -> ViewVerdict {
        let Some(field_of_view) = &view.field_of_view else {
            let inside = subject(view, block, self.dilation);
            return ViewVerdict { admitted: inside, seen_inside: inside };
        };

        // A point that the view may or may not see, by rounding, counts as both.
        let mut at = [[0.0; 3]; LANES];
        for k in 0..LANES {
            at[k] = view.project(block, k);
        }
        let (surely_visible, maybe_visible) = field_of_view.visible(&at, self.dilation);
        let mut seen_inside = subject(view, block, self.dilation) & maybe_visible;
        let mut unseen = !surely_visible;

        if self.dilation == MaskDilation::None {
            // The mask shows subject at pixels that the lens did not see.
            let blind = set_bits(seen_inside).filter(|&k| !field_of_view.lens_sees(at[k]));
            let blind = blind.fold(0, |blind, k| blind | 1 << k);
            (seen_inside, unseen) = (seen_inside & !blind, unseen | blind);
        }
        let abstained = if self.unseen == Unseen::Outside { 0 } else { unseen };
        ViewVerdict { admitted: seen_inside | abstained, seen_inside }
    }
}

/// The indices from 0 to `count`, starting at `first` and wrapping around.
#[inline(always)]
fn cyclic(first: usize, count: usize) -> impl Iterator<Item = usize> {
    (first..count).chain(0..first)
}

/// Bit masks of the spheres that may have points inside by a view, and of those that the view surely sees inside as a
/// whole.
#[inline(always)]
fn classify_spheres(view: &BodyView, spheres: &BoundingSpheres, filter: &Filter) -> (u32, u32) {
    let occupancy = view.tables.occupancy.lookup();
    let distances = view.distances();
    let dilation = filter.dilation.pixels();

    let (mut touched, mut inside) = ([0; BLOCKS_PER_GROUP], [0; BLOCKS_PER_GROUP]);
    for k in 0..BLOCKS_PER_GROUP {
        let centre = [spheres.x[k], spheres.y[k], spheres.z[k]];
        let (touches, is_inside) = view.sphere((&occupancy, &distances), centre, spheres.radius[k], dilation);
        (touched[k], inside[k]) = (u32::from(touches), u32::from(is_inside));
    }
    let (touched, inside) = (lane_mask(&touched), lane_mask(&inside));
    let Some(field_of_view) = &view.field_of_view else { return (touched, inside) };

    // A sphere of which the view may not see some part is neither rejected nor surely inside.
    let mut visible = [0; BLOCKS_PER_GROUP];
    for k in 0..BLOCKS_PER_GROUP {
        let centre = [spheres.x[k], spheres.y[k], spheres.z[k]];
        visible[k] = u32::from(view.sees_sphere(field_of_view, centre, spheres.radius[k]));
    }
    let visible = lane_mask(&visible);
    let abstained = if filter.unseen == Unseen::Outside { 0 } else { !visible };
    (touched | abstained, if field_of_view.has_blind_spots() { 0 } else { inside & visible })
}

/// A bit mask of the points of a block that project into the silhouette.
///
/// A single loop does everything, so that the compiler vectorises it as a whole.
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
