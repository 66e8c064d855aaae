//! The virtual side: boxes in an ODE world with the hull and a floor.

use nalgebra::{Isometry3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{Amount, BodyId, GeomId, Mass, Ode, Shape, Surface, World};
use ode_visual_hull::{Error, Result};
use std::sync::Arc;

/// Steps of the simulation a second.
const STEPS_PER_SECOND: f64 = 240.0;

/// Of the boxes, kg/m3: about that of a parcel.
const DENSITY: f64 = 120.0;

/// Between all surfaces.
const FRICTION: f64 = 0.8;

/// The most contacts of one pair.
const MOST_CONTACTS: usize = 8;

/// Noisy masks wear thin features away, in metres.
const MIN_FEATURE: f64 = 0.015;

/// A virtual box.
#[derive(Debug, Clone)]
pub struct VirtualBox {
    /// Full lengths, in metres.
    pub sides: Vector3<f64>,
    /// Red, green, blue.
    pub colour: [u8; 3],
    body: BodyId,
    touched: Touched,
    /// Since the beginning, how deep in the hull at most, in metres.
    pub deepest: f64,
    /// When it first touched anything, in seconds.
    pub first_contact: Option<f64>,
    /// The fastest since then, in m/s.
    pub fastest_after_contact: f64,
}

/// What a box touched in the last step.
#[derive(Debug, Clone, Default)]
struct Touched {
    hull: bool,
    floor: bool,
    /// Other boxes, by index.
    boxes: Vec<usize>,
}

/// Where and how fast a box is.
#[derive(Debug, Clone, Copy)]
pub struct State {
    /// Of the box's centre, in the world.
    pub pose: Isometry3<f64>,
    /// In m/s.
    pub linear_velocity: Vector3<f64>,
    /// In rad/s, in the world.
    pub angular_velocity: Vector3<f64>,
}

/// What holds a box up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// The real subject, directly or through other boxes.
    Subject,
    /// The floor, directly or through other boxes.
    Floor,
    /// Nothing: it falls.
    Nothing,
}

/// The world with its boxes.
pub struct Simulation {
    world: World,
    hull: GeomId,
    floor: GeomId,
    boxes: Vec<VirtualBox>,
    time: f64,
}

impl Simulation {
    /// A world with the hull of `data` and a floor at z = 0; `pixel_size` is what a pixel covers there, in metres.
    pub fn new(data: &Arc<HullData>, pixel_size: f64) -> Result<Self> {
        let mut world = World::new(&Ode::init()?)?;
        world.set_gravity(&vector![0.0, 0.0, -9.81])?;
        world.set_erp(0.2)?;
        world.set_cfm(1e-5)?;
        world.set_quick_step_iterations(50)?;
        // Edges of live masks flicker by a pixel: what flickers less than half of it is left alone.
        world.set_contact_surface_layer(0.5 * pixel_size)?;
        let root = world.root_space();
        let floor = world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 })?;
        let hull = world.add_hull(root, data)?;
        world.hull_mut(hull).set_min_feature(MIN_FEATURE)?;
        Ok(Self { world, hull, floor, boxes: Vec::new(), time: 0.0 })
    }

    /// Puts a box at rest into the world.
    pub fn add_box(&mut self, sides: Vector3<f64>, pose: &Isometry3<f64>, colour: [u8; 3]) -> Result<()> {
        let shape = Shape::Box { sides };
        let body = self.world.add_body();
        let geom = self.world.add_geom(self.world.root_space(), &shape)?;
        self.world.geom_mut(geom).set_body(Some(body))?;
        let mut body_mut = self.world.body_mut(body);
        body_mut.set_mass(&Mass::of(&shape, Amount::Density(DENSITY))?)?;
        body_mut.set_pose(pose)?;
        self.boxes.push(VirtualBox {
            sides,
            colour,
            body,
            touched: Touched::default(),
            deepest: 0.0,
            first_contact: None,
            fastest_after_contact: 0.0,
        });
        Ok(())
    }

    /// Goes on by `duration` seconds.
    pub fn advance(&mut self, duration: f64) -> Result<()> {
        let steps = (duration * STEPS_PER_SECOND).round().max(1.0);
        let dt = duration / steps;
        for _ in 0..steps as u32 {
            self.collide()?;
            self.world.quick_step(dt)?;
            self.time += dt;
            for one in &mut self.boxes {
                if one.first_contact.is_some() {
                    let speed = self.world.body(one.body).linear_velocity().norm();
                    one.fastest_after_contact = one.fastest_after_contact.max(speed);
                }
            }
        }
        match self.world.hull(self.hull).take_trouble() {
            Some(trouble) => Err(trouble),
            None => self.check_finite(),
        }
    }

    /// The near callback: contacts for every pair with a body, and a note of who touches whom.
    fn collide(&mut self) -> Result<()> {
        let Self { world, hull, floor, boxes, time } = self;
        for one in boxes.iter_mut() {
            one.touched = Touched::default();
        }
        let surface = Surface::with_friction(FRICTION);
        world.collide(|pair| {
            let contacts = pair.contacts(MOST_CONTACTS);
            for contact in contacts.iter() {
                pair.attach(contact, &surface);
            }
            if contacts.is_empty() {
                return;
            }
            let of_body = |body| boxes.iter().position(|one| one.body == body);
            let [first, second] = pair.bodies().map(|body| body.and_then(of_body));
            let depth = contacts.iter().map(|contact| contact.depth).fold(0.0, f64::max);
            for (own, other) in [(first, second), (second, first)] {
                let Some(one) = own.and_then(|own| boxes.get_mut(own)) else { continue };
                one.first_contact.get_or_insert(*time);
                one.touched.boxes.extend(other);
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
        lost.map_or(Ok(()), |i| Err(Error::Ode(format!("box {} is nowhere: the simulation diverged", i + 1))))
    }

    /// The boxes.
    pub fn boxes(&self) -> &[VirtualBox] {
        &self.boxes
    }

    /// Seconds since the beginning.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Where the boxes are.
    pub fn states(&self) -> Vec<State> {
        let state = |one: &VirtualBox| {
            let body = self.world.body(one.body);
            State {
                pose: body.pose(),
                linear_velocity: body.linear_velocity(),
                angular_velocity: body.angular_velocity(),
            }
        };
        self.boxes.iter().map(state).collect()
    }

    /// What holds each box up, directly or through others; the subject counts before the floor.
    pub fn supports(&self) -> Vec<Support> {
        let direct = |one: &VirtualBox| match &one.touched {
            Touched { hull: true, .. } => Support::Subject,
            Touched { floor: true, .. } => Support::Floor,
            _ => Support::Nothing,
        };
        let mut supports: Vec<_> = self.boxes.iter().map(direct).collect();
        for _ in 0..self.boxes.len() {
            for (i, one) in self.boxes.iter().enumerate() {
                for &below in &one.touched.boxes {
                    if supports[i] == Support::Nothing {
                        supports[i] = supports[below];
                    }
                }
            }
        }
        supports
    }

    /// The boxes as they are drawn.
    pub fn drawn(&self) -> Vec<Drawn> {
        let drawn = |(one, state): (&VirtualBox, State)| Drawn {
            half: 0.5 * one.sides,
            world_from_box: state.pose,
            colour: one.colour,
        };
        self.boxes.iter().zip(self.states()).map(drawn).collect()
    }

    /// How many boxes rest on what, for the progress bar.
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

/// A box to draw.
#[derive(Debug, Clone, Copy)]
pub struct Drawn {
    /// Half its lengths.
    pub half: Vector3<f64>,
    /// Where.
    pub world_from_box: Isometry3<f64>,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

/// How far `rotation` tilts the vertical, in degrees, taking the nearest of the box's axes as upright.
pub fn lean_deg(rotation: &UnitQuaternion<f64>) -> f64 {
    let up = rotation.inverse_transform_vector(&Vector3::z());
    up.amax().clamp(-1.0, 1.0).acos().to_degrees()
}
