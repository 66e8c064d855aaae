//! The views of a hull, folded with a pose: from the points' own frame straight to the tables of a silhouette.
//!
//! The product is formed in double precision and only then rounded, so that the frame may lie anywhere: with points
//! about their middle the error stays below a thousandth of a pixel.

use super::super::points::{LANES, Lane, Points};
use super::super::{Aabb, Hull, View};
use crate::silhouette::{Lookup, Silhouette, Tables};
use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3x4, Matrix4, Translation3};

/// Depths below this, in metres, count as behind the camera.
pub(super) const NEAREST: f32 = 1e-6;

/// Whole numbers are this one's lowest bits once added to it.
const WHOLE: f32 = 8_388_608.0;

/// A view as the points see it.
#[derive(Debug, Clone)]
pub(super) struct Folded<'a> {
    /// Points to `(u depth, v depth, depth)`, with (u, v) from the corner of the silhouette's region.
    pub(super) p: [[f32; 4]; 3],
    /// Metres that a pixel covers at a depth of one metre.
    pub(super) footprint: f32,
    /// By how much the depth changes at most, per metre.
    depth_slope: f32,
    /// By how many pixels columns and rows of the region change at most, per metre at a depth of one metre: the
    /// length of `row - u depth row`, which is largest at one end of the region.
    slope: [f32; 2],
    pub(super) tables: Tables<'a>,
    pub(super) silhouette: &'a Silhouette,
    pub(super) index: usize,
}

/// A box as the points see it: inside where each row's value lies within its half length.
#[derive(Debug, Clone, Copy)]
pub(super) struct FoldedBox {
    pub(super) rows: [[f32; 4]; 3],
    pub(super) half: [f32; 3],
}

/// Homogeneous image coordinates of as many points as are asked together.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Homogeneous {
    pub(super) u: Lane,
    pub(super) v: Lane,
    pub(super) depth: Lane,
}

/// The points' frame with their middle as origin, to the world.
///
/// # Errors
/// A pose that is not finite.
pub(super) fn world_from_middle(
    points: &Points,
    world_from_points: &Isometry3<f64>,
) -> Result<Isometry3<f64>> {
    if !world_from_points.to_homogeneous().iter().all(|x| x.is_finite()) {
        return Err(Error::argument(
            "expected a finite pose, found NaN or infinity in rotation or translation; leave the body out",
        ));
    }
    let (centre, _) = points.bounding_sphere();
    Ok(world_from_points * Translation3::from(centre.coords))
}

impl<'a> Folded<'a> {
    pub(super) fn new(view: &'a View, index: usize, world_from_middle: &Matrix4<f64>) -> Self {
        let tables = view.silhouette().tables();
        let mut p: Matrix3x4<f64> = view.projection() * world_from_middle;
        let depth = p.row(2).clone_owned();
        for (row, corner) in [(0, tables.corner.0), (1, tables.corner.1)] {
            let shifted = p.row(row) - depth * f64::from(corner);
            p.set_row(row, &shifted);
        }
        let slope = |row: usize, end: usize| {
            let at = |u: f64| (p.fixed_view::<1, 3>(row, 0) - p.fixed_view::<1, 3>(2, 0) * u).norm();
            at(0.0).max(at(end as f64)) as f32
        };
        Self {
            p: std::array::from_fn(|r| std::array::from_fn(|c| p[(r, c)] as f32)),
            footprint: view.footprint_at_one_metre() as f32,
            depth_slope: p.fixed_view::<1, 3>(2, 0).norm() as f32,
            slope: [slope(0, tables.width), slope(1, tables.height)],
            tables,
            silhouette: view.silhouette(),
            index,
        }
    }

    /// Where points appear.
    #[inline(always)]
    pub(super) fn project(&self, x: &Lane, y: &Lane, z: &Lane) -> Homogeneous {
        Homogeneous {
            u: affine(&self.p[0], x, y, z),
            v: affine(&self.p[1], x, y, z),
            depth: affine(&self.p[2], x, y, z),
        }
    }

    /// How the homogeneous coordinates change along directions.
    #[inline(always)]
    pub(super) fn project_directions(&self, x: &Lane, y: &Lane, z: &Lane) -> Homogeneous {
        Homogeneous {
            u: linear(&self.p[0], x, y, z),
            v: linear(&self.p[1], x, y, z),
            depth: linear(&self.p[2], x, y, z),
        }
    }

    /// Column and row of the region, kept within it: its rim is background. Points behind the camera come to the rim.
    #[inline(always)]
    pub(super) fn pixels(&self, h: &Homogeneous) -> ([u32; LANES], [u32; LANES]) {
        let (right, below) = (self.tables.width as f32 - 0.5, self.tables.height as f32 - 0.5);
        let (mut columns, mut rows) = ([0; LANES], [0; LANES]);
        for k in 0..LANES {
            let per_depth = either(h.depth[k] > NEAREST, 1.0 / h.depth[k], 0.0);
            columns[k] = whole(h.u[k] * per_depth, right);
            rows[k] = whole(h.v[k] * per_depth, below);
        }
        (columns, rows)
    }

    /// The distance at a pixel of the region, where a byte does not hold it.
    #[cold]
    pub(super) fn exact_distance(&self, column: u32, row: u32) -> u16 {
        let (x, y) = self.tables.corner;
        self.silhouette.distance(x + column as i32, y + row as i32)
    }

    /// Whether anything that lies within `radius` of a point may appear in the silhouette; `near` more pixels count.
    #[inline(always)]
    pub(super) fn may_touch(&self, tiles: &Lookup, [x, y, z]: [f32; 3], radius: f32, near: f32) -> bool {
        let at = |row: &[f32; 4]| row[0] * x + row[1] * y + row[2] * z + row[3];
        let depth = at(&self.p[2]);
        let nearest = depth - radius * self.depth_slope;
        let (per_depth, most) = (1.0 / depth, radius * 1.001 / nearest);
        // A hundredth of a pixel and some for rounding.
        let span = |axis: usize, pixels: usize| {
            let (middle, reach) = (at(&self.p[axis]) * per_depth, self.slope[axis] * most + near + 0.02);
            let last = pixels as f32 - 0.5;
            (whole(middle - reach, last), whole(middle + reach, last) + 1)
        };
        let ((x0, x1), (y0, y1)) = (span(0, self.tables.width), span(1, self.tables.height));
        nearest.is_nan() | (nearest <= NEAREST) | tiles.any([x0, y0], [x1, y1])
    }
}

impl FoldedBox {
    pub(super) fn new(aabb: &Aabb, world_from_middle: &Matrix4<f64>) -> Self {
        let (centre, half) = (aabb.centre(), (aabb.max - aabb.min) * 0.5);
        let row = |r: usize| {
            let shift = [0.0, 0.0, 0.0, centre[r]];
            std::array::from_fn(|c| (world_from_middle[(r, c)] - shift[c]) as f32)
        };
        Self { rows: [row(0), row(1), row(2)], half: half.cast::<f32>().into() }
    }

    /// Which points lie in it, a bit each.
    #[inline(always)]
    pub(super) fn contains(&self, x: &Lane, y: &Lane, z: &Lane) -> u32 {
        let mut inside = u32::MAX;
        for (row, half) in self.rows.iter().zip(self.half) {
            let offset = affine(row, x, y, z);
            let mut bits = 0;
            for (k, offset) in offset.iter().enumerate() {
                bits |= u32::from(offset.abs() <= half) << k;
            }
            inside &= bits;
        }
        inside
    }
}

/// The hull's enabled views and its work volume, folded with a pose.
pub(super) fn fold<'a>(
    hull: &'a Hull,
    world_from_middle: &Isometry3<f64>,
) -> (impl Iterator<Item = Folded<'a>>, FoldedBox) {
    let matrix = world_from_middle.to_homogeneous();
    let enabled = hull.views().iter().enumerate().filter(|(_, view)| view.is_enabled());
    (
        enabled.map(move |(index, view)| Folded::new(view, index, &matrix)),
        FoldedBox::new(hull.bounds(), &matrix),
    )
}

/// Both are computed, and one is taken: no branch for the compiler to stumble over.
#[inline(always)]
pub(super) fn either(condition: bool, yes: f32, no: f32) -> f32 {
    if condition { yes } else { no }
}

/// The whole number below `x`, which is brought between one half and `most`; NaN becomes the lower bound.
#[inline(always)]
pub(super) fn whole(x: f32, most: f32) -> u32 {
    let x = either(x > 0.5, x, 0.5);
    let x = either(x < most, x, most);
    // Half is taken off since the sum rounds to the nearest.
    bits_of(x - 0.5)
}

/// The whole number nearest to `x`, which is not negative and below 2^23.
#[inline(always)]
pub(super) fn bits_of(x: f32) -> u32 {
    (x + WHOLE).to_bits() & 0x007f_ffff
}

#[inline(always)]
pub(super) fn affine(row: &[f32; 4], x: &Lane, y: &Lane, z: &Lane) -> Lane {
    let mut sum = [0.0; LANES];
    for k in 0..sum.len() {
        sum[k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k] + row[3];
    }
    sum
}

#[inline(always)]
pub(super) fn linear(row: &[f32; 4], x: &Lane, y: &Lane, z: &Lane) -> Lane {
    let mut sum = [0.0; LANES];
    for k in 0..sum.len() {
        sum[k] = row[0] * x[k] + row[1] * y[k] + row[2] * z[k];
    }
    sum
}
