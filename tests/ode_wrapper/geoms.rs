//! Geoms: shapes, poses, rays, and invalid sizes.

use std::sync::Arc;

use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use ode_visual_hull::ode::{Convex, RayFlags, Shape, TriMesh, World};

use crate::{add, add_ground, run, world};

/// The corners and outward faces of a cube of side 1.
fn cube() -> (Vec<Point3<f64>>, Vec<Vec<u32>>) {
    let sign = |i: u32, bit: u32| if i & bit == 0 { -0.5 } else { 0.5 };
    let points = (0..8).map(|i| Point3::new(sign(i, 1), sign(i, 2), sign(i, 4))).collect();
    let faces: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (points, faces.iter().map(|face| face.to_vec()).collect())
}

fn convex_cube() -> Shape {
    let (points, faces) = cube();
    Shape::Convex(Arc::new(Convex::new(points, &faces).unwrap()))
}

fn mesh_cube() -> Shape {
    let (points, faces) = cube();
    let triangles = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    Shape::TriMesh(Arc::new(TriMesh::new(points, triangles).unwrap()))
}

pub(crate) fn all_shapes() -> Vec<Shape> {
    vec![
        Shape::Sphere { radius: 0.5 },
        Shape::cuboid(1.0, 1.0, 1.0),
        Shape::Capsule { radius: 0.4, length: 0.3 },
        Shape::Cylinder { radius: 0.5, length: 1.0 },
        convex_cube(),
        mesh_cube(),
        Shape::Plane { normal: Vector3::z(), offset: 0.0 },
        Shape::Ray { length: 2.0 },
    ]
}

#[test]
fn every_solid_rests_on_the_ground_at_its_height() {
    for (shape, height) in [
        (Shape::Sphere { radius: 0.5 }, 0.5),
        (Shape::cuboid(1.0, 1.0, 1.0), 0.5),
        (Shape::Cylinder { radius: 0.5, length: 1.0 }, 0.5),
        (convex_cube(), 0.5),
        (mesh_cube(), 0.5),
    ] {
        let mut world = world();
        add_ground(&mut world);
        let (body, _) = add(&mut world, &shape, 1.0, [0.0, 0.0, height + 0.05]);
        run(&mut world, 300, 0.01);
        let z = world.body(body).position().z;
        assert!((z - height).abs() < 2e-3, "{shape:?} at {z}");
    }
}

#[test]
fn every_pair_of_shapes_collides_without_an_abort() {
    // Poses at which the shapes coincide, touch, intersect, and are separate.
    let poses = [
        Isometry3::identity(),
        Isometry3::translation(0.3, 0.2, 0.8),
        Isometry3::new(Vector3::new(0.4, 0.0, 0.1), Vector3::new(0.3, 0.5, 0.7)),
        Isometry3::translation(5.0, 0.0, 0.0),
    ];

    for first in all_shapes() {
        for second in all_shapes() {
            let mut world = world();

            let root = world.root_space();
            let a = world.add_geom(root, &first).unwrap();
            let b = world.add_geom(root, &second).unwrap();

            for pose in &poses {
                if second.is_placeable() {
                    world.geom_mut(b).set_pose(pose).unwrap();
                }
                for max in [1, 4, 100] {
                    let contacts = world.collide_geoms(a, b, max).unwrap();
                    assert!(contacts.len() <= max);
                    for contact in contacts {
                        assert_eq!(contact.geoms, [a, b]);
                        assert!(
                            (contact.normal.norm() - 1.0).abs() < 1e-6,
                            "{first:?} {second:?} {contact:?}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn the_normal_points_into_the_first_geom() {
    let mut world = world();
    let root = world.root_space();
    let low = world.add_geom(root, &Shape::Sphere { radius: 1.0 }).unwrap();
    let high = world.add_geom(root, &Shape::cuboid(1.0, 1.0, 1.0)).unwrap();
    world.geom_mut(high).set_pose(&Isometry3::translation(0.0, 0.0, 1.4)).unwrap();

    let contact = world.collide_geoms(low, high, 4).unwrap()[0];

    assert!(
        (contact.normal + Vector3::z()).norm() < 1e-12 && (contact.depth - 0.1).abs() < 1e-12,
        "{contact:?}"
    );

    let contact = world.collide_geoms(high, low, 4).unwrap()[0];
    assert!(
        (contact.normal - Vector3::z()).norm() < 1e-12 && (contact.depth - 0.1).abs() < 1e-12,
        "{contact:?}"
    );

    assert!(world.collide_geoms(low, high, 0).unwrap().is_empty());
    assert!(world.collide_geoms(low, low, 4).unwrap().is_empty());
}

#[test]
fn a_pose_and_an_offset_come_back_as_they_were_set() {
    let pose = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.1, 0.2, 0.3));
    let offset = Isometry3::new(Vector3::new(-0.1, 0.5, 0.2), Vector3::new(0.4, 0.0, -0.3));
    let near = |a: Isometry3<f64>, b: Isometry3<f64>| {
        (a.translation.vector - b.translation.vector).norm() < 1e-12
            && a.rotation.angle_to(&b.rotation) < 1e-7
    };

    for shape in all_shapes().into_iter().filter(Shape::is_placeable) {
        let mut world = world();
        let geom = world.add_geom(world.root_space(), &shape).unwrap();
        assert!(world.geom_mut(geom).set_offset(&offset).is_err(), "no body");
        world.geom_mut(geom).set_pose(&pose).unwrap();
        assert!(near(world.geom(geom).pose(), pose));
        assert_eq!(
            (world.geom(geom).offset(), world.geom(geom).shape()),
            (Isometry3::identity(), Some(&shape))
        );

        let body = world.add_body();
        world.body_mut(body).set_pose(&pose).unwrap();
        world.geom_mut(geom).set_body(Some(body)).unwrap();
        assert!(world.geom_mut(geom).set_pose(&pose).is_err(), "the body places it");
        world.geom_mut(geom).set_offset(&offset).unwrap();
        assert!(near(world.geom(geom).offset(), offset));
        assert!(near(world.geom(geom).pose(), pose * offset));
        world.geom_mut(geom).clear_offset();
        assert!(near(world.geom(geom).pose(), pose));
        world.geom_mut(geom).set_offset(&offset).unwrap();
        world.geom_mut(geom).set_body(None).unwrap();
        assert!(near(world.geom(geom).pose(), pose * offset), "it stays where it was");
    }
}

#[test]
fn a_plane_has_no_pose_and_no_body() {
    let mut world = world();
    let (plane, body) = (add_ground(&mut world), world.add_body());
    assert!(world.geom_mut(plane).set_pose(&Isometry3::identity()).is_err());
    assert!(world.geom_mut(plane).set_body(Some(body)).is_err());
    assert!(world.geom_mut(plane).set_offset(&Isometry3::identity()).is_err());
    world.geom_mut(plane).clear_offset();
    assert_eq!((world.geom(plane).pose(), world.geom(plane).body()), (Isometry3::identity(), None));
    assert_eq!(world.geom(plane).offset(), Isometry3::identity());
    let higher = Shape::Plane { normal: Vector3::new(0.0, 0.0, 2.0), offset: 1.0 };
    world.geom_mut(plane).set_shape(&higher).unwrap();
    assert_eq!(world.geom(plane).aabb().max.z, 1.0);
}

/// The distances of the hits of a ray from `origin` along `direction` with a geom of this shape.
fn hits(world: &mut World, shape: &Shape, origin: Point3<f64>, direction: Vector3<f64>) -> Vec<f64> {
    let root = world.root_space();
    let (target, ray) =
        (world.add_geom(root, shape).unwrap(), world.add_geom(root, &Shape::Ray { length: 10.0 }));
    let ray = ray.unwrap();
    world.geom_mut(ray).set_ray(&origin, &direction).unwrap();
    world.geom_mut(ray).set_ray_flags(RayFlags { closest_hit: true, ..RayFlags::default() }).unwrap();

    let hits = world.collide_geoms(ray, target, 1).unwrap();
    hits.iter().map(|hit| hit.depth).collect()
}

#[test]
fn a_ray_measures_the_distance_to_a_shape() {
    for direction in [Vector3::z(), -Vector3::z(), Vector3::x(), Vector3::new(0.0, -3.0, 0.0)] {
        for shape in [Shape::Sphere { radius: 0.5 }, Shape::cuboid(1.0, 1.0, 1.0), mesh_cube()] {
            let mut world = world();
            // Aside of the centre, where two triangles of the mesh meet.
            let aside = Vector3::new(1e-4, 2e-4, 3e-4);
            let origin = Point3::origin() - direction.normalize() * 2.0 + aside;
            let hits = hits(&mut world, &shape, origin, direction);
            assert!(hits.len() == 1 && (hits[0] - 1.5).abs() < 1e-3, "{shape:?} {direction:?} {hits:?}");
        }
    }
}

#[test]
fn invalid_rays_and_rays_of_other_shapes_are_refused() {
    let mut world = world();
    let root = world.root_space();
    let ball = world.add_geom(root, &Shape::Sphere { radius: 1.0 }).unwrap();
    let ray = world.add_geom(root, &Shape::Ray { length: 1.0 }).unwrap();
    let origin = Point3::origin();

    assert!(world.geom_mut(ball).set_ray(&origin, &Vector3::x()).is_err());
    assert!(world.geom_mut(ball).set_ray_flags(RayFlags::default()).is_err());
    assert!(world.geom_mut(ray).set_ray(&origin, &Vector3::zeros()).is_err());
    assert!(world.geom_mut(ray).set_ray(&origin, &Vector3::repeat(f64::NAN)).is_err());
    assert!(world.geom_mut(ray).set_ray(&Point3::new(f64::NAN, 0.0, 0.0), &Vector3::x()).is_err());

    let body = world.add_body();
    world.geom_mut(ray).set_body(Some(body)).unwrap();
    assert!(world.geom_mut(ray).set_ray(&origin, &Vector3::x()).is_err());
}

#[test]
fn invalid_sizes_are_refused() {
    let mut world = world();
    let root = world.root_space();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e8] {
        for shape in [
            Shape::Sphere { radius: bad },
            Shape::cuboid(1.0, bad, 1.0),
            Shape::Capsule { radius: bad, length: 1.0 },
            Shape::Capsule { radius: 1.0, length: bad },
            Shape::Cylinder { radius: bad, length: 1.0 },
            Shape::Cylinder { radius: 1.0, length: bad },
            Shape::Ray { length: bad },
        ] {
            assert!(world.add_geom(root, &shape).is_err(), "{shape:?}");
        }
    }

    assert!(world.add_geom(root, &Shape::Plane { normal: Vector3::zeros(), offset: 0.0 }).is_err());
    assert!(world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: f64::NAN }).is_err());
    assert_eq!(world.geoms().count(), 0);

    let ball = world.add_geom(root, &Shape::Sphere { radius: 1.0 }).unwrap();
    assert!(world.geom_mut(ball).set_shape(&Shape::Sphere { radius: -1.0 }).is_err());
    assert!(world.geom_mut(ball).set_shape(&Shape::cuboid(1.0, 1.0, 1.0)).is_err());
    assert!(world.geom_mut(ball).set_pose(&Isometry3::translation(f64::NAN, 0.0, 0.0)).is_err());

    world.geom_mut(ball).set_shape(&Shape::Sphere { radius: 2.0 }).unwrap();
    assert_eq!(world.geom(ball).aabb().max, Point3::new(2.0, 2.0, 2.0));
}

#[test]
fn a_mesh_is_kept_as_long_as_its_geom() {
    let mut world = world();
    let geom = {
        let shape = mesh_cube();
        world.add_geom(world.root_space(), &shape).unwrap()
    };
    let ball = world.add_geom(world.root_space(), &Shape::Sphere { radius: 0.2 }).unwrap();
    let turn = UnitQuaternion::from_euler_angles(0.0, 0.0, 0.5);
    world.geom_mut(geom).set_pose(&Isometry3::from_parts(Default::default(), turn)).unwrap();
    world.geom_mut(ball).set_pose(&Isometry3::translation(0.0, 0.0, 0.6)).unwrap();
    let contacts = world.collide_geoms(ball, geom, 8).unwrap();
    assert!(!contacts.is_empty() && (contacts[0].depth - 0.1).abs() < 1e-6, "{contacts:?}");
}
