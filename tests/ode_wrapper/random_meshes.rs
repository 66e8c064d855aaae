//! Meshes that are no surface of a solid: triangles that fold, cross, coincide, and are tiny beside huge ones.

use super::hostile_pairs::convex;
use super::*;
use nalgebra::{Point3, Translation3, UnitQuaternion};
use ode_visual_hull::ode::TriMesh;
use ode_visual_hull_random::Random;
use std::sync::Arc;

/// Random triangles over a few points, a third of the meshes with every triangle from both sides; `None` where no triangle
/// is left.
fn soup(random: &mut Random) -> Option<Shape> {
    let style = random.below(6_u64);
    let coordinate = |random: &mut Random| match style {
        0 => random.unit() - 0.5,
        1 => 0.5 * f64::from(random.below(3_u32)) - 0.5,
        2 => [0.0, 1e-8, 0.5, -0.5, 1e-3][random.below(5_usize)],
        3 => (random.unit() - 0.5) * 10_f64.powi(random.below(8_i32) - 4),
        4 => [0.0, 1e6, -1e6, 0.1, 1e7][random.below(5_usize)],
        _ => (4.0 * random.unit()).round() * 0.25 - 0.5,
    };
    let count = 3 + random.below(12_u32);
    let mut point = || Point3::new(coordinate(random), coordinate(random), coordinate(random));
    let points: Vec<_> = (0..count).map(|_| point()).collect();
    let mut corner = || random.below(count);
    let mut triangles: Vec<[u32; 3]> = (0..20).map(|_| [corner(), corner(), corner()]).collect();
    triangles.truncate(1 + random.below(20_usize));
    if random.below(3_u32) == 0 {
        triangles.extend_from_within(..);
        let half = triangles.len() / 2;
        triangles[half..].iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }
    TriMesh::new(points, triangles).ok().map(|mesh| Shape::TriMesh(Arc::new(mesh)))
}

fn place(random: &mut Random) -> Isometry3<f64> {
    let rotation = if random.below(3_u32) == 0 { UnitQuaternion::identity() } else { random.rotation() };
    let at = if random.below(6_u32) == 0 { 0.0 } else { 1.0 };
    let at = Vector3::from_fn(|_, _| at * (random.unit() - 0.5));
    Isometry3::from_parts(Translation3::from(at), rotation)
}

/// Collides a mesh with a body of every shape and with another mesh, and steps the world.
fn run(seed: u64) {
    let mut random = Random(seed);
    let mut world = world();
    let root = world.root_space();
    let Some(mesh) = soup(&mut random) else { return };
    let mesh = world.add_geom(root, &mesh).unwrap();

    let mut shapes = vec![
        Shape::Sphere { radius: 0.3 },
        Shape::cuboid(0.3, 0.4, 0.5),
        Shape::Capsule { radius: 0.2, length: 0.3 },
        Shape::Cylinder { radius: 0.2, length: 0.3 },
        Shape::Ray { length: 1.0 },
        convex(Vector3::repeat(0.2)),
    ];
    shapes.extend(soup(&mut random));
    let bodies: Vec<_> = shapes
        .iter()
        .map(|shape| {
            let (body, geom) = (world.add_body(), world.add_geom(root, shape).unwrap());
            world.geom_mut(geom).set_body(Some(body)).unwrap();
            (body, geom)
        })
        .collect();

    for _ in 0..10 {
        for &(body, geom) in &bodies {
            world.body_mut(body).set_pose(&place(&mut random)).unwrap();
            for pair in [[mesh, geom], [geom, mesh]] {
                let most = 1 + random.below(64_usize);
                for contact in world.collide_geoms(pair[0], pair[1], most).unwrap() {
                    let is_unit = (contact.normal.norm() - 1.0).abs() < 1e-3;
                    assert!(is_unit && contact.depth >= 0.0, "seed {seed}: {contact:?}");
                }
            }
        }
        // Bodies may be thrown out of the world, which is an error and no abort.
        let _ = world.default_collide(&Surface::default(), 8);
        let _ = world.quick_step(0.005);
    }
}

#[test]
fn meshes_that_are_no_surfaces_collide_without_an_abort() {
    (0..300).for_each(run);
}
