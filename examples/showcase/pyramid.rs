//! A real person walks through a pyramid of boxes.

mod act;
#[path = "../shared/mod.rs"]
mod shared;

use act::{Act, Claim};
use nalgebra::{Isometry3, Vector3, point};
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
        about: "A real person walks through a pyramid of 21 virtual boxes, which stands still before.",
        who: "person",
        subject: walker,
        still_until: STILL_UNTIL,
        end: 5.2,
        place: point![0.45, 0.0, 0.85],
        reach: 1.15,
        eye: point![2.75, -3.15, 1.75],
        target: point![0.65, 0.12, 0.6],
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
    let is_untouched = |entry: &&Entry| !entry.supports.contains(&Support::Subject);
    let standing: Vec<&Entry> = log.between(0.5, f64::INFINITY).take_while(is_untouched).collect();
    let (settled, touched, end) =
        (standing[0], standing[standing.len() - 1], &log.entries[log.entries.len() - 1]);

    let place = |entry: &Entry, i: usize| entry.states[i].pose.translation.vector;
    let ways = |from, to| (0..end.states.len()).map(move |i| (place(to, i) - place(from, i)).norm());
    let crept = 1e3 * ways(settled, touched).fold(0.0, f64::max);
    let thrown = ways(touched, end).filter(|&way| way > BOX.x).count();
    let seconds = touched.time - settled.time;
    let text = format!(
        "moved by {crept:.1} mm in {seconds:.1} s before the touch; then {thrown} of 21 boxes left their places"
    );
    Claim { holds: crept < 1.0 && thrown > 10, text }
}
