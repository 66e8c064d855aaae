//! The thread that simulates: steps by the clock, and what the user does with the bodies.

use super::aim;
use super::bodies::{Bodies, Rainfall};
use super::latencies::Latencies;
use super::latest::Latest;
use super::messages::Messages;
use nalgebra::{Isometry3, Point3};
use ode_visual_hull::Result;
use ode_visual_hull::camera::Ray;
use ode_visual_hull::hull::{Aabb, HullData, Motion};
use ode_visual_hull::shape::Shape;
use ode_visual_hull::source::Clock;
use ode_visual_hull_film::{Drawn, DrawnPart, HullContact, Simulation, State, Steps, Tally};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Receiver;

/// Steps a second.
pub const STEP_RATE: f64 = 120.0;

/// A ball that is thrown, and how far in front of the eye it starts, in metres.
const BALL: Shape = Shape::Sphere { radius: 0.06 };
const BALL_START: f64 = 0.3;

/// Balls that exist at most; the one thrown first is thrown again.
const MOST_BALLS: usize = 10;
const BALL_COLOUR: [u8; 3] = [240, 110, 40];

/// All bodies that there may be: those of a scenery, then balls.
pub fn all_bodies(bodies: &Bodies) -> Vec<DrawnPart> {
    let ball = DrawnPart { shape: BALL, body_from_part: Isometry3::identity(), colour: BALL_COLOUR };
    let boxes = (0..bodies.count).map(|k| bodies.drawn_box(k));
    boxes.chain(std::iter::repeat_n(ball, MOST_BALLS)).collect()
}

/// What the user does.
#[derive(Debug, Clone, PartialEq)]
pub enum Command {
    /// Throw a ball along a ray.
    Throw(Ray),
    /// Take hold of the body that a ray meets first.
    Grab(Ray),
    /// Move the body that is held to the nearest place on a ray.
    Drag(Ray),
    /// Let it go.
    Release,
    /// Put all bodies back to where they were at first.
    Reset,
    /// Replace all bodies by those of the next scenery.
    NextScenery,
}

/// The bodies after a step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct WorldState {
    /// The time of the step, in seconds.
    pub time: f64,
    /// The time of the hull with which the bodies collided, in seconds.
    pub hull_time: f64,
    /// What is drawn.
    pub bodies: Vec<Drawn>,
    /// Their contacts with the hull, if they are asked for.
    pub contacts: Vec<HullContact>,
    /// The points of their surfaces that are tested against the hull, if they are asked for.
    pub samples: Vec<Point3<f64>>,
    /// What became of the steps so far.
    pub steps: Tally,
}

/// What the thread shares with others.
#[derive(Debug, Default)]
pub struct WorldShared {
    /// The bodies after the latest step.
    pub latest: Latest<WorldState>,
    /// Whether sample points are asked for.
    pub are_samples_asked: AtomicBool,
    /// Whether the mouse holds a body.
    pub is_body_held: AtomicBool,
    /// From the time of an image to the end of the first collide with its hull, where a body touches that.
    pub to_contact: Latencies,
}

/// A body that is held by the mouse.
struct Held {
    body: usize,
    /// Where it is held, in its own frame.
    point: Point3<f64>,
    /// Its distance from the eye when it was taken, in metres.
    distance: f64,
    target: Point3<f64>,
}

/// A simulation that keeps up with a clock.
pub struct Simulating {
    pub(super) data: Arc<HullData>,
    pub(super) motion: Motion,
    pub(super) bodies: Bodies,
    pub(super) clock: Clock,
    pub(super) commands: Receiver<Command>,
    pub(super) captures: Arc<super::capture::CaptureState>,
    pub(super) shared: Arc<WorldShared>,
    pub(super) messages: Arc<Messages>,
}

/// A world of the simulation, until it is reset.
struct World {
    simulation: Simulation,
    /// The number of each body among all that there may be: boxes, then balls.
    numbers: Vec<usize>,
    fallen: Rainfall,
    /// The bodies that are balls, in the order in which they were thrown last.
    balls: Vec<usize>,
    held: Option<Held>,
}

impl Simulating {
    /// Simulates until the clock is closed.
    ///
    /// # Errors
    /// An ODE that is missing.
    pub fn run(mut self) -> Result<()> {
        let mut world = self.world()?;
        let mut steps = Steps::new(STEP_RATE, self.clock.now());
        let mut last_used = 0.0;
        while !self.clock.is_closed() {
            let is_woken = &self.captures.wakes_simulation;
            if !self.clock.wait_until(steps.due(), is_woken) {
                is_woken.store(false, Ordering::Relaxed);
                if self.clock.is_paused() {
                    self.publish(&world.simulation, steps.tally());
                } else {
                    world.simulation.prepare_step();
                }
                continue;
            }
            world.simulation.skip(steps.drop_if_behind(self.clock.now()));
            // The step would warp masks that have changed since one after the other; this warps them side by side.
            world.simulation.prepare_step();
            if let Err(error) = self.step(&mut world, steps.dt()) {
                self.messages.warn("simulation", format!("{error}; all bodies were put back"));
                world = self.world()?;
            }
            steps.count(self.clock.now());
            self.measure(&world.simulation, &mut last_used);
            self.publish(&world.simulation, steps.tally());
            if let Some(recording) = &self.captures.recording {
                recording.write_states(world.simulation.time(), || self.states(&world));
            }
            if self.clock.now() < steps.due() {
                world.simulation.prepare_step();
            }
        }
        Ok(())
    }

    /// A world with the bodies as they are at first.
    fn world(&self) -> Result<World> {
        let hull = self.data.latest().map(|(_, hull)| hull);
        let pixel_size = hull.as_ref().map_or(0.005, |hull| hull.pixel_size(&hull.bounds().centre()));
        let mut simulation = Simulation::new(&self.data, pixel_size, self.motion)?;
        simulation.skip(self.clock.now());
        self.bodies.add_to(&mut simulation, &hull.map_or(Aabb::EMPTY, |hull| *hull.aabb()))?;
        let numbers = (0..simulation.bodies().len()).collect();
        Ok(World { simulation, numbers, fallen: Rainfall::default(), balls: Vec::new(), held: None })
    }

    fn step(&mut self, world: &mut World, dt: f64) -> Result<()> {
        while let Ok(command) = self.commands.try_recv() {
            self.obey(world, command)?;
        }
        let subject = world.simulation.hull().map_or(Aabb::EMPTY, |hull| *hull.aabb());
        let (time, before) = (world.simulation.time(), world.simulation.bodies().len());
        self.bodies.rain(&mut world.simulation, &subject, &mut world.fallen, time)?;
        if world.simulation.bodies().len() > before {
            world.numbers.push(before - world.balls.len());
        }
        if let Some(held) = &world.held {
            world.simulation.pull(held.body, &held.point, &held.target)?;
        }
        self.shared.is_body_held.store(world.held.is_some(), Ordering::Relaxed);
        world.simulation.step(dt)
    }

    fn obey(&mut self, world: &mut World, command: Command) -> Result<()> {
        match command {
            Command::Throw(ray) => world.throw(&ray, self.bodies.count)?,
            Command::Grab(ray) => world.grab(&ray),
            Command::Drag(ray) => {
                if let Some(held) = &mut world.held {
                    held.target = ray.origin + ray.direction * held.distance;
                }
            }
            Command::Release => world.held = None,
            Command::Reset => *world = self.world()?,
            Command::NextScenery => {
                self.bodies.scenery = self.bodies.scenery.next();
                self.messages.tell("bodies", self.bodies.description());
                *world = self.world()?;
            }
        }
        Ok(())
    }

    /// Measures how long the latest image took to its first contact.
    fn measure(&self, simulation: &Simulation, last_used: &mut f64) {
        let Some(hull) = simulation.hull() else { return };
        let captures = &self.captures.captures;
        // Between two frames a moving hull is made of both.
        let used = match simulation.motion() {
            Motion::Interpolated => captures.time_of_first_after(hull.time()),
            Motion::Held | Motion::Predicted => captures.time_of_last_before(hull.time()),
        };
        let Some(used) = used.filter(|used| used > last_used) else { return };
        if simulation.touches_hull() {
            self.shared.to_contact.add(self.clock.at(simulation.collided_at()) - used);
        }
        *last_used = used;
    }

    /// The states of all bodies that there may be.
    fn states(&self, world: &World) -> Vec<State> {
        let mut states = vec![State::absent(); self.bodies.count + MOST_BALLS];
        for (number, state) in world.numbers.iter().zip(world.simulation.states()) {
            states[*number] = state;
        }
        states
    }

    fn publish(&self, simulation: &Simulation, steps: Tally) {
        let are_samples_asked = self.shared.are_samples_asked.load(Ordering::Relaxed);
        self.shared.latest.put(WorldState {
            time: simulation.time(),
            hull_time: simulation.hull().map_or(simulation.time(), |hull| hull.time()),
            bodies: simulation.drawn(),
            contacts: simulation.hull_contacts().to_vec(),
            samples: if are_samples_asked { simulation.sample_points() } else { Vec::new() },
            steps,
        });
    }
}

impl World {
    /// Throws a ball at what `ray` meets first; balls have numbers from `first` on.
    fn throw(&mut self, ray: &Ray, first: usize) -> Result<()> {
        let place = ray.origin + ray.direction * BALL_START;
        let pose = Isometry3::translation(place.x, place.y, place.z);
        // Before the ball is there: the ray would meet it first.
        let velocity = aim::velocity(&self.simulation, ray, &place);
        let ball = if self.balls.len() < MOST_BALLS {
            self.numbers.push(first + self.balls.len());
            self.simulation.add(&BALL, &pose, BALL_COLOUR)?
        } else {
            self.balls.remove(0)
        };
        self.balls.push(ball);
        self.simulation.place(ball, &pose)?;
        self.simulation.set_velocity(ball, &velocity)
    }

    fn grab(&mut self, ray: &Ray) {
        self.held = self.simulation.pick(ray).map(|(body, place)| Held {
            body,
            point: self.simulation.states()[body].pose.inverse_transform_point(&place),
            distance: (place - ray.origin).norm(),
            target: place,
        });
    }
}
