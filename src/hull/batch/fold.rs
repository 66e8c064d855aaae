//! The views of a hull, folded with a pose: from the points' own frame straight to the tables of a silhouette.
//!
//! ```text
//!   pixel of the region  <-  P  -  volume  <-  pose  -  points about their middle
//!                            once a call       once a body
//! ```
//!
//! The volume's frame has the world's axes and its origin in the middle of the work volume. Products are formed in
//! double precision and only then rounded, so that world and body may lie anywhere: with points about their middle
//! the error stays below a thousandth of a pixel.

use super::super::lanes::{bits, whole};
use super::super::points::{Block, LANES, Lane, Points};
use super::super::{Hull, View};
use super::inside::Within;
use super::lookup::{Bits, Distances};
use crate::silhouette::{Lookup, Silhouette, Tables};
use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3x4, Matrix4, Point3, Translation3, Vector3};

/// Depths below this, in metres, count as behind the camera.
pub(super) const NEAREST: f32 = 1e-6;

/// A view as points of some frame see it.
#[derive(Debug, Clone)]
pub(super) struct Folded<'a> {
    /// Points to `(u depth, v depth, depth)`, with (u, v) from the corner of the silhouette's region.
    pub(super) p: [[f32; 4]; 3],
    exact: Matrix3x4<f64>,
    /// Pixels that a metre covers at a depth of one metre.
    pub(super) pixels_per_metre: f32,
    /// By how much the depth changes at most, per metre.
    depth_slope: f32,
    /// By how many pixels columns and rows of the region change at most, per metre at a depth of one metre: the
    /// length of `row - u depth row`, which is largest at one end of the region.
    slope: [f32; 2],
    pub(super) tables: Tables<'a>,
    pub(super) silhouette: &'a Silhouette,
    pub(super) index: usize,
}

/// The work volume, about its middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Volume {
    pub(super) centre: Point3<f64>,
    pub(super) half: [f32; 3],
}

/// Points about their middle to the volume's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Posed {
    pub(super) rows: [[f32; 4]; 3],
    exact: Matrix4<f64>,
    /// The radius of the sphere around the points.
    pub(super) radius: f32,
}

/// What becomes of homogeneous image coordinates, for as many points as are asked together.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Homogeneous {
    pub(super) u: Lane,
    pub(super) v: Lane,
    pub(super) depth: Lane,
}

impl Volume {
    pub(super) fn of(hull: &Hull) -> Self {
        let bounds = hull.bounds();
        Self { centre: bounds.centre(), half: ((bounds.max - bounds.min) * 0.5).cast::<f32>().into() }
    }

    /// A place of the volume's frame in the world.
    pub(super) fn in_world(&self, at: [f32; 3]) -> Point3<f64> {
        self.centre + Vector3::from(at).cast::<f64>()
    }

    /// Whether it surely holds all points of a body.
    pub(super) fn holds(&self, posed: &Posed) -> bool {
        // A millimetre is more than rounding, and less than any margin that a work volume needs.
        posed.middle().iter().zip(self.half).all(|(at, half)| at.abs() <= half - posed.radius - 1e-3)
    }

    /// Which points lie in it, a bit each.
    #[inline(always)]
    pub(super) fn contains(&self, posed: &Posed, points: &Block) -> u32 {
        let mut inside = u32::MAX;
        for (row, half) in posed.rows.iter().zip(self.half) {
            let (offset, mut within) = (affine(row, points), [0; LANES]);
            for k in 0..LANES {
                within[k] = u32::from(offset[k].abs() <= half);
            }
            inside &= bits(&within);
        }
        inside
    }
}

impl Posed {
    /// # Errors
    /// A pose that is not finite.
    pub(super) fn new(points: &Points, world_from_points: &Isometry3<f64>, volume: &Volume) -> Result<Self> {
        let (middle, radius) = points.bounding_sphere();
        let world_from_middle = world_from_points * Translation3::from(middle.coords);
        let volume_from_middle = Translation3::from(-volume.centre.coords) * world_from_middle;
        let exact = volume_from_middle.to_homogeneous();
        if !exact.iter().all(|x| x.is_finite()) {
            return Err(Error::argument(
                "expected a finite pose, found NaN or infinity in rotation or translation; leave the body out",
            ));
        }
        let rows = std::array::from_fn(|r| std::array::from_fn(|c| exact[(r, c)] as f32));
        // A little more for what rounding moves.
        Ok(Self { rows, exact, radius: radius as f32 * (1.0 + 1e-6) })
    }

    /// The points' middle in the volume's frame.
    pub(super) fn middle(&self) -> [f32; 3] {
        self.rows.map(|row| row[3])
    }

    #[inline(always)]
    pub(super) fn place(&self, [x, y, z]: [f32; 3]) -> [f32; 3] {
        self.rows.map(|row| row[0] * x + row[1] * y + row[2] * z + row[3])
    }
}

impl<'a> Folded<'a> {
    /// The view as points of the volume's frame see it.
    pub(super) fn new(view: &'a View, index: usize, volume: &Volume) -> Self {
        let tables = view.silhouette().tables();
        let world_from_volume = Translation3::from(volume.centre.coords).to_homogeneous();
        let mut p: Matrix3x4<f64> = view.projection() * world_from_volume;
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
            p: rounded(&p),
            exact: p,
            pixels_per_metre: (1.0 / view.footprint_at_one_metre()) as f32,
            depth_slope: p.fixed_view::<1, 3>(2, 0).norm() as f32,
            slope: [slope(0, tables.width), slope(1, tables.height)],
            tables,
            silhouette: view.silhouette(),
            index,
        }
    }

    /// The view as points in a pose see it; slopes are the same however they are turned.
    pub(super) fn seen_from(&self, posed: &Posed) -> Self {
        let exact = self.exact * posed.exact;
        Self { p: rounded(&exact), exact, ..self.clone() }
    }

    /// Where points appear.
    #[inline(always)]
    pub(super) fn project(&self, points: &Block) -> Homogeneous {
        let [u, v, depth] = &self.p;
        Homogeneous { u: affine(u, points), v: affine(v, points), depth: affine(depth, points) }
    }

    /// By how much that changes along directions, per metre.
    #[inline(always)]
    pub(super) fn changes(&self, directions: &Block) -> Homogeneous {
        let [u, v, depth] = &self.p;
        Homogeneous { u: linear(u, directions), v: linear(v, directions), depth: linear(depth, directions) }
    }

    /// The middle of the region's last pixel: where positions in the region end.
    #[inline(always)]
    pub(super) fn last_pixel(&self) -> [f32; 2] {
        [self.tables.width as f32 - 0.5, self.tables.height as f32 - 0.5]
    }

    /// The bits of what is within the silhouette.
    #[inline(always)]
    pub(super) fn bits(&self, within: Within) -> Bits<'a> {
        let words = if within == Within::Subject { self.tables.subject } else { self.tables.near };
        Bits::new(words, self.tables.words)
    }

    /// The table of distances.
    #[inline(always)]
    pub(super) fn distances(&self) -> Distances<'a> {
        Distances::new(self.tables.distance_words, self.tables.width)
    }

    /// The distance at a pixel of the region, where a byte does not hold it.
    #[cold]
    pub(super) fn exact_distance(&self, column: u32, row: u32) -> u16 {
        let (x, y) = self.tables.corner;
        self.silhouette.distance(x + column as i32, y + row as i32)
    }

    /// Whether anything that lies within `radius` of a point may appear in the silhouette, and whether all of it surely
    /// does; `near` more pixels count.
    #[inline(always)]
    pub(super) fn sphere(
        &self,
        (tiles, distances): (&Lookup, &Distances),
        [x, y, z]: [f32; 3],
        radius: f32,
        near: f32,
    ) -> (bool, bool) {
        let at = |row: &[f32; 4]| row[0].mul_add(x, row[1].mul_add(y, row[2].mul_add(z, row[3])));
        let depth = at(&self.p[2]);
        let nearest = depth - radius * self.depth_slope;
        let (per_depth, most) = (1.0 / depth, radius * 1.001 / nearest);
        let (u, v) = (at(&self.p[0]) * per_depth, at(&self.p[1]) * per_depth);
        // A hundredth of a pixel and some for rounding.
        let reach = |axis: usize| self.slope[axis] * most + near + 0.02;
        let [right, below] = self.last_pixel();
        let from = [whole(u - reach(0), right), whole(v - reach(1), below)];
        let to = [whole(u + reach(0), right) + 1, whole(v + reach(1), below) + 1];
        let is_ahead = nearest > NEAREST;
        let touches = !is_ahead | tiles.any(from, to);
        // Background lies as many pixels away as the distance says, or farther.
        let clear = distances.at(whole(u, right), whole(v, below)) as f32 - 1.0;
        (touches, is_ahead & (reach(0) <= clear) & (reach(1) <= clear))
    }
}

fn rounded(p: &Matrix3x4<f64>) -> [[f32; 4]; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| p[(r, c)] as f32))
}

#[inline(always)]
fn affine(row: &[f32; 4], points: &Block) -> Lane {
    let mut sum = [0.0; LANES];
    for k in 0..LANES {
        sum[k] =
            row[0].mul_add(points.x[k], row[1].mul_add(points.y[k], row[2].mul_add(points.z[k], row[3])));
    }
    sum
}

#[inline(always)]
fn linear(row: &[f32; 4], directions: &Block) -> Lane {
    let mut sum = [0.0; LANES];
    for k in 0..LANES {
        sum[k] = row[0].mul_add(directions.x[k], row[1].mul_add(directions.y[k], row[2] * directions.z[k]));
    }
    sum
}
