//! Contact events of bodies that are moved against a hull and away again, by a script, while masks are noisy and flicker:
//! each touch has to begin and to end once, at the right part.

use ode_visual_hull::hull::Motion;
use ode_visual_hull_testing::figure::{Bound::AtMost, Figure};
use ode_visual_hull_testing::touches::{Count, WAIT, play};

/// Scripted touches with a hull that is held, and with one in motion.
const TOUCHES: usize = 10_000;
const TOUCHES_IN_MOTION: usize = 1_000;

/// Scripted touches that end with the first step without a contact.
const TOUCHES_WITHOUT_WAIT: usize = 500;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress(&format!("{TOUCHES} touches of a hull that flickers"));
    let held = play(TOUCHES, Motion::Held, WAIT, 1);
    progress(&format!("{TOUCHES_IN_MOTION} touches of a hull in motion"));
    let moving = play(TOUCHES_IN_MOTION, Motion::Interpolated, WAIT, 2);
    // What the wait is for, and that the script finds what is doubled.
    let without_wait = play(TOUCHES_WITHOUT_WAIT, Motion::Held, 0.0, 3);

    let exactly = |name: &str, count: fn(&Count) -> usize, of: &Count| {
        Figure::bounded(name, count(of) as f64, AtMost(0.0))
    };
    vec![
        Figure::reported("events_touches", held.touches as f64),
        exactly("events_missed", |count| count.missed, &held),
        exactly("events_doubled", |count| count.doubled, &held),
        exactly("events_misplaced", |count| count.misplaced, &held),
        exactly("events_missed_in_motion", |count| count.missed, &moving),
        exactly("events_doubled_in_motion", |count| count.doubled, &moving),
        exactly("events_misplaced_in_motion", |count| count.misplaced, &moving),
        Figure::reported(
            "events_doubled_per_touch_without_wait",
            without_wait.doubled as f64 / without_wait.touches as f64,
        ),
    ]
}
