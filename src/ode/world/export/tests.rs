use super::*;
use crate::hull::HullData;
use crate::ode::{Amount, BodyId, Convex, JointKind, Mass, Ode, Shape, Surface, TriMesh};
use nalgebra::{Isometry3, Point3, Vector3, point};
use std::path::PathBuf;
use std::sync::Arc;

fn world() -> World {
    World::new(&Ode::init().unwrap()).unwrap()
}

fn add_body(world: &mut World, shape: &Shape, height: f64) -> BodyId {
    let (body, root) = (world.add_body(), world.root_space());
    let geom = world.add_geom(root, shape).unwrap();
    world.geom_mut(geom).set_body(Some(body)).unwrap();
    world.body_mut(body).set_pose(&Isometry3::translation(0.0, 0.0, height)).unwrap();
    body
}

fn text(world: &World) -> String {
    String::from_utf8(world.dif().unwrap()).unwrap()
}

/// A path that only this test uses, without a file.
fn fresh_path(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("ode-visual-hull-dif-{}-{name}", std::process::id()));
    let _ = std::fs::remove_file(&path);
    path
}

/// The problem in the [`Error::File`] about `path` that `result` holds.
fn problem(result: Result<()>, path: &Path) -> String {
    match result {
        Err(Error::File { path: named, problem }) if named == path => problem,
        other => panic!("expected a file error about {path:?}, found {other:?}"),
    }
}

/// A tetrahedron as a polyhedron and as a mesh.
fn tetrahedron() -> [Shape; 2] {
    let corners = vec![
        point![-0.2, -0.2, -0.2],
        point![0.8, -0.2, -0.2],
        point![-0.2, 0.8, -0.2],
        point![-0.2, -0.2, 0.8],
    ];
    let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
    let polygons = faces.map(|face: [u32; 3]| face.to_vec());
    let convex = Convex::new(corners.clone(), &polygons).unwrap();
    let mesh = TriMesh::new(corners, faces.to_vec()).unwrap();
    [Shape::Convex(Arc::new(convex)), Shape::TriMesh(Arc::new(mesh))]
}

#[test]
fn the_file_names_every_body_with_its_geoms() {
    let mut world = world();
    let [convex, mesh] = tetrahedron();
    let simple = [
        (Shape::Sphere { radius: 0.25 }, "sphere"),
        (Shape::cuboid(1.0, 2.0, 3.0), "box"),
        (Shape::Capsule { radius: 0.1, length: 0.2 }, "capsule"),
        (Shape::Cylinder { radius: 0.1, length: 0.2 }, "cylinder"),
        (convex, "convex"),
        (mesh, "trimesh"),
    ];

    // The height tells the bodies apart, since ODE writes the last one first.
    for (height, (shape, _)) in simple.iter().enumerate() {
        add_body(&mut world, shape, height as f64);
    }

    let path = fresh_path("names");
    world.export_dif(&path).unwrap();
    let written = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();

    for (index, (_, name)) in simple.iter().rev().enumerate() {
        let body = format!("\nbody[{index}] = dynamics.body {{");
        let rest = written.split_once(&body).unwrap_or_else(|| panic!("{body} in {written}")).1;
        let of_body = rest.split_once("\n}").unwrap().0;
        assert!(of_body.contains(&format!("type = \"{name}\"")), "{name} in {of_body}");
        assert!(of_body.contains(&format!("pos = {{0,0,{}}}", simple.len() - 1 - index)), "{of_body}");
    }
    assert!(written.contains("sides = {1,2,3}") && written.contains("radius = 0.25"), "{written}");
}

#[test]
fn the_file_names_every_joint_and_the_contacts_of_the_last_collide() {
    let mut world = world();
    let ball = Shape::Sphere { radius: 0.5 };
    let pair = [0.0, 0.9].map(|height| Some(add_body(&mut world, &ball, height)));
    let (anchor, axis) = (Point3::origin(), Vector3::x());
    let kinds = [
        JointKind::Ball { anchor },
        JointKind::Hinge { anchor, axis },
        JointKind::Slider { axis },
        JointKind::Fixed,
    ];

    for kind in &kinds {
        world.add_joint([pair[0], None], kind).unwrap();
    }
    world.default_collide(&Surface::default(), 4).unwrap();

    let written = text(&world);
    for name in ["ball", "hinge", "slider", "fixed", "contact"] {
        assert_eq!(written.matches(&format!("dynamics.{name}_joint")).count(), 1, "{name} in {written}");
    }
    world.clear_contacts();
    assert!(!text(&world).contains("contact_joint"));
}

#[test]
fn a_hull_on_a_body_is_an_entry_without_a_type_and_geoms_without_a_body_are_left_out() {
    let mut world = world();
    let root = world.root_space();
    world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 }).unwrap();
    let hull = world.add_hull(root, &Arc::new(HullData::new())).unwrap();
    let body = world.add_body();
    assert!(!text(&world).contains("geometry"));

    world.geom_mut(hull).set_body(Some(body)).unwrap();
    let written = text(&world);
    assert!(written.contains("geometry = {\n\t\t{\n\t\t},\n\t},"), "{written}");
    assert!(!written.contains("type = "), "{written}");
}

#[test]
fn exporting_a_world_does_not_change_its_motion() {
    let run = |export: bool| {
        let mut world = world();
        let (root, cube) = (world.root_space(), Shape::cuboid(0.2, 0.2, 0.2));
        world.set_gravity(&Vector3::new(0.0, 0.0, -9.81)).unwrap();
        world.add_geom(root, &Shape::Plane { normal: Vector3::z(), offset: 0.0 }).unwrap();
        let bodies = [0.11, 0.32].map(|height| add_body(&mut world, &cube, height));
        for body in bodies {
            world.body_mut(body).set_mass(&Mass::of(&cube, Amount::Total(1.0)).unwrap()).unwrap();
        }

        for _ in 0..50 {
            world.default_collide(&Surface::default(), 4).unwrap();
            if export {
                world.dif().unwrap();
            }
            // The other stepper uses ODE's random numbers, which tests on other threads use too.
            world.step(0.01).unwrap();
        }

        bodies.map(|body| world.body(body).pose())
    };
    assert_eq!(run(true), run(false));
}

#[test]
fn an_existing_file_is_replaced() {
    let path = fresh_path("replaced");
    std::fs::write(&path, "x".repeat(10_000)).unwrap();
    world().export_dif(&path).unwrap();
    let written = std::fs::read_to_string(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    assert!(written.starts_with("-- Dynamics Interchange Format") && !written.contains('x'), "{written}");
}

#[test]
fn a_missing_folder_is_an_error_and_is_not_made() {
    let folder = fresh_path("no_folder");
    let path = folder.join("world.dif");
    let problem = problem(world().export_dif(&path), &path);
    assert!(problem.contains("make its folder first"), "{problem}");
    assert!(!folder.exists());
}

#[test]
fn a_folder_and_an_invalid_name_are_refused_as_files() {
    let folder = std::env::temp_dir();
    let of_folder = problem(world().export_dif(&folder), &folder);
    assert!(of_folder.contains("name a file in this folder"), "{of_folder}");
    let nul = folder.join("world\0.dif");
    let of_nul = problem(world().export_dif(&nul), &nul);
    assert!(of_nul.contains("choose another name"), "{of_nul}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    let path = Path::new("/dev/full");
    let problem = problem(world().export_dif(path), path);
    assert!(problem.contains("make room on the disk"), "{problem}");
}
