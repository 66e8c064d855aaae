use super::*;
use crate::arguments::{UnseenPolicy, VolumeOptions};
use crate::playback_options::PlaybackOptions;
use nalgebra::{Point3, Vector3};
use ode_visual_hull::hull::{Aabb, Motion};
use ode_visual_hull::shape::{Convex, Heightfield, TriMesh};
use ode_visual_hull_random::Random;
use std::sync::Arc;

const KINDS: u32 = 8;

/// A random shape of the kind number `kind`.
fn shape(kind: u32, random: &mut Random) -> Shape {
    let radius = random.between(1e-3, 2.0);
    let length = random.between(1e-3, 2.0);
    let corner = |random: &mut Random| random.point(Point3::new(0.1, 0.1, 0.1), Point3::new(1.0, 2.0, 3.0));
    match kind {
        0 => Shape::Box { sides: corner(random).coords },
        1 => Shape::Sphere { radius },
        2 => Shape::Capsule { radius, length },
        3 => Shape::Cylinder { radius, length },
        4 => Shape::Plane { normal: random.direction() * length, offset: random.between(-2.0, 2.0) },
        5 => Shape::Convex(Arc::new(tetrahedron(random))),
        6 => {
            let points = (0..6).map(|_| corner(random)).collect();
            Shape::TriMesh(Arc::new(TriMesh::new(points, vec![[0, 1, 2], [2, 1, 3], [5, 4, 0]]).unwrap()))
        }
        _ => {
            let heights = (0..6).map(|_| random.between(-1.0, 1.0)).collect();
            let field = Heightfield::new(heights, [3, 2], [length, radius]).unwrap();
            let field = field.with_thickness(random.unit()).unwrap();
            Shape::Heightfield(Arc::new(if random.unit() < 0.5 { field.wrapped() } else { field }))
        }
    }
}

/// A regular tetrahedron, of random size, around the origin.
fn tetrahedron(random: &mut Random) -> Convex {
    let size = random.between(0.01, 2.0);
    let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    let points = corners.map(|corner| Point3::from(Vector3::from(corner) * size)).to_vec();
    Convex::new(points, &[vec![0, 1, 2], vec![0, 3, 1], vec![0, 2, 3], vec![1, 3, 2]]).unwrap()
}

fn part(kind: u32, random: &mut Random) -> DrawnPart {
    let position = random.point(Point3::new(-5.0, -5.0, -5.0), Point3::new(5.0, 5.0, 5.0));
    DrawnPart {
        shape: shape(kind, random),
        body_from_part: Isometry3::from_parts(position.into(), random.rotation()),
        colour: [random.below(256) as u8, random.below(256) as u8, random.below(256) as u8],
    }
}

/// Bodies of one to three parts, of all shapes.
fn random_file(random: &mut Random) -> BodiesFile {
    let body = |kind: u32, random: &mut Random| {
        let count = 1 + random.below(3_u32);
        (0..count).map(|k| part((kind + k) % KINDS, random)).collect()
    };
    let bounds = Aabb::new(Point3::new(-1.0, -0.1, 1e-9), Point3::new(1.0 / 3.0, 1e6, 2.0)).unwrap();
    BodiesFile {
        bodies: (0..KINDS).map(|kind| body(kind, random)).collect(),
        fixed: (0..KINDS).map(|kind| part(kind, random).at(&Isometry3::identity())).collect(),
        playback: Some(PlayedRecording {
            options: PlaybackOptions {
                frames: Some(2..9),
                rate: Some(1.0 / 3.0),
                wait: 0.1,
                linger: 1e-7,
                volume: VolumeOptions { bounds: Some(bounds), unseen: UnseenPolicy::Abstain },
            },
            motion: Motion::Predicted,
        }),
    }
}

/// Checks that all is equal but for rotations, which are normalised again: they may differ by their last digits.
fn assert_same(found: &BodiesFile, written: &BodiesFile) {
    let close = |a: &Isometry3<f64>, b: &Isometry3<f64>| {
        assert_eq!(a.translation, b.translation);
        assert!((a.rotation.coords - b.rotation.coords).amax() < 1e-15, "{a} and {b}");
    };
    let parts = |file: &BodiesFile| file.bodies.concat();
    let counts = |file: &BodiesFile| file.bodies.iter().map(Vec::len).collect::<Vec<_>>();
    assert_eq!(counts(found), counts(written));
    for (a, b) in parts(found).iter().zip(&parts(written)) {
        assert_eq!((&a.shape, a.colour), (&b.shape, b.colour));
        close(&a.body_from_part, &b.body_from_part);
    }
    assert_eq!(found.fixed.len(), written.fixed.len());
    for (a, b) in found.fixed.iter().zip(&written.fixed) {
        assert_eq!((&a.shape, a.colour), (&b.shape, b.colour));
        close(&a.world_from_body, &b.world_from_body);
    }
    assert_eq!(found.playback, written.playback);
}

#[test]
fn bodies_of_all_shapes_are_the_same_after_writing_and_reading() {
    let mut random = Random(1);
    for _ in 0..50 {
        let file = random_file(&mut random);
        assert_same(&BodiesFile::from_toml(&file.to_toml().unwrap()).unwrap(), &file);
    }
}

#[test]
fn what_a_playback_leaves_to_the_recording_is_not_written() {
    for motion in [Motion::Held, Motion::Interpolated, Motion::Predicted] {
        let playback = Some(PlayedRecording { options: PlaybackOptions::default(), motion });
        let file = BodiesFile { playback, ..BodiesFile::default() };
        let text = file.to_toml().unwrap();
        assert!(["frames", "rate", "bounds"].iter().all(|field| !text.contains(field)), "{text}");
        assert_eq!(BodiesFile::from_toml(&text).unwrap(), file);
    }
    let nothing = BodiesFile::default();
    assert_eq!(BodiesFile::from_toml(&nothing.to_toml().unwrap()).unwrap(), nothing);
}

const BOX: &str = "\
[[body]]

[[body.part]]
shape = \"box\"
sides = [0.1, 0.2, 0.3]
colour = [1, 2, 3]
position = [0, 0.0, 1.5]
quaternion = [2.0, 0, 0, 0]

[playback]
wait = 3
linger = 1.0
frames = \"0..9\"
rate = 30.0
bounds = [-1, 1, -1, 1, 0, 2]
unseen = \"outside\"
motion = \"held\"
";

/// The message about the text with `from` replaced by `to`.
fn refused(from: &str, to: &str) -> String {
    assert!(BOX.contains(from), "{from}");
    match BodiesFile::from_toml(&BOX.replacen(from, to, 1)) {
        Ok(file) => panic!("{to} was read: {file:?}"),
        Err(e) => e.to_string(),
    }
}

#[test]
fn a_quaternion_of_any_length_is_a_rotation() {
    let file = BodiesFile::from_toml(BOX).unwrap();
    assert_eq!(file.bodies[0][0].body_from_part, Isometry3::translation(0.0, 0.0, 1.5));
}

#[test]
fn wrong_parts_are_refused_with_line_part_field_and_what_was_expected() {
    for (from, to, expected) in [
        ("[0.1, 0.2, 0.3]", "[0.1, -0.2, 0.3]", "line 5, body 1, part 1, field `sides`: expected 3 lengths"),
        ("[0.1, 0.2, 0.3]", "[0.1, nan, 0.3]", "found [0.1, nan, 0.3]; write 3 of them"),
        ("[0.1, 0.2, 0.3]", "[0.1, 0, 0.3]", "3 lengths from 1e-6"),
        ("[0.1, 0.2, 0.3]", "[0.1, 0.2]", "3 lengths"),
        ("[0.1, 0.2, 0.3]", "0.1", "3 lengths"),
        (
            "sides = [0.1, 0.2, 0.3]",
            "side = 0.1",
            "field `side`: expected only `shape`, `colour`, `position`",
        ),
        (
            "sides = [0.1, 0.2, 0.3]\n",
            "",
            "line 3, body 1, part 1, field `sides`: expected this field, found none",
        ),
        ("\"box\"", "\"cube\"", "line 4, body 1, part 1, field `shape`: expected one of box, sphere"),
        ("\"box\"", "\"ray\"", "found a ray, which is not drawn"),
        ("\"box\"", "7", "expected text, found 7"),
        ("\"box\"", "\"sphere\"\nradius = -0.1", "field `sides`: expected only `shape`"),
        (
            "shape = \"box\"\nsides = [0.1, 0.2, 0.3]",
            "shape = \"sphere\"\nradius = inf",
            "a length from 1e-6 to 1e7 m, found inf",
        ),
        ("[1, 2, 3]", "[1, 2, 256]", "field `colour`: expected 3 whole numbers in range, found [1, 2, 256]"),
        ("[1, 2, 3]", "[1, 2, 0.5]", "red, green and blue from 0 to 255"),
        (
            "[0, 0.0, 1.5]",
            "[0, 0, 1e30]",
            "field `position`: expected 3 numbers up to 1e7, found [0, 0, 1e30]",
        ),
        (
            "[2.0, 0, 0, 0]",
            "[0, 0, 0, 0]",
            "field `quaternion`: expected a rotation, found a quaternion of length 0",
        ),
        ("[2.0, 0, 0, 0]", "[1, 0, 0]", "write w, x, y, z"),
    ] {
        let message = refused(from, to);
        assert!(message.contains(expected), "expected {expected:?} in {message:?}");
    }
}

#[test]
fn wrong_playbacks_bodies_and_files_are_refused() {
    let part = &BOX[BOX.find("[[body.part]]").unwrap()..BOX.find("[playback]").unwrap()];
    for (from, to, expected) in [
        ("wait = 3", "wait = -3", "line 11, playback, field `wait`: expected seconds from 0 on, found -3"),
        ("wait = 3\n", "", "line 10, playback, field `wait`: expected this field, found none"),
        ("linger = 1.0", "linger = nan", "expected a number up to 1e7, found nan"),
        ("\"0..9\"", "\"9..0\"", "field `frames`: expected A..B with A below B"),
        ("rate = 30.0", "rate = 0", "expected a rate above 0, found 0"),
        ("[-1, 1, -1, 1, 0, 2]", "[-1, 1, -1, 1, 2, 0]", "field `bounds`"),
        ("[-1, 1, -1, 1, 0, 2]", "[-1, 1]", "write [x0, x1, y0, y1, z0, z1]"),
        ("\"outside\"", "\"maybe\"", "expected one of outside, abstain, found \"maybe\""),
        ("\"held\"", "\"stopped\"", "expected one of held, interpolated, predicted, found \"stopped\""),
        ("[playback]", "[playback]\nspeed = 1", "field `speed`: expected only `wait`"),
        ("[playback]", "[[playback]]", "expected a table, found [a table]"),
        ("[playback]", "[played]", "field `played`: expected only `body`, `fixed`, `playback`"),
        (
            "[playback]",
            "[[body]]\n[playback]",
            "line 10, body 2, field `part`: expected a part at least, found none",
        ),
        (part, "part = []\n", "body 1, field `part`: expected a part at least"),
        (part, "part = [1]\n", "body 1, field `part`: expected tables, found 1"),
        (part, "part = 1\n", "body 1, field `part`: expected tables, found 1"),
        ("[[body]]", "body = 1", "line"),
        ("[[body]]", "[[body", "line 1: expected TOML, found"),
    ] {
        let message = refused(from, to);
        assert!(message.contains(expected), "expected {expected:?} in {message:?}");
    }
}

#[test]
fn points_that_are_no_solid_no_mesh_and_no_ground_are_refused() {
    let refused = |shape: &str| refused("shape = \"box\"\nsides = [0.1, 0.2, 0.3]", shape);
    for (shape, expected) in [
        (
            "shape = \"convex\"\npoints = [[0, 0, 0]]\nfaces = []",
            "field `faces`: polyhedron: expected at least 4 points",
        ),
        ("shape = \"convex\"\npoints = [[0, 0]]\nfaces = []", "field `points`: expected rows of 3 numbers"),
        (
            "shape = \"convex\"\npoints = []\nfaces = [[-1]]",
            "expected rows of indices from 0 on, found [-1] as number 0",
        ),
        (
            "shape = \"trimesh\"\npoints = [[0, 0, 0]]\ntriangles = [[0, 0, 1]]",
            "triangle 0 of the mesh: expected indices below 1",
        ),
        ("shape = \"trimesh\"\npoints = []\ntriangles = [[0, 0]]", "expected 3 indices each, found 2"),
        (
            "shape = \"heightfield\"\ncounts = [2, 2]\nsize = [1, 1]\nheights = [0]\nthickness = 0\nwraps = false",
            "expected 2 x 2 samples",
        ),
        (
            "shape = \"heightfield\"\ncounts = [-2, 2]\nsize = [1, 1]\nheights = [0]\nthickness = 0\nwraps = false",
            "field `counts`: expected 2 whole numbers",
        ),
        (
            "shape = \"heightfield\"\ncounts = [2, 2]\nsize = [1, 1]\nheights = [0, 0, 0, nan]\nthickness = 0\nwraps = false",
            "found nan as number 3",
        ),
        (
            "shape = \"heightfield\"\ncounts = [2, 2]\nsize = [1, 1]\nheights = [0, 0, 0, 0]\nthickness = -1\nwraps = false",
            "field `thickness`",
        ),
        (
            "shape = \"heightfield\"\ncounts = [2, 2]\nsize = [1, 1]\nheights = [0, 0, 0, 0]\nthickness = 0\nwraps = 1",
            "expected true or false, found 1",
        ),
        (
            "shape = \"plane\"\nnormal = [0, 0, 0]\noffset = 0",
            "expected a direction, found a vector of length 0",
        ),
    ] {
        let message = refused(shape);
        assert!(message.contains(expected), "expected {expected:?} in {message:?}");
    }
}

#[test]
fn rays_and_bodies_without_parts_are_not_written_and_errors_name_the_file() {
    let ray = DrawnPart { shape: Shape::Ray { length: 1.0 }, ..part(0, &mut Random(1)) };
    let with =
        |parts| BodiesFile { bodies: vec![vec![part(1, &mut Random(1))], parts], ..BodiesFile::default() };
    let message = with(vec![ray]).write("nowhere/bodies.toml").unwrap_err().to_string();
    assert!(
        message.starts_with("nowhere/bodies.toml: body 2, part 1: expected a shape that is drawn"),
        "{message}"
    );
    assert!(
        with(Vec::new()).to_toml().unwrap_err().to_string().starts_with("body 2: expected a part at least")
    );
    let message = BodiesFile::read("nowhere/bodies.toml").unwrap_err().to_string();
    assert!(message.starts_with("nowhere/bodies.toml: expected the bodies of a run, found"), "{message}");
}

#[test]
fn no_cut_of_a_file_panics() {
    let text = random_file(&mut Random(3)).to_toml().unwrap();
    let mut random = Random(4);
    for _ in 0..300 {
        let end = random.below(text.len());
        let _ = BodiesFile::from_toml(&text[..end]);
        // Another character anywhere.
        let mut bytes = text.clone().into_bytes();
        bytes[end] = b" [].-9n\""[random.below(8_usize)];
        let _ = BodiesFile::from_toml(&String::from_utf8(bytes).unwrap());
    }
}
