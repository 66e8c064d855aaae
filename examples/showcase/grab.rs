//! Two bare hands put a virtual box on another one, by friction and the velocity of their surfaces alone.

mod act;
mod grab_scene;
#[path = "../shared/hand_script.rs"]
mod hand_script;
#[path = "../shared/mod.rs"]
mod shared;

use grab_scene::*;
use hand_script::HandScript;
use std::process::ExitCode;

/// The gap between open hands, and between hands that would be 12 mm in the box.
const OPEN: f64 = 0.32;
const SHUT: f64 = BOX[0] - 0.012;

const HANDS: HandScript = HandScript {
    poses: &[
        (1.3, [0.0, 0.0, LOW, 0.0]),
        (2.2, [0.0, 0.0, HIGH + 0.12, 0.0]),
        (3.2, [0.0, PLACE, HIGH + 0.12, 0.0]),
        (4.2, [0.0, PLACE, HIGH, 0.0]),
        (5.2, [0.0, PLACE, HIGH, 0.0]),
        (6.2, [0.0, 0.1, HIGH + 0.1, 0.0]),
    ],
    gaps: &[(0.5, [OPEN]), (1.2, [SHUT]), (4.4, [SHUT]), (5.0, [OPEN])],
};

fn main() -> ExitCode {
    let about = "Two bare hands put a virtual box on another one.";
    act(about, |time| Ok(HANDS.subject(time)), 7.0).play(add_boxes, stands_on_the_other)
}
