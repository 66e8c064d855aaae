//! A real finger pushes the first domino of a spiral.

mod act;
mod arm;
#[path = "../shared/mod.rs"]
mod shared;

use act::{Act, Claim};
use nalgebra::{Isometry3, Vector3, point};
use ode_visual_hull::Result;
use ode_visual_hull::ode::{Shape, Surface};
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_film::{Entry, Log, Simulation, State};
use std::f64::consts::TAU;
use std::process::ExitCode;

/// Across, along and up the spiral, in metres.
const DOMINO: Vector3<f64> = Vector3::new(0.12, 0.035, 0.24);
const DOMINOES: usize = 72;

/// From one domino to the next and from one winding to the next, and the radius at the outer end, in metres.
const SPACING: f64 = 0.115;
const WINDING: f64 = 0.29;
const OUTER: f64 = 0.95;

/// The angle of the first domino, in radians.
const FIRST: f64 = -0.66 * std::f64::consts::PI;

fn main() -> ExitCode {
    let act = Act {
        about: "A real finger pushes the first of 72 virtual dominoes, and the last one falls.",
        who: "finger",
        subject: finger,
        still_until: 0.8,
        end: 7.0,
        place: domino(FIRST) * point![0.0, 0.0, 0.0],
        reach: 0.45,
        eye: point![-0.12, -2.1, 1.6],
        target: point![-0.04, -0.1, 0.0],
    };
    act.play(add_dominoes, all_fall)
}

/// A finger that pushes the first domino just below its top, and draws back.
fn finger(time: f64) -> Result<Subject> {
    let pushed = 0.17 * arm::ease(time, 0.8, 1.4) - 0.3 * arm::ease(time, 1.4, 2.2);
    let tip = domino(FIRST) * point![0.0, pushed - 0.12, 0.08];
    let along = domino(FIRST) * Vector3::y();
    arm::arm(tip, along - 0.2 * Vector3::z(), along - 0.5 * Vector3::z())
}

fn add_dominoes(simulation: &mut Simulation) -> Result<()> {
    simulation.set_body_surface(Surface::with_friction(0.2));
    let mut angle = FIRST;
    for k in 0..DOMINOES {
        let turn = k as f64 / DOMINOES as f64;
        let rainbow = [0.0, 2.0, 1.0].map(|third| (145.0 + 105.0 * (TAU * (turn + third / 3.0)).cos()) as u8);
        simulation.add(&Shape::Box { sides: DOMINO }, &domino(angle), rainbow)?;
        angle += SPACING / radius(angle);
    }
    Ok(())
}

fn radius(angle: f64) -> f64 {
    OUTER - WINDING * (angle - FIRST) / TAU
}

/// The pose of the domino at this angle, whose y axis leads to the next one.
fn domino(angle: f64) -> Isometry3<f64> {
    let turn = Isometry3::rotation(Vector3::z() * angle);
    turn * Isometry3::translation(radius(angle), 0.0, 0.5 * DOMINO.z)
}

fn all_fall(log: &Log) -> Claim {
    let lies = |state: &&State| (state.pose * Vector3::z()).z < 0.7;
    let lie_at = |entry: &Entry| entry.states.iter().filter(lies).count();
    let [before, after] = [0, log.entries.len() - 1].map(|i| lie_at(&log.entries[i]));
    Claim { holds: before == 0 && after == DOMINOES, text: format!("{after} of {DOMINOES} dominoes fell") }
}
