//! Where viewing rays meet the shapes of virtual bodies, and how these look there.
//!
//! Boxes, spheres and capsules are drawn. All functions take points and rays in the body's frame.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Ray;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::Solid;

/// Half the width of the dark lines along a box's edges and around a sphere, in metres.
const LINE: f64 = 0.003;

/// Brightness in the middle of a dark line.
const LINE_BRIGHTNESS: f64 = 0.45;

/// Where a ray enters a body.
#[derive(Debug, Clone, Copy)]
pub struct EntryPoint {
    /// Metres along the ray.
    pub t: f64,
    /// The axis normal to the face of a box.
    axis: usize,
}

/// The radius of the smallest sphere around the body's origin that holds it.
pub fn bounding_radius(shape: &Shape) -> f64 {
    match *shape {
        Shape::Box { sides } => (0.5 * sides).norm(),
        Shape::Sphere { radius } => radius,
        Shape::Capsule { radius, length } => radius + 0.5 * length,
        _ => 0.0,
    }
}

/// The distance of `point` from the body; 0 inside.
pub fn distance(shape: &Shape, point: &Point3<f64>) -> f64 {
    match *shape {
        Shape::Box { sides } => (point.coords.abs() - 0.5 * sides).map(|x| x.max(0.0)).norm(),
        Shape::Sphere { radius } => (point.coords.norm() - radius).max(0.0),
        Shape::Capsule { radius, length } => (from_axis(point, length).norm() - radius).max(0.0),
        _ => f64::INFINITY,
    }
}

/// Where `ray` enters the body.
pub fn entry(shape: &Shape, ray: &Ray) -> Option<EntryPoint> {
    match *shape {
        Shape::Box { sides } => enter_box(ray, &(0.5 * sides)),
        Shape::Sphere { radius } => {
            let along = ray.origin.coords.dot(&ray.direction);
            let root = (along * along - ray.origin.coords.norm_squared() + radius * radius).sqrt();
            // A miss is NaN, and no greater than 0.
            let t = -along - root;
            (t > 0.0).then_some(EntryPoint { t, axis: 0 })
        }
        Shape::Capsule { radius, length } => {
            let solid = Solid::capsule(radius, length).ok()?;
            let hit = if solid.contains(&ray.origin) { None } else { solid.first_hit(ray) };
            hit.map(|hit| EntryPoint { t: hit.t, axis: 0 })
        }
        _ => None,
    }
}

/// The outward normal at `point`, where a ray enters.
pub fn normal(shape: &Shape, point: &Point3<f64>, entry: &EntryPoint) -> Vector3<f64> {
    match *shape {
        Shape::Sphere { radius } => point.coords / radius,
        Shape::Capsule { length, .. } => from_axis(point, length).normalize(),
        _ => {
            let mut normal = Vector3::zeros();
            normal[entry.axis] = point[entry.axis].signum();
            normal
        }
    }
}

/// The brightness at `point`, where a ray enters: dark lines with soft sides show edges, and how a sphere rolls. Capsules have
/// none.
pub fn line_brightness(shape: &Shape, point: &Point3<f64>, entry: &EntryPoint) -> f64 {
    let to_line = match *shape {
        Shape::Box { sides } => {
            let half = 0.5 * sides;
            let to_edge = |axis: usize| half[axis] - point[axis].abs();
            (0..3).filter(|&axis| axis != entry.axis).map(to_edge).fold(f64::INFINITY, f64::min)
        }
        Shape::Sphere { .. } => point.coords.abs().min(),
        _ => return 1.0,
    };
    LINE_BRIGHTNESS + (1.0 - LINE_BRIGHTNESS) * (to_line / LINE - 0.5).clamp(0.0, 1.0)
}

/// The vector from the nearest point of a capsule's axis to `point`.
fn from_axis(point: &Point3<f64>, length: f64) -> Vector3<f64> {
    let along = point.z.clamp(-0.5 * length, 0.5 * length);
    Vector3::new(point.x, point.y, point.z - along)
}

/// The slab test: the ray is inside the box between its last entry and its first exit of the three pairs of planes.
fn enter_box(ray: &Ray, half: &Vector3<f64>) -> Option<EntryPoint> {
    let Ray { origin, direction } = ray;
    let (mut enter, mut leave) = (EntryPoint { t: 0.0, axis: 0 }, f64::INFINITY);

    for axis in 0..3 {
        let (a, b) = (-half[axis] - origin[axis], half[axis] - origin[axis]);
        let (near, far) = if direction[axis].is_sign_negative() { (b, a) } else { (a, b) };
        // A direction of zero gives infinities of the right signs, or NaN on the face itself, which the comparisons below
        // leave out: the other faces decide.
        let (near, far) = (near / direction[axis], far / direction[axis]);
        if near > enter.t {
            enter = EntryPoint { t: near, axis };
        }
        leave = leave.min(far);
    }

    (enter.t > 0.0 && enter.t < leave).then_some(enter)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bodies that reach from -0.1 to 0.1 m along x.
    const ROUND_ONES_AND_A_CUBE: [Shape; 3] = [
        Shape::Sphere { radius: 0.1 },
        Shape::Capsule { radius: 0.1, length: 0.1 },
        Shape::Box { sides: Vector3::new(0.2, 0.2, 0.2) },
    ];

    /// Where the ray along +x at height `z` that starts 1 m before the body enters it.
    fn enters(shape: &Shape, z: f64) -> Option<f64> {
        let ray = Ray { origin: Point3::new(-1.0, 0.0, z), direction: Vector3::x() };
        entry(shape, &ray).map(|entry| entry.t)
    }

    #[test]
    fn a_ray_enters_spheres_and_capsules_at_their_surface_and_a_box_at_its_face() {
        let ball = Shape::Sphere { radius: 0.1 };
        assert_eq!(enters(&ball, 0.0), Some(0.9));
        let half_chord = (0.1_f64 * 0.1 - 0.06 * 0.06).sqrt();
        assert!((enters(&ball, 0.06).unwrap() - (1.0 - half_chord)).abs() < 1e-12);
        assert_eq!((enters(&ball, 0.11), enters(&ball, 0.1).is_some_and(f64::is_nan)), (None, false));

        // At the middle of its axis a capsule is a cylinder.
        let rod = Shape::Capsule { radius: 0.1, length: 0.1 };
        assert!((enters(&rod, 0.02).unwrap() - 0.9).abs() < 1e-12);
        assert_eq!((enters(&rod, 0.149).is_some(), enters(&rod, 0.151)), (true, None));

        let cube = Shape::cube(0.2);
        assert_eq!((enters(&cube, 0.06), enters(&cube, 0.11)), (Some(0.9), None));
    }

    #[test]
    fn a_ray_that_starts_beyond_or_inside_enters_nothing() {
        for shape in ROUND_ONES_AND_A_CUBE {
            for x in [0.0, 0.5] {
                let ray = Ray { origin: Point3::new(x, 0.0, 0.0), direction: Vector3::x() };
                assert!(entry(&shape, &ray).is_none(), "{shape:?} from {x}");
            }
        }
    }

    #[test]
    fn distances_and_normals_are_those_of_the_surface() {
        let point = Point3::new(0.3, 0.0, 0.0);
        for shape in ROUND_ONES_AND_A_CUBE {
            assert!((distance(&shape, &point) - 0.2).abs() < 1e-12, "{shape:?}");
            let ray = Ray { origin: point, direction: -Vector3::x() };
            let entry = entry(&shape, &ray).unwrap();
            assert_eq!(normal(&shape, &ray.at(entry.t), &entry).map(f64::round), Vector3::x(), "{shape:?}");
        }
    }
}
