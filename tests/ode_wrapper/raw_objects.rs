//! Objects made with ODE's own functions beside and in a world.

use std::ptr::null_mut;

use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::ode::ode_sys::*;
use ode_visual_hull::ode::{GeomId, Heightfield, JointKind, RayFlags, Shape, SpaceKind, World};

use crate::{GRAVITY, add, run, world};

/// Whether [`World::collide`] shows the pair of two geoms.
fn is_shown(world: &mut World, pair: [GeomId; 2]) -> bool {
    let mut shown = false;
    world.collide(|found| shown |= pair.iter().all(|geom| found.geoms().contains(geom))).unwrap();
    shown
}

#[test]
fn the_id_of_a_raw_object_is_that_of_the_object() {
    let mut world = world();
    let root = world.root_space();
    let inner = world.add_space(root, SpaceKind::Simple).unwrap();
    let (body, geom) = add(&mut world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0; 3]);
    let joint = world.add_joint([Some(body), None], &JointKind::Fixed).unwrap();

    // SAFETY: all objects are alive, and none is changed.
    unsafe {
        assert_eq!(world.body_id(world.body(body).raw()), Some(body));
        assert_eq!(world.geom_id(world.geom(geom).raw()), Some(geom));
        assert_eq!(world.space_id(world.space(inner).raw()), Some(inner));
        assert_eq!(world.joint_id(world.joint(joint).raw()), Some(joint));
        assert_eq!(world.space_id(dGeomGetSpace(world.geom(geom).raw())), Some(root));
        assert_eq!(world.geom_id(world.space(inner).raw().cast()), None);

        let other = crate::world();
        assert_eq!(other.body_id(world.body(body).raw()), None);
        assert_eq!(other.geom_id(world.geom(geom).raw()), None);
        assert_eq!(other.space_id(world.space(inner).raw()), None);
        assert_eq!(other.joint_id(world.joint(joint).raw()), None);
        assert_eq!((other.body_id(null_mut()), other.geom_id(null_mut())), (None, None));
        assert_eq!((other.space_id(null_mut()), other.joint_id(null_mut())), (None, None));
    }
}

#[test]
fn a_space_view_shows_its_kind_its_parent_and_its_contents() {
    let mut world = world();
    let root = world.root_space();
    let inner = world.add_space(root, SpaceKind::Simple).unwrap();
    let geom = world.add_geom(inner, &Shape::Sphere { radius: 0.1 }).unwrap();

    assert_eq!((world.space(root).parent(), world.space(inner).parent()), (None, Some(root)));
    assert_eq!(world.space(root).inner_spaces(), [inner]);
    assert_eq!((world.space(root).geoms(), world.space(inner).geoms()), (vec![], vec![geom]));
    assert_eq!((world.space(inner).id(), world.space(inner).kind()), (inner, SpaceKind::Simple));
    world.remove_space(inner).unwrap();
    assert!(world.get_space(inner).is_none());
}

#[test]
fn a_raw_plane_carries_bodies_once_it_is_adopted() {
    let mut world = world();
    let root = world.root_space();
    let (chassis, wheel) = (world.add_body(), world.add_body());
    world.body_mut(wheel).set_pose(&Isometry3::translation(0.0, 0.0, -0.5)).unwrap();
    let tyre = world.add_geom(root, &Shape::Sphere { radius: 0.2 }).unwrap();
    world.geom_mut(tyre).set_body(Some(wheel)).unwrap();

    let mut feedback = Box::new(dJointFeedback::default());
    // SAFETY: all objects are of this world; joint and plane are destroyed with it. The feedback outlives the last
    // step.
    let ground = unsafe {
        let joint = dJointCreateHinge2(world.raw(), null_mut());
        dJointAttach(joint, world.body(chassis).raw(), world.body(wheel).raw());
        dJointSetHinge2Anchor(joint, 0.0, 0.0, -0.5);
        let (up, side) = ([0.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0]);
        dJointSetHinge2Axes(joint, up.as_ptr(), side.as_ptr());
        dJointSetFeedback(joint, &mut *feedback);

        // User data that looks like the key of another geom.
        let ground = dCreatePlane(world.space(root).raw(), 0.0, 0.0, 1.0, -1.0);
        dGeomSetData(ground, std::ptr::without_provenance_mut(1));
        ground
    };
    // Both fall freely, since no pair with the plane is shown: 10 steps of 10 ms, semi-implicit.
    run(&mut world, 10, 0.01);
    let fallen = -0.5 - GRAVITY * 0.01 * 0.01 * 55.0;
    assert!((world.body(wheel).position().z - fallen).abs() < 1e-9);

    // SAFETY: the plane is alive, in the root space, and of no other owner.
    let ground = unsafe { world.adopt_geom(ground, root).unwrap() };
    assert_eq!(world.geom(ground).shape(), Some(&Shape::Plane { normal: Vector3::z(), offset: -1.0 }));
    run(&mut world, 100, 0.01);

    let z = world.body(wheel).position().z;
    assert!((z - -0.8).abs() < 0.01, "{z}");
    assert!(feedback.f2[2].abs() > 0.1 * GRAVITY, "{:?}", feedback.f2);
    world.remove_body(chassis);
    run(&mut world, 10, 0.01);
}

#[test]
fn adopted_geoms_are_shown_have_shapes_and_are_destroyed_with_the_world() {
    let mut world = world();
    let root = world.root_space();
    let inner = world.add_space(root, SpaceKind::Simple).unwrap();
    let ball = world.add_geom(root, &Shape::Sphere { radius: 1.0 }).unwrap();

    // SAFETY: each geom is adopted once, in no space or the one named, without anything that it refers to.
    let adopted = unsafe {
        let space = world.space(inner).raw();
        [
            (dCreateSphere(null_mut(), 1.0), Shape::Sphere { radius: 1.0 }),
            (dCreateBox(space, 1.0, 2.0, 3.0), Shape::cuboid(1.0, 2.0, 3.0)),
            (dCreateCapsule(null_mut(), 1.0, 2.0), Shape::Capsule { radius: 1.0, length: 2.0 }),
            (dCreateCylinder(space, 1.0, 2.0), Shape::Cylinder { radius: 1.0, length: 2.0 }),
            (dCreateRay(null_mut(), 5.0), Shape::Ray { length: 5.0 }),
        ]
        .map(|(raw, shape)| (raw, world.adopt_geom(raw, inner).unwrap(), shape))
    };

    for (raw, geom, shape) in adopted.clone() {
        assert_eq!(world.geom(geom).shape(), Some(&shape));
        assert_eq!(world.geom(geom).space(), inner);
        assert!(is_shown(&mut world, [ball, geom]), "{shape:?}");
        // SAFETY: the geom is alive.
        unsafe { assert_eq!((world.geom(geom).raw(), world.geom_id(raw)), (raw, Some(geom))) };
        world.geom_mut(geom).set_pose(&Isometry3::translation(50.0, 0.0, 0.0)).unwrap();
        assert!(!is_shown(&mut world, [ball, geom]), "{shape:?}");
    }
    let ray = adopted[4].1;
    world.geom_mut(ray).set_ray(&Point3::new(0.0, 0.0, 3.0), &-Vector3::z()).unwrap();
    world.geom_mut(ray).set_ray_flags(RayFlags { closest_hit: true, ..RayFlags::default() }).unwrap();
    assert_eq!(world.collide_geoms(ray, ball, 1).unwrap()[0].depth, 2.0);

    // By hand, with the space, and with the world.
    assert!(world.remove_geom(adopted[0].1) && !world.remove_geom(adopted[0].1));
    world.geom_mut(adopted[1].1).set_space(root).unwrap();
    world.remove_space(inner).unwrap();
    assert!(world.get_geom(adopted[2].1).is_none() && world.get_geom(adopted[1].1).is_some());
}

#[test]
fn a_raw_heightfield_is_adopted_with_data_that_outlives_the_world() {
    let heights = [0.5; 9];
    // SAFETY: ODE is open as long as the world lives; the heights outlive the data, and the data the geom.
    unsafe {
        let mut world = world();
        let data = dGeomHeightfieldDataCreate();
        dGeomHeightfieldDataBuildDouble(data, heights.as_ptr(), 0, 2.0, 2.0, 3, 3, 1.0, 0.0, 1.0, 0);
        let ground = world.adopt_geom(dCreateHeightfield(null_mut(), data, 1), world.root_space()).unwrap();
        let turn = Isometry3::from_parts(Default::default(), Heightfield::z_up());
        world.geom_mut(ground).set_pose(&turn).unwrap();
        let (ball, _) = add(&mut world, &Shape::Sphere { radius: 0.2 }, 1.0, [0.1, 0.1, 0.75]);
        run(&mut world, 200, 0.01);
        let z = world.body(ball).position().z;
        assert!((z - 0.7).abs() < 1e-3, "{z}");
        assert_eq!(world.geom(ground).shape(), None);
        drop(world);
        let ode = ode_visual_hull::ode::Ode::init().unwrap();
        dGeomHeightfieldDataDestroy(data);
        drop(ode);
    }
}

#[test]
fn geoms_that_cannot_be_adopted_are_refused_and_stay_with_the_caller() {
    let (mut world, mut other) = (world(), world());
    let root = world.root_space();
    let inner = world.add_space(root, SpaceKind::Simple).unwrap();
    let (_, own) = add(&mut world, &Shape::Sphere { radius: 1.0 }, 1.0, [0.0; 3]);
    let foreign_body = other.add_body();

    // SAFETY: the geoms are alive, and destroyed here where they are not adopted.
    unsafe {
        let mut refused = |raw: dGeomID, expected: &str| {
            let message = world.adopt_geom(raw, root).unwrap_err().to_string();
            assert!(message.contains(expected), "expected {expected:?} in {message:?}");
        };
        refused(null_mut(), "expected a geom, found null");

        let transform = dCreateGeomTransform(null_mut());
        refused(transform, "found a transform");
        dGeomDestroy(transform);

        let elsewhere = dCreateSphere(null_mut(), 1.0);
        dGeomSetBody(elsewhere, other.body(foreign_body).raw());
        refused(elsewhere, "on a body of another world");
        dGeomDestroy(elsewhere);

        let flat = dCreateSphere(null_mut(), 0.0);
        refused(flat, "radius of the sphere: expected a length from");
        dGeomSphereSetRadius(flat, 1.0);
        dGeomSetPosition(flat, f64::NAN, 0.0, 0.0);
        refused(flat, "bounding box");
        dGeomDestroy(flat);

        let (space, inner_raw) = (world.space(root).raw(), world.space(inner).raw());
        let own_raw = world.geom(own).raw();
        let refuse = |raw: dGeomID, world: &mut World, expected: &str| {
            let message = world.adopt_geom(raw, root).unwrap_err().to_string();
            assert!(message.contains(expected), "expected {expected:?} in {message:?}");
        };
        refuse(space.cast(), &mut world, "found a space");
        refuse(own_raw, &mut world, "does not own yet");
        let inside = dCreateSphere(inner_raw, 1.0);
        refuse(inside, &mut world, "found one in another space");
        world.adopt_geom(inside, inner).unwrap();
    }
}

#[test]
fn an_adopted_body_is_listed_carries_contacts_and_is_stopped_like_others() {
    let mut world = world();
    let root = world.root_space();
    crate::add_ground(&mut world);

    // SAFETY: body and geom are of this world and adopted, so that it destroys them.
    let (raw, body, geom) = unsafe {
        let raw = dBodyCreate(world.raw());
        let geom = dCreateSphere(null_mut(), 0.5);
        dGeomSetBody(geom, raw);
        dBodySetPosition(raw, 0.0, 0.0, 0.6);
        (raw, world.adopt_body(raw).unwrap(), world.adopt_geom(geom, root).unwrap())
    };
    assert!(world.bodies().any(|id| id == body) && world.geom(geom).body() == Some(body));
    run(&mut world, 200, 0.01);
    let z = world.body(body).position().z;
    assert!((z - 0.5).abs() < 1e-3, "{z}");

    world.body_mut(body).set_linear_velocity(&Vector3::new(1e9, 0.0, 0.0)).unwrap();
    assert!(world.step(1.0).is_err());
    assert_eq!(world.stopped_bodies(), [body]);

    // SAFETY: the bodies are alive; the one that is refused is destroyed here.
    unsafe {
        let refused = |world: &mut World, raw, expected: &str| {
            let message = world.adopt_body(raw).unwrap_err().to_string();
            assert!(message.contains(expected), "expected {expected:?} in {message:?}");
        };
        refused(&mut world, null_mut(), "expected a body, found null");
        refused(&mut world, raw, "does not own yet");
        refused(&mut crate::world(), raw, "found one of another world");
        let far = dBodyCreate(world.raw());
        dBodySetPosition(far, 1e9, 0.0, 0.0);
        refused(&mut world, far, "a finite pose");
        dBodyDestroy(far);
    }
    assert!(world.remove_body_and_geoms(body) && world.get_geom(geom).is_none());
}
