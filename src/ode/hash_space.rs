//! Pairs of geoms that ODE's hash space overlooks.
//!
//! ODE 0.16 puts a box whose longest side is 2^(n-1) to 2^n units into cells of 2^n units, and numbers the cells of a column
//! from `1000 n + 100 x + 10 y + z` on, the sum at the box's lowest cell, modulo the size of a table. Where that sum is
//! negative it wraps around as an unsigned number, so that the cells above it get other numbers than a box has that begins
//! there. Two boxes in cells of one unit are overlooked if the sum is negative for one of them alone: near the origin, if
//! one crosses z = 0 and the other does not. (Cells of two units or more are concerned below z = -2000 only.)

use super::convert;
use super::space::SpaceKind;
use super::world::World;
use crate::hull::Aabb;
use ode_sys::{dGeomGetClass, dGeomID, dHashSpaceClass, dHashSpaceGetLevels, dSpaceID};

impl World {
    /// The pairs of geoms, or spaces, that ODE's hash spaces have overlooked.
    pub(super) fn overlooked_pairs(&self) -> Vec<[dGeomID; 2]> {
        let mut pairs = Vec::new();
        for (key, space) in self.spaces.iter() {
            let SpaceKind::Hash { min_level, max_level: 0.. } = space.kind else { continue };
            let members = || {
                let geoms = self.geoms.iter().filter(|(_, geom)| geom.space == key).map(|(_, geom)| geom.raw);
                let inner = self.spaces.iter().filter(|(_, inner)| inner.parent == Some(key));
                geoms.chain(inner.map(|(_, space)| space.raw.cast()))
            };
            // SAFETY: geoms and spaces are alive.
            let aabb = |member: dGeomID| unsafe { convert::aabb_of(member) };

            // In most steps there is none, and nothing is allocated.
            if !members().any(|member| may_be_overlooked(&aabb(member), min_level)) {
                continue;
            }
            let members: Vec<dGeomID> = members().collect();
            let aabbs: Vec<Aabb> = members.iter().map(|&member| aabb(member)).collect();
            let found = pairs_among(&aabbs, min_level);
            pairs.extend(found.into_iter().map(|pair| pair.map(|index| members[index])));
        }
        pairs
    }
}

/// A geom's bounding box, and the cells of one unit that it lies in.
#[derive(Debug, Clone, Copy)]
struct Cells {
    aabb: Aabb,
    level: i32,
    low: [i64; 3],
    high: [i64; 3],
}

/// The binary logarithm of the smallest cell size of a hash space; `None` for other spaces and for null.
///
/// # Safety
///
/// `space` is null or a living space.
pub(super) unsafe fn min_level_of(space: dSpaceID) -> Option<i32> {
    // SAFETY: the caller guarantees a living space, whose class is checked.
    unsafe {
        if space.is_null() || dGeomGetClass(space.cast()) != dHashSpaceClass as i32 {
            return None;
        }
        let (mut min_level, mut max_level) = (0, 0);
        dHashSpaceGetLevels(space, &mut min_level, &mut max_level);
        Some(min_level)
    }
}

/// Whether a hash space with cells of at least 2^`min_level` units may overlook pairs of a box.
fn may_be_overlooked(aabb: &Aabb, min_level: i32) -> bool {
    let cells = Cells::new(aabb, min_level);
    cells.level <= 0 && cells.wraps()
}

/// The indices of all pairs among the bounding boxes `aabbs` that overlap, and that a hash space with cells of at least
/// 2^`min_level` units overlooks.
fn pairs_among(aabbs: &[Aabb], min_level: i32) -> Vec<[usize; 2]> {
    let small: Vec<(usize, Cells)> = aabbs
        .iter()
        .map(|aabb| Cells::new(aabb, min_level))
        .enumerate()
        .filter(|(_, cells)| cells.level <= 0)
        .collect();
    let wrapped = small.iter().filter(|(_, cells)| cells.wraps());

    let mut pairs = Vec::new();
    for (a, first) in wrapped {
        let others = small.iter().filter(|(b, second)| b != a && (first.level == 0 || second.level == 0));
        pairs.extend(others.filter(|(_, second)| first.overlooks(second)).map(|(b, _)| [*a, *b]));
    }
    pairs
}

/// A box around `aabb`, the bounding box of a geom in a hash space with cells of at least 2^`min_level` units, for which
/// the space overlooks no pair: it is in larger cells.
pub(super) fn out_of_unit_cells(aabb: &Aabb, min_level: i32) -> Aabb {
    /// A unit, and a little for rounding.
    const LONG_ENOUGH: f64 = 1.001;
    let cells = Cells::new(aabb, min_level);
    let is_at_origin = (0..3).all(|axis| cells.low[axis] <= 0 && cells.high[axis] >= 0);
    let mut longer = *aabb;
    if cells.level == 0 && is_at_origin {
        let axis = (aabb.max - aabb.min).imax();
        let margin = 0.5 * (LONG_ENOUGH - (aabb.max[axis] - aabb.min[axis]));
        longer.min[axis] -= margin;
        longer.max[axis] += margin;
    }
    longer
}

impl Cells {
    fn new(aabb: &Aabb, min_level: i32) -> Self {
        let longest = (aabb.max - aabb.min).max();
        // The least n with a longest side below 2^n, as ODE computes it; infinite boxes are compared with all.
        let level = match longest {
            ..0.5 => -1,
            0.5..1.0 => 0,
            _ => 1,
        };
        let cell = |x: f64| x.floor() as i64;
        let (low, high) = ([0, 1, 2].map(|k| cell(aabb.min[k])), [0, 1, 2].map(|k| cell(aabb.max[k])));
        Self { aabb: *aabb, level: level.max(min_level), low, high }
    }

    /// Whether the number of the lowest cell wraps around in the column at (x, y).
    fn wraps_at(&self, x: i64, y: i64) -> bool {
        x >= 0 && y >= 0 && 100 * x + 10 * y + self.low[2] < 0
    }

    /// Whether numbers wrap around within a column of the box.
    fn wraps(&self) -> bool {
        let [x, y, top] = self.high;
        let ends_above = |x: i64, y: i64| 100 * x + 10 * y + top >= 0;
        // A box of at most a unit lies in few columns.
        (self.low[0]..=x).any(|x| (self.low[1]..=y).any(|y| self.wraps_at(x, y) && ends_above(x, y)))
    }

    /// Whether the two boxes overlap, and share only columns in which the numbers of one wrap around.
    fn overlooks(&self, other: &Self) -> bool {
        let columns =
            |axis: usize| self.low[axis].max(other.low[axis])..=self.high[axis].min(other.high[axis]);
        let is_found_at = |x, y| self.wraps_at(x, y) == other.wraps_at(x, y);
        !self.aabb.intersection(&other.aabb).is_empty()
            && !columns(0).any(|x| columns(1).any(|y| is_found_at(x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ode::{Ode, Shape};
    use nalgebra::{Isometry3, Point3, Vector3};
    use ode_visual_hull_random::Random;
    use std::collections::BTreeSet;

    fn boxes(random: &mut Random) -> Vec<(Vector3<f64>, Point3<f64>)> {
        let sides = |random: &mut Random| Vector3::from_fn(|_, _| 0.05 + random.unit());
        let place = |random: &mut Random| Point3::from(Vector3::from_fn(|_, _| 2.0 * random.unit() - 0.7));
        (0..12).map(|_| (sides(random), place(random))).collect()
    }

    #[test]
    fn a_world_finds_the_same_pairs_in_a_hash_space_as_in_a_simple_space() {
        let ode = Ode::init().unwrap();
        let mut random = Random(1);
        let mut overlooked = 0;
        for round in 0..2000 {
            let boxes = boxes(&mut random);
            // Also deep below, where other columns are concerned.
            let down = if round % 4 == 0 { -10.0 } else { 0.0 };
            let min_level = [-3, 0, 1][round % 3];
            let pairs = [SpaceKind::Simple, SpaceKind::Hash { min_level, max_level: 10 }].map(|kind| {
                let mut world = World::with_space(&ode, kind).unwrap();
                let root = world.root_space();
                let mut ids = Vec::new();
                for (sides, place) in &boxes {
                    let geom = world.add_geom(root, &Shape::Box { sides: *sides }).unwrap();
                    let pose = Isometry3::translation(place.x, place.y + 0.1 * -down, place.z + down);
                    world.geom_mut(geom).set_pose(&pose).unwrap();
                    ids.push(geom);
                }
                let place = |geom| ids.iter().position(|id| *id == geom).unwrap();
                let mut found = Vec::new();
                let visit = |pair: &crate::ode::Pair<'_>| {
                    let [a, b] = pair.geoms().map(place);
                    found.push([a.min(b), a.max(b)]);
                };
                world.collide(visit).unwrap();
                let set: BTreeSet<_> = found.iter().copied().collect();
                assert_eq!(set.len(), found.len(), "each pair once");
                set
            });
            assert_eq!(pairs[0], pairs[1], "round {round}");

            let aabbs: Vec<Aabb> = boxes
                .iter()
                .map(|(sides, place)| Aabb { min: place - sides / 2.0, max: place + sides / 2.0 })
                .collect();
            overlooked += pairs_among(&aabbs, -3).len();
        }
        assert!(overlooked > 100, "{overlooked}: the case occurs");
    }
}
