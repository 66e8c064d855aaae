//! Bodies that are taken by a point, as with a mouse, and pulled to another place.
//!
//! ```text
//!   ray ──► pick ──► body and point ──► pull before each step: a damped spring from the point to the target
//! ```

use super::Simulation;
use crate::ray_cast;
use crate::simulated_body::GRAVITY;
use nalgebra::{Matrix3, Point3, Vector3};
use ode_visual_hull::camera::Ray;
use ode_visual_hull::ode::Body;
use ode_visual_hull::{Error, Result};

/// Angular frequency of the spring at the body's mass, in rad/s: the point is at its target after about 0.2 s.
const FREQUENCY: f64 = 25.0;

/// Largest acceleration that a pull gives a body's centre besides that which holds it up, in m/s2.
const MAX_ACCELERATION: f64 = 150.0;

/// How fast a body that is pulled stops turning, in 1/s, about the point: it swings from there once or twice.
const TURN_DAMPING: f64 = 6.0;

/// A body that is pulled in the next step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pull {
    body: usize,
    /// The point that is pulled, in the body's frame.
    from: Point3<f64>,
    /// Where to, in the world.
    to: Point3<f64>,
}

impl Simulation {
    /// The index of the virtual body that `ray` meets first, and the point where it does, in the world. The subject is not
    /// looked at: a picture tells whether it is in front.
    pub fn pick(&self, ray: &Ray) -> Option<(usize, Point3<f64>)> {
        let mut nearest: Option<(usize, f64)> = None;
        for (index, (one, state)) in self.bodies.iter().zip(self.states()).enumerate() {
            for part in &one.parts {
                let part_from_world = (state.pose * part.body_from_part).inverse();
                let in_part =
                    Ray { origin: part_from_world * ray.origin, direction: part_from_world * ray.direction };
                let Some(entry) = ray_cast::entry(&part.shape, &in_part) else { continue };
                if nearest.is_none_or(|(_, t)| entry.t < t) {
                    nearest = Some((index, entry.t));
                }
            }
        }
        nearest.map(|(index, t)| (index, ray.at(t)))
    }

    /// Pulls a body in the next step by the point `from`, in the body's frame (see [`State::pose`](crate::State::pose)),
    /// towards the point `to`, in the world. To be called before each step while the body is held; it hangs from the point.
    ///
    /// The pull is a critically damped spring of 25 rad/s at the body's mass, so that all bodies follow alike, at up to 3 m/s.
    /// It accelerates a body by 150 m/s2 at most, besides what holds up its weight.
    ///
    /// # Errors
    /// A body that does not exist, or a point that is not finite.
    pub fn pull(&mut self, body: usize, from: &Point3<f64>, to: &Point3<f64>) -> Result<()> {
        self.check_index("pull", body)?;
        if let Some(point) = [from, to].into_iter().find(|point| !point.iter().all(|x| x.is_finite())) {
            return Err(Error::argument(format!("pull of a body: expected finite points, found {point}")));
        }
        self.pulls.push(Pull { body, from: *from, to: *to });
        Ok(())
    }

    /// Adds the forces of the pulls in a step of `dt` seconds, which are forgotten then.
    pub(super) fn apply_pulls(&mut self, dt: f64) -> Result<()> {
        let states = if self.pulls.is_empty() { Vec::new() } else { self.states() };
        for pull in self.pulls.drain(..) {
            let Some((one, state)) = self.bodies.get(pull.body).zip(states.get(pull.body)) else { continue };
            let point = state.pose * pull.from;
            let body = self.world.body(one.id);
            let force = force(&body, &point, &(pull.to - point), dt);
            let torque = damping_torque(&body, &point, dt);
            let mut body = self.world.body_mut(one.id);
            body.set_enabled(true);
            body.add_force_at(&force, &point)?;
            body.add_torque(&torque)?;
        }
        Ok(())
    }

    /// Forgets the pulls of a body that was removed; those after it have moved up.
    pub(super) fn forget_pulls_of(&mut self, removed: usize) {
        self.pulls.retain(|pull| pull.body != removed);
        self.pulls.iter_mut().filter(|pull| pull.body > removed).for_each(|pull| pull.body -= 1);
    }
}

/// The force at `point` that moves it along `way`, in N. The spring's force is that at the end of the step, so that it is
/// stable however long the step is and wherever the point lies in the body.
fn force(body: &Body<'_>, point: &Point3<f64>, way: &Vector3<f64>, dt: f64) -> Vector3<f64> {
    let mass = body.mass().total();
    let most = MAX_ACCELERATION * mass;
    let (stiffness, damping) = (mass * FREQUENCY * FREQUENCY, 2.0 * mass * FREQUENCY);

    // A spring that is longer pulls no more: otherwise the body would be too fast to be stopped at its target.
    let way = way.cap_magnitude(most / stiffness);
    let velocity = body.velocity_at(point);
    let wanted = stiffness * (way - dt * velocity) - damping * velocity;

    // F = wanted - (damping + dt stiffness) dt M F, where M F is the acceleration that F gives the point.
    let implicit = Matrix3::identity() + (damping + dt * stiffness) * dt * mobility(body, point);
    let force = implicit.cholesky().map_or(wanted, |implicit| implicit.solve(&wanted));
    force.cap_magnitude(most) + Vector3::z() * mass * GRAVITY
}

/// The acceleration of a body's material point that a force there brings, as a matrix in 1/kg.
fn mobility(body: &Body<'_>, point: &Point3<f64>) -> Matrix3<f64> {
    let arm = (point - body.position()).cross_matrix();
    let turned = inertia(body).try_inverse().map_or(Matrix3::zeros(), |inverse| arm * inverse * arm);
    Matrix3::identity() / body.mass().total() - turned
}

/// The torque that slows the body's turning about `point`, in N m, that of the end of the step as in [`force`].
fn damping_torque(body: &Body<'_>, point: &Point3<f64>, dt: f64) -> Vector3<f64> {
    let arm = (point - body.position()).cross_matrix();
    let own = inertia(body);
    let damping = TURN_DAMPING * (own - body.mass().total() * arm * arm);
    let implicit =
        own.try_inverse().and_then(|inverse| (Matrix3::identity() + dt * damping * inverse).try_inverse());
    implicit.map_or(Vector3::zeros(), |implicit| -implicit * damping * body.angular_velocity())
}

/// The body's inertia about its centre of mass in the world's frame, in kg m2.
fn inertia(body: &Body<'_>) -> Matrix3<f64> {
    let turn = body.pose().rotation.to_rotation_matrix();
    turn.matrix() * body.mass().inertia() * turn.matrix().transpose()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::STEPS_PER_SECOND;
    use crate::part::Part;
    use nalgebra::{Isometry3, vector};
    use ode_visual_hull::hull::{HullData, Motion};
    use ode_visual_hull::ode::Shape;
    use std::sync::Arc;

    const DT: f64 = 1.0 / STEPS_PER_SECOND;
    const CORNER: Point3<f64> = Point3::new(0.1, 0.1, 0.1);

    fn empty_world() -> Simulation {
        Simulation::new(&Arc::new(HullData::new()), 0.001, Motion::Held).unwrap()
    }

    /// A box of this density in kg/m3 that lies on the floor.
    fn box_on_floor(density: f64) -> Simulation {
        let mut simulation = empty_world();
        let part = Part::new(Shape::cube(0.2), [0; 3]).with_density(density);
        simulation.add_parts(&[part], &Isometry3::translation(0.0, 0.0, 0.1)).unwrap();
        simulation
    }

    /// Where the point `from` of the body is after each step of 4 seconds in which it is pulled to `to`.
    fn pulled(simulation: &mut Simulation, from: Point3<f64>, to: Point3<f64>, dt: f64) -> Vec<Point3<f64>> {
        let step = |_| {
            simulation.pull(0, &from, &to).unwrap();
            simulation.step(dt).unwrap();
            simulation.states()[0].pose * from
        };
        (0..(4.0 / dt) as u32).map(step).collect()
    }

    #[test]
    fn a_box_that_is_pulled_up_ends_at_the_target_at_rest() {
        for from in [Point3::origin(), CORNER] {
            let (mut simulation, to) = (box_on_floor(120.0), Point3::new(0.3, 0.1, 0.9));
            let way = pulled(&mut simulation, from, to, DT);
            // What remains of a swing about the corner after 4 s is exp(-6 x 4 / 2), 6 millionths.
            assert!((way.last().unwrap() - to).norm() < 1e-3, "{from}: {}", way.last().unwrap());
            let state = simulation.states()[0];
            assert!(state.linear_velocity.norm() < 2e-3 && state.angular_velocity.norm() < 2e-2, "{state:?}");

            // It hangs: the centre of mass is straight below.
            let below = state.pose * from - state.pose.translation.vector;
            assert!(below.coords.xy().norm() < 2e-3, "{from}: {below}");
        }
    }

    #[test]
    fn the_mass_of_a_body_that_is_pulled_does_not_matter() {
        let to = Point3::new(0.3, 0.1, 0.9);
        let [light, heavy] = [10.0, 10_000.0].map(|density| {
            let mut simulation = box_on_floor(density);
            simulation.add(&Shape::cube(0.1), &Isometry3::translation(3.0, 0.0, 0.05), [0; 3]).unwrap();
            pulled(&mut simulation, CORNER, to, DT)
        });
        // They leave the floor, whose contacts are a little softer for light bodies, a fraction of a millimetre apart.
        let apart = light.iter().zip(&heavy).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 5e-3, "{apart}");
    }

    #[test]
    fn a_far_target_is_reached_at_a_bounded_speed_and_not_overshot() {
        // At 240 and at 30 steps a second.
        for dt in [DT, 1.0 / 30.0] {
            let mut simulation = box_on_floor(120.0);
            let way = pulled(&mut simulation, Point3::origin(), Point3::new(0.0, 0.0, 6.0), dt);
            let fastest = way.windows(2).map(|pair| (pair[1].z - pair[0].z) / dt).fold(0.0, f64::max);
            assert!((2.0..3.01).contains(&fastest), "{fastest}");
            // A critically damped spring does not overshoot; gravity within a step may lift by g dt2.
            assert!(way.iter().all(|point| point.z < 6.0 + GRAVITY * dt * dt), "{dt}");
        }
    }

    #[test]
    fn a_body_that_is_let_go_falls_and_pulls_that_make_no_sense_are_refused() {
        let mut simulation = box_on_floor(120.0);
        let to = Point3::new(0.0, 0.0, 0.8);
        pulled(&mut simulation, Point3::origin(), to, DT);
        simulation.advance(0.2).unwrap();
        assert!(simulation.states()[0].pose.translation.z < 0.8 - 0.18);
        assert!(simulation.pull(1, &Point3::origin(), &to).unwrap_err().to_string().contains("found 1"));
        let nowhere = Point3::new(0.0, f64::NAN, 0.0);
        assert!(simulation.pull(0, &Point3::origin(), &nowhere).is_err());
    }

    #[test]
    fn the_nearest_part_that_a_ray_meets_is_picked() {
        let mut simulation = empty_world();
        let ball = Part::new(Shape::Sphere { radius: 0.1 }, [0; 3]);
        let dumbbell = [
            ball.clone().at(Isometry3::translation(-0.5, 0.0, 0.0)),
            ball.at(Isometry3::translation(0.5, 0.0, 0.0)),
        ];
        simulation.add(&Shape::cube(0.2), &Isometry3::translation(0.0, 0.0, 1.0), [0; 3]).unwrap();
        let quarter = vector![0.0, 0.0, std::f64::consts::FRAC_PI_2];
        simulation.add_parts(&dumbbell, &Isometry3::new(vector![2.0, 0.0, 1.0], quarter)).unwrap();

        let towards_x = |y: f64| Ray { origin: Point3::new(-3.0, y, 1.0), direction: Vector3::x() };
        let (index, point) = simulation.pick(&towards_x(0.05)).unwrap();
        assert!(index == 0 && (point - Point3::new(-0.1, 0.05, 1.0)).norm() < 1e-9, "{index}, {point}");
        for y in [-0.5, 0.5] {
            let (index, point) = simulation.pick(&towards_x(y)).unwrap();
            assert!(index == 1 && (point - Point3::new(1.9, y, 1.0)).norm() < 1e-9, "{y}: {index}, {point}");
        }
        assert_eq!(simulation.pick(&towards_x(0.25)), None);
        let from_behind = Ray { origin: Point3::new(3.0, 0.05, 1.0), direction: -Vector3::x() };
        assert_eq!(simulation.pick(&from_behind).map(|(index, _)| index), Some(0));
    }
}
