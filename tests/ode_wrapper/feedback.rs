//! Measured forces of joints and contacts: they are those that statics requires.

use nalgebra::{Point3, Vector3};
use ode_visual_hull::ode::{BodyId, JointFeedback, JointKind, MotorAxis, Shape, Surface, World};

use crate::{GRAVITY, add, add_ground, world};

const DT: f64 = 0.001;
const MASS: f64 = 2.0;

fn ball(world: &mut World, at: [f64; 3]) -> BodyId {
    add(world, &Shape::Sphere { radius: 0.1 }, MASS, at).0
}

fn steps(world: &mut World, n: usize) {
    for _ in 0..n {
        world.step(DT).unwrap();
    }
}

/// The weight of `n` balls, upwards.
fn weight(n: f64) -> Vector3<f64> {
    Vector3::z() * (n * MASS * GRAVITY)
}

/// Whether two forces are equal up to the compliance (CFM) of ODE's constraints, which is 1e-10 m/s per N s.
fn close(a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
    (a - b).norm() < 1e-5
}

#[test]
fn the_joint_at_which_a_body_hangs_carries_its_weight() {
    for world_first in [false, true] {
        let mut world = world();
        let body = ball(&mut world, [0.0, 0.0, -1.0]);
        let anchor = Point3::origin();
        for kind in [
            JointKind::Ball { anchor },
            JointKind::Hinge { anchor, axis: Vector3::x() },
            JointKind::Slider { axis: Vector3::x() },
            JointKind::Fixed,
        ] {
            let bodies = if world_first { [None, Some(body)] } else { [Some(body), None] };
            let joint = world.add_joint(bodies, &kind).unwrap();
            assert_eq!(world.joint(joint).feedback(), None);
            world.joint_mut(joint).set_feedback(true);
            assert_eq!(world.joint(joint).feedback(), Some(JointFeedback::default()));

            steps(&mut world, 10);
            let JointFeedback { forces, torques } = world.joint(joint).feedback().unwrap();
            let (on_body, on_world) = if world_first { (1, 0) } else { (0, 1) };
            assert!(close(&forces[on_body], &weight(1.0)), "{kind:?}: {forces:?}");
            assert!(close(&torques[on_body], &Vector3::zeros()), "{kind:?}: {torques:?}");
            assert_eq!((forces[on_world], torques[on_world]), (Vector3::zeros(), Vector3::zeros()));
            world.remove_joint(joint);
        }
    }
}

#[test]
fn a_joint_within_a_chain_carries_what_hangs_below_it_and_pulls_both_bodies_alike() {
    let mut world = world();
    let [upper, lower] = [-1.0, -2.0].map(|z| ball(&mut world, [0.0, 0.0, z]));
    let kinds = [0.0, -1.0].map(|z| JointKind::Ball { anchor: Point3::new(0.0, 0.0, z) });
    let top = world.add_joint([Some(upper), None], &kinds[0]).unwrap();
    let middle = world.add_joint([Some(upper), Some(lower)], &kinds[1]).unwrap();
    for joint in [top, middle] {
        world.joint_mut(joint).set_feedback(true);
    }
    steps(&mut world, 10);

    assert!(close(&world.joint(top).feedback().unwrap().forces[0], &weight(2.0)));
    let forces = world.joint(middle).feedback().unwrap().forces;
    assert!(close(&forces[1], &weight(1.0)) && close(&forces[0], &-weight(1.0)), "{forces:?}");
}

#[test]
fn a_motor_at_its_largest_force_measures_that_force() {
    let mut world = world();
    world.set_gravity(&Vector3::zeros()).unwrap();
    let body = ball(&mut world, [0.0; 3]);
    let axes = [Some(MotorAxis::of_world(Vector3::x())), None, None];
    let joint = world.add_joint([Some(body), None], &JointKind::LinearMotor { axes }).unwrap();
    let mut joint_mut = world.joint_mut(joint);
    joint_mut.set_param(ode_visual_hull::ode::JointParam::MotorVelocity, 100.0).unwrap();
    joint_mut.set_param(ode_visual_hull::ode::JointParam::MotorMaxForce, 3.0).unwrap();
    joint_mut.set_feedback(true);
    steps(&mut world, 1);
    assert!(close(&world.joint(joint).feedback().unwrap().forces[0], &(Vector3::x() * 3.0)));
}

#[test]
fn joints_without_effect_in_the_last_step_have_no_force() {
    let mut world = world();
    let body = ball(&mut world, [0.0; 3]);
    let joint = world.add_joint([Some(body), None], &JointKind::Fixed).unwrap();
    world.joint_mut(joint).set_feedback(true);
    steps(&mut world, 1);
    assert!(world.joint(joint).feedback().unwrap().forces[0].z > 0.0);

    world.joint_mut(joint).set_enabled(false);
    steps(&mut world, 1);
    assert_eq!(world.joint(joint).feedback(), Some(JointFeedback::default()));

    world.joint_mut(joint).set_enabled(true);
    steps(&mut world, 1);
    world.remove_body(body);
    steps(&mut world, 1);
    assert_eq!(world.joint(joint).feedback(), Some(JointFeedback::default()));
    world.joint_mut(joint).set_feedback(false);
    assert_eq!(world.joint(joint).feedback(), None);
}

#[test]
fn memory_for_forces_goes_with_joints_groups_and_worlds() {
    let mut world = world();
    let body = ball(&mut world, [0.0; 3]);
    let group = world.add_joint_group();
    let joints = [None, Some(group), Some(group), None].map(|group| {
        let bodies = [Some(body), None];
        let joint = match group {
            Some(group) => world.add_joint_in(group, bodies, &JointKind::Fixed),
            None => world.add_joint(bodies, &JointKind::Fixed),
        }
        .unwrap();
        // Setting it once more replaces the memory.
        world.joint_mut(joint).set_feedback(true);
        world.joint_mut(joint).set_feedback(true);
        joint
    });

    steps(&mut world, 1);
    assert!(world.remove_joint(joints[0]) && world.remove_joint(joints[1]));
    steps(&mut world, 1);
    world.empty_joint_group(group).unwrap();
    steps(&mut world, 1);

    // The remaining joint carries the body alone, also in a world that was moved to another thread.
    let mut world = std::thread::spawn(move || {
        steps(&mut world, 1);
        world
    })
    .join()
    .unwrap();
    steps(&mut world, 1);
    assert!(close(&world.joint(joints[3]).feedback().unwrap().forces[0], &weight(1.0)));
}

#[test]
fn the_contacts_of_a_resting_box_carry_its_weight() {
    let mut world = world();
    add_ground(&mut world);
    let (body, geom) = add(&mut world, &Shape::cuboid(0.4, 0.4, 0.4), MASS, [0.0, 0.0, 0.2]);
    assert!(world.contact_feedback().is_empty());

    for _ in 0..200 {
        world
            .collide(|pair| {
                for contact in pair.contacts(8).iter() {
                    pair.attach_measured(contact, &Surface::default());
                }
            })
            .unwrap();
        world.step(DT).unwrap();
    }
    let measured = world.contact_feedback();
    assert_eq!(measured.len(), 4);
    let total: Vector3<f64> = measured
        .iter()
        .map(|(contact, feedback)| feedback.forces[usize::from(contact.geoms[1] == geom)])
        .sum();
    // The box still settles by the contacts' compliance.
    assert!((total - weight(1.0)).norm() < 1e-3, "{total}");

    world.remove_body(body);
    world.step(DT).unwrap();
    assert!(world.contact_feedback().iter().all(|(_, feedback)| *feedback == JointFeedback::default()));
    world.clear_contacts();
    assert!(world.contact_feedback().is_empty());
}
