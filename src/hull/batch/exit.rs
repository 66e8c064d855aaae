//! Where many points inside leave the hull.

use super::super::points::{LANES, Lane};
use super::fold::{Folded, FoldedBox, Homogeneous, affine, either, linear};
use super::walk::{Lines, walk};

/// Points inside, as many as are asked together, and where each view sees them.
#[derive(Debug, Default)]
pub(super) struct Sightings {
    pub(super) x: Lane,
    pub(super) y: Lane,
    pub(super) z: Lane,
    pub(super) views: Vec<Sighting>,
    /// Points and views whose walks are left to do.
    pending: Vec<(usize, usize)>,
}

/// Where a view sees them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Sighting {
    pub(super) at: Homogeneous,
    pub(super) column: Lane,
    pub(super) row: Lane,
    /// Chebyshev distance to the background.
    pub(super) clear: Lane,
}

impl Sightings {
    /// Takes up to `LANES` points, the last one again and again where there are fewer.
    #[inline(always)]
    pub(super) fn take(&mut self, views: &[Folded], point: impl Fn(usize) -> [f32; 3]) {
        for k in 0..LANES {
            [self.x[k], self.y[k], self.z[k]] = point(k);
        }
        self.views.clear();
        for view in views {
            let at = view.project(&self.x, &self.y, &self.z);
            let (columns, rows) = view.pixels(&at);
            let mut sighting = Sighting { at, ..Sighting::default() };
            let width = view.tables.width as u32;
            let (mut places, mut clear) = ([0; LANES], [0_u32; LANES]);
            for k in 0..LANES {
                places[k] = rows[k] * width + columns[k];
            }
            for k in 0..LANES {
                let pixels = view.tables.distance.get(places[k] as usize).copied().unwrap_or(0);
                clear[k] = u32::from(pixels);
                if pixels == u8::MAX {
                    clear[k] = u32::from(view.exact_distance(columns[k], rows[k]));
                }
            }
            for k in 0..LANES {
                (sighting.column[k], sighting.row[k]) = (columns[k] as f32, rows[k] as f32);
                sighting.clear[k] = clear[k] as f32;
            }
            self.views.push(sighting);
        }
    }
}

/// Metres from each point along its `direction` to the first background in any view, or to the side of the work
/// volume. `first` is for each point the place of the view that is likely to decide. An exit not above
/// `floor` need not be exact: the true one is not above it either.
#[inline(always)]
pub(super) fn exits<'a>(
    views: &[Folded<'a>],
    volume: &FoldedBox,
    points: &mut Sightings,
    direction: &[Lane; 3],
    first: &[usize; LANES],
    used: u32,
    floor: f32,
) -> Lane {
    let mut pending = std::mem::take(&mut points.pending);
    let [x, y, z] = direction;
    let mut exit = wall(volume, points, direction);
    let mut lines = Lines::default();
    let line = |lines: &mut Lines<'a>, slot: usize, k: usize, place: usize| {
        let (view, sighting) = (&views[place], &points.views[place]);
        let along = |row: &[f32; 4]| row[0] * x[k] + row[1] * y[k] + row[2] * z[k];
        lines.start.u[slot] = sighting.at.u[k];
        lines.start.v[slot] = sighting.at.v[k];
        lines.start.depth[slot] = sighting.at.depth[k];
        lines.ahead.u[slot] = along(&view.p[0]);
        lines.ahead.v[slot] = along(&view.p[1]);
        lines.ahead.depth[slot] = along(&view.p[2]);
        (lines.column[slot], lines.row[slot]) = (sighting.column[k], sighting.row[k]);
        (lines.table[slot], lines.width[slot]) = (view.tables.distance, view.tables.width as u32);
    };
    for (k, &place) in first.iter().enumerate() {
        line(&mut lines, k, k, place);
    }
    walk(&lines, &mut exit, used);
    let mut longer = 0;
    for k in 0..LANES {
        longer |= u32::from(exit[k] > floor) << k;
    }
    let used = used & longer;
    pending.clear();
    for (place, (view, sighting)) in views.iter().zip(&points.views).enumerate() {
        let ahead = view.project_directions(x, y, z);
        let mut in_doubt = used & !stays_clear(sighting, &ahead, &exit);
        while in_doubt != 0 {
            let k = in_doubt.trailing_zeros() as usize;
            in_doubt &= in_doubt - 1;
            if first[k] != place {
                pending.push((k, place));
            }
        }
    }
    // What is in doubt are few lines of many views: they walk together.
    for chunk in pending.chunks(LANES) {
        let mut limit = [0.0; LANES];
        for (slot, &(k, place)) in chunk.iter().enumerate() {
            line(&mut lines, slot, k, place);
            limit[slot] = exit[k];
        }
        let walking = u32::MAX >> (LANES - chunk.len());
        walk(&lines, &mut limit, walking);
        for (&(k, _), limit) in chunk.iter().zip(limit) {
            exit[k] = either(limit < exit[k], limit, exit[k]);
        }
    }
    points.pending = pending;
    exit
}

/// Which lines surely stay on subject pixels up to their exits: those whose end lies in the square of subject pixels
/// around their start.
#[inline(always)]
fn stays_clear(sighting: &Sighting, ahead: &Homogeneous, exit: &Lane) -> u32 {
    let mut clear = [0_u32; LANES];
    for k in 0..LANES {
        let depth = sighting.at.depth[k] + exit[k] * ahead.depth[k];
        let per_depth = 1.0 / depth;
        let u = (sighting.at.u[k] + exit[k] * ahead.u[k]) * per_depth;
        let v = (sighting.at.v[k] + exit[k] * ahead.v[k]) * per_depth;
        // From the pixel's middle to the square's side.
        let half = sighting.clear[k] - 0.5;
        let (du, dv) = (u - sighting.column[k] - 0.5, v - sighting.row[k] - 0.5);
        clear[k] = u32::from((depth > 0.0) & (du.abs() <= half) & (dv.abs() <= half));
    }
    let mut bits = 0;
    for (k, clear) in clear.iter().enumerate() {
        bits |= clear << k;
    }
    bits
}

/// Metres to the side of the work volume.
#[inline(always)]
fn wall(volume: &FoldedBox, points: &Sightings, [dx, dy, dz]: &[Lane; 3]) -> Lane {
    let mut exit = [f32::INFINITY; LANES];
    for (row, half) in volume.rows.iter().zip(volume.half) {
        let (at, ahead) = (affine(row, &points.x, &points.y, &points.z), linear(row, dx, dy, dz));
        for k in 0..LANES {
            let t = (half.copysign(ahead[k]) - at[k]) / ahead[k];
            // 0 / 0 is NaN, and not nearer.
            exit[k] = either(t < exit[k], t, exit[k]);
        }
    }
    for exit in &mut exit {
        *exit = either(*exit > 0.0, *exit, 0.0);
    }
    exit
}
