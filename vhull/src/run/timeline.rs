//! Which recorded frame is current at which time of the film.

use ode_visual_hull_film::{FRAME_RATE, STEPS_PER_SECOND};

/// The times of recorded frames, by index, on the clock of the film.
#[derive(Debug)]
pub struct Timeline {
    /// When each frame becomes current, in seconds of the film.
    starts: Vec<f64>,
    /// From the first frame's start to the last one's end, in seconds.
    duration: f64,
    linger: f64,
}

impl Timeline {
    /// The first frame is held for `hold` seconds. Then frames follow at their `times`, of which there has to be at
    /// least one. The last frame is current for as long as the others on average, and then for `linger` seconds more.
    pub fn new(times: &[f64], hold: f64, linger: f64) -> Self {
        let starts: Vec<f64> = times.iter().map(|time| hold + time - times[0]).collect();
        let last = starts[starts.len() - 1];
        let step =
            if starts.len() == 1 { 1.0 / FRAME_RATE } else { (last - hold) / (starts.len() - 1) as f64 };
        Self { starts, duration: last - hold + step, linger }
    }

    /// The current frame: the last one that has started, or starts within half a step of the simulation.
    pub fn at(&self, time: f64) -> usize {
        let soon = time + 0.5 / STEPS_PER_SECOND;
        self.starts.partition_point(|&start| start <= soon).max(1) - 1
    }

    /// When a frame becomes current; the first one is from the beginning.
    pub fn start(&self, frame: usize) -> f64 {
        if frame == 0 { 0.0 } else { self.starts[frame] }
    }

    /// From the first frame's start to the last one's end, in seconds.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The number of frames of the film.
    pub fn film_frames(&self) -> usize {
        (((self.starts[0] + self.duration + self.linger) * FRAME_RATE).round() as usize).max(1)
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
            let frame = timeline.at(f64::from(step) / STEPS_PER_SECOND);
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
        assert_eq!((timeline.start(0), timeline.start(1)), (0.0, 0.5 + 5.1 - 5.0));
        assert_eq!(Timeline::new(&[3.0], 0.0, 0.0).film_frames(), 1);
    }
}
