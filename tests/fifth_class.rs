//! ODE has room for four user classes in a process and aborts at a fifth. The hull registers a single class and returns
//! an error where no room is left. These tests have a process of their own, because classes of other tests would count.

mod foreign_class;
use ode_sys::{dCloseODE, dInitODE2};
use ode_visual_hull::ode::{Ode, World};
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Lets the tests run one after the other, each from an empty table of classes, which is global in the process.
fn lock_class_table() -> MutexGuard<'static, ()> {
    static LOCK: Mutex<()> = Mutex::new(());
    LOCK.lock().unwrap_or_else(PoisonError::into_inner)
}

#[test]
fn a_hull_beside_four_other_classes_is_refused_and_the_process_lives() {
    let _lock = lock_class_table();
    let data = table();
    {
        let mut world = World::new(&Ode::init().unwrap()).unwrap();
        (14..18).for_each(|number| assert_eq!(foreign_class::register(), number));
        let root = world.root_space();
        for _ in 0..2 {
            let refused = world.add_hull(root, &data).unwrap_err().to_string();
            for part in ["ODE", "one more user class", "all four taken", "register fewer"] {
                assert!(refused.contains(part), "{refused}");
            }
        }

        let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, 1.0));
        step(&mut world, 0.005);
        assert!(world.body(body).position().z.is_finite());
    }
    // ODE has room again after it was closed.
    let (mut world, body) = drop_box_on(&data);
    (0..200).for_each(|_| step(&mut world, 0.005));
    assert!((height(&world, body) - TOP - 0.1).abs() < 0.002);
}

#[test]
fn beside_three_other_classes_there_is_room() {
    let _lock = lock_class_table();
    let _ode = Ode::init().unwrap();
    (14..17).for_each(|number| assert_eq!(foreign_class::register(), number));
    let (mut world, body) = drop_box_on(&table());
    (0..200).for_each(|_| step(&mut world, 0.005));
    assert!((height(&world, body) - TOP - 0.1).abs() < 0.002);
}

#[test]
fn the_class_is_registered_once_over_many_worlds() {
    let _lock = lock_class_table();
    let data = table();
    let ode = Ode::init().unwrap();
    for _ in 0..10 {
        let (mut world, _) = drop_box_on(&data);
        let root = world.root_space();
        world.add_hull(root, &data).unwrap();
    }
    assert_eq!(foreign_class::register(), 15, "only the hull's class stands before this one");
    drop(ode);
}

#[test]
fn the_class_is_found_again_while_only_others_keep_ode_open() {
    let _lock = lock_class_table();
    let data = table();

    // SAFETY: pairs with the dCloseODE below.
    assert_ne!(unsafe { dInitODE2(0) }, 0);

    for _ in 0..6 {
        let (mut world, body) = drop_box_on(&data);
        (0..40).for_each(|_| step(&mut world, 0.005));
        assert!(height(&world, body) > TOP + 0.09, "the hull holds it");
    }

    assert_eq!(foreign_class::register(), 15);

    // SAFETY: pairs with the dInitODE2 above.
    unsafe { dCloseODE() };

    // After the last reference is gone, the number of the class is free: another class takes it, and the hull the next.
    let _ode = Ode::init().unwrap();
    assert_eq!(foreign_class::register(), 14);

    let (mut world, body) = drop_box_on(&data);
    (0..200).for_each(|_| step(&mut world, 0.005));

    assert!((height(&world, body) - TOP - 0.1).abs() < 0.002);
    assert_eq!(foreign_class::register(), 16);
}
