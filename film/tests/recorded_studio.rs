//! A studio that is recorded, and its recording played again.

use nalgebra::{Isometry3, Point3, Vector3};
use ode_visual_hull::Result;
use ode_visual_hull::hull::{Aabb, Hull, HullData, Motion};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, clean_plate, layout};
use ode_visual_hull_film::{
    FRAME_RATE, FrameTimes, Frames, Playback, STEPS_PER_SECOND, Scenario, Story, Studio, VolumeOptions,
};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Frames that are recorded, and steps of the simulation meanwhile.
const FRAMES: usize = 8;
const STEPS: usize = FRAMES * (STEPS_PER_SECOND / FRAME_RATE) as usize;

/// A red ball that keeps still for a tenth of a second and then moves along x at 1 m/s.
struct Ball;

impl Ball {
    fn centre(time: f64) -> Point3<f64> {
        Point3::new((time - 0.1).max(0.0), 0.0, 0.5)
    }
}

impl Scenario for Ball {
    fn name(&self) -> &str {
        "ball"
    }

    fn subject(&self, time: f64) -> Result<Subject> {
        let pose = Isometry3::from(Self::centre(time).coords);
        Ok(Subject::new(vec![Placed::new(Solid::sphere(0.3)?, pose, Texture::plain([190, 40, 30]))]))
    }

    fn top(&self, _: f64) -> Option<f64> {
        None
    }

    fn still_until(&self) -> f64 {
        0.1
    }

    fn end(&self) -> f64 {
        FRAMES as f64 / FRAME_RATE
    }

    fn moments(&self) -> [f64; 3] {
        [0.0, 0.1, 0.2]
    }
}

fn bounds() -> Aabb {
    Aabb::new(Point3::new(-0.6, -0.6, 0.0), Point3::new(0.9, 0.6, 1.2)).unwrap()
}

fn studio(data: &Arc<HullData>) -> Studio<Ball> {
    let cameras = layout::ring(4, 3.0, 0.8, Point3::new(0.1, 0.0, 0.5), (160, 120), 0.8).unwrap();
    Studio::new(Ball, cameras, bounds(), 1, data).unwrap()
}

/// Path of a folder for a test, which does not exist.
fn folder(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("recorded_studio").join(name);
    let _ = std::fs::remove_dir_all(&dir);
    dir
}

/// The hulls of all steps, held and interpolated.
fn hulls(capture: &mut impl Frames, data: &HullData) -> Vec<[Arc<Hull>; 2]> {
    let hulls_at = |step: usize| {
        let time = step as f64 / STEPS_PER_SECOND;
        capture.publish(time, data).unwrap();
        [Motion::Held, Motion::Interpolated].map(|motion| data.in_motion(motion, time).unwrap())
    };
    (0..STEPS).map(hulls_at).collect()
}

#[test]
fn a_recording_of_a_studio_has_its_cameras_masks_times_and_images_without_noise() {
    let (dir, data) = (folder("whole"), Arc::new(HullData::new()));
    let mut studio = studio(&data);
    studio.record(&dir).unwrap();
    hulls(&mut studio, &data);
    let last_masks = data.latest().unwrap().1;

    let recording = Recording::open(&dir).unwrap();
    let expected: Vec<u32> = (0..FRAMES as u32).collect();
    assert_eq!((recording.frames(), recording.image_frames()), (&expected[..], &expected[..]));
    let times = FrameTimes::of(&recording, None).unwrap();
    assert!(!times.is_assumed);
    for (k, time) in times.times.iter().enumerate() {
        // The table has microseconds.
        assert!((time - k as f64 / FRAME_RATE).abs() < 1e-6, "{time}");
    }

    let masks = recording.masks(FRAMES as u32 - 1).unwrap();
    for (mask, view) in masks.iter().zip(last_masks.views()) {
        assert!(mask.pixels().any(|pixel| pixel.0[0] == 255));
        for (x, y, pixel) in mask.enumerate_pixels() {
            let published = view.silhouette().value(x as i32, y as i32);
            // A silhouette drops coverage below one half far from the subject.
            let found = pixel.0[0];
            assert!(found == published || found < 128 && published == 0, "{x}, {y}: {found}, {published}");
        }
    }

    let room = Default::default();
    for (k, camera) in studio.cameras().iter().enumerate() {
        let plate = clean_plate(camera, &room);
        assert_eq!(recording.background(k).unwrap(), plate);
        // The ball is small in these images: without noise most pixels are the background's.
        let image = &recording.images(0).unwrap()[k];
        let same = image.pixels().zip(plate.pixels()).filter(|(a, b)| a == b).count();
        assert!(same * 2 > (plate.width() * plate.height()) as usize, "{same} pixels");
    }
}

#[test]
fn a_recorded_studio_plays_again_with_the_same_hull_at_the_same_time() {
    let (dir, data) = (folder("again"), Arc::new(HullData::new()));
    let mut studio = studio(&data);
    assert_eq!(studio.playback(), None);
    studio.record(&dir).unwrap();
    let in_studio = hulls(&mut studio, &data);
    let options = studio.playback().unwrap();
    assert_eq!((options.frames.clone(), options.wait, options.rate), (Some(0..FRAMES as u32), 0.0, None));

    let data = HullData::new();
    let mut playback = Playback::new(Recording::open(&dir).unwrap(), &dir, &options, &data).unwrap();
    assert_eq!(Story::frames(&playback), FRAMES);
    assert_eq!(playback.playback(), Some(options));
    let played = hulls(&mut playback, &data);
    for (step, (studio, played)) in in_studio.iter().zip(&played).enumerate() {
        for (a, b) in studio.iter().zip(played) {
            // The table of times has microseconds.
            assert!((a.time() - b.time()).abs() < 2e-6, "step {step}: {} s, {} s", a.time(), b.time());
            for k in 0..1000 {
                let cell = Vector3::new((k % 10) as f64, (k / 10 % 10) as f64, (k / 100) as f64);
                let point = bounds().min + (bounds().max - bounds().min).component_mul(&cell) * 0.1;
                assert_eq!(a.inside(&point), b.inside(&point), "step {step} at {point}");
            }
        }
    }
}

#[test]
fn a_recording_leaves_work_volume_and_frames_to_its_options_as_resolved() {
    let (dir, data) = (folder("resolved"), Arc::new(HullData::new()));
    let mut studio = studio(&data);
    studio.record(&dir).unwrap();
    hulls(&mut studio, &data);

    let recording = Recording::open(&dir).unwrap();
    let volume = recording.rig().work_volume().unwrap();
    let playback = Playback::new(recording, &dir, &Default::default(), &HullData::new()).unwrap();
    let resolved = playback.playback().unwrap();
    assert_eq!(resolved.frames, Some(0..FRAMES as u32));
    assert_eq!(resolved.volume, VolumeOptions { bounds: Some(volume), ..VolumeOptions::default() });
}

#[test]
fn a_folder_with_a_recording_is_not_recorded_over() {
    let (dir, data) = (folder("twice"), Arc::new(HullData::new()));
    studio(&data).record(&dir).unwrap();
    let message = studio(&Arc::new(HullData::new())).record(&dir).unwrap_err().to_string();
    assert!(message.contains("expected a folder without a recording"), "{message}");
}
