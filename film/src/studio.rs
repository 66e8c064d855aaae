//! Synthetic cameras that film what happens in a room, through all steps of a real system: image, noise, segmentation, mask.

mod recorder;

use crate::capture::{FRAME_RATE, Frames, Story};
use crate::playback_options::PlaybackOptions;
use crate::sensor::Sensor;
use crate::window::Window;
use image::RgbImage;
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{Aabb, Hull, HullData};
use ode_visual_hull::pipeline::Pipeline;
use ode_visual_hull::segment::{CleanPlate, Segmenter, Thresholds};
use ode_visual_hull::silhouette::PackedMask;
use ode_visual_hull::source::ImageSet;
use ode_visual_hull::synthetic::{Hit, Room, Scene, Subject, clean_plate, render_over};
use recorder::Recorder;
use std::path::Path;
use std::sync::Arc;

/// Sensor noise, in grey levels.
const NOISE: f64 = 3.0;

/// Rounding error of times, as a part of a frame.
const ROUNDING: f64 = 1e-6;

/// What happens in front of the cameras.
pub trait Scenario: Sync {
    /// A word for the subject.
    fn name(&self) -> &str;

    /// The subject at a time, in seconds.
    ///
    /// # Errors
    /// Solids of no size.
    fn subject(&self, time: f64) -> Result<Subject>;

    /// The height of the subject's top at a time, where that is of interest.
    fn top(&self, time: f64) -> Option<f64>;

    /// The time up to which the subject does not move, in seconds.
    fn still_until(&self) -> f64;

    /// The time at which the film ends, in seconds.
    fn end(&self) -> f64;

    /// Three times that show what happens, in seconds.
    fn moments(&self) -> [f64; 3];
}

/// A room with cameras in which a [`Scenario`] happens.
pub struct Studio<S> {
    scenario: S,
    cameras: Vec<Camera>,
    /// The image of the empty room in each camera.
    plates: Vec<RgbImage>,
    sensor: Sensor,
    pipeline: Pipeline,
    /// The scene, and its images without noise.
    scene: Scene,
    images: Vec<RgbImage>,
    /// The frame published last, and its masks.
    frame: Option<usize>,
    masks: Vec<PackedMask>,
    bounds: Aabb,
    /// The recording of the frames, if one is written.
    recorder: Option<Recorder>,
    /// The subject in the picture taken last.
    pictured: Subject,
}

impl<S: Scenario> Studio<S> {
    /// The studio with its empty room photographed, its cameras added to `data` and the first frame published. All images
    /// have the size of the first camera's; the last camera shows most. The seed is that of the sensors' noise.
    ///
    /// # Errors
    /// No cameras, or two with one name; a scenario that fails.
    pub fn new(
        scenario: S,
        cameras: Vec<Camera>,
        bounds: Aabb,
        seed: u64,
        data: &Arc<HullData>,
    ) -> Result<Self> {
        let room = Room::default();
        let plates = in_parallel(&cameras, |_, camera| Ok(clean_plate(camera, &room)))?;
        data.add_views(&cameras)?;
        data.set_bounds(bounds)?;
        let segmenters = plates.iter().map(segmenter).collect::<Result<Vec<_>>>()?;
        let pipeline = Pipeline::new(segmenters, data.clone())?;
        let size = cameras.first().map_or((1, 1), Camera::size);
        let sensor = Sensor::new(size, NOISE, seed)?;
        let scene = Scene { subject: Subject::default(), room };
        let mut studio = Self {
            scenario,
            cameras,
            plates,
            sensor,
            pipeline,
            scene,
            images: Vec::new(),
            frame: None,
            masks: Vec::new(),
            bounds,
            recorder: None,
            pictured: Subject::default(),
        };
        studio.publish(0.0, data)?;
        Ok(studio)
    }

    /// Writes the frames from the present one on as a recording to folder `dir`: the masks that are published, and the images
    /// without noise, which would take two to three times the space.
    ///
    /// # Errors
    /// A folder that holds a recording already, or cannot be written.
    pub fn record(&mut self, dir: &Path) -> Result<()> {
        self.recorder = Some(Recorder::new(dir, &self.cameras, &self.plates, self.bounds)?);
        self.record_frame()
    }

    /// Adds the frame published last to the recording.
    fn record_frame(&mut self) -> Result<()> {
        match (&mut self.recorder, self.frame) {
            (Some(recorder), Some(frame)) => {
                recorder.add(frame as u32, time_of(frame), &self.images, &self.masks)
            }
            _ => Ok(()),
        }
    }

    /// Moves the subject to where it is in `frame`. While it stands, its images are those of the frame before.
    fn move_subject(&mut self, frame: usize) -> Result<()> {
        let subject = self.scenario.subject(time_of(frame))?;
        if subject != self.scene.subject {
            self.scene.subject = subject;
            let scene = &self.scene;
            let render = |view: usize, camera: &Camera| render_over(camera, scene, &self.plates[view]);
            self.images = in_parallel(&self.cameras, render)?;
        }
        Ok(())
    }
}

impl<S: Scenario> Frames for Studio<S> {
    fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// All steps of a real system. The pipeline publishes to the data.
    fn publish(&mut self, time: f64, _: &HullData) -> Result<()> {
        let frame = (time * FRAME_RATE + ROUNDING) as usize;
        if self.frame.replace(frame) == Some(frame) {
            return Ok(());
        }
        self.move_subject(frame)?;
        let noisy = in_parallel(&self.cameras, |view, _| {
            let exposure = (frame * self.cameras.len() + view) as u32;
            Ok(self.sensor.expose(&self.images[view], exposure))
        })?;
        let captured = self.pipeline.publish(ImageSet::simultaneous(frame as u32, time_of(frame), noisy))?;
        self.masks = captured.masks.into_iter().flatten().collect();
        self.record_frame()
    }

    /// The image without noise, which would only make the film larger.
    fn picture(&mut self, view: usize, time: f64) -> Result<RgbImage> {
        self.pictured = self.scenario.subject(time)?;
        if self.pictured == self.scene.subject {
            return Ok(self.images[view].clone());
        }
        // The hull in the simulation lags behind the frame published last.
        let scene = Scene { subject: self.pictured.clone(), room: self.scene.room.clone() };
        render_over(&self.cameras[view], &scene, &self.plates[view])
    }

    fn hit(&self, ray: &Ray, _: usize, _: &Hull) -> Option<Hit> {
        self.pictured.first_hit(ray).map(|(hit, _)| hit)
    }

    fn real_top(&self) -> Option<f64> {
        self.scenario.top(time_of(self.frame?))
    }
}

impl<S: Scenario> Story for Studio<S> {
    fn subject(&self) -> &str {
        self.scenario.name()
    }

    fn frames(&self) -> usize {
        (self.scenario.end() * FRAME_RATE) as usize
    }

    fn still_until(&self) -> f64 {
        self.scenario.still_until()
    }

    fn moments(&self) -> [f64; 3] {
        self.scenario.moments()
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

    fn playback(&self) -> Option<PlaybackOptions> {
        self.recorder.as_ref().map(Recorder::playback)
    }
}

fn segmenter(empty: &RgbImage) -> Result<Box<dyn Segmenter>> {
    Ok(Box::new(CleanPlate::new(empty, Thresholds::default())?))
}

fn time_of(frame: usize) -> f64 {
    frame as f64 / FRAME_RATE
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
