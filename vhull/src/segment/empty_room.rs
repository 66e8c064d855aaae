//! Images of the background without the subject, for each camera.

use super::Options;
use image::RgbImage;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::source::{ReadOptions, Source, Video};
use ode_visual_hull::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Number of images, evenly spread, taken of a longer clip: enough for the mean and the noise of each pixel.
const IMAGES: u32 = 24;

/// Images of the background without the subject.
pub struct EmptyRoom {
    /// At least one image per camera, all of the camera's size.
    pub images: Vec<Vec<RgbImage>>,
}

impl EmptyRoom {
    /// Reads the images named by the options, by default the `background` files of the recording.
    pub fn find(options: &Options, recording: &Recording, streaming: &StreamOptions) -> Result<Self> {
        let images = of_each_camera(recording, |camera| {
            if let Some(count) = options.empty {
                let mut source = recording.source(camera, streaming)?;
                if let Some(found) = source.frames_left().filter(|&found| found < count) {
                    let problem =
                        format!("--empty: expected at least {count} images, found {found}; give fewer");
                    return Err(Error::argument(problem));
                }
                return evenly_spaced(&mut *source, count);
            }
            let calibrated = &recording.rig().cameras()[camera];
            read(&background(options, calibrated.name())?, calibrated.size())
        })?;
        Ok(Self { images })
    }
}

/// Reads up to [`IMAGES`] images of each camera, evenly spread over the recording.
pub fn throughout(recording: &Recording, streaming: &StreamOptions) -> Result<Vec<Vec<RgbImage>>> {
    of_each_camera(recording, |camera| {
        let mut source = recording.source(camera, streaming)?;
        let count = source.frames_left().unwrap_or(u32::MAX);
        evenly_spaced(&mut *source, count)
    })
}

/// Calls `images` with the index of each camera, on a thread per camera because decoding videos is slow.
fn of_each_camera(
    recording: &Recording,
    images: impl Fn(usize) -> Result<Vec<RgbImage>> + Sync,
) -> Result<Vec<Vec<RgbImage>>> {
    let cameras = recording.rig().cameras();
    let images = &images;
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..cameras.len()).map(|camera| scope.spawn(move || images(camera))).collect();
        let joined = threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        joined
            .zip(cameras)
            .map(|(images, camera)| images.map_err(|e| Error::view(camera.name(), e)))
            .collect()
    })
}

/// Path of the image or video of a camera's background.
fn background(options: &Options, camera: &str) -> Result<PathBuf> {
    let in_recording = options.recording.join(camera);
    let (folder, stems) = match &options.background {
        None => (in_recording, vec![PathBuf::from("background")]),
        Some(folder) if folder.is_dir() => {
            (folder.clone(), vec![PathBuf::from(camera), Path::new(camera).join("background")])
        }
        Some(file) => {
            let path = in_recording.join(file);
            return if path.is_file() { Ok(path) } else { Err(Error::file(path, ABSENT)) };
        }
    };

    for stem in &stems {
        let place = folder.join(stem);
        let beside = place.parent().and_then(|parent| std::fs::read_dir(parent).ok());
        let mut found: Vec<_> = beside.into_iter().flatten().flatten().map(|entry| entry.path()).collect();

        // Images go before videos, then names in order, so that the choice does not depend on the file system.
        found.retain(|path| path.is_file() && path.with_extension("") == place);
        found.sort_by_key(|path| (!is_picture(path), path.clone()));
        if let Some(path) = found.into_iter().next() {
            return Ok(path);
        }
    }
    Err(Error::file(folder.join(&stems[0]), ABSENT))
}

const ABSENT: &str = "expected an image or a video of the background without the subject, found none; put one there \
                      (background.png), name it with --background, or set --empty to the number of first images that \
                      show it";

fn is_picture(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ["png", "jpg", "jpeg", "ppm", "pnm"].contains(&extension.to_ascii_lowercase().as_str())
}

/// Reads an image, or images spread over a video, of the given size in pixels.
fn read(path: &Path, size: (u32, u32)) -> Result<Vec<RgbImage>> {
    if !is_picture(path) {
        let mut video = Video::open(path, ReadOptions { size: Some(size), ..ReadOptions::default() })?;
        let count = video.frames_left().unwrap_or(u32::MAX);
        return evenly_spaced(&mut video, count);
    }

    let image = image::ImageReader::open(path)
        .and_then(image::ImageReader::with_guessed_format)
        .map_err(image::ImageError::IoError)
        .and_then(image::ImageReader::decode)
        .map_err(|e| Error::file(path, format!("expected an image of the background, found: {e}")))?
        .into_rgb8();

    if image.dimensions() == size {
        return Ok(vec![image]);
    }
    let ((w, h), (width, height)) = (image.dimensions(), size);
    let problem =
        format!("expected {width} x {height} pixels as in the calibration, found {w} x {h}; scale the image");
    Err(Error::file(path, problem))
}

/// At most [`IMAGES`] of the first `count` images, evenly spread, or the first ones if `count` is `u32::MAX` (unknown).
fn evenly_spaced(source: &mut dyn Source, count: u32) -> Result<Vec<RgbImage>> {
    let step = if count == u32::MAX { 1 } else { count.div_ceil(IMAGES).max(1) };
    let mut images = Vec::new();
    for index in 0..count.min(step * IMAGES) {
        match source.next_frame() {
            Some(frame) if index % step == 0 => images.push(Arc::unwrap_or_clone(frame?.image)),
            Some(frame) => drop(frame?),
            None => break,
        }
    }
    Ok(images)
}
