//! Where the masks go.

use super::Options;
use crate::times::Times;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::rig::Rig;
use ode_visual_hull::silhouette::PackedMask;
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
    /// Whether they are written as run lengths.
    as_runs: bool,
    /// Of masks that are written elsewhere, where nothing else tells; only where the recording does.
    times: Option<Times>,
}

impl Masks {
    /// Gets ready to write where the options say.
    ///
    /// # Errors
    /// Masks of frames that are asked for, unless the options say what to do with them.
    pub fn open(options: &Options, images: &Recording, streaming: &StreamOptions) -> Result<Self> {
        let rig = images.rig();
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
        let times = match &options.out {
            Some(out) if !matches!(images.frame_times(streaming), Ok(None)) => {
                Times::open(out, options.force.then_some(&options.frames))?
            }
            _ => None,
        };
        Ok(Self { dir, rig: rig.clone(), recording, kept, as_runs: options.rle, times })
    }

    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Whether frame `number` keeps the masks it has.
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
