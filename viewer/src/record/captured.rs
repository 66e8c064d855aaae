//! Scenes of recorded frames, and of the frames of a finished run.

use crate::scene::{RealCameras, Scene};
use image::RgbImage;
use nalgebra::Point3;
use ode_visual_hull::hull::{Aabb, Hull, HullData};
use ode_visual_hull::recording::Recording;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::{
    FinishedRun, Frames, Playback, PlayedRecording, RecordedHulls, STEPS_PER_SECOND, VolumeOptions,
    check_subject,
};
use std::path::Path;
use std::sync::Arc;

/// Bodies up to this far from the work volume are shown by a tour around the subject, in metres.
const NEARBY: f64 = 3.0;

/// The frames of a recording as scenes, in any order.
pub struct CapturedFrames {
    hulls: RecordedHulls,
    cameras: RealCameras,
    dir: std::path::PathBuf,
}

/// The frames of a finished run as scenes, from the first to the last.
pub struct FinishedScenes {
    run: FinishedRun,
    played: PlayedRecording,
    playback: Playback,
    data: HullData,
    cameras: RealCameras,
    has_images: Vec<bool>,
    /// The next step of the simulation whose masks are published.
    step: u64,
}

impl CapturedFrames {
    /// The frames of the recording in folder `dir`.
    ///
    /// # Errors
    /// A folder that is no recording, one without masks, an invalid work volume.
    pub fn open(dir: &Path, volume: &VolumeOptions) -> Result<Self> {
        let hulls = RecordedHulls::new(Recording::open(dir)?, dir, volume)?;
        let cameras = RealCameras::new(hulls.recording.rig().cameras());
        Ok(Self { hulls, cameras, dir: dir.to_owned() })
    }

    /// The real cameras.
    pub fn cameras(&self) -> &RealCameras {
        &self.cameras
    }

    /// The number of the first frame that has both masks and images.
    ///
    /// # Errors
    /// There is none.
    pub fn first_frame(&self) -> Result<u32> {
        let (masks, images) = (self.hulls.recording.frames(), self.hulls.recording.image_frames());
        masks.iter().copied().find(|frame| images.contains(frame)).ok_or_else(|| {
            let found = format!("masks of {}, images of {}", numbers(masks), numbers(images));
            Error::file(&self.dir, format!("expected a frame with masks and images, found {found}"))
        })
    }

    /// The scene of `frame`.
    ///
    /// # Errors
    /// No such frame, files that cannot be read, a hull that is empty, images that are missing or of another size than the
    /// masks.
    pub fn scene(&self, frame: u32) -> Result<Scene> {
        self.hulls.check_has(frame)?;
        let hull = self.hulls.hull(frame)?;
        check_subject(&self.dir, frame, &hull)?;
        let recording = &self.hulls.recording;
        if !recording.image_frames().contains(&frame) {
            return Err(Error::file(
                &self.dir,
                format!(
                    "expected images of frame {frame}, found none; frames with images: {}",
                    numbers(recording.image_frames())
                ),
            ));
        }
        let images: Vec<_> = recording.images(frame)?.into_iter().map(Some).collect();
        self.cameras.scene(&hull, images)
    }
}

impl FinishedScenes {
    /// The frames of the run whose states are in the file `states`, beside the file that describes its bodies, and whose subject
    /// is in the recording in folder `dir`.
    ///
    /// # Errors
    /// Files that cannot be read or do not belong together, a recording that cannot be played.
    pub fn open(dir: &Path, states: &Path) -> Result<Self> {
        let bodies = states.with_file_name(ode_visual_hull_film::BodiesFile::NAME);
        let run = FinishedRun::read(states, &bodies)?;
        let played = run.playback().cloned().ok_or_else(|| {
            Error::file(
                &bodies,
                "expected a [playback] table, found none: the run played no recording; make it again with vhull run",
            )
        })?;
        let recording = Recording::open(dir)?;
        let has_images = (0..recording.rig().cameras().len()).map(|view| recording.has_images_of(view));
        let has_images: Vec<bool> = has_images.collect();
        let cameras = RealCameras::new(recording.rig().cameras());
        let data = HullData::new();
        let playback = Playback::new(recording, dir, &played.options, &data)?;
        Ok(Self { run, played, playback, data, cameras, has_images, step: 0 })
    }

    /// The real cameras.
    pub fn cameras(&self) -> &RealCameras {
        &self.cameras
    }

    /// The times of the frames, in seconds of the film.
    pub fn times(&self) -> &[f64] {
        self.run.times()
    }

    /// A box around all places where the subject is, and where the bodies are in the first frame.
    pub fn shown_box(&self) -> Aabb {
        let hulls = self.playback.sampled_hulls().iter().map(|hull| *hull.aabb());
        let subject = hulls.filter(|aabb| !aabb.is_empty()).reduce(|a, b| a.union(&b));
        let subject = subject.unwrap_or(*self.playback.first().aabb());
        let bodies = self.run.drawn(0).into_iter().map(|body| body.world_from_body.translation.vector.into());
        // Bodies that do not exist yet are far below the floor.
        let nearby = self.data.bounds().map(|bounds| bounds.grown(NEARBY));
        let is_near = |place: &Point3<f64>| nearby.is_none_or(|nearby| nearby.contains(place));
        let places: Vec<Point3<f64>> = bodies.filter(is_near).collect();
        if places.is_empty() { subject } else { subject.union(&Aabb::of_points(&places)) }
    }

    /// The scene of frame `k`. Frames have to be asked for in their order.
    ///
    /// # Errors
    /// Masks or images that cannot be read, a hull that is empty.
    pub fn scene(&mut self, k: usize) -> Result<Scene> {
        let time = self.run.collided_at(k);
        while self.step as f64 / STEPS_PER_SECOND <= time {
            self.playback.publish(self.step as f64 / STEPS_PER_SECOND, &self.data)?;
            self.step += 1;
        }
        let hull = self.data.in_motion(self.played.motion, time)?;
        let images = self.images(&hull)?;
        let mut scene = self.cameras.scene(&hull, images)?;
        scene.bodies = self.run.drawn(k);
        Ok(scene)
    }

    fn images(&mut self, hull: &Arc<Hull>) -> Result<Vec<Option<RgbImage>>> {
        let Self { playback, has_images, .. } = self;
        let image =
            |(view, has): (usize, &bool)| has.then(|| playback.picture(view, hull.time())).transpose();
        has_images.iter().enumerate().map(image).collect()
    }
}

/// Numbers in words, at most the first ten.
fn numbers(frames: &[u32]) -> String {
    let first: Vec<_> = frames.iter().take(10).map(u32::to_string).collect();
    let more = if frames.len() > 10 { ", .." } else { "" };
    if first.is_empty() { "none".into() } else { format!("{}{more}", first.join(", ")) }
}
