//! Ownership of the world's objects, and its parameters.

use std::ptr::null_mut;
use std::sync::Arc;

use nalgebra::{Isometry3, Point3, Vector3};
use ode_sys::{dBodyCreate, dCreateSphere, dGeomDestroy, dGeomSetData, dSpaceAdd};

use super::*;
use crate::hull::HullData;
use crate::ode::{AutoDisable, Damping, Shape, SweepAxes, TriMesh};

fn world() -> World {
    World::new(&Ode::init().unwrap()).unwrap()
}

const BALL: Shape = Shape::Sphere { radius: 0.5 };

#[test]
fn a_world_may_be_sent_to_another_thread() {
    fn assert_send<T: Send>() {}
    assert_send::<World>();
    let mut world = world();
    let body = world.add_body();
    let world = std::thread::spawn(move || {
        world.quick_step(0.01).unwrap();
        world
    });
    assert!(world.join().unwrap().contains_body(body));
}

#[test]
fn the_user_data_of_odes_objects_gives_their_ids() {
    let mut world = world();
    let (body, root) = (world.add_body(), world.root_space());
    let geom = world.add_geom(root, &BALL).unwrap();

    // SAFETY: body and geom are alive, or null.
    unsafe {
        let (raw_body, raw_geom) = (world.body(body).raw(), world.geom(geom).raw());
        assert_eq!(world.body_id(raw_body), Some(body));
        assert_eq!(world.geom_id(raw_geom), Some(geom));
        assert_eq!((world.body_id(null_mut()), world.geom_id(null_mut())), (None, None));
    }
}

#[test]
fn objects_made_elsewhere_have_no_id_and_are_not_visited() {
    let mut world = world();
    let root = world.root_space();
    world.add_geom(root, &BALL).unwrap();

    // SAFETY: the test itself makes the body, which the world destroys, and the geom, which it destroys.
    unsafe {
        let body = dBodyCreate(world.raw());
        assert_eq!(world.body_id(body), None);

        let geom = dCreateSphere(null_mut(), 0.5);
        assert_eq!(world.geom_id(geom), None);
        // Another geom with the user data of the world's first geom.
        dGeomSetData(geom, std::ptr::without_provenance_mut(1));
        assert_eq!(world.geom_id(geom), None);

        dSpaceAdd(world.spaces.expect(root).raw, geom);
        world.collide(|pair| panic!("{pair:?}")).unwrap();
        dGeomDestroy(geom);
    }
}

#[test]
fn a_hull_releases_its_data_with_its_geom_or_its_world() {
    let data = Arc::new(HullData::new());
    let mut world = world();
    let root = world.root_space();
    let [first, _] = [0, 1].map(|_| world.add_hull(root, &data).unwrap());
    assert_eq!(Arc::strong_count(&data), 3);
    assert_eq!(world.geom(first).shape(), None);
    assert!(world.geom_mut(first).set_shape(&BALL).is_err());

    assert!(world.remove_geom(first));
    assert_eq!(Arc::strong_count(&data), 2);
    drop(world);
    assert_eq!(Arc::strong_count(&data), 1);
}

#[test]
fn a_hull_for_a_removed_space_is_destroyed() {
    let data = Arc::new(HullData::new());
    let mut world = world();
    let space = world.add_space(world.root_space(), SpaceKind::Simple).unwrap();
    world.remove_space(space).unwrap();
    assert!(world.add_hull(space, &data).is_err());
    assert_eq!(Arc::strong_count(&data), 1);
}

#[test]
fn removing_a_space_removes_its_contents_and_keeps_the_bodies() {
    let mut world = world();
    let outer = world.add_space(world.root_space(), SpaceKind::Simple).unwrap();
    let inner = world.add_space(outer, SpaceKind::SweepAndPrune(SweepAxes::Zyx)).unwrap();
    let geoms = [outer, inner, world.root_space()].map(|space| world.add_geom(space, &BALL).unwrap());
    let body = world.add_body();
    world.geom_mut(geoms[1]).set_body(Some(body)).unwrap();

    world.remove_space(outer).unwrap();
    assert_eq!(geoms.map(|geom| world.contains_geom(geom)), [false, false, true]);
    assert_eq!([outer, inner].map(|space| world.contains_space(space)), [false, false]);
    assert!(world.contains_body(body) && world.geoms_of(body).is_empty());
    assert!(world.remove_space(outer).is_err());
    assert!(world.remove_space(world.root_space()).is_err());
}

#[test]
fn a_geom_moves_from_any_kind_of_space_to_any_other() {
    let quad_tree =
        SpaceKind::QuadTree { center: Point3::origin(), extents: Vector3::repeat(10.0), depth: 3 };
    let kinds =
        [SpaceKind::Simple, SpaceKind::default(), SpaceKind::SweepAndPrune(SweepAxes::Xyz), quad_tree];
    let mut world = world();
    let spaces = kinds.map(|kind| world.add_space(world.root_space(), kind).unwrap());
    let others = spaces.map(|space| world.add_geom(space, &BALL).unwrap());
    let geom = world.add_geom(spaces[0], &BALL).unwrap();

    // Each space contains one ball, so that the moved geom always meets all of them.
    for from in spaces {
        for to in spaces {
            for space in [from, to] {
                world.geom_mut(geom).set_space(space).unwrap();
                assert_eq!(world.geom(geom).space(), space);
                let mut pairs = Vec::new();
                world
                    .collide(|pair| pairs.extend(pair.geoms().contains(&geom).then(|| pair.geoms())))
                    .unwrap();
                assert_eq!(pairs.len(), others.len(), "in a {:?}", world.space_kind(space));
            }
        }
    }
}

#[test]
fn a_dropped_world_frees_everything_in_it() {
    let mesh = TriMesh::new(
        vec![Point3::origin(), Point3::new(1.0, 0.0, 0.0), Point3::new(0.0, 1.0, 0.0)],
        vec![[0, 1, 2]],
    );
    let mesh = Shape::TriMesh(Arc::new(mesh.unwrap()));

    for _ in 0..20 {
        let mut world = world();
        let space = world.add_space(world.root_space(), SpaceKind::default()).unwrap();
        let (body, geom) = (world.add_body(), world.add_geom(space, &mesh).unwrap());
        world.geom_mut(geom).set_body(Some(body)).unwrap();
        world.add_geom(space, &BALL).unwrap();

        let group = world.add_joint_group();
        world.add_joint_in(group, [Some(body), None], &crate::ode::JointKind::Fixed).unwrap();
        world.add_joint([Some(body), None], &crate::ode::JointKind::Fixed).unwrap();

        world.default_collide(&crate::ode::Surface::default(), 4).unwrap();
        world.quick_step(0.01).unwrap();
    }
}

#[test]
fn parameters_are_stored_and_values_out_of_range_are_refused() {
    let mut world = world();
    let check_number =
        |world: &mut World, set: fn(&mut World, f64) -> Result<()>, get: fn(&World) -> f64, good: f64| {
            set(world, good).unwrap();
            assert!((get(world) - good).abs() < 1e-15);

            // A refused value leaves the old one in place.
            for bad in [f64::NAN, -1.0, f64::NEG_INFINITY] {
                assert!(set(world, bad).is_err());
            }
            assert!((get(world) - good).abs() < 1e-15);
        };

    check_number(&mut world, World::set_erp, World::erp, 0.3);
    check_number(&mut world, World::set_cfm, World::cfm, 1e-5);
    check_number(&mut world, World::set_contact_surface_layer, World::contact_surface_layer, 1e-3);
    check_number(
        &mut world,
        World::set_contact_max_correcting_velocity,
        World::contact_max_correcting_velocity,
        0.5,
    );
    check_number(&mut world, World::set_quick_step_w, World::quick_step_w, 1.2);
    check_number(&mut world, World::set_max_angular_speed, World::max_angular_speed, 50.0);

    world.set_quick_step_iterations(50).unwrap();
    assert!(world.set_quick_step_iterations(0).is_err());
    assert_eq!(world.quick_step_iterations(), 50);

    world.set_gravity(&Vector3::new(1.0, 2.0, 3.0)).unwrap();
    assert!(world.set_gravity(&Vector3::repeat(f64::NAN)).is_err());
    assert_eq!(world.gravity(), Vector3::new(1.0, 2.0, 3.0));
}

#[test]
fn the_defaults_equal_odes_own() {
    let mut world = world();
    // ODE stores the squares of the thresholds, so they come back with roundoff.
    let (ours, ode) = (AutoDisable::default(), world.auto_disable());
    assert!((ode.linear_threshold - ours.linear_threshold).abs() < 1e-15);
    assert!((ode.angular_threshold - ours.angular_threshold).abs() < 1e-15);
    assert_eq!((ode.steps, ode.time, ode.average_samples), (ours.steps, ours.time, ours.average_samples));

    let (ours, ode) = (Damping::default(), world.damping());
    assert!((ode.linear_threshold - ours.linear_threshold).abs() < 1e-15);
    assert_eq!((ode.linear, ode.angular), (ours.linear, ours.angular));

    assert_eq!((world.erp(), world.quick_step_iterations(), world.quick_step_w()), (0.2, 20, 1.3));
    assert_eq!(world.gravity(), Vector3::zeros());
    assert!(!world.has_auto_disable());

    let body = world.add_body();
    let body = world.body(body);
    assert_eq!((body.pose(), body.mass().total()), (Isometry3::identity(), 1.0));
    assert!(body.is_enabled() && body.has_gravity() && !body.is_kinematic() && !body.has_auto_disable());
}

#[test]
fn new_bodies_take_the_parameters_of_the_world_and_may_have_their_own() {
    let mut world = world();
    let parameters = AutoDisable { steps: 3, average_samples: 5, time: 0.5, ..AutoDisable::default() };
    world.set_auto_disable(true);
    world.set_auto_disable_parameters(&parameters).unwrap();
    world.set_damping(&Damping { linear: 0.1, angular: 0.2, ..Damping::default() }).unwrap();

    let body = world.add_body();
    assert!(world.body(body).has_auto_disable());
    assert_eq!(
        (world.body(body).auto_disable().steps, world.body(body).auto_disable().average_samples),
        (3, 5)
    );
    assert_eq!((world.body(body).damping().linear, world.body(body).damping().angular), (0.1, 0.2));

    let mut body_mut = world.body_mut(body);
    body_mut.set_auto_disable(false);
    body_mut.set_auto_disable_parameters(&AutoDisable { steps: 7, ..parameters }).unwrap();
    body_mut.set_damping(&Damping::default()).unwrap();

    assert!(body_mut.set_auto_disable_parameters(&AutoDisable { average_samples: 0, ..parameters }).is_err());
    assert!(body_mut.set_auto_disable_parameters(&AutoDisable { time: f64::NAN, ..parameters }).is_err());
    assert!(body_mut.set_damping(&Damping { linear: 1.5, ..Damping::default() }).is_err());
    let body = world.body(body);
    assert_eq!((body.has_auto_disable(), body.auto_disable().steps, body.damping().linear), (false, 7, 0.0));
}
