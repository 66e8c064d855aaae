//! Bodies without a size, without samples, or with too many samples.

use super::*;

#[test]
fn bodies_without_a_valid_size_are_refused() {
    with_table_kept(|data| {
        let (mut world, body) = drop_box_on(data);
        let root = world.root_space();
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            let found = format!("found {size}");
            let (radius, length) = (size, 1.0);

            for shape in [
                Shape::Sphere { radius },
                Shape::cuboid(1.0, size, 1.0),
                Shape::Capsule { radius, length },
                Shape::Cylinder { radius: 1.0, length: size },
            ] {
                assert_says(world.add_geom(root, &shape), &["expected a length from", &found]);
            }
            for shape in [
                Shape::Sphere { radius },
                Shape::cuboid(1.0, 1.0, size),
                Shape::Capsule { radius, length },
                Shape::Cylinder { radius, length },
            ] {
                assert!(matches!(shape.sample(0.03), Err(Error::Argument(_))), "{shape:?}");
            }
            assert!(Shape::Sphere { radius: 1.0 }.sample(size.min(0.0)).is_err());
        }

        for _ in 0..20 {
            step(&mut world, 0.005);
            assert_finite(&world, body);
        }
    });
}

#[test]
fn raw_geoms_without_a_size_have_no_contacts_and_are_reported() {
    let data = table();
    let mut world = world(SpaceKind::default());
    let root = world.root_space();
    let hull = world.add_hull(root, &data).unwrap();
    world.collide(|_| ()).unwrap();

    // SAFETY: ODE is open, the geoms are destroyed here and in no space, and the buffer holds the four contacts.
    unsafe {
        let none = std::ptr::null_mut();
        for flat in [dCreateSphere(none, 0.0), dCreateBox(none, 0.0, 0.1, 0.1)] {
            let mut contacts = [dContactGeom::default(); 4];
            let skip = size_of::<dContactGeom>() as i32;
            let found = dCollide(world.geom(hull).raw(), flat, 4, contacts.as_mut_ptr(), skip);
            dGeomDestroy(flat);
            assert_eq!(found, 0);
            assert_says(world.hull(hull).take_error().map_or(Ok(()), Err), &["above 0"]);
        }
    }
}

#[test]
fn a_body_without_samples_is_refused() {
    assert_says(sample::from_points(&[], None), &["0 surface samples", "give 1 to"]);
    let unit = [point![-1.0, -1.0, -1.0], point![1.0, 1.0, 1.0]];
    assert_says(sample::implicit(|_| 1.0, unit, 0.1), &["no surface found", "check the bounds"]);
    assert_says(sample::implicit(|_| f64::NAN, unit, 0.1), &["no surface found"]);
    assert_says(sample::implicit(|_| -1.0, unit, 0.1), &["leaves the bounds", "widen"]);
    assert_says(sample::implicit(|p| p.x, [unit[1], unit[0]], 0.1), &["bounds are empty"]);
    let nan = [point![0.0, f64::NAN, 0.0]];
    assert_says(sample::from_points(&nan, None), &["surface sample 0", "NaN", "finite"]);
}

#[test]
fn a_degenerate_mesh_is_refused() {
    let line = [point![0.0, 0.0, 0.0], point![1.0, 0.0, 0.0], point![2.0, 0.0, 0.0]];
    assert_says(
        TriMesh::new(line.to_vec(), vec![[0, 1, 2], [1, 1, 1]]),
        &["triangle with an area", "none among 2"],
    );
    assert_says(TriMesh::new(Vec::new(), Vec::new()), &["triangle with an area"]);
    assert_says(TriMesh::new(line.to_vec(), vec![[0, 1, 3]]), &["triangle 0", "below 3", "found 3"]);
    assert_says(sample::trimesh(&[line], 0.03), &["mesh of 1 triangles", "no area", "different corners"]);
    assert_says(sample::trimesh(&[], 0.03), &["mesh of 0 triangles", "no area"]);
    assert_says(sample::convex(&line, 0.03), &["convex"]);

    // A good triangle beside bad ones collides.
    let data = table();
    let (mut world, _) = drop_box_on(&data);
    let points =
        vec![point![-0.1, -0.1, 0.0], point![0.1, -0.1, 0.0], point![0.0, 0.1, 0.0], point![0.0, -0.1, 0.0]];
    let mesh = TriMesh::new(points, vec![[0, 3, 1], [2, 1, 0], [2, 2, 2]]).unwrap();
    let root = world.root_space();

    let hull = world.geoms().find(|&geom| world.get_hull(geom).is_ok()).unwrap();
    let plate = world.add_geom(root, &Shape::TriMesh(Arc::new(mesh))).unwrap();
    world.geom_mut(plate).set_pose(&at(0.0, 0.0, TOP - 0.004)).unwrap();
    let contacts = world.collide_geoms(hull, plate, 8).unwrap();

    assert!(!contacts.is_empty() && contacts.iter().all(|contact| contact.normal.z < -0.99));
}

#[test]
fn a_body_too_large_for_its_samples_leaves_the_others_alone() {
    with_table_kept(|data| {
        let (mut world, body) = drop_box_on(data);
        let hull = world.geoms().find(|&geom| world.get_hull(geom).is_ok()).unwrap();
        assert_says(world.hull_mut(hull).set_max_contacts(0), &["max_contacts", "at least 1"]);
        assert_says(world.hull_mut(hull).set_max_depth(f64::NAN), &["max_depth", "found NaN"]);
        assert_says(world.hull_mut(hull).set_min_feature(0.0), &["min_feature", "found 0"]);
        world.hull_mut(hull).set_max_contacts(usize::MAX).unwrap();

        let (huge, geom) = add_body(&mut world, &cube(1e6), &at(0.0, 0.0, 0.0));
        // The huge box collides with the hull alone, since ODE would make contacts between it and the other box.
        world.geom_mut(geom).set_category_bits(2);
        for id in world.geoms().collect::<Vec<_>>() {
            if id != hull && id != geom {
                world.geom_mut(id).set_collide_bits(!2);
            }
        }

        for _ in 0..50 {
            step(&mut world, 0.005);
            assert_finite(&world, body);
            assert_finite(&world, huge);
        }

        let error = world.hull(hull).take_error().map_or(Ok(()), Err);
        assert_says(error, &["min_feature", "at most 1000000"]);
    });
}
