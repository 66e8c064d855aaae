use super::*;
use ode_visual_hull_testing::random::Random;
use std::f64::consts::PI;
use std::sync::Arc;

/// The volume that a closed surface encloses: the sum of the tetrahedra to the origin.
fn volume(mesh: &Mesh) -> f64 {
    let of_triangle = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|corner| mesh.vertices[corner as usize].position.coords.cast::<f64>());
        a.dot(&b.cross(&c)) / 6.0
    };
    mesh.triangles.iter().map(of_triangle).sum()
}

/// Distance of the tetrahedron's three upright faces from its origin.
const INSET: f64 = 0.05;

fn tetrahedron() -> Convex {
    let corner = |x: f64, y: f64, z: f64| Point3::new(x - INSET, y - INSET, z - INSET);
    let points =
        vec![corner(0.0, 0.0, 0.0), corner(0.3, 0.0, 0.0), corner(0.0, 0.3, 0.0), corner(0.0, 0.0, 0.3)];
    Convex::new(points, &[vec![0, 2, 1], vec![0, 1, 3], vec![0, 3, 2], vec![1, 2, 3]]).unwrap()
}

/// Closed shapes and their volumes.
fn closed() -> Vec<(Shape, f64)> {
    let (radius, length) = (0.2_f64, 0.3);
    let (ball, tube) = (4.0 / 3.0 * PI * radius.powi(3), PI * radius * radius * length);
    let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mesh = TriMesh::new(tetrahedron().points().to_vec(), triangles).unwrap();
    vec![
        (Shape::cuboid(0.1, 0.2, 0.4), 0.008),
        (Shape::Sphere { radius }, ball),
        (Shape::Capsule { radius, length }, ball + tube),
        (Shape::Cylinder { radius, length }, tube),
        (Shape::Convex(Arc::new(tetrahedron())), 0.0045),
        (Shape::TriMesh(Arc::new(mesh)), 0.0045),
    ]
}

#[test]
fn triangles_enclose_the_volume_of_their_shape_and_face_outwards() {
    for (shape, expected) in closed() {
        // Round bodies are polyhedra of 64 meridians: 0.5 % less.
        let found = volume(&Mesh::of(&shape));
        assert!((0.99..1.0001).contains(&(found / expected)), "{shape:?}: {found}, {expected}");
    }
}

#[test]
fn normals_are_of_unit_length_and_point_out_of_their_triangles() {
    for (shape, _) in closed() {
        let mesh = Mesh::of(&shape);
        for triangle in &mesh.triangles {
            let corners = triangle.map(|corner| mesh.vertices[corner as usize]);
            let [a, b, c] = corners.map(|corner| corner.position);
            let Some(normal) = (b - a).cross(&(c - a)).try_normalize(1e-9) else { continue };
            for corner in corners {
                assert!((corner.normal.norm() - 1.0).abs() < 1e-5, "{shape:?}");
                assert!(corner.normal.dot(&normal) > 0.9, "{shape:?}: {corner:?}, {normal:?}");
            }
        }
    }
}

#[test]
fn a_point_is_inside_a_mesh_where_it_is_inside_the_shape() {
    let mut random = Random(5);
    let half = Vector3::new(0.05, 0.1, 0.2);
    type IsInside<'i> = &'i dyn Fn(&Point3<f64>) -> bool;
    let inside: [(Shape, IsInside); 3] = [
        (Shape::Box { sides: 2.0 * half }, &|p| (0..3).all(|axis| p[axis].abs() < half[axis])),
        // A polyhedron is a little smaller than its ball.
        (Shape::Sphere { radius: 0.2 }, &|p| p.coords.norm() < 0.2),
        (Shape::Convex(Arc::new(tetrahedron())), &|p| {
            p.coords.min() > -INSET && p.coords.sum() < 0.3 - 3.0 * INSET
        }),
    ];
    for (shape, expected) in inside {
        let mesh = Mesh::of(&shape);
        let mut differ = 0;
        for _ in 0..2000 {
            let point = random.point(Point3::new(-0.3, -0.3, -0.3), Point3::new(0.3, 0.3, 0.3));
            differ += usize::from(mesh.contains(&point.cast()) != expected(&point));
        }
        assert!(differ < 10, "{shape:?}: {differ} of 2000");
    }
}

#[test]
fn ground_faces_upwards_a_plane_along_its_normal_and_a_ray_has_no_surface() {
    let field = Heightfield::new(vec![0.0, 0.1, 0.2, 0.0, 0.3, 0.1], [3, 2], [1.0, 2.0]).unwrap();
    let ground = Mesh::of(&Shape::Heightfield(Arc::new(field)));
    assert_eq!(ground.triangles.len(), 4);
    assert!(ground.vertices.iter().all(|vertex| vertex.normal.y > 0.5));

    let normal = Vector3::new(1.0, 2.0, -2.0);
    let plane = Mesh::of(&Shape::Plane { normal, offset: 0.6 });
    for vertex in &plane.vertices {
        assert!((vertex.normal - normal.normalize().cast()).norm() < 1e-6);
        let height = normal.normalize().dot(&vertex.position.coords.cast());
        assert!((height - 0.6).abs() < 1e-5, "the offset is along the unit normal: {height}");
    }
    assert_eq!(Mesh::of(&Shape::Ray { length: 1.0 }), Mesh::default());
}
