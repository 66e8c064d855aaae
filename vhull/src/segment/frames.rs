//! Which frames to segment, and what has become of them.

use crate::Outcome;
use ode_visual_hull::rig::Rig;
use ode_visual_hull::source::{ImageSet, Synchroniser};
use ode_visual_hull::{Error, Result};
use std::path::Path;

/// From `first` to before `end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frames {
    pub first: u32,
    pub end: u32,
}

impl Frames {
    /// How many, where `left` are known to come from the first on; 0 where nothing is known.
    pub fn count(self, left: Option<u32>) -> usize {
        let asked = (self.end < u32::MAX).then(|| self.end - self.first);
        left.into_iter().chain(asked).min().unwrap_or(0) as usize
    }
}

/// `A..B`, `A..`, `..B` or `..`.
pub fn parse(text: &str) -> std::result::Result<Frames, String> {
    let number = |text: &str, default| if text.is_empty() { Some(default) } else { text.parse().ok() };
    text.split_once("..")
        .and_then(|(first, end)| Some(Frames { first: number(first, 0)?, end: number(end, u32::MAX)? }))
        .filter(|frames| frames.first < frames.end)
        .ok_or_else(|| format!("expected two numbers as in 10..90, the second greater, found {text}"))
}

/// What has become of the frames so far.
#[derive(Debug, Default)]
pub struct Tally {
    pub written: u32,
    /// Had masks before.
    pub kept: u32,
    /// The frame that is being segmented or written.
    pub frame_at_work: Option<u32>,
    last: Option<u32>,
    /// Frames of which not every camera has an image, with the cameras that have none.
    incomplete: Vec<(u32, String)>,
    /// Frames whose images bear different numbers.
    renumbered: u32,
    widest_spread: f64,
}

impl Tally {
    pub fn written(&mut self, set: &ImageSet) {
        self.written += 1;
        self.last = self.frame_at_work.take();
        self.widest_spread = self.widest_spread.max(set.spread);
        let differs = set.images.iter().flatten().any(|frame| frame.number != set.number());
        self.renumbered += u32::from(differs);
    }

    pub fn left_out(&mut self, set: &ImageSet, rig: &Rig) {
        let names: Vec<_> = set.missing().map(|camera| rig.cameras()[camera].name()).collect();
        self.incomplete.push((set.number(), names.join(", ")));
    }

    /// What to say where `e` put an end to it.
    pub fn broken_off(&self, e: &Error, out: &Path) -> Error {
        let at = match (self.frame_at_work, self.last) {
            (Some(frame), _) => format!("frame {frame}"),
            (None, Some(last)) => format!("after frame {last}"),
            (None, None) => "first frame".into(),
        };
        let done = self.written + self.kept;
        Error::argument(format!(
            "{at}: {e}\n{done} frames are done and kept in {}; mend this, then go on with --resume",
            out.display()
        ))
    }

    /// Says how it ended.
    pub fn report(&self, recording: &Path, out: &Path, sets: &Synchroniser) -> Result<Outcome> {
        for note in sets.streams().flat_map(|stream| stream.notes()) {
            eprintln!("note: {note}");
        }
        if self.renumbered > 0 {
            eprintln!(
                "note: {} frames hold images of different numbers; their masks are numbered as the first camera's",
                self.renumbered
            );
        }
        if let [(first, missing), ..] = self.incomplete.as_slice() {
            let count = self.incomplete.len();
            eprintln!(
                "note: {count} frames left out, of which not every camera has an image; the first is frame {first}, \
                 without {missing}"
            );
        }
        if self.written + self.kept == 0 {
            let problem = format!(
                "expected frames of which every camera has an image within {} s, found none; give --frames that there \
                 are, or a greater --bound",
                sets.bound()
            );
            return Err(Error::file(recording, problem));
        }
        let spread_ms = 1000.0 * self.widest_spread;
        println!(
            "{} frames segmented, {} had masks before; images of one time within {spread_ms:.1} ms",
            self.written, self.kept
        );
        println!("written to {}", out.display());
        Ok(Outcome::Done)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_end_of_a_range_may_be_left_out() {
        let ranges = [("3..7", 3, 7), ("3..", 3, u32::MAX), ("..7", 0, 7), ("..", 0, u32::MAX)];
        for (text, first, end) in ranges {
            assert_eq!(parse(text), Ok(Frames { first, end }));
        }
        for bad in ["", "3", "7..3", "3..3", "a..b", "-1..3", "1..2..3"] {
            assert!(parse(bad).unwrap_err().contains(&format!("found {bad}")), "{bad}");
        }
        assert_eq!(Frames { first: 3, end: 7 }.count(Some(100)), 4);
        assert_eq!(Frames { first: 3, end: 7 }.count(Some(2)), 2);
        assert_eq!(Frames { first: 3, end: u32::MAX }.count(None), 0);
    }
}
