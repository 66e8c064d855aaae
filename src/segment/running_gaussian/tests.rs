use super::*;
use crate::segment::testing::{area, painted};
use crate::synthetic::add_noise;
use image::Rgb;

fn background(light: f64) -> RgbImage {
    RgbImage::from_pixel(100, 70, Rgb([90.0, 140.0, 100.0].map(|c| (c * light) as u8)))
}

fn noisy(mut image: RgbImage, seed: u64) -> RgbImage {
    add_noise(&mut image, 3.0, seed).unwrap();
    image
}

/// A model that has learnt the empty scene from 25 frames.
fn learnt(learning: Learning) -> RunningGaussian {
    let mut segmenter = RunningGaussian::new(learning).unwrap();
    (0..25).for_each(|k| segmenter.learn(&noisy(background(1.0), k)).unwrap());
    segmenter
}

#[test]
fn an_empty_scene_gives_an_empty_mask_and_a_subject_is_found() {
    let mut segmenter = learnt(Learning::default());
    assert_eq!(area(&segmenter.segment(&noisy(background(1.0), 100)).unwrap()), 0.0);
    let image = noisy(painted(&background(1.0), 30, 20, 20, 40, [200, 60, 50]), 101);
    let mask = segmenter.segment(&image).unwrap();
    assert!((area(&mask) - 20.0 * 40.0).abs() <= 8.0, "the opening removes the corners: {}", area(&mask));
}

#[test]
fn a_slow_fade_is_followed_and_a_sudden_change_is_not() {
    let learning = Learning { history: 50, detect_shadows: false, ..Learning::default() };
    let mut segmenter = learnt(learning);
    let fade = |k: u32| 1.0 - 0.4 * f64::from(k) / 800.0;
    for k in 0..800 {
        let mask = segmenter.segment(&noisy(background(fade(k)), 200 + u64::from(k))).unwrap();
        assert_eq!(area(&mask), 0.0, "frame {k}");
    }
    assert!(area(&learnt(learning).segment(&background(0.6)).unwrap()) > 6000.0);
}

#[test]
fn a_subject_that_sits_still_does_not_fade() {
    let mut segmenter = learnt(Learning { history: 20, ..Learning::default() });
    let image = painted(&background(1.0), 30, 20, 20, 40, [200, 60, 50]);
    let areas = (0..300).map(|k| area(&segmenter.segment(&noisy(image.clone(), k)).unwrap()));
    assert!(areas.last().unwrap() > 790.0);
}

#[test]
fn invalid_settings_and_images_are_refused_with_the_found_value() {
    let error = |learning| RunningGaussian::new(learning).unwrap_err().to_string();
    assert!(error(Learning { history: 0, ..Learning::default() }).contains("found 0"));
    assert!(error(Learning { var_threshold: f64::NAN, ..Learning::default() }).contains("NaN"));

    let mut segmenter = RunningGaussian::new(Learning::default()).unwrap();
    assert!(
        segmenter.segment(&background(1.0)).unwrap_err().to_string().contains("found none; call learn first")
    );
    assert!(segmenter.learn(&RgbImage::new(0, 0)).unwrap_err().to_string().contains("without pixels"));

    segmenter.learn(&background(1.0)).unwrap();
    let other = RgbImage::new(70, 100);
    for result in [segmenter.learn(&other), segmenter.segment(&other).map(drop)] {
        assert!(result.unwrap_err().to_string().contains("found 70 x 100"));
    }
}
