//! A real person walks through a pyramid of boxes.

mod act;
#[path = "../shared/mod.rs"]
mod shared;

use act::{Act, Claim};
use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::synthetic::{PERSON_PERIOD, Subject};
use ode_visual_hull_film::{Entry, Log, Simulation, Support};
use std::process::ExitCode;

/// Boxes of the lowest row, their side lengths, and from one box of a row to the next, in metres.
const ROWS: usize = 6;
const BOX: Vector3<f64> = Vector3::new(0.2, 0.2, 0.17);
const SPACING: f64 = 0.215;

/// Until when the person stands, in seconds.
const STILL_UNTIL: f64 = 1.0;

const COLOURS: [[u8; 3]; ROWS] =
    [[222, 86, 62], [240, 150, 60], [240, 200, 60], [64, 168, 110], [66, 118, 202], [146, 92, 186]];

fn main() -> ExitCode {
    let act = Act {
        name: "pyramid",
        out: "target/pyramid",
        about: "A real person walks through a pyramid of 21 virtual boxes, which stands still before.",
        who: "person",
        subject: walker,
        still_until: STILL_UNTIL,
        end: 5.0,
        place: Point3::new(0.2, 0.0, 0.85),
        reach: 1.15,
        eye: Point3::new(2.3, -2.9, 1.7),
        target: Point3::new(0.25, 0.0, 0.7),
    };
    act.play(add_pyramid, stands_and_falls)
}

fn walker(time: f64) -> Result<Subject> {
    let walked = (time - STILL_UNTIL).max(0.0);
    let along = -0.95 + 0.68 * walked / PERSON_PERIOD;
    Ok(Subject::person_at(walked).transformed(&Isometry3::translation(along, 0.0, 0.0)))
}

/// Adds rows of boxes along y, one row upon the other, from the floor up.
fn add_pyramid(simulation: &mut Simulation) -> Result<()> {
    for (row, colour) in COLOURS.into_iter().enumerate() {
        let count = ROWS - row;
        for k in 0..count {
            let y = SPACING * (k as f64 - 0.5 * (count - 1) as f64);
            let place = Isometry3::translation(0.3, y, BOX.z * (row as f64 + 0.5));
            simulation.add(&Shape::Box { sides: BOX }, &place, colour)?;
        }
    }
    Ok(())
}

fn stands_and_falls(log: &Log) -> Claim {
    let height = |entry: &Entry, i: usize| entry.states[i].pose.translation.vector;
    let moved = |from: &Entry, to: &Entry| {
        let ways = (0..from.states.len()).map(|i| (height(to, i) - height(from, i)).norm());
        ways.fold(0.0, f64::max)
    };
    let untouched = |entry: &&Entry| !entry.supports.contains(&Support::Subject);
    let standing: Vec<&Entry> = log.between(0.5, f64::INFINITY).take_while(untouched).collect();
    let (settled, before, end) =
        (standing[0], standing[standing.len() - 1], &log.entries[log.entries.len() - 1]);
    let (crept, thrown) = (1e3 * moved(settled, before), moved(before, end));
    let top = end.states[end.states.len() - 1].pose.translation.z;
    let text = format!(
        "in {:.1} s before the touch the boxes moved by up to {crept:.2} mm; then by up to {thrown:.2} m, and the top one lies \
         at {top:.2} m",
        before.time - settled.time
    );
    Claim { holds: crept < 1.0 && top < 2.0 * BOX.z, text }
}
