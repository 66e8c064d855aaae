//! Where many points inside leave the hull: the nearest exit over the views and the work volume.

use super::super::Hull;
use super::super::lanes::{bits, either, ones};
use super::super::points::LANES;
use super::Wide;
use super::sight::{Block, Field, Sighting};
use super::walk::{Line, Paths, Walkers};

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
    walkers: Walkers,
    /// How each view's homogeneous coordinates change along the way.
    ahead: Vec<[Wide; 3]>,
    /// Lines that are left to walk.
    lines: Vec<Line>,
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
        let Self { exit, walkers, ahead, lines } = self;
        ahead.resize(fields.len(), [[0.0; LANES]; 3]);
        for (field, ahead) in fields.iter().zip(ahead.iter_mut()) {
            field.ahead(&way.direction, ahead);
        }
        let paths = Paths { fields, block, way, ahead };
        lines.clear();
        for k in ones(used) {
            lines.push(Line { k, place: way.field[k] });
        }
        walkers.walk(lines, &paths, exit);
        lines.clear();
        for (place, field) in fields.iter().enumerate() {
            let stays = stays_inside(field, &block.sightings[place], &ahead[place], exit);
            for k in ones(used & !stays) {
                if way.field[k] != place {
                    lines.push(Line { k, place });
                }
            }
        }
        walkers.walk(lines, &paths, exit);
    }
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
        stays[k] = u32::from((end_z > 0.0) & near & (reach > 0.0));
    }
    bits(&stays)
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
