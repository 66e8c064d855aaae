//! Invariants of contacts, tested on random hulls, bodies and poses against single queries, the reference and
//! analytic surfaces, as MuJoCo does it for boxes.
//!
//! 1. A contact is on the body's surface, to a nanometre, and inside the hull: by the single query, and
//!    within a pixel by the masks themselves.
//! 2. Its depth is the exit along its direction by the single query, or the largest depth allowed if that is
//!    less. For masks without coverage it is also the exit of
//!    [`reference`](ode_visual_hull::hull::reference).
//! 3. There are at most as many contacts as allowed; directions are unit vectors, and no manifold is empty.
//! 4. In another order of the views the contacts are the same set, unless the nearest edges of
//!    a sample are equally far in two views, to a nanometre: then the first decides.
//! 5. In another order of the samples, the contacts from which the reduction chooses are the same set, unless
//!    two samples are equally deep. The reduction itself prefers the first of the deep samples.

mod bodies;
mod hulls;
mod invariants;
mod ties;

pub use bodies::Body;
pub use hulls::{Scene, scenes};

use crate::random::Random;
use nalgebra::{Isometry3, Vector3};
use ode_visual_hull::contact::{Mode, Settings};
use ode_visual_hull::hull::EdgeModel;

/// What was found in a number of collisions.
#[derive(Debug, Clone, Default)]
pub struct Findings {
    /// Number of contacts.
    pub contacts: usize,
    /// Number of bodies that touch.
    pub touching: usize,
    /// Number of contacts and sets of contacts that break an invariant.
    pub violations: usize,
    /// The first few of these.
    pub examples: Vec<String>,
    /// Number of sets of contacts that were compared with those of another order, by views and by samples.
    pub compared: [usize; 2],
    /// Of these, how many depend on the order because of a tie.
    pub ties: [usize; 2],
}

impl Findings {
    /// The share of the compared sets that depend on an order because of a tie.
    pub fn tie_share(&self) -> f64 {
        (self.ties[0] + self.ties[1]) as f64 / (self.compared[0] + self.compared[1]).max(1) as f64
    }

    fn add_violation(&mut self, what: String) {
        const EXAMPLES: usize = 5;
        self.violations += 1;
        if self.examples.len() < EXAMPLES {
            self.examples.push(what);
        }
    }
}

/// Collides random bodies with the hulls of `scenes` in turn until there are `count` contacts.
pub fn collide_random(scenes: &[Scene], count: usize, seed: u64) -> Findings {
    let mut random = Random(seed);
    let mut findings = Findings::default();
    for scene in scenes.iter().cycle() {
        // Enough bodies of one size that sampling them takes no time.
        for kind in 0..Body::KINDS {
            let body = Body::random(&mut random, kind);
            for _ in 0..8 {
                let pose = touching_pose(scene, &body, &mut random);
                let settings = random_settings(&mut random);
                invariants::check(scene, &body, &pose, &settings, &mut random, &mut findings);
            }
        }
        if findings.contacts >= count {
            break;
        }
    }
    findings
}

/// A pose in which the body touches the hull in most cases: deep, or barely.
fn touching_pose(scene: &Scene, body: &Body, random: &mut Random) -> Isometry3<f64> {
    let inside = scene.inside[random.below(scene.inside.len())];
    let direction = random.direction();
    let exit = scene.hull.exit(&inside, &direction, EdgeModel::Coverage);
    let centre = inside + direction * (exit + body.reach() * random.between(-0.3, 1.0));
    Isometry3::from_parts(centre.into(), random.rotation())
}

fn random_settings(random: &mut Random) -> Settings {
    let mode = match random.below(8) {
        0 => Mode::Point,
        1 => Mode::Single,
        _ => Mode::Clustered,
    };
    Settings { mode, max_contacts: 1 + random.below(12_usize), ..Settings::default() }
}

/// Whether two directions or positions are equal but for rounding.
fn are_close(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    (a - b).amax() <= NANOMETRE
}

/// In metres, or as a part of a unit vector: far more than rounding, far less than a pixel.
const NANOMETRE: f64 = 1e-9;
