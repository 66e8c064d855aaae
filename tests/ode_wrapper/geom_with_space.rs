//! One geom is collided with all geoms of a space.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};

use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::ode::{ContactGeom, GeomId, Shape, SpaceId, SpaceKind, Surface, SweepAxes, World};
use ode_visual_hull_random::Random;

use crate::geoms::all_shapes;
use crate::{add, run, world};

/// A space of each kind.
pub(crate) const SPACE_KINDS: [SpaceKind; 4] = [
    SpaceKind::Simple,
    SpaceKind::Hash { min_level: -3, max_level: 10 },
    SpaceKind::SweepAndPrune(SweepAxes::Xyz),
    SpaceKind::QuadTree {
        center: Point3::new(0.0, 0.0, 0.0),
        extents: Vector3::new(8.0, 8.0, 8.0),
        depth: 4,
    },
];

/// A world with 60 geoms of all shapes at random poses, in four nested spaces that begin with the root.
fn random_world(random: &mut Random) -> (World, Vec<SpaceId>) {
    let kind = |random: &mut Random| SPACE_KINDS[random.below(SPACE_KINDS.len())];
    let mut world = World::with_space(world().ode(), kind(random)).unwrap();
    let mut spaces = vec![world.root_space()];
    for _ in 0..3 {
        let parent = spaces[random.below(spaces.len())];
        spaces.push(world.add_space(parent, kind(random)).unwrap());
    }

    let shapes = all_shapes();
    for _ in 0..60 {
        let shape = &shapes[random.below(shapes.len())];
        let geom = world.add_geom(spaces[random.below(spaces.len())], shape).unwrap();
        if shape.is_placeable() {
            place(&mut world, geom, random);
        }
        world.geom_mut(geom).set_enabled(random.unit() < 0.9);
        world.geom_mut(geom).set_category_bits(1 << random.below(2u32));
        world.geom_mut(geom).set_collide_bits(1 << random.below(2u32));
    }
    (world, spaces)
}

fn place(world: &mut World, geom: GeomId, random: &mut Random) {
    let at = random.point(Point3::from([-5.0; 3]), Point3::from([5.0; 3]));
    world.geom_mut(geom).set_pose(&Isometry3::from_parts(at.into(), random.rotation())).unwrap();
}

/// All geoms in a space and its inner spaces.
fn geoms_below(world: &World, space: SpaceId) -> Vec<GeomId> {
    let mut geoms = world.space(space).geoms();
    for inner in world.space(space).inner_spaces() {
        geoms.extend(geoms_below(world, inner));
    }
    geoms
}

/// Whether two geoms are enabled, have bits that let them collide, and boxes that overlap. ODE 0.16 reports some hits
/// of rays with polyhedra far away.
fn may_collide(world: &World, a: GeomId, b: GeomId) -> bool {
    let (a, b) = (world.geom(a), world.geom(b));
    let bits = a.category_bits() & b.collide_bits() | b.category_bits() & a.collide_bits();
    let apart = a.aabb().intersection(&b.aabb()).is_empty();
    a.is_enabled() && b.is_enabled() && bits != 0 && !apart
}

#[test]
fn all_contacts_of_a_geom_are_those_of_its_single_pairs() {
    let mut hits = 0;
    for seed in 0..60 {
        let mut random = Random(seed);
        let (mut world, spaces) = random_world(&mut random);
        for shape in [Shape::Ray { length: 8.0 }, Shape::Sphere { radius: 1.5 }] {
            let geom = world.add_geom(spaces[random.below(spaces.len())], &shape).unwrap();
            place(&mut world, geom, &mut random);
            let space = spaces[random.below(spaces.len())];

            let mut found: Vec<(GeomId, Vec<ContactGeom>)> = Vec::new();
            world
                .collide_geom_with_space(geom, space, |pair| {
                    assert_eq!(pair.geoms()[0], geom);
                    found.push((pair.geoms()[1], pair.contacts(16).to_vec()));
                })
                .unwrap();
            found.sort_by_key(|(other, _)| *other);
            assert!(found.windows(2).all(|two| two[0].0 != two[1].0), "seed {seed}: a pair came twice");
            found.retain(|(_, contacts)| !contacts.is_empty());

            let mut expected = Vec::new();
            for other in geoms_below(&world, space) {
                let contacts = world.collide_geoms(geom, other, 16).unwrap();
                if other != geom && !contacts.is_empty() && may_collide(&world, geom, other) {
                    expected.push((other, contacts));
                }
            }
            expected.sort_by_key(|(other, _)| *other);
            assert_eq!(found, expected, "seed {seed} {shape:?}");
            hits += found.len();
            world.remove_geom(geom);
        }
    }
    assert!(hits > 100, "{hits}");
}

#[test]
fn geoms_of_the_same_body_and_the_geom_itself_are_left_out() {
    for kind in SPACE_KINDS {
        let mut world = World::with_space(world().ode(), kind).unwrap();
        let root = world.root_space();
        let (body, ball) = add(&mut world, &Shape::Sphere { radius: 1.0 }, 1.0, [0.0; 3]);
        let ray = world.add_geom(root, &Shape::Ray { length: 5.0 }).unwrap();
        let lone = world.add_geom(root, &Shape::Sphere { radius: 1.0 }).unwrap();

        let others = |world: &mut World, geom| {
            let mut others = Vec::new();
            world.collide_geom_with_space(geom, root, |pair| others.push(pair.geoms()[1])).unwrap();
            others.sort();
            others
        };
        assert_eq!(others(&mut world, ray), [ball, lone], "{kind:?}");
        assert_eq!(others(&mut world, lone), [ball, ray], "{kind:?}");
        world.geom_mut(ray).set_body(Some(body)).unwrap();
        assert_eq!(others(&mut world, ray), [lone], "{kind:?}");
        world.geom_mut(ray).set_enabled(false);
        assert_eq!(others(&mut world, ray), [], "{kind:?}");
    }
}

#[test]
fn contacts_that_are_attached_act_beside_those_of_the_last_collide() {
    let mut world = world();
    let shelf = world.add_space(world.root_space(), SpaceKind::Simple).unwrap();
    let table = world.add_geom(shelf, &Shape::cuboid(2.0, 2.0, 0.2)).unwrap();
    let (body, ball) = add(&mut world, &Shape::Sphere { radius: 0.2 }, 1.0, [0.0, 0.0, 0.35]);

    for _ in 0..300 {
        world.clear_contacts();
        world
            .collide_geom_with_space(ball, shelf, |pair| {
                assert_eq!(pair.geoms(), [ball, table]);
                for contact in pair.contacts(4).iter() {
                    pair.attach(contact, &Surface::default());
                }
            })
            .unwrap();
        world.step(0.01).unwrap();
    }

    let z = world.body(body).position().z;
    assert!((z - 0.3).abs() < 1e-3, "{z}");
}

#[test]
fn removed_geoms_and_spaces_are_refused_and_a_panic_leaves_the_world_usable() {
    let mut world = world();
    let root = world.root_space();
    let space = world.add_space(root, SpaceKind::Simple).unwrap();
    let (_, ball) = add(&mut world, &Shape::Sphere { radius: 1.0 }, 1.0, [0.0; 3]);
    add(&mut world, &Shape::cube(1.0), 1.0, [0.5, 0.0, 0.0]);
    add(&mut world, &Shape::cube(1.0), 1.0, [0.0, 0.5, 0.0]);

    let calls = Cell::new(0);
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        world.collide_geom_with_space(ball, root, |_| {
            calls.set(calls.get() + 1);
            panic!("in the closure");
        })
    }));
    assert!(outcome.is_err() && calls.get() == 1);
    run(&mut world, 3, 0.01);

    world.remove_space(space).unwrap();
    assert!(world.collide_geom_with_space(ball, space, |_| ()).is_err());
    world.remove_geom(ball);
    assert!(world.collide_geom_with_space(ball, root, |_| ()).is_err());
}
