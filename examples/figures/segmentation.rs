//! The figures of segmentation: real captures compared with the masks that came with them, and synthetic images
//! compared with exact silhouettes.

use image::{GrayImage, RgbImage, imageops};
use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{HullData, Unseen};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::{Calibration, Hints, Rig};
use ode_visual_hull::segment::{CleanPlate, Cleanup, Segmenter, Shadows, Thresholds};
use ode_visual_hull::silhouette::PackedMask;
use ode_visual_hull::source::{ReadOptions, Source, Video};
use ode_visual_hull::synthetic::{Scene, Subject, add_noise, clean_plate, layout, render_over, silhouette};
use ode_visual_hull_testing::captures::{self, DINO, SEATED, carve, dino_cameras};
use ode_visual_hull_testing::figure::{Bound, Figure};
use std::path::Path;
use std::sync::Arc;

/// Frames of the background that a plate is made of.
const EMPTY_FRAMES: u32 = 24;

/// The figures of all captures that are present, and of the synthetic studio.
pub fn run_group(progress: &dyn Fn(&str)) -> Vec<Figure> {
    let (mut figures, mut coded) = (Vec::new(), Vec::new());
    for (name, capture) in
        [("seated_person", seated as Capture), ("balancing_person", balancing), ("dino", dino)]
    {
        if let Some(dir) = captures::find(name) {
            progress(name);
            figures.extend(capture(&dir, &mut coded));
        }
    }

    figures.extend(coded_sizes(&coded));
    progress("a moving shadow");
    figures.push(Figure::bounded("segment_iou_mean", moving_shadow(), Bound::AtLeast(0.98)));

    figures
}

/// Measures the capture in a folder, and appends the size of its masks as run lengths.
type Capture = fn(&Path, &mut Vec<Coded>) -> Vec<Figure>;

/// Mean size of the masks of a capture as run lengths, in bytes.
struct Coded {
    binary: f64,
    with_coverage: f64,
}

impl Coded {
    fn of<'a>(masks: impl Iterator<Item = &'a GrayImage>) -> Self {
        let lengths: Vec<_> = masks
            .map(|mask| {
                let packed = PackedMask::new(mask);
                let coded = packed.encode().expect("a mask of this size");
                assert_eq!(PackedMask::decode(&coded).expect("what was coded"), packed);
                [packed.encode_binary().expect("a mask of this size").len() as f64, coded.len() as f64]
            })
            .collect();
        let mean = |k: usize| mean(&lengths.iter().map(|length| length[k]).collect::<Vec<_>>());
        Self { binary: mean(0), with_coverage: mean(1) }
    }
}

/// The figures of the size of seven masks as run lengths, from the means over the captures of a person.
fn coded_sizes(captures: &[Coded]) -> Vec<Figure> {
    if captures.is_empty() {
        return Vec::new();
    }
    let seven = |length: fn(&Coded) -> f64| 7.0 * mean(&captures.iter().map(length).collect::<Vec<_>>());
    vec![
        Figure::bounded("rle_bytes_vga_binary", seven(|coded| coded.binary), Bound::AtMost(10_000.0)),
        Figure::bounded(
            "rle_bytes_vga_coverage",
            seven(|coded| coded.with_coverage),
            Bound::AtMost(22_000.0),
        ),
    ]
}

/// A man on a chair, with videos of the background, the lenses of the XML files, and poses that were estimated
/// anew. The masks that came with the capture are a little wide, and contain the shadow beneath the chair.
fn seated(dir: &Path, coded: &mut Vec<Coded>) -> Vec<Figure> {
    let recording = Recording::open(dir).expect("a recording");
    let cameras = seated_cameras(dir, recording.rig());
    let frames = recording.image_frames();

    let clips = |camera: &Camera| {
        let clip = |name, frames: &[u32]| {
            decoded(&dir.join("original").join(camera.name()).join(name), camera.size(), frames)
        };
        let empty = clip("background.avi", &(0..EMPTY_FRAMES).collect::<Vec<_>>());
        let plate = CleanPlate::from_empty(&empty, Thresholds::default()).expect("thresholds in range");
        (plate, clip("video.avi", frames))
    };
    let (mut segmenters, clips): (Vec<_>, Vec<_>) = cameras.iter().map(clips).unzip();

    let (mut overlaps, mut volume, mut found) = (Vec::new(), f64::NAN, Vec::new());

    for (k, &frame) in frames.iter().enumerate() {
        let images: Vec<_> = clips.iter().map(|clip| clip[k].clone()).collect();
        let masks = segment(&mut segmenters, &images);
        overlaps.extend(compare(&masks, &recording.masks(frame).expect("masks")));
        found.extend(masks.clone());
        if frame == 0 {
            let data = hull_data(cameras.iter().cloned().zip(masks));
            data.set_bounds(SEATED).expect("a volume");
            volume = carve(&data.update(0.0).expect("masks in all views"), 0.02).0;
        }
    }

    coded.push(Coded::of(found.iter()));
    vec![
        Figure::bounded("seated_iou_mean", mean(&overlaps), Bound::AtLeast(0.93)),
        Figure::bounded("seated_volume_m3", volume, Bound::Between(0.95 * 0.233, 1.05 * 0.233)),
    ]
}

/// Cameras with the poses of `refined` and the lenses of the XML files, whose unit is a millimetre.
fn seated_cameras(dir: &Path, refined: &Rig) -> Vec<Camera> {
    let size = refined.cameras()[0].size();
    let hints = Hints { size: Some(size), metres_per_unit: Some(1e-3) };
    let lenses = Calibration::load(dir.join("original"), &hints).expect("a calibration").rig;
    let camera = |refined: &Camera| {
        let lens = &lenses.cameras()[lenses.index_of(refined.name()).expect("the same cameras")];
        let pose = *refined.cam_from_world();
        Camera::new(refined.name(), size, *lens.intrinsics(), *lens.lens(), pose).expect("a camera")
    };
    refined.cameras().iter().map(camera).collect()
}

/// The frames of a video whose numbers are in `frames`, in ascending order.
fn decoded(path: &Path, size: (u32, u32), frames: &[u32]) -> Vec<RgbImage> {
    let mut video = Video::open(path, ReadOptions { size: Some(size), ..ReadOptions::default() })
        .expect("a video, and ffmpeg");
    let all = std::iter::from_fn(|| video.next_frame()).map(|frame| frame.expect("a whole video"));
    let wanted: Vec<_> = all.filter(|frame| frames.contains(&frame.number)).take(frames.len()).collect();
    assert_eq!(wanted.len(), frames.len(), "{}", path.display());
    wanted.into_iter().map(|frame| Arc::unwrap_or_clone(frame.image)).collect()
}

/// A person who balances in a crowded laboratory. The only photograph of the background shows another person, so that
/// the plate is refined with frames of the recording.
fn balancing(dir: &Path, coded: &mut Vec<Coded>) -> Vec<Figure> {
    let recording = Recording::open(dir).expect("a recording");
    let frames: Vec<_> = recording.image_frames().iter().map(|&frame| images(&recording, frame)).collect();
    let photographs = recording.rig().cameras().iter().map(|camera| {
        let path = dir.join(format!("original/{}_ext.png", camera.name()));
        let photograph = image::open(path).expect("a photograph").into_rgb8();
        imageops::thumbnail(&photograph, camera.size().0, camera.size().1)
    });

    let refined = photographs.enumerate().map(|(view, photograph)| {
        let frames: Vec<_> = frames.iter().map(|images| images[view].clone()).collect();
        default_plate(&photograph).refined_with(&frames).expect("ten frames")
    });
    let (mut refined, mut unrefined): (Vec<_>, Vec<_>) =
        (refined.collect(), backgrounds(&recording).iter().map(default_plate).collect());

    let overlap = |segmenters: &mut [CleanPlate]| {
        let frames = recording.image_frames().iter().zip(&frames);
        let overlaps = frames.flat_map(|(&frame, images)| {
            compare(&segment(segmenters, images), &recording.masks(frame).expect("masks"))
        });
        mean(&overlaps.collect::<Vec<_>>())
    };

    let found: Vec<_> = frames.iter().flat_map(|images| segment(&mut refined, images)).collect();
    coded.push(Coded::of(found.iter()));

    vec![
        Figure::bounded("balancing_iou_mean", overlap(&mut refined), Bound::AtLeast(0.85)),
        Figure::reported("balancing_plate_with_ghost_iou_mean", overlap(&mut unrefined)),
    ]
}

/// A plaster dinosaur in front of a black background, lit from one side.
fn dino(dir: &Path, _: &mut Vec<Coded>) -> Vec<Figure> {
    let views = dino_cameras(dir).into_iter().map(|(number, camera)| {
        let image =
            image::open(dir.join(format!("image/dinoSR{number:04}.png"))).expect("an image").into_rgb8();
        let mask = black_background(image.dimensions()).segment(&image).expect("an image of that size");
        (camera, mask)
    });

    let data = hull_data(views);
    data.set_unseen(Unseen::ABSTAIN).expect("a policy");
    data.set_bounds(DINO.grown(0.008)).expect("a volume");

    let (volume, aabb) = carve(&data.update(0.0).expect("masks in all views"), 0.001);
    // All cameras look down, so that the hull ends in a wedge below the box of the dinosaur. Points up to 6.5 mm
    // below the box project to bright pixels in every view, so that exact silhouettes contain them too.
    let (below, above) = ((DINO.min - aabb.min) * 1e3, (aabb.max - DINO.max) * 1e3);
    let five_sides = below.x.max(below.z).max(above.max());

    vec![
        Figure::bounded("dino_volume_e4_m3", 1e4 * volume, Bound::Between(0.97 * 1.28, 1.03 * 1.28)),
        Figure::bounded("dino_beyond_five_sides_of_its_box_mm", five_sides, Bound::AtMost(2.0)),
        Figure::reported("dino_beyond_its_box_towards_minus_y_mm", below.y),
    ]
}

/// A segmenter for a black background, by the method that came with the images: the threshold is 0.19, and the result
/// is dilated by 10 pixels and eroded by 7.
fn black_background((width, height): (u32, u32)) -> CleanPlate {
    let thresholds = Thresholds { difference: 0.19 * 255.0, ..Thresholds::default() };
    let cleanup = Cleanup {
        close_px: 7,
        margin_px: 3,
        smallest_hole_px: 10_000,
        smallest_region_share: 1.0,
        ..Cleanup::default()
    };
    CleanPlate::new(&RgbImage::new(width, height), thresholds)
        .and_then(|plate| plate.with_shadows(None))
        .and_then(|plate| plate.with_cleanup(cleanup))
        .expect("numbers in range")
}

/// The mean overlap with exact silhouettes of a walking person, with noise of 3 grey levels and a soft shadow that
/// moves over the background.
fn moving_shadow() -> f64 {
    let target = Point3::new(0.0, 0.0, 0.9);

    let cameras = layout::staggered(5, 3.5, &[0.9, 2.4, 1.5], target, (640, 480), 0.9).expect("a layout");
    let mut overlaps = Vec::new();
    for (view, camera) in cameras.iter().enumerate() {
        let background = clean_plate(camera, &Scene::default().room);
        let empty: Vec<_> = (0..5).map(|k| noisy(&background, 1000 + 10 * view as u64 + k)).collect();

        let mut segmenter = CleanPlate::from_empty(&empty, Thresholds::default())
            .and_then(|plate| plate.with_shadows(Shadows::DEEP))
            .expect("frames of one size");

        for frame in 0..6u32 {
            let time = 0.23 * f64::from(frame);
            let shaded = shade(&background, camera, time, 0.30 + 0.03 * f64::from(frame));
            let scene = Scene { subject: Subject::person_at(time), ..Scene::default() };

            let image = render_over(camera, &scene, &shaded).expect("a background of the camera's size");
            let mask =
                segmenter.segment(&noisy(&image, 100 * view as u64 + u64::from(frame))).expect("a size");
            overlaps.push(overlap(&mask, &silhouette(camera, &scene.subject)));
        }
    }

    mean(&overlaps)
}

/// The background with a soft shadow beside the subject, which moves with time and darkens by the share `depth`.
fn shade(background: &RgbImage, camera: &Camera, time: f64, depth: f64) -> RgbImage {
    let centre = Point3::origin() + Vector3::new((2.0 * time).cos(), (2.0 * time).sin(), 0.0) * 0.5;
    let centre = camera.project(&centre).expect("in front of every camera");

    let mut shaded = background.clone();
    for (x, y, pixel) in shaded.enumerate_pixels_mut() {
        let (dx, dy) = ((f64::from(x) - centre.u) / 140.0, (f64::from(y) - centre.v) / 70.0);
        // Constant in the middle, and smooth at the border.
        let inside = (1.5 - dx.hypot(dy)).clamp(0.0, 1.0);
        let light = 1.0 - depth * inside * inside * (3.0 - 2.0 * inside);
        pixel.0 = pixel.0.map(|value| (f64::from(value) * light).round() as u8);
    }
    shaded
}

fn noisy(image: &RgbImage, seed: u64) -> RgbImage {
    let mut image = image.clone();
    add_noise(&mut image, 3.0, seed).expect("a deviation");
    image
}

fn default_plate(plate: &RgbImage) -> CleanPlate {
    CleanPlate::new(plate, Thresholds::default()).expect("thresholds in range")
}

fn backgrounds(recording: &Recording) -> Vec<RgbImage> {
    let views = 0..recording.rig().len();
    views.map(|view| recording.background(view).expect("a background")).collect()
}

fn images(recording: &Recording, frame: u32) -> Vec<RgbImage> {
    recording.images(frame).expect("images")
}

fn segment(segmenters: &mut [CleanPlate], images: &[RgbImage]) -> Vec<GrayImage> {
    let pairs = segmenters.iter_mut().zip(images);
    pairs.map(|(segmenter, image)| segmenter.segment(image).expect("an image of the plate's size")).collect()
}

fn hull_data(views: impl Iterator<Item = (Camera, GrayImage)>) -> HullData {
    let data = HullData::new();
    for (camera, mask) in views {
        let view = data.add_view(camera).expect("names of their own");
        data.set_mask(view, &mask).expect("a mask of the camera's size");
    }
    data
}

fn compare<'a>(masks: &'a [GrayImage], expected: &'a [GrayImage]) -> Vec<f64> {
    masks.iter().zip(expected).map(|(mask, expected)| overlap(mask, expected)).collect()
}

/// Intersection over union of two masks.
fn overlap(mask: &GrayImage, expected: &GrayImage) -> f64 {
    let pairs = mask.iter().zip(expected.iter()).map(|(&a, &b)| (a >= 128, b >= 128));
    let both = pairs.clone().filter(|&(a, b)| a && b).count();
    both as f64 / pairs.filter(|&(a, b)| a || b).count() as f64
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
