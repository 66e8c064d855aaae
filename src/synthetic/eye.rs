//! Finds the solids that the rays of a part of an image can meet.
//!
//! ```text
//!            .--'      the rays of a patch diverge by at most `spread` metres
//!   eye o--<------     at depth 1, so by `spread * depth` at a solid: they
//!            '--.      miss what the middle ray misses when grown by that
//! ```
//!
//! Images are therefore traversed in tiles: most meet nothing, the others few of the solids. The same test separates
//! pixels that show only background or only the inside of a solid from those that an outline crosses. It does not need
//! the outline, and holds with a distorting lens, beyond the image and behind the camera.

use super::subject::{Placed, Subject};
use crate::camera::{Camera, Ray};
use nalgebra::{Point3, Vector3};

/// The edge of a tile, in pixels.
const TILE: u32 = 16;

/// A camera with its centre and viewing direction, which all rays need.
pub(super) struct Eye<'c> {
    camera: &'c Camera,
    centre: Point3<f64>,
    forward: Vector3<f64>,
}

impl<'c> Eye<'c> {
    pub(super) fn new(camera: &'c Camera) -> Self {
        Self { camera, centre: camera.centre(), forward: camera.forward() }
    }

    /// The ray through the pixel coordinates `(u, v)`; `None` beyond the lens model.
    pub(super) fn ray(&self, u: f64, v: f64) -> Option<Ray> {
        Some(Ray { origin: self.centre, direction: self.to_plane(u, v)?.normalize() })
    }

    /// The depth in metres of the point at distance `t` on `ray`.
    pub(super) fn depth(&self, ray: &Ray, t: f64) -> f64 {
        t * ray.direction.dot(&self.forward)
    }

    /// The vector from the eye to the point at depth 1 on the ray through `(u, v)`.
    fn to_plane(&self, u: f64, v: f64) -> Option<Vector3<f64>> {
        Some(self.camera.unproject(u, v, 1.0)? - self.centre)
    }

    /// The image's tiles, row by row.
    pub(super) fn image_tiles(&self) -> impl Iterator<Item = Tile> + use<> {
        let (width, height) = self.camera.size();
        (0..height).step_by(TILE as usize).flat_map(move |y| {
            (0..width).step_by(TILE as usize).map(move |x| Tile {
                left: x,
                top: y,
                right: (x + TILE).min(width),
                bottom: (y + TILE).min(height),
            })
        })
    }

    /// The tiles in which the subject may appear, each with the solids that may appear in it.
    pub(super) fn tiles_with<'s>(
        &self,
        subject: &'s Subject,
    ) -> impl Iterator<Item = (Tile, Vec<&'s Placed>)> {
        self.image_tiles().filter_map(|tile| {
            let patch = self.patch_around(&tile);
            let may_appear = |placed: &&Placed| patch.as_ref().is_none_or(|patch| patch.may_meet(placed));
            let solids: Vec<_> = subject.solids().iter().filter(may_appear).collect();
            (!solids.is_empty()).then_some((tile, solids))
        })
    }

    /// The rays of a tile; `None` where a corner is beyond the lens model.
    fn patch_around(&self, tile: &Tile) -> Option<Patch> {
        // In pixels: distortion bends the sides of a tile outwards by less.
        let margin = 1.0;
        let (left, right) = (f64::from(tile.left) - margin, f64::from(tile.right) + margin);
        let (top, bottom) = (f64::from(tile.top) - margin, f64::from(tile.bottom) + margin);

        let corners = [
            self.to_plane(left, top)?,
            self.to_plane(right, top)?,
            self.to_plane(left, bottom)?,
            self.to_plane(right, bottom)?,
        ];
        Some(Patch::new(self, corners))
    }

    /// Calls `visit(x, y, patch)` for each pixel of `tile`, except pixels with a corner beyond the lens model.
    pub(super) fn for_each_pixel(&self, tile: &Tile, mut visit: impl FnMut(u32, u32, Patch)) {
        let corners_of_row = |y: u32| -> Vec<Option<Vector3<f64>>> {
            (tile.left..=tile.right).map(|x| self.to_plane(f64::from(x), f64::from(y))).collect()
        };

        let mut above = corners_of_row(tile.top);
        for y in tile.top..tile.bottom {
            let below = corners_of_row(y + 1);
            for x in tile.left..tile.right {
                let i = (x - tile.left) as usize;
                if let (Some(a), Some(b), Some(c), Some(d)) = (above[i], above[i + 1], below[i], below[i + 1])
                {
                    visit(x, y, Patch::new(self, [a, b, c, d]));
                }
            }
            above = below;
        }
    }
}

/// A rectangle of pixels; `right` and `bottom` are exclusive.
pub(super) struct Tile {
    left: u32,
    top: u32,
    right: u32,
    bottom: u32,
}

impl Tile {
    /// The tile's pixels, row by row.
    pub(super) fn pixels(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (left, right) = (self.left, self.right);
        (self.top..self.bottom).flat_map(move |y| (left..right).map(move |x| (x, y)))
    }
}

/// The rays through a four-sided part of the plane at depth 1: those of a pixel or of a tile.
pub(super) struct Patch {
    eye: Point3<f64>,
    forward: Vector3<f64>,
    /// The vectors from the eye to the corners at depth 1: upper left, upper right, lower left, lower right.
    corners: [Vector3<f64>; 4],
    middle: Vector3<f64>,
    angular_radius: f64,
}

/// What a pixel shows of a subject.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum PatchContent {
    /// Only background.
    Background,
    /// Only solids.
    Subject,
    /// An outline may cross the pixel.
    Contour,
}

impl Patch {
    fn new(eye: &Eye, corners: [Vector3<f64>; 4]) -> Self {
        let middle = corners.iter().sum::<Vector3<f64>>() / 4.0;
        let spread = corners.iter().map(|corner| (corner - middle).norm()).fold(0.0, f64::max);
        Self { eye: eye.centre, forward: eye.forward, corners, middle, angular_radius: spread }
    }

    /// The ray at `(s, t)` of the patch, from (0, 0) at its upper left to (1, 1) at its lower right corner.
    ///
    /// Between a pixel's corners the lens is taken as linear, which holds to about a thousandth of a pixel.
    pub(super) fn ray(&self, s: f64, t: f64) -> Ray {
        let [a, b, c, d] = &self.corners;
        let upper = a + (b - a) * s;
        let lower = c + (d - c) * s;
        Ray { origin: self.eye, direction: (upper + (lower - upper) * t).normalize() }
    }

    /// `n` times `n` rays through the centres of as many equal parts.
    pub(super) fn rays(&self, n: u32) -> impl Iterator<Item = Ray> + '_ {
        let middle = move |i: u32| (f64::from(i) + 0.5) / f64::from(n);
        (0..n * n).map(move |i| self.ray(middle(i % n), middle(i / n)))
    }

    /// The largest distance of a ray of the patch from the middle ray, in metres, at the depths of `placed`; `None` if
    /// the solid is completely behind the camera.
    fn spread_at(&self, placed: &Placed) -> Option<f64> {
        let farthest = (placed.centre() - self.eye).dot(&self.forward) + placed.solid().bounding_radius();
        (farthest > 0.0).then_some(farthest * self.angular_radius)
    }

    /// Whether a ray of the patch may meet the bounding ball of `placed`.
    fn may_meet(&self, placed: &Placed) -> bool {
        let Some(spread) = self.spread_at(placed) else { return false };
        let direction = self.middle.normalize();
        let to_centre = placed.centre() - self.eye;
        let nearest = to_centre.dot(&direction).max(0.0);
        (to_centre - direction * nearest).norm() <= placed.solid().bounding_radius() + spread
    }

    /// What the patch shows of `solids`; those that it may meet are written to `met`.
    pub(super) fn content<'s>(&self, solids: &[&'s Placed], met: &mut Vec<&'s Placed>) -> PatchContent {
        met.clear();
        let middle = Ray { origin: self.eye, direction: self.middle.normalize() };
        let mut content = PatchContent::Background;
        for &placed in solids {
            if !self.may_meet(placed) {
                continue;
            }
            let Some(spread) = self.spread_at(placed) else { continue };

            let ray = placed.ray_in_solid(&middle);
            let meets = |distance: f64| {
                placed.solid().grown(distance).is_some_and(|solid| solid.first_crossing(&ray).is_some())
            };
            if !meets(spread) {
                continue;
            }

            met.push(placed);
            if content != PatchContent::Subject {
                content = if meets(-spread) { PatchContent::Subject } else { PatchContent::Contour };
            }
        }
        content
    }
}
