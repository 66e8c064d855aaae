//! How fast a live system was.

use super::Live;
use ode_visual_hull::recording::RecordingSummary;
use ode_visual_hull_film::Tally;
use std::fmt;
use std::sync::atomic::Ordering;

/// Measurements of a live system, as far as time did not stand still.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveReport {
    /// How long it has run, in seconds.
    pub seconds: f64,
    /// Pictures that were shown.
    pub pictures: u64,
    /// Sets of images whose hull was published, of these without some camera's image, and sets that came too late.
    pub sets: [u64; 3],
    /// What became of the steps.
    pub steps: Tally,
    /// From an image to the first contact with its hull, half and 99 % of them are faster, in seconds.
    pub to_contact: [Option<f64>; 2],
    /// From an image to the picture that shows it.
    pub to_pixel: [Option<f64>; 2],
    /// What was recorded, once that has ended.
    pub recording: Option<RecordingSummary>,
}

impl LiveReport {
    pub(super) fn of(live: &Live) -> Self {
        let tally = &live.capture.tally;
        let count = |of: &std::sync::atomic::AtomicU64| of.load(Ordering::Relaxed);
        let quantiles =
            |of: &super::latencies::Latencies| [0.5, 0.99].map(|part| of.quantile(part, usize::MAX));
        Self {
            seconds: live.clock.now() - live.started,
            pictures: count(&live.drawing.pictures),
            sets: [&tally.published, &tally.incomplete, &tally.dropped].map(count),
            steps: live.world.latest.get().1.map(|world| world.steps).unwrap_or_default(),
            to_contact: quantiles(&live.world.to_contact),
            to_pixel: quantiles(&live.drawing.to_pixel),
            recording: None,
        }
    }

    /// Pictures a second.
    pub fn rate(&self) -> f64 {
        self.pictures as f64 / self.seconds.max(1e-3)
    }
}

impl fmt::Display for LiveReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [sets, incomplete, dropped] = self.sets;
        let milliseconds =
            |time: Option<f64>| time.map_or("none".into(), |seconds| format!("{:.0} ms", 1e3 * seconds));
        let quantiles =
            |of: [Option<f64>; 2]| format!("median {}, 99 % {}", milliseconds(of[0]), milliseconds(of[1]));
        writeln!(
            f,
            "pictures          {} in {:.1} s: {:.1} a second",
            self.pictures,
            self.seconds,
            self.rate()
        )?;
        writeln!(f, "image sets        {sets} used, of them {incomplete} incomplete; {dropped} left out")?;
        writeln!(f, "steps             {}", self.steps)?;
        writeln!(f, "image to contact  {}", quantiles(self.to_contact))?;
        write!(f, "image to picture  {}", quantiles(self.to_pixel))?;
        let Some(recording) = &self.recording else { return Ok(()) };
        let (dir, frames) = (recording.dir.display(), recording.frames);
        write!(
            f,
            "\nrecorded          {frames} frames in {dir}; {} left out, {} incomplete",
            recording.left_out, recording.incomplete
        )
    }
}
