//! `vhull synth`: recordings of a synthetic subject.

use super::{folder, studio, vhull};
use ode_visual_hull::recording::{Recording, StreamOptions};

#[test]
fn a_recording_has_images_backgrounds_and_masks() {
    let folder = studio("synth_all", "ring");
    let recording = Recording::open(folder.join("studio")).unwrap();
    assert_eq!((recording.rig().len(), recording.frames()), (5, &[0, 1, 2][..]));
    let times = recording.frame_times(&StreamOptions::default()).unwrap();
    assert_eq!(times, Some(vec![0.0, 0.033333, 0.066667]));

    // The images differ from the background where the mask is set, and by noise elsewhere.
    let (images, masks) = (recording.images(2).unwrap(), recording.masks(2).unwrap());
    let plate = recording.background(4).unwrap();
    let (mut inside, mut outside) = ((0.0, 0), (0.0, 0));
    for (x, y, mask) in masks[4].enumerate_pixels() {
        let [a, b] = [images[4].get_pixel(x, y), plate.get_pixel(x, y)];
        let difference: f64 = (0..3).map(|c| f64::from(a.0[c].abs_diff(b.0[c]))).sum();
        match mask.0[0] {
            0 => outside = (outside.0 + difference, outside.1 + 1),
            255 => inside = (inside.0 + difference, inside.1 + 1),
            _ => {}
        }
    }

    let (inside, outside) = (inside.0 / f64::from(inside.1), outside.0 / f64::from(outside.1));
    // Noise of 2 grey levels in both images differs by 4 / sqrt(pi) on average, over three channels by 6.8.
    assert!(inside > 60.0 && outside < 12.0, "{inside} {outside}");
}

#[test]
fn equal_seeds_give_equal_recordings_and_masks_can_be_left_out() {
    let folder = folder("synth_seed");
    for (name, seed) in [("a", "3"), ("b", "3"), ("c", "4")] {
        let words = [
            "synth",
            name,
            "--cameras",
            "2",
            "--frames",
            "1",
            "--size",
            "64x48",
            "--seed",
            seed,
            "--no-masks",
        ];
        assert_eq!(vhull(&folder, &words).code, 0);
    }

    let file = |name: &str| std::fs::read(folder.join(name).join("cam1/image/000000.png")).unwrap();
    assert_eq!(file("a"), file("b"));
    assert_ne!(file("a"), file("c"));
    assert!(Recording::open(folder.join("a")).unwrap().frames().is_empty());
    let run = vhull(&folder, &["check", "a"]);
    assert!(run.code == 1 && run.error.contains("make them first: vhull segment a"), "{}", run.error);
}

#[test]
fn existing_recordings_are_kept_and_invalid_numbers_are_refused() {
    let folder = studio("synth_wrong", "ball");
    let again = vhull(&folder, &["synth", "studio"]);
    assert!(again.code == 1 && again.error.contains("choose another folder"), "{}", again.error);
    assert_eq!(vhull(&folder, &["synth", "other", "--cameras", "0"]).code, 2);
    assert_eq!(vhull(&folder, &["synth", "other", "--size", "0x10"]).code, 2);
    assert_eq!(vhull(&folder, &["synth", "other", "--noise", "-1"]).code, 2);
    let noisy = vhull(&folder, &["synth", "other", "--noise", "1000"]);
    assert!(noisy.code == 1 && noisy.error.contains("--noise"), "{}", noisy.error);
    assert!(!folder.join("other").exists());
}
