//! A recording as a capture: its first frame is held for a while, then it plays at its own pace.

use super::background_images::{BackgroundImages, FrameTime};
use super::frame_times::{ASSUMED_RATE, FrameTimes};
use super::hulls::{RecordedHulls, evenly_spaced};
use super::timeline::{Publication, Timeline};
use crate::arguments::{VolumeOptions, shown_frames};
use crate::capture::{FRAME_RATE, Frames, Story};
use crate::playback_options::PlaybackOptions;
use crate::window::Window;
use image::{GrayImage, RgbImage};
use nalgebra::{Point3, Vector3};
use ode_visual_hull::camera::{Camera, Ray};
use ode_visual_hull::hull::{Aabb, Hull, HullData};
use ode_visual_hull::pipeline::publish_masks;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::synthetic::Hit;
use ode_visual_hull::{Error, Result};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Margin around the subject that is drawn, in metres.
const MARGIN: f64 = 0.4;

/// Number of frames whose hulls are made beforehand, to know where the subject will be.
const SAMPLED_FRAMES: usize = 24;

/// A recording that is played.
pub struct Playback {
    recording: Recording,
    frame_times: FrameTimes,
    /// The recorded frames that are played, and when.
    frames: Vec<FrameTime>,
    timeline: Timeline,
    /// How it is played, with all that is left to the recording filled in.
    options: PlaybackOptions,
    /// The hulls of some frames, starting with the first frame.
    sampled_hulls: Vec<Arc<Hull>>,
    /// The part of the world that the film shows.
    shown: Aabb,
    /// What is published, and its masks.
    published: Option<Publication>,
    masks: Vec<GrayImage>,
    /// The images of each view, opened with its first picture.
    backgrounds: Vec<Option<BackgroundImages>>,
}

impl Playback {
    /// Adds the cameras of `recording`, which was opened in folder `dir`, to `data` and publishes its first frame.
    ///
    /// # Errors
    /// No masks, or none of the wanted frames; an empty hull in the first one; masks or times that cannot be read.
    pub fn new(recording: Recording, dir: &Path, options: &PlaybackOptions, data: &HullData) -> Result<Self> {
        let frame_times = FrameTimes::of(&recording, options.rate)?;
        options.volume.prepare(data, recording.rig())?;
        let recorded = RecordedHulls::new(recording, dir, &options.volume)?;
        let frames = frames_of(&recorded.recording, &frame_times, options.frames.as_ref())?;

        // The hulls of some frames show where the subject will be.
        let sampled = evenly_spaced(frames.len(), SAMPLED_FRAMES);
        let sampled_hulls = sampled.map(|k| recorded.hull(frames[k].0)).collect::<Result<Vec<_>>>()?;
        check_subject(dir, frames[0].0, &sampled_hulls[0])?;

        let times: Vec<f64> = frames.iter().map(|&(_, time)| time).collect();
        let options = filled_in(options, &recorded.recording, &frame_times, &frames)?;
        let backgrounds = recorded.recording.rig().cameras().iter().map(|_| None).collect();
        let shown = sampled_hulls.iter().map(|hull| *hull.aabb()).filter(|aabb| !aabb.is_empty());
        let mut playback = Self {
            recording: recorded.recording,
            frame_times,
            frames,
            timeline: Timeline::new(&times, options.wait, options.linger),
            options,
            shown: shown.reduce(|a, b| a.union(&b)).unwrap_or(*sampled_hulls[0].aabb()).grown(MARGIN),
            sampled_hulls,
            published: None,
            masks: Vec::new(),
            backgrounds,
        };
        playback.publish(0.0, data)?;

        Ok(playback)
    }

    /// Number of recorded frames that are played, and their duration in seconds.
    pub fn pace(&self) -> (usize, f64) {
        (self.frames.len(), self.timeline.duration())
    }

    /// The time between recorded frames on average, in seconds.
    pub fn period(&self) -> f64 {
        self.timeline.period()
    }

    /// Whether the recording states no times, so that a rate is assumed.
    pub fn is_rate_assumed(&self) -> bool {
        self.frame_times.is_assumed
    }

    /// Size of a pixel at the subject, in metres.
    pub fn pixel_size(&self) -> f64 {
        self.first().pixel_size(&self.first().aabb().centre())
    }

    /// The hull of the first frame.
    pub fn first(&self) -> &Hull {
        &self.sampled_hulls[0]
    }

    /// The hulls of frames spread over the recording, starting with the first one.
    pub fn sampled_hulls(&self) -> &[Arc<Hull>] {
        &self.sampled_hulls
    }

    /// Lets the film show bodies too that stand within `width` of `foot`, up to `height` above it.
    pub fn show(&mut self, foot: &Point3<f64>, width: f64, height: f64) {
        let top = foot + Vector3::z() * height;
        self.shown = self.shown.union(&Aabb::of_points([foot, &top]).grown(width));
    }
}

/// The recorded frames to play; at least one.
fn frames_of(
    recording: &Recording,
    frame_times: &FrameTimes,
    wanted: Option<&Range<u32>>,
) -> Result<Vec<FrameTime>> {
    let all = recording.frames();
    let (first, last) = (all[0], all[all.len() - 1]);
    let wanted = wanted.cloned().unwrap_or(0..u32::MAX);
    let moments = all.iter().copied().zip(frame_times.times.iter().copied());
    let frames: Vec<FrameTime> = moments.filter(|(frame, _)| wanted.contains(frame)).collect();
    if frames.is_empty() {
        return Err(Error::argument(format!(
            "--frames: expected frames of the recording, which has masks from {first} to {last}, found none in {}",
            shown_frames(&wanted)
        )));
    }
    Ok(frames)
}

/// The options with what they leave to the recording: the numbers of the `frames`, an assumed rate, the work volume.
fn filled_in(
    options: &PlaybackOptions,
    recording: &Recording,
    frame_times: &FrameTimes,
    frames: &[FrameTime],
) -> Result<PlaybackOptions> {
    let (first, last) = (frames[0].0, frames[frames.len() - 1].0);
    let volume = VolumeOptions { bounds: Some(options.volume.of(recording.rig())?), ..options.volume };
    let assumed = frame_times.is_assumed.then_some(ASSUMED_RATE);
    Ok(PlaybackOptions {
        frames: Some(first..last.saturating_add(1)),
        rate: options.rate.or(assumed),
        volume,
        ..options.clone()
    })
}

/// Checks that there is a subject in `frame` of the recording in folder `dir`, whose hull is `hull`.
///
/// # Errors
/// The hull is empty.
pub fn check_subject(dir: &Path, frame: u32, hull: &Hull) -> Result<()> {
    let Some(why) = hull.empty_reason() else { return Ok(()) };
    let problem = format!(
        "expected a subject in frame {frame}, found an empty hull ({why:?}); set --bounds, or --unseen abstain where no \
         point is in sight of all cameras"
    );
    Err(Error::file(dir, problem))
}

impl Frames for Playback {
    fn cameras(&self) -> &[Camera] {
        self.recording.rig().cameras()
    }

    fn publish(&mut self, time: f64, data: &HullData) -> Result<()> {
        let due = self.timeline.at(time);
        if self.published == Some(due) {
            return Ok(());
        }
        if self.published.is_none_or(|published| published.frame != due.frame) {
            self.masks = self.recording.masks(self.frames[due.frame].0)?;
        }
        publish_masks(data, &self.masks, due.time)?;
        self.published = Some(due);
        Ok(())
    }

    /// The nearest recorded image, else the mask.
    fn picture(&mut self, view: usize, time: f64) -> Result<RgbImage> {
        let moment = self.frames[self.timeline.nearest(time)];
        let Self { recording, frame_times, backgrounds, .. } = self;
        let images = match &mut backgrounds[view] {
            Some(images) => images,
            none => none.insert(BackgroundImages::open(
                recording,
                view,
                moment,
                &frame_times.streaming,
                f64::INFINITY,
            )?),
        };
        images.at(recording, moment)
    }

    /// The hull stands for the subject.
    fn hit(&self, ray: &Ray, view: usize, hull: &Hull) -> Option<Hit> {
        // Most rays miss: those beside the camera's own silhouette, and those beside the hull's box.
        let view = hull.views().get(view)?;
        let (i, j) = view.pixel(&ray.at(1.0))?;
        if !view.silhouette().is_subject(i, j) {
            return None;
        }
        let (near, _, _) = hull.aabb().span(&ray.origin, &ray.direction)?;
        // Starts just before the box, since a ray that starts inside the hull has no entry.
        let start = (near - 0.01).max(0.0);
        let (entry, _) = hull.ray_cast(&Ray { origin: ray.at(start), ..*ray })?;
        entry.map(|entry| Hit { t: start + entry.t, normal: entry.normal })
    }

    fn real_top(&self) -> Option<f64> {
        None
    }
}

impl Story for Playback {
    fn subject(&self) -> &str {
        "subject"
    }

    fn frames(&self) -> usize {
        self.timeline.film_frames()
    }

    fn still_until(&self) -> f64 {
        self.options.wait
    }

    fn moments(&self) -> [f64; 3] {
        let end = self.frames() as f64 / FRAME_RATE;
        [0.2, self.options.wait - 0.1, 0.5 * (self.options.wait + end)]
    }

    /// The nearest camera.
    fn best_view(&self) -> usize {
        let middle = self.first().aabb().centre();
        let distance = |&view: &usize| (self.cameras()[view].centre() - middle).norm();
        (0..self.cameras().len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }

    /// Around the places where the subject comes and where bodies fall.
    fn window(&self, view: usize) -> Window {
        let mut around = self.shown;
        around.min.z = 0.0;
        Window::around(&self.cameras()[view], &around.corners())
    }

    fn light(&self) -> Point3<f64> {
        Point3::new(1.5, -1.0, 4.0)
    }

    fn playback(&self) -> Option<PlaybackOptions> {
        Some(self.options.clone())
    }
}
