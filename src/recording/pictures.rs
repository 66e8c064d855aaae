//! The files of one kind of picture of a recording, images or masks.

use super::mask_file::MaskFile;
use super::{IMAGE, MASK, MASK_FILE, MASK_SUFFIX, make_folder};
use crate::camera::Camera;
use crate::rig::Rig;
use crate::{Error, Result, image_file};
use image::{ImageBuffer, PixelWithColorType};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// One kind of picture of all cameras.
#[derive(Debug, Clone)]
pub(super) struct Pictures {
    pub(super) kind: &'static str,
    /// The file of each frame, per camera.
    pub(super) files: Vec<BTreeMap<u32, PathBuf>>,
    /// The frames that all cameras have, ascending.
    pub(super) common: Vec<u32>,
}

impl Pictures {
    pub(super) fn list(dir: &Path, rig: &Rig, kind: &'static str) -> Result<Self> {
        let files = rig
            .cameras()
            .iter()
            .map(|camera| {
                numbered_files(&dir.join(camera.name()), kind).map_err(|e| Error::view(camera.name(), e))
            })
            .collect::<Result<Vec<_>>>()?;

        let mut pictures = Self { kind, files, common: Vec::new() };
        pictures.find_common();
        Ok(pictures)
    }

    fn find_common(&mut self) {
        let in_all = |frame: &u32| self.files.iter().all(|of_camera| of_camera.contains_key(frame));
        self.common = self.files[0].keys().copied().filter(in_all).collect();
    }

    pub(super) fn has_files(&self) -> bool {
        self.files.iter().any(|of_camera| !of_camera.is_empty())
    }

    /// The file of one frame of one camera.
    pub(super) fn file(&self, rig: &Rig, camera: usize, frame: u32) -> Result<&Path> {
        self.files[camera].get(&frame).map(PathBuf::as_path).ok_or_else(|| {
            let (name, kind) = (rig.cameras()[camera].name(), self.kind);
            let has = extent(&self.files[camera]);
            let problem = format!("expected {name}/{kind}/{frame:06}.*, found {has}; choose one of these");
            Error::view(name, problem)
        })
    }

    /// Writes the pictures of one frame as PNGs, all of them or none.
    pub(super) fn write<P>(
        &mut self,
        dir: &Path,
        rig: &Rig,
        frame: u32,
        pictures: &[ImageBuffer<P, Vec<u8>>],
    ) -> Result<()>
    where
        P: PixelWithColorType<Subpixel = u8> + Sync,
    {
        let mut paths = Vec::new();
        for camera in rig.cameras() {
            let folder = dir.join(camera.name()).join(self.kind);
            make_folder(&folder)?;
            paths.push(folder.join(format!("{frame:06}.png")));
        }

        image_file::write_pngs(paths.iter().map(PathBuf::as_path).zip(pictures))?;
        self.replace(frame, paths.into_iter())
    }

    /// Replaces the files of one frame, one per camera, and removes the old ones from disk.
    pub(super) fn replace(&mut self, frame: u32, paths: impl Iterator<Item = PathBuf>) -> Result<()> {
        for (files, path) in self.files.iter_mut().zip(paths) {
            let old =
                files.insert(frame, path.clone()).filter(|old| *old != path && !old.ends_with(MASK_FILE));
            if let Some(old) = old {
                std::fs::remove_file(&old)
                    .map_err(|e| Error::file(old, format!("expected to replace it, found: {e}")))?;
            }
        }
        self.add_common(frame);
        Ok(())
    }

    /// Adds the masks of mask files.
    ///
    /// # Errors
    /// A frame that has a mask in a file of its own as well.
    pub(super) fn add(&mut self, rig: &Rig, mask_files: &[MaskFile]) -> Result<()> {
        for ((camera, files), mask_file) in rig.cameras().iter().zip(&mut self.files).zip(mask_files) {
            for frame in mask_file.frames() {
                if let Some(other) = files.insert(frame, mask_file.path().to_owned()) {
                    let problem = format!(
                        "expected one mask of frame {frame}, found those in {} and {}; remove one",
                        other.display(),
                        mask_file.path().display()
                    );
                    return Err(Error::view(camera.name(), problem));
                }
            }
        }

        self.find_common();
        Ok(())
    }

    fn add_common(&mut self, frame: u32) {
        if let Err(place) = self.common.binary_search(&frame) {
            self.common.insert(place, frame);
        }
    }

    /// The error text about pictures without a frame that all cameras have.
    pub(super) fn nothing_in_common(&self, rig: &Rig) -> String {
        let has = |(camera, files): (&Camera, &BTreeMap<u32, PathBuf>)| {
            format!("\"{}\" has {}", camera.name(), extent(files))
        };
        let cameras: Vec<_> = rig.cameras().iter().zip(&self.files).map(has).collect();
        format!(
            "expected a frame with a file {kind}/%06d.png of every camera, found none: {}; add what is missing \
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
        (Some((only, _)), _) => format!("only frame {only}"),
        _ => "no frames".into(),
    }
}

/// A camera's files of one kind by frame. Masks may lie beside the images if they have no folder of their own.
fn numbered_files(camera: &Path, kind: &str) -> Result<BTreeMap<u32, PathBuf>> {
    let folder = camera.join(kind);
    if kind != MASK {
        return image_file::numbered(&folder, &[""]);
    }
    if folder.is_dir() {
        return image_file::numbered(&folder, &["", MASK_SUFFIX]);
    }
    image_file::numbered(&camera.join(IMAGE), &[MASK_SUFFIX])
}
