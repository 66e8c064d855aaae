//! Solids with ray intersections in closed form: sphere, box, capsule and torus, each in a frame of its own.
//!
//! ```text
//!      z                                     z
//!      |   .--.                              |
//!      |  |    |  capsule: length L          |      .-.         .-.   torus: a tube of radius
//!      |  | L  |  along z between the        |     ( o )---R---( o )  r about the circle of
//!      |  |    |  centres of its caps        |      '-'         '-'   radius R in the plane z = 0
//!      |   '--'
//! ```

use super::torus;
use crate::camera::Ray;
use crate::{Error, Result};
use nalgebra::{Point3, Vector3};

/// A solid about the origin of its own frame; lengths in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Solid {
    /// A ball, made by [`Solid::sphere`].
    #[non_exhaustive]
    Sphere {
        /// The radius.
        radius: f64,
    },
    /// A box aligned with the axes, made by [`Solid::cuboid`].
    #[non_exhaustive]
    Cuboid {
        /// The full lengths along x, y and z.
        lengths: Vector3<f64>,
    },
    /// All points within `radius` of a segment of the z axis, made by [`Solid::capsule`].
    #[non_exhaustive]
    Capsule {
        /// The radius of the tube and of its caps.
        radius: f64,
        /// The distance between the centres of the caps.
        length: f64,
    },
    /// A ring about the z axis, made by [`Solid::torus`].
    #[non_exhaustive]
    Torus {
        /// The radius of the circle in the middle of the tube.
        major: f64,
        /// The radius of the tube, smaller than `major`.
        minor: f64,
    },
}

/// The point where a ray crosses a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// The distance from the ray's origin, in metres.
    pub t: f64,
    /// The surface's outward unit normal, in the ray's frame.
    pub normal: Vector3<f64>,
}

impl Solid {
    /// A ball.
    ///
    /// # Errors
    /// A radius that is not positive and finite.
    pub fn sphere(radius: f64) -> Result<Self> {
        Ok(Self::Sphere { radius: positive("a sphere's radius", radius)? })
    }

    /// A box with these full lengths.
    ///
    /// # Errors
    /// A length that is not positive and finite.
    pub fn cuboid(lengths: Vector3<f64>) -> Result<Self> {
        for length in lengths.iter() {
            positive("each length of a box", *length)?;
        }
        Ok(Self::Cuboid { lengths })
    }

    /// A capsule along z; `length` is the length of its cylinder, without the caps.
    ///
    /// # Errors
    /// A radius or length that is not positive and finite.
    pub fn capsule(radius: f64, length: f64) -> Result<Self> {
        Ok(Self::Capsule {
            radius: positive("a capsule's radius", radius)?,
            length: positive("a capsule's length", length)?,
        })
    }

    /// A ring about z: a tube of radius `minor` about a circle of radius `major`.
    ///
    /// # Errors
    /// A radius that is not positive and finite, or a `minor` that is not smaller than `major`.
    pub fn torus(major: f64, minor: f64) -> Result<Self> {
        positive("a torus's minor radius", minor)?;
        positive("a torus's major radius", major)?;
        if minor >= major {
            return Err(Error::argument(format!(
                "expected a torus's minor radius below its major one, found {minor} and {major} m"
            )));
        }
        Ok(Self::Torus { major, minor })
    }

    /// The point where `ray`, in the solid's frame, first crosses the surface: where it enters, or where it leaves if
    /// it starts inside.
    ///
    /// Whether a grazing ray hits is exact up to rounding errors; the position of its hit is as exact as their square
    /// root.
    pub fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let t = self.first_crossing(ray)?;
        Some(Hit { t, normal: self.normal_at(&ray.at(t)) })
    }

    /// Whether `point`, in the solid's frame, is inside or on the surface.
    pub fn contains(&self, point: &Point3<f64>) -> bool {
        match *self {
            Self::Sphere { radius } => point.coords.norm() <= radius,
            Self::Cuboid { lengths } => (0..3).all(|i| point[i].abs() <= 0.5 * lengths[i]),
            Self::Capsule { radius, length } => from_axis(point, length).norm() <= radius,
            Self::Torus { major, minor } => torus::from_circle(point, major).norm() <= minor,
        }
    }

    /// The radius of the smallest ball about the origin that holds the solid.
    pub fn bounding_radius(&self) -> f64 {
        match *self {
            Self::Sphere { radius } => radius,
            Self::Cuboid { lengths } => 0.5 * lengths.norm(),
            Self::Capsule { radius, length } => radius + 0.5 * length,
            Self::Torus { major, minor } => major + minor,
        }
    }

    /// The distance at which `ray` first crosses the surface.
    pub(super) fn first_crossing(&self, ray: &Ray) -> Option<f64> {
        let chord = match *self {
            Self::Sphere { radius } => ball_chord(ray, &Point3::origin(), radius),
            Self::Cuboid { lengths } => cuboid_chord(ray, &lengths),
            Self::Capsule { radius, length } => capsule_chord(ray, radius, length),
            Self::Torus { major, minor } => return torus::first_crossing(ray, major, minor),
        };
        let (enter, leave) = chord?;
        let t = if enter >= 0.0 { enter } else { leave };
        (t >= 0.0).then_some(t)
    }

    /// The solid grown by `distance` metres (shrunk if negative): it contains every point that near. `None` if nothing
    /// is left. A grown box keeps its sharp edges and so contains slightly more.
    pub(super) fn grown(&self, distance: f64) -> Option<Self> {
        let (grown, thinnest) = match *self {
            Self::Sphere { radius } => (Self::Sphere { radius: radius + distance }, radius + distance),
            Self::Cuboid { lengths } => {
                let lengths = lengths.add_scalar(2.0 * distance);
                (Self::Cuboid { lengths }, lengths.min())
            }
            Self::Capsule { radius, length } => {
                (Self::Capsule { radius: radius + distance, length }, radius + distance)
            }
            Self::Torus { major, minor } => {
                (Self::Torus { major, minor: minor + distance }, minor + distance)
            }
        };
        (thinnest > 0.0).then_some(grown)
    }

    /// The outward unit normal at `point` on the surface.
    fn normal_at(&self, point: &Point3<f64>) -> Vector3<f64> {
        match *self {
            Self::Sphere { .. } => point.coords.normalize(),
            Self::Cuboid { lengths } => {
                let beyond = point.coords.abs() - 0.5 * lengths;
                let mut normal = Vector3::zeros();
                normal[beyond.imax()] = point[beyond.imax()].signum();
                normal
            }
            Self::Capsule { length, .. } => from_axis(point, length).normalize(),
            Self::Torus { major, .. } => torus::from_circle(point, major).normalize(),
        }
    }
}

fn positive(what: &str, metres: f64) -> Result<f64> {
    if metres > 0.0 && metres.is_finite() {
        return Ok(metres);
    }
    Err(Error::argument(format!("expected {what} positive and finite, in metres, found {metres}")))
}

/// The vector from the nearest point of a capsule's axis to `point`.
fn from_axis(point: &Point3<f64>, length: f64) -> Vector3<f64> {
    let along = point.z.clamp(-0.5 * length, 0.5 * length);
    Vector3::new(point.x, point.y, point.z - along)
}

/// The distances at which the whole line of a ray enters and leaves.
type Chord = (f64, f64);

fn ball_chord(ray: &Ray, centre: &Point3<f64>, radius: f64) -> Option<Chord> {
    let middle = (centre - ray.origin).dot(&ray.direction);
    // The offset of the nearest point keeps a grazing ray's digits, which b^2 - 4ac would lose to the squared distance.
    let offset = ray.at(middle) - centre;
    let half = real_root(radius * radius - offset.norm_squared())?;
    Some((middle - half, middle + half))
}

/// The part of a line where `|origin + t direction| <= half`.
fn slab_chord(origin: f64, direction: f64, half: f64) -> Option<Chord> {
    if direction == 0.0 {
        return (origin.abs() <= half).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }
    let (a, b) = ((-half - origin) / direction, (half - origin) / direction);
    Some((a.min(b), a.max(b)))
}

fn cuboid_chord(ray: &Ray, lengths: &Vector3<f64>) -> Option<Chord> {
    let mut chord = (f64::NEG_INFINITY, f64::INFINITY);
    for i in 0..3 {
        chord = common(chord, slab_chord(ray.origin[i], ray.direction[i], 0.5 * lengths[i])?)?;
    }
    Some(chord)
}

/// The chord of a capsule, which is convex and the union of a cylinder and two balls: from the first of their
/// entrances to the last of their exits.
fn capsule_chord(ray: &Ray, radius: f64, length: f64) -> Option<Chord> {
    let cap = |z: f64| ball_chord(ray, &Point3::new(0.0, 0.0, z), radius);
    let tube = slab_chord(ray.origin.z, ray.direction.z, 0.5 * length)
        .and_then(|slab| common(slab, tube_chord(ray, radius)?));
    let chords = [tube, cap(-0.5 * length), cap(0.5 * length)];
    chords.into_iter().flatten().reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// The chord of the infinite cylinder about z.
fn tube_chord(ray: &Ray, radius: f64) -> Option<Chord> {
    let (o, d) = (ray.origin.xy().coords, ray.direction.xy());
    let a = d.norm_squared();
    let c = o.norm_squared() - radius * radius;
    if a == 0.0 {
        return (c <= 0.0).then_some((f64::NEG_INFINITY, f64::INFINITY));
    }

    // Solve a t^2 + 2 b t + c = 0, with b^2 - a c in a form that keeps a grazing ray's digits.
    let b = o.dot(&d);
    let root = real_root(a * radius * radius - o.perp(&d).powi(2))?;

    // One of the two roots -(b -+ root) / a suffers cancellation; compute it from the other by their product c / a.
    let q = -(b + root.copysign(b));
    if q == 0.0 {
        return Some((0.0, 0.0));
    }
    let (t, u) = (q / a, c / q);
    Some((t.min(u), t.max(u)))
}

/// The intersection of two chords.
fn common(a: Chord, b: Chord) -> Option<Chord> {
    let both = (a.0.max(b.0), a.1.min(b.1));
    (both.0 <= both.1).then_some(both)
}

/// The square root; `None` for a negative number or NaN, where the line misses.
fn real_root(square: f64) -> Option<f64> {
    (square >= 0.0).then(|| square.sqrt())
}
