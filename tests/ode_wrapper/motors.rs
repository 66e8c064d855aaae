//! Motors and torques: they reach their velocity, and pull no harder than they may.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{
    AxisFrame, BodyId, JointAxis, JointId, JointKind, JointParam, JointType, MotorAxis, Shape, World,
};

use crate::{add, world};

const DT: f64 = 0.001;
const MASS: f64 = 4.0;
/// The inertia of a cube of 0.3 m about any axis through its centre.
const INERTIA: f64 = MASS * 0.3 * 0.3 / 6.0;

fn weightless() -> World {
    let mut world = world();
    world.set_gravity(&Vector3::zeros()).unwrap();
    world
}

fn cube(world: &mut World) -> BodyId {
    add(world, &Shape::cuboid(0.3, 0.3, 0.3), MASS, [0.0; 3]).0
}

fn steps(world: &mut World, n: usize) {
    for _ in 0..n {
        world.step(DT).unwrap();
    }
}

/// Gives the motor of an axis a target velocity, and a largest force or torque.
fn drive(world: &mut World, joint: JointId, axis: JointAxis, velocity: f64, most: f64) {
    let mut joint = world.joint_mut(joint);
    joint.set_param_of_axis(axis, JointParam::MotorVelocity, velocity).unwrap();
    joint.set_param_of_axis(axis, JointParam::MotorMaxForce, most).unwrap();
}

#[test]
fn a_linear_motor_accelerates_with_its_largest_force_up_to_its_velocity() {
    let mut world = weightless();
    let body = cube(&mut world);
    let axes = [Some(MotorAxis::of_world(Vector3::x() * 7.0)), None, None];
    let joint = world.add_joint([Some(body), None], &JointKind::LinearMotor { axes }).unwrap();
    assert_eq!(world.joint(joint).axis(), Some(Vector3::x()));
    assert_eq!(world.joint(joint).axis_frame(JointAxis::First), Some(AxisFrame::World));
    assert_eq!(world.joint(joint).axis_of(JointAxis::Second), None);
    drive(&mut world, joint, JointAxis::First, 1.0, 2.0);

    // F = m a: 0.5 m/s after a second.
    steps(&mut world, 1000);
    assert!((world.body(body).linear_velocity() - Vector3::x() * (2.0 / MASS)).norm() < 1e-6);
    steps(&mut world, 2000);
    assert!((world.body(body).linear_velocity() - Vector3::x()).norm() < 1e-6);
}

#[test]
fn axes_of_a_motor_turn_with_the_body_that_they_belong_to() {
    for frame in [AxisFrame::World, AxisFrame::FirstBody, AxisFrame::SecondBody] {
        let mut world = weightless();
        let bodies = [cube(&mut world), cube(&mut world)];
        let axes = [Some(MotorAxis { direction: Vector3::x(), frame }), None, None];
        let kinds = [JointKind::LinearMotor { axes }, JointKind::AngularMotor { axes }];
        let joints = kinds.map(|kind| world.add_joint(bodies.map(Some), &kind).unwrap());

        let turns = [0.4, 1.1].map(|angle| UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle));
        for (body, turn) in bodies.into_iter().zip(turns) {
            let pose = Isometry3::from_parts(Translation3::identity(), turn);
            world.body_mut(body).set_pose(&pose).unwrap();
        }

        let expected = match frame {
            AxisFrame::World => Vector3::x(),
            AxisFrame::FirstBody => turns[0] * Vector3::x(),
            AxisFrame::SecondBody => turns[1] * Vector3::x(),
        };
        for joint in joints {
            assert!((world.joint(joint).axis().unwrap() - expected).norm() < 1e-12, "{frame:?}");
        }
        drive(&mut world, joints[0], JointAxis::First, 1.0, 100.0);
        steps(&mut world, 1);
        // The velocity is that of the first body against the second.
        let [first, second] = bodies.map(|body| world.body(body).linear_velocity());
        assert!((first - second).normalize().dot(&expected) > 1.0 - 1e-9, "{frame:?}");
    }
}

#[test]
fn an_angular_motor_accelerates_with_its_largest_torque_up_to_its_velocity() {
    let mut world = weightless();
    let body = cube(&mut world);
    let axes = [Vector3::x(), Vector3::z()].map(|axis| Some(MotorAxis::of_world(axis)));
    let kind = JointKind::AngularMotor { axes: [axes[0], axes[1], None] };
    let joint = world.add_joint([Some(body), None], &kind).unwrap();
    drive(&mut world, joint, JointAxis::Second, 2.0, 0.06);

    steps(&mut world, 1000);
    assert!((world.body(body).angular_velocity().z - 0.06 / INERTIA).abs() < 1e-6);
    steps(&mut world, 1000);
    assert!((world.body(body).angular_velocity() - Vector3::z() * 2.0).norm() < 1e-6);
    assert!((world.joint(joint).angle_rate_of(JointAxis::Second).unwrap() - 2.0).abs() < 1e-6);

    // The program measures the angle, and the motor compares it with the stop: beyond it the motion ends.
    let mut joint_mut = world.joint_mut(joint);
    joint_mut.set_param_of_axis(JointAxis::Second, JointParam::HighStop, 1.0).unwrap();
    joint_mut.set_motor_angle(JointAxis::Second, 1.0).unwrap();
    assert_eq!(joint_mut.view().angle_of(JointAxis::Second), Some(1.0));
    steps(&mut world, 10);
    assert!(world.body(body).angular_velocity().norm() < 1e-6);
}

#[test]
fn other_axes_replace_those_of_a_motor() {
    let mut world = weightless();
    let body = cube(&mut world);
    let none = [None; 3];
    for kind in [JointKind::LinearMotor { axes: none }, JointKind::AngularMotor { axes: none }] {
        let joint = world.add_joint([Some(body), None], &kind).unwrap();
        let mut joint = world.joint_mut(joint);
        assert!(JointAxis::ALL.iter().all(|&axis| joint.view().axis_of(axis).is_none()));

        let three =
            [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| Some(MotorAxis::of_first_body(axis)));
        joint.set_motor_axes(&three).unwrap();
        assert_eq!(joint.view().axis_of(JointAxis::Third), Some(Vector3::z()));
        joint.set_motor_axes(&[three[1], None, None]).unwrap();
        assert_eq!(joint.view().axis(), Some(Vector3::y()));
        assert_eq!(joint.view().axis_of(JointAxis::Second), None);

        for wrong in [
            [None, three[0], None],
            [Some(MotorAxis::of_world(Vector3::zeros())), None, None],
            [Some(MotorAxis::of_world(Vector3::repeat(f64::NAN))), None, None],
            [Some(MotorAxis::of_second_body(Vector3::x())), None, None],
        ] {
            assert!(joint.set_motor_axes(&wrong).is_err(), "{wrong:?}");
        }
        assert_eq!(joint.view().axis(), Some(Vector3::y()));
    }
}

#[test]
fn an_euler_motor_keeps_each_angle_within_its_stops() {
    let mut world = world();
    let body = add(&mut world, &Shape::cuboid(0.3, 0.2, 0.1), MASS, [0.5, 0.0, 0.0]).0;
    let ball = JointKind::Ball { anchor: Point3::origin() };
    world.add_joint([Some(body), None], &ball).unwrap();
    let motor = JointKind::EulerMotor { axes: [Vector3::x(), Vector3::z()] };
    let motor = world.add_joint([Some(body), None], &motor).unwrap();
    assert_eq!(world.joint(motor).joint_type(), JointType::EulerMotor);

    let stops = [0.2, 0.3, 0.15];
    for (axis, stop) in JointAxis::ALL.into_iter().zip(stops) {
        let mut joint = world.joint_mut(motor);
        joint.set_param_of_axis(axis, JointParam::LowStop, -stop).unwrap();
        joint.set_param_of_axis(axis, JointParam::HighStop, stop).unwrap();
    }
    world.body_mut(body).set_angular_velocity(&Vector3::new(1.0, 0.5, 2.0)).unwrap();

    let mut largest = [0.0_f64; 3];
    for _ in 0..3000 {
        world.step(DT).unwrap();
        let angles = JointAxis::ALL.map(|axis| world.joint(motor).angle_of(axis).unwrap());
        largest = std::array::from_fn(|i| largest[i].max(angles[i].abs()));
    }
    // At 2 rad/s a step goes 2 mrad beyond a stop before the stop acts.
    for (angle, stop) in largest.into_iter().zip(stops) {
        assert!(angle > stop - 0.01 && angle < stop + 0.01, "{largest:?}");
    }
    // Gravity has turned the body about y until the stop: it hangs at 0.3 rad.
    let down = world.body(body).position();
    assert!((down.z + 0.5 * 0.3_f64.sin()).abs() < 0.01, "{down}");
}

#[test]
fn torques_about_the_axes_of_joints_act_on_both_bodies() {
    let (anchor, axes) = (Point3::origin(), [Vector3::z(), Vector3::x()]);
    let motor_axes = axes.map(|axis| Some(MotorAxis::of_first_body(axis)));
    for (kind, axis) in [
        (JointKind::Hinge { anchor, axis: Vector3::z() }, JointAxis::First),
        (JointKind::Hinge2 { anchor, axes }, JointAxis::First),
        (JointKind::Universal { anchor, axes }, JointAxis::First),
        (JointKind::PrismaticRotoide { anchor, axes: [axes[1], axes[0]] }, JointAxis::Second),
        (JointKind::AngularMotor { axes: [motor_axes[1], motor_axes[0], None] }, JointAxis::Second),
    ] {
        let mut world = weightless();
        let bodies = [cube(&mut world), cube(&mut world)];
        let joint = world.add_joint(bodies.map(Some), &kind).unwrap();
        for _ in 0..100 {
            world.joint_mut(joint).add_torque(axis, 0.6).unwrap();
            world.step(DT).unwrap();
        }
        let speed = 0.6 * 0.1 / INERTIA;
        for (body, sign) in bodies.into_iter().zip([1.0, -1.0]) {
            let found = world.body(body).angular_velocity();
            assert!((found - Vector3::z() * sign * speed).norm() < 1e-3, "{kind:?}: {found}");
        }
    }
}
