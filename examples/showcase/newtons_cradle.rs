//! A real finger lifts the first ball of Newton's cradle and lets it go.

mod act;
mod arm;
#[path = "../shared/mod.rs"]
mod shared;

use act::{Act, Claim};
use nalgebra::{Isometry3, Point3, Vector3, point, vector};
use ode_visual_hull::Result;
use ode_visual_hull::ode::{JointKind, Shape, Surface};
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_film::{Entry, Log, Part, Simulation};
use std::process::ExitCode;

/// The balls' radius, their distance below their axes, the height of these, and the distance from one to the next, in metres:
/// with a gap, so that ODE passes impulses on from ball to ball.
const RADIUS: f64 = 0.06;
const LENGTH: f64 = 0.5;
const HEIGHT: f64 = 0.68;
const SPACING: f64 = 2.0 * RADIUS + 0.001;

/// How far the first ball is lifted, in radians.
const LIFT: f64 = 0.6;

fn main() -> ExitCode {
    let act = Act {
        about: "A real finger lifts the first of five virtual balls and lets it go; the last one swings up.",
        who: "finger",
        subject: finger,
        still_until: 0.4,
        end: 8.0,
        place: point![-0.4, 0.0, 0.25],
        reach: 0.35,
        eye: point![0.15, -1.75, 0.85],
        target: point![-0.02, 0.0, 0.36],
    };
    act.play(add_cradle, outer_balls_swing)
}

/// A finger below the first ball, which follows its arc, gives way downwards and draws back.
fn finger(time: f64) -> Result<Subject> {
    let (sin, cos) = (LIFT * arm::ease(time, 0.8, 2.0)).sin_cos();
    let (down, ahead) = (vector![-sin, 0.0, -cos], vector![cos, 0.0, -sin]);
    let away = 0.1 * (1.0 - arm::ease(time, 0.4, 0.8)) + 0.14 * arm::ease(time, 2.3, 2.45);
    let below = (RADIUS + arm::FINGER) * (0.8 * down + 0.6 * ahead) + away * down;
    let reach = vector![0.45, -1.0, -0.35];
    let back = vector![0.0, -0.03, 0.0] - 0.9 * arm::ease(time, 2.45, 3.4) * reach;
    arm::arm(axis(0) + LENGTH * down + below + back, -Vector3::y(), reach)
}

fn axis(ball: usize) -> Point3<f64> {
    point![(ball as f64 - 2.0) * SPACING, 0.0, HEIGHT]
}

fn add_cradle(simulation: &mut Simulation) -> Result<()> {
    simulation.set_body_surface(Surface { mu: 0.0, bounce: Some(1.0), ..Surface::default() });
    let string = |y| Part::rod(Point3::origin(), point![0.0, y, LENGTH], 0.003, [240; 3]).only_drawn();
    let wood = |from, to| Part::rod(from, to, 0.014, [240, 150, 60]).only_drawn();
    for ball in 0..5 {
        let steel = Part::new(Shape::Sphere { radius: RADIUS }, [70, 130, 220]).with_density(1000.0);
        let pose = Isometry3::from((axis(ball) - LENGTH * Vector3::z()).coords);
        let body = simulation.add_parts(&[steel, string(-0.15), string(0.15)], &pose)?;
        simulation.join([Some(body), None], &JointKind::Hinge { anchor: axis(ball), axis: Vector3::y() })?;
    }
    for (x, y) in [(-0.66, -0.15), (0.66, -0.15), (0.66, 0.15), (-0.66, 0.15)] {
        let top = point![x, y, HEIGHT];
        simulation.add_fixed(&[wood(top, point![x, y, 0.0]), wood(top, point![0.0, y, HEIGHT])])?;
    }
    Ok(())
}

fn outer_balls_swing(log: &Log) -> Claim {
    let angle = |entry: &Entry, ball: usize| entry.states[ball].pose.rotation.angle().to_degrees();
    let swing = |ball| log.between(6.0, 8.0).map(|entry| angle(entry, ball)).fold(0.0, f64::max);
    let ([first, middle, last], lifted) = ([0, 2, 4].map(swing), LIFT.to_degrees());
    let text =
        format!("the outer balls still swing {first:.1} and {last:.1} degrees, the middle {middle:.1}");
    Claim { holds: first.min(last) > 0.7 * lifted && middle < 0.2 * lifted, text }
}
