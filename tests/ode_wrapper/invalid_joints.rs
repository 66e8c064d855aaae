//! What ODE aborts on, or mishandles, is refused with an error: bodies, axes and parameters that a joint cannot have.

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{
    BodyId, JointAxis, JointId, JointKind, JointParam, JointType, MotorAxis, Shape, World,
};

use crate::{add, world};

const ORIGIN: Point3<f64> = Point3::new(0.0, 0.0, 0.0);

fn ball(world: &mut World, x: f64) -> BodyId {
    add(world, &Shape::Sphere { radius: 0.1 }, 1.0, [x, 0.0, 0.0]).0
}

/// A joint of each kind that has axes, with valid ones.
fn kinds() -> [JointKind; 9] {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let motor = [Some(MotorAxis::of_first_body(x)), None, None];
    [
        JointKind::Hinge2 { anchor: ORIGIN, axes: [x, y] },
        JointKind::Universal { anchor: ORIGIN, axes: [x, y] },
        JointKind::PrismaticRotoide { anchor: ORIGIN, axes: [x, y] },
        JointKind::PrismaticUniversal { anchor: ORIGIN, axes: [x, y, z] },
        JointKind::Piston { anchor: ORIGIN, axis: x },
        JointKind::LinearMotor { axes: motor },
        JointKind::AngularMotor { axes: motor },
        JointKind::EulerMotor { axes: [x, y] },
        JointKind::Plane2d,
    ]
}

/// The turn of 120 degrees about (1, 1, 1) maps y to x without a rounding error, so that ODE finds parallel axes.
fn turn_y_to_x(world: &mut World, body: BodyId) {
    let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.5, -0.5, -0.5, -0.5));
    assert_eq!(turn * Vector3::y(), Vector3::x());
    world.body_mut(body).set_pose(&Isometry3::from_parts(Translation3::new(1.0, 0.0, 0.0), turn)).unwrap();
}

/// Whether the joint's two bodies carry an axis each, which must not be parallel.
fn is_crossed(kind: &JointKind) -> bool {
    use JointType::{EulerMotor, Hinge2, PrismaticUniversal, Universal};
    matches!(kind.joint_type(), Hinge2 | Universal | PrismaticUniversal | EulerMotor)
}

#[test]
fn each_kind_of_joint_connects_only_the_bodies_that_it_can() {
    let mut world = world();
    let bodies = [0.0, 1.0].map(|x| Some(ball(&mut world, x)));
    for kind in kinds() {
        let (two, one_first) = match kind.joint_type() {
            JointType::Hinge2 => (true, false),
            JointType::Plane2d => (false, true),
            _ => (true, true),
        };
        let cases = [
            (bodies, two),
            ([bodies[0], None], one_first),
            ([None, bodies[0]], false),
            ([None, None], false),
        ];
        for (bodies, valid) in cases {
            let before = world.joints().count();
            let added = world.add_joint(bodies, &kind);
            assert_eq!(added.is_ok(), valid, "{kind:?} between {bodies:?}");
            assert_eq!(world.joints().count(), before + usize::from(valid));

            // Attaching obeys the rules of creation.
            let Ok(joint) = added else { continue };
            for (bodies, valid) in cases {
                assert_eq!(world.joint_mut(joint).attach(bodies).is_ok(), valid, "{kind:?} to {bodies:?}");
            }
            world.remove_joint(joint);
        }
    }
    let message = world.add_joint([None, bodies[0]], &kinds()[4]).unwrap_err().to_string();
    assert!(message.contains("Piston") && message.contains("expected a body before the world"), "{message}");
}

#[test]
fn axes_at_a_wrong_angle_are_refused() {
    let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
    let mut world = world();
    let bodies = [0.0, 1.0].map(|x| Some(ball(&mut world, x)));
    let add = |world: &mut World, kind: JointKind| world.add_joint(bodies, &kind);

    for oblique in [x + y, x, -x, Vector3::zeros(), Vector3::repeat(f64::NAN), Vector3::repeat(f64::INFINITY)]
    {
        let axes = [x, oblique];
        assert!(add(&mut world, JointKind::Universal { anchor: ORIGIN, axes }).is_err());
        assert!(add(&mut world, JointKind::PrismaticRotoide { anchor: ORIGIN, axes }).is_err());
        assert!(
            add(&mut world, JointKind::PrismaticUniversal { anchor: ORIGIN, axes: [x, oblique, z] }).is_err()
        );
        assert!(add(&mut world, JointKind::EulerMotor { axes }).is_err());
        // A hinge2 joint keeps any angle but 0.
        let hinge2 = add(&mut world, JointKind::Hinge2 { anchor: ORIGIN, axes });
        assert_eq!(hinge2.is_ok(), oblique == x + y, "{oblique}");
    }

    let message =
        add(&mut world, JointKind::Universal { anchor: ORIGIN, axes: [x, x + y] }).unwrap_err().to_string();
    assert!(message.contains("perpendicular") && message.contains("45"), "{message}");
    assert!(add(&mut world, JointKind::Piston { anchor: ORIGIN, axis: Vector3::zeros() }).is_err());
    let nan = Point3::new(f64::NAN, 0.0, 0.0);
    assert!(add(&mut world, JointKind::Piston { anchor: nan, axis: x }).is_err());
    assert!(add(&mut world, JointKind::Hinge2 { anchor: nan, axes: [x, y] }).is_err());
}

#[test]
fn joints_are_created_between_bodies_in_which_the_axes_of_ode_s_new_joints_are_parallel() {
    for kind in kinds().iter().filter(|kind| is_crossed(kind)) {
        let mut world = world();
        let bodies = [0.0, 1.0].map(|x| ball(&mut world, x));
        turn_y_to_x(&mut world, bodies[1]);
        let joint = world.add_joint(bodies.map(Some), kind).unwrap();
        let view = world.joint(joint);
        let axes = [JointAxis::First, JointAxis::Second].map(|axis| view.axis_of(axis).unwrap());
        let expected = [Vector3::x(), Vector3::y()];
        if kind.joint_type() != JointType::EulerMotor {
            assert!((0..2).all(|i| (axes[i] - expected[i]).norm() < 1e-12), "{kind:?}: {axes:?}");
            assert!((view.anchor().unwrap() - ORIGIN).norm() < 1e-12);
        }
        world.step(0.001).unwrap();
    }
}

#[test]
fn a_step_with_parallel_axes_is_refused_until_a_body_is_turned_or_the_joint_disabled() {
    for kind in kinds().iter().filter(|kind| is_crossed(kind)) {
        let mut world = world();
        let bodies = [0.0, 1.0].map(|x| ball(&mut world, x));
        let joint = world.add_joint(bodies.map(Some), kind).unwrap();
        let upright = world.body(bodies[1]).pose();
        turn_y_to_x(&mut world, bodies[1]);

        let before = world.body(bodies[0]).position();
        let message = world.step(0.001).unwrap_err().to_string();
        assert!(message.contains("parallel"), "{message}");
        assert!(world.quick_step(0.001).is_err());
        assert_eq!(world.body(bodies[0]).position(), before);

        // ODE aborts in these, too, or reads numbers that it never set.
        let has_anchor = kind.joint_type() != JointType::EulerMotor;
        let mut joint_mut = world.joint_mut(joint);
        assert!(joint_mut.set_anchor(&ORIGIN).is_err());
        assert!(joint_mut.add_torque(JointAxis::First, 1.0).is_err());
        assert!(joint_mut.attach(bodies.map(Some)).is_err());
        assert_eq!(joint_mut.view().angle(), None);
        assert_eq!(joint_mut.view().angle_rate(), None);
        assert_eq!(joint_mut.view().axis().is_some(), has_anchor);

        joint_mut.set_enabled(false);
        world.step(0.001).unwrap();
        world.joint_mut(joint).set_enabled(true);
        assert!(world.step(0.001).is_err());
        world.body_mut(bodies[1]).set_pose(&upright).unwrap();
        world.step(0.001).unwrap();

        // Other axes help as well.
        turn_y_to_x(&mut world, bodies[1]);
        let axes = [Vector3::y(), Vector3::z(), Vector3::x()];
        let count = if kind.joint_type() == JointType::PrismaticUniversal { 3 } else { 2 };
        world.joint_mut(joint).set_axes(&axes[..count]).unwrap();
        world.step(0.001).unwrap();
    }
}

#[test]
fn a_joint_that_lost_a_body_has_no_geometry_until_it_is_attached() {
    for kind in kinds() {
        let mut world = world();
        let bodies = [0.0, 1.0].map(|x| ball(&mut world, x));
        let to =
            if kind.joint_type() == JointType::Plane2d { [Some(bodies[0]), None] } else { bodies.map(Some) };
        let joint = world.add_joint(to, &kind).unwrap();
        world.remove_body(bodies[0]);
        check_detached(&mut world, joint);
        world.step(0.001).unwrap();

        let new = ball(&mut world, 2.0);
        world.joint_mut(joint).attach([Some(new), to[1]]).unwrap();
        assert_eq!(world.joint(joint).bodies(), [Some(new), to[1]]);
        assert!(world.joint(joint).axis().is_some(), "{kind:?}");
        world.step(0.001).unwrap();

        // It cannot be attached where its axes would be parallel.
        if is_crossed(&kind) {
            world.remove_body(new);
            let new = ball(&mut world, 3.0);
            turn_y_to_x(&mut world, bodies[1]);
            assert!(world.joint_mut(joint).attach([Some(new), to[1]]).is_err());
            assert!(!world.joint(joint).is_attached());
        }
    }
}

fn check_detached(world: &mut World, joint: JointId) {
    let view = world.joint(joint);
    let kind = view.joint_type();
    assert!(!view.is_attached());
    assert_eq!((view.anchor(), view.anchor2(), view.axis()), (None, None, None));
    assert_eq!((view.position(), view.position_rate()), (None, None));
    for axis in JointAxis::ALL {
        assert_eq!((view.axis_of(axis), view.angle_of(axis), view.angle_rate_of(axis)), (None, None, None));
    }

    let mut joint = world.joint_mut(joint);
    assert!(joint.set_anchor(&ORIGIN).is_err() && joint.set_axis(&Vector3::x()).is_err());
    assert!(joint.set_axes(&[Vector3::x(), Vector3::y()]).is_err());
    assert!(joint.set_motor_axes(&[Some(MotorAxis::of_first_body(Vector3::x())), None, None]).is_err());
    assert!(joint.add_torque(JointAxis::First, 1.0).is_err() && joint.add_force(1.0).is_err());
    // Parameters need no bodies.
    let axis = if kind == JointType::Hinge2 { JointAxis::Second } else { JointAxis::First };
    joint.set_param_of_axis(axis, JointParam::MotorMaxForce, 1.0).unwrap();
}

#[test]
fn parameters_belong_to_the_axes_that_heed_them() {
    let mut world = world();
    let bodies = [0.0, 1.0].map(|x| ball(&mut world, x));
    for kind in kinds() {
        let to =
            if kind.joint_type() == JointType::Plane2d { [Some(bodies[0]), None] } else { bodies.map(Some) };
        let joint = world.add_joint(to, &kind).unwrap();
        let mut joint = world.joint_mut(joint);
        let (axes, with_stops) = match kind.joint_type() {
            JointType::Hinge2 => (2, 1),
            JointType::Plane2d | JointType::LinearMotor => (3, 0),
            JointType::Universal | JointType::PrismaticRotoide | JointType::Piston => (2, 2),
            _ => (3, 3),
        };
        for (index, axis) in JointAxis::ALL.into_iter().enumerate() {
            let value = 0.25 * (index + 1) as f64;
            for (param, of) in [
                (JointParam::MotorVelocity, axes),
                (JointParam::MotorMaxForce, axes),
                (JointParam::Cfm, axes),
                (JointParam::LowStop, with_stops),
                (JointParam::Bounce, with_stops),
                (JointParam::StopErp, with_stops),
                (JointParam::Erp, 0),
                (JointParam::SuspensionErp, usize::from(kind.joint_type() == JointType::Hinge2)),
            ] {
                let set = joint.set_param_of_axis(axis, param, value).is_ok();
                assert_eq!(set, index < of, "{kind:?}, {axis:?}, {param:?}");
                let readable = set && kind.joint_type() != JointType::Plane2d;
                assert_eq!(joint.view().param_of_axis(axis, param), readable.then_some(value));
                assert!(joint.set_param_of_axis(axis, param, f64::NAN).is_err());
            }
        }
    }
}
