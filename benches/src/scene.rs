//! The input of every candidate: cameras, masks, and boxes around a subject.
//!
//! Lengths are in metres, and z points up. The cameras stand around the subject at 3.2 m, so that a pixel covers 6 mm
//! at VGA.

use crate::masks;
use image::GrayImage;
use nalgebra::{Isometry3, Point3, Translation3, Vector3, point, vector};
use ode_visual_hull::camera::{Camera, Distortion};
use ode_visual_hull::hull::Aabb;
use ode_visual_hull::sample::{self, Samples};
use ode_visual_hull::silhouette::Undistortion;
use ode_visual_hull::synthetic::{self, Placed, Solid, Subject, Texture, layout};
use ode_visual_hull_testing::random::Random;

/// Names of the image sizes, and width and height in pixels.
pub const SIZES: [(&str, (u32, u32)); 3] =
    [("VGA", (640, 480)), ("1080p", (1920, 1080)), ("4K", (3840, 2160))];

/// 640 x 480 pixels.
pub const VGA: (u32, u32) = SIZES[0].1;

/// 1920 x 1080 pixels.
pub const FULL_HD: (u32, u32) = SIZES[1].1;

/// 3840 x 2160 pixels.
pub const UHD: (u32, u32) = SIZES[2].1;

/// The side lengths of every box, in metres.
pub const BOX: Vector3<f64> = Vector3::new(0.105, 0.19, 0.232);

/// The samples' `min_feature`, in metres, that puts 400 of them on a box.
pub const SAMPLES_400: f64 = 0.03;

/// The samples' `min_feature`, in metres, that puts 4000 of them on a box.
pub const SAMPLES_4000: f64 = 0.0095;

const RADIUS: f64 = 3.2;
const FIELD_OF_VIEW: f64 = 1.1;
const TARGET: Point3<f64> = Point3::new(0.0, 0.0, 0.95);

/// Heights of the cameras in metres, in cyclic order: the lowest look along the floor, the highest down at the head.
const HEIGHTS: [f64; 7] = [0.2, 1.6, 0.8, 2.3, 0.4, 1.2, 1.9];

/// The distortion coefficient k1 of the lenses; OpenCV's other coefficients are zero. Straight lines at the image's
/// corners bend by a few per cent, as with a usual wide-angle lens.
const K1: f64 = -0.2;

/// The time of the person's walk, in seconds.
const TIME: f64 = 0.2;

/// The subject in front of the cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SubjectKind {
    /// A person of capsules, 1.75 m tall, in the middle of a step. No point is deeper than 17 pixels at VGA.
    Person,
    /// An upright capsule, 1.7 m tall and 0.84 m wide, for points that lie deep.
    Barrel,
}

/// Cameras, their masks, and the work volume.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The cameras around the subject.
    pub cameras: Vec<Camera>,
    /// One mask a camera, with 0 or 255 from exact ray casting, unless the scene is [`segmented`](Self::segmented) or
    /// [`undistorted`](Self::undistorted).
    pub masks: Vec<GrayImage>,
    /// The work volume.
    pub bounds: Aabb,
}

impl Scene {
    /// `cameras` views of `size` pixels by pinhole cameras.
    pub fn new(kind: SubjectKind, cameras: usize, size: (u32, u32)) -> Self {
        Self::of(&kind.subject(), pinholes(cameras, size))
    }

    /// `cameras` views of `size` pixels by cameras with a distorting lens, whose places and focal lengths are those of
    /// [`new`](Self::new).
    pub fn through_lenses(kind: SubjectKind, cameras: usize, size: (u32, u32)) -> Self {
        Self::of(&kind.subject(), pinholes(cameras, size).iter().map(with_lens).collect())
    }

    /// The cameras of [`new`](Self::new) with masks from the segmentation of noisy images: with coverage along the
    /// outline, and with the errors of noise.
    pub fn segmented(kind: SubjectKind, cameras: usize, size: (u32, u32)) -> Self {
        let subject = kind.subject();
        let cameras = pinholes(cameras, size);
        let masks = masks::segmented(&cameras, &subject);
        Self { cameras, masks, bounds: bounds() }
    }

    /// The person of [`Subject::person_at`] at `time` seconds.
    pub fn person_at(time: f64, cameras: usize, size: (u32, u32), optics: Optics) -> Self {
        let mut cameras = pinholes(cameras, size);
        if optics == Optics::Lenses {
            cameras = cameras.iter().map(with_lens).collect();
        }
        Self::of(&Subject::person_at(time), cameras)
    }

    /// This scene for a program without a lens model: pinhole cameras in place of the distorted ones, with undistorted
    /// masks.
    pub fn undistorted(&self) -> Self {
        let undistort = |(camera, mask): (&Camera, &GrayImage)| match Undistortion::new(camera) {
            Some(lens) => (lens.pinhole().clone(), lens.apply(mask, 0).expect("a mask of the camera's size")),
            None => (camera.clone(), mask.clone()),
        };
        let (cameras, masks) = self.cameras.iter().zip(&self.masks).map(undistort).unzip();
        Self { cameras, masks, bounds: self.bounds }
    }

    /// This scene with masks of 0 and 255 alone: 255 where at least half a pixel is covered.
    pub fn binary(&self) -> Self {
        Self { masks: self.masks.iter().map(masks::binary).collect(), ..self.clone() }
    }

    fn of(subject: &Subject, cameras: Vec<Camera>) -> Self {
        let masks = cameras.iter().map(|camera| synthetic::silhouette(camera, subject)).collect();
        Self { cameras, masks, bounds: bounds() }
    }

    /// The size of all masks together, in bytes.
    pub fn mask_bytes(&self) -> usize {
        self.masks.iter().map(|mask| mask.as_raw().len()).sum()
    }
}

impl SubjectKind {
    fn subject(self) -> Subject {
        match self {
            Self::Person => Subject::person_at(TIME),
            Self::Barrel => barrel(),
        }
    }
}

/// The input of the library and of its peers in a comparison.
///
/// The peers have no lens model. Where the cameras have lenses, the peers get undistorted masks, which costs them no
/// time, while the time of the library includes undistorting.
#[derive(Debug, Clone)]
pub struct Inputs {
    /// The masks that the cameras see.
    pub ours: Scene,
    /// The masks that pinhole cameras in the same places would see.
    pub peers: Scene,
}

/// The optics of the cameras.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Optics {
    /// Pinhole cameras.
    Pinholes,
    /// Distorting lenses, see [`Scene::through_lenses`].
    Lenses,
}

impl Inputs {
    /// `cameras` views of `size` pixels.
    pub fn new(kind: SubjectKind, cameras: usize, size: (u32, u32), optics: Optics) -> Self {
        let ours = match optics {
            Optics::Pinholes => Scene::new(kind, cameras, size),
            Optics::Lenses => Scene::through_lenses(kind, cameras, size),
        };
        Self { peers: ours.undistorted(), ours }
    }
}

fn pinholes(count: usize, size: (u32, u32)) -> Vec<Camera> {
    layout::staggered(count, RADIUS, &HEIGHTS, TARGET, size, FIELD_OF_VIEW).expect("a valid layout")
}

/// The camera with the lens of [`K1`].
fn with_lens(camera: &Camera) -> Camera {
    let lens = Distortion::from_opencv(&[K1, 0.0, 0.0, 0.0]).expect("four finite coefficients");
    Camera::new(camera.name(), camera.size(), *camera.intrinsics(), lens, *camera.cam_from_world())
        .expect("a valid camera")
}

/// The work volume.
fn bounds() -> Aabb {
    Aabb::new(point![-1.0, -1.0, -0.1], point![1.0, 1.0, 2.0]).expect("a volume")
}

fn barrel() -> Subject {
    let solid = Solid::capsule(0.42, 0.86).expect("positive lengths");
    Subject::new(vec![Placed::new(solid, Isometry3::translation(0.0, 0.0, 0.87), Texture::plain([200; 3]))])
}

/// Equal boxes at random poses.
#[derive(Debug, Clone)]
pub struct Bodies {
    /// Samples of one box, in its own frame.
    pub samples: Samples,
    /// Poses of the boxes: world from box.
    pub poses: Vec<Isometry3<f64>>,
}

impl Bodies {
    /// `count` random boxes around a person, with samples of `min_feature` metres. A quarter of them touches the
    /// person. A larger `count` adds boxes to those of a smaller one.
    pub fn scattered(count: usize, min_feature: f64) -> Self {
        let samples = sample::box_(BOX, min_feature).expect("a box that can be sampled");
        let around = Aabb { min: point![-0.45, -0.6, 0.1], max: point![0.45, 0.6, 1.7] };
        let mut random = Random(7);
        let mut pose = || {
            let at = random.point(around.min, around.max);
            Isometry3::from_parts(Translation3::from(at.coords), random.rotation())
        };
        Self { samples, poses: (0..count).map(|_| pose()).collect() }
    }

    /// The samples of all bodies in the world, body by body.
    pub fn world_points(&self) -> Vec<Point3<f64>> {
        let points_of = |pose: &Isometry3<f64>| {
            let pose = *pose;
            self.samples.points().iter().map(move |sample| pose * sample.point)
        };
        self.poses.iter().flat_map(points_of).collect()
    }

    /// Half the boxes' side lengths, in metres.
    pub fn half_lengths(&self) -> Vector3<f64> {
        vector![BOX.x / 2.0, BOX.y / 2.0, BOX.z / 2.0]
    }
}
