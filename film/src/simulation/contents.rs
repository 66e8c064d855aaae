//! What is in the world of a simulation: bodies, what is fixed, joints, and how their surfaces are.

use super::Simulation;
use crate::bodies_file::{BodiesFile, DrawnPart, PlayedRecording};
use crate::body_shape::check_drawable;
use crate::part::{Part, mass_of};
use crate::playback_options::PlaybackOptions;
use crate::simulated_body::{SimulatedBody, drawn};
use nalgebra::{Isometry3, Translation3};
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

    /// Joins two bodies, given by their indices, at their present poses; `None` is the world.
    ///
    /// # Errors
    /// A body that does not exist, or a joint that ODE cannot make of these bodies.
    pub fn join(&mut self, bodies: [Option<usize>; 2], kind: &JointKind) -> Result<()> {
        let count = self.bodies.len();
        if let Some(index) = bodies.into_iter().flatten().find(|&index| index >= count) {
            return Err(Error::argument(format!(
                "joint: expected the index of one of {count} bodies, found {index}"
            )));
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
    use crate::simulated_body::{GRAVITY, State};
    use nalgebra::{Point3, Vector3, vector};
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
}
