//! Counts of segmented, kept and skipped frames, and the summary printed from them.

use crate::Outcome;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::{ImageSet, Synchroniser};
use ode_visual_hull::{Error, Result};
use std::path::Path;

/// Counts of the frames so far.
#[derive(Debug, Default)]
pub struct Tally {
    /// Frames segmented and written.
    pub written: u32,
    /// Frames whose existing masks were kept.
    pub kept: u32,
    /// Number of the frame that is being segmented or written.
    pub frame_at_work: Option<u32>,
    /// Number of the last frame written.
    last: Option<u32>,
    /// Frames that lack images, each with the names of the cameras without one.
    incomplete: Vec<(u32, String)>,
    /// Number of frames whose images have different numbers.
    renumbered: u32,
    /// Greatest time difference within a frame, in seconds.
    widest_spread: f64,
}

impl Tally {
    /// Counts the frame at work as written.
    pub fn written(&mut self, set: &ImageSet) {
        self.written += 1;
        self.last = self.frame_at_work.take();
        self.widest_spread = self.widest_spread.max(set.time_spread);
        let differs = set.images.iter().flatten().any(|frame| frame.number != set.number());
        self.renumbered += u32::from(differs);
    }

    /// Counts a frame that is skipped because cameras lack an image.
    pub fn left_out(&mut self, set: &ImageSet, rig: &Rig) {
        let names: Vec<_> = set.missing().map(|camera| rig.cameras()[camera].name()).collect();
        self.incomplete.push((set.number(), names.join(", ")));
    }

    /// Error for a run that ended with `e`: it adds the frame, the number of frames done, and how to continue.
    pub fn broken_off(&self, e: &Error, out: &Path) -> Error {
        let at = match (self.frame_at_work, self.last) {
            (Some(frame), _) => format!("frame {frame}"),
            (None, Some(last)) => format!("after frame {last}"),
            (None, None) => "first frame".into(),
        };
        let done = self.written + self.kept;
        Error::argument(format!(
            "{at}: {e}\n{done} frames are done and kept in {}; fix this, then continue with --resume",
            out.display()
        ))
    }

    /// Prints notes and the summary.
    ///
    /// # Errors
    /// Not a single complete frame.
    pub fn print_summary(&self, recording: &Path, out: &Path, sets: &Synchroniser) -> Result<Outcome> {
        for note in sets.streams().flat_map(|stream| stream.notes()) {
            eprintln!("note: {note}");
        }

        // Notes on what a user may not expect, to standard error.
        if self.renumbered > 0 {
            eprintln!(
                "note: {} frames combine images of different numbers; their masks are numbered as the first camera's",
                self.renumbered
            );
        }
        if let [(first, missing), ..] = self.incomplete.as_slice() {
            let count = self.incomplete.len();
            eprintln!(
                "note: {count} frames left out because cameras lack an image; the first is frame {first}, without \
                 {missing}"
            );
        }

        if self.written + self.kept == 0 {
            let problem = format!(
                "expected frames with images of all cameras within {} s, found none; choose other --frames, or a \
                 greater --bound",
                sets.bound()
            );
            return Err(Error::file(recording, problem));
        }

        let spread_ms = 1000.0 * self.widest_spread;
        println!(
            "{} frames segmented, {} had masks before; images of a frame within {spread_ms:.1} ms",
            self.written, self.kept
        );
        println!("written to {}", out.display());
        Ok(Outcome::Done)
    }
}
