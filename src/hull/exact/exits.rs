//! Where many points inside leave the hull: the nearest exit over the views and the work volume.

use super::super::Hull;
use super::super::image_line::ImageLine;
use super::super::march::March;
use super::super::points::LANES;
use super::sight::{Block, Field, Sighting};
use super::walk::Lines;
use super::{Wide, bits, either, gathered};
use nalgebra::Vector3;

/// Where to: a unit direction for each point, and the view that is asked first, by its place among the fields.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Way {
    pub(super) direction: [Wide; 3],
    pub(super) field: [usize; LANES],
}

/// The exits of a block of points, and what is kept while they are searched.
#[derive(Debug, Default)]
pub(super) struct Exits {
    /// Metres from each point to its exit.
    pub(super) exit: Wide,
    lines: Lines,
    /// How each view's homogeneous coordinates change along the way.
    ahead: Vec<[Wide; 3]>,
    /// Points and fields whose walks are left to do.
    pending: Vec<(usize, usize)>,
}

impl Exits {
    /// Finds the exits of the points `used`, at most `most`.
    ///
    /// The first view walks first; of the others only those that may leave sooner.
    #[inline(always)]
    pub(super) fn find(
        &mut self,
        hull: &Hull,
        fields: &[Field],
        block: &Block,
        way: &Way,
        most: f64,
        used: u32,
    ) {
        self.exit = wall(hull, block, &way.direction, most);
        self.ahead.clear();
        self.ahead.extend(fields.iter().map(|field| field.ahead(&way.direction)));
        self.pending.clear();
        self.pending.extend(bits(used).map(|k| (k, way.field[k])));
        self.walk(fields, block, way);
        self.pending.clear();
        for place in 0..fields.len() {
            let stays = stays_inside(&fields[place], &block.sightings[place], &self.ahead[place], &self.exit);
            self.pending.extend(bits(used & !stays).filter(|&k| way.field[k] != place).map(|k| (k, place)));
        }
        self.walk(fields, block, way);
    }

    /// Does the walks that are pending.
    #[inline(always)]
    fn walk(&mut self, fields: &[Field], block: &Block, way: &Way) {
        for chunk in self.pending.chunks(LANES) {
            let (mut limit, mut walking) = ([0.0; LANES], 0);
            for (slot, &(k, place)) in chunk.iter().enumerate() {
                self.lines.set(slot, k, place, fields, block, &self.ahead[place]);
                limit[slot] = self.exit[k];
                walking |= u32::from(block.sightings[place].clear[k] > 0.0) << slot;
            }
            let in_background = !walking & u32::MAX >> (LANES - chunk.len());
            let left = self.lines.walk(fields, &mut limit, walking);
            for slot in bits(left) {
                limit[slot] = walk_on(&self.lines, slot, fields, limit[slot]);
            }
            for slot in bits(in_background) {
                let (k, place) = chunk[slot];
                limit[slot] = walk_from_background(fields, block, way, k, place, limit[slot]);
            }
            for (&(k, _), limit) in chunk.iter().zip(limit) {
                self.exit[k] = either(limit < self.exit[k], limit, self.exit[k]);
            }
        }
    }
}

/// Walks a line on from where it stands.
fn walk_on(lines: &Lines, slot: usize, fields: &[Field], limit: f64) -> f64 {
    let field = &fields[lines.field[slot]];
    let vector = |of: &[Wide; 3]| Vector3::new(of[0][slot], of[1][slot], of[2][slot]);
    let line = ImageLine::new(vector(&lines.start), vector(&lines.ahead));
    let (cell, t) = ((lines.column[slot] as i32, lines.row[slot] as i32), lines.t[slot]);
    March::from_cell(field.view, line, cell, t, field.edge).exit_by(t, limit)
}

/// Walks from a pixel that is background, though the point is inside by coverage.
fn walk_from_background(
    fields: &[Field],
    block: &Block,
    way: &Way,
    k: usize,
    place: usize,
    limit: f64,
) -> f64 {
    let field = &fields[place];
    let direction = Vector3::new(way.direction[0][k], way.direction[1][k], way.direction[2][k]);
    March::new(field.view, &block.point(k), &direction, field.edge).exit_by(0.0, limit)
}

/// Which views surely see subject up to the exits: those ends lie in the square of subject pixels around the start,
/// and so does all between, since a line's image is straight.
#[inline(always)]
fn stays_inside(field: &Field, sighting: &Sighting, ahead: &[Wide; 3], exit: &Wide) -> u32 {
    // Beyond the pixels' centres there may be an edge by coverage; the rest is far more than rounding.
    let rim = if field.by_coverage { 1.0 + 1e-6 } else { 0.5 + 1e-6 };
    let (mut stays, [x, y, z]) = ([0; LANES], &sighting.at);
    for k in 0..LANES {
        let reach = sighting.clear[k] - rim;
        let (end_x, end_y, end_z) =
            (x[k] + ahead[0][k] * exit[k], y[k] + ahead[1][k] * exit[k], z[k] + ahead[2][k] * exit[k]);
        let (du, dv) = (end_x - (sighting.column[k] + 0.5) * end_z, end_y - (sighting.row[k] + 0.5) * end_z);
        // Both sides times the depth.
        let near = (du.abs() < reach * end_z) & (dv.abs() < reach * end_z);
        stays[k] = u64::from((end_z > 0.0) & near & (reach > 0.0));
    }
    gathered(&stays)
}

/// Metres to the side of the work volume, at most `most`.
#[inline(always)]
fn wall(hull: &Hull, block: &Block, direction: &[Wide; 3], most: f64) -> Wide {
    let (bounds, mut exit) = (hull.bounds(), [most; LANES]);
    for axis in 0..3 {
        let (min, max) = (bounds.min[axis], bounds.max[axis]);
        for k in 0..LANES {
            let (at, ahead) = (block.point[axis][k], direction[axis][k]);
            let t = (either(ahead > 0.0, max, min) - at) / ahead;
            exit[k] = either((ahead != 0.0) & (t < exit[k]), t, exit[k]);
        }
    }
    exit
}
