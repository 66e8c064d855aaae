//! ODE closes with the last reference on it, and opens again. Alone in its process: others would hold ODE open.

use nalgebra::Vector3;
use ode_sys::{dCreateGeomClass, dGeomClass, dGeomID, dInfiniteAABB, dReal};
use ode_visual_hull::ode::{Ode, Shape, Surface, World, random_seed, set_random_seed};

unsafe extern "C" fn no_box(geom: dGeomID, bounds: *mut dReal) {
    // SAFETY: ODE passes a geom and six numbers.
    unsafe { dInfiniteAABB(geom, bounds) };
}

unsafe extern "C" fn no_collider(_: i32) -> ode_sys::dColliderFn {
    None
}

/// Registers a geometry class; its number tells how many there were since ODE was opened.
fn register_class() -> i32 {
    let class =
        dGeomClass { bytes: 8, collider: Some(no_collider), aabb: Some(no_box), aabb_test: None, dtor: None };
    // SAFETY: the structure is whole, and ODE copies it.
    unsafe { dCreateGeomClass(&class) }
}

fn simulate(ode: &Ode) -> f64 {
    let mut world = World::new(ode).unwrap();
    world.set_gravity(&Vector3::new(0.0, 0.0, -9.81)).unwrap();
    let root = world.root_space();
    world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: -0.1 }).unwrap();
    let (body, geom) = (world.add_body(), world.add_geom(root, &Shape::Sphere { radius: 0.1 }).unwrap());
    world.geom_mut(geom).set_body(Some(body)).unwrap();
    for _ in 0..50 {
        world.default_collide(&Surface::default(), 4).unwrap();
        world.quick_step(0.01).unwrap();
    }
    world.body(body).position().z
}

#[test]
fn ode_closes_with_its_last_reference_and_opens_again() {
    for _ in 0..3 {
        let ode = Ode::init().unwrap();
        let first = register_class();
        let clone = ode.clone();
        drop(ode);
        assert_eq!(register_class(), first + 1, "a clone holds ODE open");

        let world = World::new(&clone).unwrap();
        drop(clone);
        assert_eq!(register_class(), first + 2, "a world holds ODE open");
        drop(world);

        let again = Ode::init().unwrap();
        assert_eq!(register_class(), first, "ODE was closed in between, and has forgotten the classes");
        let here = simulate(&again);
        // A thread that entered ODE when it was open before.
        let there = std::thread::spawn(move || simulate(&again)).join().unwrap();
        assert_eq!(here, there);
    }
    set_random_seed(1234);
    assert_eq!(random_seed(), 1234);
}
