//! Steps that ODE cannot finish: the program gets an error instead of an abort, and the world remains usable.

use nalgebra::Vector3;
use ode_visual_hull::ode::{JointKind, JointParam, Shape};

use crate::{GRAVITY, add, world};

#[test]
fn a_step_in_which_constraints_contradict_each_other_is_an_error_on_every_thread() {
    // Three joints where one suffices leave the direct solver without an inverse where nothing is soft (CFM 0).
    let fail = || {
        let mut world = world();
        world.set_cfm(0.0).unwrap();
        let bodies =
            [0.0, 1.0].map(|x| add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [x, 0.3, 0.2]).0);
        world.body_mut(bodies[0]).set_angular_velocity(&Vector3::new(1.0, 2.0, 3.0)).unwrap();
        let joints = [0, 1, 2].map(|_| {
            let joint = world.add_joint(bodies.map(Some), &JointKind::Fixed).unwrap();
            world.joint_mut(joint).set_param(JointParam::Cfm, 0.0).unwrap();
            joint
        });
        assert!((0..1000).any(|_| world.step(0.01).is_err()));
        assert!(!world.stopped_bodies().is_empty());

        // The world remains usable.
        joints.iter().for_each(|&joint| assert!(world.remove_joint(joint)));
        for body in bodies {
            world.body_mut(body).set_enabled(true);
            world.body_mut(body).set_linear_velocity(&Vector3::zeros()).unwrap();
        }
        let before = world.body(bodies[0]).position().z;
        (0..100).for_each(|_| world.step(0.01).unwrap());
        let fall = before - world.body(bodies[0]).position().z;
        assert!((fall - GRAVITY / 2.0).abs() < 0.1, "{fall}");
    };

    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| (0..20).for_each(|_| fail()));
        }
    });
}
