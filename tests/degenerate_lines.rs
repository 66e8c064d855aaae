//! Rays and exits along lines on which a depth, an image coordinate or its change is zero but for rounding: lines of
//! sight, of constant rows and columns, in cameras' principal planes, along the work volume. What the hull answers is
//! held against inside tests of points on the lines.

use image::GrayImage;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3, point, vector};
use ode_visual_hull::camera::{Camera, Distortion, Fisheye, Lens, Ray};
use ode_visual_hull::hull::{Aabb, Hull, HullData, Unseen, Workspace, reference};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, silhouette};
use ode_visual_hull_testing::degenerate_lines::{Kind, Lines, contradiction};
use ode_visual_hull_testing::random::Random;
use std::sync::{Arc, LazyLock};

const SIZE: (u32, u32) = (160, 120);

/// A kind of rig.
#[derive(Debug, Clone, Copy)]
struct Rig {
    seed: u64,
    /// Whether masks have coverage.
    has_coverage: bool,
    unseen: Unseen,
    has_lenses: bool,
    /// Whether the work volume holds the cameras, so that lines may start in and behind them.
    is_wide: bool,
    /// Whether one view is disabled.
    is_mixed: bool,
}

/// Eight rigs: pixels and coverage, both policies, pinholes and lenses, narrow and wide work volumes.
fn rigs() -> impl Iterator<Item = &'static (Rig, Arc<Hull>)> {
    static RIGS: LazyLock<Vec<(Rig, Arc<Hull>)>> = LazyLock::new(|| (0..8).map(rig).collect());
    RIGS.iter()
}

fn rig(seed: u64) -> (Rig, Arc<Hull>) {
    let bit = |k: u64| seed >> k & 1 == 1;
    let unseen = if bit(1) { Unseen::ABSTAIN } else { Unseen::Outside };
    let (has_coverage, has_lenses, is_wide) = (bit(0), bit(2), bit(0) ^ bit(1) ^ bit(2));
    let rig = Rig { seed, has_coverage, unseen, has_lenses, is_wide, is_mixed: has_coverage == has_lenses };
    (rig, hull(rig))
}

fn hull(rig: Rig) -> Arc<Hull> {
    let mut random = Random(rig.seed);
    let subject = subject(&mut random);
    let half = if rig.is_wide { vector![2.0, 2.0, 2.0] } else { vector![0.4, 0.35, 0.3] };

    let data = HullData::new();
    data.set_bounds(Aabb::new((-half).into(), half.into()).unwrap()).unwrap();
    data.set_unseen(rig.unseen).unwrap();
    let render: fn(&Camera, &Subject) -> GrayImage = if rig.has_coverage { coverage } else { silhouette };
    for (k, camera) in cameras(rig, &mut random).into_iter().enumerate() {
        let mask = render(&camera, &subject);
        let view = data.add_view(camera).unwrap();
        data.set_mask(view, &mask).unwrap();
        data.set_view_enabled(view, !(rig.is_mixed && k == 3)).unwrap();
    }
    data.update(0.0).unwrap()
}

/// A plate, a bar and a ball, each turned and a little off the middle.
fn subject(random: &mut Random) -> Subject {
    let solids = [
        Solid::cuboid(vector![0.3, 0.08, 0.4]).unwrap(),
        Solid::cuboid(vector![0.06, 0.6, 0.06]).unwrap(),
        Solid::sphere(0.12).unwrap(),
    ];
    let placed = solids.map(|solid| {
        let shift = random.point(point![-0.15, -0.15, -0.1], point![0.15, 0.15, 0.1]).coords;
        Placed::new(solid, Isometry3::from_parts(shift.into(), random.rotation()), Texture::plain([200; 3]))
    });
    Subject::new(placed.to_vec())
}

/// Five cameras 1.2 m to 1.6 m from the middle. The first two look along axes, so that many of their numbers are zeros;
/// the subject lies near an image border of every other one.
fn cameras(rig: Rig, random: &mut Random) -> Vec<Camera> {
    let lens: Lens = match (rig.has_lenses, rig.has_coverage) {
        (false, _) => Lens::none(),
        (true, false) => Distortion::from_opencv(&[-0.3, 0.05, 0.0, 0.0]).unwrap().into(),
        (true, true) => Fisheye::from_opencv(&[0.02, -0.004, 0.0, 0.0]).unwrap().into(),
    };
    (0..5)
        .map(|k| {
            let direction = match k {
                0 => Vector3::x(),
                1 => -Vector3::y(),
                _ => random.direction(),
            };
            let eye = Point3::from(direction * random.between(1.2, 1.6));
            let target = if k < 2 {
                Point3::origin()
            } else {
                random.point(point![-0.1, -0.1, -0.1], point![0.1, 0.1, 0.1])
            };
            let up = if k < 2 { Vector3::z() } else { random.direction() };
            let camera = Camera::look_at(format!("cam{k}"), SIZE, 0.9, eye, target, up).unwrap();

            let focal = 150.0;
            let (cx, cy) = if k % 2 == 1 { (80.0, 60.0) } else { (random.between(40.0, 120.0), 75.5) };
            let k = Matrix3::new(focal, 0.0, cx, 0.0, focal, cy, 0.0, 0.0, 1.0);
            Camera::new(camera.name(), SIZE, k, lens, *camera.cam_from_world()).unwrap()
        })
        .collect()
}

/// Number of lines of each kind along which the answers of each rig are tested.
const LINES: usize = 160;

#[test]
fn rays_and_exits_along_degenerate_lines_agree_with_inside_tests() {
    let mut wrong = Vec::new();
    for (rig, hull) in rigs() {
        let (mut lines, mut random) = (Lines::new(hull, rig.seed), Random(rig.seed));
        for kind in Kind::ALL {
            for _ in 0..LINES {
                let ray = lines.along(kind);
                if let Some(problem) = contradiction(hull, &ray, &mut random) {
                    wrong.push(format!("{kind:?}, {rig:?}, {ray:?}: {problem}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} answers:\n{}", wrong.len(), wrong[..wrong.len().min(20)].join("\n"));
}

#[test]
fn a_ray_along_a_line_of_sight_meets_the_hull_at_the_same_points_wherever_it_begins() {
    for (rig, hull) in rigs().filter(|(rig, _)| !rig.is_wide) {
        let (mut lines, mut random, mut hits) = (Lines::new(hull, rig.seed), Random(rig.seed), 0);
        for _ in 0..100 {
            // From the camera's centre, and from up to 0.7 m before or behind it: the work volume begins farther away.
            let sight = lines.along(Kind::Sight);
            let camera = hull.views().iter().map(|view| view.camera().centre());
            let Some(centre) = camera
                .into_iter()
                .find(|centre| (centre - sight.origin).cross(&sight.direction).norm() < 1e-12)
            else {
                panic!("no camera on {sight:?}")
            };
            let away =
                if sight.direction.dot(&centre.coords) > 0.0 { -sight.direction } else { sight.direction };
            let cast = |start: f64| {
                let ray = Ray { origin: centre + away * start, direction: away };
                hull.ray_cast(&ray)
                    .map(|(entry, exit)| [entry.map_or(0.0, |hit| hit.t), exit.t].map(|t| t + start))
            };

            let expected = cast(0.0);
            hits += usize::from(expected.is_some());
            let start = random.between(-0.7, 0.7);
            let found = cast(start);
            // Only the rounding of the start and of crossings differs.
            let is_same = match (found, expected) {
                (Some(found), Some(expected)) => (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-9),
                (found, expected) => found == expected,
            };
            assert!(is_same, "{rig:?}, {away} from {start} m: {found:?}, not {expected:?}");
        }
        assert!(hits > 40, "{rig:?}: {hits}");
    }
}

#[test]
fn responses_of_points_on_the_borders_of_pixels_agree_with_the_reference() {
    let mut workspace = Workspace::new();
    for (rig, hull) in rigs() {
        let mut lines = Lines::new(hull, rig.seed);
        let points: Vec<_> = (0..12).map(|_| lines.along(Kind::Border).origin).collect();
        let mut many = hull.respond_many(&points, &mut workspace).iter().peekable();

        for (index, p) in points.iter().enumerate() {
            let many = many.next_if(|response| response.point == index);
            let (single, expected) = (hull.respond(p), reference::respond(hull, p));
            assert_eq!(many.map(|many| (many.normal, many.depth)), single.map(|one| (one.normal, one.depth)));

            let found = single.map(|one| (one.nearest.view.name(), one.nearest.b));
            let wanted = expected.map(|one| (hull.views()[one.view].name(), one.b));
            assert_eq!(found, wanted, "{rig:?}, {p}");
            // Both find the same pixel border in closed form.
            if let (Some(found), Some(expected)) = (single, expected) {
                assert!((found.depth - expected.depth).abs() < 1e-9, "{rig:?}, {p}");
            }
        }
    }
}
