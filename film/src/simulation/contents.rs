//! What is in the world of a simulation: bodies, what is fixed, joints, and how their surfaces are.

use super::Simulation;
use crate::bodies_file::{BodiesFile, DrawnPart, PlayedRecording};
use crate::body_shape::check_drawable;
use crate::part::{Part, mass_of};
use crate::playback_options::PlaybackOptions;
use crate::simulated_body::{SimulatedBody, drawn};
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use ode_visual_hull::ode::{Damping, JointKind, Shape, Surface};
use ode_visual_hull::{Error, Result};

impl Simulation {
    /// Sets friction and bounce of the contacts between virtual bodies: a friction coefficient of 0.8 and no bounce at first.
    pub fn set_body_surface(&mut self, surface: Surface) {
        self.body_surface = surface;
    }

    /// Sets friction and bounce of the contacts with the subject, the floor and what is fixed, which are alike at first.
    pub fn set_real_surface(&mut self, surface: Surface) {
        self.real_surface = surface;
    }

    /// Sets the part of their velocities that bodies lose in each step, for bodies added from now on: none at first.
    ///
    /// # Errors
    /// Numbers out of range.
    pub fn set_damping(&mut self, damping: &Damping) -> Result<()> {
        self.world.set_damping(damping)
    }

    /// Adds a body of one part at rest, of 120 kg/m3, and returns its index.
    ///
    /// # Errors
    /// A shape other than a box, a sphere or a capsule, a size that is not positive, or a pose that is not finite.
    pub fn add(&mut self, shape: &Shape, pose: &Isometry3<f64>, colour: [u8; 3]) -> Result<usize> {
        self.add_parts(&[Part::new(shape.clone(), colour)], pose)
    }

    /// Adds a rigid body of several parts at rest, whose frame has this pose, and returns its index.
    ///
    /// # Errors
    /// Parts as in [`Self::add`], a density that is not positive, or no solid part.
    pub fn add_parts(&mut self, parts: &[Part], pose: &Isometry3<f64>) -> Result<usize> {
        let mass = mass_of(parts)?;
        let mass_centre = Translation3::from(mass.center());
        let body = self.world.add_body();
        for part in parts.iter().filter(|part| part.is_solid) {
            let geom = self.world.add_geom(self.world.root_space(), &part.shape)?;
            let mut geom = self.world.geom_mut(geom);
            geom.set_body(Some(body))?;
            geom.set_offset(&(mass_centre.inverse() * part.body_from_part))?;
        }

        let placed = pose * mass_centre;
        let mut body_mut = self.world.body_mut(body);
        body_mut.set_mass(&mass.centred())?;
        body_mut.set_pose(&placed)?;
        self.bodies.push(SimulatedBody::new(parts, body, mass_centre, placed.translation.z));
        Ok(self.bodies.len() - 1)
    }

    /// Adds what does not move, in the world's frame: solid parts are collided with, others are only drawn.
    ///
    /// # Errors
    /// Parts as in [`Self::add`].
    pub fn add_fixed(&mut self, parts: &[Part]) -> Result<()> {
        for part in parts {
            check_drawable(&part.shape)?;
            if part.is_solid {
                let geom = self.world.add_geom(self.world.root_space(), &part.shape)?;
                self.world.geom_mut(geom).set_pose(&part.body_from_part)?;
            }
        }
        self.fixed.extend(drawn(parts, Isometry3::identity()));
        Ok(())
    }

    /// Puts a body, whose frame gets this pose, somewhere else, at rest.
    ///
    /// # Errors
    /// A body that does not exist, or a pose that is not finite.
    pub fn place(&mut self, index: usize, pose: &Isometry3<f64>) -> Result<()> {
        let one = self.check_index("pose", index)?;
        let (id, placed) = (one.id, pose * one.mass_centre);
        self.world.body_mut(id).set_pose(&placed)?;
        self.set_velocity(index, &Vector3::zeros())
    }

    /// Sets the velocity of a body's centre of mass in m/s, as after a throw; it does not turn any more.
    ///
    /// # Errors
    /// A body that does not exist, or a velocity that is not finite.
    pub fn set_velocity(&mut self, index: usize, velocity: &Vector3<f64>) -> Result<()> {
        let mut body = self.world.body_mut(self.check_index("velocity", index)?.id);
        body.set_linear_velocity(velocity)?;
        body.set_angular_velocity(&Vector3::zeros())?;
        body.set_enabled(true);
        Ok(())
    }

    /// The velocity in m/s of a throw from `start` that reaches `target` after so many `seconds`, if nothing is in its way.
    pub fn velocity_of_throw(&self, start: &Point3<f64>, target: &Point3<f64>, seconds: f64) -> Vector3<f64> {
        (target - start) / seconds - 0.5 * seconds * self.world.gravity()
    }

    /// Removes a body with its joints. The bodies after it move up: their indices become smaller by one, here and in all that
    /// the simulation tells from now on. A [`Log`](crate::Log) knows bodies by their indices, and must not go on.
    ///
    /// # Errors
    /// A body that does not exist.
    pub fn remove(&mut self, index: usize) -> Result<()> {
        let id = self.check_index("removal", index)?.id;
        let joints: Vec<_> = self.world.joints().collect();
        for joint in joints {
            if self.world.joint(joint).bodies().contains(&Some(id)) {
                self.world.remove_joint(joint);
            }
        }
        self.world.remove_body_and_geoms(id);
        self.bodies.remove(index);

        for one in &mut self.bodies {
            one.touched.bodies.retain(|&other| other != index);
            one.touched.bodies.iter_mut().filter(|other| **other > index).for_each(|other| *other -= 1);
        }
        self.forget_pulls_of(index);
        Ok(())
    }

    /// The body with this index, for an argument named `what`.
    pub(super) fn check_index(&self, what: &str, index: usize) -> Result<&SimulatedBody> {
        self.bodies.get(index).ok_or_else(|| {
            let count = self.bodies.len();
            Error::argument(format!("{what}: expected the index of one of {count} bodies, found {index}"))
        })
    }

    /// Joins two bodies, given by their indices, at their present poses; `None` is the world.
    ///
    /// # Errors
    /// A body that does not exist, or a joint that ODE cannot make of these bodies.
    pub fn join(&mut self, bodies: [Option<usize>; 2], kind: &JointKind) -> Result<()> {
        for index in bodies.into_iter().flatten() {
            self.check_index("joint", index)?;
        }
        self.world.add_joint(bodies.map(|index| index.map(|i| self.bodies[i].id)), kind)?;
        Ok(())
    }

    /// What bodies and fixed parts look like, to be drawn again later. `playback` tells how the recording of the subject is
    /// played, where there is one.
    pub fn bodies_file(&self, playback: Option<PlaybackOptions>) -> BodiesFile {
        let drawn = |part: &Part| DrawnPart {
            shape: part.shape.clone(),
            body_from_part: part.body_from_part,
            colour: part.colour,
        };
        BodiesFile {
            bodies: self.bodies.iter().map(|one| one.parts.iter().map(drawn).collect()).collect(),
            fixed: self.fixed.clone(),
            playback: playback.map(|options| PlayedRecording { options, motion: self.motion() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::STEPS_PER_SECOND;
    use crate::simulated_body::{GRAVITY, State, Support};
    use nalgebra::vector;
    use ode_visual_hull::hull::{HullData, Motion};
    use std::sync::Arc;

    const PIVOT: Point3<f64> = Point3::new(0.0, 0.0, 1.0);

    fn empty_world() -> Simulation {
        Simulation::new(&Arc::new(HullData::new()), 0.001, Motion::Held).unwrap()
    }

    #[test]
    fn a_body_of_two_parts_falls_as_one_that_is_where_it_was_put() {
        let mut simulation = empty_world();
        let heavy = Part::new(Shape::Sphere { radius: 0.05 }, [0; 3]).with_density(4000.0);
        let light = Part::rod(Point3::new(0.1, 0.0, 0.0), Point3::new(0.5, 0.0, 0.0), 0.02, [0; 3]);
        let pose = Isometry3::new(vector![0.3, -0.2, 2.0], vector![0.4, 0.5, 0.6]);
        simulation.add_parts(&[heavy, light], &pose).unwrap();
        assert!((simulation.states()[0].pose.to_homogeneous() - pose.to_homogeneous()).norm() < 1e-12);

        // Without contact all of it falls alike, about no axis.
        simulation.advance(0.2).unwrap();
        let fallen = simulation.states()[0].pose;
        assert!(fallen.rotation.angle_to(&pose.rotation) < 1e-9);
        let way = fallen.translation.vector - pose.translation.vector;
        assert!(way.xy().norm() < 1e-9 && way.z < -0.19, "{way}");
    }

    #[test]
    fn a_hinge_holds_a_ball_on_its_circle() {
        let mut simulation = empty_world();
        let ball = Part::new(Shape::Sphere { radius: 0.05 }, [0; 3]).with_density(1000.0);
        let body = simulation.add_parts(&[ball], &Isometry3::translation(0.4, 0.0, 1.0)).unwrap();
        let hinge = JointKind::Hinge { anchor: PIVOT, axis: Vector3::y() };
        simulation.join([Some(body), None], &hinge).unwrap();
        assert!(simulation.join([Some(1), None], &hinge).is_err());

        // At the bottom, all it has fallen by is speed.
        let mut fastest = 0.0_f64;
        for _ in 0..120 {
            simulation.advance(1.0 / STEPS_PER_SECOND).unwrap();
            let State { pose, linear_velocity, .. } = simulation.states()[0];
            // A step at 3 m/s leaves the circle by (3 / 240)^2 / (2 x 0.4), 0.2 mm, of which the ERP corrects 5 to 20 % a step.
            assert!(((pose.translation.vector - PIVOT.coords).norm() - 0.4).abs() < 2e-3);
            fastest = fastest.max(linear_velocity.norm());
        }
        // The ball's own inertia turns with it: 2 g h / (1 + 2/5 r2/h2). A step adds up to g / 240, 1.5 % of the speed.
        let expected = (2.0 * GRAVITY * 0.4 / (1.0 + 0.4 * (0.05_f64 / 0.4).powi(2))).sqrt();
        assert!((fastest / expected - 1.0).abs() < 0.02, "{fastest}, expected {expected}");
    }
    #[test]
    fn a_body_that_is_thrown_flies_on_its_parabola() {
        let mut simulation = empty_world();
        let start = Isometry3::translation(0.0, 0.0, 1.0);
        let ball = simulation.add(&Shape::Sphere { radius: 0.05 }, &start, [0; 3]).unwrap();
        let velocity = vector![2.0, -1.0, 3.0];
        simulation.set_velocity(ball, &velocity).unwrap();
        simulation.advance(0.3).unwrap();
        let expected = start.translation.vector + 0.3 * velocity - 0.5 * GRAVITY * 0.09 * Vector3::z();
        // Each step moves at the velocity of its end: g x 0.3 s x (1 / 240 s) / 2 lower, 6 mm.
        assert!((simulation.states()[0].pose.translation.vector - expected).norm() < 7e-3);
        assert!(simulation.set_velocity(ball, &Vector3::repeat(f64::NAN)).is_err());
        assert!(simulation.set_velocity(1, &velocity).unwrap_err().to_string().contains("found 1"));
    }

    #[test]
    fn a_body_that_is_put_somewhere_else_starts_from_rest_there() {
        let mut simulation = empty_world();
        let start = Isometry3::translation(0.0, 0.0, 5.0);
        let index = simulation.add(&Shape::cube(0.2), &start, [0; 3]).unwrap();
        simulation.advance(0.5).unwrap();
        simulation.place(index, &start).unwrap();
        let state = simulation.states()[0];
        assert_eq!((state.pose, state.linear_velocity), (start, Vector3::zeros()));
        assert!(simulation.place(1, &start).is_err());
    }

    #[test]
    fn after_a_removal_the_later_bodies_move_up_and_go_on() {
        let mut simulation = empty_world();
        for k in 0..3 {
            let pose = Isometry3::translation(0.0, 0.0, 0.1 + 0.2 * f64::from(k));
            simulation.add(&Shape::cube(0.2), &pose, [k as u8; 3]).unwrap();
        }
        simulation.join([Some(2), None], &JointKind::Ball { anchor: PIVOT }).unwrap();
        simulation.advance(0.2).unwrap();

        // Without the box in the middle, and without the joint of the upper one, nothing holds that up.
        simulation.remove(2).unwrap();
        assert_eq!(simulation.world.joints().count(), 0);
        simulation.add(&Shape::cube(0.2), &Isometry3::translation(0.0, 0.0, 0.5), [3; 3]).unwrap();
        simulation.advance(0.2).unwrap();
        simulation.remove(1).unwrap();
        assert_eq!(simulation.bodies().iter().map(|one| one.colour()[0]).collect::<Vec<_>>(), [0, 3]);
        simulation.advance(1.0).unwrap();
        assert_eq!(simulation.supports(), [Support::Floor; 2]);
        let height = simulation.states()[1].pose.translation.z;
        // The layer of the contacts is half a millimetre, on each of two floors of the stack.
        assert!((height - 0.3).abs() < 2e-3, "{height}");
        assert!(simulation.remove(2).unwrap_err().to_string().contains("one of 2 bodies"));
    }
}
