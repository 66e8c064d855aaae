//! Ids of removed objects and ids of another world are refused.

use std::panic::{AssertUnwindSafe, catch_unwind};

use ode_visual_hull::ode::{JointKind, Shape, SpaceKind, World};

use crate::{add, world};

const BALL: Shape = Shape::Sphere { radius: 0.1 };

/// The message of the panic that `act` ends in.
fn panic_of<T>(act: impl FnOnce() -> T) -> String {
    let payload = catch_unwind(AssertUnwindSafe(|| drop(act()))).expect_err("expected a panic");
    payload.downcast_ref::<String>().expect("a panic with a message").clone()
}

#[test]
fn a_removed_body_is_refused_also_when_its_slot_is_used_again() {
    let mut world = world();
    let old = world.add_body();

    assert!(world.remove_body(old) && !world.remove_body(old));

    for _ in 0..2 {
        assert!(!world.contains_body(old) && world.get_body(old).is_none());
        assert!(panic_of(|| world.body(old).position()).contains("was removed"));
        assert!(panic_of(|| world.body_mut(old).set_enabled(true)).contains("was removed"));
        let geom = world.add_geom(world.root_space(), &BALL).unwrap();
        assert!(world.geom_mut(geom).set_body(Some(old)).is_err());
        assert!(world.add_joint([Some(old), None], &JointKind::Fixed).is_err());
        assert!(!world.remove_body_and_geoms(old) && world.geoms_of(old).is_empty());
        // In the second round, another body has the slot.
        world.add_body();
    }
}

#[test]
fn removed_geoms_spaces_and_joints_are_refused_also_when_their_slots_are_used_again() {
    let mut world = world();
    let body = world.add_body();
    let space = world.add_space(world.root_space(), SpaceKind::Simple).unwrap();
    let geom = world.add_geom(space, &BALL).unwrap();
    let joint = world.add_joint([Some(body), None], &JointKind::Fixed).unwrap();

    assert!(world.remove_geom(geom) && world.remove_joint(joint));

    world.remove_space(space).unwrap();
    for _ in 0..2 {
        assert!(world.get_geom(geom).is_none() && !world.contains_geom(geom) && !world.remove_geom(geom));
        assert!(
            world.get_joint(joint).is_none() && !world.contains_joint(joint) && !world.remove_joint(joint)
        );
        assert!(!world.contains_space(space) && world.remove_space(space).is_err());
        assert!(world.add_geom(space, &BALL).is_err() && world.add_space(space, SpaceKind::Simple).is_err());

        assert!(panic_of(|| world.geom(geom).pose()).contains("was removed"));

        assert!(panic_of(|| world.geom_mut(geom).set_enabled(true)).contains("was removed"));
        assert!(panic_of(|| world.joint(joint).bodies()).contains("was removed"));
        assert!(panic_of(|| world.joint_mut(joint).set_enabled(true)).contains("was removed"));

        let next = world.add_geom(world.root_space(), &BALL).unwrap();
        assert!(world.collide_geoms(geom, next, 1).is_err() && world.collide_geoms(next, geom, 1).is_err());
        assert!(world.geom_mut(next).set_space(space).is_err());
        world.add_joint([Some(body), None], &JointKind::Fixed).unwrap();
        world.add_space(world.root_space(), SpaceKind::Simple).unwrap();
    }
}

#[test]
fn ids_of_another_world_are_refused() {
    let add_each_kind = |world: &mut World| {
        let (body, geom) = add(world, &BALL, 1.0, [0.0; 3]);
        let joint = world.add_joint([Some(body), None], &JointKind::Fixed).unwrap();
        (body, geom, joint, world.add_joint_group())
    };
    let (mut here, mut there) = (world(), world());
    let (body, geom, joint, group) = add_each_kind(&mut here);
    let (own_body, own_geom, ..) = add_each_kind(&mut there);
    let root = here.root_space();

    assert!(!there.contains_body(body) && !there.contains_geom(geom) && !there.contains_joint(joint));
    assert!(!there.contains_space(root) && !there.contains_joint_group(group));
    assert!(!there.remove_body(body) && !there.remove_geom(geom) && !there.remove_joint(joint));
    assert!(!there.remove_joint_group(group) && there.empty_joint_group(group).is_err());
    assert!(there.remove_space(root).is_err() && there.add_geom(root, &BALL).is_err());
    assert!(there.geom_mut(own_geom).set_body(Some(body)).is_err());
    assert!(there.geom_mut(own_geom).set_space(root).is_err());
    assert!(there.add_joint([Some(own_body), Some(body)], &JointKind::Fixed).is_err());
    assert!(panic_of(|| there.body(body).position()).contains("another"));
    assert!(panic_of(|| there.geom(geom).pose()).contains("another"));
    assert!(panic_of(|| there.joint(joint).bodies()).contains("another"));

    assert!(here.contains_body(body) && here.contains_geom(geom) && here.contains_joint(joint));
}

#[test]
fn geoms_of_a_removed_body_stay_where_they_were_or_go_with_it() {
    let mut world = world();
    let (body, geom) = add(&mut world, &BALL, 1.0, [1.0, 2.0, 3.0]);
    world.remove_body(body);
    let view = world.geom(geom);
    assert_eq!((view.body(), view.pose().translation.vector.as_slice()), (None, [1.0, 2.0, 3.0].as_slice()));

    let (body, geom) = add(&mut world, &BALL, 1.0, [1.0, 2.0, 3.0]);
    assert_eq!(world.geoms_of(body), [geom]);
    assert!(world.remove_body_and_geoms(body));
    assert!(!world.contains_body(body) && !world.contains_geom(geom));
}

#[test]
fn ids_print_their_type_and_slot() {
    let mut world = world();
    let body = world.add_body();
    assert!(format!("{body:?}").starts_with("BodyId(0v0 of world "), "{body:?}");
    assert!(format!("{world:?}").contains("bodies: 1"));
}
