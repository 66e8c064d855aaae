//! A bird balances with its beak on a real finger.

mod act;
mod arm;
#[path = "../shared/mod.rs"]
mod shared;

use act::{Act, Claim};
use nalgebra::{Isometry3, Point3, Vector3, point, vector};
use ode_visual_hull::Result;
use ode_visual_hull::ode::{Damping, Shape};
use ode_visual_hull_film::{FRAME_RATE, Log, Part, Simulation};
use std::process::ExitCode;

/// The radius of the beak's tip, in metres.
const BEAK: f64 = 0.006;

fn main() -> ExitCode {
    let act = Act {
        name: "balance_bird",
        out: "target/balance_bird",
        about: "A virtual bird balances with its beak on a real finger, swings, and follows it.",
        who: "finger",
        subject: |time| arm::arm(tip(time), Vector3::z(), vector![0.6, 0.5, 0.55]),
        still_until: 4.0,
        end: 9.0,
        place: Point3::new(0.1, 0.0, 0.75),
        reach: 0.3,
        eye: Point3::new(0.35, -1.0, 1.0),
        target: Point3::new(0.05, 0.0, 0.72),
    };
    act.play(add_bird, stays_on_the_finger)
}

/// The tip of the finger, which moves to the side and upwards and back.
fn tip(time: f64) -> Point3<f64> {
    let moved = arm::ease(time, 4.0, 5.5) - arm::ease(time, 6.0, 7.5);
    point![0.0 + 0.2 * moved, 0.0, 0.75 + 0.05 * moved]
}

fn add_bird(simulation: &mut Simulation) -> Result<()> {
    simulation.set_damping(&Damping { angular: 0.005, ..Damping::default() })?;
    let (red, yellow) = ([222, 60, 50], [245, 190, 40]);
    let mut parts = vec![
        Part::rod(point![0.0, 0.0, 0.0], point![-0.03, 0.0, 0.025], BEAK, yellow),
        Part::rod(point![-0.045, 0.0, 0.035], point![-0.06, 0.0, 0.033], 0.024, red),
        Part::rod(point![-0.06, 0.0, 0.02], point![-0.17, 0.0, 0.0], 0.02, red),
        Part::new(Shape::cuboid(0.08, 0.06, 0.006), yellow).at(Isometry3::translation(-0.21, 0.0, -0.005)),
    ];
    for side in [-1.0, 1.0] {
        let wing =
            Isometry3::new(vector![-0.03, side * 0.11, -0.01], vector![side * -0.3, 0.0, side * -0.35]);
        parts.push(Part::new(Shape::cuboid(0.07, 0.2, 0.006), [60, 120, 220]).at(wing));
        let weight = Part::new(Shape::Sphere { radius: 0.014 }, yellow).with_density(3000.0);
        parts.push(weight.at(Isometry3::translation(0.04, side * 0.2, -0.045)));
    }
    let place = tip(0.0) + vector![0.0, 0.0, BEAK];
    simulation.add_parts(&parts, &Isometry3::new(place.coords, vector![0.25, 0.15, 0.0]))?;
    Ok(())
}

fn stays_on_the_finger(log: &Log) -> Claim {
    let beak = |entry: &ode_visual_hull_film::Entry| {
        let tip = tip(entry.time - 1.0 / FRAME_RATE) + vector![0.0, 0.0, BEAK];
        (entry.states[0].pose * Point3::origin() - tip).norm()
    };
    let farthest = 1e3 * log.entries.iter().map(beak).fold(0.0, f64::max);
    Claim { holds: farthest < 5.0, text: format!("the beak stays within {farthest:.1} mm of the finger") }
}
