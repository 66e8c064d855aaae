//! Axis-aligned boxes.

use crate::{Error, Result};
use nalgebra::{Isometry3, Point3, Vector3};

/// The largest coordinate of a work volume, in metres: 10 000 km, farther than any simulation reaches.
const REACH: f64 = 1e7;

/// An axis-aligned box, in metres. It is empty if `min` exceeds `max` on some axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The lower corner.
    pub min: Point3<f64>,
    /// The upper corner.
    pub max: Point3<f64>,
}

impl Aabb {
    /// A box without points.
    pub const EMPTY: Self = Self {
        min: Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        max: Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// A work volume between two corners.
    ///
    /// # Errors
    /// A coordinate that is not finite or beyond 1e7 m; an upper corner that is not above the lower one on every axis.
    pub fn new(min: Point3<f64>, max: Point3<f64>) -> Result<Self> {
        let in_reach = min.iter().chain(max.iter()).all(|x| x.abs() <= REACH);
        if !in_reach || min.x >= max.x || min.y >= max.y || min.z >= max.z {
            return Err(Error::argument(format!(
                "bounds: expected finite corners, at most {REACH} m away, with min below max on each axis, found \
                 min {}, max {}; swap or spread them",
                triple(&min),
                triple(&max)
            )));
        }
        Ok(Self { min, max })
    }

    /// The smallest box around `points`.
    pub fn of_points<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> Self {
        points.into_iter().fold(Self::EMPTY, |aabb, p| Self { min: aabb.min.inf(p), max: aabb.max.sup(p) })
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y || self.min.z > self.max.z
    }

    /// Whether `p` lies in it, faces included.
    pub fn contains(&self, p: &Point3<f64>) -> bool {
        *p >= self.min && *p <= self.max
    }

    /// The box of the points that lie in both; empty where they do not overlap.
    pub fn intersection(&self, other: &Self) -> Self {
        Self { min: self.min.sup(&other.min), max: self.max.inf(&other.max) }
    }

    /// The smallest box that holds both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// The box grown by `margin` metres on every side.
    pub fn grown(&self, margin: f64) -> Self {
        let by = Vector3::repeat(margin);
        Self { min: self.min - by, max: self.max + by }
    }

    /// The middle of the box.
    pub fn centre(&self) -> Point3<f64> {
        nalgebra::center(&self.min, &self.max)
    }

    /// The eight corners; corner `c` takes its upper bound on axis `k` where bit `k` of `c` is set.
    pub fn corners(&self) -> [Point3<f64>; 8] {
        std::array::from_fn(|c| {
            let pick = |axis: usize| if c >> axis & 1 == 1 { self.max[axis] } else { self.min[axis] };
            Point3::new(pick(0), pick(1), pick(2))
        })
    }

    /// The axis-aligned box around this one after `motion`.
    pub fn transformed(&self, motion: &Isometry3<f64>) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::of_points(&self.corners().map(|corner| motion * corner))
    }

    /// The first distance `t >= 0` at which the line `origin + t direction` leaves the box, for an origin in it, and
    /// the outward normal there.
    pub fn exit(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> (f64, Vector3<f64>) {
        let mut first = (f64::INFINITY, Vector3::zeros());

        for axis in 0..3 {
            let face = if direction[axis] > 0.0 { self.max[axis] } else { self.min[axis] };
            // A line parallel to the two faces of this axis meets neither.
            if direction[axis] != 0.0 {
                let t = ((face - origin[axis]) / direction[axis]).max(0.0);
                if t < first.0 {
                    let mut normal = Vector3::zeros();
                    normal[axis] = direction[axis].signum();
                    first = (t, normal);
                }
            }
        }
        first
    }

    /// The interval `(entry, exit)` in which the half-line `origin + t direction`, `t >= 0`, lies inside the box, and
    /// the outward normal of the face where it enters (zero if it starts inside); `None` if it misses the box.
    pub fn span(&self, origin: &Point3<f64>, direction: &Vector3<f64>) -> Option<(f64, f64, Vector3<f64>)> {
        let (mut entry, mut exit, mut normal) = (0.0_f64, f64::INFINITY, Vector3::zeros());

        for axis in 0..3 {
            // A line parallel to the two faces of this axis lies between them throughout, or nowhere.
            if direction[axis] == 0.0 {
                if origin[axis] < self.min[axis] || origin[axis] > self.max[axis] {
                    return None;
                }
                continue;
            }

            // Slab test: the latest entry and the earliest exit over the axes.
            let at = |face: f64| (face - origin[axis]) / direction[axis];
            let (low, high) = (at(self.min[axis]), at(self.max[axis]));
            if low.min(high) > entry {
                entry = low.min(high);
                normal = Vector3::zeros();
                normal[axis] = -direction[axis].signum();
            }
            exit = exit.min(low.max(high));
        }
        (entry <= exit).then_some((entry, exit, normal))
    }
}

fn triple(p: &Point3<f64>) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}
