//! Traversal of the mask along a ray's image, pixel by pixel.

use super::{LiteralView, Vec3};
use ode_visual_hull::silhouette::SUBJECT;

impl LiteralView<'_> {
    /// Metres from `a`, which projects to a subject pixel, along `direction` to the first background pixel, but `limit`
    /// at most.
    ///
    /// The image of `a + t direction` is `(u, v) + s (du, dv)` with `s = t / (z0 + t z1)`. Pixel borders lie at even
    /// steps of `s`.
    pub(super) fn walk_line(&self, a: &Vec3, direction: &Vec3, limit: f32) -> f32 {
        let (x0, x1) = (self.homogeneous(a), self.homogeneous_direction(direction));
        let (u, v) = (x0[0] / x0[2], x0[1] / x0[2]);
        let (du, dv) = (x1[0] - u * x1[2], x1[1] - v * x1[2]);

        let mut along_u = Axis::new(u, du, self.rect.x0, self.rect.x1);
        let mut along_v = Axis::new(v, dv, self.rect.y0, self.rect.y1);
        // Every pixel beyond the silhouette's rectangle is background.
        let leaves_rect = along_u.last.min(along_v.last);

        let depth_at_limit = x0[2] + limit * x1[2];
        let end = if depth_at_limit > 0.0 { limit / depth_at_limit } else { f32::INFINITY };

        let (bytes, stride) = self.bytes_at((0, 0));
        let mut at = v as i32 as isize * stride as isize + u as i32 as isize;
        let (step_u, step_v) = (along_u.step, along_v.step * stride as isize);

        loop {
            let s = if along_u.next < along_v.next {
                at += step_u;
                along_u.advance()
            } else {
                at += step_v;
                along_v.advance()
            };
            if s >= end {
                return limit;
            }
            if s >= leaves_rect || bytes.get(at as usize).is_none_or(|&byte| byte < SUBJECT) {
                let rest = 1.0 - s * x1[2];
                return if rest > 0.0 { (s * x0[2] / rest).min(limit) } else { limit };
            }
        }
    }
}

/// One image coordinate along a line.
struct Axis {
    /// Parameter `s` at the next pixel border.
    next: f32,
    /// Change of `s` from one pixel border to the next.
    delta: f32,
    /// Parameter `s` at the rectangle's last border.
    last: f32,
    /// Offset of the next pixel: 1 or -1, or 0 where the line does not move along this axis.
    step: isize,
}

impl Axis {
    fn new(from: f32, slope: f32, low: i32, high: i32) -> Self {
        // Truncation is the floor here, since the point lies in the image.
        let pixel = from as i32 as f32;
        if slope == 0.0 {
            return Self { next: f32::INFINITY, delta: 0.0, last: f32::INFINITY, step: 0 };
        }
        let (border, last, step) = if slope > 0.0 { (pixel + 1.0, high, 1) } else { (pixel, low, -1) };
        let per_pixel = 1.0 / slope;
        // Rounding may put a point on the last border; it leaves at once.
        let last = ((last as f32 - from) * per_pixel).max(0.0);
        Self { next: (border - from) * per_pixel, delta: per_pixel.abs(), last, step }
    }

    /// Moves on to the next pixel and returns `s` at the border crossed.
    fn advance(&mut self) -> f32 {
        let crossing = self.next;
        self.next += self.delta;
        crossing
    }
}
