//! The forms that virtual bodies have, and how they look.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Ray;
#[cfg(feature = "ode")]
use ode_visual_hull::ode::Shape;

/// Half the width of the dark lines along a box's edges and around a ball, in metres.
const LINE: f64 = 0.003;

/// A body's form, about its own origin, in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// A box.
    Box {
        /// Its whole lengths.
        sides: Vector3<f64>,
    },
    /// A ball.
    Ball {
        /// Its radius.
        radius: f64,
    },
}

/// Where a ray enters a body.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entrance {
    /// Metres along the ray.
    pub(crate) t: f64,
    /// Of a box, the axis across the face.
    axis: usize,
}

impl Form {
    /// A cube.
    pub fn cube(side: f64) -> Self {
        Self::Box { sides: Vector3::repeat(side) }
    }

    /// What it is called.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Box { .. } => "box",
            Self::Ball { .. } => "ball",
        }
    }

    /// As ODE has it.
    #[cfg(feature = "ode")]
    pub fn shape(&self) -> Shape {
        match *self {
            Self::Box { sides } => Shape::Box { sides },
            Self::Ball { radius } => Shape::Sphere { radius },
        }
    }

    /// Its whole lengths along its axes.
    pub fn lengths(&self) -> Vector3<f64> {
        match *self {
            Self::Box { sides } => sides,
            Self::Ball { radius } => Vector3::repeat(2.0 * radius),
        }
    }

    /// The radius of the ball around it.
    pub(crate) fn reach(&self) -> f64 {
        match *self {
            Self::Box { sides } => (0.5 * sides).norm(),
            Self::Ball { radius } => radius,
        }
    }

    /// How far `point` is from it; 0 inside.
    pub(crate) fn distance(&self, point: &Point3<f64>) -> f64 {
        match *self {
            Self::Box { sides } => (point.coords.abs() - 0.5 * sides).map(|x| x.max(0.0)).norm(),
            Self::Ball { radius } => (point.coords.norm() - radius).max(0.0),
        }
    }

    /// Where `ray`, in the body's frame, enters it.
    pub(crate) fn entrance(&self, ray: &Ray) -> Option<Entrance> {
        match *self {
            Self::Box { sides } => enter_box(ray, &(0.5 * sides)),
            Self::Ball { radius } => {
                let along = ray.origin.coords.dot(&ray.direction);
                let root = (along * along - ray.origin.coords.norm_squared() + radius * radius).sqrt();
                // A miss is NaN, and no greater than 0.
                let t = -along - root;
                (t > 0.0).then_some(Entrance { t, axis: 0 })
            }
        }
    }

    /// The outward normal where a ray enters, `point` in the body's frame.
    pub(crate) fn normal(&self, point: &Point3<f64>, entrance: &Entrance) -> Vector3<f64> {
        match self {
            Self::Box { .. } => {
                let mut normal = Vector3::zeros();
                normal[entrance.axis] = point[entrance.axis].signum();
                normal
            }
            Self::Ball { radius } => point.coords / *radius,
        }
    }

    /// What is left of the colour where a ray enters: dark lines, with a soft side, show edges and how a ball rolls.
    pub(crate) fn line(&self, point: &Point3<f64>, entrance: &Entrance) -> f64 {
        let to_line = match *self {
            Self::Box { sides } => {
                let half = 0.5 * sides;
                let to_edge = |axis: usize| half[axis] - point[axis].abs();
                (0..3).filter(|&axis| axis != entrance.axis).map(to_edge).fold(f64::INFINITY, f64::min)
            }
            Self::Ball { .. } => point.coords.abs().min(),
        };
        0.45 + 0.55 * (to_line / LINE - 0.5).clamp(0.0, 1.0)
    }
}

fn enter_box(ray: &Ray, half: &Vector3<f64>) -> Option<Entrance> {
    let Ray { origin, direction } = ray;
    let (mut enter, mut leave) = (Entrance { t: 0.0, axis: 0 }, f64::INFINITY);
    for axis in 0..3 {
        let (a, b) = (-half[axis] - origin[axis], half[axis] - origin[axis]);
        let (near, far) = if direction[axis].is_sign_negative() { (b, a) } else { (a, b) };
        // A direction of zero gives infinities of the right signs, or NaN on the face itself, which is a miss.
        let (near, far) = (near / direction[axis], far / direction[axis]);
        if near > enter.t {
            enter = Entrance { t: near, axis };
        }
        leave = leave.min(far);
    }
    (enter.t > 0.0 && enter.t < leave).then_some(enter)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of the ray along +x at height `z` that starts 1 m before the body.
    fn enters(form: Form, z: f64) -> Option<f64> {
        let ray = Ray { origin: Point3::new(-1.0, 0.0, z), direction: Vector3::x() };
        form.entrance(&ray).map(|entrance| entrance.t)
    }

    #[test]
    fn a_ray_enters_a_ball_at_its_surface_and_a_box_at_its_face() {
        let ball = Form::Ball { radius: 0.1 };
        assert_eq!(enters(ball, 0.0), Some(0.9));
        let half_chord = (0.1_f64 * 0.1 - 0.06 * 0.06).sqrt();
        assert!((enters(ball, 0.06).unwrap() - (1.0 - half_chord)).abs() < 1e-12);
        assert_eq!((enters(ball, 0.11), enters(ball, 0.1).is_some_and(f64::is_nan)), (None, false));
        assert_eq!((enters(Form::cube(0.2), 0.06), enters(Form::cube(0.2), 0.11)), (Some(0.9), None));
    }

    #[test]
    fn a_ray_that_starts_beyond_or_inside_enters_nothing() {
        for form in [Form::Ball { radius: 0.1 }, Form::cube(0.2)] {
            for x in [0.0, 0.5] {
                let ray = Ray { origin: Point3::new(x, 0.0, 0.0), direction: Vector3::x() };
                assert!(form.entrance(&ray).is_none(), "{form:?} from {x}");
            }
        }
    }

    #[test]
    fn distances_and_normals_are_those_of_the_surface() {
        let point = Point3::new(0.3, 0.0, 0.0);
        for form in [Form::Ball { radius: 0.1 }, Form::cube(0.2)] {
            assert!((form.distance(&point) - 0.2).abs() < 1e-12, "{form:?}");
            let ray = Ray { origin: point, direction: -Vector3::x() };
            let entrance = form.entrance(&ray).unwrap();
            assert_eq!(form.normal(&ray.at(entrance.t), &entrance).map(f64::round), Vector3::x(), "{form:?}");
        }
    }
}
