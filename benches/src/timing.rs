//! Candidates that take turns: each round runs all of them, and only times of one round are compared.
//!
//! The clock is the thread's own, which stands still while other programs have the core; where candidates start
//! threads of their own, it is the wall clock.

use indicatif::ProgressBar;
use ode_visual_hull_testing::median;
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

/// Least time of a candidate in a round, in seconds, so that the clock's own time and interrupts do not matter.
const MIN_SECONDS: f64 = 4e-3;

/// Candidates by name, compared within each round.
pub struct PairedBench<'a> {
    candidates: Vec<Candidate<'a>>,
    clock_id: ClockId,
}

struct Candidate<'a> {
    name: String,
    /// Takes a number of repeats, and returns their time in seconds.
    run: Box<dyn FnMut(u32, ClockId) -> f64 + 'a>,
    repeats: u32,
}

impl<'a> PairedBench<'a> {
    pub fn new() -> Self {
        Self { candidates: Vec::new(), clock_id: ClockId::ThreadCPUTime }
    }

    /// A comparison of candidates that start threads of their own.
    pub fn by_wall_clock() -> Self {
        Self { clock_id: ClockId::Monotonic, ..Self::new() }
    }

    /// Adds a candidate; what `run` returns is not optimised away.
    pub fn with<T>(self, name: impl Into<String>, mut run: impl FnMut() -> T + 'a) -> Self {
        self.timed_by(name, move |repeats, clock| {
            let start = seconds(clock);
            for _ in 0..repeats {
                black_box(run());
            }
            seconds(clock) - start
        })
    }

    /// Adds a candidate each of whose runs is on new input, which `prepare` makes off the clock just before.
    ///
    /// So nothing that queries store in a frame is there yet, while the frame lies in the caches as it does in a program.
    /// Starting and stopping the clock costs less than a microsecond a run.
    pub fn with_prepared<S, T>(
        self,
        name: impl Into<String>,
        mut prepare: impl FnMut() -> S + 'a,
        mut run: impl FnMut(S) -> T + 'a,
    ) -> Self {
        self.timed_by(name, move |repeats, clock| {
            let mut total = 0.0;
            for _ in 0..repeats {
                let prepared = black_box(prepare());
                let start = seconds(clock);
                black_box(run(prepared));
                total += seconds(clock) - start;
            }
            total
        })
    }

    fn timed_by(mut self, name: impl Into<String>, run: impl FnMut(u32, ClockId) -> f64 + 'a) -> Self {
        self.candidates.push(Candidate { name: name.into(), run: Box::new(run), repeats: 1 });
        self
    }

    /// Runs `rounds` rounds, after one that measures how many repeats each candidate needs.
    pub fn run(mut self, rounds: usize, bar: &ProgressBar) -> Times {
        bar.inc_length(rounds as u64);
        for candidate in &mut self.candidates {
            let once = candidate.seconds(self.clock_id);
            candidate.repeats = (MIN_SECONDS / once).ceil().clamp(1.0, 1e6) as u32;
        }

        let mut times = Times {
            names: self.candidates.iter().map(|candidate| candidate.name.clone()).collect(),
            rounds: Vec::new(),
        };
        for _ in 0..rounds {
            let seconds = self.candidates.iter_mut().map(|candidate| candidate.seconds(self.clock_id));
            times.rounds.push(seconds.collect());
            bar.inc(1);
        }

        times
    }
}

impl Candidate<'_> {
    /// Seconds of one run, the mean over the repeats, after a run that is not timed: the last candidate has filled the
    /// caches with its data.
    fn seconds(&mut self, clock: ClockId) -> f64 {
        (self.run)(1, clock);
        (self.run)(self.repeats, clock) / f64::from(self.repeats)
    }
}

/// The time of each candidate in each round, in seconds.
pub struct Times {
    names: Vec<String>,
    rounds: Vec<Vec<f64>>,
}

impl Times {
    /// The median over the rounds.
    pub fn seconds(&self, name: &str) -> f64 {
        let index = self.index(name);
        median(self.rounds.iter().map(|round| round[index]))
    }

    /// How many times as long as `other` a candidate takes: the median over the rounds of the ratios within one.
    pub fn ratio(&self, name: &str, other: &str) -> f64 {
        let (index, other) = (self.index(name), self.index(other));
        median(self.rounds.iter().map(|round| round[index] / round[other]))
    }

    fn index(&self, name: &str) -> usize {
        self.names.iter().position(|known| known == name).expect("a candidate's name")
    }
}

/// Seconds that this thread has run, on any core.
pub fn thread_seconds() -> f64 {
    seconds(ClockId::ThreadCPUTime)
}

fn seconds(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
