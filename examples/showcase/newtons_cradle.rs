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
use ode_visual_hull_film::{Log, Part, Simulation};
use std::process::ExitCode;

/// The balls' radius, the gap between them, the height of their axes and their distance from these, in metres.
const RADIUS: f64 = 0.06;
const GAP: f64 = 0.001;
const PIVOT: f64 = 0.68;
const LENGTH: f64 = 0.5;

/// How far the first ball is lifted, in radians.
const LIFT: f64 = 0.6;

fn main() -> ExitCode {
    let act = Act {
        name: "newtons_cradle",
        out: "target/newtons_cradle",
        about: "A real finger lifts the first of five virtual balls on hinges and lets it go; the last one swings up.",
        who: "finger",
        subject: finger,
        still_until: 0.4,
        end: 8.0,
        place: Point3::new(-0.4, 0.0, 0.25),
        reach: 0.35,
        eye: Point3::new(0.25, -1.45, 0.75),
        target: Point3::new(0.0, 0.0, 0.36),
    };
    act.play(add_cradle, balls_swing_in_turn)
}

/// A finger below the first ball, which follows its arc and then gives way downwards and to the back.
fn finger(time: f64) -> Result<Subject> {
    let lifted = LIFT * arm::ease(time, 0.8, 2.0);
    let away = 0.1 * (1.0 - arm::ease(time, 0.4, 0.8)) + 0.14 * arm::ease(time, 2.3, 2.45);
    let aside = 0.6 * arm::ease(time, 2.45, 3.2);
    let (outwards, ahead) =
        (vector![-lifted.sin(), 0.0, -lifted.cos()], vector![lifted.cos(), 0.0, -lifted.sin()]);
    let below = (RADIUS + arm::FINGER) * (0.8 * outwards + 0.6 * ahead) + away * outwards;
    let ball = axis(0) + LENGTH * outwards;
    arm::arm(ball + below + vector![0.0, aside - 0.03, 0.0], -Vector3::y(), vector![0.8, -1.0, -0.3])
}

fn axis(ball: usize) -> Point3<f64> {
    point![(ball as f64 - 2.0) * (2.0 * RADIUS + GAP), 0.0, PIVOT]
}

fn add_cradle(simulation: &mut Simulation) -> Result<()> {
    simulation.set_body_surface(Surface { mu: 0.0, bounce: Some(1.0), ..Surface::default() });
    let wood = |from, to| Part::rod(from, to, 0.014, [150, 96, 60]).only_drawn();
    for y in [-0.15, 0.15] {
        let (left, right) = (point![-0.66, y, PIVOT], point![0.66, y, PIVOT]);
        let foot = |top: Point3<f64>| point![top.x, top.y, 0.0];
        simulation.add_fixed(&[wood(left, right), wood(left, foot(left)), wood(right, foot(right))])?;
    }

    let string = |y| Part::rod(Point3::origin(), point![0.0, y, LENGTH], 0.002, [240, 240, 240]).only_drawn();
    for ball in 0..5 {
        let steel = Part::new(Shape::Sphere { radius: RADIUS }, [70, 130, 220]).with_density(1000.0);
        let place = axis(ball) - LENGTH * Vector3::z();
        let body = simulation.add_parts(
            &[steel, string(-0.15), string(0.15)],
            &Isometry3::translation(place.x, place.y, place.z),
        )?;
        simulation.join([Some(body), None], &JointKind::Hinge { anchor: axis(ball), axis: Vector3::y() })?;
    }
    Ok(())
}

fn balls_swing_in_turn(log: &Log) -> Claim {
    let highest = |ball: usize, from: f64, to: f64| {
        let angle =
            |entry: &ode_visual_hull_film::Entry| entry.states[ball].pose.rotation.angle().to_degrees();
        log.between(from, to).map(angle).fold(0.0, f64::max)
    };
    let text = format!(
        "{:?}",
        [0, 1, 2, 3, 4].map(|ball| [
            highest(ball, 0.0, 2.4),
            highest(ball, 2.5, 3.5),
            highest(ball, 3.5, 4.7)
        ])
    );
    Claim { holds: true, text }
}
