//! The image of a half-line in one view, and where it crosses pixel borders.

use super::floor;
use crate::math::lanes::select;
use crate::math::rect::Rect;
use nalgebra::Vector3;

/// A half-line `origin + t direction`, `t >= 0` in metres, in homogeneous image coordinates: `x(t) = x0 + t x1`.
///
/// Its image is a line on which `u(t)` and `v(t)` are monotonic, so that the `t` at which it crosses the border of a
/// column or row has a closed form.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImageLine {
    x0: Vector3<f64>,
    x1: Vector3<f64>,
    /// du/dt times the depth squared: its sign says whether the image runs to the right.
    rightward: f64,
    /// dv/dt times the depth squared: its sign says whether the image runs down.
    downward: f64,
}

/// Where a line leaves a rectangle of cells, and through which side.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellExit {
    pub(crate) t: f64,
    side: CellSide,
}

/// The column or row of the cell that is entered through a side.
#[derive(Debug, Clone, Copy)]
enum CellSide {
    Column(i32),
    Row(i32),
}

impl ImageLine {
    pub(crate) fn new(x0: Vector3<f64>, x1: Vector3<f64>) -> Self {
        let rightward = x1.x * x0.z - x0.x * x1.z;
        let downward = x1.y * x0.z - x0.y * x1.z;
        Self { x0, x1, rightward, downward }
    }

    /// The image position at `t`; at infinity the vanishing point.
    pub(crate) fn at(&self, t: f64) -> (f64, f64) {
        let x = if t < f64::INFINITY { self.x0 + self.x1 * t } else { self.x1 };
        (x.x / x.z, x.y / x.z)
    }

    /// The interval of `t >= 0` in which the line lies at least `min_depth` metres in front of the camera and its image
    /// between the positions `low` and `high`; `None` where there is none.
    pub(crate) fn interval(&self, min_depth: f64, low: (f64, f64), high: (f64, f64)) -> Option<(f64, f64)> {
        // Multiplied by the depth, each condition is linear in t: constant + slope t >= 0.
        let conditions = [
            (self.x0.z - min_depth, self.x1.z),
            (self.x0.x - low.0 * self.x0.z, self.x1.x - low.0 * self.x1.z),
            (high.0 * self.x0.z - self.x0.x, high.0 * self.x1.z - self.x1.x),
            (self.x0.y - low.1 * self.x0.z, self.x1.y - low.1 * self.x1.z),
            (high.1 * self.x0.z - self.x0.y, high.1 * self.x1.z - self.x1.y),
        ];

        let (mut first, mut last) = (0.0_f64, f64::INFINITY);
        for (constant, slope) in conditions {
            if slope > 0.0 {
                first = first.max(-constant / slope);
            } else if slope < 0.0 {
                last = last.min(-constant / slope);
            } else if constant < 0.0 {
                return None;
            }
        }
        (first < last).then_some((first, last))
    }

    /// The depth at `t`, in metres.
    pub(crate) fn depth(&self, t: f64) -> f64 {
        self.x0.z + self.x1.z * t
    }

    /// The `t` at which the image crosses column position `u`.
    pub(crate) fn at_column(&self, u: f64) -> f64 {
        (u * self.x0.z - self.x0.x) / (self.x1.x - u * self.x1.z)
    }

    /// The `t` at which the image crosses row position `v`.
    pub(crate) fn at_row(&self, v: f64) -> f64 {
        (v * self.x0.z - self.x0.y) / (self.x1.y - v * self.x1.z)
    }

    /// Where the image leaves `cells`, whose corners lie at whole numbers plus `shift`; not before `t`.
    pub(crate) fn leave(&self, cells: &Rect, shift: f64, t: f64) -> CellExit {
        let (rightwards, downwards) = (self.rightward > 0.0, self.downward > 0.0);
        let column = if rightwards { cells.x1 } else { cells.x0 };
        let row = if downwards { cells.y1 } else { cells.y0 };

        let Self { x0, x1, rightward, downward } = self;
        let by_column = border_ahead(f64::from(column) + shift, [x0.x, x0.z], [x1.x, x1.z], *rightward);
        let by_row = border_ahead(f64::from(row) + shift, [x0.y, x0.z], [x1.y, x1.z], *downward);
        if by_column <= by_row {
            let entered = if rightwards { column } else { column - 1 };
            CellExit { t: by_column.max(t), side: CellSide::Column(entered) }
        } else {
            let entered = if downwards { row } else { row - 1 };
            CellExit { t: by_row.max(t), side: CellSide::Row(entered) }
        }
    }

    /// The cell that the line enters as it leaves `cells`. The side fixes one coordinate and `cells` bounds the other,
    /// so that rounding can neither stop a traversal nor move it off its line.
    pub(crate) fn entered(&self, leave: &CellExit, cells: &Rect, shift: f64) -> (i32, i32) {
        let (u, v) = self.at(leave.t);
        match leave.side {
            CellSide::Column(i) => (i, floor(v - shift).clamp(cells.y0, cells.y1 - 1)),
            CellSide::Row(j) => (floor(u - shift).clamp(cells.x0, cells.x1 - 1), j),
        }
    }
}

/// The `t` at which the image coordinate `(a0 + t a1) / (z0 + t z1)` reaches `border`, which lies ahead; infinity where
/// it never does: an image that converges to its vanishing point does not reach all borders.
///
/// `slope = a1 z0 - a0 z1` is the coordinate's derivative times the depth squared.
#[inline(always)]
pub(crate) fn border_ahead(border: f64, [a0, z0]: [f64; 2], [a1, z1]: [f64; 2], slope: f64) -> f64 {
    let divisor = a1 - border * z1;
    // The depth at the crossing is slope / divisor, and a crossing behind the camera is none. On a line of sight and on
    // one along a row or column the slope, and with it that depth, is zero but for rounding, so that a depth computed
    // from t would have either sign. The divisor is not: a border ahead that is never reached gives it the other sign
    // than the slope, whichever that has.
    let is_reached = slope * divisor > 0.0;
    select(is_reached, (border * z0 - a0) / divisor, f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use nalgebra::{Point3, vector};
    use ode_visual_hull_random::Random;

    /// Half-lines along lines of sight of random cameras: each with its image, the position of that image in pixels, and
    /// whether it leads away from the camera.
    fn lines_of_sight() -> impl Iterator<Item = (ImageLine, (f64, f64), bool)> {
        let mut random = Random(1);
        (0..5000).map(move |k| {
            let eye = Point3::from(random.direction() * 3.0);
            let camera = Camera::look_at("eye", (640, 480), 0.8, eye, Point3::origin(), random.direction());
            let (camera, leads_away) = (camera.unwrap(), k % 2 == 0);
            // At least a hundredth of a pixel from every border.
            let mut within = |pixels: u32| f64::from(random.below(pixels)) + random.between(0.01, 0.99);
            let (u, v) = (within(640), within(480));
            let ray = camera.ray(u, v).unwrap();

            let projection = camera.projection_matrix();
            let start = projection * ray.at(random.between(0.5, 5.0)).to_homogeneous();
            let direction = projection * ray.direction.to_homogeneous();
            (ImageLine::new(start, if leads_away { direction } else { -direction }), (u, v), leads_away)
        })
    }

    #[test]
    fn along_a_line_of_sight_no_border_is_crossed_before_the_camera() {
        for (line, (u, v), leads_away) in lines_of_sight() {
            for half in [0, 1, 20] {
                let exit = line.leave(&Rect::window(floor(u), floor(v), half), 0.0, 0.0);
                // Towards the camera every border is crossed in its centre, but for rounding.
                let is_never = exit.t == f64::INFINITY;
                assert!(is_never || (!leads_away && line.depth(exit.t).abs() < 1e-9), "{line:?} {exit:?}");
            }
        }
    }

    #[test]
    fn a_line_away_from_the_camera_ends_in_its_vanishing_point() {
        for (line, (u, v), _) in lines_of_sight().filter(|(.., leads_away)| *leads_away) {
            let (end_u, end_v) = line.at(f64::INFINITY);
            // Rounding of coordinates of some hundred pixels.
            assert!((end_u - u).abs() < 1e-9 && (end_v - v).abs() < 1e-9, "{end_u} {end_v}, not {u} {v}");
        }
        let aslant = ImageLine::new(vector![10.0, 20.0, 1.0], vector![0.3, -0.2, 0.1]);
        assert_eq!(aslant.at(f64::INFINITY), (0.3 / 0.1, -0.2 / 0.1));
    }
}
