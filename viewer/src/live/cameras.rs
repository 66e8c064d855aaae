//! The cameras of a live system.

use super::priority::Work;
use super::rendered::Rendered;
use super::stamped::Stamped;
use image::RgbImage;
use nalgebra::Point3;
use ode_visual_hull::camera::Camera;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::{
    Clock, Device, DeviceOptions, Images, Paced, ReadAhead, ReconnectOptions, Reconnecting, Round, Source,
    Start, StatusHandle, WhenFull,
};
use ode_visual_hull::synthetic::{PERSON_PERIOD, Subject, layout};
use ode_visual_hull::{Error, Result};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Images a second of real cameras whose rate is not given.
const ASSUMED_RATE: f64 = 30.0;

/// Images of a recording that each camera has decoded before they are due: decoding waits for other work at times.
const DECODED_AHEAD: usize = 4;

/// Cameras that deliver images by a clock.
pub struct LiveCameras {
    pub(super) rig: Rig,
    /// One for each camera of the rig.
    pub(super) sources: Vec<Box<dyn Source>>,
    /// How real cameras are doing, one for each; none for others.
    pub(super) statuses: Vec<StatusHandle>,
    /// Seconds from one image to the next.
    pub(super) period: f64,
    /// Images of the empty room by each camera; `None` where it has to be learnt.
    pub(super) empty_room: Option<Vec<Vec<RgbImage>>>,
    pub(super) clock: Clock,
}

impl LiveCameras {
    /// So many synthetic cameras, with images of `size` pixels, `rate` of them a second, around a person who walks on the spot
    /// and waves.
    ///
    /// # Errors
    /// No camera, a size of zero, a rate that is not positive.
    pub fn synthetic(count: usize, size: (u32, u32), rate: f64, clock: &Clock) -> Result<Self> {
        let frames = (PERSON_PERIOD * rate).round().max(1.0);
        let person = |k: u32| Subject::person_at(PERSON_PERIOD * f64::from(k) / frames);
        let subjects: Vec<_> = (0..frames as u32).map(person).collect();
        Self::rendered(&subjects, count, size, rate, clock)
    }

    /// So many synthetic cameras around `subjects`, which are seen one after the other, again and again.
    ///
    /// # Errors
    /// As [`synthetic`](Self::synthetic).
    pub fn rendered(
        subjects: &[Subject],
        count: usize,
        size: (u32, u32),
        rate: f64,
        clock: &Clock,
    ) -> Result<Self> {
        let target = Point3::new(0.0, 0.0, 0.9);
        let cameras = layout::staggered(count, 3.2, &[1.1, 2.4, 0.6], target, size, 0.75)?;
        let rendered = Rendered::new(&cameras, subjects)?;
        let round = Round::at_rate(subjects.len() as u32, rate)?;
        // One for all: images of one moment would have times that differ by how long it takes to open a source.
        let start = clock.now();
        let source = |images: Vec<RgbImage>| -> Result<Box<dyn Source>> {
            let images = Images::new(images, rate)?;
            let open = move || Ok(Box::new(images.clone()) as _);
            Ok(Box::new(Paced::looped(clock, round.clone(), start, open)?))
        };
        Ok(Self {
            sources: rendered.images.into_iter().map(source).collect::<Result<_>>()?,
            statuses: Vec::new(),
            empty_room: Some(rendered.empty_room.into_iter().map(|image| vec![image]).collect()),
            rig: Rig::new(cameras)?,
            period: 1.0 / rate,
            clock: clock.clone(),
        })
    }

    /// The cameras, the source of each, and the seconds from one image to the next.
    pub fn into_sources(self) -> (Rig, Vec<Box<dyn Source>>, f64) {
        (self.rig, self.sources, self.period)
    }

    /// The cameras of the recording in folder `dir`, which is played by the clock, again and again; at `rate` images a second
    /// where it is given.
    ///
    /// # Errors
    /// A folder that is no recording, a camera without images, a background that cannot be read.
    pub fn of_recording(dir: &Path, rate: Option<f64>, clock: &Clock) -> Result<Self> {
        let recording = Arc::new(Recording::open(dir)?);
        let options = StreamOptions { rate, ..StreamOptions::default() };
        let round = recording.round(&options)?;
        let (rig, start) = (recording.rig().clone(), Start::default());
        let source = |camera: usize| -> Result<Box<dyn Source>> {
            let opened = recording.clone();
            let open = move || {
                // On a thread of its own, whose priority ffmpeg has too.
                Work::Decoding.set_priority();
                let (name, source) =
                    (opened.rig().cameras()[camera].name(), opened.source(camera, &options)?);
                Ok(Box::new(ReadAhead::spawn(name, source, DECODED_AHEAD, WhenFull::Wait)?) as _)
            };
            // One after the other, the last of them in time.
            let part = (camera as f64 + 0.5) / (rig.len() + 1) as f64;
            Ok(Box::new(Paced::looped(clock, round.clone(), start.clone(), open)?.opening_after(part)))
        };
        let sources = (0..rig.len()).map(source).collect::<Result<Vec<_>>>()?;
        let period = sources.iter().filter_map(|source| source.period()).fold(f64::INFINITY, f64::min);
        Ok(Self {
            sources,
            statuses: Vec::new(),
            period: if period.is_finite() { period } else { 1.0 / ASSUMED_RATE },
            empty_room: backgrounds(&recording)?,
            rig,
            clock: clock.clone(),
        })
    }

    /// The real cameras of `rig`: the device or the address of the stream of each, by its name in the rig. They are opened
    /// again whenever they are lost.
    ///
    /// # Errors
    /// A camera of the rig without a device, a name that the rig does not have.
    pub fn real(
        rig: &Rig,
        devices: &[(String, String)],
        options: &DeviceOptions,
        clock: &Clock,
    ) -> Result<Self> {
        check_names(rig, devices)?;
        let epoch = Instant::now();
        let (mut sources, mut statuses): (Vec<Box<dyn Source>>, _) = (Vec::new(), Vec::new());
        for camera in rig.cameras() {
            let Some((_, device)) = devices.iter().find(|(name, _)| name == camera.name()) else { continue };
            let reconnect = ReconnectOptions { size: Some(camera.size()), ..ReconnectOptions::default() };
            let (device, options) = (device.clone(), options_of(device, camera, options));
            let open = move || Ok(Box::new(Device::start(&device, &options, epoch)?) as _);
            let source = Reconnecting::new(reconnect, open)?;
            statuses.push(source.status_handle());
            sources.push(Box::new(Stamped::new(source, clock)));
        }
        Ok(Self {
            rig: rig.clone(),
            sources,
            statuses,
            period: 1.0 / options.rate.unwrap_or(ASSUMED_RATE),
            empty_room: None,
            clock: clock.clone(),
        })
    }
}

/// How `device` is opened: a path is a device, an address a stream, which has a size of its own.
fn options_of(device: &str, camera: &Camera, options: &DeviceOptions) -> DeviceOptions {
    if device.contains("://") || !device.starts_with("/dev/") {
        return DeviceOptions::stream();
    }
    DeviceOptions { size: Some(camera.size()), ..options.clone() }
}

fn check_names(rig: &Rig, devices: &[(String, String)]) -> Result<()> {
    let names: Vec<_> = rig.cameras().iter().map(Camera::name).collect();
    if let Some((name, _)) = devices.iter().find(|(name, _)| !names.contains(&name.as_str())) {
        return Err(Error::argument(format!(
            "--camera: expected one of {}, the cameras of the rig, found {name}",
            names.join(", ")
        )));
    }
    let is_given = |name: &&&str| devices.iter().any(|(other, _)| other == **name);
    match names.iter().find(|name| !is_given(name)) {
        Some(name) => Err(Error::argument(format!(
            "--camera: expected one for each of {}, found none for {name}; add --camera {name}=SOURCE, or take it out of the rig",
            names.join(", ")
        ))),
        None => Ok(()),
    }
}

/// The background images of a recording, if all cameras have one.
fn backgrounds(recording: &Recording) -> Result<Option<Vec<Vec<RgbImage>>>> {
    let cameras = 0..recording.rig().len();
    if !cameras.clone().all(|camera| recording.has_background(camera)) {
        return Ok(None);
    }
    cameras.map(|camera| Ok(vec![recording.background(camera)?])).collect::<Result<_>>().map(Some)
}
