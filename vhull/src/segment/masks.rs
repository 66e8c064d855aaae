//! Where the masks go.

use super::Options;
use image::GrayImage;
use ode_visual_hull::recording::Recording;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::{Error, Result};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A recording that takes masks. Where there is none it begins with the first masks.
pub struct Masks {
    dir: PathBuf,
    rig: Rig,
    recording: Option<Recording>,
    /// Frames that keep the masks they have.
    kept: BTreeSet<u32>,
}

impl Masks {
    /// Gets ready to write where the options say.
    ///
    /// # Errors
    /// Masks of frames that are asked for, unless the options say what to do with them.
    pub fn open(options: &Options, rig: &Rig) -> Result<Self> {
        let dir = options.out.as_ref().unwrap_or(&options.recording).clone();
        let recording = dir.exists().then(|| Recording::resume(&dir, rig)).transpose()?;
        let frames = recording.as_ref().map_or(&[][..], Recording::frames);
        let asked = options.frames.clone();
        let there: BTreeSet<u32> = frames.iter().copied().filter(|frame| asked.contains(frame)).collect();
        if !there.is_empty() && !options.resume && !options.force {
            let problem = format!(
                "expected no masks yet, found those of {} frames; --resume keeps them and does the others, --force \
                 writes over them, --out DIR writes elsewhere",
                there.len()
            );
            return Err(Error::file(dir, problem));
        }
        let kept = if options.resume { there } else { BTreeSet::new() };
        Ok(Self { dir, rig: rig.clone(), recording, kept })
    }

    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Whether frame `number` keeps the masks it has.
    pub fn has(&self, number: u32) -> bool {
        self.kept.contains(&number)
    }

    pub fn write(&mut self, number: u32, masks: &[GrayImage]) -> Result<()> {
        let recording = match &mut self.recording {
            Some(recording) => recording,
            none => none.insert(Recording::resume(&self.dir, &self.rig)?),
        };
        recording.write_masks(number, masks)
    }
}
