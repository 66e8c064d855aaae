//! A bird balances with its beak on a real finger.

mod act;
mod arm;
#[path = "../shared/mod.rs"]
mod shared;

use act::{Act, Claim};
use nalgebra::{Isometry3, Point3, Vector3, point, vector};
use ode_visual_hull::Result;
use ode_visual_hull::ode::{Damping, Shape};
use ode_visual_hull_film::{Entry, FRAME_RATE, Log, Part, Simulation};
use std::process::ExitCode;

/// The radius of the beak's tip, and how far from the finger's end it stands, in metres.
const BEAK: f64 = 0.006;
const FROM_END: f64 = 0.03;

const RED: [u8; 3] = [222, 60, 50];
const YELLOW: [u8; 3] = [245, 190, 40];
const BLUE: [u8; 3] = [60, 120, 220];

fn main() -> ExitCode {
    let act = Act {
        about: "A virtual bird balances with its beak on a real finger, swings, settles and follows the finger.",
        who: "finger",
        subject: |time| arm::arm(tip(time), -Vector3::x(), vector![-1.0, 0.15, 0.45]),
        still_until: 3.5,
        end: 8.5,
        place: point![-0.05, 0.0, 0.78],
        reach: 0.25,
        eye: point![0.2, -0.8, 1.02],
        target: point![-0.02, 0.0, 0.76],
    };
    act.play(add_bird, stays_on_the_finger)
}

/// The end of the finger, which moves forwards and up, and back.
fn tip(time: f64) -> Point3<f64> {
    let moved = arm::ease(time, 3.5, 5.5) - arm::ease(time, 6.0, 8.0);
    point![-0.15 * moved, 0.0, 0.75 + 0.08 * moved]
}

/// Adds the bird, whose weights below the ends of its wings bring its centre of mass below the beak, at the origin.
fn add_bird(simulation: &mut Simulation) -> Result<()> {
    simulation.set_damping(&Damping { angular: 0.005, ..Damping::default() })?;
    let mut parts = vec![
        Part::rod(Point3::origin(), point![-0.03, 0.0, 0.025], BEAK, YELLOW),
        Part::rod(point![-0.045, 0.0, 0.035], point![-0.06, 0.0, 0.033], 0.024, RED),
        Part::rod(point![-0.06, 0.0, 0.02], point![-0.17, 0.0, 0.0], 0.02, RED),
        Part::new(Shape::cuboid(0.08, 0.06, 0.006), YELLOW).at(Isometry3::translation(-0.21, 0.0, -0.005)),
    ];
    for side in [-1.0, 1.0] {
        let wing =
            Isometry3::new(vector![-0.03, 0.11 * side, -0.01], vector![-0.3 * side, 0.0, -0.35 * side]);
        let below = Isometry3::translation(0.0235, 0.2 * side, -0.06);
        parts.push(Part::rod(point![0.0, 0.19 * side, -0.037], below * Point3::origin(), 0.004, YELLOW));
        parts.push(Part::new(Shape::cuboid(0.07, 0.2, 0.006), BLUE).at(wing));
        parts.push(Part::new(Shape::Sphere { radius: 0.014 }, YELLOW).at(below).with_density(8000.0));
    }
    let place = tip(0.0) + vector![FROM_END, 0.0, arm::FINGER + BEAK];
    simulation.add_parts(&parts, &Isometry3::new(place.coords, vector![0.25, 0.15, 0.0]))?;
    Ok(())
}

fn stays_on_the_finger(log: &Log) -> Claim {
    // The interpolated hull is a frame late. The finger lies along x.
    let beak =
        |entry: &Entry| entry.states[0].pose.translation.vector - tip(entry.time - 1.0 / FRAME_RATE).coords;
    let most = |measured: &dyn Fn(&Entry) -> f64| 1e3 * log.entries.iter().map(measured).fold(0.0, f64::max);
    let gap = most(&|entry| (beak(entry).yz().norm() - arm::FINGER - BEAK).abs());
    let slip = most(&|entry| (beak(entry).x - FROM_END).abs());
    let text = format!(
        "the beak stays within {gap:.1} mm of the finger, and within {slip:.0} mm of its place along it"
    );
    Claim { holds: gap < 5.0 && slip < 1e3 * FROM_END, text }
}
