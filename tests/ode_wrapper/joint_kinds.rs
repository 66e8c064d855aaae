//! Joints of two and three axes: each moves along and about its axes, and in no other way.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{BodyId, JointAxis, JointId, JointKind, JointParam, JointType, Shape, World};

use crate::{GRAVITY, add, world};

const DT: f64 = 0.001;
/// The inertia of a cube about any axis through its centre is m a^2 / 6.
const INERTIA: f64 = 6.0 * 0.5 * 0.5 / 6.0;

/// A cube of 6 kg and 0.5 m.
fn cube(world: &mut World, at: [f64; 3]) -> BodyId {
    add(world, &Shape::cuboid(0.5, 0.5, 0.5), 6.0, at).0
}

fn weightless() -> World {
    let mut world = world();
    world.set_gravity(&Vector3::zeros()).unwrap();
    world
}

/// Steps `n` times while a force and a torque act on the body.
fn push(world: &mut World, n: usize, body: BodyId, force: Vector3<f64>, torque: Vector3<f64>) {
    for _ in 0..n {
        world.body_mut(body).add_force(&force).unwrap();
        world.body_mut(body).add_torque(&torque).unwrap();
        world.step(DT).unwrap();
    }
}

/// A wheel that hangs at a kinematic chassis, steered about z, with its axle along y.
fn wheel(world: &mut World, mass: f64) -> (BodyId, JointId) {
    let chassis = cube(world, [0.0, 0.0, 1.0]);
    world.body_mut(chassis).set_kinematic(true);
    let (wheel, _) = add(world, &Shape::Sphere { radius: 0.2 }, mass, [0.0; 3]);
    let kind = JointKind::Hinge2 { anchor: Point3::origin(), axes: [Vector3::z(), Vector3::y()] };
    (wheel, world.add_joint([Some(chassis), Some(wheel)], &kind).unwrap())
}

#[test]
fn a_wheel_steers_about_the_first_axis_of_a_hinge2_and_spins_about_the_second() {
    let mut world = weightless();
    let (wheel, joint) = wheel(&mut world, 1.0);
    let mut joint_mut = world.joint_mut(joint);
    for (axis, velocity) in [(JointAxis::First, 0.5), (JointAxis::Second, 10.0)] {
        joint_mut.set_param_of_axis(axis, JointParam::MotorVelocity, velocity).unwrap();
        joint_mut.set_param_of_axis(axis, JointParam::MotorMaxForce, 100.0).unwrap();
    }
    push(&mut world, 1000, wheel, Vector3::zeros(), Vector3::zeros());

    let view = world.joint(joint);
    // A step takes the motor's velocity over at once; turning the axle takes up some of the solver's precision.
    assert!((view.angle_rate_of(JointAxis::First).unwrap() - 0.5).abs() < 1e-3);
    assert!((view.angle_rate_of(JointAxis::Second).unwrap() - 10.0).abs() < 1e-2);
    assert!((view.angle().unwrap() - 0.5).abs() < 1e-2, "{:?}", view.angle());
    assert!(view.angle_of(JointAxis::Second).is_some() && view.angle_of(JointAxis::Third).is_none());

    // Rates are of the first body against the second, so the wheel turns the other way.
    let axle = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -0.5) * Vector3::y();
    assert!((view.axis_of(JointAxis::Second).unwrap() - axle).norm() < 1e-2);
    assert!(world.body(wheel).position().coords.norm() < 1e-3);
}

#[test]
fn a_suspension_sags_by_the_weight_over_the_spring_constant() {
    let (mass, spring, damper) = (2.0, 1000.0, 100.0);
    let mut world = world();
    let (wheel, joint) = wheel(&mut world, mass);
    let softness = 1.0 / (DT * spring + damper);
    let mut joint_mut = world.joint_mut(joint);
    joint_mut.set_param(JointParam::SuspensionErp, DT * spring * softness).unwrap();
    joint_mut.set_param(JointParam::SuspensionCfm, softness).unwrap();
    assert_eq!(joint_mut.view().param(JointParam::SuspensionCfm), Some(softness));

    // The slower root of the damped spring is 13.8 per second: e^-27 of the start remains after 2 s.
    push(&mut world, 2000, wheel, Vector3::zeros(), Vector3::zeros());
    let sag = -world.body(wheel).position().z;
    assert!((sag - mass * GRAVITY / spring).abs() < 1e-6, "{sag}");
    let view = world.joint(joint);
    assert!((view.anchor().unwrap() - view.anchor2().unwrap() - Vector3::new(0.0, 0.0, sag)).norm() < 1e-6);
}

#[test]
fn the_axes_of_a_universal_joint_stay_perpendicular_while_both_turn() {
    let mut world = weightless();
    let bodies = [cube(&mut world, [-0.5, 0.0, 0.0]), cube(&mut world, [0.5, 0.0, 0.0])];
    let kind = JointKind::Universal { anchor: Point3::origin(), axes: [Vector3::y(), Vector3::z()] };
    let joint = world.add_joint(bodies.map(Some), &kind).unwrap();
    world.body_mut(bodies[0]).set_angular_velocity(&Vector3::new(0.0, 2.0, 0.5)).unwrap();
    world.body_mut(bodies[1]).set_angular_velocity(&Vector3::new(0.3, 0.0, -1.0)).unwrap();

    let mut turned = [0.0_f64; 2];
    for _ in 0..2000 {
        world.step(DT).unwrap();
        let view = world.joint(joint);
        let [first, second] = [JointAxis::First, JointAxis::Second].map(|axis| view.axis_of(axis).unwrap());
        // A step at these speeds turns by 2 mrad, and the error is of its square.
        assert!(first.dot(&second).abs() < 1e-3);
        assert!((view.anchor().unwrap() - view.anchor2().unwrap()).norm() < 1e-3);
        turned[0] = turned[0].max(view.angle_of(JointAxis::First).unwrap().abs());
        turned[1] = turned[1].max(view.angle_of(JointAxis::Second).unwrap().abs());
    }
    assert!(turned.iter().all(|&angle| angle > 0.5), "{turned:?}");
}

#[test]
fn a_pr_joint_slides_along_its_first_axis_and_turns_about_its_second() {
    let kind = JointKind::PrismaticRotoide { anchor: Point3::origin(), axes: [Vector3::x(), Vector3::z()] };
    let joint_of = |world: &mut World| {
        let body = cube(world, [0.0; 3]);
        (body, world.add_joint([Some(body), None], &kind).unwrap())
    };

    let mut world = weightless();
    let (body, joint) = joint_of(&mut world);
    push(&mut world, 1000, body, Vector3::new(12.0, 0.0, 5.0), Vector3::new(3.0, 3.0, 0.0));
    let view = world.joint(joint);
    // F t^2 / 2 m, to first order in the step; what is blocked moves by the solver's compliance.
    assert!((view.position().unwrap() - 1.0).abs() < 2e-3, "{:?}", view.position());
    assert!((view.position_rate().unwrap() - 2.0).abs() < 1e-6);
    assert!((world.body(body).position() - Point3::new(1.0, 0.0, 0.0)).norm() < 2e-3);

    let mut world = weightless();
    let (body, joint) = joint_of(&mut world);
    for _ in 0..1000 {
        world.joint_mut(joint).add_torque(JointAxis::Second, 0.5).unwrap();
        world.step(DT).unwrap();
    }
    assert!((world.joint(joint).angle_rate().unwrap() - 0.5 / INERTIA).abs() < 1e-6);
    assert!((world.joint(joint).angle().unwrap() - 0.25 / INERTIA).abs() < 2e-3);
    assert!((world.body(body).angular_velocity() - Vector3::z() * (0.5 / INERTIA)).norm() < 1e-6);
}

#[test]
fn a_pu_joint_slides_along_its_third_axis_and_does_not_turn_about_it() {
    let mut world = weightless();
    let body = cube(&mut world, [0.0; 3]);
    let axes = [Vector3::y(), Vector3::z(), Vector3::x()];
    let kind = JointKind::PrismaticUniversal { anchor: Point3::origin(), axes };
    let joint = world.add_joint([Some(body), None], &kind).unwrap();
    assert_eq!(JointAxis::ALL.map(|axis| world.joint(joint).axis_of(axis).unwrap()), axes);

    push(&mut world, 1000, body, Vector3::new(12.0, 5.0, 5.0), Vector3::new(3.0, 0.0, 0.0));
    assert!((world.joint(joint).position().unwrap() - 1.0).abs() < 2e-3);
    assert!((world.body(body).position() - Point3::new(1.0, 0.0, 0.0)).norm() < 2e-3);
    assert!(world.body(body).angular_velocity().norm() < 1e-6);

    // A motor on the slider stops it, and one on an axis of the universal joint turns the body.
    let mut joint_mut = world.joint_mut(joint);
    joint_mut.set_param_of_axis(JointAxis::Third, JointParam::MotorMaxForce, 1000.0).unwrap();
    joint_mut.set_param_of_axis(JointAxis::First, JointParam::MotorMaxForce, 1000.0).unwrap();
    joint_mut.set_param_of_axis(JointAxis::First, JointParam::MotorVelocity, 0.5).unwrap();
    push(&mut world, 100, body, Vector3::zeros(), Vector3::zeros());
    assert!((world.joint(joint).angle_rate().unwrap() - 0.5).abs() < 1e-3);
    assert!(world.joint(joint).position_rate().unwrap().abs() < 1e-2);
}

#[test]
fn a_piston_slides_along_its_axis_and_spins_about_it() {
    let mut world = world();
    let body = cube(&mut world, [1.0, 2.0, 3.0]);
    let kind = JointKind::Piston { anchor: Point3::new(1.0, 2.0, 0.0), axis: Vector3::z() };
    let joint = world.add_joint([Some(body), None], &kind).unwrap();
    world.body_mut(body).set_angular_velocity(&Vector3::new(0.0, 0.0, 1.0)).unwrap();
    push(&mut world, 500, body, Vector3::new(5.0, 5.0, 0.0), Vector3::new(3.0, 3.0, 0.0));

    let fall = GRAVITY * 0.5 * 0.5 / 2.0;
    let (view, at) = (world.joint(joint), world.body(body).position());
    assert!((at - Point3::new(1.0, 2.0, 3.0 - fall)).norm() < 5e-3, "{at}");
    assert!((view.position().unwrap().abs() - fall).abs() < 5e-3);
    assert!((view.angle().unwrap().abs() - 0.5).abs() < 1e-6, "{:?}", view.angle());
    assert!((view.angle_rate_of(JointAxis::Second).unwrap().abs() - 1.0).abs() < 1e-6);

    // A force along the axis that carries the weight.
    let speed = world.body(body).linear_velocity().z;
    for _ in 0..100 {
        world.joint_mut(joint).add_force(6.0 * GRAVITY).unwrap();
        world.step(DT).unwrap();
    }
    assert!((world.body(body).linear_velocity().z - speed).abs() < 1e-6);
}

#[test]
fn a_plane2d_joint_keeps_a_body_in_the_plane_and_drives_it_there() {
    let mut world = world();
    let body = cube(&mut world, [0.0; 3]);
    let joint = world.add_joint([Some(body), None], &JointKind::Plane2d).unwrap();
    assert_eq!(world.joint(joint).joint_type(), JointType::Plane2d);
    push(&mut world, 500, body, Vector3::new(12.0, 0.0, 0.0), Vector3::new(3.0, 3.0, INERTIA));
    let view = world.body(body);
    assert!(view.position().z.abs() < 1e-6 && (view.linear_velocity().x - 1.0).abs() < 1e-6);
    assert!((view.angular_velocity() - Vector3::z() * 0.5).norm() < 1e-6, "{}", view.angular_velocity());

    let mut joint = world.joint_mut(joint);
    for (axis, velocity) in JointAxis::ALL.into_iter().zip([-1.0, 2.0, 3.0]) {
        joint.set_param_of_axis(axis, JointParam::MotorVelocity, velocity).unwrap();
        joint.set_param_of_axis(axis, JointParam::MotorMaxForce, 1e4).unwrap();
    }
    push(&mut world, 10, body, Vector3::zeros(), Vector3::zeros());
    assert!((world.body(body).linear_velocity() - Vector3::new(-1.0, 2.0, 0.0)).norm() < 1e-6);
    assert!((world.body(body).angular_velocity() - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-6);
}
