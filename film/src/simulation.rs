//! A world of ODE with the hull, a floor, and virtual bodies.

use crate::body_shape::check_drawable;
use crate::compositor::Drawn;
use nalgebra::{Isometry3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::hull::{Hull, HullData, Motion};
use ode_visual_hull::ode::{Amount, BodyId, GeomId, Mass, Ode, Shape, Surface, Swept, World};
use ode_visual_hull::{Error, Result};
use std::sync::Arc;
use std::time::Instant;

/// Steps of the simulation a second.
pub const STEPS_PER_SECOND: f64 = 240.0;

/// Acceleration of falling bodies, in m/s2.
const GRAVITY: f64 = 9.81;

/// A body slower than this, in m/s, is at rest.
pub(crate) const AT_REST: f64 = 0.02;

/// Density of the bodies in kg/m3, about that of a parcel.
const DENSITY: f64 = 120.0;

/// Coefficient of friction between all surfaces.
const FRICTION: f64 = 0.8;

/// Limit of the contacts of a pair.
const MAX_CONTACTS: usize = 8;

/// Thinnest feature of the subject that must not pass through a body, in metres; small, because noisy masks make
/// features thinner.
const MIN_FEATURE: f64 = 0.015;

/// A virtual body.
#[derive(Debug, Clone)]
pub struct SimulatedBody {
    /// A box or a sphere.
    pub shape: Shape,
    /// Red, green, blue.
    pub colour: [u8; 3],
    body: BodyId,
    touched: Touched,
    /// Largest depth in the hull so far, in metres.
    pub deepest: f64,
    /// Time of its first contact, in seconds.
    pub first_contact: Option<f64>,
    /// Largest speed since then, in m/s.
    pub fastest_after_contact: f64,
    /// Largest speed since then without what it gained by falling, in m/s: the speed that it would have at the greatest
    /// height since it was last at rest.
    pub fastest_without_fall: f64,
    /// That height, in metres.
    highest: f64,
}

/// What a body touched in the last step.
#[derive(Debug, Clone, Default)]
struct Touched {
    hull: bool,
    floor: bool,
    /// Other bodies, by index.
    bodies: Vec<usize>,
}

/// Pose and velocity of a body.
#[derive(Debug, Clone, Copy)]
pub struct State {
    /// World from body.
    pub pose: Isometry3<f64>,
    /// In m/s.
    pub linear_velocity: Vector3<f64>,
    /// In rad/s, in the world.
    pub angular_velocity: Vector3<f64>,
}

/// What supports a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// The real subject, directly or through other bodies.
    Subject,
    /// The floor, directly or through other bodies.
    Floor,
    /// Nothing: the body falls.
    Nothing,
}

impl SimulatedBody {
    /// Records the speed in m/s and the height in metres after a step.
    fn record_speed(&mut self, speed: f64, height: f64) {
        self.highest = if speed < AT_REST { height } else { self.highest.max(height) };
        if self.first_contact.is_some() {
            let by_falling = 2.0 * GRAVITY * (self.highest - height);
            let without_fall = (speed * speed - by_falling).max(0.0).sqrt();
            self.fastest_without_fall = self.fastest_without_fall.max(without_fall);
            self.fastest_after_contact = self.fastest_after_contact.max(speed);
        }
    }
}

/// A world with its bodies.
#[derive(Debug)]
pub struct Simulation {
    world: World,
    hull: GeomId,
    floor: GeomId,
    bodies: Vec<SimulatedBody>,
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
        let floor = world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 })?;
        let hull = world.add_hull(root, data)?;
        world.hull_mut(hull).set_min_feature(MIN_FEATURE)?;
        world.hull_mut(hull).set_motion(motion);
        Ok(Self { world, hull, floor, bodies: Vec::new(), time: 0.0, collided_at: Instant::now() })
    }

    /// Sets whether the hull collides with what it will meet within the next step; it does not at first.
    pub fn set_swept(&mut self, swept: Swept) {
        self.world.hull_mut(self.hull).set_swept(swept);
    }

    /// Sets the diameter of the thinnest feature of the subject that must not pass through a body, in metres: 0.015 at first,
    /// since noisy masks make features thinner.
    ///
    /// # Errors
    /// A diameter that is not positive.
    pub fn set_min_feature(&mut self, diameter: f64) -> Result<()> {
        self.world.hull_mut(self.hull).set_min_feature(diameter)
    }

    /// Adds a body at rest.
    ///
    /// # Errors
    /// A shape other than a box or a sphere, a size that is not positive, or a pose that is not finite.
    pub fn add(&mut self, shape: &Shape, pose: &Isometry3<f64>, colour: [u8; 3]) -> Result<()> {
        check_drawable(shape)?;
        let body = self.world.add_body();
        let geom = self.world.add_geom(self.world.root_space(), shape)?;
        self.world.geom_mut(geom).set_body(Some(body))?;

        let mut body_mut = self.world.body_mut(body);
        body_mut.set_mass(&Mass::of(shape, Amount::Density(DENSITY))?)?;
        body_mut.set_pose(pose)?;
        self.bodies.push(SimulatedBody {
            shape: shape.clone(),
            colour,
            body,
            touched: Touched::default(),
            deepest: 0.0,
            first_contact: None,
            fastest_after_contact: 0.0,
            fastest_without_fall: 0.0,
            highest: pose.translation.z,
        });

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
            let body = self.world.body(one.body);
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
        let Self { world, hull, floor, bodies, time, .. } = self;
        for one in bodies.iter_mut() {
            one.touched = Touched::default();
        }

        // Contacts with the hull carry the speed of the real surface.
        world.hull_mut(*hull).set_time(*time)?;
        let surface = Surface::with_friction(FRICTION);
        world.collide(|pair| {
            let contacts = pair.contacts(MAX_CONTACTS);
            for contact in contacts.iter() {
                pair.attach(contact, &pair.surface_at(contact, &surface, dt));
            }
            if contacts.is_empty() {
                return;
            }

            // Both bodies of the pair record what they touch.
            let of_body = |body| bodies.iter().position(|one| one.body == body);
            let [first, second] = pair.bodies().map(|body| body.and_then(of_body));
            let depth = contacts.iter().map(|contact| contact.depth).fold(0.0, f64::max);
            for (own, other) in [(first, second), (second, first)] {
                let Some(one) = own.and_then(|own| bodies.get_mut(own)) else { continue };
                one.first_contact.get_or_insert(*time);
                one.touched.bodies.extend(other);
                one.touched.floor |= pair.geoms().contains(floor);
                if pair.geoms().contains(hull) {
                    one.touched.hull = true;
                    one.deepest = one.deepest.max(depth);
                }
            }
        })
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
            let body = self.world.body(one.body);
            State {
                pose: body.pose(),
                linear_velocity: body.linear_velocity(),
                angular_velocity: body.angular_velocity(),
            }
        };
        self.bodies.iter().map(state).collect()
    }

    /// What supports each body, directly or through others. A body on both subject and floor counts as on the subject.
    pub fn supports(&self) -> Vec<Support> {
        let direct = |one: &SimulatedBody| match &one.touched {
            Touched { hull: true, .. } => Support::Subject,
            Touched { floor: true, .. } => Support::Floor,
            _ => Support::Nothing,
        };

        // Support spreads from body to body, by one contact in each round.
        let mut supports: Vec<_> = self.bodies.iter().map(direct).collect();
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

    /// The bodies as they are drawn.
    pub fn drawn(&self) -> Vec<Drawn> {
        let drawn = |(one, state): (&SimulatedBody, State)| Drawn {
            shape: one.shape.clone(),
            world_from_body: state.pose,
            colour: one.colour,
        };
        self.bodies.iter().zip(self.states()).map(drawn).collect()
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

    /// The largest speed without falling of a body that has these speeds, in m/s, at these heights, in metres.
    fn without_fall(states: &[(f64, f64)]) -> f64 {
        let mut simulation = Simulation::new(&Arc::new(HullData::new()), 0.001, Motion::Held).unwrap();
        simulation.add(&Shape::cube(0.1), &Isometry3::translation(0.0, 0.0, 1.0), [0; 3]).unwrap();
        let one = &mut simulation.bodies[0];
        one.first_contact = Some(0.0);
        states.iter().for_each(|&(speed, height)| one.record_speed(speed, height));
        one.fastest_without_fall
    }

    #[test]
    fn falling_adds_nothing_to_a_bodys_speed_without_falling() {
        let fallen = |height: f64| ((2.0 * GRAVITY * (1.0 - height)).sqrt(), height);
        assert!(without_fall(&[(0.0, 1.0), fallen(0.6), fallen(0.1)]) < 1e-6);

        // A body that was thrown at 2 m/s keeps that speed while it rises, falls and lies on the floor.
        let thrown = |height: f64| ((4.0 + 2.0 * GRAVITY * (1.0 - height)).sqrt(), height);
        let found = without_fall(&[(0.0, 1.0), thrown(1.0), thrown(1.1), thrown(0.1), (0.0, 0.05)]);
        assert!((found - 2.0).abs() < 1e-9, "{found}");
    }
}
