//! The search line: pixel by pixel along a ray's image.

use super::{LiteralView, Vec3};
use ode_visual_hull::silhouette::SUBJECT;

impl LiteralView<'_> {
    /// Metres from `a`, which the view sees as subject, along `direction` to the first background pixel; `limit` where
    /// there is none before.
    ///
    /// The image of `a + t direction` is `(u, v) + s (du, dv)` with `s = t / (z0 + t z1)`: a line at even steps, from
    /// pixel border to pixel border.
    pub(super) fn walk_line(&self, a: &Vec3, direction: &Vec3, limit: f32) -> f32 {
        let (x0, x1) = (self.homogeneous(a), self.homogeneous_direction(direction));
        let (u, v) = (x0[0] / x0[2], x0[1] / x0[2]);
        let (du, dv) = (x1[0] - u * x1[2], x1[1] - v * x1[2]);
        let mut along_u = Axis::new(u, du, self.rect.x0, self.rect.x1);
        let mut along_v = Axis::new(v, dv, self.rect.y0, self.rect.y1);

        // Beyond the silhouette's rectangle all is background.
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
    /// Where the next pixel border is crossed.
    next: f32,
    /// From border to border.
    delta: f32,
    /// Where the rectangle's last border is crossed.
    last: f32,
    /// The neighbour's offset.
    step: isize,
}

impl Axis {
    fn new(from: f32, slope: f32, low: i32, high: i32) -> Self {
        // Truncated, which is the floor: the point lies in the image.
        let pixel = from as i32 as f32;
        if slope == 0.0 {
            return Self { next: f32::INFINITY, delta: 0.0, last: f32::INFINITY, step: 0 };
        }
        let (border, last, step) = if slope > 0.0 { (pixel + 1.0, high, 1) } else { (pixel, low, -1) };
        let per_pixel = 1.0 / slope;
        // A point that lies on the last border by rounding leaves at once.
        let last = ((last as f32 - from) * per_pixel).max(0.0);
        Self { next: (border - from) * per_pixel, delta: per_pixel.abs(), last, step }
    }

    /// The next crossing, passed.
    fn advance(&mut self) -> f32 {
        let crossing = self.next;
        self.next += self.delta;
        crossing
    }
}
