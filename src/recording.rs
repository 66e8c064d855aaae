//! What the cameras of a rig recorded: a folder of images and masks.
//!
//! ```text
//! recording/
//!   rig.toml                    the cameras
//!   <camera>/background.png     the place without the subject
//!   <camera>/image/000000.*     colour images, one per frame
//!   <camera>/mask/000000.*      masks: 0 background .. 255 subject
//! ```
//!
//! Masks may be called `000000_mask.*` too, and may then lie beside the images; [`load_mask`] says what may be in them,
//! such as cut-out images with an alpha channel. Frames are numbered by their file names. An image or a mask counts only where every camera has one.

use crate::rig::Rig;
use crate::silhouette::load_mask;
use crate::{Error, Result, image_file};
use image::{GrayImage, RgbImage};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const RIG: &str = "rig.toml";
const BACKGROUND: &str = "background.png";
const IMAGE: &str = "image";
const MASK: &str = "mask";
const MASK_SUFFIX: &str = "_mask";
const EXTENSIONS: [&str; 6] = ["png", "jpg", "jpeg", "pgm", "ppm", "pnm"];

/// A recording on disk. Pictures are read when they are asked for.
#[derive(Debug, Clone)]
pub struct Recording {
    dir: PathBuf,
    rig: Rig,
    images: Pictures,
    masks: Pictures,
}

/// One kind of picture, of all cameras.
#[derive(Debug, Clone)]
struct Pictures {
    kind: &'static str,
    /// Per camera the file of each frame.
    files: Vec<BTreeMap<u32, PathBuf>>,
    /// The frames that all cameras have, ascending.
    common: Vec<u32>,
}

impl Recording {
    /// Opens the recording in folder `dir`.
    ///
    /// # Errors
    /// A missing folder, rig file or camera folder; a rig that [`Rig::load`] refuses; a camera name that cannot be a
    /// folder's; two files of one frame; neither images nor masks, or masks of which no frame has all.
    pub fn open(dir: impl AsRef<Path>) -> Result<Self> {
        let dir = dir.as_ref();
        if !dir.is_dir() {
            let problem = "expected the folder of a recording, found none; check the path";
            return Err(Error::file(dir, problem));
        }
        if !dir.join(RIG).is_file() {
            let problem =
                "expected the recording's rig file, found none; write the cameras' calibration there";
            return Err(Error::file(dir.join(RIG), problem));
        }
        let rig = Rig::load(dir.join(RIG))?;
        check_names(&rig)?;
        for camera in rig.cameras() {
            let folder = dir.join(camera.name());
            if !folder.is_dir() {
                let problem =
                    format!("expected the folder {}, found none; name it as in {RIG}", folder.display());
                return Err(Error::view(camera.name(), problem));
            }
        }
        let (images, masks) = (Pictures::list(dir, &rig, IMAGE)?, Pictures::list(dir, &rig, MASK)?);
        if masks.common.is_empty() && (masks.any() || images.common.is_empty()) {
            let wanted = if masks.any() || !images.any() { &masks } else { &images };
            return Err(Error::file(dir, wanted.nothing_in_common(&rig)));
        }
        Ok(Self { dir: dir.to_owned(), rig, images, masks })
    }

    /// Starts an empty recording of `rig` in folder `dir`, which is made if need be.
    ///
    /// # Errors
    /// A folder that holds a recording already, or cannot be written; a camera name that cannot be a folder's.
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
        let (images, masks) = (Pictures::list(dir, rig, IMAGE)?, Pictures::list(dir, rig, MASK)?);
        Ok(Self { dir: dir.to_owned(), rig: rig.clone(), images, masks })
    }

    /// The cameras; masks and images come in their order.
    pub fn rig(&self) -> &Rig {
        &self.rig
    }

    /// The frames of which every camera has a mask, ascending; none only if no camera has any mask.
    pub fn frames(&self) -> &[u32] {
        &self.masks.common
    }

    /// The frames of which every camera has an image, ascending.
    pub fn image_frames(&self) -> &[u32] {
        &self.images.common
    }

    /// The masks of one frame, one per camera, as [`load_mask`] reads them.
    ///
    /// # Errors
    /// A frame that is not in [`frames`](Self::frames), a file that [`load_mask`] refuses or of another size than the
    /// rig says; messages name the file and the view.
    pub fn masks(&self, frame: u32) -> Result<Vec<GrayImage>> {
        (0..self.rig.len())
            .map(|camera| {
                let path = self.masks.file(&self.rig, camera, frame)?;
                let mask = load_mask(path).map_err(|e| Error::view(self.name(camera), e))?;
                self.check_size(camera, path, mask.dimensions())?;
                Ok(mask)
            })
            .collect()
    }

    /// The colour images of one frame, one per camera.
    ///
    /// # Errors
    /// A frame that is not in [`image_frames`](Self::image_frames), a file that is no image or of another size than
    /// the rig says; messages name the file and the view.
    pub fn images(&self, frame: u32) -> Result<Vec<RgbImage>> {
        (0..self.rig.len())
            .map(|camera| self.colour(camera, self.images.file(&self.rig, camera, frame)?))
            .collect()
    }

    /// The colour image without the subject, of the camera at position `camera` of the rig.
    ///
    /// # Errors
    /// No such camera; a file that is missing, no image, or of another size than the rig says.
    pub fn background(&self, camera: usize) -> Result<RgbImage> {
        let Some(view) = self.rig.cameras().get(camera) else {
            let n = self.rig.len();
            return Err(Error::argument(format!("expected a camera below {n}, found {camera}")));
        };
        self.colour(camera, &self.dir.join(view.name()).join(BACKGROUND))
    }

    /// Writes the masks of one frame, one per camera, over any that are there.
    ///
    /// # Errors
    /// Another number of masks than cameras, a mask of another size than its camera (then nothing is written), a file
    /// that cannot be written.
    pub fn write_masks(&mut self, frame: u32, masks: &[GrayImage]) -> Result<()> {
        self.check_sizes("masks", masks.iter().map(GrayImage::dimensions))?;
        for (camera, mask) in masks.iter().enumerate() {
            let path = self.masks.make_room(&self.dir, &self.rig, camera, frame)?;
            image_file::write_png(&path, mask)?;
            self.masks.files[camera].insert(frame, path);
        }
        self.masks.add_common(frame);
        Ok(())
    }

    /// Writes the colour images of one frame, one per camera, over any that are there.
    ///
    /// # Errors
    /// As [`write_masks`](Self::write_masks).
    pub fn write_images(&mut self, frame: u32, images: &[RgbImage]) -> Result<()> {
        self.check_sizes("images", images.iter().map(RgbImage::dimensions))?;
        for (camera, image) in images.iter().enumerate() {
            let path = self.images.make_room(&self.dir, &self.rig, camera, frame)?;
            image_file::write_png(&path, image)?;
            self.images.files[camera].insert(frame, path);
        }
        self.images.add_common(frame);
        Ok(())
    }

    /// Writes the colour images without the subject, one per camera.
    ///
    /// # Errors
    /// As [`write_masks`](Self::write_masks).
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

impl Pictures {
    fn list(dir: &Path, rig: &Rig, kind: &'static str) -> Result<Self> {
        let files = rig
            .cameras()
            .iter()
            .map(|camera| {
                numbered_files_of(&dir.join(camera.name()), kind).map_err(|e| Error::view(camera.name(), e))
            })
            .collect::<Result<Vec<_>>>()?;
        let in_all = |frame: &u32| files.iter().all(|of_camera| of_camera.contains_key(frame));
        let common = files[0].keys().copied().filter(in_all).collect();
        Ok(Self { kind, files, common })
    }

    fn any(&self) -> bool {
        self.files.iter().any(|of_camera| !of_camera.is_empty())
    }

    fn file(&self, rig: &Rig, camera: usize, frame: u32) -> Result<&Path> {
        self.files[camera].get(&frame).map(PathBuf::as_path).ok_or_else(|| {
            let (name, kind) = (rig.cameras()[camera].name(), self.kind);
            let has = extent(&self.files[camera]);
            let problem = format!("expected {name}/{kind}/{frame:06}.*, found {has}; ask for a frame it has");
            Error::view(name, problem)
        })
    }

    /// The path at which to write a frame, its folder made and any older file of the frame gone.
    fn make_room(&self, dir: &Path, rig: &Rig, camera: usize, frame: u32) -> Result<PathBuf> {
        let folder = dir.join(rig.cameras()[camera].name()).join(self.kind);
        make_folder(&folder)?;
        let path = folder.join(format!("{frame:06}.png"));
        if let Some(old) = self.files[camera].get(&frame).filter(|&old| *old != path) {
            std::fs::remove_file(old)
                .map_err(|e| Error::file(old, format!("expected to replace it, found: {e}")))?;
        }
        Ok(path)
    }

    fn add_common(&mut self, frame: u32) {
        if let Err(place) = self.common.binary_search(&frame) {
            self.common.insert(place, frame);
        }
    }

    fn nothing_in_common(&self, rig: &Rig) -> String {
        let has = |(camera, files): (&crate::camera::Camera, &BTreeMap<u32, PathBuf>)| {
            format!("\"{}\" has {}", camera.name(), extent(files))
        };
        let cameras: Vec<_> = rig.cameras().iter().zip(&self.files).map(has).collect();
        format!(
            "expected a frame of which every camera has a file {kind}/%06d.png, found none: {}; add what is missing \
             or remove the {kind} folders",
            cameras.join(", "),
            kind = self.kind
        )
    }
}

fn extent(files: &BTreeMap<u32, PathBuf>) -> String {
    match (files.first_key_value(), files.last_key_value()) {
        (Some((first, _)), Some((last, _))) if files.len() > 1 => {
            format!("{} frames from {first} to {last}", files.len())
        }
        (Some((only, _)), _) => format!("frame {only} alone"),
        _ => "no frames".into(),
    }
}

/// A camera's files of one kind by their numbers. Masks may lie beside the images where they have no folder of their own.
fn numbered_files_of(camera: &Path, kind: &str) -> Result<BTreeMap<u32, PathBuf>> {
    let folder = camera.join(kind);
    if kind != MASK {
        return numbered_files(&folder, &[""]);
    }
    if folder.is_dir() {
        return numbered_files(&folder, &["", MASK_SUFFIX]);
    }
    numbered_files(&camera.join(IMAGE), &[MASK_SUFFIX])
}

/// The image files of a folder whose names are numbers and one of the suffixes; none where there is no folder.
fn numbered_files(folder: &Path, suffixes: &[&str]) -> Result<BTreeMap<u32, PathBuf>> {
    let mut files = BTreeMap::new();
    if !folder.is_dir() {
        return Ok(files);
    }
    let fail = |e: std::io::Error| Error::file(folder, format!("expected a readable folder, found: {e}"));
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        let Some(frame) = suffixes.iter().find_map(|suffix| frame_of(&path, suffix)) else { continue };
        if let Some(other) = files.insert(frame, path.clone()) {
            let problem =
                format!("expected one file for frame {frame}, found also {}; remove one", other.display());
            return Err(Error::file(path, problem));
        }
    }
    Ok(files)
}

fn frame_of(path: &Path, suffix: &str) -> Option<u32> {
    let extension = path.extension()?.to_str()?.to_ascii_lowercase();
    let stem = path.file_stem()?.to_str()?.strip_suffix(suffix)?;
    let numbered = stem.bytes().all(|b| b.is_ascii_digit());
    (numbered && EXTENSIONS.contains(&extension.as_str())).then(|| stem.parse().ok())?
}

/// Camera names become folders, which must stay inside the recording.
fn check_names(rig: &Rig) -> Result<()> {
    let bad = |name: &str| matches!(name, "." | "..") || name.contains(['/', '\\', '\0']);
    match rig.cameras().iter().find(|camera| bad(camera.name())) {
        None => Ok(()),
        Some(camera) => {
            let problem =
                "expected a name that can be a folder's, found \"/\", \"\\\", \".\" or \"..\"; rename it";
            Err(Error::camera(camera.name(), problem))
        }
    }
}

fn make_folder(folder: &Path) -> Result<()> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Error::file(folder, format!("expected to make this folder, found: {e}")))
}

#[cfg(test)]
mod tests;
