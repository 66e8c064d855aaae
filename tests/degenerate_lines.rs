//! Rays and exits along lines on which a depth, an image coordinate or its change is zero but for rounding: lines of
//! sight, of constant rows and columns, in cameras' principal planes, along the work volume. What the hull answers is
//! held against inside tests of points on the lines.

use image::GrayImage;
use nalgebra::{Isometry3, Matrix3, Point3, Vector3, point, vector};
use ode_visual_hull::camera::{Camera, Distortion, Fisheye, Lens};
use ode_visual_hull::hull::{Aabb, Hull, HullData, Unseen};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, silhouette};
use ode_visual_hull_testing::degenerate_lines::{Kind, Lines, contradiction};
use ode_visual_hull_testing::random::Random;
use std::sync::Arc;

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

/// Sixteen rigs: pixels and coverage, both policies, pinholes and lenses, narrow and wide work volumes.
fn rigs() -> impl Iterator<Item = (Rig, Arc<Hull>)> {
    (0..16_u64).map(|seed| {
        let bit = |k: u64| seed >> k & 1 == 1;
        let unseen = if bit(1) { Unseen::ABSTAIN } else { Unseen::Outside };
        let (has_coverage, has_lenses, is_wide) = (bit(0), bit(2), bit(3));
        let rig = Rig { seed, has_coverage, unseen, has_lenses, is_wide, is_mixed: bit(0) != bit(3) };
        (rig, hull(rig))
    })
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

/// A torus, a box and a ball, each turned and a little off the middle.
fn subject(random: &mut Random) -> Subject {
    let solids = [
        Solid::torus(0.2, 0.06).unwrap(),
        Solid::cuboid(vector![0.3, 0.08, 0.4]).unwrap(),
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

#[test]
fn rays_and_exits_along_degenerate_lines_agree_with_inside_tests() {
    let (mut wrong, mut count) = (Vec::new(), 0);
    for (rig, hull) in rigs() {
        let (mut lines, mut random) = (Lines::new(&hull, rig.seed), Random(rig.seed));
        for kind in Kind::ALL {
            for _ in 0..LINES {
                let ray = lines.along(kind);
                count += 1;
                if let Some(problem) = contradiction(&hull, &ray, &mut random) {
                    wrong.push(format!("{kind:?} {rig:?} {ray:?}: {problem}"));
                }
            }
        }
    }
    let by_kind = Kind::ALL.map(|kind| wrong.iter().filter(|w| w.starts_with(&format!("{kind:?} "))).count());
    assert!(
        wrong.is_empty(),
        "{} of {count}, {by_kind:?}:\n{}",
        wrong.len(),
        wrong[..wrong.len().min(40)].join("\n")
    );
}

/// Number of lines of each kind for each rig.
const LINES: usize = 200;
