//! What ODE answers with an abort, an overrun or garbage does not reach it: safe code gets contacts or an error.

use super::*;
use nalgebra::{Point3, Quaternion, Translation3, UnitQuaternion};
use ode_visual_hull::ode::{Convex, MIN_SIZE, REACH, SpaceKind, TriMesh};
use ode_visual_hull_random::Random;
use std::sync::Arc;

/// The corners of a box with half sides `h`, and its six faces.
fn corners(h: Vector3<f64>) -> (Vec<Point3<f64>>, [[u32; 4]; 6]) {
    let corner = |i: u32| Vector3::from_fn(|axis, _| if i >> axis & 1 == 0 { -h[axis] } else { h[axis] });
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    ((0..8).map(|i| corner(i).into()).collect(), faces)
}

pub fn convex(h: Vector3<f64>) -> Shape {
    let (points, faces) = corners(h);
    Shape::Convex(Arc::new(Convex::new(points, &faces.map(|face| face.to_vec())).unwrap()))
}

fn mesh(h: Vector3<f64>) -> Shape {
    let (points, faces) = corners(h);
    let triangles = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    Shape::TriMesh(Arc::new(TriMesh::new(points, triangles).unwrap()))
}

fn triangle() -> Shape {
    let points = vec![Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, -1.0, 0.0), Point3::new(0.0, 1.0, 0.0)];
    Shape::TriMesh(Arc::new(TriMesh::new(points, vec![[0, 1, 2]]).unwrap()))
}

/// All shapes of about half a metre.
fn shapes() -> Vec<Shape> {
    vec![
        Shape::Sphere { radius: 0.5 },
        Shape::cuboid(1.0, 1.0, 1.0),
        Shape::Capsule { radius: 0.3, length: 0.6 },
        Shape::Cylinder { radius: 0.5, length: 1.0 },
        Shape::Plane { normal: Vector3::z(), offset: 0.0 },
        Shape::Ray { length: 1.5 },
        convex(Vector3::repeat(0.5)),
        mesh(Vector3::repeat(0.5)),
        triangle(),
    ]
}

fn place(world: &mut World, geom: GeomId, random: &mut Random) {
    let at = Vector3::from_fn(|_, _| random.between(-1.0, 1.0));
    let pose = Isometry3::from_parts(Translation3::from(at), random.rotation());
    if world.geom(geom).shape().is_some_and(Shape::is_placeable) {
        world.geom_mut(geom).set_pose(&pose).unwrap();
    }
}

/// Calls `check` for each pair of `shapes` in random poses.
fn for_each_pair(shapes: &[Shape], poses: usize, mut check: impl FnMut(&mut World, GeomId, GeomId)) {
    let ode = Ode::init().unwrap();
    let mut random = Random(1);
    for (i, first) in shapes.iter().enumerate() {
        for second in &shapes[i..] {
            let mut world = World::with_space(&ode, SpaceKind::Simple).unwrap();
            let root = world.root_space();
            let [a, b] = [first, second].map(|shape| world.add_geom(root, shape).unwrap());
            for _ in 0..poses {
                place(&mut world, a, &mut random);
                place(&mut world, b, &mut random);
                check(&mut world, a, b);
            }
        }
    }
}

#[test]
fn touches_agrees_with_contacts_for_every_pair_of_shapes() {
    for_each_pair(&shapes(), 200, |world, _, _| {
        world
            .collide(|pair| {
                assert_eq!(pair.touches(), !pair.contacts(8).is_empty(), "{:?}", pair.geom_views())
            })
            .unwrap();
    });
}

#[test]
fn any_number_of_contacts_may_be_asked_for_on_a_small_stack() {
    // ODE would take 5 MB of stack for the contacts of capsules and cylinders with meshes.
    let all_pairs = || {
        for_each_pair(&shapes(), 20, |world, a, b| {
            let few = world.collide_geoms(a, b, 1000).unwrap();
            assert_eq!(world.collide_geoms(a, b, usize::MAX).unwrap(), few);
        });
    };
    std::thread::Builder::new().stack_size(512 << 10).spawn(all_pairs).unwrap().join().unwrap();
}

#[test]
fn a_mesh_of_one_triangle_collides_as_one_of_two_in_the_same_place() {
    let two = {
        let points = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0], [0.0, -1.0]];
        let points = points.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec();
        Shape::TriMesh(Arc::new(TriMesh::new(points, vec![[0, 3, 2], [3, 1, 2]]).unwrap()))
    };
    let ode = Ode::init().unwrap();
    let mut random = Random(2);
    let mut touching = 0;
    for shape in shapes() {
        let mut world = World::new(&ode).unwrap();
        let root = world.root_space();
        let [one, two, other] = [&triangle(), &two, &shape].map(|shape| world.add_geom(root, shape).unwrap());
        for _ in 0..100 {
            place(&mut world, other, &mut random);
            let [first, second] =
                [one, two].map(|mesh| !world.collide_geoms(mesh, other, 8).unwrap().is_empty());
            assert_eq!(first, second, "{shape:?}");
            touching += usize::from(first);
        }
    }
    assert!(touching > 100, "{touching}");
}

#[test]
fn sizes_for_which_ode_aborts_are_refused() {
    let mut world = world();
    let root = world.root_space();
    for (shape, problem) in [
        (
            Shape::Sphere { radius: 1e-12 },
            "radius of the sphere: expected a length from 1e-6 to 1e7 m, found",
        ),
        (Shape::cuboid(1.0, 1e-9, 1e7), "y side of the box"),
        (Shape::cuboid(1e-5, 1.0, 1e5), "differ by a factor of at most 1e7"),
        (Shape::Capsule { radius: 1e-4, length: 5e6 }, "radius and length of the capsule"),
        (Shape::Cylinder { radius: 1e6, length: 1e-3 }, "radius and length of the cylinder"),
        (Shape::Ray { length: 1e-9 }, "length of the ray"),
    ] {
        let message = world.add_geom(root, &shape).unwrap_err().to_string();
        assert!(message.contains(problem), "{message}");
    }

    let (points, faces) = corners(Vector3::repeat(1e-7));
    let message = Convex::new(points, &faces.map(|face| face.to_vec())).unwrap_err().to_string();
    assert!(message.contains("behind each face"), "{message}");
    let sliver = [[0.0, 0.0], [1e6, 0.0], [5e5, 1e-3]].map(|[x, y]| Point3::new(x, y, 0.0));
    let message = TriMesh::new(sliver.to_vec(), vec![[0, 1, 2]]).unwrap_err().to_string();
    assert!(message.contains("at least one triangle with an area"), "{message}");
}

#[test]
fn the_smallest_and_the_largest_shapes_collide_without_an_abort() {
    let mut random = Random(3);
    let size = |random: &mut Random| {
        let exponent = random.between(MIN_SIZE.log10(), REACH.log10());
        10_f64.powf(exponent).clamp(MIN_SIZE, REACH)
    };
    for _ in 0..300 {
        let mut shapes = Vec::new();
        while shapes.len() < 4 {
            let sides = Vector3::from_fn(|_, _| size(&mut random));
            // Sizes that differ by more are refused.
            if sides.max() > 1e6 * sides.min() || sides.min() < 4e-6 {
                continue;
            }
            shapes.push(match random.below(7_u64) {
                0 => Shape::Sphere { radius: sides.x },
                1 => Shape::Box { sides },
                2 => Shape::Capsule { radius: sides.x, length: sides.y },
                3 => Shape::Cylinder { radius: sides.x, length: sides.y },
                4 => Shape::Ray { length: sides.x },
                5 => convex(sides / 2.0),
                _ => mesh(sides / 2.0),
            });
        }
        for_each_pair(&shapes, 2, |world, _, _| {
            let number = |x: f64| assert!(x.is_finite());
            world.collide(|pair| pair.contacts(16).iter().for_each(|contact| number(contact.depth))).unwrap();
        });
    }
}

#[test]
fn a_mass_is_not_turned_by_what_is_no_rotation() {
    let mass = Mass::of(&Shape::cuboid(0.1, 0.2, 0.3), Amount::Total(1.0)).unwrap();
    let mut world = world();
    let body = world.add_body();
    let zero = UnitQuaternion::new_unchecked(Quaternion::new(0.0, 0.0, 0.0, 0.0));
    let long = UnitQuaternion::new_unchecked(Quaternion::new(3.0, 1.0, 0.0, 0.0));
    for bad in [UnitQuaternion::from_euler_angles(f64::NAN, 0.0, 0.0), zero, long] {
        let turned = mass.rotated(&bad);
        for refused in [
            world.body_mut(body).set_mass(&turned).unwrap_err(),
            turned.translated(&Vector3::x()).unwrap_err(),
            turned.combined(&mass).unwrap_err(),
        ] {
            assert!(refused.to_string().contains("a quaternion that is not of unit length"), "{refused}");
        }
        world.quick_step(0.01).unwrap();
    }
    world.body_mut(body).set_mass(&mass.rotated(&UnitQuaternion::from_euler_angles(0.3, 0.2, 0.1))).unwrap();
}
