//! The views of a hull as the points of a body see them: from the points' own frame straight to a silhouette's tables.
//!
//! ```text
//!   pixel of the region  <-  P  -  volume  <-  pose  -  points about their middle
//!                            once a call       once a body
//! ```
//!
//! The volume's frame has the world's axes and its origin in the middle of the work volume. Products are formed in
//! double precision and only then rounded, so that world and body may lie anywhere: with points about their middle
//! the error stays below a thousandth of a pixel.

use crate::hull::{Hull, View};
use crate::math::lanes::{floor_clamped, lane_mask, select};
use crate::math::point_cloud::{Block, LANES, Points};
use crate::silhouette::{Bits, Distances, OccupancyLookup, TableSlices};
use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3x4, Matrix4, Point3, Translation3, Vector3};

/// What counts as subject.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MaskDilation {
    /// A subject pixel.
    None,
    /// A subject pixel or one beside it: nothing that any edge model calls inside is missed.
    OnePixel,
}

impl MaskDilation {
    /// By how many pixels.
    pub(super) fn pixels(self) -> f32 {
        f32::from(u8::from(self == Self::OnePixel))
    }
}

/// Depths below this, in metres, count as behind the camera.
pub(super) const NEAREST: f32 = 1e-6;

/// More than rounding moves a position in an image, in pixels.
const ROUNDING_PX: f32 = 0.02;

/// A view as points of some frame see it.
#[derive(Debug, Clone)]
pub(super) struct BodyView<'a> {
    /// Points to `(u depth, v depth, depth)`, with (u, v) from the corner of the silhouette's region.
    pub(super) p: [[f32; 4]; 3],
    projection: Matrix3x4<f64>,
    /// By how much the depth changes at most, per metre.
    depth_slope: f32,
    /// By how many pixels columns and rows of the region change at most, per metre at a depth of one metre: the
    /// length of `row - u depth row`, which is largest at one end of the region.
    slope: [f32; 2],
    pub(super) tables: TableSlices<'a>,
    /// `None` where what the view does not see is outside, as its mask's background says.
    pub(super) field_of_view: Option<FieldOfView<'a>>,
}

/// What a view sees, where a point that it does not see may be inside or lies beyond no silhouette edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct FieldOfView<'a> {
    /// The image from the region's corner: first column and row, and those behind the last ones.
    low: [f32; 2],
    high: [f32; 2],
    view: &'a View,
}

/// The work volume, about its middle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Volume {
    centre: Point3<f64>,
    half: [f32; 3],
}

/// Points about their middle to the volume's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyPlacement {
    rows: [[f32; 4]; 3],
    exact: Matrix4<f64>,
    /// The radius of the sphere around the points.
    pub(super) radius: f32,
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
    pub(super) fn holds(&self, placement: &BodyPlacement) -> bool {
        // A millimetre is more than rounding, and less than any margin that a work volume needs.
        let middle = placement.middle();
        middle.iter().zip(self.half).all(|(at, half)| at.abs() <= half - placement.radius - 1e-3)
    }

    /// Which points lie in it, a bit each.
    #[inline(always)]
    pub(super) fn contains(&self, placement: &BodyPlacement, points: &Block) -> u32 {
        let mut inside = u32::MAX;
        for (row, half) in placement.rows.iter().zip(self.half) {
            let mut within = [0; LANES];
            for k in 0..LANES {
                within[k] = u32::from(affine(row, points, k).abs() <= half);
            }
            inside &= lane_mask(&within);
        }
        inside
    }
}

impl BodyPlacement {
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
}

impl<'a> BodyView<'a> {
    /// The view as points of the volume's frame see it.
    pub(super) fn new(hull: &Hull, view: &'a View, volume: &Volume) -> Self {
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
            projection: p,
            depth_slope: p.fixed_view::<1, 3>(2, 0).norm() as f32,
            slope: [slope(0, tables.width), slope(1, tables.height)],
            tables,
            field_of_view: (!hull.is_closed(view)).then(|| FieldOfView::new(view, tables.corner)),
        }
    }

    /// The view as points in a pose see it; slopes are the same however they are turned.
    pub(super) fn seen_from(&self, placement: &BodyPlacement) -> Self {
        let exact = self.projection * placement.exact;
        Self { p: rounded(&exact), projection: exact, ..self.clone() }
    }

    /// Where point k of a block appears, from the corner of the region, and its depth; at the corner where it is behind
    /// the camera.
    #[inline(always)]
    pub(super) fn project(&self, points: &Block, k: usize) -> [f32; 3] {
        let [u, v, depth] = &self.p;
        let (u, v, depth) = (affine(u, points, k), affine(v, points, k), affine(depth, points, k));
        let per_depth = select(depth > NEAREST, 1.0 / depth, 0.0);
        [u * per_depth, v * per_depth, depth]
    }

    /// The middle of the region's last pixel: where positions in the region end.
    #[inline(always)]
    pub(super) fn last_pixel(&self) -> [f32; 2] {
        [self.tables.width as f32 - 0.5, self.tables.height as f32 - 0.5]
    }

    /// The bits of the silhouette, dilated.
    #[inline(always)]
    pub(super) fn mask_bits(&self, dilation: MaskDilation) -> Bits<'a> {
        let words = if dilation == MaskDilation::None { self.tables.subject } else { self.tables.dilated };
        Bits::new(words, self.tables.words)
    }

    /// The table of distances.
    #[inline(always)]
    pub(super) fn distances(&self) -> Distances<'a> {
        Distances::new(self.tables.distance_words, self.tables.width)
    }

    /// Whether anything that lies within `radius` of a point may appear in the silhouette, dilated by so many pixels, and
    /// whether all of it surely does.
    #[inline(always)]
    pub(super) fn sphere(
        &self,
        (tiles, distances): (&OccupancyLookup, &Distances),
        [x, y, z]: [f32; 3],
        radius: f32,
        dilation_px: f32,
    ) -> (bool, bool) {
        let at = |row: &[f32; 4]| row[0].mul_add(x, row[1].mul_add(y, row[2].mul_add(z, row[3])));
        let depth = at(&self.p[2]);
        let nearest = depth - radius * self.depth_slope;
        let (per_depth, most) = (1.0 / depth, radius * 1.001 / nearest);
        let (u, v) = (at(&self.p[0]) * per_depth, at(&self.p[1]) * per_depth);
        // A hundredth of a pixel and some for rounding.
        let reach = |axis: usize| self.slope[axis] * most + dilation_px + ROUNDING_PX;
        let [right, below] = self.last_pixel();
        let from = [floor_clamped(u - reach(0), right), floor_clamped(v - reach(1), below)];
        let to = [floor_clamped(u + reach(0), right) + 1, floor_clamped(v + reach(1), below) + 1];
        let is_ahead = nearest > NEAREST;
        let touches = !is_ahead | tiles.any_occupied(from, to);
        // Background lies as many pixels away as the distance says, or farther.
        let clear = distances.at(floor_clamped(u, right), floor_clamped(v, below)) as f32 - 1.0;
        (touches, is_ahead & (reach(0) <= clear) & (reach(1) <= clear))
    }

    /// Whether the image surely holds all that lies within `radius` of a point, by a view that may not see it.
    #[inline(always)]
    pub(super) fn sees_sphere(&self, sight: &FieldOfView, [x, y, z]: [f32; 3], radius: f32) -> bool {
        let at = |row: &[f32; 4]| row[0].mul_add(x, row[1].mul_add(y, row[2].mul_add(z, row[3])));
        let depth = at(&self.p[2]);
        let nearest = depth - radius * self.depth_slope;
        let (per_depth, most) = (1.0 / depth, radius * 1.001 / nearest);
        let reach = [self.slope[0] * most + ROUNDING_PX, self.slope[1] * most + ROUNDING_PX];
        (nearest > NEAREST) & sight.holds([at(&self.p[0]) * per_depth, at(&self.p[1]) * per_depth], reach)
    }
}

impl<'a> FieldOfView<'a> {
    fn new(view: &'a View, corner: (i32, i32)) -> Self {
        let image = view.silhouette().image();
        Self {
            low: [(image.x0 - corner.0) as f32, (image.y0 - corner.1) as f32],
            high: [(image.x1 - corner.0) as f32, (image.y1 - corner.1) as f32],
            view,
        }
    }

    /// Whether the image holds all that lies within `reach` pixels of a position.
    #[inline(always)]
    fn holds(&self, at: [f32; 2], reach: [f32; 2]) -> bool {
        let along = |axis: usize| {
            (at[axis] - reach[axis] >= self.low[axis]) & (at[axis] + reach[axis] < self.high[axis])
        };
        along(0) & along(1)
    }

    /// Which points of a block the view surely sees, and which it may see, from positions and depths.
    ///
    /// Without dilation both are the same: what single precision makes of them.
    #[inline(always)]
    pub(super) fn visible(&self, at: &[[f32; 3]; LANES], dilation: MaskDilation) -> (u32, u32) {
        let slack = if dilation == MaskDilation::None { 0.0 } else { ROUNDING_PX };
        let (mut surely, mut maybe) = ([0; LANES], [0; LANES]);
        for k in 0..LANES {
            let ([u, v, depth], is_ahead) = (at[k], at[k][2] > NEAREST);
            surely[k] = u32::from((depth > NEAREST + slack) & self.holds([u, v], [slack; 2]));
            maybe[k] = u32::from(is_ahead & self.holds([u, v], [-slack; 2]));
        }
        (lane_mask(&surely), lane_mask(&maybe))
    }

    pub(super) fn has_blind_spots(&self) -> bool {
        self.view.blind_spots().is_some()
    }

    /// Whether the lens saw the pixel at a position from the region's corner.
    pub(super) fn lens_sees(&self, [u, v, _]: [f32; 3]) -> bool {
        let pixel = |at: f32, low: f32| (at - low).floor() as i32;
        self.view
            .blind_spots()
            .is_none_or(|seen| seen.is_subject(pixel(u, self.low[0]), pixel(v, self.low[1])))
    }
}

fn rounded(p: &Matrix3x4<f64>) -> [[f32; 4]; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| p[(r, c)] as f32))
}

#[inline(always)]
fn affine(row: &[f32; 4], points: &Block, k: usize) -> f32 {
    row[0].mul_add(points.x[k], row[1].mul_add(points.y[k], row[2].mul_add(points.z[k], row[3])))
}
