//! Sphere tracing of several rays at once: the steps of one ray wait for one another, those of several do not.
//!
//! All rays of a packet ask the same view at the same time: each goes on until the view lets it pass, and waits for the others.

// Loops over the lanes of several arrays by index become vector instructions.
#![allow(clippy::needless_range_loop)]

use super::super::lanes::{LANES, Lanes, Mask, any, mask, select, whole};
use super::ray::{Ray, clip_to_box};
use super::view::MarchView;
use super::{BLIND_STEP, Entry, MIN_DEPTH, MIN_LEAP, MIN_LEAP_PX, MIN_RELATIVE_LEAP, March};
use std::ops::Range;

/// The images of the rays of a packet in one view: homogeneous coordinates `at_origin + t slope`.
#[derive(Debug, Clone, Default)]
pub struct PacketLines {
    at_origin: [Lanes; 3],
    slope: [Lanes; 3],
    /// The speeds of the images are these over the squared depths, in pixels a metre.
    speed: Lanes,
    /// The metres that each ray takes for a metre of depth; infinite for a ray that never comes nearer to the front.
    per_depth: Lanes,
}

/// Memory for packets of rays next to one another. What they meet depends a little on the packets before them, as on the view
/// that is asked first.
#[derive(Debug, Default)]
pub struct Packets {
    lines: Vec<PacketLines>,
    /// The view that decided the last ray: it is asked first, since it often decides neighbouring rays too.
    decided_by: usize,
}

impl Packets {
    /// Memory for the images of the rays of another packet.
    pub fn lines(&mut self) -> &mut Vec<PacketLines> {
        self.lines.clear();
        &mut self.lines
    }
}

/// Where the rays of a packet are.
struct Travel {
    t: Lanes,
    to: Lanes,
    /// The last distance that some view saw outside, and that view.
    before: Lanes,
    decided_by: [u32; LANES],
    /// Views in turn that let the ray pass at its distance, and those of them that see it.
    passed: [u32; LANES],
    seen: [u32; LANES],
    /// Whether the ray still asks the view whose turn it is, whether it is under way at all, and whether it has entered.
    asks: Mask,
    is_under_way: Mask,
    has_entered: Mask,
}

/// What one view says of the places of the rays of a packet.
struct Verdicts {
    is_outside: Mask,
    is_seen: Mask,
    /// The metres for which a ray that is outside stays there.
    leap: Lanes,
}

impl March<'_> {
    /// Where each of `rays` enters the hull within its range of distances, as [`entry`](Self::entry) tells of one.
    pub fn entries(
        &self,
        rays: &[Ray; LANES],
        ranges: &[Range<f32>; LANES],
        packets: &mut Packets,
    ) -> [Option<Entry>; LANES] {
        let clipped: [_; LANES] = std::array::from_fn(|k| {
            clip_to_box(&self.bounds, 0.0, &rays[k], (ranges[k].start, ranges[k].end))
        });
        if clipped.iter().all(Option::is_none) || self.views.is_empty() {
            return [None; LANES];
        }

        let first = if packets.decided_by < self.views.len() { packets.decided_by } else { 0 };
        let mut travel = Travel::new(&clipped, first);
        trace(self, rays, first, packets.lines(), &mut travel);
        std::array::from_fn(|k| {
            if travel.has_entered[k] == 0 {
                return None;
            }
            let view = travel.decided_by[k] as usize;
            packets.decided_by = view;
            Some(self.entry_between(&rays[k], travel.before[k], Entry { t: travel.t[k], view }))
        })
    }

    /// Lets the rays go on until view number `view`, in which they have these images, lets all of them pass.
    #[inline(always)]
    fn ask(&self, travel: &mut Travel, view: usize, lines: &PacketLines) {
        let count = self.views.len() as u32;
        let least_seen = self.min_views.map_or(count, |least| least as u32);
        travel.asks = travel.is_under_way;
        while any(&travel.asks) {
            let verdicts = self.views[view].verdicts(lines, &travel.t, mask(self.min_views.is_some()));
            for k in 0..LANES {
                let leap = verdicts.leap[k].max(MIN_LEAP).max(MIN_RELATIVE_LEAP * travel.t[k]);
                let leaps = travel.asks[k] & verdicts.is_outside[k];
                let passes = travel.asks[k] & !verdicts.is_outside[k];
                travel.before[k] = select(leaps, travel.t[k], travel.before[k]);
                travel.decided_by[k] = leaps & view as u32 | !leaps & travel.decided_by[k];
                travel.t[k] = select(leaps, travel.t[k] + leap, travel.t[k]);
                travel.passed[k] = !leaps & (travel.passed[k] + (passes & 1));
                travel.seen[k] = !leaps & (travel.seen[k] + (passes & verdicts.is_seen[k] & 1));
                travel.is_under_way[k] &= mask(travel.t[k] <= travel.to[k]);
                travel.asks[k] = leaps & travel.is_under_way[k];
            }
        }

        for k in 0..LANES {
            if travel.is_under_way[k] == 0 || travel.passed[k] < count {
                continue;
            }
            if travel.seen[k] >= least_seen {
                (travel.has_entered[k], travel.is_under_way[k]) = (u32::MAX, 0);
            } else {
                // Too few views see the place.
                travel.before[k] = travel.t[k];
                travel.t[k] += BLIND_STEP;
                (travel.passed[k], travel.seen[k]) = (0, 0);
                travel.is_under_way[k] = mask(travel.t[k] <= travel.to[k]);
            }
        }
    }
}

/// Lets rays go on until each has entered the hull or is past its range; view number `first` is asked first. `lines` is memory
/// for their images in the views.
#[multiversion::multiversion(targets("x86_64+avx2+fma+bmi1+bmi2+popcnt+lzcnt"))]
fn trace(
    march: &March,
    rays: &[Ray; LANES],
    first: usize,
    lines: &mut Vec<PacketLines>,
    travel: &mut Travel,
) {
    let count = march.views.len();
    let mut turn = 0;
    while any(&travel.is_under_way) {
        let view = if first + turn < count { first + turn } else { first + turn - count };
        if turn == lines.len() {
            lines.push(PacketLines::new(rays, &march.views[view]));
        }
        march.ask(travel, view, &lines[turn]);
        turn = if turn + 1 == count { 0 } else { turn + 1 };
    }
}

impl Travel {
    /// Rays that begin in these ranges, of which view number `first` decides first; those without a range never set out.
    fn new(ranges: &[Option<(f32, f32)>; LANES], first: usize) -> Self {
        let from = ranges.map(|range| range.map_or(0.0, |(from, _)| from));
        Self {
            t: from,
            to: ranges.map(|range| range.map_or(0.0, |(_, to)| to)),
            before: from,
            decided_by: [first as u32; LANES],
            passed: [0; LANES],
            seen: [0; LANES],
            asks: [0; LANES],
            is_under_way: ranges.map(|range| mask(range.is_some())),
            has_entered: [0; LANES],
        }
    }
}

impl PacketLines {
    /// The images of `rays` in `view`.
    #[inline(always)]
    pub fn new(rays: &[Ray; LANES], view: &MarchView) -> Self {
        let mut lines = Self::default();
        for k in 0..LANES {
            let (o, d) = (&rays[k].origin, &rays[k].direction);
            for row in 0..3 {
                let p = |column: usize| view.projection[(row, column)];
                lines.at_origin[row][k] = p(0) * o.x + p(1) * o.y + p(2) * o.z + p(3);
                lines.slope[row][k] = p(0) * d.x + p(1) * d.y + p(2) * d.z;
            }
        }
        let ([x, y, z], [along_x, along_y, along_z]) = (&lines.at_origin, &lines.slope);
        for k in 0..LANES {
            let (across, down) =
                (along_x[k] * z[k] - x[k] * along_z[k], along_y[k] * z[k] - y[k] * along_z[k]);
            lines.speed[k] = (across * across + down * down).sqrt();
            lines.per_depth[k] = if along_z[k] > 0.0 { 1.0 / along_z[k] } else { f32::INFINITY };
        }
        lines
    }

    /// Makes the image of ray number `k` that of ray number `k` in another view, whose images are `other`.
    #[inline(always)]
    pub fn copy_ray(&mut self, k: usize, other: &Self) {
        for row in 0..3 {
            self.at_origin[row][k] = other.at_origin[row][k];
            self.slope[row][k] = other.slope[row][k];
        }
        (self.speed[k], self.per_depth[k]) = (other.speed[k], other.per_depth[k]);
    }

    /// The image positions `u` and `v` of the points at distances `t`, and their depths.
    #[inline(always)]
    pub fn images_at(&self, t: &Lanes) -> [Lanes; 3] {
        let (mut u, mut v, mut depth) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        let ([x, y, z], [along_x, along_y, along_z]) = (&self.at_origin, &self.slope);
        for k in 0..LANES {
            depth[k] = z[k] + along_z[k] * t[k];
            let per_depth = 1.0 / depth[k];
            u[k] = (x[k] + along_x[k] * t[k]) * per_depth;
            v[k] = (y[k] + along_y[k] * t[k]) * per_depth;
        }
        [u, v, depth]
    }
}

impl MarchView<'_> {
    /// What the view says of the places at distances `t` along rays with these images. Where it `abstains`, it does not see
    /// what is outside its image; elsewhere it sees everything.
    #[inline(always)]
    fn verdicts(&self, lines: &PacketLines, t: &Lanes, abstains: u32) -> Verdicts {
        let ([u, v, depth], along_z) = (lines.images_at(t), &lines.slope[2]);
        let distance = self.distances(&u, &v);

        let mut verdicts = Verdicts { is_outside: [0; LANES], is_seen: [0; LANES], leap: [0.0; LANES] };
        for k in 0..LANES {
            let leap_px = distance[k].max(MIN_LEAP_PX);
            let slower = lines.speed[k] - leap_px * depth[k] * along_z[k];
            // A ray that flees from the camera may never move so far.
            let leap = if slower <= 0.0 { f32::INFINITY } else { leap_px * depth[k] * depth[k] / slower };
            // The factor keeps a ray in front of the camera in spite of rounding.
            let to_front = (1.001 * MIN_DEPTH - depth[k]) * lines.per_depth[k] + 1e-4;

            let is_behind = mask(depth[k] < MIN_DEPTH);
            let is_in_image =
                mask(u[k] >= 0.0) & mask(v[k] >= 0.0) & mask(u[k] < self.image.x) & mask(v[k] < self.image.y);
            verdicts.is_seen[k] = !abstains | is_in_image & !is_behind;
            verdicts.is_outside[k] = verdicts.is_seen[k] & (is_behind | mask(distance[k] > 0.0));
            verdicts.leap[k] = select(is_behind, to_front, leap);
        }
        verdicts
    }

    /// [`distance`](Self::distance) at several image positions.
    #[inline(always)]
    pub fn distances(&self, u: &Lanes, v: &Lanes) -> Lanes {
        let ([columns, rows], stride) = (self.last, self.stride as i32);
        let (mut index, mut right, mut below, mut beyond) =
            ([0; LANES], [0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let (column, row) = (u[k] - self.first[0], v[k] - self.first[1]);
            let (x, y) = (column.max(0.0).min(columns), row.max(0.0).min(rows));
            // The last row and column are the lower and right ones of those before them.
            let (i, j) = (whole(x).min(stride - 2), whole(y).min(rows as i32 - 1).max(0));
            index[k] = j * stride + i;
            (right[k], below[k]) = (x - i as f32, y - j as f32);
            let (du, dv) = (column - x, row - y);
            beyond[k] = du * du + dv * dv;
        }

        let mut corners = [[f32::MAX; LANES]; 4];
        for k in 0..LANES {
            let at = index[k] as usize;
            let Some(found) = self.distances.get(at..at + self.stride + 2) else { continue };
            let [upper, lower] = [0, self.stride].map(|row| [found[row], found[row + 1]]);
            (corners[0][k], corners[1][k], corners[2][k], corners[3][k]) =
                (upper[0], upper[1], lower[0], lower[1]);
        }

        let mut distances = [0.0; LANES];
        for k in 0..LANES {
            let upper = corners[0][k] + (corners[1][k] - corners[0][k]) * right[k];
            let lower = corners[2][k] + (corners[3][k] - corners[2][k]) * right[k];
            distances[k] = upper + (lower - upper) * below[k];
        }
        // Most places are within the known distances.
        if beyond != [0.0; LANES] {
            for k in 0..LANES {
                let around = (beyond[k] + distances[k] * distances[k]).sqrt();
                distances[k] = if beyond[k] > 0.0 { around } else { distances[k] };
            }
        }
        distances
    }
}
