//! A world of ODE with the hull, a floor, and virtual bodies.

use crate::body_shape::check_drawable;
use crate::compositor::Drawn;
use crate::part::{Part, mass_of};
use crate::simulated_body::{GRAVITY, SimulatedBody, State, Support, Touched, drawn};
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::hull::{Hull, HullData, Motion};
use ode_visual_hull::ode::{Damping, GeomId, JointKind, Ode, Shape, Surface, Swept, World};
use ode_visual_hull::{Error, Result};
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

/// Steps of the simulation a second.
pub const STEPS_PER_SECOND: f64 = 240.0;

/// Coefficient of friction between all surfaces.
const FRICTION: f64 = 0.8;

/// Limit of the contacts of a pair.
const MAX_CONTACTS: usize = 8;

/// Thinnest feature of the subject that must not pass through a body, in metres; small, because noisy masks make
/// features thinner.
const MIN_FEATURE: f64 = 0.015;

/// A world with its bodies.
#[derive(Debug)]
pub struct Simulation {
    world: World,
    hull: GeomId,
    bodies: Vec<SimulatedBody>,
    /// What is drawn and does not move.
    fixed: Vec<Drawn>,
    /// Of contacts between bodies, and of all others.
    body_surface: Surface,
    real_surface: Surface,
    /// When bodies that touch the hull stick to it, in seconds.
    held: Vec<Range<f64>>,
    time: f64,
    collided_at: Instant,
}

impl Simulation {
    /// A world with the hull of `data`, shown in `motion` at the world's time, and a floor at z = 0; `pixel_size` is the
    /// size of a pixel at the subject, in metres. The world's time begins with 0, on the clock of the frames.
    ///
    /// # Errors
    /// ODE is missing.
    pub fn new(data: &Arc<HullData>, pixel_size: f64, motion: Motion) -> Result<Self> {
        let mut world = World::new(&Ode::init()?)?;
        world.set_gravity(&vector![0.0, 0.0, -GRAVITY])?;
        world.set_erp(erp(motion))?;
        world.set_cfm(1e-5)?;
        world.set_quick_step_iterations(50)?;

        // Edges of live masks flicker by up to a pixel. A layer of half a pixel keeps contacts steady.
        world.set_contact_surface_layer(0.5 * pixel_size)?;

        let root = world.root_space();
        world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 })?;
        let hull = world.add_hull(root, data)?;
        world.hull_mut(hull).set_min_feature(MIN_FEATURE)?;
        world.hull_mut(hull).set_motion(motion);
        let surface = Surface::with_friction(FRICTION);
        Ok(Self {
            world,
            hull,
            bodies: Vec::new(),
            fixed: Vec::new(),
            body_surface: surface,
            real_surface: surface,
            held: Vec::new(),
            time: 0.0,
            collided_at: Instant::now(),
        })
    }

    /// Sets whether the hull collides with what it will meet within the next step; it does not at first.
    pub fn set_swept(&mut self, swept: Swept) {
        self.world.hull_mut(self.hull).set_swept(swept);
    }

    /// Sets when bodies that touch the hull stick to it, in seconds of the world's time; never, at first.
    pub fn hold_during(&mut self, times: &[Range<f64>]) {
        self.held = times.to_vec();
    }

    /// Takes the first body that did not stick to the hull, or the first thing that was left out of a sweep, since the last call.
    pub fn take_left_out(&self) -> Option<Error> {
        self.world.hull(self.hull).take_left_out()
    }

    /// Sets the diameter of the thinnest feature of the subject that must not pass through a body, in metres: 0.015 at first,
    /// since noisy masks make features thinner.
    ///
    /// # Errors
    /// A diameter that is not positive.
    pub fn set_min_feature(&mut self, diameter: f64) -> Result<()> {
        self.world.hull_mut(self.hull).set_min_feature(diameter)
    }

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

    /// Simulates `duration` seconds.
    ///
    /// # Errors
    /// A body that cannot be collided with the hull, or whose position is no longer finite.
    pub fn advance(&mut self, duration: f64) -> Result<()> {
        let steps = (duration * STEPS_PER_SECOND).round().max(1.0);
        let dt = duration / steps;

        for _ in 0..steps as u32 {
            self.step(dt)?;
        }
        Ok(())
    }

    /// Simulates one step of `dt` seconds.
    ///
    /// # Errors
    /// As [`Self::advance`].
    pub fn step(&mut self, dt: f64) -> Result<()> {
        self.collide(dt)?;
        self.collided_at = Instant::now();
        self.world.quick_step(dt)?;
        self.time += dt;
        for one in &mut self.bodies {
            let body = self.world.body(one.id);
            one.record_speed(body.linear_velocity().norm(), body.position().z);
        }
        match self.world.hull(self.hull).take_error() {
            Some(error) => Err(error),
            None => self.check_finite(),
        }
    }

    /// Lets `seconds` pass without a step, for a simulation that is late.
    pub fn skip(&mut self, seconds: f64) {
        self.time += seconds;
    }

    /// When the last collide ended.
    pub fn collided_at(&self) -> Instant {
        self.collided_at
    }

    /// Whether a body touched the hull in the last step.
    pub fn touches_hull(&self) -> bool {
        self.bodies.iter().any(|one| one.touched.hull)
    }

    /// Which hull the bodies collide with at the simulation's time.
    pub fn motion(&self) -> Motion {
        self.world.hull(self.hull).motion()
    }

    /// Collides before a step of `dt` seconds: adds contacts for every pair with a body, and records what each body
    /// touches.
    fn collide(&mut self, dt: f64) -> Result<()> {
        let Self { world, hull, bodies, held, body_surface, real_surface, time, .. } = self;
        for one in bodies.iter_mut() {
            one.touched = Touched::default();
        }

        // Contacts with the hull carry the speed of the real surface.
        world.hull_mut(*hull).set_time(*time)?;
        world.hull_mut(*hull).hold(held.iter().any(|times| times.contains(time)));
        world.collide(|pair| {
            if pair.are_connected_excluding_contact() {
                return;
            }
            let is_between_bodies = pair.bodies().iter().all(Option::is_some);
            let surface = if is_between_bodies { *body_surface } else { *real_surface };
            let contacts = pair.contacts(MAX_CONTACTS);
            for contact in contacts.iter() {
                pair.attach(contact, &pair.surface_at(contact, &surface, dt));
            }
            if contacts.is_empty() {
                return;
            }

            // Both bodies of the pair record what they touch.
            let of_body = |body| bodies.iter().position(|one| one.id == body);
            let [first, second] = pair.bodies().map(|body| body.and_then(of_body));
            let depth = contacts.iter().map(|contact| contact.depth).fold(0.0, f64::max);
            for (own, other) in [(first, second), (second, first)] {
                let Some(one) = own.and_then(|own| bodies.get_mut(own)) else { continue };
                one.first_contact.get_or_insert(*time);
                one.touched.bodies.extend(other);
                if pair.geoms().contains(hull) {
                    one.touched.hull = true;
                    one.deepest = one.deepest.max(depth);
                } else if other.is_none() {
                    one.touched.floor = true;
                }
            }
        })?;

        // What sticks to the hull has no contacts with it.
        let hull = world.hull(*hull);
        for one in bodies.iter_mut().filter(|one| hull.holds(one.id)) {
            one.first_contact.get_or_insert(*time);
            one.touched.hull = true;
        }
        Ok(())
    }

    fn check_finite(&self) -> Result<()> {
        let lost = self.states().iter().position(|state| !state.pose.translation.vector.norm().is_finite());
        lost.map_or(Ok(()), |i| {
            Err(Error::Ode(format!("body {}: expected a finite position, found none; the simulation has diverged: lower the bodies' \
                 speed", i + 1)))
        })
    }

    /// The bodies.
    pub fn bodies(&self) -> &[SimulatedBody] {
        &self.bodies
    }

    /// The hull that the bodies collided with last; `None` before the first step.
    pub fn hull(&self) -> Option<Arc<Hull>> {
        self.world.hull(self.hull).frame()
    }

    /// Simulated time, in seconds.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Poses and velocities of the bodies.
    pub fn states(&self) -> Vec<State> {
        let state = |one: &SimulatedBody| {
            let body = self.world.body(one.id);
            State {
                pose: body.pose() * one.mass_centre.inverse(),
                linear_velocity: body.linear_velocity(),
                angular_velocity: body.angular_velocity(),
            }
        };
        self.bodies.iter().map(state).collect()
    }

    /// What supports each body, directly or through others. A body on both subject and floor counts as on the subject.
    pub fn supports(&self) -> Vec<Support> {
        // Support spreads from body to body, by one contact in each round.
        let mut supports: Vec<_> = self.bodies.iter().map(|one| Support::of(&one.touched)).collect();
        for _ in 0..self.bodies.len() {
            for (i, one) in self.bodies.iter().enumerate() {
                for &below in &one.touched.bodies {
                    if supports[i] == Support::Nothing {
                        supports[i] = supports[below];
                    }
                }
            }
        }

        supports
    }

    /// The bodies, and what is fixed, as they are drawn.
    pub fn drawn(&self) -> Vec<Drawn> {
        let of_body = |(one, state): (_, State)| {
            let one: &SimulatedBody = one;
            drawn(&one.parts, state.pose)
        };
        let bodies = self.bodies.iter().zip(self.states()).flat_map(of_body);
        bodies.chain(self.fixed.iter().cloned()).collect()
    }

    /// The number of bodies on each support, for the progress bar.
    pub fn summary(&self) -> String {
        let supports = self.supports();
        let count = |kind| supports.iter().filter(|&&support| support == kind).count();
        format!(
            "{} up, {} in the air, {} on the floor",
            count(Support::Subject),
            count(Support::Nothing),
            count(Support::Floor)
        )
    }
}

/// The part of a contact's depth that a step corrects. A surface that jumps from frame to frame moves bodies by this
/// correction alone. One that moves gives them its speed, and a correction would add to it: with 0.05 a pushed box
/// leaves at the surface's speed or little more.
fn erp(motion: Motion) -> f64 {
    if motion == Motion::Held { 0.2 } else { 0.05 }
}

/// The angle in degrees between the vertical and the axis of the body that is nearest to it.
pub fn lean_deg(rotation: &UnitQuaternion<f64>) -> f64 {
    let up = rotation.inverse_transform_vector(&Vector3::z());
    up.amax().clamp(-1.0, 1.0).acos().to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Point3;

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
            assert!(((pose.translation.vector - PIVOT.coords).norm() - 0.4).abs() < 2e-3);
            fastest = fastest.max(linear_velocity.norm());
        }
        // The ball's own inertia turns with it: 2 g h / (1 + 2/5 r2/h2).
        let expected = (2.0 * GRAVITY * 0.4 / (1.0 + 0.4 * (0.05_f64 / 0.4).powi(2))).sqrt();
        assert!((fastest / expected - 1.0).abs() < 0.02, "{fastest}, expected {expected}");
    }
}
