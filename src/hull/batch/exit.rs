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
            for k in 0..LANES {
                (sighting.column[k], sighting.row[k]) = (columns[k] as f32, rows[k] as f32);
                let place = (rows[k] * width + columns[k]) as usize;
                let clear = view.tables.distance.get(place).copied().unwrap_or(0);
                let clear =
                    if clear == u8::MAX { view.exact_distance(columns[k], rows[k]) } else { clear.into() };
                sighting.clear[k] = f32::from(clear);
            }
            self.views.push(sighting);
        }
    }
}

/// Metres from each point along its `direction` to the first background in any view, or to the side of the work
/// volume. `first` is for each point the place of the view that is likely to decide.
#[inline(always)]
pub(super) fn exits(
    views: &[Folded],
    volume: &FoldedBox,
    points: &Sightings,
    direction: &[Lane; 3],
    first: &[usize; LANES],
    used: u32,
) -> Lane {
    let [x, y, z] = direction;
    let mut exit = wall(volume, points, direction);
    let mut lines = Lines::default();
    for k in 0..LANES {
        let (view, sighting) = (&views[first[k]], &points.views[first[k]]);
        let along = |row: &[f32; 4]| row[0] * x[k] + row[1] * y[k] + row[2] * z[k];
        (lines.start.u[k], lines.start.v[k]) = (sighting.at.u[k], sighting.at.v[k]);
        lines.start.depth[k] = sighting.at.depth[k];
        (lines.ahead.u[k], lines.ahead.v[k]) = (along(&view.p[0]), along(&view.p[1]));
        lines.ahead.depth[k] = along(&view.p[2]);
        (lines.column[k], lines.row[k]) = (sighting.column[k], sighting.row[k]);
    }
    walk(&lines, &mut exit, used, |k, column, row| distance(&views[first[k]], column, row));
    for (place, (view, sighting)) in views.iter().zip(&points.views).enumerate() {
        let ahead = view.project_directions(x, y, z);
        let mut in_doubt = used & !stays_clear(sighting, &ahead, &exit);
        for (k, first) in first.iter().enumerate() {
            in_doubt &= !(u32::from(*first == place) << k);
        }
        if in_doubt != 0 {
            let lines = Lines { start: sighting.at, ahead, column: sighting.column, row: sighting.row };
            walk(&lines, &mut exit, in_doubt, |_, column, row| distance(view, column, row));
        }
    }
    exit
}

#[inline(always)]
fn distance(view: &Folded, column: u32, row: u32) -> u8 {
    let tables = &view.tables;
    tables.distance.get(row as usize * tables.width + column as usize).copied().unwrap_or(0)
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
