//! Hulls between frames and after the last one, against the hulls of masks that were left out.

use crate::studio::cuboid;
use image::{GrayImage, Luma, Rgb, RgbImage};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, Hull, HullData, Motion};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::silhouette::{PackedMask, SUBJECT};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage};
use ode_visual_hull_testing::captures;
use ode_visual_hull_testing::figure::{
    Bound::{self, AtLeast},
    Figure,
};
use std::path::Path;

/// Frames of the recording a second.
const RATE: f64 = 60.0;

/// Distance between the points of the grid on which hulls are compared, in metres.
const SPACING: f64 = 0.03;

pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let Some(dir) = captures::find("balancing_person") else { return fast_part(progress) };
    let recording = Recording::open(&dir).expect("a recording");
    let masks: Vec<Vec<PackedMask>> = recording
        .frames()
        .iter()
        .map(|&frame| {
            let masks = recording.masks(frame).expect("masks");
            masks.iter().map(PackedMask::new).collect()
        })
        .collect();

    let mut figures = Vec::new();
    // Every second, fourth and sixth frame is shown; the bounds are for the middle, half a frame ahead, a whole frame.
    let cases: [(usize, u32, [Option<f64>; 3]); 3] = [
        (2, 30, [Some(0.935), Some(0.90), Some(0.83)]),
        (4, 15, [Some(0.90), Some(0.82), None]),
        (6, 10, [Some(0.86), None, None]),
    ];
    for (step, rate, [middle, half, whole]) in cases {
        progress(&format!("a person at {rate} frames a second"));
        let found = compare(&recording, &masks, step);
        let mut add = |name: &str, value: f64, bound: Option<f64>| {
            let name = format!("{name}_iou_{rate}hz");
            figures.push(Figure { name, value, bound: bound.map(|least| AtLeast(least) as Bound) });
        };
        add("interpolated", found.interpolated, middle);
        add("held_middle", found.held_half, None);
        add("predicted_half", found.predicted_half, half);
        add("held_half", found.held_half, None);
        add("predicted_full", found.predicted_full, whole);
        add("held_full", found.held_full, None);
    }
    figures.extend(fast_part(progress));
    figures
}

/// Mean intersections over unions with the hulls of the true masks.
#[derive(Debug, Default)]
struct Overlaps {
    interpolated: f64,
    held_half: f64,
    predicted_half: f64,
    held_full: f64,
    predicted_full: f64,
}

/// Shows every `step`-th frame of the recording.
fn compare(recording: &Recording, masks: &[Vec<PackedMask>], step: usize) -> Overlaps {
    let truth = open(recording);
    let shown = open(recording);
    let time = |frame: usize| frame as f64 / RATE;

    let (mut sums, mut count) = (Overlaps::default(), 0.0);
    publish(&shown, &masks[0], 0.0);
    for frame in (step..masks.len() - step).step_by(step) {
        publish(&shown, &masks[frame], time(frame));
        // The first motion is computed here, and the later ones by the thread that sets the masks.
        let (_, held) = shown.latest().expect("a frame");
        let moving = |motion, time| occupied(&shown.in_motion(motion, time).expect("a hull"));
        let interpolated = moving(Motion::Interpolated, time(frame + step / 2));
        let predicted_half = moving(Motion::Predicted, time(frame + step / 2));
        let predicted_full = moving(Motion::Predicted, time(frame + step));

        let true_at = |frame: usize| {
            publish(&truth, &masks[frame], 0.0);
            occupied(&truth.latest().expect("a frame").1)
        };
        let [before, half, full] = [frame - step / 2, frame + step / 2, frame + step].map(true_at);
        let held = occupied(&held);
        sums.interpolated += overlap(&interpolated, &before);
        sums.held_half += overlap(&held, &half);
        sums.predicted_half += overlap(&predicted_half, &half);
        sums.held_full += overlap(&held, &full);
        sums.predicted_full += overlap(&predicted_full, &full);
        count += 1.0;
    }
    for sum in [
        &mut sums.interpolated,
        &mut sums.held_half,
        &mut sums.predicted_half,
        &mut sums.held_full,
        &mut sums.predicted_full,
    ] {
        *sum /= count;
    }
    sums
}

fn open(recording: &Recording) -> HullData {
    let data = HullData::new();
    data.set_bounds(captures::BALANCING).expect("valid bounds");
    data.add_views(recording.rig().cameras()).expect("distinct names");
    data
}

fn publish(data: &HullData, masks: &[PackedMask], time: f64) {
    for (view, mask) in masks.iter().enumerate() {
        data.set_packed(view, mask).expect("a mask of the camera's size");
    }
    data.update(time).expect("masks in all views");
}

/// Which points of a grid are inside a hull.
fn occupied(hull: &Hull) -> Vec<bool> {
    let bounds = captures::BALANCING;
    let counts = (bounds.max - bounds.min).map(|extent| (extent / SPACING) as usize);
    let mut inside = Vec::with_capacity(counts.product());
    for k in 0..counts.z {
        for j in 0..counts.y {
            for i in 0..counts.x {
                let p: Point3<f64> = bounds.min + Vector3::new(i, j, k).map(|n| (n as f64 + 0.5) * SPACING);
                inside.push(hull.inside(&p));
            }
        }
    }
    inside
}

/// The intersection over the union.
fn overlap(a: &[bool], b: &[bool]) -> f64 {
    let both = a.iter().zip(b).filter(|(a, b)| **a && **b).count();
    let any = a.iter().zip(b).filter(|(a, b)| **a || **b).count();
    both as f64 / any.max(1) as f64
}

/// A hand of 20 pixels on a thin arm that is lifted or swings by 20 and 60 pixels from mask to mask: the intersection over
/// the union of hand and arm with those of the true mask in the middle. Draws what is lifted into `docs/motion`.
fn fast_part(progress: &dyn Fn(&str)) -> Vec<Figure> {
    progress("a hand that moves fast");
    let mut figures = Vec::new();
    for (kind, turns) in [("", false), ("_swing", true)] {
        for widths in [1, 3] {
            let arm = MovingArm::new(f64::from(widths) * 0.1, turns);
            let [before, middle, after] = [-1.0, 0.0, 1.0].map(|time| arm.mask(time));
            let data = arm.data();
            for (mask, time) in [(&before, 0.0), (&after, 0.1)] {
                data.set_mask(0, mask).expect("a mask of the camera's size");
                data.update(time).expect("masks in all views");
            }
            let found = mask_of(&data.in_motion(Motion::Interpolated, 0.15).expect("a hull"));

            let bound = (widths == 3 && !turns).then_some(AtLeast(0.9));
            let name = |what: &str| format!("fast_part{kind}_{what}{widths}_widths");
            figures.push(Figure { name: name("iou_"), value: arm.overlap(&found, &middle), bound });
            figures.push(Figure::reported(&name("held_iou_"), arm.overlap(&before, &middle)));
            if !turns {
                for (name, mask) in [("interpolated", &found), ("held", &before)] {
                    arm.draw(mask, &middle, &format!("{name}_{widths}_widths.png"));
                }
            }
        }
    }
    figures
}

/// A person's trunk, and an arm with a hand that moves in front of a camera.
struct MovingArm {
    camera: Camera,
    /// The way of the hand in half the time between two masks, in metres.
    half_way: f64,
    /// Whether the arm turns about the shoulder; else it is lifted as a whole.
    turns: bool,
}

/// The length of the arm, in metres. A pixel is 5 mm at its place.
const ARM: f64 = 0.6;

impl MovingArm {
    /// The hand moves by `way` metres from mask to mask.
    fn new(way: f64, turns: bool) -> Self {
        let eye = Point3::new(3.2, 0.0, 1.0);
        let camera =
            Camera::look_at("front", (640, 480), 0.93, eye, Point3::new(0.0, 0.0, 1.0), Vector3::z());
        Self { camera: camera.expect("a camera"), half_way: 0.5 * way, turns }
    }

    fn trunk() -> Placed {
        cuboid(Vector3::new(0.2, 0.3, 0.9), Isometry3::translation(0.0, -0.3, 0.95))
    }

    /// The mask at a time from -1 to 1.
    fn mask(&self, time: f64) -> GrayImage {
        let way = time * self.half_way;
        let (sin, cos) = if self.turns { (way / ARM).sin_cos() } else { (0.0, 1.0) };
        let lift = if self.turns { 0.0 } else { way };
        let shoulder = Point3::new(0.0, -0.15, 1.2 + lift);
        let along = Vector3::new(0.0, cos, sin);
        let pose = |distance: f64| {
            let turn = UnitQuaternion::rotation_between(&Vector3::z(), &along).unwrap_or_default();
            Isometry3::from_parts((shoulder + along * distance).coords.into(), turn)
        };
        let part = |solid, distance| Placed::new(solid, pose(distance), Texture::plain([200; 3]));
        let arm = part(Solid::capsule(0.015, ARM).expect("positive sizes"), 0.5 * ARM);
        let hand = part(Solid::sphere(0.05).expect("a positive radius"), ARM);
        coverage(&self.camera, &Subject::new(vec![Self::trunk(), arm, hand]))
    }

    fn data(&self) -> HullData {
        let data = HullData::new();
        data.add_view(self.camera.clone()).expect("the only view");
        let bounds = Aabb::new(Point3::new(-1.0, -1.0, 0.0), Point3::new(1.0, 1.0, 2.0)).expect("a volume");
        data.set_bounds(bounds).expect("a volume");
        data
    }

    /// The intersection over the union outside the trunk.
    fn overlap(&self, found: &GrayImage, truth: &GrayImage) -> f64 {
        let trunk = coverage(&self.camera, &Subject::new(vec![Self::trunk()]));
        let part = |mask: &GrayImage| -> Vec<bool> {
            mask.iter().zip(trunk.iter()).map(|(&byte, &trunk)| byte >= SUBJECT && trunk == 0).collect()
        };
        overlap(&part(found), &part(truth))
    }

    /// Draws a mask over the true one: right pixels white, missing ones blue, those too many orange.
    fn draw(&self, found: &GrayImage, truth: &GrayImage, name: &str) {
        let picture = RgbImage::from_fn(320, 240, |i, j| {
            let (i, j) = (i + 160, j + 60);
            let [found, truth] = [found, truth].map(|mask| mask.get_pixel(i, j).0[0] >= SUBJECT);
            Rgb(match (found, truth) {
                (true, true) => [255, 255, 255],
                (false, true) => [40, 110, 230],
                (true, false) => [240, 150, 40],
                (false, false) => [25, 25, 25],
            })
        });
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/motion");
        let written = std::fs::create_dir_all(&folder)
            .and_then(|()| picture.save(folder.join(name)).map_err(std::io::Error::other));
        if let Err(error) = written {
            eprintln!("{}: {error}", folder.display());
        }
    }
}

/// The mask of a hull's only view.
fn mask_of(hull: &Hull) -> GrayImage {
    let silhouette = hull.views()[0].silhouette();
    GrayImage::from_fn(640, 480, |i, j| Luma([silhouette.value(i as i32, j as i32)]))
}
