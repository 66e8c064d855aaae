//! Heightfields: bodies rest on them, rays hit them, and neither sizes nor poses make ODE abort.

use std::sync::Arc;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{Amount, GeomId, Heightfield, Mass, Shape, Surface, World};
use ode_visual_hull_random::Random;
use ode_visual_hull_testing::scene::table;

use crate::geom_with_space::SPACE_KINDS;
use crate::geoms::all_shapes;
use crate::{add, add_ground, run, world};

/// The heights of `columns` x `rows` samples over `size`, at the coordinates x and z of each.
fn field(counts: [usize; 2], size: [f64; 2], height: impl Fn(f64, f64) -> f64) -> Heightfield {
    let [columns, rows] = counts;
    let along = |i: usize, count: usize, size: f64| (i as f64 / (count - 1) as f64 - 0.5) * size;
    let heights = (0..rows * columns)
        .map(|i| height(along(i % columns, columns, size[0]), along(i / columns, rows, size[1])))
        .collect();
    Heightfield::new(heights, counts, size).unwrap()
}

/// Adds a heightfield to the root space, with z up.
fn add_field(world: &mut World, field: Heightfield) -> GeomId {
    let ground = world.add_geom(world.root_space(), &Shape::Heightfield(Arc::new(field))).unwrap();
    let z_up = Isometry3::from_parts(Default::default(), Heightfield::z_up());
    world.geom_mut(ground).set_pose(&z_up).unwrap();
    ground
}

#[test]
fn a_ball_and_a_box_rest_on_level_ground_at_its_height() {
    let mut world = world();
    add_field(&mut world, field([9, 7], [4.0, 3.0], |_, _| 0.3).with_thickness(1.0).unwrap());
    let (ball, _) = add(&mut world, &Shape::Sphere { radius: 0.2 }, 1.0, [0.6, 0.3, 0.55]);
    let (cube, _) = add(&mut world, &Shape::cube(0.4), 1.0, [-0.7, -0.4, 0.55]);

    run(&mut world, 300, 0.01);

    // Contacts are soft: with ODE's default ERP and CFM a body sinks in by less than a tenth of a millimetre.
    for body in [ball, cube] {
        let z = world.body(body).position().z;
        assert!((z - 0.5).abs() < 1e-3, "{body:?} at {z}");
    }
}

#[test]
fn a_box_rests_on_a_ramp_and_parallel_to_it() {
    let slope: f64 = 0.2;
    let mut world = world();
    add_field(&mut world, field([9, 9], [8.0, 8.0], |x, _| slope * x).with_thickness(1.0).unwrap());
    let turn = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), -slope.atan());
    let normal = turn * Vector3::z();

    // A flat box, so that it does not tip over, a centimetre above the ramp.
    let slab = Shape::cuboid(0.6, 0.6, 0.2);
    let (body, _) = add(&mut world, &slab, 1.0, [0.0; 3]);
    world.body_mut(body).set_pose(&Isometry3::from_parts((0.11 * normal).into(), turn)).unwrap();
    let rough = Surface { mu: f64::INFINITY, ..Surface::default() };
    for _ in 0..300 {
        world.default_collide(&rough, 8).unwrap();
        world.step(0.01).unwrap();
    }

    let pose = world.body(body).pose();
    let height = normal.dot(&pose.translation.vector);
    assert!((height - 0.1).abs() < 1e-3, "{height} m above the ramp");
    assert!(pose.rotation.angle_to(&turn) < 1e-2, "{pose}");
}

#[test]
fn the_contact_of_a_ball_with_a_ramp_is_that_with_its_plane() {
    let (slope_x, slope_z, radius) = (0.3, -0.2, 0.2);
    let mut world = world();
    let ground = add_field(&mut world, field([5, 5], [4.0, 4.0], |x, z| slope_x * x + slope_z * z));
    // With z up, z of the field is -y of the world.
    let normal = Vector3::new(-slope_x, slope_z, 1.0).normalize();
    let ball = world.add_geom(world.root_space(), &Shape::Sphere { radius }).unwrap();
    let at = Vector3::new(0.3, 0.2, slope_x * 0.3 - slope_z * 0.2) + (radius - 0.01) * normal;
    world.geom_mut(ball).set_pose(&Isometry3::from_parts(at.into(), UnitQuaternion::identity())).unwrap();

    let contacts = world.collide_geoms(ball, ground, 8).unwrap();

    let [contact] = contacts[..] else { panic!("{contacts:?}") };
    assert!((contact.depth - 0.01).abs() < 1e-12, "{contact:?}");
    assert!((contact.normal - normal).norm() < 1e-12, "{contact:?}");
    assert_eq!(contact.geoms, [ball, ground]);
}

#[test]
fn a_ray_from_above_hits_the_interpolated_height() {
    let mut random = Random(1);
    let mut world = world();
    let (counts, size) = ([7, 5], [3.0, 4.0]);
    let heights: Vec<f64> = (0..35).map(|_| random.between(-0.5, 0.5)).collect();
    let ground = add_field(&mut world, Heightfield::new(heights.clone(), counts, size).unwrap());
    let ray = world.add_geom(world.root_space(), &Shape::Ray { length: 10.0 }).unwrap();

    for _ in 0..1000 {
        // A point in a cell, as parts of its width and depth, and the height in the triangle around it.
        let (column, row) = (random.below(6usize), random.below(4usize));
        let (a, b) = (random.between(0.01, 0.99), random.between(0.01, 0.99));
        let sample = |i: usize, j: usize| heights[(row + j) * 7 + column + i];
        let expected = if a + b <= 1.0 {
            sample(0, 0) + a * (sample(1, 0) - sample(0, 0)) + b * (sample(0, 1) - sample(0, 0))
        } else {
            sample(1, 1)
                + (1.0 - a) * (sample(0, 1) - sample(1, 1))
                + (1.0 - b) * (sample(1, 0) - sample(1, 1))
        };
        let x = (column as f64 + a) * 0.5 - 1.5;
        let y = 2.0 - (row as f64 + b);

        world.geom_mut(ray).set_ray(&Point3::new(x, y, 5.0), &-Vector3::z()).unwrap();
        let hits = world.collide_geoms(ray, ground, 8).unwrap();

        let [hit] = hits[..] else { panic!("{hits:?} at {x} {y}") };
        assert!((hit.position - Point3::new(x, y, expected)).norm() < 1e-9, "{hit:?}, expected {expected}");
        assert!((hit.depth - (5.0 - expected)).abs() < 1e-9 && hit.normal.z > 0.0, "{hit:?}");
    }
}

#[test]
fn a_ray_below_the_ground_or_beyond_its_border_hits_nothing() {
    let mut world = world();
    for ground in [field([3, 3], [2.0, 2.0], |_, _| 0.0), field([3, 3], [2.0, 2.0], |x, _| 0.1 * x)] {
        let ground = add_field(&mut world, ground);
        let ray = world.add_geom(world.root_space(), &Shape::Ray { length: 2.0 }).unwrap();
        let mut hits = |origin: [f64; 3], direction: Vector3<f64>| {
            world.geom_mut(ray).set_ray(&origin.into(), &direction).unwrap();
            world.collide_geoms(ray, ground, 8).unwrap().len()
        };

        assert_eq!(hits([0.3, 0.2, -3.0], Vector3::z()), 0);
        assert_eq!(hits([0.3, 0.2, -1.0], Vector3::x()), 0);
        assert_eq!(hits([0.3, 0.2, -1.0], -Vector3::z()), 0);
        // From above the field to a point of its plane beyond the border.
        assert_eq!(hits([0.8, 0.2, 0.5], Vector3::new(1.0, 0.0, -1.0)), 0);
        assert_eq!(hits([0.8, 0.2, 0.1], Vector3::new(1.0, 0.0, -1.0)), 1);
        assert_eq!(hits([0.3, 0.2, -1.0], Vector3::z()), 1);
    }
}

#[test]
fn a_repeated_field_has_the_same_height_in_each_period() {
    let mut world = world();
    let ground = field([5, 5], [4.0, 4.0], |x, _| if x.abs() < 1.5 { 0.2 } else { 0.0 });
    let ground = add_field(&mut world, ground.wrapped());
    let ray = world.add_geom(world.root_space(), &Shape::Ray { length: 10.0 }).unwrap();
    for period in [-1000.0, 0.0, 1.0, 250.0] {
        for (x, height) in [(0.3, 0.2), (-2.0 + 1e-3, 2e-4)] {
            world.geom_mut(ray).set_ray(&Point3::new(x + 4.0 * period, 0.1, 5.0), &-Vector3::z()).unwrap();
            let hits = world.collide_geoms(ray, ground, 8).unwrap();
            assert!(hits.len() == 1 && (hits[0].position.z - height).abs() < 1e-9, "{period} {x} {hits:?}");
        }
    }
}

#[test]
fn a_ball_below_the_ground_is_pushed_up_within_its_thickness() {
    for (z, expected) in [(-0.5, 1), (-1.1, 1), (-1.3, 0)] {
        let mut world = world();
        let ground =
            add_field(&mut world, field([5, 5], [4.0, 4.0], |_, _| 0.0).with_thickness(1.0).unwrap());
        let (_, ball) = add(&mut world, &Shape::Sphere { radius: 0.2 }, 1.0, [0.1, 0.1, z]);
        let mut normals = Vec::new();
        world
            .collide(|pair| {
                // The normal points into the first geom.
                let sign = if pair.geoms() == [ball, ground] { 1.0 } else { -1.0 };
                normals.extend(pair.contacts(4).iter().map(|contact| sign * contact.normal.z));
            })
            .unwrap();
        assert_eq!(normals.len(), expected, "at {z}");
        assert!(normals.iter().all(|&up| up > 0.999), "at {z}: {normals:?}");
    }
}

#[test]
fn a_box_may_touch_the_border_of_a_field_of_any_width() {
    // At one width in eight ODE would abort: roundoff puts the box into the cell beyond the last one.
    for samples in 2..60 {
        for tenths in 1..40 {
            let width = f64::from(tenths) * 0.1;
            let mut world = world();
            let ground = add_field(&mut world, field([samples, 2], [width, 1.0], |x, _| 0.1 * x));
            let cube = world.add_geom(world.root_space(), &Shape::cube(1.0)).unwrap();
            for x in [0.5 * width + 0.5, -0.5 * width - 0.5] {
                for x in [x.next_down(), x, x.next_up()] {
                    world.geom_mut(cube).set_pose(&Isometry3::translation(x, 0.0, 0.0)).unwrap();
                    world.collide_geoms(cube, ground, 8).unwrap();
                }
            }
        }
    }
}

#[test]
fn planes_visual_hulls_and_other_heightfields_have_no_contacts_with_a_heightfield() {
    let mut world = world();
    let ground = add_field(&mut world, field([3, 3], [2.0, 2.0], |x, _| x));
    let other = add_field(&mut world, field([3, 3], [2.0, 2.0], |_, z| z));
    let plane = add_ground(&mut world);
    let hull = world.add_hull(world.root_space(), &table()).unwrap();
    world.collide(|pair| assert!(!pair.touches(), "{pair:?}")).unwrap();
    for geom in [other, plane, hull] {
        assert_eq!(world.collide_geoms(ground, geom, 8).unwrap(), []);
        assert_eq!(world.collide_geoms(geom, ground, 8).unwrap(), []);
    }
}

#[test]
fn a_geom_over_too_many_cells_is_an_error_and_all_other_pairs_are_visited() {
    let mut world = world();
    let ground = add_field(&mut world, field([101, 101], [10.0, 10.0], |x, z| 0.1 * (x * z).sin()));
    let (_, large) = add(&mut world, &Shape::cuboid(10.0, 10.0, 1.0), 1.0, [0.0; 3]);
    let (_, small) = add(&mut world, &Shape::cube(1.0), 1.0, [0.0; 3]);

    let mut pairs = Vec::new();
    let message = world.collide(|pair| pairs.push(pair.geoms())).unwrap_err().to_string();

    assert!(message.contains("expected at most 4096 cells of the grid"), "{message}");
    assert_eq!(pairs.len(), 2);
    assert!(pairs.iter().all(|pair| pair.contains(&small)));
    assert!(world.collide_geoms(large, ground, 8).is_err() && world.collide_geoms(ground, large, 8).is_err());

    // An endless field has no border, and cells that ODE could not number.
    let endless = add_field(&mut world, field([3, 3], [1e-3, 1e-3], |_, _| 0.0).wrapped());
    let far = world.add_geom(world.root_space(), &Shape::Sphere { radius: 1e-3 }).unwrap();
    world.geom_mut(far).set_pose(&Isometry3::translation(9e6, 0.0, 0.0)).unwrap();
    assert!(world.collide_geoms(far, endless, 8).unwrap_err().to_string().contains("cells of the grid"));
}

#[test]
fn a_heightfield_has_no_mass_and_no_new_sizes() {
    let mut world = world();
    let ground = add_field(&mut world, field([2, 2], [1.0, 1.0], |_, _| 0.0));
    let shape = world.geom(ground).shape().unwrap().clone();
    let message = Mass::of(&shape, Amount::Total(1.0)).unwrap_err().to_string();
    assert!(message.contains("expected a solid, found Heightfield"), "{message}");
    let message = world.geom_mut(ground).set_shape(&shape).unwrap_err().to_string();
    assert!(message.contains("remove the geom and add another"), "{message}");
}

/// A number whose logarithm is uniformly distributed.
fn any_size(random: &mut Random, low: f64, high: f64) -> f64 {
    random.between(low.ln(), high.ln()).exp()
}

/// A field of any size that is accepted, with up to 9 x 9 random heights, some of them equal.
fn random_field(random: &mut Random) -> Heightfield {
    let counts = [2 + random.below(8usize), 2 + random.below(8usize)];
    let heights = (0..counts[0] * counts[1])
        .map(|_| if random.unit() < 0.3 { 0.0 } else { random.between(-1.0, 1.0) })
        .collect();
    let extreme = random.unit() < 0.2;
    let [low, high] = if extreme { [1e-5, 1e7] } else { [0.01, 100.0] };
    let size = [any_size(random, low, high), any_size(random, low, high)];
    let scale = any_size(random, low, 0.4 * high);
    let field = Heightfield::new(heights, counts, size).unwrap();
    let field = field.scaled(scale, scale * random.between(-1.0, 1.0)).unwrap();
    let field = field.with_thickness(scale * random.unit()).unwrap();
    if random.unit() < 0.3 { field.wrapped() } else { field }
}

/// Solids of random sizes, from a millimetre to a hundred metres.
fn random_solids(random: &mut Random) -> [Shape; 4] {
    let mut size = || any_size(random, 1e-3, 100.0);
    [
        Shape::Sphere { radius: size() },
        Shape::cuboid(size(), size(), size()),
        Shape::Capsule { radius: size(), length: size() },
        Shape::Cylinder { radius: size(), length: size() },
    ]
}

/// A pose within `reach` of the origin along each axis.
fn random_pose(random: &mut Random, reach: Vector3<f64>) -> Isometry3<f64> {
    let at = random.point(Point3::from(-reach), Point3::from(reach));
    let turn = if random.unit() < 0.3 { UnitQuaternion::identity() } else { random.rotation() };
    Isometry3::from_parts(at.into(), turn)
}

/// Collides two geoms in both orders, and checks that all contacts are valid. Returns their number.
fn check_contacts(world: &mut World, pair: [GeomId; 2], seed: u64) -> usize {
    let mut count = 0;
    for max in [1, 7, 100] {
        for [first, second] in [pair, [pair[1], pair[0]]] {
            // A geom over too many cells is an error.
            let Ok(contacts) = world.collide_geoms(first, second, max) else { continue };
            assert!(contacts.len() <= max, "seed {seed}");
            for contact in &contacts {
                let length = contact.normal.norm();
                let shape = world.geom(pair[0]).shape();
                assert!((length - 1.0).abs() < 1e-6, "seed {seed} {shape:?} {contact:?}");
                assert!(contact.depth >= 0.0, "seed {seed} {shape:?} {contact:?}");
            }
            count += contacts.len();
        }
    }
    count
}

#[test]
fn random_shapes_at_random_poses_collide_with_random_heights_without_an_abort() {
    let mut contacts = 0;
    for seed in 0..100 {
        let mut random = Random(seed);
        let kind = SPACE_KINDS[random.below(SPACE_KINDS.len())];
        let mut world = World::with_space(world().ode(), kind).unwrap();
        let root = world.root_space();
        let field = random_field(&mut random);
        let highest = field.heights().iter().fold(0.0, |most: f64, height| most.max(height.abs()));
        let near = Vector3::new(0.6 * field.size()[0], highest, 0.6 * field.size()[1]);
        let ground = world.add_geom(root, &Shape::Heightfield(Arc::new(field))).unwrap();
        let anywhere = Vector3::repeat(any_size(&mut random, 1e-3, 1e7));
        let ground_pose = random_pose(&mut random, 0.1 * anywhere);
        world.geom_mut(ground).set_pose(&ground_pose).unwrap();

        let mut shapes = all_shapes();
        shapes.extend(random_solids(&mut random));
        for shape in &shapes {
            let geom = world.add_geom(root, shape).unwrap();
            if shape.is_placeable() {
                let body = world.add_body();
                world.geom_mut(geom).set_body(Some(body)).unwrap();
                // Half of them at the field, where they do not leave the world.
                let mut pose = ground_pose * random_pose(&mut random, near);
                if random.unit() < 0.5 || pose.translation.vector.amax() > 1e7 {
                    pose = random_pose(&mut random, anywhere);
                }
                world.body_mut(body).set_pose(&pose).unwrap();
            }
            contacts += check_contacts(&mut world, [geom, ground], seed);
        }

        // Bodies with random contacts may be thrown out of the world, which is an error and no abort.
        for _ in 0..3 {
            let _ = world.default_collide(&Surface::default(), 8);
            let _ = world.quick_step(0.01);
        }
    }
    assert!(contacts > 1000, "{contacts} contacts");
}
