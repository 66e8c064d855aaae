//! Colliding: the pairs that are found, what a closure may do with them, and panics in it.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};

use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::ode::{GeomId, JointKind, Ode, Shape, SpaceKind, Surface, SweepAxes, World};

use crate::{add, add_ground, run, world};

fn kinds() -> Vec<SpaceKind> {
    let quad_tree = |depth| SpaceKind::QuadTree {
        center: Point3::new(0.5, 0.0, 0.0),
        extents: Vector3::repeat(2.0),
        depth,
    };
    vec![
        SpaceKind::Simple,
        SpaceKind::default(),
        SpaceKind::Hash { min_level: -5, max_level: -2 },
        SpaceKind::SweepAndPrune(SweepAxes::Xyz),
        SpaceKind::SweepAndPrune(SweepAxes::Zyx),
        SpaceKind::SweepAndPrune(SweepAxes::Yxz),
        quad_tree(1),
        quad_tree(5),
    ]
}

/// The pose of the `i`th ball: an irregular scatter in a cube of side 6.
fn place(i: usize) -> Isometry3<f64> {
    let coordinate = |step: usize| ((i * i * 7 + i * step + 17) % 97) as f64 / 97.0 * 6.0 - 3.0;
    Isometry3::translation(coordinate(31), coordinate(57), coordinate(73))
}

const COUNT: usize = 60;

/// The pairs that colliding finds, as indices into `geoms`.
fn pairs(world: &mut World, geoms: &[GeomId]) -> BTreeSet<[usize; 2]> {
    let mut found = BTreeSet::new();
    world
        .collide(|pair| {
            let mut numbers = pair.geoms().map(|geom| geoms.iter().position(|&own| own == geom).unwrap());
            numbers.sort_unstable();
            assert!(found.insert(numbers), "each pair once: {numbers:?}");
        })
        .unwrap();
    found
}

/// Adds sixty balls, distributed over `spaces`, and a ground in the first of them.
fn scatter(world: &mut World, spaces: &[ode_visual_hull::ode::SpaceId]) -> Vec<GeomId> {
    let mut geoms: Vec<GeomId> = (0..COUNT)
        .map(|i| {
            let geom = world.add_geom(spaces[i % spaces.len()], &Shape::Sphere { radius: 0.4 }).unwrap();
            world.geom_mut(geom).set_pose(&place(i)).unwrap();
            geom
        })
        .collect();
    let ground = Shape::Plane { normal: Vector3::new(0.0, 0.1, 1.0), offset: -1.0 };
    geoms.push(world.add_geom(spaces[0], &ground).unwrap());
    geoms
}

/// The pairs of geoms whose bounding boxes overlap, as indices into `geoms`.
fn overlapping_boxes(world: &World, geoms: &[GeomId]) -> BTreeSet<[usize; 2]> {
    let mut overlaps = BTreeSet::new();
    for j in 0..geoms.len() {
        for i in 0..j {
            let (a, b) = (world.geom(geoms[i]).aabb(), world.geom(geoms[j]).aabb());
            if (0..3).all(|axis| a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis]) {
                overlaps.insert([i, j]);
            }
        }
    }
    overlaps
}

#[test]
fn every_kind_of_space_finds_the_same_pairs() {
    let ode = Ode::init().unwrap();
    for kind in kinds() {
        let mut world = World::with_space(&ode, kind).unwrap();
        let root = world.root_space();
        let geoms = scatter(&mut world, &[root]);
        assert!(overlapping_boxes(&world, &geoms).len() > COUNT);
        assert_eq!(pairs(&mut world, &geoms), overlapping_boxes(&world, &geoms), "{kind:?}");

        // Once more, after all balls have moved.
        for (i, &geom) in geoms[..COUNT].iter().enumerate() {
            world.geom_mut(geom).set_pose(&place(i + 200)).unwrap();
        }
        assert_eq!(pairs(&mut world, &geoms), overlapping_boxes(&world, &geoms), "{kind:?}, moved");
    }
}

#[test]
fn nested_spaces_find_the_same_pairs() {
    let ode = Ode::init().unwrap();
    for outer in kinds() {
        for inner in kinds() {
            let mut world = World::with_space(&ode, outer).unwrap();
            let root = world.root_space();
            let first = world.add_space(root, inner).unwrap();
            let second = world.add_space(first, outer).unwrap();
            let third = world.add_space(root, outer).unwrap();
            let empty = world.add_space(root, inner).unwrap();

            let geoms = scatter(&mut world, &[root, first, second, third]);
            assert_eq!(
                pairs(&mut world, &geoms),
                overlapping_boxes(&world, &geoms),
                "{outer:?} around {inner:?}"
            );

            world.remove_space(empty).unwrap();
            for (i, &geom) in geoms[..COUNT].iter().enumerate() {
                world.geom_mut(geom).set_pose(&place(i + 200)).unwrap();
            }
            assert_eq!(
                pairs(&mut world, &geoms),
                overlapping_boxes(&world, &geoms),
                "{outer:?} around {inner:?}, moved"
            );
        }
    }
}

#[test]
fn disabled_geoms_and_geoms_without_common_bits_are_left_out() {
    for kind in kinds() {
        let mut world = world();
        let root = world.root_space();
        let nested = world.add_space(root, kind).unwrap();
        let other = world.add_space(root, kind).unwrap();
        let shape = Shape::Sphere { radius: 0.5 };
        let geoms = [nested, nested, other].map(|space| world.add_geom(space, &shape).unwrap());
        assert_eq!(pairs(&mut world, &geoms).len(), 3);

        world.geom_mut(geoms[0]).set_enabled(false);
        assert!(!world.geom(geoms[0]).is_enabled());
        assert_eq!(pairs(&mut world, &geoms), BTreeSet::from([[1, 2]]), "{kind:?}");

        world.geom_mut(geoms[0]).set_enabled(true);
        world.geom_mut(geoms[1]).set_category_bits(2);
        world.geom_mut(geoms[1]).set_collide_bits(0);
        world.geom_mut(geoms[2]).set_collide_bits(1);
        assert_eq!((world.geom(geoms[1]).category_bits(), world.geom(geoms[1]).collide_bits()), (2, 0));
        assert_eq!(pairs(&mut world, &geoms), BTreeSet::from([[0, 1], [0, 2]]), "{kind:?}");
    }
}

#[test]
fn two_geoms_of_one_body_are_no_pair() {
    let mut world = world();
    let (body, first) = add(&mut world, &Shape::Sphere { radius: 0.5 }, 1.0, [0.0; 3]);
    let second = world.add_geom(world.root_space(), &Shape::cuboid(1.0, 1.0, 1.0)).unwrap();
    assert_eq!(pairs(&mut world, &[first, second]).len(), 1);
    world.geom_mut(second).set_body(Some(body)).unwrap();
    assert_eq!(pairs(&mut world, &[first, second]).len(), 0);
}

#[test]
fn a_pair_knows_its_bodies_and_its_contacts() {
    let mut world = world();
    let ground = add_ground(&mut world);
    let (body, geom) = add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [0.0, 0.0, 0.09]);
    let mut visited = 0;
    world
        .collide(|pair| {
            visited += 1;

            let swapped = pair.geoms() == [ground, geom];
            assert!(swapped || pair.geoms() == [geom, ground]);
            assert_eq!(pair.bodies(), if swapped { [None, Some(body)] } else { [Some(body), None] });
            assert_eq!(pair.geom_views().map(|view| view.id()), pair.geoms());
            assert_eq!(pair.body(body).unwrap().position().z, 0.09);
            assert!(pair.touches() && !pair.are_connected_excluding_contact());
            assert!(pair.contacts(0).is_empty());
            // Two lists of contacts may exist at a time.
            let (all, few) = (pair.contacts(8), pair.contacts(3));
            assert_eq!((all.len(), few.len()), (4, 3));
            for contact in all.iter() {
                assert!((contact.depth - 0.01).abs() < 1e-12);
                assert_eq!(contact.normal.z, if swapped { -1.0 } else { 1.0 });
            }
        })
        .unwrap();
    assert_eq!(visited, 1);
}

#[test]
fn contacts_last_until_the_next_collide() {
    let mut world = world();
    add_ground(&mut world);
    let (body, _) = add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [0.0, 0.0, 0.1]);
    let fall = |world: &mut World| {
        world.step(0.01).unwrap();
        world.body(body).linear_velocity().z < -0.05
    };
    world.default_collide(&Surface::default(), 8).unwrap();

    assert!(!fall(&mut world) && !fall(&mut world));

    world.clear_contacts();
    assert!(fall(&mut world));

    world.default_collide(&Surface::default(), 8).unwrap();
    assert!(!fall(&mut world));

    world.collide(|_| ()).unwrap();
    assert!(fall(&mut world));
}

#[test]
fn jointed_bodies_do_not_collide_by_default() {
    let mut world = world();
    world.set_gravity(&Vector3::zeros()).unwrap();
    let shape = Shape::Sphere { radius: 0.5 };
    let [a, b] = [0.0, 0.5].map(|x| add(&mut world, &shape, 1.0, [x, 0.0, 0.0]).0);
    let joint = world.add_joint([Some(a), Some(b)], &JointKind::Ball { anchor: Point3::origin() }).unwrap();

    let mut connected = Vec::new();
    world.collide(|pair| connected.push(pair.are_connected_excluding_contact())).unwrap();

    assert_eq!(connected, [true]);

    run(&mut world, 10, 0.01);
    assert!(world.body(b).linear_velocity().norm() < 1e-12);

    world.remove_joint(joint);
    run(&mut world, 10, 0.01);
    assert!(world.body(b).linear_velocity().x > 0.1);
}

#[test]
fn an_invalid_contact_becomes_the_error_of_collide() {
    let mut world = world();
    add_ground(&mut world);
    add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [0.0, 0.0, 0.09]);
    let collide =
        |world: &mut World, spoil: fn(&mut ode_visual_hull::ode::ContactGeom), surface: &Surface| {
            world.collide(|pair| {
                for mut contact in pair.contacts(8).iter().copied() {
                    spoil(&mut contact);
                    pair.attach(&contact, surface);
                }
            })
        };

    let good = Surface::default();

    assert!(collide(&mut world, |_| (), &good).is_ok());

    assert!(collide(&mut world, |contact| contact.depth = f64::NAN, &good).is_err());
    assert!(collide(&mut world, |contact| contact.depth = -0.1, &good).is_err());
    assert!(collide(&mut world, |contact| contact.normal *= 2.0, &good).is_err());
    assert!(collide(&mut world, |contact| contact.normal.x = f64::NAN, &good).is_err());
    assert!(collide(&mut world, |contact| contact.position.x = f64::INFINITY, &good).is_err());

    let bad = Surface { mu: f64::NAN, ..good };
    assert!(collide(&mut world, |_| (), &bad).unwrap_err().to_string().contains("mu"));
    assert!(world.default_collide(&bad, 8).is_err());
}

#[test]
fn a_panic_leaves_collide_and_the_world_still_works() {
    let mut world = world();
    let nested = world.add_space(world.root_space(), SpaceKind::Simple).unwrap();
    let ground = add_ground(&mut world);
    let (body, geom) = add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [0.0, 0.0, 0.1]);
    let (_, second) = add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [1.0, 0.0, 0.1]);
    world.geom_mut(second).set_space(nested).unwrap();

    let mut visited = 0;
    let payload = catch_unwind(AssertUnwindSafe(|| {
        world.collide(|pair| {
            visited += 1;
            let _contacts = pair.contacts(4);
            std::panic::panic_any(42_u32);
        })
    }))
    .unwrap_err();

    assert_eq!((payload.downcast_ref::<u32>(), visited), (Some(&42), 1));

    // No lock is left behind: everything that ODE refuses during a collide works.
    world.geom_mut(geom).set_space(nested).unwrap();
    world.geom_mut(second).set_body(None).unwrap();

    assert_eq!(pairs(&mut world, &[ground, geom, second]).len(), 2);

    run(&mut world, 50, 0.01);
    assert!((world.body(body).position().z - 0.1).abs() < 1e-3);
}

#[test]
fn a_closure_may_use_another_world() {
    let (mut outer, mut inner) = (world(), world());
    for world in [&mut outer, &mut inner] {
        add_ground(world);
        add(world, &Shape::Sphere { radius: 0.1 }, 1.0, [0.0, 0.0, 0.05]);
    }

    let mut pairs = 0;
    outer
        .collide(|pair| {
            assert!(pair.touches());
            inner.collide(|pair| pairs += pair.contacts(4).len()).unwrap();
            inner.step(0.01).unwrap();
        })
        .unwrap();
    assert_eq!(pairs, 1);
}

#[test]
fn worlds_on_several_threads_do_not_disturb_each_other() {
    let simulate = || {
        let mut world = world();
        add_ground(&mut world);
        let points =
            vec![Point3::new(-5.0, -5.0, 0.02), Point3::new(5.0, -5.0, 0.02), Point3::new(0.0, 5.0, 0.02)];

        let mesh = ode_visual_hull::ode::TriMesh::new(points, vec![[0, 1, 2]]).unwrap();
        world.add_geom(world.root_space(), &Shape::TriMesh(mesh.into())).unwrap();

        let bodies: Vec<_> = (0..6)
            .map(|i| {
                add(&mut world, &Shape::cuboid(0.2, 0.2, 0.2), 1.0, [0.0, 0.0, 0.15 + 0.25 * f64::from(i)]).0
            })
            .collect();
        run(&mut world, 100, 0.005);
        bodies.iter().map(|&body| world.body(body).position()).collect::<Vec<_>>()
    };
    let alone = simulate();
    let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(simulate)).collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), alone);
    }
}
