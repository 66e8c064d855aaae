//! One view: its projection matrix in plain `f32`, and its mask.

use super::Vec3;
use image::GrayImage;
use nalgebra::Matrix3x4;
use ode_visual_hull::camera::{Camera, MIN_DEPTH};
use ode_visual_hull::silhouette::{Rect, SUBJECT};

/// Minimum length, in pixels, of a mean of background vectors that counts as a direction.
const SHORTEST_MEAN: f32 = 0.3;

/// A camera, its mask and the silhouette's bounding rectangle.
#[derive(Debug, Clone)]
pub struct LiteralView<'a> {
    p: [[f32; 4]; 3],
    /// Metres that a pixel covers at a depth of 1 m.
    pixel_at_1m: f32,
    mask: &'a [u8],
    width: i32,
    height: i32,
    pub(super) rect: Rect,
    /// Lower corner of `rect`, compared with a projection before rounding.
    low: (f32, f32),
    /// Upper corner of `rect`.
    high: (f32, f32),
}

impl<'a> LiteralView<'a> {
    /// A view of `camera`, which has no distortion.
    pub fn new(camera: &Camera, mask: &'a GrayImage) -> Self {
        let p: Matrix3x4<f32> = camera.projection_matrix().cast();
        let k = camera.intrinsics();
        let rect = bounding_rectangle(mask);
        Self {
            p: std::array::from_fn(|row| std::array::from_fn(|column| p[(row, column)])),
            pixel_at_1m: (1.0 / k[(0, 0)]).min(1.0 / k[(1, 1)]) as f32,
            mask: mask.as_raw(),
            width: mask.width() as i32,
            height: mask.height() as i32,
            rect,
            low: (rect.x0 as f32, rect.y0 as f32),
            high: (rect.x1 as f32, rect.y1 as f32),
        }
    }

    /// Homogeneous image coordinates of a point: `(u depth, v depth, depth)`.
    #[inline]
    pub(super) fn homogeneous(&self, p: &Vec3) -> Vec3 {
        self.p.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2] + r[3])
    }

    /// Change of the homogeneous image coordinates along a direction.
    pub(super) fn homogeneous_direction(&self, d: &Vec3) -> Vec3 {
        self.p.map(|r| r[0] * d[0] + r[1] * d[1] + r[2] * d[2])
    }

    /// Whether the point projects to a subject pixel.
    #[inline]
    pub(super) fn sees_subject(&self, p: &Vec3) -> bool {
        let h = self.homogeneous(p);
        let to_image = 1.0 / h[2];
        let (u, v) = (h[0] * to_image, h[1] * to_image);
        let in_rect = h[2] > MIN_DEPTH as f32
            && u >= self.low.0
            && u < self.high.0
            && v >= self.low.1
            && v < self.high.1;
        in_rect && self.mask[v as usize * self.width as usize + u as usize] >= SUBJECT
    }

    /// The pixel of a visible point, and the metres that a pixel covers at its depth.
    pub(super) fn project(&self, p: &Vec3) -> ((i32, i32), f32) {
        let h = self.homogeneous(p);
        (((h[0] / h[2]) as i32, (h[1] / h[2]) as i32), h[2] * self.pixel_at_1m)
    }

    /// Whether the square of half-width `radius` around a pixel lies in the image.
    pub(super) fn holds_square(&self, (i, j): (i32, i32), radius: i32) -> bool {
        i >= radius && j >= radius && i + radius < self.width && j + radius < self.height
    }

    /// Columns `x0..=x1` of a row inside the image.
    pub(super) fn row(&self, y: i32, x0: i32, x1: i32) -> &'a [u8] {
        &self.mask[(y * self.width + x0) as usize..=(y * self.width + x1) as usize]
    }

    /// The mask's bytes from a pixel inside the image on, and the number of bytes in a row.
    pub(super) fn bytes_at(&self, (i, j): (i32, i32)) -> (&'a [u8], usize) {
        (&self.mask[(j * self.width + i) as usize..], self.width as usize)
    }

    /// Whether a pixel is subject; false beyond the image.
    pub(super) fn is_subject(&self, i: i32, j: i32) -> bool {
        self.rect.contains(i, j) && self.mask[(j * self.width + i) as usize] >= SUBJECT
    }

    /// The direction of the mean vector from `b` to the background pixels of the 5x5 window around it. Where the mean
    /// is short, the window is 7x7 or 9x9; `None` where it is short in all three.
    pub(super) fn normal_2d(&self, b: (i32, i32)) -> Option<(f32, f32)> {
        [2, 3, 4].into_iter().find_map(|half| {
            let (mut du, mut dv, mut count) = (0, 0, 0);
            for y in -half..=half {
                for x in -half..=half {
                    let background = i32::from(!self.is_subject(b.0 + x, b.1 + y));
                    du += x * background;
                    dv += y * background;
                    count += background;
                }
            }

            let length = ((du * du + dv * dv) as f32).sqrt();
            (length >= SHORTEST_MEAN * count as f32).then(|| (du as f32 / length, dv as f32 / length))
        })
    }

    /// The outward normal of the plane through the camera's centre and the tangent line at pixel `b`.
    pub(super) fn backproject_normal(&self, b: (i32, i32), (nu, nv): (f32, f32)) -> Vec3 {
        let (u, v) = (b.0 as f32 + 0.5, b.1 as f32 + 0.5);
        let [p0, p1, p2] = &self.p;
        let n: Vec3 = std::array::from_fn(|k| nu * (p0[k] - u * p2[k]) + nv * (p1[k] - v * p2[k]));
        scaled(&n, 1.0 / dot(&n, &n).sqrt())
    }
}

pub(super) fn dot(a: &Vec3, b: &Vec3) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn add(a: &Vec3, b: &Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(super) fn scaled(a: &Vec3, by: f32) -> Vec3 {
    a.map(|x| x * by)
}

/// The bounding rectangle of the subject pixels, in a single pass: rows without a subject pixel are skipped by their
/// largest byte, and the others are searched only where they could widen the rectangle.
fn bounding_rectangle(mask: &GrayImage) -> Rect {
    let width = mask.width() as usize;
    let (mut x0, mut x1, mut y0, mut y1) = (width, 0, i32::MAX, 0);
    for (y, row) in mask.as_raw().chunks_exact(width.max(1)).enumerate() {
        if row.iter().fold(0, |most, &byte| most.max(byte)) < SUBJECT {
            continue;
        }

        y0 = y0.min(y as i32);
        y1 = y as i32 + 1;
        x0 = row[..x0].iter().position(|&byte| byte >= SUBJECT).unwrap_or(x0);
        x1 += row[x1..].iter().rposition(|&byte| byte >= SUBJECT).map_or(0, |last| last + 1);
    }
    if x1 == 0 { Rect::EMPTY } else { Rect { x0: x0 as i32, y0, x1: x1 as i32, y1 } }
}
