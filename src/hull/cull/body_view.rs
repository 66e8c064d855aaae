//! The views of a hull as seen from a body's frame: one matrix maps the body's points to indices of a silhouette's
//! tables.
//!
//! ```text
//!   pixel of the crop  <-  P  -  volume  <-  pose  -  points relative to their middle
//!                          once a call       once a body
//! ```
//!
//! The volume's frame has the world's axes, and its origin in the middle of the work volume. Matrices are multiplied in
//! double precision and only then rounded. World and body may therefore lie anywhere: since points are relative to
//! their middle, the error stays below a thousandth of a pixel.

use crate::hull::{Hull, View};
use crate::math::lanes::{floor_clamped, lane_mask, select};
use crate::math::point_cloud::{Block, LANES, Points};
use crate::silhouette::{Bits, Distances, OccupancyLookup, TableSlices};
use crate::{Error, Result};
use nalgebra::{Isometry3, Matrix3x4, Matrix4, Point3, Translation3, Vector3};

/// Which pixels count as subject.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MaskDilation {
    /// The subject pixels of the mask.
    None,
    /// The subject pixels and those beside them, which hold every point that is inside by either edge model.
    OnePixel,
}

impl MaskDilation {
    /// The radius of the dilation, in pixels.
    pub(super) fn pixels(self) -> f32 {
        f32::from(u8::from(self == Self::OnePixel))
    }
}

/// A point at a lower depth, in metres, counts as behind the camera.
pub(super) const NEAREST: f32 = 1e-6;

/// More than rounding changes a position in an image, in pixels.
const ROUNDING_PX: f32 = 0.02;

/// A view as seen from the frame of some points: the volume's frame, or that of a body's points.
#[derive(Debug, Clone)]
pub(super) struct BodyView<'a> {
    /// Maps points to `(u depth, v depth, depth)`, with (u, v) in pixels from the corner of the silhouette's crop.
    pub(super) p: [[f32; 4]; 3],
    projection: Matrix3x4<f64>,
    /// The largest change of depth per metre.
    depth_slope: f32,
    /// The largest change of column and row per metre, in pixels, at a depth of one metre: the length of the matrix row
    /// minus u times the depth's row, which is largest at one end of the crop.
    slope: [f32; 2],
    pub(super) tables: TableSlices<'a>,
    /// `None` if every point that the view does not see is outside, so that it can be treated as background.
    pub(super) field_of_view: Option<FieldOfView<'a>>,
}

/// The image of a view that may abstain, or whose silhouette has an open border.
#[derive(Debug, Clone, Copy)]
pub(super) struct FieldOfView<'a> {
    /// First column and row of the image, in pixels from the crop's corner.
    low: [f32; 2],
    /// One past the last column and row of the image, in pixels from the crop's corner.
    high: [f32; 2],
    view: &'a View,
}

/// The work volume: its middle, and half its extent along each axis, in metres.
#[derive(Debug, Clone, Copy)]
pub(super) struct Volume {
    centre: Point3<f64>,
    half: [f32; 3],
}

/// The transform of a body's points, relative to their middle, to the volume's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct BodyPlacement {
    rows: [[f32; 4]; 3],
    matrix: Matrix4<f64>,
    /// The radius of the sphere around the points, in metres.
    pub(super) radius: f32,
}

impl Volume {
    pub(super) fn of(hull: &Hull) -> Self {
        let bounds = hull.bounds();
        Self { centre: bounds.centre(), half: ((bounds.max - bounds.min) * 0.5).cast::<f32>().into() }
    }

    /// A point of the volume's frame, in the world.
    pub(super) fn in_world(&self, at: [f32; 3]) -> Point3<f64> {
        self.centre + Vector3::from(at).cast::<f64>()
    }

    /// Whether the volume surely holds all points of a body.
    pub(super) fn holds(&self, placement: &BodyPlacement) -> bool {
        // A millimetre is far more than rounding.
        let middle = placement.middle();
        middle.iter().zip(self.half).all(|(at, half)| at.abs() <= half - placement.radius - 1e-3)
    }

    /// A bit mask of the points that lie in the volume.
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
        let matrix = volume_from_middle.to_homogeneous();
        if !matrix.iter().all(|x| x.is_finite()) {
            return Err(Error::argument(
                "expected a finite pose, found NaN or infinity in rotation or translation; leave the body out",
            ));
        }
        let rows = std::array::from_fn(|r| std::array::from_fn(|c| matrix[(r, c)] as f32));
        // The radius is rounded up, since rounding moves the points.
        Ok(Self { rows, matrix, radius: radius as f32 * (1.0 + 1e-6) })
    }

    /// The middle of the points, in the volume's frame.
    pub(super) fn middle(&self) -> [f32; 3] {
        self.rows.map(|row| row[3])
    }
}

impl<'a> BodyView<'a> {
    /// The view as seen from the volume's frame.
    pub(super) fn new(hull: &Hull, view: &'a View, volume: &Volume) -> Self {
        let tables = view.silhouette().tables();
        let world_from_volume = Translation3::from(volume.centre.coords).to_homogeneous();
        let mut p: Matrix3x4<f64> = view.projection() * world_from_volume;

        // Columns and rows count from the corner of the crop.
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

    /// The view as seen from the frame of a body's points. Slopes do not depend on the body's pose.
    pub(super) fn seen_from(&self, placement: &BodyPlacement) -> Self {
        let matrix = self.projection * placement.matrix;
        Self { p: rounded(&matrix), projection: matrix, ..self.clone() }
    }

    /// The image position of point k of a block, in pixels from the corner of the crop, and its depth. A point behind
    /// the camera is placed at the corner.
    #[inline(always)]
    pub(super) fn project(&self, points: &Block, k: usize) -> [f32; 3] {
        let [u, v, depth] = &self.p;
        let (u, v, depth) = (affine(u, points, k), affine(v, points, k), affine(depth, points, k));
        let per_depth = select(depth > NEAREST, 1.0 / depth, 0.0);
        [u * per_depth, v * per_depth, depth]
    }

    /// The middle of the crop's last pixel, to which positions are clamped.
    #[inline(always)]
    pub(super) fn last_pixel(&self) -> [f32; 2] {
        [self.tables.width as f32 - 0.5, self.tables.height as f32 - 0.5]
    }

    /// The bits of the silhouette, dilated as requested.
    #[inline(always)]
    pub(super) fn mask_bits(&self, dilation: MaskDilation) -> Bits<'a> {
        let words = if dilation == MaskDilation::None { self.tables.subject } else { self.tables.dilated };
        Bits::new(words, self.tables.words)
    }

    /// The table of Chebyshev distances to the background.
    #[inline(always)]
    pub(super) fn distances(&self) -> Distances<'a> {
        Distances::new(self.tables.distance_words, self.tables.width)
    }

    /// Whether any part of a sphere may project into the silhouette, dilated by `dilation_px`, and whether all of it
    /// surely does.
    #[inline(always)]
    pub(super) fn sphere(
        &self,
        (occupancy, distances): (&OccupancyLookup, &Distances),
        [x, y, z]: [f32; 3],
        radius: f32,
        dilation_px: f32,
    ) -> (bool, bool) {
        // The image of the centre, and the least depth of the sphere.
        let at = |row: &[f32; 4]| row[0].mul_add(x, row[1].mul_add(y, row[2].mul_add(z, row[3])));
        let depth = at(&self.p[2]);
        let nearest = depth - radius * self.depth_slope;
        let (per_depth, per_nearest) = (1.0 / depth, radius * 1.001 / nearest);
        let (u, v) = (at(&self.p[0]) * per_depth, at(&self.p[1]) * per_depth);

        // A rectangle of pixels that holds the sphere's image.
        let reach = |axis: usize| self.slope[axis] * per_nearest + dilation_px + ROUNDING_PX;
        let [right, below] = self.last_pixel();
        let from = [floor_clamped(u - reach(0), right), floor_clamped(v - reach(1), below)];
        let to = [floor_clamped(u + reach(0), right) + 1, floor_clamped(v + reach(1), below) + 1];
        let is_ahead = nearest > NEAREST;
        let touches = !is_ahead | occupancy.any_occupied(from, to);

        // All pixels nearer to the centre's pixel than its distance are subject.
        let clear = distances.at(floor_clamped(u, right), floor_clamped(v, below)) as f32 - 1.0;
        (touches, is_ahead & (reach(0) <= clear) & (reach(1) <= clear))
    }

    /// Whether the whole of a sphere surely projects into the image `field_of_view` of this view.
    #[inline(always)]
    pub(super) fn sees_sphere(&self, field_of_view: &FieldOfView, [x, y, z]: [f32; 3], radius: f32) -> bool {
        let at = |row: &[f32; 4]| row[0].mul_add(x, row[1].mul_add(y, row[2].mul_add(z, row[3])));
        let depth = at(&self.p[2]);
        let nearest = depth - radius * self.depth_slope;
        let (per_depth, per_nearest) = (1.0 / depth, radius * 1.001 / nearest);
        let reach = [self.slope[0] * per_nearest + ROUNDING_PX, self.slope[1] * per_nearest + ROUNDING_PX];
        let centre = [at(&self.p[0]) * per_depth, at(&self.p[1]) * per_depth];
        (nearest > NEAREST) & field_of_view.holds(centre, reach)
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

    /// Whether the image holds every position within `reach` pixels of `at`.
    #[inline(always)]
    fn holds(&self, at: [f32; 2], reach: [f32; 2]) -> bool {
        let along = |axis: usize| {
            (at[axis] - reach[axis] >= self.low[axis]) & (at[axis] + reach[axis] < self.high[axis])
        };
        along(0) & along(1)
    }

    /// Bit masks of the points of a block that the view surely sees, and of those that it may see, from image positions
    /// and depths. Without dilation no allowance is made for rounding, and both are equal.
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

    /// Whether the lens saw the pixel at a position, in pixels from the crop's corner.
    pub(super) fn lens_sees(&self, [u, v, _]: [f32; 3]) -> bool {
        let pixel = |at: f32, low: f32| (at - low).floor() as i32;
        self.view
            .blind_spots()
            .is_none_or(|visible| visible.is_subject(pixel(u, self.low[0]), pixel(v, self.low[1])))
    }
}

/// The matrix in single precision.
fn rounded(p: &Matrix3x4<f64>) -> [[f32; 4]; 3] {
    std::array::from_fn(|r| std::array::from_fn(|c| p[(r, c)] as f32))
}

/// One row of an affine map, applied to point k of a block.
#[inline(always)]
fn affine(row: &[f32; 4], points: &Block, k: usize) -> f32 {
    row[0].mul_add(points.x[k], row[1].mul_add(points.y[k], row[2].mul_add(points.z[k], row[3])))
}
