//! Hulls between frames: what the flow costs when a mask is set, and what a hull at the simulation's own time costs.
//!
//! Seven views see a walking person at 30 frames a second, with 60 boxes of 400 samples around.

use crate::session::{Session, StartTime};
use crate::timing::PairedBench;
use ode_visual_hull::hull::Motion;
use ode_visual_hull_bench::ours::{Boxes, Rig};
use ode_visual_hull_bench::scene::{Bodies, Optics, SAMPLES_400, Scene, VGA};
use ode_visual_hull_testing::figure::Bound;
use std::cell::Cell;

/// Number of views.
const VIEWS: usize = 7;

/// Times of the person's walk, in seconds, that are shown in turn, so that each mask is new.
const MOMENTS: [f64; 4] = [0.2, 0.2 + 1.0 / 30.0, 0.2 + 2.0 / 30.0, 0.2 + 3.0 / 30.0];

/// Frames before the first that is timed.
const WARM_UP: usize = 60;

/// Steps of the simulation in a frame: 240 a second.
const STEPS: usize = 8;

pub fn run_group(session: &mut Session) {
    let boxes = Boxes::new(&Bodies::scattered(60, SAMPLES_400));
    for (name, optics) in [("vga", Optics::Pinholes), ("vga_lens", Optics::Lenses)] {
        let scenes = MOMENTS.map(|time| Scene::person_at(time, VIEWS, VGA, optics));
        flow(session, name, &scenes);
        own_time(session, name, &scenes, &boxes);
    }
}

/// Measures how much longer it takes to set masks where motion is asked for.
fn flow(session: &mut Session, name: &str, scenes: &[Scene]) {
    let (held, moving, at) = (Rig::new(&scenes[0]), Rig::new(&scenes[0]), Cell::new(0));
    warm_up(&moving, scenes);

    let next = || {
        at.set((at.get() + 1) % scenes.len());
        &scenes[at.get()].masks
    };
    let bench = PairedBench::new().with("held", || held.publish(next())).with_prepared(
        "moving",
        || moving.at(Motion::Interpolated, 0.0),
        |_| moving.publish(next()),
    );
    let times = session.run(bench);

    let per_view = 1e3 * (times.seconds("moving") - times.seconds("held")) / VIEWS as f64;
    let bound = (name == "vga").then_some(Bound::AtMost(0.5));
    let what = "the flow of a mask, in milliseconds a view, while its mask is set";
    session.figure(&format!("flow_ms_{name}"), per_view, bound, StartTime::Masks, what);
}

/// Shows frames until all memory is that of past ones.
fn warm_up(rig: &Rig, scenes: &[Scene]) {
    for scene in scenes.iter().cycle().take(WARM_UP) {
        rig.publish(&scene.masks);
        rig.at(Motion::Interpolated, 0.0);
    }
}

/// Compares contacts at a fresh time in each step with contacts in a new held frame in each step.
fn own_time(session: &mut Session, name: &str, scenes: &[Scene], boxes: &Boxes) {
    let (held, moving, at) = (Rig::new(&scenes[0]), Rig::new(&scenes[0]), Cell::new(0));
    let mut contacts = [Vec::new(), Vec::new()];
    let [of_held, of_moving] = &mut contacts;
    let (step, time) = (Cell::new(0), Cell::new(0));
    warm_up(&moving, scenes);

    // A new frame comes after some steps, and its flow is not part of a step.
    let prepare = || {
        if time.get() % STEPS == 0 {
            moving.publish(&scenes[time.get() / STEPS % scenes.len()].masks);
        }
        time.set(time.get() + 1);
        (time.get() - 1) % STEPS
    };
    let bench = PairedBench::new()
        .with("held", || {
            at.set((at.get() + 1) % scenes.len());
            held.publish(&scenes[at.get()].masks).contacts(boxes, of_held);
        })
        .with_prepared("moving", prepare, |k| {
            step.set(k);
            moving.at(Motion::Interpolated, (k as f64 + 0.5) / STEPS as f64).contacts(boxes, of_moving);
        });
    let times = session.run(bench);

    let what =
        "set_time and contacts at a fresh time in each step, over a new mask in each step and its contacts";
    let ratio = times.ratio("moving", "held");
    let bound = (name == "vga").then_some(Bound::AtMost(2.0));
    session.figure(&format!("interpolated_over_held_query_{name}"), ratio, bound, StartTime::Masks, what);
    let what = "set_time and contacts of 60 boxes at a fresh time, in milliseconds";
    let name = format!("interpolated_query_{name}_ms");
    session.reported(&name, 1e3 * times.seconds("moving"), StartTime::Masks, what);
}
