//! Scenes of bodies that fall, slide, roll, are stacked and swing, on a table and on a ramp.
//!
//! Each scene runs twice by the same code: on ODE's box, which gives the reference file of the scene's name, and on the
//! hull of that box.

pub mod compare;
pub mod reference;
pub mod rig;
pub mod stage;

use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3, point, vector};
use ode_visual_hull::ode::{JointKind, Shape, Surface};
use rig::{RAMP, Rig, TABLE};
use stage::{Ends, InitialState, Scene};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Height that bodies are dropped from, in metres.
const DROP: f64 = 0.1;

const CUBE: Shape = Shape::Box { sides: Vector3::new(0.2, 0.2, 0.2) };
const BALL: Shape = Shape::Sphere { radius: 0.08 };
const CAPSULE: Shape = Shape::Capsule { radius: 0.05, length: 0.15 };
const CYLINDER: Shape = Shape::Cylinder { radius: 0.08, length: 0.2 };

/// All scenes.
pub fn all() -> Vec<Scene> {
    let mut scenes = drops();
    scenes.extend(edge_first_drops());
    scenes.extend(slides());
    scenes.extend(rolls());
    scenes.extend([stack(), pendulum_ball(), pendulum_box()]);
    scenes
}

/// A body at rest with its centre `height` metres above the top of `rig`, at `(x, y)` in the frame of the rig's box.
fn above(rig: &Rig, shape: &Shape, x: f64, y: f64, height: f64, turn: UnitQuaternion<f64>) -> InitialState {
    let box_from_body = Isometry3::from_parts(Translation3::new(x, y, rig.top() + height), turn);
    let pose = rig.world_from_box * box_from_body;
    InitialState { shape: shape.clone(), pose, velocity: Vector3::zeros(), spin: Vector3::zeros() }
}

fn euler(roll: f64, pitch: f64, yaw: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

/// Turns the z axis of a body to y of the box, so that the body rolls along x.
fn lying() -> UnitQuaternion<f64> {
    euler(FRAC_PI_2, 0.0, 0.0)
}

fn drop(name: &'static str, about: &'static str, body: InitialState) -> Scene {
    Scene {
        name,
        about,
        rig: &TABLE,
        bodies: vec![body],
        joint: None,
        surface: Surface::default(),
        ends: Ends::AtRest,
        edge_first: false,
    }
}

fn drops() -> Vec<Scene> {
    let onto = |shape: &Shape, half: f64, turn| above(&TABLE, shape, 0.03, -0.02, half + DROP, turn);

    let mut thrown = onto(&CUBE, 0.1, euler(0.0, 0.0, 0.3));
    thrown.velocity = vector![-0.6, 0.3, 0.0];

    let mut bouncing = drop(
        "sphere_bounces",
        "a sphere dropped from 10 cm, restitution one half",
        onto(&BALL, 0.08, euler(0.0, 0.0, 0.0)),
    );
    bouncing.surface = Surface { bounce: Some(0.5), bounce_velocity: 0.1, ..Surface::default() };

    vec![
        drop("box_dropped", "a cube dropped from 10 cm on its face", onto(&CUBE, 0.1, euler(0.0, 0.0, 0.3))),
        drop("sphere_dropped", "a sphere dropped from 10 cm", onto(&BALL, 0.08, euler(0.0, 0.0, 0.0))),
        drop(
            "capsule_dropped",
            "a capsule dropped from 10 cm on its side",
            onto(&CAPSULE, 0.05, euler(FRAC_PI_2, 0.0, 0.4)),
        ),
        drop(
            "cylinder_dropped",
            "a cylinder dropped from 10 cm on its flat end",
            onto(&CYLINDER, 0.1, euler(0.0, 0.0, 0.0)),
        ),
        drop(
            "cylinder_dropped_lying",
            "a cylinder dropped from 10 cm on its side",
            onto(&CYLINDER, 0.08, euler(FRAC_PI_2, 0.0, 0.4)),
        ),
        drop(
            "box_thrown",
            "a cube thrown level at 0.67 m/s from 10 cm, lands on its face and slides",
            thrown,
        ),
        bouncing,
    ]
}

fn edge_first_drops() -> Vec<Scene> {
    // The lowest point of each body is 10 cm above the table.
    let onto = |shape: &Shape, lowest: f64, turn| above(&TABLE, shape, 0.02, -0.03, lowest + DROP, turn);
    let (sin, cos) = 0.5f64.sin_cos();

    // Cube: tilted by 30 degrees about y, then turned about z.
    let edge = euler(0.0, 30f64.to_radians(), 0.3);
    let edge_low = 0.1 * (30f64.to_radians().cos() + 0.5);

    let corner = euler(0.4, 0.5, 0.2);
    let corner_low = 0.1 * (corner.inverse() * Vector3::z()).abs().sum();

    let scenes = [
        drop(
            "box_edge_first",
            "a cube tilted by 30 degrees, dropped from 10 cm on an edge",
            onto(&CUBE, edge_low, edge),
        ),
        drop(
            "box_corner_first",
            "a cube tilted about two axes, dropped from 10 cm on a corner",
            onto(&CUBE, corner_low, corner),
        ),
        drop(
            "cylinder_rim_first",
            "a cylinder leaning by 0.5 rad, dropped from 10 cm on its rim",
            onto(&CYLINDER, 0.1 * cos + 0.08 * sin, euler(0.5, 0.0, 0.3)),
        ),
        drop(
            "capsule_end_first",
            "a capsule leaning by 45 degrees, dropped from 10 cm on one end",
            onto(&CAPSULE, 0.075 * FRAC_PI_4.cos() + 0.05, euler(FRAC_PI_4, 0.0, 0.4)),
        ),
    ];

    scenes.map(|scene| Scene { edge_first: true, ..scene }).into()
}

fn slides() -> Vec<Scene> {
    let on_ramp = |x: f64| above(&RAMP, &CUBE, x, 0.04, 0.1, euler(0.0, 0.0, 0.2));
    let ramp = |name, about, mu, ends| Scene {
        rig: &RAMP,
        surface: Surface::with_friction(mu),
        ends,
        ..drop(name, about, on_ramp(-0.5))
    };

    let mut pushed = above(&TABLE, &CUBE, -0.12, 0.03, 0.1, euler(0.0, 0.0, 0.3));
    pushed.velocity = vector![1.0, 0.0, 0.0];

    vec![
        ramp("box_slides_ramp", "a cube slides down the ramp, friction 0.2", 0.2, Ends::OffSupport),
        ramp("box_holds_ramp", "a cube stays on the ramp, friction 0.6", 0.6, Ends::AtRest),
        Scene {
            surface: Surface::with_friction(0.3),
            ..drop(
                "box_slides_table",
                "a cube slides at 1 m/s over the table and stops, friction 0.3",
                pushed,
            )
        },
    ]
}

fn rolls() -> Vec<Scene> {
    let ramp = |name, about, shape: &Shape, radius, turn| Scene {
        rig: &RAMP,
        ends: Ends::OffSupport,
        ..drop(name, about, above(&RAMP, shape, -0.6, 0.04, radius, turn))
    };

    let table = |name, about, shape: &Shape, radius: f64, turn| {
        let mut body = above(&TABLE, shape, -0.2, 0.03, radius, turn);
        body.velocity = vector![0.4, 0.0, 0.0];
        body.spin = vector![0.0, 0.4 / radius, 0.0];
        Scene { ends: Ends::OffSupport, ..drop(name, about, body) }
    };

    let none = UnitQuaternion::identity();

    vec![
        ramp("sphere_rolls_ramp", "a sphere rolls down the ramp from rest", &BALL, 0.08, none),
        ramp(
            "cylinder_rolls_ramp",
            "a lying cylinder rolls down the ramp from rest",
            &CYLINDER,
            0.08,
            lying(),
        ),
        ramp("capsule_rolls_ramp", "a lying capsule rolls down the ramp from rest", &CAPSULE, 0.05, lying()),
        table("sphere_rolls_table", "a sphere rolls over the table at 0.4 m/s", &BALL, 0.08, none),
        table(
            "cylinder_rolls_table",
            "a lying cylinder rolls over the table at 0.4 m/s",
            &CYLINDER,
            0.08,
            lying(),
        ),
    ]
}

fn stack() -> Scene {
    let bodies = (0..3).map(|k| {
        let k = f64::from(k);
        // Each cube is a centimetre above the one below, and turned against it.
        above(&TABLE, &CUBE, 0.02, -0.01 * k, 0.11 + 0.21 * k, euler(0.0, 0.0, 0.2 * k))
    });
    Scene {
        bodies: bodies.collect(),
        ..drop(
            "stack",
            "three cubes, each turned by 0.2 rad against the one below, fall by 1 cm each on one another",
            above(&TABLE, &CUBE, 0.0, 0.0, 0.0, euler(0.0, 0.0, 0.0)),
        )
    }
}

/// A pendulum at the table's +x side, drawn back by 40 degrees: its bob, 0.7 m below the pivot, and the pivot.
fn pendulum(shape: &Shape, half: f64) -> (InitialState, nalgebra::Point3<f64>) {
    let pivot = point![TABLE.lengths.x / 2.0 + half, 0.06, 0.75];
    let swing = Isometry3::rotation_wrt_point(
        UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -40f64.to_radians()),
        pivot,
    );
    let pose = swing * Isometry3::translation(pivot.x, pivot.y, pivot.z - 0.7);
    let start =
        InitialState { shape: shape.clone(), pose, velocity: Vector3::zeros(), spin: Vector3::zeros() };
    (start, pivot)
}

fn pendulum_ball() -> Scene {
    let (start, pivot) = pendulum(&BALL, 0.08);
    Scene {
        joint: Some(JointKind::Ball { anchor: pivot }),
        ..drop(
            "pendulum_ball",
            "a sphere on a ball joint swings from 40 degrees into the table's side",
            start,
        )
    }
}

fn pendulum_box() -> Scene {
    let sides = vector![0.16, 0.16, 0.16];
    let (start, pivot) = pendulum(&Shape::Box { sides }, 0.08);
    Scene {
        joint: Some(JointKind::Hinge { anchor: pivot, axis: Vector3::y() }),
        ..drop("pendulum_box", "a cube on a hinge swings from 40 degrees into the table's side", start)
    }
}
