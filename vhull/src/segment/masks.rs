//! Writes the masks of a recording.

use super::Options;
use crate::times::Times;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::rig::Rig;
use ode_visual_hull::silhouette::PackedMask;
use ode_visual_hull::{Error, Result};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// A recording that masks are written to. Where there is none yet it is made with the first masks.
pub struct Masks {
    dir: PathBuf,
    rig: Rig,
    recording: Option<Recording>,
    /// Frames whose existing masks are kept.
    kept: BTreeSet<u32>,
    /// Whether masks are written as run lengths.
    as_runs: bool,
    /// The times of the frames, for masks in a folder of their own, if the recording states times.
    times: Option<Times>,
}

impl Masks {
    /// Prepares to write to the folder that the options name.
    ///
    /// # Errors
    /// Some of the frames have masks already, and the options do not say what to do with them.
    pub fn open(options: &Options, images: &Recording, streaming: &StreamOptions) -> Result<Self> {
        let rig = images.rig();
        let dir = options.out.as_ref().unwrap_or(&options.recording).clone();
        let recording = dir.exists().then(|| Recording::resume(&dir, rig)).transpose()?;
        let frames = recording.as_ref().map_or(&[][..], Recording::frames);
        let wanted = options.frames.clone();
        let existing: BTreeSet<u32> = frames.iter().copied().filter(|frame| wanted.contains(frame)).collect();

        if !existing.is_empty() && !options.resume && !options.force {
            let problem = format!(
                "expected no masks yet, found those of {} frames; --resume keeps them and makes the others, --force \
                 overwrites them, --out DIR writes elsewhere",
                existing.len()
            );
            return Err(Error::file(dir, problem));
        }

        let kept = if options.resume { existing } else { BTreeSet::new() };
        let times = match &options.out {
            Some(out) if !matches!(images.frame_times(streaming), Ok(None)) => {
                Times::open(out, options.force.then_some(&options.frames))?
            }
            _ => None,
        };
        Ok(Self { dir, rig: rig.clone(), recording, kept, as_runs: options.rle, times })
    }

    /// The folder of the recording.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Whether the existing masks of frame `number` are kept.
    pub fn has(&self, number: u32) -> bool {
        self.kept.contains(&number)
    }

    /// Writes the masks of frame `number`, taken at `time` seconds.
    pub fn write(&mut self, number: u32, time: f64, masks: &[PackedMask]) -> Result<()> {
        let recording = match &mut self.recording {
            Some(recording) => recording,
            none => none.insert(Recording::resume(&self.dir, &self.rig)?),
        };
        if self.as_runs {
            recording.write_packed_masks(number, masks)?;
        } else {
            let masks: Vec<_> = masks.iter().map(PackedMask::to_mask).collect();
            recording.write_masks(number, &masks)?;
        }
        self.times.as_mut().map_or(Ok(()), |times| times.add(number, time))
    }
}
