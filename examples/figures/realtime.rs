//! A person among a hundred boxes by the wall clock: whether the simulation keeps up, and how late a mask's contact is.

use crate::studio::*;
use ode_visual_hull::hull::{HullData, Motion};
use ode_visual_hull::synthetic::coverage;
use ode_visual_hull_film::{FRAME_RATE, Pace, PaceReport, PacedFrames, Simulation, run_paced};
use ode_visual_hull_testing::figure::{
    Bound::{AtLeast, AtMost},
    Figure,
};
use std::sync::Arc;

// The scene of the example of this name.
#[path = "../figure1/scene.rs"]
#[allow(dead_code)]
mod scene;

/// Steps a second.
const STEP_RATE: f64 = 120.0;

/// How long each run is, in seconds.
const SECONDS: f64 = 15.0;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("a hundred boxes by the wall clock, interpolated");
    let interpolated = paced(Motion::Interpolated);
    progress("a hundred boxes by the wall clock, held");
    let held = paced(Motion::Held);

    // A mask waits for the step after it, which is the pace's and not the library's.
    let over_step = |part: f64| 1e3 * (held.latency(part).unwrap_or(f64::INFINITY) - 1.0 / STEP_RATE);
    let dropped = interpolated.frames.dropped + interpolated.steps.dropped;
    vec![
        Figure::bounded("figure1_realtime_factor", interpolated.realtime_factor(), AtLeast(1.0)),
        Figure::bounded("figure1_mixed_hulls", (interpolated.mixed + held.mixed) as f64, AtMost(0.0)),
        Figure::reported("figure1_dropped", dropped as f64),
        Figure::reported("figure1_late_steps", interpolated.steps.late as f64),
        Figure::reported("latency_mask_to_contact_over_step_p50_ms", over_step(0.5)),
        Figure::reported("latency_mask_to_contact_over_step_p99_ms", over_step(0.99)),
    ]
}

fn paced(motion: Motion) -> PaceReport {
    let cameras = scene::cameras().expect("cameras that look at the middle");
    let data = Arc::new(HullData::new());
    data.add_views(&cameras).expect("names of their own");
    data.set_bounds(scene::bounds().expect("a volume")).expect("a volume");
    let frames = (scene::PERIOD * FRAME_RATE).round() as usize;
    let film: Vec<_> = (0..frames)
        .map(|k| masks(&cameras, &scene::Wanderer::walked(k as f64 / FRAME_RATE), coverage))
        .collect();

    let mut simulation = Simulation::new(&data, scene::PIXEL, motion).expect("ODE");
    scene::add_boxes(&mut simulation).expect("boxes that can be drawn");
    let film = PacedFrames::in_a_loop(film, FRAME_RATE).expect("frames");
    let pace = Pace { step_rate: STEP_RATE, seconds: SECONDS };
    run_paced(&film, &data, &mut simulation, &pace, &mut |_, _| ()).expect("masks of the cameras")
}
