use super::*;
use crate::camera::Camera;
use crate::hull::{Aabb, Unseen};
use crate::silhouette::{Border, Silhouette};
use crate::synthetic::{Placed, Solid, Subject, Texture, coverage, layout};
use image::GrayImage;
use nalgebra::{Isometry3, Vector3, point};
use std::sync::Arc;

/// The radius of all balls, in metres.
const RADIUS: f64 = 0.1;

/// Frames a second.
const RATE: f64 = 30.0;

/// Balls, and the cameras of a level ring that see them.
struct Scene {
    cameras: Vec<Arc<Camera>>,
    parts: Parts,
    last: Option<Hull>,
    frames: usize,
}

impl Scene {
    fn new(cameras: usize) -> Self {
        let ring = layout::ring(cameras, 3.0, 0.3, Point3::origin(), (320, 240), 0.6).unwrap();
        let cameras = ring.into_iter().map(Arc::new).collect();
        Self { cameras, parts: Parts::default(), last: None, frames: 0 }
    }

    fn masks(&self, balls: &[Point3<f64>]) -> Vec<GrayImage> {
        let ball = |centre: &Point3<f64>| {
            let pose = Isometry3::translation(centre.x, centre.y, centre.z);
            Placed::new(Solid::sphere(RADIUS).unwrap(), pose, Texture::plain([200; 3]))
        };
        let subject = Subject::new(balls.iter().map(ball).collect());
        self.cameras.iter().map(|camera| coverage(camera, &subject)).collect()
    }

    fn show_masks(&mut self, masks: &[GrayImage]) {
        let view = |(camera, mask): (&Arc<Camera>, &GrayImage)| {
            View::new(camera.clone(), Arc::new(Silhouette::new(mask, Border::Background)), None)
        };
        let half = Vector3::repeat(0.8);
        let bounds = Aabb::new(Point3::origin() - half, Point3::origin() + half).unwrap();
        let views = self.cameras.iter().zip(masks).map(view).collect();
        let next = Hull::new(views, bounds, Unseen::Outside, self.frames as f64 / RATE);
        self.parts.follow(self.last.as_ref(), &next);
        (self.last, self.frames) = (Some(next), self.frames + 1);
    }

    fn show(&mut self, balls: &[Point3<f64>]) {
        let masks = self.masks(balls);
        self.show_masks(&masks);
    }

    /// The part of a point on top of a ball.
    fn part(&mut self, ball: &Point3<f64>) -> Option<PartId> {
        let top = ball + Vector3::z() * RADIUS;
        self.parts.part_at(self.last.as_ref().unwrap(), &top, AT_SURFACE)
    }
}

/// Two balls that pass each other, near enough to overlap in the images of some views at a time.
fn passing(frame: usize) -> [Point3<f64>; 2] {
    let x = 0.4 - 0.8 * frame as f64 / 60.0;
    [point![x, 0.15, 0.0], point![-x, -0.15, 0.0]]
}

#[test]
fn parts_that_pass_each_other_in_some_views_keep_their_ids() {
    for cameras in [4, 5, 7] {
        let mut scene = Scene::new(cameras);
        let mut overlapping = 0;
        for frame in 0..=60 {
            let balls = passing(frame);
            let masks = scene.masks(&balls);
            let merged = masks.iter().filter(|mask| {
                Components::new(&Silhouette::new(*mask, Border::Background), None).all().len() == 1
            });
            overlapping = overlapping.max(merged.count());
            scene.show_masks(&masks);
            let parts = balls.map(|ball| scene.part(&ball));
            assert_eq!(parts, [Some(1), Some(2)], "{cameras} cameras, frame {frame}");
        }
        assert!(overlapping > 0, "{cameras} cameras");
    }
}

#[test]
fn a_part_that_comes_has_a_new_id_and_one_that_was_gone_for_long_too() {
    let mut scene = Scene::new(5);
    let [a, b] = [point![0.3, 0.1, 0.0], point![-0.3, -0.2, 0.0]];
    scene.show(&[a]);
    assert_eq!(scene.part(&a), Some(1));
    scene.show(&[a, b]);
    assert_eq!([scene.part(&a), scene.part(&b)], [Some(1), Some(2)]);

    // It was seen for two frames, and so is remembered for one.
    scene.show(&[a, b]);
    (0..3).for_each(|_| scene.show(&[a]));
    assert_eq!(scene.parts.known.len(), 1);
    scene.show(&[a, b]);
    assert_eq!([scene.part(&b), scene.part(&a)], [Some(3), Some(1)]);
}

#[test]
fn masks_that_flicker_in_up_to_half_of_the_views_change_no_id() {
    let mut scene = Scene::new(4);
    let balls = [point![0.3, 0.1, 0.0], point![-0.3, -0.2, 0.0]];
    let masks = scene.masks(&balls);
    for frame in 0..60 {
        let mut masks = masks.clone();
        if frame % 3 == 2 {
            // A ball falls apart along a column in the one view, all is missing in another.
            let [split, missing] = [frame % 4, (frame + 1) % 4];
            let centre = scene.last.as_ref().unwrap().views()[split].project(&balls[0]).unwrap();
            for j in 0..240 {
                masks[split].put_pixel(centre.u as u32 + 3, j, image::Luma([0]));
            }
            masks[missing].fill(0);
        }
        scene.show_masks(&masks);
        for (ball, id) in balls.iter().zip([1, 2]) {
            // On both sides of the gap.
            let sides = [-0.05, 0.05].map(|x| ball + Vector3::new(x, x, -0.03));
            let parts = sides.map(|side| scene.part(&side));
            assert_eq!(parts, [Some(id); 2], "frame {frame}");
        }
    }
}

#[test]
fn a_point_that_falls_on_no_component_has_no_part() {
    let mut scene = Scene::new(4);
    scene.show(&[Point3::origin()]);
    assert_eq!(scene.part(&point![0.5, 0.5, 0.0]), None);
}
