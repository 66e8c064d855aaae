//! Joints: each kind constrains the motion that it should and no other.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{
    BodyId, ContactGeom, JointId, JointKind, JointParam, JointType, Shape, Surface, World,
};

use crate::{GRAVITY, add, world};

const DT: f64 = 0.001;

fn ball(world: &mut World, at: [f64; 3]) -> BodyId {
    add(world, &Shape::Sphere { radius: 0.01 }, 2.0, at).0
}

fn steps(world: &mut World, n: usize) {
    for _ in 0..n {
        world.step(DT).unwrap();
    }
}

fn anchor_distance(world: &World, joint: JointId) -> f64 {
    let joint = world.joint(joint);
    (joint.anchor().unwrap() - joint.anchor2().unwrap()).norm()
}

#[test]
fn a_pendulum_keeps_its_energy_and_its_length() {
    for hinge in [false, true] {
        let mut world = world();
        let body = ball(&mut world, [1.0, 0.0, 0.0]);
        let kind = if hinge {
            JointKind::Hinge { anchor: Point3::origin(), axis: Vector3::y() }
        } else {
            JointKind::Ball { anchor: Point3::origin() }
        };
        let joint = world.add_joint([Some(body), None], &kind).unwrap();

        let (mut lowest, mut worst) = (0.0_f64, 0.0_f64);
        for _ in 0..4000 {
            world.step(DT).unwrap();
            let body = world.body(body);
            // Energy per kilogram; the ball's own rotation accounts for a share of 4e-5.
            let energy = body.linear_velocity().norm_squared() / 2.0 + GRAVITY * body.position().z;
            worst = worst.max(energy.abs());
            lowest = lowest.min(body.position().z);
            assert!((body.position().coords.norm() - 1.0).abs() < 1e-3);
        }

        assert!(lowest < -0.999, "it swings through: {lowest}");
        // The integrator is of first order, with an error of 1 % of the energy of the fall at steps of 1 ms.
        assert!(worst < 0.01 * GRAVITY, "hinge {hinge}: energy off by {worst}");
        assert!(anchor_distance(&world, joint) < 1e-3);
    }
}

#[test]
fn a_hinge_measures_its_angle_and_stops_at_its_limit() {
    let mut world = world();
    let body = ball(&mut world, [1.0, 0.0, 0.0]);
    let kind = JointKind::Hinge { anchor: Point3::origin(), axis: Vector3::new(0.0, 3.0, 0.0) };
    let joint = world.add_joint([Some(body), None], &kind).unwrap();

    assert_eq!((world.joint(joint).axis(), world.joint(joint).angle()), (Some(Vector3::y()), Some(0.0)));

    // Angles about y are positive downwards.
    world.joint_mut(joint).set_param(JointParam::HighStop, 0.5).unwrap();
    world.joint_mut(joint).set_param(JointParam::LowStop, -0.5).unwrap();

    steps(&mut world, 2000);
    let angle = world.joint(joint).angle().unwrap();

    assert!((angle - 0.5).abs() < 0.01, "{angle}");
    assert!(world.joint(joint).angle_rate().unwrap().abs() < 1e-3);
    assert!((world.body(body).position() - Point3::new(angle.cos(), 0.0, -angle.sin())).norm() < 1e-2);
    assert_eq!(world.joint(joint).param(JointParam::HighStop), Some(0.5));

    assert_eq!(world.joint(joint).position(), None);
}

#[test]
fn a_hinge_at_its_stop_swings_on_when_the_stops_are_removed() {
    // Removed in both ways that ODE has: no number, or the lower above the higher.
    for (low, high) in [(f64::NEG_INFINITY, f64::INFINITY), (1.0, -1.0)] {
        let mut world = world();
        let body = ball(&mut world, [1.0, 0.0, 0.0]);
        let kind = JointKind::Hinge { anchor: Point3::origin(), axis: Vector3::y() };
        let joint = world.add_joint([Some(body), None], &kind).unwrap();
        world.joint_mut(joint).set_param(JointParam::LowStop, -0.2).unwrap();
        world.joint_mut(joint).set_param(JointParam::HighStop, 0.2).unwrap();
        steps(&mut world, 1000);

        world.joint_mut(joint).set_param(JointParam::LowStop, low).unwrap();
        world.joint_mut(joint).set_param(JointParam::HighStop, high).unwrap();
        assert_eq!(world.joint(joint).param(JointParam::LowStop), Some(low));
        assert_eq!(world.joint(joint).param(JointParam::HighStop), Some(high));
        let lowest = (0..2000).map(|_| {
            world.step(DT).unwrap();
            world.body(body).position().z
        });
        assert!(lowest.fold(0.0, f64::min) < -0.999);
    }
}

#[test]
fn a_motor_turns_a_hinge_at_its_velocity() {
    let mut world = world();
    world.set_gravity(&Vector3::zeros()).unwrap();
    let (body, _) = add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [0.0; 3]);
    let kind = JointKind::Hinge { anchor: Point3::origin(), axis: Vector3::z() };
    let joint = world.add_joint([Some(body), None], &kind).unwrap();
    let mut joint_mut = world.joint_mut(joint);
    joint_mut.set_param(JointParam::MotorVelocity, FRAC_PI_2).unwrap();
    joint_mut.set_param(JointParam::MotorMaxForce, 100.0).unwrap();
    steps(&mut world, 1000);
    assert!((world.joint(joint).angle_rate().unwrap() - FRAC_PI_2).abs() < 1e-6);
    let turned = world.body(body).pose().rotation;
    assert!(turned.angle_to(&UnitQuaternion::from_axis_angle(&Vector3::z_axis(), FRAC_PI_2)) < 1e-2);
}

#[test]
fn a_slider_moves_only_along_its_axis() {
    let mut world = world();
    let body = ball(&mut world, [0.0; 3]);
    let axis = Vector3::new(1.0, 0.0, -1.0);
    let joint = world.add_joint([Some(body), None], &JointKind::Slider { axis }).unwrap();
    steps(&mut world, 1000);

    // The acceleration along a slope of 45 degrees is g / sqrt 2, and the time is 1 s.
    let expected = GRAVITY * 0.5_f64.sqrt() / 2.0;
    let position = world.joint(joint).position().unwrap();

    assert!((position.abs() - expected).abs() < 0.01, "{position}");
    assert!((world.joint(joint).position_rate().unwrap().abs() - 2.0 * expected).abs() < 0.01);

    let off = world.body(body).position().coords - axis.normalize() * expected;
    assert!(off.norm() < 0.01, "{off}");
    assert_eq!(world.joint(joint).angle(), None);
    assert_eq!(world.joint(joint).anchor(), None);
}

#[test]
fn fixed_bodies_move_as_one() {
    let mut world = world();
    let (a, _) = add(&mut world, &Shape::cuboid(0.1, 0.1, 0.1), 1.0, [0.0; 3]);
    let (b, _) = add(&mut world, &Shape::cuboid(0.1, 0.1, 0.1), 1.0, [0.5, 0.0, 0.0]);
    world.add_joint([Some(a), Some(b)], &JointKind::Fixed).unwrap();
    for body in [a, b] {
        world.body_mut(body).set_angular_velocity(&Vector3::new(0.0, 0.0, 1.0)).unwrap();
    }
    world.body_mut(b).set_linear_velocity(&Vector3::new(0.0, 0.5, 0.0)).unwrap();

    let between = |world: &World| world.body(a).pose().inverse() * world.body(b).pose();
    let before = between(&world);

    steps(&mut world, 1000);
    let after = between(&world);

    assert!((after.translation.vector - before.translation.vector).norm() < 1e-3);
    assert!(after.rotation.angle_to(&before.rotation) < 1e-3);
    assert!(world.body(a).position().z < -4.0, "and they fall");
}

#[test]
fn a_contact_joint_carries_a_body_until_it_is_removed() {
    let mut world = world();
    let (body, geom) = add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0; 3]);
    let contact = ContactGeom {
        position: Point3::new(0.0, 0.0, -0.1),
        normal: Vector3::z(),
        depth: 0.0,
        time: 0.0,
        geoms: [geom, geom],
    };

    let kind = JointKind::Contact { contact, surface: Surface::default() };
    let joint = world.add_joint([Some(body), None], &kind).unwrap();

    assert_eq!(world.joint(joint).joint_type(), JointType::Contact);

    steps(&mut world, 100);
    assert!(world.body(body).position().z.abs() < 1e-6, "{}", world.body(body).position());

    assert!(world.remove_joint(joint));

    steps(&mut world, 100);
    assert!(world.body(body).position().z < -0.04);
}

#[test]
fn the_world_may_be_the_first_body_of_a_joint() {
    let mut world = world();
    let body = ball(&mut world, [1.0, 0.0, 0.0]);
    let kind = JointKind::Ball { anchor: Point3::origin() };
    let joint = world.add_joint([None, Some(body)], &kind).unwrap();
    assert_eq!(world.joint(joint).bodies(), [None, Some(body)]);
    steps(&mut world, 500);
    assert!((world.body(body).position().coords.norm() - 1.0).abs() < 1e-3);
}

#[test]
fn a_disabled_joint_constrains_nothing() {
    let mut world = world();
    let body = ball(&mut world, [0.0; 3]);
    let joint = world.add_joint([Some(body), None], &JointKind::Fixed).unwrap();
    steps(&mut world, 100);
    assert!(world.body(body).position().z.abs() < 1e-6);
    world.joint_mut(joint).set_enabled(false);
    assert!(!world.joint(joint).is_enabled());
    steps(&mut world, 100);
    assert!(world.body(body).position().z < -0.04);
}

#[test]
fn emptying_a_group_removes_its_joints_and_invalidates_their_ids() {
    let mut world = world();
    let bodies = [0.0, 1.0, 2.0].map(|x| ball(&mut world, [x, 0.0, 0.0]));
    let group = world.add_joint_group();
    let joints = bodies.map(|body| world.add_joint_in(group, [Some(body), None], &JointKind::Fixed).unwrap());

    assert!(world.remove_joint(joints[0]));

    steps(&mut world, 100);
    assert!(world.body(bodies[0]).position().z < -0.04);
    assert!(world.body(bodies[1]).position().z.abs() < 1e-6);

    world.empty_joint_group(group).unwrap();
    assert!(joints.iter().all(|&joint| !world.contains_joint(joint)));

    steps(&mut world, 100);
    assert!(world.body(bodies[1]).position().z < -0.04);

    let again = world.add_joint_in(group, [Some(bodies[2]), None], &JointKind::Fixed).unwrap();
    assert!(world.remove_joint_group(group) && !world.contains_joint_group(group));
    assert!(!world.contains_joint(again) && !world.remove_joint_group(group));
    assert!(world.empty_joint_group(group).is_err());

    assert!(world.add_joint_in(group, [Some(bodies[2]), None], &JointKind::Fixed).is_err());
}

#[test]
fn the_joints_of_a_removed_body_remain_and_constrain_nothing() {
    let mut world = world();
    let (a, b) = (ball(&mut world, [0.0; 3]), ball(&mut world, [1.0, 0.0, 0.0]));
    let anchor = Point3::new(0.5, 0.0, 0.0);
    let kinds = [
        JointKind::Ball { anchor },
        JointKind::Hinge { anchor, axis: Vector3::y() },
        JointKind::Slider { axis: Vector3::x() },
        JointKind::Fixed,
    ];

    let joints = kinds.map(|kind| world.add_joint([Some(a), Some(b)], &kind).unwrap());
    world.remove_body(a);

    for joint in joints {
        let view = world.joint(joint);
        assert_eq!((view.bodies(), view.is_attached()), ([None, None], false));
        assert_eq!((view.anchor(), view.axis()), (None, None));
        assert_eq!((view.angle(), view.angle_rate()), (None, None));
        assert_eq!((view.position(), view.position_rate()), (None, None));
        assert!(world.joint_mut(joint).set_anchor(&anchor).is_err());
        assert!(world.joint_mut(joint).set_axis(&Vector3::x()).is_err());
    }

    steps(&mut world, 100);
    assert!(world.body(b).position().z < -0.04);

    world.joint_mut(joints[2]).attach([Some(b), None]).unwrap();
    world.joint_mut(joints[2]).set_axis(&Vector3::x()).unwrap();
    assert_eq!(world.joint(joints[2]).bodies(), [Some(b), None]);
}

#[test]
fn invalid_joints_are_refused() {
    let mut world = world();
    let (a, gone) = (ball(&mut world, [0.0; 3]), ball(&mut world, [1.0; 3]));
    world.remove_body(gone);
    let (origin, nan) = (Point3::origin(), Point3::new(f64::NAN, 0.0, 0.0));
    let ball = JointKind::Ball { anchor: origin };
    for bodies in [[None, None], [Some(a), Some(a)], [Some(gone), None], [Some(a), Some(gone)]] {
        assert!(world.add_joint(bodies, &ball).is_err(), "{bodies:?}");
    }

    for kind in [
        JointKind::Ball { anchor: nan },
        JointKind::Hinge { anchor: nan, axis: Vector3::x() },
        JointKind::Hinge { anchor: origin, axis: Vector3::zeros() },
        JointKind::Slider { axis: nan.coords },
    ] {
        assert!(world.add_joint([Some(a), None], &kind).is_err(), "{kind:?}");
    }

    assert_eq!(world.joints().count(), 0);

    let hinge = JointKind::Hinge { anchor: origin, axis: Vector3::x() };
    let joints = [ball, hinge, JointKind::Slider { axis: Vector3::x() }, JointKind::Fixed];
    for kind in joints {
        let joint = world.add_joint([Some(a), None], &kind).unwrap();
        let mut joint = world.joint_mut(joint);
        for param in [
            JointParam::LowStop,
            JointParam::MotorMaxForce,
            JointParam::Bounce,
            JointParam::Cfm,
            JointParam::Erp,
            JointParam::StopCfm,
        ] {
            assert!(joint.set_param(param, f64::NAN).is_err());
        }
        assert!(joint.set_param(JointParam::Cfm, -1.0).is_err());
        assert!(joint.set_param(JointParam::Cfm, 1e-5).is_ok());
        assert_eq!(joint.view().param(JointParam::Cfm), Some(1e-5));

        let has_stops = matches!(kind, JointKind::Hinge { .. } | JointKind::Slider { .. });
        assert_eq!(joint.set_param(JointParam::LowStop, f64::NEG_INFINITY).is_ok(), has_stops);
        assert_eq!(joint.set_param(JointParam::Erp, 0.5).is_ok(), !has_stops);
        assert!(joint.attach([Some(a), Some(a)]).is_err() && joint.attach([None, None]).is_err());
    }
}
