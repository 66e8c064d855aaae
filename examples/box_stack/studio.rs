//! Eight synthetic cameras around a real box that stands, is lifted, and is tilted.
//!
//! Above a flat top the visual hull is a tent unless a camera looks along the top. So seven cameras stand at heights
//! through which the top moves. Two of them stand on the axis of the tilt and look along the top at any angle. The
//! eighth camera looks down and shows the scene.

use super::sensor::Sensor;
use image::RgbImage;
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3, vector};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{Aabb, Hull, HullData};
use ode_visual_hull::pipeline::Pipeline;
use ode_visual_hull::segment::{CleanPlate, Segmenter, Thresholds};
use ode_visual_hull::shape::Shape;
use ode_visual_hull::source::ImageSet;
use ode_visual_hull::synthetic::{
    Hit, Placed, Room, Scene, Solid, Subject, Texture, clean_plate, render_over,
};
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{FRAME_RATE, Frames, Simulation, Story, Window};
use std::sync::Arc;

/// The real box, in metres.
const REAL: Vector3<f64> = Vector3::new(0.5, 0.5, 0.35);

/// Times at which the real box starts and stops moving and the film ends, in seconds.
const STILL_UNTIL: f64 = 1.8;
const MOVED_BY: f64 = 3.6;
const END: f64 = 5.8;

/// Height of the lift in metres, and angle of the tilt towards +x in radians.
const LIFT: f64 = 0.25;
const TILT: f64 = 28.0 * std::f64::consts::PI / 180.0;

/// Positions of the grazing cameras: azimuth in degrees, counter-clockwise from +x, and height in metres.
const GRAZING: [(f64, f64); 7] =
    [(0.0, 0.35), (45.0, 0.35), (90.0, 0.42), (135.0, 0.35), (180.0, 0.50), (225.0, 0.35), (270.0, 0.62)];

const IMAGE: (u32, u32) = (640, 480);

/// Sensor noise, in grey levels.
const NOISE: f64 = 3.0;

/// Rounding error of times, as a part of a frame.
const ROUNDING: f64 = 1e-6;

/// The synthetic studio.
pub struct Studio {
    cameras: Vec<Camera>,
    /// The image of the empty room in each camera.
    plates: Vec<RgbImage>,
    sensor: Sensor,
    pipeline: Pipeline,
    /// The scene, and its images without noise.
    scene: Scene,
    images: Vec<RgbImage>,
    /// The frame published last.
    frame: Option<usize>,
}

impl Studio {
    /// The studio with its empty room photographed, its cameras added to `data` and the first frame published.
    pub fn new(seed: u32, data: &Arc<HullData>) -> Result<Self> {
        let cameras = cameras()?;
        let room = Room::default();
        let plates = in_parallel(&cameras, |_, camera| Ok(clean_plate(camera, &room)))?;
        data.add_views(&cameras)?;
        data.set_bounds(Aabb::new(Point3::new(-0.8, -0.8, -0.1), Point3::new(0.8, 0.8, 1.2))?)?;
        let segmenters = plates.iter().map(segmenter).collect::<Result<Vec<_>>>()?;
        let pipeline = Pipeline::new(segmenters, data.clone())?;
        let sensor = Sensor::new(IMAGE, NOISE, u64::from(seed))?;
        let scene = Scene { subject: Subject::default(), room };
        let mut studio = Self { cameras, plates, sensor, pipeline, scene, images: Vec::new(), frame: None };
        studio.publish(0.0, data)?;
        Ok(studio)
    }

    /// Size of a pixel at the real box, in metres.
    pub fn pixel_size(&self, data: &HullData) -> Result<f64> {
        let (_, hull) = data.latest().ok_or_else(|| Error::argument("expected a frame, found none"))?;
        Ok(hull.pixel_size(&Point3::new(0.0, 0.0, REAL.z)))
    }

    /// Moves the real box to where it is in `frame`. While it stands, its images are those of the frame before.
    fn move_real_box(&mut self, frame: usize) -> Result<()> {
        let cardboard = Texture::plain([206, 150, 92]);
        let placed = Placed::new(Solid::cuboid(REAL)?, real_pose(time_of(frame)), cardboard);
        let subject = Subject::new(vec![placed]);
        if subject != self.scene.subject {
            self.scene.subject = subject;
            let scene = &self.scene;
            let render = |view: usize, camera: &Camera| render_over(camera, scene, &self.plates[view]);
            self.images = in_parallel(&self.cameras, render)?;
        }
        Ok(())
    }
}

impl Frames for Studio {
    fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// All steps of a real system: image, noise, segmentation, mask. The pipeline publishes to the data.
    fn publish(&mut self, time: f64, _: &HullData) -> Result<()> {
        let frame = (time * FRAME_RATE + ROUNDING) as usize;
        if self.frame.replace(frame) == Some(frame) {
            return Ok(());
        }
        self.move_real_box(frame)?;
        let noisy = in_parallel(&self.cameras, |view, _| {
            let exposure = (frame * self.cameras.len() + view) as u32;
            Ok(self.sensor.expose(&self.images[view], exposure))
        })?;
        self.pipeline.publish(ImageSet::simultaneous(frame as u32, time_of(frame), noisy))?;
        Ok(())
    }

    /// The image without noise, which would only make the film larger.
    fn picture(&mut self, view: usize, _: f64) -> Result<RgbImage> {
        Ok(self.images[view].clone())
    }

    fn hit(&self, ray: &Ray, _: usize, _: &Hull) -> Option<Hit> {
        self.scene.subject.first_hit(ray).map(|(hit, _)| hit)
    }

    fn real_top(&self) -> Option<f64> {
        Some((real_pose(time_of(self.frame?)) * Point3::new(0.0, 0.0, 0.5 * REAL.z)).z)
    }
}

impl Story for Studio {
    fn subject(&self) -> &str {
        "real box"
    }

    fn frames(&self) -> usize {
        (END * FRAME_RATE) as usize
    }

    fn still_until(&self) -> f64 {
        STILL_UNTIL
    }

    fn moments(&self) -> [f64; 3] {
        [STILL_UNTIL - 0.1, MOVED_BY - 0.2, END]
    }

    fn best_view(&self) -> usize {
        self.cameras.len() - 1
    }

    fn window(&self, view: usize) -> Window {
        Window::full(&self.cameras[view])
    }

    fn light(&self) -> Point3<f64> {
        self.scene.room.light_position()
    }
}

fn segmenter(empty: &RgbImage) -> Result<Box<dyn Segmenter>> {
    Ok(Box::new(CleanPlate::new(empty, Thresholds::default())?))
}

/// Stacks the five virtual boxes, with a gap of a millimetre.
pub fn stack(simulation: &mut Simulation) -> Result<()> {
    let boxes = [
        (vector![0.26, 0.25, 0.15], 0.05, [222, 86, 62]),
        (vector![0.24, 0.24, 0.14], -0.12, [66, 118, 202]),
        (vector![0.25, 0.22, 0.13], 0.20, [240, 188, 60]),
        (vector![0.22, 0.24, 0.14], -0.06, [146, 92, 186]),
        (vector![0.21, 0.21, 0.13], 0.30, [236, 236, 228]),
    ];
    let mut top = REAL.z;
    for (sides, yaw, colour) in boxes {
        top += 0.001;
        let pose = Isometry3::new(vector![0.0, 0.0, top + 0.5 * sides.z], Vector3::z() * yaw);
        simulation.add(&Shape::Box { sides }, &pose, colour)?;
        top += sides.z;
    }

    Ok(())
}

/// The real box's pose at `time`.
fn real_pose(time: f64) -> Isometry3<f64> {
    let s = ((time - STILL_UNTIL) / (MOVED_BY - STILL_UNTIL)).clamp(0.0, 1.0);
    let moved = s * s * (3.0 - 2.0 * s);
    let centre = vector![0.0, 0.0, 0.5 * REAL.z + LIFT * moved];
    Isometry3::from_parts(centre.into(), UnitQuaternion::from_axis_angle(&Vector3::y_axis(), TILT * moved))
}

fn time_of(frame: usize) -> f64 {
    frame as f64 / FRAME_RATE
}

fn cameras() -> Result<Vec<Camera>> {
    let target = Point3::new(0.0, 0.0, 0.4);
    let grazing = GRAZING.iter().enumerate().map(|(i, &(azimuth, height))| {
        let (sin, cos) = azimuth.to_radians().sin_cos();
        let eye = Point3::new(3.0 * cos, 3.0 * sin, height);
        Camera::look_at(format!("grazing{i}"), IMAGE, 0.46, eye, target, Vector3::z())
    });
    let (eye, target) = (Point3::new(-0.55, -3.05, 1.6), Point3::new(0.38, 0.0, 0.52));
    let overview = Camera::look_at("overview", IMAGE, 0.66, eye, target, Vector3::z());
    grazing.chain([overview]).collect()
}

/// Calls `work` for each camera, each on a thread of its own.
fn in_parallel<T: Send>(
    cameras: &[Camera],
    work: impl Fn(usize, &Camera) -> Result<T> + Sync,
) -> Result<Vec<T>> {
    std::thread::scope(|scope| {
        let work = &work;
        let threads: Vec<_> = cameras
            .iter()
            .enumerate()
            .map(|(view, camera)| scope.spawn(move || work(view, camera)))
            .collect();
        threads.into_iter().map(|thread| thread.join().expect("no camera's work panics")).collect()
    })
}
