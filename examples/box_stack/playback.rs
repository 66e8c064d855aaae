//! A real recording, played after its first frame has stood still for a while.

use super::capture::{Capture, FRAME_RATE, Window};
use super::landing;
use super::options::Options;
use super::simulation::Simulation;
use image::RgbImage;
use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{Hull, HullData};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::synthetic::Hit;
use ode_visual_hull::{Error, Result};
use std::path::Path;
use std::sync::Arc;

/// How long all frames last together at least, unless told otherwise, in seconds.
const DURATION: f64 = 5.0;

/// How much around the subject is drawn, in metres.
const MARGIN: f64 = 0.4;

const COLOURS: [[u8; 3]; 6] =
    [[222, 86, 62], [66, 118, 202], [240, 188, 60], [146, 92, 186], [236, 236, 228], [64, 168, 160]];

/// A recording that plays.
pub struct Playback {
    recording: Recording,
    hold: usize,
    repeat: usize,
    side: f64,
    /// The recorded frame whose masks are in force.
    published: Option<u32>,
    /// The last picture read: recorded frame, view.
    picture: Option<(u32, usize, RgbImage)>,
}

impl Playback {
    /// Opens the recording in `dir`, adds its cameras to `data` and publishes its first frame.
    pub fn open(dir: &Path, options: &Options, data: &HullData) -> Result<Self> {
        let recording = Recording::open(dir)?;
        let count = recording.frames().len();
        if count == 0 {
            let problem =
                "expected masks, found images alone; segment them into <camera>/mask/000000.png first";
            return Err(Error::file(dir, problem));
        }
        if !(0.05..=2.0).contains(&options.side) {
            return Err(Error::argument(format!("--side: expected 0.05 to 2 m, found {}", options.side)));
        }
        if !(options.hold >= 0.0 && options.hold <= 3600.0) {
            return Err(Error::argument(format!("--hold: expected 0 to 3600 s, found {}", options.hold)));
        }
        for camera in recording.rig().cameras() {
            data.add_view(camera.clone())?;
        }
        data.set_unseen(options.unseen.into())?;
        let bounds = options.bounds.map_or_else(|| recording.rig().work_volume(), Ok)?;
        data.set_bounds(bounds)?;
        let repeat = (DURATION * FRAME_RATE / count as f64).round().max(1.0) as usize;
        let mut playback = Self {
            recording,
            hold: (options.hold * FRAME_RATE) as usize,
            repeat: options.repeat.map_or(repeat, |repeat| repeat as usize),
            side: options.side,
            published: None,
            picture: None,
        };
        playback.publish(0, data)?;
        playback.check_hull(dir, data)?;
        Ok(playback)
    }

    fn check_hull(&self, dir: &Path, data: &HullData) -> Result<()> {
        let (_, hull) = data.latest().ok_or_else(|| Error::argument("expected a frame, found none"))?;
        let Some(why) = hull.emptiness() else { return Ok(()) };
        let problem = format!(
            "expected a subject in frame {}, found an empty hull ({why:?}); set --bounds, or --unseen abstain where \
             no point is in sight of all cameras",
            self.recording.frames()[0]
        );
        Err(Error::file(dir, problem))
    }

    /// Metres that a pixel covers at the subject.
    pub fn pixel_size(&self, data: &HullData) -> Result<f64> {
        let (_, hull) = data.latest().ok_or_else(|| Error::argument("expected a frame, found none"))?;
        Ok(hull.pixel_size(&hull.aabb().centre()))
    }

    /// Lets `n` boxes fall on the subject.
    pub fn drop_boxes(&self, n: usize, data: &Arc<HullData>, simulation: &mut Simulation) -> Result<()> {
        let poses = landing::poses(data, n, self.side, self.pixel_size(data)?)?;
        if poses.is_empty() && n > 0 {
            return Err(Error::argument(
                "expected a place above 0.3 m for a box to land, found none; check that the world's z is up and \
                 the floor at z = 0, or take a smaller --side",
            ));
        }
        for (i, pose) in poses.iter().enumerate() {
            simulation.add_box(Vector3::repeat(self.side), pose, COLOURS[i % COLOURS.len()])?;
        }
        Ok(())
    }

    /// The recorded frame to show in `frame`.
    fn recorded(&self, frame: usize) -> u32 {
        let frames = self.recording.frames();
        frames[(frame.saturating_sub(self.hold) / self.repeat).min(frames.len() - 1)]
    }
}

impl Capture for Playback {
    fn subject(&self) -> &str {
        "subject"
    }

    fn cameras(&self) -> &[Camera] {
        self.recording.rig().cameras()
    }

    /// The nearest.
    fn best_view(&self, data: &HullData) -> usize {
        let Some((_, hull)) = data.latest() else { return 0 };
        let middle = hull.aabb().centre();
        let distance = |&view: &usize| (self.cameras()[view].centre() - middle).norm();
        (0..self.cameras().len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }

    fn frames(&self) -> usize {
        self.hold + self.recording.frames().len() * self.repeat
    }

    fn still_until(&self) -> f64 {
        self.hold as f64 / FRAME_RATE
    }

    fn moments(&self) -> [f64; 3] {
        let (still_until, end) = (self.still_until(), self.frames() as f64 / FRAME_RATE);
        [0.2, still_until - 0.1, 0.5 * (still_until + end)]
    }

    fn publish(&mut self, frame: usize, data: &HullData) -> Result<()> {
        let recorded = self.recorded(frame);
        if self.published != Some(recorded) {
            for (view, mask) in self.recording.masks(recorded)?.iter().enumerate() {
                data.set_mask(view, mask)?;
            }
            self.published = Some(recorded);
            data.update(frame as f64 / FRAME_RATE)?;
        }
        Ok(())
    }

    /// The nearest recorded image, else the mask.
    fn picture(&mut self, frame: usize, view: usize) -> Result<RgbImage> {
        let masked = self.recorded(frame);
        let nearest =
            self.recording.image_frames().iter().copied().min_by_key(|image| image.abs_diff(masked));
        let key = nearest.unwrap_or(masked);
        if let Some((of, from, picture)) = &self.picture
            && (*of, *from) == (key, view)
        {
            return Ok(picture.clone());
        }
        let picture = match nearest {
            Some(image) => self.recording.images(image)?.swap_remove(view),
            None => image::DynamicImage::from(self.recording.masks(masked)?.swap_remove(view)).into_rgb8(),
        };
        self.picture = Some((key, view, picture.clone()));
        Ok(picture)
    }

    /// Around the subject and where boxes fall.
    fn window(&self, view: usize, data: &HullData) -> Window {
        let camera = &self.cameras()[view];
        let Some((_, hull)) = data.latest() else { return Window::whole(camera) };
        let mut around = hull.aabb().grown(MARGIN);
        around.min.z = 0.0;
        Window::around(camera, &around.corners())
    }

    /// The hull stands for the subject.
    fn hit(&self, ray: &Ray, view: usize, hull: &Hull) -> Option<Hit> {
        // Most rays miss: those beside the camera's own silhouette, and those beside the box around the hull.
        let view = hull.views().get(view)?;
        let (i, j) = view.pixel(&ray.at(1.0))?;
        if !view.silhouette().is_subject(i, j) {
            return None;
        }
        let (near, _, _) = hull.aabb().span(&ray.origin, &ray.direction)?;
        let (entry, _) = hull.first_span(&Ray { origin: ray.at(near), ..*ray })?;
        entry.map(|entry| Hit { t: near + entry.t, normal: entry.normal })
    }

    fn real_top(&self, _: usize) -> Option<f64> {
        None
    }

    fn lamp(&self) -> Point3<f64> {
        Point3::new(1.5, -1.0, 4.0)
    }
}
