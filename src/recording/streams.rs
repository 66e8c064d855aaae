//! Streams of a recording's images, from folders and videos alike.

use super::Recording;
use crate::source::{
    ImageFolder, ReadAhead, ReadOptions, Source, Synchroniser, Times, VideoFile, WhenFull, frames_csv,
};
use crate::{Error, Result};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const VIDEO: &str = "video";
const VIDEOS: &str = "videos";
const EXTENSIONS: [&str; 12] =
    ["mp4", "avi", "mov", "mkv", "webm", "m4v", "mpg", "mpeg", "mts", "m2ts", "wmv", "ogv"];

/// The number of images that are read ahead per camera.
const DEPTH: usize = 3;

/// Options for reading the images of all cameras of a recording.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct StreamOptions {
    /// The number of the first image; earlier ones are skipped.
    pub first: u32,
    /// Images per second; image 0 is at 0 s. Default: the times in `frames.csv`, else the videos' own rates; folders
    /// have the rate of the first video, or 30 images per second.
    pub rate: Option<f64>,
    /// The largest time between images of one set, in seconds. Default: half the shortest period.
    pub bound: Option<f64>,
}

impl Recording {
    /// Whether every camera has images in a folder or a video.
    pub fn has_images(&self) -> bool {
        (0..self.rig.len()).all(|camera| self.has_images_of(camera))
    }

    /// Whether the camera at index `camera` of the rig has images in a folder or a video.
    pub fn has_images_of(&self, camera: usize) -> bool {
        let in_folder = self.images.files.get(camera).is_some_and(|files| !files.is_empty());
        in_folder || self.videos.get(camera).is_some_and(Option::is_some)
    }

    /// The time of each of [`frames`](Self::frames), in increasing seconds: that of the first camera's image of that
    /// number, on the clock of [`source`](Self::source). `None` if neither `options`, `frames.csv` nor a video gives
    /// it.
    ///
    /// # Errors
    /// All errors of [`source`](Self::source); a frame that `frames.csv` does not list for the first camera.
    pub fn frame_times(&self, options: &StreamOptions) -> Result<Option<Vec<f64>>> {
        let first = self.times(options)?.swap_remove(0);
        let times = match (first, &self.videos[0]) {
            (None, Some(video)) => video.rate().map_err(|e| Error::view(self.name(0), e))?.map(Times::Rate),
            (listed, _) => listed,
        };

        let Some(times) = times else { return Ok(None) };
        times.check()?;

        let of = |&frame: &u32| {
            let fail =
                |problem| Error::view(self.name(0), Error::file(self.dir.join(frames_csv::NAME), problem));
            times.of(frame).map_err(fail)
        };
        self.frames().iter().map(of).collect::<Result<_>>().map(Some)
    }

    /// The images of the camera at index `camera` of the rig, from its folder, or else its video.
    ///
    /// # Errors
    /// No such camera, or one without images; all errors of [`ImageFolder`], [`VideoFile::open`] and
    /// [`frames_csv::load`].
    pub fn source(&self, camera: usize, options: &StreamOptions) -> Result<Box<dyn Source>> {
        let n = self.rig.len();
        let times = self.times(options)?;
        match times.into_iter().nth(camera) {
            Some(times) => self.source_with(camera, options, times),
            None => Err(Error::argument(format!("expected a camera below {n}, found {camera}"))),
        }
    }

    /// The images of all cameras, read ahead and grouped by their times; each set is in the rig's order.
    ///
    /// # Errors
    /// All errors of [`source`](Self::source); a bound that is negative or not finite.
    pub fn synchronised(&self, options: &StreamOptions) -> Result<Synchroniser> {
        let mut sources = Vec::new();
        for (camera, times) in self.times(options)?.into_iter().enumerate() {
            sources.push(self.source_with(camera, options, times)?);
        }

        let shortest = sources.iter().filter_map(|source| source.period()).fold(f64::INFINITY, f64::min);
        let default = if shortest.is_finite() { shortest / 2.0 } else { 0.0 };

        let streams = (0..)
            .zip(sources)
            .map(|(camera, source)| ReadAhead::spawn(self.name(camera), source, DEPTH, WhenFull::Wait));
        Synchroniser::new(streams.collect::<Result<_>>()?, options.bound.unwrap_or(default))
    }

    fn source_with(
        &self,
        camera: usize,
        options: &StreamOptions,
        times: Option<Times>,
    ) -> Result<Box<dyn Source>> {
        let name = self.name(camera);
        let read_options =
            ReadOptions { size: Some(self.rig.cameras()[camera].size()), first: options.first, times };

        let named = |e| Error::view(name, e);
        match &self.videos[camera] {
            Some(video) => Ok(Box::new(video.open(read_options).map_err(named)?)),
            None if self.images.files[camera].is_empty() => Err(Error::view(
                name,
                format!("expected images in {name}/image or a video {name}/{VIDEO}.mp4, found neither"),
            )),
            None => {
                let files = self.images.files[camera].clone();
                Ok(Box::new(ImageFolder::of_files(files, read_options).map_err(named)?))
            }
        }
    }

    /// The times of each camera's images; `None` for a video's own rate.
    pub(super) fn times(&self, options: &StreamOptions) -> Result<Vec<Option<Times>>> {
        if let Some(rate) = options.rate {
            return Ok(vec![Some(Times::Rate(rate)); self.rig.len()]);
        }

        let path = self.dir.join(frames_csv::NAME);
        if path.exists() {
            let names: Vec<_> = (0..self.rig.len()).map(|camera| self.name(camera)).collect();
            let listed = frames_csv::load(&path, &names)?;
            return Ok(listed.into_iter().map(|times| Some(Times::Listed(Arc::new(times)))).collect());
        }

        // The header of a video is read only if there are folders that follow its rate.
        let videos = || self.videos.iter().flatten();
        let rate = match videos().next() {
            Some(first) if videos().count() < self.videos.len() => first.rate()?,
            _ => None,
        };
        let of_folder = |video: &Option<VideoFile>| video.is_none().then(|| rate.map(Times::Rate)).flatten();
        Ok(self.videos.iter().map(of_folder).collect())
    }
}

/// The video of a camera in the recording at `dir`, if there is one.
pub(super) fn video_of(dir: &Path, camera: &str) -> Result<Option<VideoFile>> {
    let places = [dir.join(camera).join(VIDEO), dir.join(VIDEOS).join(camera)];
    let mut found = None;
    for path in places.iter().flat_map(|place| with_extensions(place)).filter(|path| path.is_file()) {
        if let Some(other) = found.replace(path.clone()) {
            let problem = format!("expected one video, found also {}; remove one", other.display());
            return Err(Error::file(path, problem));
        }
    }
    Ok(found.map(VideoFile::new))
}

/// The video of a camera that is written in the recording at `dir`, a Matroska file.
pub(super) fn video_path(dir: &Path, camera: &str) -> PathBuf {
    dir.join(camera).join(format!("{VIDEO}.mkv"))
}

/// `place` with each extension of a video, in lower and upper case.
fn with_extensions(place: &Path) -> impl Iterator<Item = PathBuf> {
    EXTENSIONS.iter().flat_map(move |extension| {
        [(*extension).to_owned(), extension.to_uppercase()].map(|extension| {
            // `set_extension` would cut a camera's name at its dot.
            let mut name = place.as_os_str().to_owned();
            name.push(".");
            name.push(extension);
            PathBuf::from(name)
        })
    })
}

#[cfg(test)]
mod tests;
