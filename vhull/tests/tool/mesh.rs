//! `vhull mesh`: meshes are closed, have the volume of the hull, and are the same in both formats.

use super::{studio, vhull};
use nalgebra::Vector3;
use ode_visual_hull_testing::captures;
use std::collections::HashMap;
use std::path::Path;

/// Contents of a binary PLY file written by `vhull mesh`.
struct Ply {
    points: Vec<Vector3<f64>>,
    normals: Vec<Vector3<f64>>,
    triangles: Vec<[usize; 3]>,
}

fn read_ply(path: &Path) -> Ply {
    let bytes = std::fs::read(path).unwrap();
    let end = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"), "{header}");
    let count = |what: &str| -> usize {
        let line = header.lines().find_map(|line| line.strip_prefix(what)).unwrap();
        line.trim().parse().unwrap()
    };

    let (vertices, faces) = (count("element vertex"), count("element face"));
    let body = &bytes[end..];
    assert_eq!(body.len(), 24 * vertices + 13 * faces);

    // Vertices take six floats of 4 bytes; faces a count of 1 byte and three indices of 4 bytes.
    let float = |at: usize| f64::from(f32::from_le_bytes(body[at..at + 4].try_into().unwrap()));
    let vector = |at: usize| Vector3::new(float(at), float(at + 4), float(at + 8));
    let index = |at: usize| u32::from_le_bytes(body[at..at + 4].try_into().unwrap()) as usize;
    let triangle = |k: usize| {
        let at = 24 * vertices + 13 * k;
        assert_eq!(body[at], 3);
        [index(at + 1), index(at + 5), index(at + 9)]
    };

    Ply {
        points: (0..vertices).map(|k| vector(24 * k)).collect(),
        normals: (0..vertices).map(|k| vector(24 * k + 12)).collect(),
        triangles: (0..faces).map(triangle).collect(),
    }
}

impl Ply {
    /// Sum of the signed tetrahedra between the triangles and the origin.
    fn volume(&self) -> f64 {
        let signed =
            |&[a, b, c]: &[usize; 3]| self.points[a].dot(&self.points[b].cross(&self.points[c])) / 6.0;
        self.triangles.iter().map(signed).sum()
    }

    /// Each edge occurs as often in one direction as in the other.
    fn assert_closed(&self) {
        let mut balance: HashMap<(usize, usize), i32> = HashMap::new();
        for &[a, b, c] in &self.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *balance.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(balance.values().all(|&times| times == 0));
    }
}

#[test]
fn a_balls_hull_is_closed_and_as_large_as_the_ball_or_a_little_larger() {
    let folder = studio("mesh_ball", "ball");
    let run = vhull(&folder, &["mesh", "studio", "--resolution", "0.02", "-o", "ball.ply"]);
    assert_eq!((run.code, run.error.as_str()), (0, ""), "{}", run.out);
    let mesh = read_ply(&folder.join("ball.ply"));
    mesh.assert_closed();

    // The ball has 0.268 m3; the hull of five cameras is larger, but smaller than the box around the ball.
    assert!((0.25..0.40).contains(&mesh.volume()), "{}", mesh.volume());
    let centre = Vector3::new(0.0, 0.0, 0.4);
    for (point, normal) in mesh.points.iter().zip(&mesh.normals) {
        assert!((normal.norm() - 1.0).abs() < 1e-5);
        // A pixel covers 12 mm at the ball, and cells are 20 mm.
        assert!((point - centre).norm() > 0.4 - 0.025, "{point}");
        assert!(normal.dot(&(point - centre)) > 0.0, "a hull of a ball is convex: {point} {normal}");
    }
}

#[test]
fn files_of_a_sequence_are_numbered_and_obj_has_as_many_elements_as_ply() {
    let folder = studio("mesh_sequence", "box");
    let run =
        vhull(&folder, &["mesh", "studio", "--frames", "1..3", "--resolution", "0.05", "-o", "hull.obj"]);
    assert_eq!(run.code, 0, "{}", run.error);
    assert!(!folder.join("hull.obj").exists() && !folder.join("hull_000000.obj").exists());
    assert_eq!(run.out.lines().count(), 2);

    let obj = std::fs::read_to_string(folder.join("hull_000002.obj")).unwrap();
    vhull(&folder, &["mesh", "studio", "--frame", "2", "--resolution", "0.05", "-o", "hull.ply"]);
    let ply = read_ply(&folder.join("hull.ply"));
    let lines = |start: &str| obj.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!(
        (lines("v "), lines("vn "), lines("f ")),
        (ply.points.len(), ply.points.len(), ply.triangles.len())
    );
}

#[test]
fn the_balancing_persons_mesh_has_the_measured_volume() {
    let Some(dir) = captures::find("balancing_person") else { return };
    let folder = super::folder("mesh_person");
    let out = folder.join("person.ply");
    let run =
        vhull(&dir, &["mesh", ".", "--frame", "50", "--resolution", "0.02", "-o", out.to_str().unwrap()]);
    assert_eq!(run.code, 0, "{}", run.error);
    let mesh = read_ply(&out);
    mesh.assert_closed();
    // The volume of the hull counted in voxels is 0.122 m3; 5 % of it are allowed.
    assert!((mesh.volume() - 0.122).abs() < 0.006, "{}", mesh.volume());
}

#[test]
fn errors_of_wrong_input_name_the_next_step_and_no_file_is_written() {
    let folder = studio("mesh_wrong", "ball");
    for (words, part) in [
        (&["mesh", "studio", "-o", "hull.stl"][..], "expected a name that ends in .ply or .obj"),
        (&["mesh", "studio", "--frame", "7", "-o", "hull.ply"], "3 frames from 0 to 2"),
        (&["mesh", "studio", "--frames", "7..9", "-o", "hull.ply"], "expected some of frames 0 to 2"),
        (&["mesh", "studio", "--resolution", "0.0001", "-o", "hull.ply"], "take larger cells"),
        (
            &["mesh", "studio", "--bounds", "0.6,0.7,0.6,0.7,0.5,0.6", "-o", "hull.ply"],
            "look for the cause with vhull check",
        ),
        (&["mesh", "studio", "-o", "studio/rig.toml/hull.ply"], "expected to make this folder"),
        (&["mesh", "studio", "--frames", "7..", "-o", "hull.ply"], "found 7..\n"),
        (&["mesh", "studio/rig.toml", "-o", "hull.ply"], "found a file; give the folder"),
        (&["mesh", ".", "-o", "hull.ply"], "vhull convert CALIBRATION ./rig.toml"),
        (&["mesh", "absent", "-o", "hull.ply"], "expected the folder of a recording"),
    ] {
        let run = vhull(&folder, words);
        assert_eq!(run.code, 1, "{words:?}: {}{}", run.out, run.error);
        assert!(run.error.contains(part), "{words:?}: {}", run.error);
    }
    assert!(!folder.join("hull.ply").exists());
}

#[test]
fn the_folder_of_a_mesh_is_created_and_small_volumes_are_in_cubic_centimetres() {
    let folder = studio("mesh_small", "ball");
    let small = vhull(&folder, &["convert", "studio", "small/rig.toml", "--unit", "0.1"]);
    assert_eq!(small.code, 0, "the rig file of a recording is converted: {}", small.error);
    for camera in 0..5 {
        let [from, to] = ["studio", "small"].map(|name| folder.join(format!("{name}/cam{camera}")));
        std::fs::rename(from, to).unwrap();
    }

    let run = vhull(&folder, &["mesh", "small", "--resolution", "0.002", "-o", "made/for/it/hull.ply"]);
    assert_eq!(run.code, 0, "{}", run.error);
    let mesh = read_ply(&folder.join("made/for/it/hull.ply"));
    assert!(run.out.contains(&format!(", {:.1} cm3", 1e6 * mesh.volume())), "{}", run.out);
}
