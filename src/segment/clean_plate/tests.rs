use super::*;
use crate::camera::Camera;
use crate::segment::testing::{area, coverage_error, overlap, painted};
use crate::synthetic::{Scene, Subject, add_noise, clean_plate, coverage, layout, render, silhouette};
use image::{GrayImage, Rgb};
use nalgebra::Point3;

fn cameras() -> Vec<Camera> {
    let target = Point3::new(0.0, 0.0, 0.9);
    layout::staggered(5, 3.5, &[0.9, 2.4, 1.5], target, (320, 240), 0.9).unwrap()
}

fn noisy(mut image: RgbImage, seed: u64) -> RgbImage {
    add_noise(&mut image, 3.0, seed).unwrap();
    image
}

/// The area of a rectangle of 20 x 40 pixels, without the corners, which the opening removes.
const RECTANGLE: f64 = 20.0 * 40.0 - 4.0;

/// A clean-up for images in which limbs are six pixels wide.
const SMALL: Cleanup = Cleanup {
    open_px: 1,
    close_px: 0,
    smallest_hole_px: 20,
    smallest_region_px: 40,
    smallest_region_share: 0.05,
    margin_px: 0,
};

/// The mask of a person, from an image and a clean plate with noise of 3 grey levels each.
fn segmented(camera: &Camera, scene: &Scene, seed: u64) -> GrayImage {
    let plate = noisy(clean_plate(camera, &scene.room), 2 * seed);
    let mut segmenter = CleanPlate::new(&plate, Thresholds::default()).unwrap().with_cleanup(SMALL).unwrap();
    segmenter.segment(&noisy(render(camera, scene), 2 * seed + 1)).unwrap()
}

fn plain(width: u32, height: u32) -> RgbImage {
    RgbImage::from_pixel(width, height, Rgb([90, 140, 100]))
}

#[test]
fn a_noisy_person_is_segmented_along_the_true_outline() {
    for (i, camera) in cameras().iter().enumerate() {
        let scene = Scene { subject: Subject::person_at(0.27 * i as f64), ..Scene::default() };
        let (mask, exact) = (segmented(camera, &scene, i as u64), silhouette(camera, &scene.subject));

        for (x, y, pixel) in exact.enumerate_pixels() {
            let is_same = (pixel.0[0] == 255) == (mask.get_pixel(x, y).0[0] >= 128);
            // All pixels of the 3x3 window are within 1.5 px.
            let at_outline =
                (-1i64..=1).flat_map(|dy| (-1i64..=1).map(move |dx| (dx, dy))).any(|(dx, dy)| {
                    let (x, y) = ((i64::from(x) + dx) as u32, (i64::from(y) + dy) as u32);
                    exact.get_pixel_checked(x, y).is_some_and(|other| other != pixel)
                });
            assert!(is_same || at_outline, "{}: pixel {x}, {y} is far from the outline", camera.name());
        }

        assert!(overlap(&mask, &exact) > 0.985, "{}: IoU {}", camera.name(), overlap(&mask, &exact));

        // A mask that is too wide by 0.1 px all around would gain about 1 %.
        let gain = area(&mask) / area(&exact) - 1.0;
        assert!(gain.abs() < 0.01, "{}: area gains {gain}", camera.name());
    }
}

#[test]
fn coverage_along_the_outline_is_the_covered_share_of_each_pixel() {
    let camera = &cameras()[0];
    let scene = Scene { subject: Subject::person_at(0.3), ..Scene::default() };
    let plate = clean_plate(camera, &scene.room);
    let segmenter = CleanPlate::new(&plate, Thresholds::default()).unwrap();
    let mask = segmenter.with_cleanup(SMALL).unwrap().segment(&render(camera, &scene)).unwrap();
    // A binary mask has a mean error of a quarter. Here the background is a mix of 3 x 3 rays, the subject's shading
    // varies towards its outline, and where two of its colours meet the nearest one is used.
    let error = coverage_error(&mask, &coverage(camera, &scene.subject));
    assert!(error < 0.1, "{error}");
}

#[test]
fn an_empty_scene_gives_an_empty_mask() {
    let mask = segmented(&cameras()[1], &Scene::default(), 77);
    assert!(mask.iter().all(|&value| value == 0));
}

#[test]
fn a_background_in_an_even_shadow_gives_an_empty_mask() {
    let room = clean_plate(&cameras()[1], &Scene::default().room);
    for (shadows, light) in [(Shadows::SOFT, 0.8), (Shadows::DEEP, 0.55)] {
        let mut shaded = room.clone();
        shaded.iter_mut().for_each(|value| *value = (f64::from(*value) * light) as u8);
        let segmenter = CleanPlate::new(&room, Thresholds::default()).unwrap();
        let mask = segmenter.clone().with_shadows(shadows).unwrap().segment(&shaded).unwrap();
        assert!(mask.iter().all(|&value| value == 0), "{light}");
        let mask = segmenter.with_shadows(None).unwrap().segment(&shaded).unwrap();
        assert!(mask.contains(&255), "without the test a shadow is the subject");
    }
}

#[test]
fn a_subject_of_another_hue_is_found_in_a_shadow() {
    let room = plain(80, 60);
    let shaded = RgbImage::from_pixel(80, 60, Rgb([63, 98, 70]));
    let image = painted(&shaded, 20, 10, 20, 40, [110, 60, 50]);
    let mut segmenter =
        CleanPlate::new(&room, Thresholds::default()).unwrap().with_shadows(Shadows::DEEP).unwrap();
    let mask = segmenter.segment(&image).unwrap();
    assert_eq!(area(&mask), RECTANGLE);
}

#[test]
fn noise_measured_from_several_frames_raises_a_pixels_tolerance() {
    // The left half flickers between 70 and 130 grey levels.
    let flicker = |up: bool| {
        RgbImage::from_fn(80, 60, |x, _| {
            Rgb([if x >= 40 {
                100
            } else if up {
                130
            } else {
                70
            }; 3])
        })
    };

    let empty = [flicker(true), flicker(false), flicker(true), flicker(false)];
    let mut learnt =
        CleanPlate::from_empty(&empty, Thresholds::default()).unwrap().with_shadows(None).unwrap();
    assert_eq!(area(&learnt.segment(&flicker(true)).unwrap()), 0.0);

    let mut single = CleanPlate::new(&empty[1], Thresholds::default()).unwrap().with_shadows(None).unwrap();
    assert!(area(&single.segment(&flicker(true)).unwrap()) > 2000.0);

    let subject = painted(&flicker(true), 50, 10, 20, 40, [130; 3]);
    assert_eq!(area(&learnt.segment(&subject).unwrap()), RECTANGLE, "the quiet half stays sensitive");
}

#[test]
fn refining_removes_a_person_from_the_plate_who_has_left() {
    let room = plain(120, 60);
    let plate = painted(&room, 5, 10, 15, 40, [200, 60, 50]);
    let frame = |k: u32| painted(&room, 30 + 9 * k, 10, 15, 40, [50, 60, 200]);
    let frames: Vec<_> = (0..6).map(frame).collect();

    let old = CleanPlate::new(&plate, Thresholds::default()).unwrap();
    let mask = old.clone().segment(&frames[2]).unwrap();
    assert_eq!(mask.get_pixel(12, 30).0, [255]);

    let mask = old.refined_with(&frames).unwrap().segment(&frames[2]).unwrap();
    assert_eq!((mask.get_pixel(12, 30).0, mask.get_pixel(55, 30).0), ([0], [255]));
    assert_eq!(area(&mask), 15.0 * 40.0 - 4.0);
}

#[test]
fn invalid_images_and_settings_are_refused_with_the_found_value() {
    let room = plain(40, 30);
    let error = |result: Result<CleanPlate>| result.unwrap_err().to_string();
    assert!(error(CleanPlate::from_empty(&[], Thresholds::default())).contains("found none"));
    let other = plain(30, 40);
    let sizes = error(CleanPlate::from_empty(&[room.clone(), other.clone()], Thresholds::default()));
    assert!(
        sizes.starts_with("expected an image of 40 x 30 pixels") && sizes.contains("found 30 x 40"),
        "{sizes}"
    );

    let nan = Thresholds { difference: f64::NAN, ..Thresholds::default() };
    assert!(error(CleanPlate::new(&room, nan)).contains("NaN"));
    let mut plate = CleanPlate::new(&room, Thresholds::default()).unwrap();
    assert!(plate.segment(&other).unwrap_err().to_string().contains("found 30 x 40"));

    let shadows = Shadows { darkest: f64::NAN, ..Shadows::default() };
    assert!(error(plate.clone().with_shadows(shadows)).contains("NaN"));
    let shadows = Shadows { hue_tolerance: -1.0, ..Shadows::default() };
    assert!(error(plate.clone().with_shadows(shadows)).contains("-1"));
    let cleanup = Cleanup { smallest_region_share: 2.0, ..Cleanup::default() };
    assert!(error(plate.clone().with_cleanup(cleanup)).contains("found 2"));
    assert!(error(plate.refined_with(&[room])).contains("found 1"));
}

#[test]
fn an_image_without_pixels_gives_a_mask_without_pixels() {
    let mut plate = CleanPlate::new(&RgbImage::new(0, 0), Thresholds::default()).unwrap();
    assert_eq!(plate.segment(&RgbImage::new(0, 0)).unwrap().dimensions(), (0, 0));
}
