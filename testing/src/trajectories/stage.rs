//! Building a scene on ODE's box or on the hull of that box, and running it.

use super::rig::Rig;
use nalgebra::{Isometry3, Vector3, vector};
use ode_visual_hull::contact::Mode;
use ode_visual_hull::ode::{
    Amount, BodyId, GeomId, JointKind, Mass, Ode, Shape, Surface, World, set_random_seed,
};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Step size, in seconds.
pub const DT: f64 = 0.005;

/// The seed of ODE's random numbers, set before each run.
pub const SEED: u32 = 1;

/// Maximum number of contacts of a pair, on both supports.
pub const CONTACTS: usize = 8;

/// The support that the bodies fall on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// ODE's own box.
    Native,
    /// The hull of ODE's box, from masks with coverage.
    Hull,
}

/// The initial state of a body of 1 kg, in the world frame.
#[derive(Debug, Clone)]
pub struct InitialState {
    /// Shape of the only geom.
    pub shape: Shape,
    /// World from body.
    pub pose: Isometry3<f64>,
    /// In m/s.
    pub velocity: Vector3<f64>,
    /// In rad/s.
    pub spin: Vector3<f64>,
}

/// One experiment.
pub struct Scene {
    /// Name of the scene in its file name and its figure.
    pub name: &'static str,
    /// Description of what happens.
    pub about: &'static str,
    /// The support and its cameras.
    pub rig: &'static Rig,
    /// Initial states of the bodies.
    pub bodies: Vec<InitialState>,
    /// Joint between the first body and the world.
    pub joint: Option<JointKind>,
    /// Surface parameters of all contacts.
    pub surface: Surface,
    /// Condition that ends the comparison.
    pub ends: Ends,
    /// Whether a body falls on an edge or a corner, where a small difference at the impact grows.
    pub edge_first: bool,
}

/// The condition that ends a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// All bodies are at rest, or 2 s have passed since the first impact.
    AtRest,
    /// No body touches the support any more, or 1 s has passed since the first contact.
    OffSupport,
}

/// The state of a body after a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// World from body.
    pub pose: Isometry3<f64>,
    /// In m/s.
    pub velocity: Vector3<f64>,
    /// In rad/s.
    pub spin: Vector3<f64>,
}

/// A running scene.
pub struct Stage {
    /// The world of ODE.
    pub world: World,
    /// The geom of the support.
    pub support: GeomId,
    /// The bodies, in the order of the scene.
    pub bodies: Vec<BodyId>,
    surface: Surface,
    _lock: MutexGuard<'static, ()>,
}

/// Held by a running scene: ODE has one sequence of random numbers in a process, so that scenes must not overlap.
static RANDOM_LOCK: Mutex<()> = Mutex::new(());

impl Stage {
    /// Builds `scene` on `support`, in its initial state.
    pub fn new(scene: &Scene, support: Support) -> Self {
        let lock = RANDOM_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
        let mut world = World::new(&Ode::init().unwrap()).unwrap();
        world.set_gravity(&vector![0.0, 0.0, -9.81]).unwrap();
        world.set_cfm(1e-5).unwrap();
        world.set_erp(0.2).unwrap();
        world.set_contact_surface_layer(0.001).unwrap();
        world.set_quick_step_iterations(50).unwrap();

        let root = world.root_space();
        let support = match support {
            Support::Native => {
                let geom = world.add_geom(root, &Shape::Box { sides: scene.rig.lengths }).unwrap();
                world.geom_mut(geom).set_pose(&scene.rig.world_from_box).unwrap();
                geom
            }
            Support::Hull => {
                let geom = world.add_hull(root, &scene.rig.hull_data()).unwrap();
                world.hull_mut(geom).set_mode(Mode::Clustered);
                geom
            }
        };

        let bodies: Vec<BodyId> = scene.bodies.iter().map(|start| add(&mut world, start)).collect();
        if let Some(joint) = &scene.joint {
            world.add_joint([Some(bodies[0]), None], joint).unwrap();
        }
        set_random_seed(SEED);
        Self { world, support, bodies, surface: scene.surface, _lock: lock }
    }

    /// The states of the bodies, in the order of the scene.
    pub fn states(&self) -> Vec<State> {
        let state = |&id: &BodyId| {
            let body = self.world.body(id);
            State { pose: body.pose(), velocity: body.linear_velocity(), spin: body.angular_velocity() }
        };
        self.bodies.iter().map(state).collect()
    }

    /// Collides and advances the world by a step. Returns whether a body touched the support.
    pub fn step(&mut self) -> bool {
        let (support, surface) = (self.support, self.surface);

        let mut touched = false;
        let collide = |pair: &ode_visual_hull::ode::Pair<'_>| {
            if pair.bodies() == [None, None] {
                return;
            }
            let contacts = pair.contacts(CONTACTS);
            touched |= pair.geoms().contains(&support) && !contacts.is_empty();
            for contact in contacts.iter() {
                pair.attach(contact, &surface);
            }
        };
        self.world.collide(collide).unwrap();
        self.world.quick_step(DT).unwrap();

        touched
    }
}

fn add(world: &mut World, start: &InitialState) -> BodyId {
    let body = world.add_body();
    let root = world.root_space();
    let geom = world.add_geom(root, &start.shape).unwrap();
    world.geom_mut(geom).set_body(Some(body)).unwrap();

    let mut view = world.body_mut(body);
    view.set_mass(&Mass::of(&start.shape, Amount::Total(1.0)).unwrap()).unwrap();
    view.set_pose(&start.pose).unwrap();
    view.set_linear_velocity(&start.velocity).unwrap();
    view.set_angular_velocity(&start.spin).unwrap();
    body
}

/// The course of a scene.
pub struct Run {
    /// States by step and body, beginning with the initial states.
    pub states: Vec<Vec<State>>,
    /// Step in which a body first touched the support.
    pub first: usize,
    /// Last step of the comparison.
    pub last: usize,
    /// Reason why the scene ends there.
    pub ending: &'static str,
}

/// Speed in m/s below which a body counts as at rest, if it stays so for 0.1 s; the limit of the spin in rad/s is ten
/// times as large, as bodies are about 0.1 m in size.
const REST: f64 = 1e-3;

/// Steps without a contact after which the bodies count as off the support.
const OFF: usize = 3;

/// Runs a scene to its end.
pub fn run(scene: &Scene, support: Support) -> Run {
    let mut stage = Stage::new(scene, support);
    let mut states = vec![stage.states()];
    let (mut first, mut at_rest, mut without_contact) = (None, 0, 0);
    let steps = |seconds: f64| (seconds / DT).round() as usize;

    for k in 1..=steps(5.0) {
        let touched = stage.step();
        states.push(stage.states());
        if touched {
            first.get_or_insert(k);
        }
        let Some(first) = first else { continue };

        let slow = |state: &State| state.velocity.norm() < REST && state.spin.norm() < 10.0 * REST;
        at_rest = if states[k].iter().all(slow) { at_rest + 1 } else { 0 };
        without_contact = if touched { 0 } else { without_contact + 1 };

        let ending = match scene.ends {
            Ends::AtRest if at_rest == steps(0.1) => Some((k, "at rest")),
            Ends::AtRest if k == first + steps(2.0) => Some((k, "2 s after the first impact")),
            Ends::OffSupport if without_contact == OFF => Some((k - OFF, "off the support")),
            Ends::OffSupport if k == first + steps(1.0) => Some((k, "after 1 s")),
            _ => None,
        };

        if let Some((last, ending)) = ending {
            return Run { states, first, last, ending };
        }
    }

    panic!("{}: expected the bodies to reach the support within 3 s", scene.name)
}

/// Runs a scene for a number of steps and returns the states, beginning with the initial ones.
pub fn run_for(scene: &Scene, support: Support, steps: usize) -> Vec<Vec<State>> {
    let mut stage = Stage::new(scene, support);
    let mut states = vec![stage.states()];
    for _ in 0..steps {
        stage.step();
        states.push(stage.states());
    }
    states
}
