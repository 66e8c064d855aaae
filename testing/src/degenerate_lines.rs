//! Half-lines along which something that a traversal divides by, or takes the sign of, is zero but for rounding: the
//! depth, its change, or the change of an image coordinate. And whether what the hull answers along them agrees with
//! inside tests of the points on them.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{EdgeModel, Hull};
use ode_visual_hull_random::Random;

/// What is special about a half-line. Each kind starts before, in and behind the hull.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Through a camera's centre, towards it or away from it: its image is one point. It may start behind the camera
    /// and in its centre.
    Sight,
    /// Through the centres of two cameras.
    Baseline,
    /// In the plane of two cameras' centres and a point: its images are epipolar lines.
    Epipolar,
    /// In a camera's principal plane, where the depth is 0, or from there.
    PrincipalPlane,
    /// Parallel to an image plane: the depth is constant. Some are parallel to the image's rows or columns.
    ImageParallel,
    /// With a constant column position, on the border or in the middle of a column, or elsewhere.
    Column,
    /// With a constant row position, likewise.
    Row,
    /// Through corners, along edges and along faces of the work volume.
    Volume,
    /// Parallel to an axis or to two of them.
    Axis,
    /// From a point on the border, corner or centre of a pixel, in any direction.
    Border,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 10] = [
        Self::Sight,
        Self::Baseline,
        Self::Epipolar,
        Self::PrincipalPlane,
        Self::ImageParallel,
        Self::Column,
        Self::Row,
        Self::Volume,
        Self::Axis,
        Self::Border,
    ];
}

/// Random half-lines in and around a hull.
pub struct Lines<'a> {
    hull: &'a Hull,
    random: Random,
    inside: Vec<Point3<f64>>,
}

impl<'a> Lines<'a> {
    /// # Panics
    ///
    /// If no point inside is found, or if the hull has fewer than two views.
    pub fn new(hull: &'a Hull, seed: u64) -> Self {
        let mut random = Random(seed);
        let aabb = hull.aabb();
        let points = std::iter::repeat_with(|| random.point(aabb.min, aabb.max)).take(1_000_000);
        let inside: Vec<_> = points.filter(|p| hull.inside_by(p, EdgeModel::Coverage)).take(500).collect();
        assert!(!inside.is_empty() && hull.views().len() > 1, "expected two views and points inside");
        Self { hull, random, inside }
    }

    /// The next half-line of `kind`.
    pub fn along(&mut self, kind: Kind) -> Ray {
        let camera = self.camera();
        let p = self.point(camera);
        let centre = camera.centre();

        match kind {
            Kind::Sight => {
                let direction = (p - centre).normalize();
                match self.random.below(4) {
                    0 => Ray { origin: centre, direction },
                    1 => Ray { origin: centre - direction * self.random.unit(), direction },
                    _ => self.through(p, direction),
                }
            }
            Kind::Baseline => {
                let other = self.other_than(camera).centre();
                let between = centre + (other - centre) * self.random.unit();
                self.through(between, other - centre)
            }
            Kind::Epipolar => {
                let other = self.other_than(camera).centre();
                let (a, b) = (self.random.between(-1.0, 1.0), self.random.between(-1.0, 1.0));
                self.through(p, (p - centre).normalize() * a + (p - other).normalize() * b)
            }
            Kind::PrincipalPlane => {
                let in_plane = self.in_image_plane(camera);
                let origin = centre + in_plane * self.random.between(-1.0, 1.0);
                let direction = if self.random.below(2) == 0 { in_plane } else { (p - origin).normalize() };
                Ray { origin, direction }
            }
            Kind::ImageParallel => {
                let direction = self.in_image_plane(camera);
                self.through(p, direction)
            }
            Kind::Column | Kind::Row => {
                let other = self.beside(camera, &p, kind);
                self.through(p, other - p)
            }
            Kind::Volume => {
                let origin = self.on_bounds();
                let target = if self.random.below(2) == 0 { p } else { self.on_bounds() };
                Ray { origin, direction: unit(target - origin) }
            }
            Kind::Axis => {
                let mut direction = Vector3::zeros();
                direction[self.random.below(3)] = self.sign();
                if self.random.below(2) == 0 {
                    direction[self.random.below(3)] += 0.75 * self.sign();
                }
                self.through(p, direction)
            }
            Kind::Border => Ray { origin: p, direction: self.random.direction() },
        }
    }

    fn camera(&mut self) -> &'a Camera {
        let views = self.hull.views();
        views[self.random.below(views.len())].camera()
    }

    fn other_than(&mut self, camera: &Camera) -> &'a Camera {
        loop {
            let other = self.camera();
            if other.name() != camera.name() {
                return other;
            }
        }
    }

    fn sign(&mut self) -> f64 {
        if self.random.below(2) == 0 { 1.0 } else { -1.0 }
    }

    /// A point inside the hull or, seldom, anywhere in the work volume. In most cases it is moved so that its image in
    /// `camera` lies on the border or in the middle of a column, of a row, or of both.
    fn point(&mut self, camera: &Camera) -> Point3<f64> {
        let bounds = self.hull.bounds();
        let p = if self.random.below(5) == 0 {
            self.random.point(bounds.min, bounds.max)
        } else {
            self.inside[self.random.below(self.inside.len())]
        };

        let pinhole = camera.projection_matrix() * p.to_homogeneous();
        let mut snap = |x: f64| match self.random.below(3) {
            0 => x.round(),
            1 => x.floor() + 0.5,
            _ => x,
        };
        let (u, v) = (snap(pinhole.x / pinhole.z), snap(pinhole.y / pinhole.z));
        camera.unproject(u, v, pinhole.z).unwrap_or(p)
    }

    /// Another point whose image in `camera` has the column position (or row position) of that of `p`.
    fn beside(&mut self, camera: &Camera, p: &Point3<f64>, kind: Kind) -> Point3<f64> {
        let at = camera.projection_matrix() * p.to_homogeneous();
        let (u, v) = (at.x / at.z, at.y / at.z);
        let (du, dv) = if kind == Kind::Column { (0.0, 50.0) } else { (50.0, 0.0) };
        let (du, dv) = (du * self.random.between(-1.0, 1.0), dv * self.random.between(-1.0, 1.0));
        camera.unproject(u + du, v + dv, at.z * self.random.between(0.9, 1.1)).unwrap_or(*p)
    }

    /// A unit vector parallel to the image plane, in half of the cases along a row or a column.
    fn in_image_plane(&mut self, camera: &Camera) -> Vector3<f64> {
        let angle = match self.random.below(2) {
            0 => f64::from(self.random.below(4_u32)) * std::f64::consts::FRAC_PI_2,
            _ => self.random.between(0.0, std::f64::consts::TAU),
        };
        camera.cam_from_world().inverse_transform_vector(&Vector3::new(angle.cos(), angle.sin(), 0.0))
    }

    /// A corner of the work volume, or a point on one of its edges or faces.
    fn on_bounds(&mut self) -> Point3<f64> {
        let bounds = *self.hull.bounds();
        let mut p = self.random.point(bounds.min, bounds.max);
        for _ in 0..4 {
            let (axis, corner) = (self.random.below(3), self.random.below(8));
            p[axis] = bounds.corners()[corner][axis];
        }
        p
    }

    /// The half-line through `p` along `direction` or against it. It starts before, at or behind `p`.
    fn through(&mut self, p: Point3<f64>, direction: Vector3<f64>) -> Ray {
        let bounds = self.hull.bounds();
        let reach = (bounds.max - bounds.min).norm();
        let before = match self.random.below(4) {
            0 => 0.0,
            1 => self.random.between(0.0, 2.0),
            _ => self.random.between(-0.1, 0.5),
        };
        let direction = unit(direction * self.sign());
        Ray { origin: p - direction * (before * reach), direction }
    }
}

/// `v` with length 1; upwards where it has none.
fn unit(v: Vector3<f64>) -> Vector3<f64> {
    v.try_normalize(1e-9).unwrap_or_else(Vector3::z)
}

/// How far points are moved to see whether a verdict depends on rounding, in metres. On the borders of pixels rounding
/// decides; it moves a point by about 1e-15 m, so that this is far more than rounding and far less than a pixel.
const NEIGHBOURHOOD: f64 = 1e-9;

/// How near to a crossing points are tested, in metres: far enough that they are neighbours of its surface only where the
/// line runs along it.
const BESIDE: f64 = 1e-8;

/// Number of points on a half-line that are tested.
const SAMPLES: usize = 48;

/// What is wrong with the hull's answers along `ray`, held against inside tests of points on it; `None` if nothing is.
pub fn contradiction(hull: &Hull, ray: &Ray, random: &mut Random) -> Option<String> {
    let found = hull.ray_cast(ray);
    let interval = found.map(|(entry, exit)| (entry.map_or(0.0, |hit| hit.t), exit.t));
    let by_cast = interval_contradiction(hull, ray, EdgeModel::Coverage, interval, random);
    if let Some(problem) = by_cast {
        return Some(format!("ray_cast gives {interval:?}, but {problem}"));
    }

    // Normals are of length 1.
    let hits = found.iter().flat_map(|(entry, exit)| entry.iter().chain([exit]));
    if let Some(hit) = hits.into_iter().find(|hit| (hit.normal.norm() - 1.0).abs() > 1e-9) {
        return Some(format!("ray_cast gives the normal {:?}", hit.normal));
    }

    // From a point inside the exit has to be what a ray that starts there gives.
    for edge in [EdgeModel::Pixel, EdgeModel::Coverage] {
        if hull.inside_by(&ray.origin, edge) {
            let exit = hull.exit(&ray.origin, &ray.direction, edge);
            if let Some(problem) = interval_contradiction(hull, ray, edge, Some((0.0, exit)), random) {
                return Some(format!("exit by {edge:?} gives {exit}, but {problem}"));
            }
        }
    }

    None
}

/// What contradicts that the first interval of `ray` inside the hull is `interval`, or that there is none.
fn interval_contradiction(
    hull: &Hull,
    ray: &Ray,
    edge: EdgeModel,
    interval: Option<(f64, f64)>,
    random: &mut Random,
) -> Option<String> {
    // Points spread over the part of the half-line in the work volume, or where it misses that over its first metre.
    let bounds = hull.bounds();
    let (near, far) =
        bounds.span(&ray.origin, &ray.direction).map_or((0.0, 1.0), |(near, far, _)| (near, far));
    let mut spread = |from: f64, to: f64| -> Vec<f64> {
        (0..SAMPLES).map(|k| from + (to - from) * (k as f64 + random.unit()) / SAMPLES as f64).collect()
    };

    // Outside before the entry and just beyond the exit, inside between.
    let (mut outside, mut inside) = (spread(near, far), Vec::new());
    if let Some((entry, exit)) = interval {
        outside.retain(|&t| t < entry);
        outside.extend([entry - BESIDE, exit + BESIDE]);
        inside = spread(entry, exit);
        if exit - entry > 4.0 * BESIDE {
            inside.extend([entry + BESIDE, exit - BESIDE]);
        }
    }

    let is_certainly = |t: f64, expected: bool| {
        let p = ray.at(t);
        t >= 0.0 && hull.inside_by(&p, edge) == expected && verdict(hull, &p, edge) == Some(expected)
    };
    let wrongly_out = outside.into_iter().find(|&t| is_certainly(t, true));
    let wrongly_in = inside.into_iter().find(|&t| is_certainly(t, false));
    let inside_there = wrongly_out.map(|t| format!("it is inside at {t} m"));
    inside_there.or_else(|| wrongly_in.map(|t| format!("it is outside at {t} m")))
}

/// Whether `p` is inside; `None` where that depends on rounding, because points beside it have another verdict.
fn verdict(hull: &Hull, p: &Point3<f64>, edge: EdgeModel) -> Option<bool> {
    let steps = [0.0, -NEIGHBOURHOOD, NEIGHBOURHOOD];
    let offset = |k: usize| Vector3::new(steps[k % 3], steps[k / 3 % 3], steps[k / 9]);
    let first = hull.inside_by(p, edge);
    (0..27).all(|k| hull.inside_by(&(p + offset(k)), edge) == first).then_some(first)
}
