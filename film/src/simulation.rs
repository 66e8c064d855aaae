//! A world of ODE with the hull, a floor, and virtual bodies.

mod contents;
mod hull_contacts;
mod pull;

pub use hull_contacts::HullContact;

use crate::capture::STEPS_PER_SECOND;
use crate::compositor::Drawn;
use crate::simulated_body::{GRAVITY, SimulatedBody, State, Support, Touched, drawn};
use nalgebra::{UnitQuaternion, Vector3, vector};
use ode_visual_hull::hull::{Hull, HullData, Motion};
use ode_visual_hull::ode::{GeomId, Ode, Shape, Surface, Swept, World};
use ode_visual_hull::{Error, Result};
use pull::Pull;
use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

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
    /// Of the last step.
    hull_contacts: Vec<HullContact>,
    /// Of the next step.
    pulls: Vec<Pull>,
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
            hull_contacts: Vec::new(),
            pulls: Vec::new(),
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
        self.apply_pulls(dt)?;
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

    /// Warps the silhouettes for the next step, in the time until that step is due: it is the longest part of a step with a hull
    /// that moves. The step finds them, unless the masks around its time have changed meanwhile.
    pub fn prepare_step(&self) {
        let hull = self.world.hull(self.hull);
        let (data, motion) = (hull.data(), hull.motion());
        if motion != Motion::Held {
            // What is wrong is told by the step.
            let _ = data.prepare_motion(motion, self.time);
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
        let Self { world, hull, bodies, hull_contacts, held, body_surface, real_surface, time, .. } = self;
        hull_contacts.clear();
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
                    hull_contacts.extend(contacts.iter().map(|contact| HullContact::new(contact, *hull)));
                } else if other.is_none() {
                    one.touched.floor = true;
                }
            }
        })?;

        // What sticks to the hull has no contacts with it.
        let hull = world.hull(*hull);
        hull_contacts.iter_mut().for_each(|contact| contact.find_velocity(&hull));
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
