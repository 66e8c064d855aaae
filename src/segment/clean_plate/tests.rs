use super::*;
use crate::camera::Camera;
use crate::synthetic::{Scene, Subject, add_noise, clean_plate, layout, render, silhouette};
use image::Rgb;
use nalgebra::Point3;

fn cameras() -> Vec<Camera> {
    let target = Point3::new(0.0, 0.0, 0.9);
    layout::staggered(5, 3.5, &[0.9, 2.4, 1.5], target, (320, 240), 0.9).unwrap()
}

/// A person as a camera with noise of 3 grey levels sees them, cut out against a clean plate with the same noise.
fn segmented(camera: &Camera, scene: &Scene, seed: u64) -> GrayImage {
    let (mut plate, mut image) = (clean_plate(camera, &scene.room), render(camera, scene));
    add_noise(&mut plate, 3.0, 2 * seed).unwrap();
    add_noise(&mut image, 3.0, 2 * seed + 1).unwrap();
    CleanPlate::new(plate, Thresholds::default()).subtract(&image).unwrap()
}

#[test]
fn a_noisy_person_is_cut_out_along_the_true_outline() {
    for (i, camera) in cameras().iter().enumerate() {
        let scene = Scene { subject: Subject::person_at(0.27 * i as f64), ..Scene::default() };
        let (mask, exact) = (segmented(camera, &scene, i as u64), silhouette(camera, &scene.subject));
        let (mut both, mut either, mut gain) = (0.0, 0.0, 0.0);
        for (x, y, pixel) in exact.enumerate_pixels() {
            let (a, b) = (pixel.0[0] == 255, mask.get_pixel(x, y).0[0] == 255);
            both += f64::from(u8::from(a && b));
            either += f64::from(u8::from(a || b));
            gain += f64::from(u8::from(b)) - f64::from(u8::from(a));
            // Of the 3x3 around, all are within 1.5 px.
            let at_outline =
                (-1i64..=1).flat_map(|dy| (-1i64..=1).map(move |dx| (dx, dy))).any(|(dx, dy)| {
                    let (x, y) = ((i64::from(x) + dx) as u32, (i64::from(y) + dy) as u32);
                    exact.get_pixel_checked(x, y).is_some_and(|other| other != pixel)
                });
            assert!(a == b || at_outline, "{}: pixel {x}, {y} is far from the outline", camera.name());
        }
        // A mask too wide by 0.1 px all around would gain about 1 %.
        assert!((gain / both).abs() < 0.01, "{}: area gains {}", camera.name(), gain / both);
        assert!(both / either > 0.98 && either > 3000.0, "{}: IoU {}", camera.name(), both / either);
    }
}

#[test]
fn an_empty_room_gives_an_empty_mask() {
    let mask = segmented(&cameras()[1], &Scene::default(), 77);
    assert!(mask.iter().all(|&value| value == 0));
}

#[test]
fn specks_go_and_holes_close_by_their_area() {
    let room = RgbImage::from_pixel(60, 60, Rgb([90, 140, 100]));
    let mut image = room.clone();
    let mut paint = |left: u32, top: u32, size: u32, colour: [u8; 3]| {
        for (x, y) in (left..left + size).flat_map(|x| (top..top + size).map(move |y| (x, y))) {
            image.put_pixel(x, y, Rgb(colour));
        }
    };
    let subject = [200, 60, 50];
    paint(20, 20, 30, subject);
    paint(2, 2, 3, subject); // a speck of 9
    paint(22, 22, 3, [90, 140, 100]); // a hole of 9
    paint(35, 35, 8, [90, 140, 100]); // a hole of 64
    let thresholds = Thresholds { smallest_region_px: 10, smallest_hole_px: 10, ..Thresholds::default() };
    let mask = CleanPlate::new(room.clone(), thresholds).subtract(&image).unwrap();
    let at = |x: u32, y: u32| mask.get_pixel(x, y).0[0];
    assert_eq!([at(30, 30), at(3, 3), at(23, 23), at(38, 38)], [255, 0, 255, 0]);
    let keep = Thresholds { smallest_region_px: 9, smallest_hole_px: 9, ..Thresholds::default() };
    let mask = CleanPlate::new(room, keep).subtract(&image).unwrap();
    let at = |x: u32, y: u32| mask.get_pixel(x, y).0[0];
    assert_eq!([at(3, 3), at(23, 23)], [255, 0], "regions of just that area stay");
}

#[test]
fn an_image_of_another_size_is_refused() {
    let plate = CleanPlate::new(RgbImage::new(40, 30), Thresholds::default());
    let error = plate.subtract(&RgbImage::new(30, 40)).unwrap_err().to_string();
    assert!(
        error.starts_with("expected an image of 40 x 30 pixels, the size of the clean plate, found 30 x 40")
    );
}
