//! A recording of the cameras of a rig: a folder of images and masks.
//!
//! ```text
//! recording/
//!   rig.toml                    the cameras
//!   <camera>/background.png     the scene without the subject
//!   <camera>/image/000000.*     colour images, one per frame
//!   <camera>/mask/000000.*      masks: 0 background .. 255 subject
//!   <camera>/mask.rle           masks of all frames as run lengths, instead of or beside the folder
//!   <camera>/video.*            a video instead of images (mp4, avi, mov, ...); or videos/<camera>.*
//!   frames.csv                  the images' times, see [`crate::source::frames_csv`]; optional
//! ```
//!
//! Frames are numbered by their file names, those of a video from 0. An image or a mask counts only if every camera
//! has one of that number. Masks may also be called `000000_mask.*`, and may then lie beside the images; [`load_mask`]
//! documents their content, such as cut-out images with an alpha channel. [`Recording::synchronised`] reads the images
//! of folders and videos alike, grouped by their times. [`Recorder`] writes a live capture: videos, `mask.rle`,
//! `frames.csv` and the backgrounds.

use crate::camera::Camera;
use crate::rig::Rig;
use crate::silhouette::{PackedMask, load_mask};
use crate::source::VideoFile;
use crate::{Error, Result, image_file};
use image::{GrayImage, RgbImage};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const RIG: &str = "rig.toml";
const BACKGROUND: &str = "background.png";
const IMAGE: &str = "image";
const MASK: &str = "mask";
const MASK_SUFFIX: &str = "_mask";
const MASK_FILE: &str = "mask.rle";

/// A recording on disk. Images and masks are read on request.
#[derive(Debug, Clone)]
pub struct Recording {
    dir: PathBuf,
    rig: Rig,
    images: Pictures,
    /// The masks; those in a mask file have its path.
    masks: Pictures,
    /// The mask file of each camera.
    mask_files: Vec<MaskFile>,
    /// The video of each camera without an image folder.
    videos: Vec<Option<VideoFile>>,
}

impl Recording {
    /// Opens the recording in folder `dir`.
    ///
    /// # Errors
    /// A missing folder, rig file or camera folder; a rig that [`Rig::load`] refuses; a camera name that cannot be a
    /// folder name; two files of one frame, two videos of one camera; neither images, videos nor masks, or masks
    /// without a frame that all cameras have.
    pub fn open(dir: impl AsRef<Path>) -> Result<Self> {
        let dir = dir.as_ref();
        check_folder(dir)?;
        if !dir.join(RIG).is_file() {
            let problem =
                "expected the recording's rig file, found none; write the cameras' calibration there";
            return Err(Error::file(dir.join(RIG), problem));
        }
        Self::open_with(dir, Rig::load(dir.join(RIG))?)
    }

    /// Opens the recording in folder `dir` with the calibration `rig` in place of its own rig file, which may be
    /// absent.
    ///
    /// # Errors
    /// All errors of [`open`](Self::open), except those about the rig file.
    pub fn open_with(dir: impl AsRef<Path>, rig: Rig) -> Result<Self> {
        let dir = dir.as_ref();
        check_folder(dir)?;
        check_names(&rig)?;

        let recording = Self::list(dir, rig)?;
        let Self { rig, images, masks, mask_files, videos, .. } = &recording;

        for (camera, video) in rig.cameras().iter().zip(videos) {
            let folder = dir.join(camera.name());
            if !folder.is_dir() && video.is_none() {
                let problem =
                    format!("expected the folder {}, found none; name it as in {RIG}", folder.display());
                return Err(Error::view(camera.name(), problem));
            }
        }

        // Masks are optional in a recording of images, but not if some exist.
        let has_common_images =
            !images.common.is_empty() || (videos.iter().any(Option::is_some) && recording.has_images());
        if masks.common.is_empty() && (masks.has_files() || !has_common_images) {
            let wanted = if masks.has_files() || !images.has_files() { masks } else { images };
            let mut problem = wanted.nothing_in_common(rig);
            for (file, frame) in mask_files.iter().filter_map(|file| Some((file, file.cut_off()?))) {
                problem += &format!("; {} ends within the mask of frame {frame}", file.path().display());
            }
            return Err(Error::file(dir, problem));
        }
        Ok(recording)
    }

    /// Lists the files in folder `dir`.
    fn list(dir: &Path, rig: Rig) -> Result<Self> {
        let (images, mut masks) = (Pictures::list(dir, &rig, IMAGE)?, Pictures::list(dir, &rig, MASK)?);

        let mask_file = |camera: &Camera| {
            MaskFile::open(dir.join(camera.name()).join(MASK_FILE)).map_err(|e| Error::view(camera.name(), e))
        };
        let mask_files = rig.cameras().iter().map(mask_file).collect::<Result<Vec<_>>>()?;
        masks.add(&rig, &mask_files)?;

        let video = |(camera, files): (&Camera, &BTreeMap<_, _>)| {
            let video = if files.is_empty() { streams::video_of(dir, camera.name()) } else { Ok(None) };
            video.map_err(|e| Error::view(camera.name(), e))
        };
        let videos = rig.cameras().iter().zip(&images.files).map(video).collect::<Result<_>>()?;

        Ok(Self { dir: dir.to_owned(), rig, images, masks, mask_files, videos })
    }

    /// Starts an empty recording of `rig` in folder `dir`, which is created if necessary.
    ///
    /// # Errors
    /// A folder that holds a recording already, or cannot be camera; a camera name that cannot be a folder name.
    pub fn create(dir: impl AsRef<Path>, rig: &Rig) -> Result<Self> {
        let dir = dir.as_ref();
        check_names(rig)?;
        if dir.join(RIG).exists() {
            let problem = "expected a folder without a recording, found a rig file; choose another folder";
            return Err(Error::file(dir, problem));
        }
        for camera in rig.cameras() {
            make_folder(&dir.join(camera.name()))?;
        }
        rig.save(dir.join(RIG))?;
        Self::list(dir, rig.clone())
    }

    /// Opens the recording of `rig` in folder `dir` for writing, or starts one. It may be empty.
    ///
    /// # Errors
    /// A recording of other cameras; all errors of [`create`](Self::create).
    pub fn resume(dir: impl AsRef<Path>, rig: &Rig) -> Result<Self> {
        let dir = dir.as_ref();
        if !dir.join(RIG).exists() {
            return Self::create(dir, rig);
        }
        let found = Rig::load(dir.join(RIG))?;

        // Writing a rig rounds its numbers, so compare the texts as well.
        if found != *rig && found.to_toml() != Rig::from_toml(&rig.to_toml())?.to_toml() {
            let problem =
                "expected the cameras of the recording in this folder, found others; choose another folder";
            return Err(Error::file(dir.join(RIG), problem));
        }

        Self::list(dir, found)
    }

    /// The cameras; masks and images are in their order.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The numbers of frames with a mask of every camera, ascending; empty only if no camera has any mask.
    pub fn frames(&self) -> &[u32] {
        &self.masks.common
    }

    /// The numbers of frames with an image of every camera in a folder, ascending.
    pub fn image_frames(&self) -> &[u32] {
        &self.images.common
    }

    /// The masks of one frame, one per camera, read by [`load_mask`] or from run lengths.
    ///
    /// # Errors
    /// A frame that is not in [`frames`](Self::frames), a file that [`load_mask`] refuses, or one of another size than
    /// in the rig; messages name the file and the view.
    pub fn masks(&self, frame: u32) -> Result<Vec<GrayImage>> {
        (0..self.rig.len())
            .map(|camera| {
                let path = self.masks.file(&self.rig, camera, frame)?;
                let coded = self.mask_files[camera].read(frame);
                let mask = match coded.map_err(|e| Error::view(self.name(camera), e))? {
                    Some(mask) => mask.to_mask(),
                    None => load_mask(path).map_err(|e| Error::view(self.name(camera), e))?,
                };
                self.check_size(camera, path, mask.dimensions())?;
                Ok(mask)
            })
            .collect()
    }

    /// The colour images of one frame, one per camera.
    ///
    /// # Errors
    /// A frame that is not in [`image_frames`](Self::image_frames), a file that is not an image, or one of another
    /// size than in the rig; messages name the file and the view.
    pub fn images(&self, frame: u32) -> Result<Vec<RgbImage>> {
        (0..self.rig.len())
            .map(|camera| self.colour(camera, self.images.file(&self.rig, camera, frame)?))
            .collect()
    }

    /// Whether the camera at index `camera` of the rig has an image of the scene without the subject.
    pub fn has_background(&self, camera: usize) -> bool {
        let view = self.rig.cameras().get(camera);
        view.is_some_and(|view| self.dir.join(view.name()).join(BACKGROUND).is_file())
    }

    /// The image of the scene without the subject from the camera at index `camera` of the rig.
    ///
    /// # Errors
    /// No such camera; a file that is missing, not an image, or of another size than in the rig.
    pub fn background(&self, camera: usize) -> Result<RgbImage> {
        let Some(view) = self.rig.cameras().get(camera) else {
            let n = self.rig.len();
            return Err(Error::argument(format!("expected a camera below {n}, found {camera}")));
        };
        self.colour(camera, &self.dir.join(view.name()).join(BACKGROUND))
    }

    /// Writes the masks of one frame, one per camera, all of them or none. Existing ones are replaced.
    ///
    /// # Errors
    /// Another number of masks than cameras, a mask of another size than its camera, a file that cannot be camera.
    pub fn write_masks(&mut self, frame: u32, masks: &[GrayImage]) -> Result<()> {
        self.check_sizes("masks", masks.iter().map(GrayImage::dimensions))?;
        self.masks.write(&self.dir, &self.rig, frame, masks)?;
        self.mask_files.iter_mut().filter(|file| file.has(frame)).try_for_each(|file| file.write(frame, None))
    }

    /// Writes the masks of one frame, one per camera, as run lengths at the end of each camera's mask file, all of
    /// them or none. Existing ones are replaced. A mask takes a few hundred bytes, with coverage a few thousand.
    ///
    /// # Errors
    /// All errors of [`write_masks`](Self::write_masks).
    pub fn write_packed_masks(&mut self, frame: u32, masks: &[PackedMask]) -> Result<()> {
        self.check_sizes("masks", masks.iter().map(PackedMask::size))?;
        let states: Vec<_> = self.mask_files.iter().map(|file| file.state(frame)).collect();
        for (camera, mask) in masks.iter().enumerate() {
            make_folder(&self.dir.join(self.name(camera)))?;
            if let Err(e) = self.mask_files[camera].write(frame, Some(mask)) {
                // Undo the masks of the other cameras; if that fails too, the first error is the one to report.
                self.mask_files[..camera]
                    .iter_mut()
                    .zip(states)
                    .for_each(|(file, state)| drop(file.undo(state)));
                return Err(Error::view(self.name(camera), e));
            }
        }
        self.masks.replace(frame, self.mask_files.iter().map(|file| file.path().to_owned()))
    }

    /// Writes the colour images of one frame, one per camera. Existing ones are replaced.
    ///
    /// # Errors
    /// All errors of [`write_masks`](Self::write_masks).
    pub fn write_images(&mut self, frame: u32, images: &[RgbImage]) -> Result<()> {
        self.check_sizes("images", images.iter().map(RgbImage::dimensions))?;
        self.images.write(&self.dir, &self.rig, frame, images)
    }

    /// Writes the images of the scene without the subject, one per camera.
    ///
    /// # Errors
    /// All errors of [`write_masks`](Self::write_masks).
    pub fn write_backgrounds(&self, images: &[RgbImage]) -> Result<()> {
        self.check_sizes("backgrounds", images.iter().map(RgbImage::dimensions))?;
        for (camera, image) in self.rig.cameras().iter().zip(images) {
            image_file::write_png(&self.dir.join(camera.name()).join(BACKGROUND), image)?;
        }
        Ok(())
    }

    fn name(&self, camera: usize) -> &str {
        self.rig.cameras()[camera].name()
    }

    fn colour(&self, camera: usize, path: &Path) -> Result<RgbImage> {
        let image = image_file::read(path).map_err(|e| Error::view(self.name(camera), e))?.into_rgb8();
        self.check_size(camera, path, image.dimensions())?;
        Ok(image)
    }

    fn check_size(&self, camera: usize, path: &Path, (w, h): (u32, u32)) -> Result<()> {
        let (width, height) = self.rig.cameras()[camera].size();
        if (w, h) == (width, height) {
            return Ok(());
        }
        let problem = format!(
            "{}: expected {width} x {height} pixels as {RIG} says, found {w} x {h}; calibrate at the size of the \
             pictures",
            path.display()
        );
        Err(Error::view(self.name(camera), problem))
    }

    fn check_sizes(&self, what: &str, sizes: impl ExactSizeIterator<Item = (u32, u32)>) -> Result<()> {
        if sizes.len() != self.rig.len() {
            let (n, found) = (self.rig.len(), sizes.len());
            return Err(Error::argument(format!(
                "expected {n} {what}, one per camera, found {found}; pass them in the rig's order"
            )));
        }
        sizes
            .enumerate()
            .try_for_each(|(camera, size)| self.check_size(camera, &self.dir.join(self.name(camera)), size))
    }
}

fn check_folder(dir: &Path) -> Result<()> {
    let found = match dir {
        _ if dir.is_dir() => return Ok(()),
        _ if dir.exists() => "a file; give the folder, which holds rig.toml and a folder for each camera",
        _ => "none; check the path",
    };
    Err(Error::file(dir, format!("expected the folder of a recording, found {found}")))
}

/// Camera names become folder names, which must stay inside the recording.
fn check_names(rig: &Rig) -> Result<()> {
    let bad = |name: &str| matches!(name, "." | "..") || name.contains(['/', '\\', '\0']);
    match rig.cameras().iter().find(|camera| bad(camera.name())) {
        None => Ok(()),
        Some(camera) => {
            let problem =
                "expected a name that can be a folder name, found \"/\", \"\\\", \".\" or \"..\"; rename it";
            Err(Error::camera(camera.name(), problem))
        }
    }
}

fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::file(folder, format!("expected to create this folder, found: {e}")))
}

mod mask_file;
mod pictures;
mod recorder;
mod round;
mod streams;

use mask_file::MaskFile;
use pictures::Pictures;
pub use recorder::{Recorder, RecorderOptions, RecordingSummary};
pub use streams::StreamOptions;

#[cfg(test)]
mod tests;
