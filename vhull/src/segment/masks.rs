//! Writer of the masks of a recording.

use super::Options;
use ode_visual_hull::recording::{Recording, StreamOptions};
use ode_visual_hull::rig::Rig;
use ode_visual_hull::silhouette::PackedMask;
use ode_visual_hull::{Error, Result};
use ode_visual_hull_film::FramesCsv;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The recording to which masks are written; it is created with the first masks where it does not exist.
pub struct Masks {
    dir: PathBuf,
    rig: Rig,
    recording: Option<Recording>,
    /// Frames whose existing masks are kept (`--resume`).
    kept: BTreeSet<u32>,
    /// Whether masks are written as run lengths instead of PNG files.
    as_runs: bool,
    /// Table of times beside masks in a folder of their own; `None` where the images have no known times or the folder
    /// has a table from the user.
    times: Option<FramesCsv>,
}

impl Masks {
    /// Prepares to write to the folder of the options.
    ///
    /// # Errors
    /// Requested frames that have masks already, without `--resume` or `--force`.
    pub fn open(options: &Options, images: &Recording, streaming: &StreamOptions) -> Result<Self> {
        let rig = images.rig();
        let dir = options.out.as_ref().unwrap_or(&options.recording).clone();
        let recording = dir.exists().then(|| Recording::resume(&dir, rig)).transpose()?;

        // Existing masks among the requested frames are kept or overwritten only on request.
        let frames = recording.as_ref().map_or(&[][..], Recording::frames);
        let existing: BTreeSet<u32> =
            frames.iter().copied().filter(|frame| options.frames.contains(frame)).collect();
        if !existing.is_empty() && !options.resume && !options.force {
            let problem = format!(
                "expected no masks yet, found masks of {} frames; --resume keeps them and segments the others, --force \
                 overwrites them, --out DIR writes to another folder",
                existing.len()
            );
            return Err(Error::file(dir, problem));
        }
        let kept = if options.resume { existing } else { BTreeSet::new() };

        // Masks in a folder of their own lose the images that hold their times.
        let times = match &options.out {
            Some(out) if !matches!(images.frame_times(streaming), Ok(None)) => {
                FramesCsv::open(out, options.force.then_some(&options.frames))?
            }
            _ => None,
        };
        Ok(Self { dir, rig: rig.clone(), recording, kept, as_runs: options.rle, times })
    }

    /// Folder of the masks.
    pub fn dir(&self) -> &Path {
        &self.dir
    }

    /// Whether existing masks of frame `number` are kept.
    pub fn has(&self, number: u32) -> bool {
        self.kept.contains(&number)
    }

    /// Writes the masks of frame `number`, captured at `time` seconds, one for each camera.
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
