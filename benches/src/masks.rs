//! Masks as a program gets them from its cameras: noisy colour images, segmented against the background.

use image::{GrayImage, RgbImage};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::segment::{CleanPlate, Segmenter, Thresholds};
use ode_visual_hull::silhouette::SUBJECT;
use ode_visual_hull::synthetic::{Room, Scene, Subject, add_noise, clean_plate, render_over};

/// Standard deviation of the images' noise in grey levels, as of a usual camera indoors.
const NOISE: f64 = 3.0;

/// One silhouette of `subject` per camera, segmented with a clean plate: with coverage along the outline, and with
/// specks and gaps cleaned up.
pub fn segmented(cameras: &[Camera], subject: &Subject) -> Vec<GrayImage> {
    let scene = Scene { subject: subject.clone(), room: Room::default() };
    (0..).zip(cameras).map(|(seed, camera)| silhouette(camera, &scene, seed)).collect()
}

/// The mask with 255 at each subject pixel and 0 elsewhere.
pub fn binary(mask: &GrayImage) -> GrayImage {
    let mut mask = mask.clone();
    mask.iter_mut().for_each(|byte| *byte = if *byte >= SUBJECT { 255 } else { 0 });
    mask
}

fn silhouette(camera: &Camera, scene: &Scene, seed: u64) -> GrayImage {
    let noisy = |mut image: RgbImage, seed: u64| {
        add_noise(&mut image, NOISE, seed).expect("a deviation");
        image
    };

    let background = clean_plate(camera, &scene.room);
    let image = render_over(camera, scene, &background).expect("a clean plate of the camera's size");

    // The background and the image are two exposures with independent noise.
    let empty = noisy(background, 2 * seed + 1);
    let mut plate = CleanPlate::new(&empty, Thresholds::default()).expect("thresholds in range");
    plate.segment(&noisy(image, 2 * seed)).expect("an image of the clean plate's size")
}
