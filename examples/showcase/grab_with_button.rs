//! A real palm touches a virtual box, to which the box sticks while a button is held: the paper's section 7.

mod act;
mod grab_scene;
#[path = "../shared/hand_script.rs"]
mod hand_script;
#[path = "../shared/mod.rs"]
mod shared;

use grab_scene::*;
use hand_script::HandScript;
use std::process::ExitCode;

/// The gap between the hands, of which one touches the box, and the middle between them then, along x.
const GAP: f64 = 0.42;
const AWAY: f64 = -0.04;
const TOUCH: f64 = 0.5 * BOX[0] - 0.005 - 0.5 * GAP;

const HANDS: HandScript = HandScript {
    poses: &[
        (0.5, [AWAY, 0.0, LOW, 0.0]),
        (1.2, [TOUCH, 0.0, LOW, 0.0]),
        (1.4, [TOUCH, 0.0, LOW, 0.0]),
        (2.4, [TOUCH, 0.0, HIGH + 0.15, 0.0]),
        (3.4, [TOUCH, PLACE, HIGH + 0.15, 0.0]),
        (4.4, [TOUCH, PLACE, HIGH + 0.003, 0.0]),
        (4.8, [TOUCH, PLACE, HIGH + 0.003, 0.0]),
        (5.6, [AWAY, PLACE, HIGH + 0.003, 0.0]),
        (6.4, [AWAY, 0.1, HIGH + 0.1, 0.0]),
    ],
    gaps: &[(0.0, [GAP]), (1.0, [GAP])],
};

/// When the button is held, in seconds.
const HELD: std::ops::Range<f64> = 1.0..4.7;

fn main() -> ExitCode {
    let about = "A virtual box sticks to a real palm while a button is held.";
    act(about, |time| Ok(HANDS.subject(time)), 7.0).play(
        |simulation| {
            simulation.hold_during(&[HELD]);
            add_boxes(simulation)
        },
        stands_on_the_other,
    )
}
