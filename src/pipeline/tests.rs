use super::*;
use crate::hull::Aabb;
use crate::segment::{CleanPlate, Thresholds};
use crate::synthetic::{Scene, Subject, add_noise, clean_plate, layout, render_over};
use image::{GrayImage, RgbImage};
use nalgebra::{Point3, point};
use std::sync::LazyLock;
use std::time::Duration;

const SIZE: (u32, u32) = (160, 120);

/// A segmenter that calls a closure.
struct Segment<F>(F);

impl<F: FnMut(&RgbImage, &mut PackedMask) -> Result<()> + Send + Sync> Segmenter for Segment<F> {
    fn segment_packed(&mut self, image: &RgbImage, mask: &mut PackedMask) -> Result<()> {
        (self.0)(image, mask)
    }
}

fn cameras() -> Vec<Camera> {
    layout::staggered(4, 3.5, &[0.9, 2.0, 1.4], Point3::new(0.0, 0.0, 0.9), SIZE, 0.9).unwrap()
}

/// A camera's image of the empty scene, rendered once for all tests.
fn empty_room(camera: &Camera) -> &'static RgbImage {
    static ROOMS: LazyLock<Vec<(Camera, RgbImage)>> = LazyLock::new(|| {
        let room = |camera: Camera| {
            let image = clean_plate(&camera, &Scene::default().room);
            (camera, image)
        };
        cameras().into_iter().map(room).collect()
    });
    &ROOMS.iter().find(|(other, _)| other == camera).unwrap().1
}

fn data(cameras: &[Camera]) -> Arc<HullData> {
    let data = HullData::new();
    data.add_views(cameras).unwrap();
    data.set_bounds(Aabb::new(point![-1.0, -1.0, 0.0], point![1.0, 1.0, 2.2]).unwrap()).unwrap();
    Arc::new(data)
}

fn plate(camera: &Camera) -> CleanPlate {
    CleanPlate::new(empty_room(camera), Thresholds::default()).unwrap()
}

fn boxed(segmenter: impl Segmenter + 'static) -> Box<dyn Segmenter> {
    Box::new(segmenter)
}

fn plates(cameras: &[Camera]) -> Vec<Box<dyn Segmenter>> {
    cameras.iter().map(|camera| boxed(plate(camera))).collect()
}

/// A segmenter that waits before it segments, and refuses a grey image.
fn slow(camera: &Camera, milliseconds: u64) -> Box<dyn Segmenter> {
    let mut plate = plate(camera);
    boxed(Segment(move |image: &RgbImage, mask: &mut PackedMask| {
        std::thread::sleep(Duration::from_millis(milliseconds));
        if is_grey(image) {
            return Err(Error::argument("found grey"));
        }
        plate.segment_packed(image, mask)
    }))
}

fn grey() -> RgbImage {
    RgbImage::from_pixel(SIZE.0, SIZE.1, image::Rgb([128; 3]))
}

fn is_grey(image: &RgbImage) -> bool {
    image.iter().all(|&value| value == 128)
}

/// Images of a walking person at 30 images per second, with noise of 3 grey levels.
fn images(cameras: &[Camera], number: u32) -> ImageSet {
    let time = f64::from(number) / 30.0;
    let scene = Scene { subject: Subject::person_at(8.0 * time), ..Scene::default() };
    let image = |camera: &Camera| {
        let mut image = render_over(camera, &scene, empty_room(camera)).unwrap();
        let name = camera.name().bytes().fold(0, |seed, byte| 31 * seed + u64::from(byte));
        add_noise(&mut image, 3.0, name + u64::from(number)).unwrap();
        image
    };
    ImageSet::simultaneous(number, time, cameras.iter().map(image))
}

/// The masks and the hull by single calls on this thread.
fn one_by_one(cameras: &[Camera], images: &ImageSet) -> (Vec<GrayImage>, Arc<Hull>) {
    let data = data(cameras);
    let frames = images.images.iter().flatten();
    let mask = |(camera, frame): (&Camera, &Frame)| plate(camera).segment(&frame.image).unwrap();
    let masks: Vec<_> = cameras.iter().zip(frames).map(mask).collect();
    for (view, mask) in masks.iter().enumerate() {
        data.set_mask(view, mask).unwrap();
    }
    (masks, data.update(images.time).unwrap())
}

fn to_masks(masks: &[Option<PackedMask>]) -> Vec<GrayImage> {
    masks.iter().flatten().map(PackedMask::to_mask).collect()
}

/// The masks of a hull's views.
fn masks_of(hull: &Hull) -> Vec<GrayImage> {
    hull.views().iter().map(|view| view.silhouette().to_mask()).collect()
}

/// The points of a grid that are inside a hull.
fn inside(hull: &Hull) -> Vec<bool> {
    let grid = (0..20u8).flat_map(|k| (0..20u8).flat_map(move |j| (0..20u8).map(move |i| [i, j, k])));
    let point = |indices: [u8; 3]| {
        let [x, y, z] = indices.map(f64::from);
        Point3::new(0.1 * x - 0.95, 0.1 * y - 0.95, 0.11 * z)
    };
    grid.map(|indices| hull.inside(&point(indices))).collect()
}

fn assert_same_hull(a: &Hull, b: &Hull) {
    assert_eq!((a.time(), a.aabb(), masks_of(a), inside(a)), (b.time(), b.aabb(), masks_of(b), inside(b)));
}

#[test]
fn the_hull_equals_that_of_single_calls() {
    let cameras = cameras();
    let mut pipeline = Pipeline::new(plates(&cameras), data(&cameras)).unwrap();
    for number in 0..3 {
        let images = images(&cameras, number);
        let (masks, hull) = one_by_one(&cameras, &images);
        let captured = pipeline.publish(images).unwrap();
        assert!(inside(&hull).contains(&true), "the person is in the hull");
        assert_eq!(to_masks(&captured.masks), masks);
        assert_same_hull(&captured.hull, &hull);
    }
}

#[test]
fn images_masks_and_hull_of_one_call_stay_together_after_later_calls() {
    let cameras = cameras();
    let mut pipeline = Pipeline::new(plates(&cameras), data(&cameras)).unwrap();
    let captured: Vec<_> = (0..8).map(|number| pipeline.publish(images(&cameras, number)).unwrap()).collect();
    for (number, Captured { images: kept, masks, hull }) in (0..).zip(&captured) {
        assert_eq!(*kept, images(&cameras, number));
        assert_eq!(hull.time(), kept.time);
        assert_eq!(masks_of(hull), to_masks(masks));
        assert_same_hull(hull, &one_by_one(&cameras, kept).1);
    }
    let (published, latest) = pipeline.data().latest().unwrap();
    assert_eq!((published, Arc::ptr_eq(&latest, &captured[7].hull)), (8, true));
}

#[test]
fn a_failed_segmenter_keeps_the_last_frame_and_the_error_names_camera_and_time() {
    let cameras = cameras();
    let segmenters = cameras.iter().map(|camera| slow(camera, 0)).collect();
    let mut pipeline = Pipeline::new(segmenters, data(&cameras)).unwrap();
    let good = pipeline.publish(images(&cameras, 0)).unwrap();

    let mut bad = images(&cameras, 3);
    bad.images[2].as_mut().unwrap().image = grey().into();
    let error = pipeline.publish(bad).unwrap_err().to_string();
    assert_eq!(error, format!("view \"{}\": image 3 of 0.100 s: found grey", cameras[2].name()));
    let (published, latest) = pipeline.data().latest().unwrap();
    assert_eq!((published, Arc::ptr_eq(&latest, &good.hull)), (1, true));

    // A later frame holds no masks of the failed set either.
    let later = pipeline.data().update(0.2).unwrap();
    assert_eq!(masks_of(&later), to_masks(&good.masks));
    pipeline.publish(images(&cameras, 7)).unwrap();
}

#[test]
fn a_mask_without_background_leaves_all_views_unchanged() {
    let cameras = cameras();
    let mut segmenters = plates(&cameras);
    let mut plate = plate(&cameras[3]);
    segmenters[3] = boxed(Segment(move |image: &RgbImage, mask: &mut PackedMask| {
        if is_grey(image) {
            mask.pack(&GrayImage::from_pixel(SIZE.0, SIZE.1, image::Luma([255])));
            return Ok(());
        }
        plate.segment_packed(image, mask)
    }));

    let mut pipeline = Pipeline::new(segmenters, data(&cameras)).unwrap();
    let good = pipeline.publish(images(&cameras, 0)).unwrap();

    let mut bad = images(&cameras, 1);
    bad.images[3].as_mut().unwrap().image = grey().into();
    let error = pipeline.publish(bad).unwrap_err().to_string();
    assert!(error.contains(cameras[3].name()) && error.contains("all subject"), "{error}");
    assert_eq!(masks_of(&pipeline.data().update(0.1).unwrap()), to_masks(&good.masks));
}

#[test]
fn the_result_does_not_depend_on_which_camera_finishes_first() {
    let cameras = cameras();
    let images = images(&cameras, 4);
    let (masks, hull) = one_by_one(&cameras, &images);
    for delays in [[0, 10, 20, 30], [30, 20, 10, 0]] {
        let segmenters = cameras.iter().zip(delays).map(|(camera, delay)| slow(camera, delay)).collect();
        let mut pipeline = Pipeline::new(segmenters, data(&cameras)).unwrap();
        let captured = pipeline.publish(images.clone()).unwrap();
        assert_eq!(to_masks(&captured.masks), masks);
        assert_same_hull(&captured.hull, &hull);

        // If two cameras fail, the first camera's error is returned, in whichever order they finish.
        let mut bad = images.clone();
        for view in [1, 2] {
            bad.images[view].as_mut().unwrap().image = grey().into();
        }
        let error = pipeline.publish(bad).unwrap_err().to_string();
        assert!(error.contains(cameras[1].name()), "{error}");
    }
}

#[test]
fn a_set_of_an_earlier_time_is_refused() {
    let cameras = cameras();
    let mut pipeline = Pipeline::new(plates(&cameras), data(&cameras)).unwrap();
    let good = pipeline.publish(images(&cameras, 3)).unwrap();
    let error = pipeline.publish(images(&cameras, 0)).unwrap_err().to_string();
    assert!(error.contains("frame of 0.000 s") && error.contains("not before the last mask's"), "{error}");
    assert!(Arc::ptr_eq(&pipeline.data().latest().unwrap().1, &good.hull));
}

#[test]
fn the_order_of_the_cameras_changes_neither_masks_nor_hull() {
    let cameras = cameras();
    let reversed: Vec<_> = cameras.iter().rev().cloned().collect();
    let [one, mut other] = [&cameras, &reversed].map(|cameras| {
        let mut pipeline = Pipeline::new(plates(cameras), data(cameras)).unwrap();
        pipeline.publish(images(cameras, 2)).unwrap()
    });
    other.masks.reverse();
    assert_eq!(one.masks, other.masks);
    assert_eq!(inside(&one.hull), inside(&other.hull));
}

#[test]
fn a_camera_without_an_image_keeps_its_last_mask() {
    let cameras = cameras();
    let mut pipeline = Pipeline::new(plates(&cameras), data(&cameras)).unwrap();
    let mut without = images(&cameras, 0);
    without.images[1] = None;
    let error = pipeline.publish(without).unwrap_err().to_string();
    assert!(error.contains(cameras[1].name()) && error.contains("found none"), "no mask yet: {error}");

    let first = pipeline.publish(images(&cameras, 1)).unwrap();
    let mut without = images(&cameras, 2);
    without.images[1] = None;
    let second = pipeline.publish(without).unwrap();
    assert_eq!(second.masks.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false, true, true]);
    let (before, after) = (masks_of(&first.hull), masks_of(&second.hull));
    assert_eq!(after[1], before[1]);
    assert_ne!(after[0], before[0], "the person walks");
    assert_eq!(after[0], second.masks[0].as_ref().unwrap().to_mask());
}

#[test]
fn a_pipeline_may_be_sent_to_and_shared_with_other_threads() {
    fn is_send_and_sync<T: Send + Sync>() {}
    is_send_and_sync::<Pipeline>();
    is_send_and_sync::<Captured>();
}

#[test]
fn a_wrong_number_of_segmenters_is_refused() {
    let cameras = cameras();
    let error = Pipeline::new(plates(&cameras[1..]), data(&cameras)).unwrap_err().to_string();
    assert!(error.contains("expected 4 segmenters") && error.contains("found 3"), "{error}");
    assert!(Segmenters::new(&cameras, Vec::new()).is_err());
}

#[test]
fn images_of_other_cameras_are_refused() {
    let cameras = cameras();
    let mut segmenters = Segmenters::new(&cameras, plates(&cameras)).unwrap();
    let error = segmenters.segment(&images(&cameras[1..], 3)).unwrap_err().to_string();
    assert!(error.contains("0.100 s") && error.contains("4 cameras, found 3"), "{error}");

    let mut of_other_size = images(&cameras, 3);
    of_other_size.images[2].as_mut().unwrap().image = RgbImage::new(8, 6).into();
    let error = segmenters.segment(&of_other_size).unwrap_err().to_string();
    let parts = [cameras[2].name(), "image 3 of 0.100 s", "160 x 120", "8 x 6"];
    assert!(parts.iter().all(|part| error.contains(part)), "{error}");
}

#[test]
fn existing_masks_give_the_same_hull_as_the_pipeline() {
    let cameras = cameras();
    let images = images(&cameras, 5);
    let (masks, hull) = one_by_one(&cameras, &images);
    let data = data(&cameras);
    assert_same_hull(&publish_masks(&data, &masks, images.time).unwrap(), &hull);

    let error = publish_masks(&data, &masks[1..], 0.5).unwrap_err().to_string();
    assert!(error.contains("expected 4 masks") && error.contains("found 3"), "{error}");
    assert!(publish_masks(&data, &masks, 0.0).is_err(), "a time before the last frame's");
    assert_eq!(data.latest().unwrap().0, 1);
}
