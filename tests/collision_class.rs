//! The hull as a geometry class of ODE: the rules of every geometry class, and the properties of this one.

use nalgebra::{Point3, UnitQuaternion, Vector3, point, vector};
use ode_visual_hull::contact::Mode;
use ode_visual_hull::hull::HullData;
use ode_visual_hull::ode::{ContactGeom, GeomId, RayFlags, Shape, SpaceKind, Surface, TriMesh, World};
use ode_visual_hull::sample;
use ode_visual_hull::synthetic::Subject;
use ode_visual_hull_testing::random::Random;
use ode_visual_hull_testing::scene::*;
use ode_visual_hull_testing::world::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

fn space_kinds() -> [SpaceKind; 4] {
    [
        SpaceKind::Simple,
        SpaceKind::default(),
        SpaceKind::SweepAndPrune(Default::default()),
        SpaceKind::QuadTree { center: Point3::origin(), extents: vector![2.0, 2.0, 2.0], depth: 4 },
    ]
}

fn with_table(kind: SpaceKind) -> (World, GeomId) {
    let mut world = world(kind);
    let root = world.root_space();
    let hull = world.add_hull(root, &table()).unwrap();
    (world, hull)
}

/// Contacts of the hull with a cube of 0.2 m whose base is 4 mm deep in the table.
fn cube_contacts(world: &mut World, hull: GeomId, max: usize) -> Vec<ContactGeom> {
    let (_, cube) = add_body(world, &cube(0.2), &at(0.0, 0.0, TOP + 0.096));
    world.collide_geoms(hull, cube, max).unwrap()
}

#[test]
fn a_box_dropped_on_the_hull_comes_to_rest_on_it_in_every_kind_of_space() {
    for kind in space_kinds() {
        let (mut world, _) = with_table(kind);
        let (body, _) = add_body(&mut world, &cube(0.2), &at(0.03, -0.02, TOP + 0.13));
        for _ in 0..400 {
            step(&mut world, 0.005);
        }
        let at_rest = height(&world, body) - TOP - 0.1;
        // The surface layer lets it sink by 1 mm, and the hull is exact to a third of a pixel.
        assert!((-0.001 - 0.33 * PIXEL..0.33 * PIXEL).contains(&at_rest), "{kind:?}: {at_rest}");
        assert!(world.body(body).linear_velocity().norm() < 0.01);
    }
}

#[test]
fn normals_point_into_the_first_geom_whatever_the_order() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let (_, cube) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.096));
    let hull_first = world.collide_geoms(hull, cube, 8).unwrap();
    let cube_first = world.collide_geoms(cube, hull, 8).unwrap();
    assert_eq!(hull_first.len(), 8);
    for (a, b) in hull_first.iter().zip(&cube_first) {
        assert!(a.normal.z < -0.99, "into the hull: {a:?}");
        assert_eq!((a.normal, a.position, a.depth), (-b.normal, b.position, b.depth));
        assert_eq!((a.geoms, b.geoms), ([hull, cube], [cube, hull]));
        assert!(a.depth >= 0.0 && (a.depth - 0.004).abs() < 0.33 * PIXEL);
    }
}

#[test]
fn the_callers_limit_and_the_geoms_maximum_of_contacts_both_hold() {
    let (mut world, hull) = with_table(SpaceKind::default());
    assert_eq!(cube_contacts(&mut world, hull, 3).len(), 3);
    assert_eq!(cube_contacts(&mut world, hull, 1).len(), 1);
    assert_eq!(cube_contacts(&mut world, hull, 100).len(), 8);
    world.hull_mut(hull).set_max_contacts(20).unwrap();
    assert_eq!(cube_contacts(&mut world, hull, 100).len(), 20);
    assert_eq!(cube_contacts(&mut world, hull, 12).len(), 12);
}

#[test]
fn a_pair_touches_if_and_only_if_it_has_contacts() {
    let (mut world, _) = with_table(SpaceKind::default());
    for k in 0..20 {
        add_body(&mut world, &cube(0.1), &at(0.2, 0.0, TOP + 0.04 + 0.002 * f64::from(k)));
    }
    let mut pairs = 0;
    world
        .collide(|pair| {
            pairs += 1;
            assert_eq!(pair.touches(), !pair.contacts(8).is_empty());
        })
        .unwrap();
    assert!(pairs >= 20);
}

#[test]
fn every_shape_comes_to_rest_on_the_hull() {
    let sides = vector![0.16, 0.16, 0.16];
    let corners: Vec<Point3<f64>> = (0..8)
        .map(|c| {
            point![0.0, 0.0, 0.0]
                + vector![c & 1, c >> 1 & 1, c >> 2 & 1].map(|bit| f64::from(bit) * 0.16 - 0.08)
        })
        .collect();

    // Faces of a cube, counter-clockwise from outside.
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

    let triangles =
        faces.iter().flat_map(|f: &[u32; 4]| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect::<Vec<_>>();
    let polygons: Vec<Vec<u32>> = faces.iter().map(|face| face.to_vec()).collect();
    let convex = ode_visual_hull::ode::Convex::new(corners.clone(), &polygons).unwrap();

    let shapes = [
        (Shape::Sphere { radius: 0.08 }, 0.08),
        (Shape::Box { sides }, 0.08),
        (Shape::Capsule { radius: 0.05, length: 0.08 }, 0.09),
        (Shape::Cylinder { radius: 0.08, length: 0.16 }, 0.08),
        (Shape::Convex(Arc::new(convex)), 0.08),
        (Shape::TriMesh(Arc::new(TriMesh::new(corners, triangles).unwrap())), 0.08),
    ];

    for (shape, half) in shapes {
        let (mut world, _) = with_table(SpaceKind::default());
        // Half a second is enough to land, and too short for a capsule on its cap to tip over.
        let (body, _) = add_body(&mut world, &shape, &at(0.01, 0.02, TOP + half + 0.01));
        for _ in 0..100 {
            step(&mut world, 0.005);
        }
        let above = height(&world, body) - TOP - half;
        assert!(above.abs() < 0.004, "{shape:?}: {above}");
    }
}

#[test]
fn contacts_do_not_depend_on_the_offset_of_a_geom_from_its_body() {
    // Two equal cubes at one place: one geom at its body, the other 0.3 m beside it.
    let (mut world, hull) = with_table(SpaceKind::default());
    let offset = at(0.3, 0.0, 0.0) * UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4);
    let turned = at(0.0, 0.0, TOP + 0.096) * UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4);
    let (_, plain) = add_body(&mut world, &cube(0.2), &turned);
    let (_, mounted) = add_body(&mut world, &cube(0.2), &at(-0.3, 0.0, TOP + 0.096));
    world.geom_mut(mounted).set_offset(&offset).unwrap();

    let a = world.collide_geoms(hull, plain, 8).unwrap();
    let b = world.collide_geoms(hull, mounted, 8).unwrap();

    assert_eq!(a.len(), b.len());

    for (a, b) in a.iter().zip(&b) {
        assert!((a.position - b.position).norm() < 1e-9 && (a.normal - b.normal).norm() < 1e-9);
        assert!((a.depth - b.depth).abs() < 1e-9);
    }
}

#[test]
fn moving_the_hull_moves_the_whole_capture_space() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let here = cube_contacts(&mut world, hull, 8);
    let motion = at(5.0, -2.0, 1.0) * UnitQuaternion::from_euler_angles(0.3, -0.2, 2.0);
    world.geom_mut(hull).set_pose(&motion).unwrap();
    let (_, moved) = add_body(&mut world, &cube(0.2), &(motion * at(0.0, 0.0, TOP + 0.096)));
    let there = world.collide_geoms(hull, moved, 8).unwrap();
    assert_eq!(here.len(), there.len());
    for (a, b) in here.iter().zip(&there) {
        assert!((motion * a.position - b.position).norm() < 1e-9);
        assert!((motion * a.normal - b.normal).norm() < 1e-9);
    }
    assert!(world.hull(hull).inside(&(motion * ORIGIN)) && !world.hull(hull).inside(&ORIGIN));
}

#[test]
fn the_hull_works_in_nested_spaces() {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    let hulls = world.add_space(root, SpaceKind::Simple).unwrap();
    let deeper = world.add_space(hulls, SpaceKind::default()).unwrap();
    world.add_hull(deeper, &table()).unwrap();
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.12));
    for _ in 0..200 {
        step(&mut world, 0.005);
    }
    assert!((height(&world, body) - TOP - 0.1).abs() < 0.003);
}

#[test]
fn a_frame_published_between_two_collides_takes_effect_with_the_next() {
    let cameras = table_cameras();
    let lifted = masks_of(&cameras, &Subject::new(vec![cuboid(TABLE, at(0.0, 0.0, 0.18))]));
    let gone = masks_of(&cameras, &Subject::new(Vec::new()));

    for kind in space_kinds() {
        let data = table();
        let mut world = world(kind);
        let root = world.root_space();
        world.add_hull(root, &data).unwrap();
        let (_, cube) = add_body(&mut world, &cube(0.1), &at(0.0, 0.0, TOP + 0.2));

        let touching = |world: &mut World| {
            let mut found = 0;
            world
                .collide(|pair| {
                    if pair.geoms().contains(&cube) {
                        found += pair.contacts(8).len()
                    }
                })
                .unwrap();
            found
        };

        assert_eq!(touching(&mut world), 0);
        publish(&data, &lifted, 1.0);
        assert!(touching(&mut world) > 0, "{kind:?}");
        publish(&data, &gone, 2.0);
        assert_eq!(touching(&mut world), 0, "{kind:?}");
    }
}

/// A world with a cube asleep on the table.
fn asleep_on(data: &Arc<HullData>) -> (World, ode_visual_hull::ode::BodyId) {
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    world.add_hull(root, data).unwrap();
    world.set_auto_disable(true);
    let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.1));
    for _ in 0..600 {
        step(&mut world, 0.005);
    }
    assert!(!world.body(body).is_enabled(), "asleep after three seconds");
    (world, body)
}

#[test]
fn a_sleeping_body_wakes_when_the_hull_beneath_it_changes_or_vanishes() {
    let cameras = table_cameras();
    let (lifted, gone) = (Subject::new(vec![cuboid(TABLE, at(0.0, 0.0, 0.02))]), Subject::new(Vec::new()));
    for next in [&lifted, &gone] {
        let data = table();
        let (mut world, body) = asleep_on(&data);
        show(&data, &cameras, next, 1.0);
        step(&mut world, 0.005);
        assert!(world.body(body).is_enabled());
    }
    // The hull moves so far away that its bounding box no longer overlaps that of the body.
    let data = table();
    let (mut world, body) = asleep_on(&data);
    show(&data, &cameras, &Subject::new(vec![cuboid(vector![0.1, 0.1, 0.1], at(0.0, 0.0, -0.14))]), 1.0);
    step(&mut world, 0.005);

    assert!(world.body(body).is_enabled());
}

#[test]
fn a_sleeping_body_stays_asleep_when_equal_silhouettes_are_published() {
    let data = table();
    let (mut world, body) = asleep_on(&data);
    for k in 1..20 {
        show_table(&data, f64::from(k));
        step(&mut world, 0.005);
    }
    assert!(!world.body(body).is_enabled());
}

#[test]
fn a_ray_hits_the_hull_as_it_hits_the_box() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let root = world.root_space();

    let table = world.add_geom(root, &Shape::Box { sides: TABLE }).unwrap();
    let ray = world.add_geom(root, &Shape::Ray { length: 2.0 }).unwrap();

    let rays = [
        (point![0.1, 0.05, 1.0], vector![0.0, 0.0, -1.0]),
        (point![1.0, 0.05, 0.1], vector![-1.0, 0.1, -0.05]),
        (point![-0.3, -0.9, 0.5], vector![0.3, 0.8, -0.4]),
        (point![0.0, 0.1, 0.1], vector![0.1, 0.0, 1.0]),
        (point![1.0, 1.0, 1.0], vector![1.0, 0.0, 0.0]),
    ];
    for (origin, direction) in rays {
        world.geom_mut(ray).set_ray(&origin, &direction).unwrap();
        for ray_is_first in [false, true] {
            let hits = |world: &mut World, geom| {
                let (a, b) = if ray_is_first { (ray, geom) } else { (geom, ray) };
                world.collide_geoms(a, b, 4).unwrap()
            };

            let (on_hull, on_box) = (hits(&mut world, hull), hits(&mut world, table));
            assert_eq!(on_hull.len(), on_box.len(), "from {origin} along {direction}");
            for (a, b) in on_hull.iter().zip(&on_box) {
                assert!((a.depth - b.depth).abs() < 0.5 * PIXEL, "{} {}", a.depth, b.depth);
                assert!(a.normal.angle(&b.normal) < 0.05, "{} {}", a.normal, b.normal);
                assert!((a.position - b.position).norm() < 0.5 * PIXEL);
            }
        }
    }
    // From inside, a ray that culls back faces hits nothing.
    world.geom_mut(ray).set_ray(&point![0.0, 0.1, 0.1], &Vector3::z()).unwrap();
    world.geom_mut(ray).set_ray_flags(RayFlags { backface_cull: true, ..RayFlags::default() }).unwrap();
    assert!(world.collide_geoms(hull, ray, 1).unwrap().is_empty());
}

#[test]
fn a_ray_along_a_line_of_sight_hits_the_hull_at_the_same_point_wherever_it_begins() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let root = world.root_space();
    let ray = world.add_geom(root, &Shape::Ray { length: 5.0 }).unwrap();

    let (mut random, mut hits) = (Random(1), 0);
    for camera in table_cameras() {
        for _ in 0..300 {
            // Among the middle pixels, most of which show the table.
            let (u, v) = (random.between(180.0, 460.0), random.between(120.0, 360.0));
            let sight = camera.ray(u, v).unwrap();
            let mut hit_from = |start: f64| {
                world.geom_mut(ray).set_ray(&sight.at(start), &sight.direction).unwrap();
                world.collide_geoms(hull, ray, 1).unwrap().first().map(|contact| contact.position)
            };

            // The camera sees the table from about 3 m.
            let from_camera = hit_from(0.0);
            hits += usize::from(from_camera.is_some());
            for start in [-0.5, 0.3, 0.7, 1.1, 1.7] {
                let found = hit_from(start);
                // Only the rounding of the start and of the crossing differs.
                let is_same = match (found, from_camera) {
                    (Some(found), Some(expected)) => (found - expected).norm() < 1e-9,
                    (found, expected) => found == expected,
                };
                assert!(
                    is_same,
                    "{} ({u}, {v}) from {start} m: {found:?}, not {from_camera:?}",
                    camera.name()
                );
            }
        }
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn two_hulls_collide_with_a_body_between_them_and_not_with_each_other() {
    let (mut world, lower) = with_table(SpaceKind::default());
    let root = world.root_space();
    let upper = world.add_hull(root, &table()).unwrap();

    let flip =
        at(0.0, 0.0, 2.0 * TOP + 0.195) * UnitQuaternion::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
    world.geom_mut(upper).set_pose(&flip).unwrap();

    let (_, cube) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.0975));

    assert!(world.collide_geoms(lower, upper, 8).unwrap().is_empty());
    let down = world.collide_geoms(lower, cube, 8).unwrap();
    let up = world.collide_geoms(upper, cube, 8).unwrap();
    assert!(!down.is_empty() && down.iter().all(|contact| contact.normal.z < -0.99));
    assert!(!up.is_empty() && up.iter().all(|contact| contact.normal.z > 0.99));
}

#[test]
fn data_outlives_its_last_handle_while_a_geom_is_bound_to_it() {
    let data = table();
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    let hull = world.add_hull(root, &data).unwrap();
    drop(data);
    assert_eq!(cube_contacts(&mut world, hull, 8).len(), 8);
}

#[test]
fn a_geom_bound_to_other_data_collides_with_that() {
    let (mut world, hull) = with_table(SpaceKind::default());
    assert_eq!(cube_contacts(&mut world, hull, 8).len(), 8);
    let empty = data_with(&table_cameras());
    world.hull_mut(hull).set_data(&empty);
    assert!(cube_contacts(&mut world, hull, 8).is_empty(), "no frame was published yet");
}

#[test]
fn samples_set_by_the_user_replace_those_of_the_shape() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let (_, cube) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.096));
    let middle = sample::from_points(&[point![0.0, 0.0, -0.1]], None).unwrap();
    world.set_samples(cube, middle).unwrap();
    let found = world.collide_geoms(hull, cube, 8).unwrap();
    assert_eq!(found.len(), 1);
    assert!((found[0].position - point![0.0, 0.0, TOP - 0.004]).norm() < 1e-9);
    world.clear_samples(cube).unwrap();
    assert_eq!(world.collide_geoms(hull, cube, 8).unwrap().len(), 8);
}

#[test]
fn a_body_too_large_to_sample_is_reported_and_does_not_collide() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let (_, huge) = add_body(&mut world, &cube(90.0), &at(0.0, 0.0, 0.0));
    assert!(world.hull(hull).take_error().is_none());
    assert!(world.collide_geoms(hull, huge, 8).unwrap().is_empty());
    let error = world.hull(hull).take_error().expect("an error").to_string();
    assert!(error.contains("min_feature"), "{error}");
    assert!(world.hull(hull).take_error().is_none(), "reported once");
}

#[test]
fn all_modes_make_contacts_and_can_be_read_back() {
    let (mut world, hull) = with_table(SpaceKind::default());
    for mode in [Mode::Paper, Mode::Point, Mode::Single, Mode::Clustered] {
        world.hull_mut(hull).set_mode(mode);
        assert_eq!(world.hull(hull).settings().mode, mode);
        let most = if mode == Mode::Single { 1 } else { 8 };
        assert_eq!(cube_contacts(&mut world, hull, 8).len(), most, "{mode:?}");
    }
}

#[test]
fn queries_take_and_return_world_coordinates() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let (_, cube) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.096));
    world.collide(|_| ()).unwrap();
    let view = world.hull(hull);
    let w = view.point_response(&point![0.05, 0.0, TOP - 0.01]).expect("inside");
    assert!((w - vector![0.0, 0.0, 0.01]).norm() < 2.0 * PIXEL, "{w}");
    assert_eq!(view.point_response(&point![0.0, 0.0, TOP + 0.01]), None);

    let response = view.body_response(cube).unwrap();
    assert!(response.colliding > 8 && (response.vector.z - 0.004).abs() < PIXEL, "{response:?}");

    assert!(world.get_hull(cube).is_err());
}

#[test]
fn a_hull_tells_by_which_samples_a_geom_collides() {
    let (mut world, hull) = with_table(SpaceKind::default());
    let shape = cube(0.2);
    let (_, geom) = add_body(&mut world, &shape, &at(0.0, 0.0, 2.0));
    let of_class = world.hull(hull).samples(geom).unwrap().unwrap();
    assert_eq!(*of_class, shape.sample(world.hull(hull).min_feature()).unwrap());

    let own = sample::from_points(&[point![0.1, 0.0, 0.0]], None).unwrap();
    world.set_samples(geom, own.clone()).unwrap();
    assert_eq!(*world.hull(hull).samples(geom).unwrap().unwrap(), own);

    world.remove_geom(geom);
    assert!(world.hull(hull).samples(geom).is_err());
}

#[test]
fn a_panic_in_the_closure_leaves_collide_and_the_world_still_works() {
    let (mut world, hull) = with_table(SpaceKind::default());
    add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.096));
    let outcome = catch_unwind(AssertUnwindSafe(|| world.collide(|_| panic!("in the closure"))));
    assert!(outcome.is_err());
    world.default_collide(&Surface::default(), 8).unwrap();
    world.quick_step(0.005).unwrap();
    assert_eq!(cube_contacts(&mut world, hull, 8).len(), 8);
}

#[test]
fn worlds_on_two_threads_share_one_data_object_while_a_third_publishes() {
    let data = table();
    let fall = || {
        let mut world = world(SpaceKind::default());
        let root = world.root_space();
        world.add_hull(root, &data).unwrap();
        let (body, _) = add_body(&mut world, &cube(0.2), &at(0.0, 0.0, TOP + 0.12));
        for _ in 0..200 {
            step(&mut world, 0.005);
        }
        height(&world, body)
    };

    std::thread::scope(|scope| {
        let falls = [scope.spawn(fall), scope.spawn(fall)];
        for k in 1..5 {
            show_table(&data, f64::from(k));
        }
        for fall in falls {
            assert!((fall.join().unwrap() - TOP - 0.1).abs() < 0.003);
        }
    });
}
