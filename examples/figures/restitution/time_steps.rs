//! The error of a ball that bounces and of a box that slides, for shorter and shorter steps.

use super::{Ground, bouncing};
use crate::studio::*;
use nalgebra::vector;
use ode_visual_hull::ode::{Shape, Surface, World};
use ode_visual_hull_testing::figure::{Bound::AtLeast, Figure};
use ode_visual_hull_testing::world::add_body;

/// Steps a second.
const RATES: [f64; 5] = [60.0, 120.0, 240.0, 480.0, 960.0];

/// Number of drops at each rate. Their heights are spread over the way of one of the longest steps at the
/// impact, since the error of one drop depends on when in a step it hits.
const DROPS: u32 = 64;

const GRAVITY: f64 = 9.81;

/// The errors at each rate, in millimetres, and `error_over_dt_falls`: 1 if both errors fall with each
/// shorter step.
pub fn figures([hull, native]: &[Ground; 2], progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("errors over steps of 1/60 to 1/960 s");
    let mut figures = Vec::new();
    for (ground, suffix) in [(hull, ""), (native, "_native")] {
        let mut falls = true;
        for (name, error) in [("bounce", bounce_error as fn(&Ground, f64) -> f64), ("slide", slide_error)] {
            let errors = RATES.map(|rate| error(ground, rate));
            falls &= errors.windows(2).all(|pair| pair[1] < pair[0]);
            figures.extend(RATES.iter().zip(errors).map(|(rate, error)| {
                Figure::reported(&format!("{name}_error{suffix}_{rate}_hz_mm"), 1e3 * error)
            }));
        }
        let (name, falls) = (format!("error_over_dt_falls{suffix}"), f64::from(u8::from(falls)));
        figures.push(match ground {
            Ground::Hull(_) => Figure::bounded(&name, falls, AtLeast(1.0)),
            Ground::Native => Figure::reported(&name, falls),
        });
    }
    figures
}

/// A world with ODE's own CFM. With a larger one contacts are the softer the shorter the step is: at 960 Hz
/// 1e-5 takes a hundredth of an impact's impulse from a body of 1 kg, on ODE's box too.
fn rigid_world(ground: &Ground) -> World {
    let mut world = ground.world();
    world.set_cfm(1e-10).expect("in range");
    world
}

/// The RMS error of the height of a ball that has bounced with a coefficient of restitution of 0.8, over
/// drops, at the moment when it ought to be highest again, in metres.
fn bounce_error(ground: &Ground, rate: f64) -> f64 {
    const RESTITUTION: f64 = 0.8;
    const RADIUS: f64 = 0.06;
    const HEIGHT: f64 = 0.3;
    let way = (2.0 * GRAVITY * HEIGHT).sqrt() / RATES[0];
    let errors: Vec<f64> = (0..DROPS)
        .map(|k| {
            let height = HEIGHT + way * f64::from(k) / f64::from(DROPS);
            let fall = (2.0 * height / GRAVITY).sqrt();
            let expected = RESTITUTION * RESTITUTION * height;

            // The moment is seldom the end of a step; between steps the ball is on a parabola.
            let (mut world, moment) = (rigid_world(ground), (1.0 + RESTITUTION) * fall);
            let start = at(0.03, -0.02, TOP + RADIUS + height);
            let (body, _) = add_body(&mut world, &Shape::Sphere { radius: RADIUS }, &start);
            let steps = (moment * rate) as usize;
            for _ in 0..steps {
                world.default_collide(&bouncing(0.5, RESTITUTION), 8).expect("a valid surface");
                world.step(1.0 / rate).expect("finite states");
            }
            let (rest, velocity) = (moment - steps as f64 / rate, world.body(body).linear_velocity().z);
            let reached = world.body(body).position().z + velocity * rest - 0.5 * GRAVITY * rest * rest;
            reached - (TOP + RADIUS) - expected
        })
        .collect();
    rms(&errors)
}

/// The error of the way on which a box slides until it stops, in metres.
fn slide_error(ground: &Ground, rate: f64) -> f64 {
    const SPEED: f64 = 1.0;
    const MU: f64 = 0.3;
    let (mut world, sides) = (rigid_world(ground), vector![0.12, 0.12, 0.04]);
    world.set_slip_friction(true);
    let (body, _) = add_body(&mut world, &Shape::Box { sides }, &at(-0.12, 0.0, TOP + 0.5 * sides.z));
    let mut run = |seconds: f64, speed: f64| {
        world.body_mut(body).set_linear_velocity(&vector![speed, 0.0, 0.0]).expect("finite");
        let start = world.body(body).position();
        for _ in 0..(seconds * rate) as usize {
            world.default_collide(&Surface::with_friction(MU), 8).expect("a valid surface");
            world.step(1.0 / rate).expect("finite states");
        }
        (world.body(body).position() - start).norm()
    };
    // It settles in the contacts' surface layer first.
    run(0.3, 0.0);
    (run(0.6, SPEED) - SPEED * SPEED / (2.0 * MU * GRAVITY)).abs()
}
