//! Which recorded frame is published at which time of the film.

use crate::capture::{FRAME_RATE, STEPS_PER_SECOND};

/// The times of recorded frames, by index, on the clock of the film.
#[derive(Debug)]
pub(super) struct Timeline {
    /// When each frame becomes current, in seconds of the film.
    starts: Vec<f64>,
    /// The time between frames on average, in seconds.
    period: f64,
    linger: f64,
}

/// A recorded frame, by index, and the time at which it is published, in seconds of the film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Publication {
    pub(super) frame: usize,
    pub(super) time: f64,
}

impl Timeline {
    /// The first frame is shown for `wait` seconds. Then frames follow at their `times`, of which there has to be at
    /// least one. The last frame is current for as long as the others on average, and then for `linger` seconds more.
    pub(super) fn new(times: &[f64], wait: f64, linger: f64) -> Self {
        let starts: Vec<f64> = times.iter().map(|time| wait + time - times[0]).collect();
        let steps = starts.len() - 1;
        let period = if steps == 0 { 1.0 / FRAME_RATE } else { (starts[steps] - wait) / steps as f64 };
        Self { starts, period, linger }
    }

    /// What is published last at `time`: the last frame that has started, or starts within half a step of the
    /// simulation.
    ///
    /// While the first or the last frame is held it is published again and again, as cameras do when a subject stands
    /// still. So its motion ends, and what leads to the second frame is as fast as it was, however long the wait.
    pub(super) fn at(&self, time: f64) -> Publication {
        let soon = time + 0.5 / STEPS_PER_SECOND;
        let frame = self.starts.partition_point(|&start| start <= soon).max(1) - 1;
        let start = self.starts[frame];

        let last = self.starts.len() - 1;
        let periods = ((soon - start) / self.period).floor();
        let repeats = match frame {
            _ if frame == last => periods,
            0 => periods.min(0.0),
            _ => 0.0,
        };
        Publication { frame, time: start + repeats * self.period }
    }

    /// The frame that starts nearest to `time`.
    pub(super) fn nearest(&self, time: f64) -> usize {
        let later = self.starts.partition_point(|&start| start < time).min(self.starts.len() - 1);
        let is_earlier = |&earlier: &usize| time - self.starts[earlier] < self.starts[later] - time;
        later.checked_sub(1).filter(is_earlier).unwrap_or(later)
    }

    /// The time between frames on average, in seconds.
    pub(super) fn period(&self) -> f64 {
        self.period
    }

    /// From the first frame's start to the last one's end, in seconds.
    pub(super) fn duration(&self) -> f64 {
        self.starts[self.starts.len() - 1] - self.starts[0] + self.period
    }

    /// The number of frames of the film.
    pub(super) fn film_frames(&self) -> usize {
        (((self.starts[0] + self.duration() + self.linger) * FRAME_RATE).round() as usize).max(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The current frames over the steps of the simulation, each with its number of steps.
    fn played(timeline: &Timeline) -> Vec<(usize, u32)> {
        let mut played: Vec<(usize, u32)> = Vec::new();
        let steps = timeline.film_frames() as f64 / FRAME_RATE * STEPS_PER_SECOND;
        for step in 0..steps.round() as u32 {
            let frame = timeline.at(f64::from(step) / STEPS_PER_SECOND).frame;
            match played.last_mut() {
                Some((last, count)) if *last == frame => *count += 1,
                _ => played.push((frame, 1)),
            }
        }
        played
    }

    fn times(rate: f64, count: u32) -> Vec<f64> {
        (0..count).map(|frame| 7.0 + f64::from(frame) / rate).collect()
    }

    #[test]
    fn every_frame_is_current_for_its_own_time_whatever_the_films_rate() {
        for (rate, steps) in [(30.0, 8), (60.0, 4), (24.0, 10), (120.0, 2)] {
            let timeline = Timeline::new(&times(rate, 24), 0.0, 0.0);
            let expected: Vec<_> = (0..24).map(|frame| (frame, steps)).collect();
            assert_eq!(played(&timeline)[..23], expected[..23], "{rate}");
            assert!((timeline.duration() - 24.0 / rate).abs() < 1e-9);
        }

        // A rate that no step fits: never off by more than half a step.
        let timeline = Timeline::new(&times(25.0, 50), 0.0, 0.0);
        assert!(
            played(&timeline).iter().all(|(_, steps)| (9..=10).contains(steps)),
            "{:?}",
            played(&timeline)
        );
        assert_eq!(timeline.film_frames(), 60);
    }

    #[test]
    fn the_first_frame_is_held_the_last_lingers_and_listed_times_need_no_rate() {
        let timeline = Timeline::new(&[5.0, 5.1, 5.4], 0.5, 0.2);
        assert_eq!(played(&timeline), [(0, 144), (1, 72), (2, 96)]);
        assert_eq!(Timeline::new(&[3.0], 0.0, 0.0).film_frames(), 1);
    }

    /// What is published over the steps of the simulation, without repetitions.
    fn published(timeline: &Timeline) -> Vec<Publication> {
        let steps = timeline.film_frames() as f64 / FRAME_RATE * STEPS_PER_SECOND;
        let mut published: Vec<_> =
            (0..steps as u32).map(|step| timeline.at(f64::from(step) / STEPS_PER_SECOND)).collect();
        published.dedup();
        published
    }

    #[test]
    fn frames_are_published_at_the_recordings_own_pace_also_while_the_subject_is_held() {
        for wait in [0.0, 0.3, 3.0] {
            let published = published(&Timeline::new(&times(60.0, 4), wait, 0.5));
            let steps = published.windows(2).map(|pair| pair[1].time - pair[0].time);
            for (step, pair) in steps.zip(published.windows(2)) {
                assert!((step - 1.0 / 60.0).abs() < 1e-9, "{pair:?}");
                assert!([0, 1].contains(&(pair[1].frame - pair[0].frame)), "{pair:?}");
            }
            assert!((-1.0 / 60.0..1e-9).contains(&published[0].time), "{:?}", published[0]);
        }
    }

    #[test]
    fn a_pause_of_the_recording_is_a_pause_between_two_frames() {
        let published = published(&Timeline::new(&[0.0, 0.1, 0.9, 1.0], 0.0, 0.0));
        let times: Vec<f64> = published.iter().map(|one| one.time).collect();
        assert_eq!(times[..4], [0.0, 0.1, 0.9, 1.0]);
    }

    #[test]
    fn the_nearest_frame_to_a_time_is_the_first_before_all_and_the_last_after_all() {
        let timeline = Timeline::new(&[5.0, 5.1, 5.4], 0.5, 0.2);
        let nearest = [-1.0, 0.5, 0.54, 0.56, 0.7, 0.74, 0.76, 2.0].map(|time| timeline.nearest(time));
        assert_eq!(nearest, [0, 0, 0, 1, 1, 1, 2, 2]);
    }
}
