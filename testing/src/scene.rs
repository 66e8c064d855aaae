//! A table that is its own visual hull, with cameras and masks.

use image::GrayImage;
use nalgebra::{Isometry3, Point3, Vector3, point};
use ode_visual_hull::camera::Camera;
use ode_visual_hull::hull::{Aabb, HullData};
use ode_visual_hull::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use std::sync::{Arc, LazyLock};

/// The table's side lengths in metres; its centre is the origin.
pub const TABLE: Vector3<f64> = Vector3::new(0.5, 0.5, 0.4);

/// Height of the table's top, in metres.
pub const TOP: f64 = 0.2;

/// Size of a pixel of the table's cameras at the table, in metres: 0.45 rad over 640 pixels at about 3 m.
pub const PIXEL: f64 = 0.0022;

/// An orange box with side lengths `sides`, in metres.
pub fn cuboid(sides: Vector3<f64>, pose: Isometry3<f64>) -> Placed {
    Placed::new(Solid::cuboid(sides).unwrap(), pose, Texture::plain([200, 60, 40]))
}

/// Four cameras that each look along the table's top and one of its sides.
pub fn table_cameras() -> Vec<Camera> {
    layout::face_on(TABLE, &Isometry3::identity(), 2.8, 0.2, (640, 480), 0.45).unwrap()
}

/// A work volume around the table.
pub fn bounds() -> Aabb {
    Aabb::new(point![-0.6, -0.6, -0.3], point![0.6, 0.6, 0.8]).unwrap()
}

/// Hull data with a view for each of `cameras`, without masks.
pub fn data_with(cameras: &[Camera]) -> Arc<HullData> {
    let data = HullData::new();
    for camera in cameras {
        data.add_view(camera.clone()).unwrap();
    }
    data.set_bounds(bounds()).unwrap();
    Arc::new(data)
}

/// The masks of `subject` in all cameras, with coverage.
pub fn masks_of(cameras: &[Camera], subject: &Subject) -> Vec<GrayImage> {
    cameras.iter().map(|camera| coverage(camera, subject)).collect()
}

/// Publishes the masks of `subject` in all views as the frame at `time` seconds.
pub fn show(data: &HullData, cameras: &[Camera], subject: &Subject, time: f64) {
    publish(data, &masks_of(cameras, subject), time);
}

/// Publishes `masks`, one a view, as the frame at `time` seconds.
pub fn publish(data: &HullData, masks: &[GrayImage], time: f64) {
    for (view, mask) in masks.iter().enumerate() {
        data.set_mask(view, mask).unwrap();
    }
    data.update(time).unwrap();
}

/// The masks of the table in its cameras, with coverage.
pub fn table_masks() -> &'static [GrayImage] {
    static MASKS: LazyLock<Vec<GrayImage>> = LazyLock::new(|| {
        let table = Subject::new(vec![cuboid(TABLE, Isometry3::identity())]);
        masks_of(&table_cameras(), &table)
    });
    &MASKS
}

/// Publishes the table as the frame at `time` seconds.
pub fn show_table(data: &HullData, time: f64) {
    publish(data, table_masks(), time);
}

/// Hull data with the table as its frame at time 0.
pub fn table() -> Arc<HullData> {
    let data = data_with(&table_cameras());
    show_table(&data, 0.0);
    data
}

/// A pose without rotation.
pub fn at(x: f64, y: f64, z: f64) -> Isometry3<f64> {
    Isometry3::translation(x, y, z)
}

/// The table's centre.
pub const ORIGIN: Point3<f64> = Point3::new(0.0, 0.0, 0.0);
