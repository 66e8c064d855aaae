//! Paired timing: each round runs all candidates, and only times of one round are compared.
//!
//! Times are CPU times of the thread, which leave out what other programs take. Candidates that start threads of their
//! own are timed by the wall clock.

use indicatif::ProgressBar;
use ode_visual_hull_testing::median;
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

/// Minimum time of a candidate in a round, in seconds, so that reading the clock and an interrupt do not matter.
const MIN_SECONDS: f64 = 4e-3;

/// Named candidates that are compared within each round.
pub struct PairedBench<'a> {
    candidates: Vec<Candidate<'a>>,
    clock_id: ClockId,
}

struct Candidate<'a> {
    name: String,
    /// Runs the candidate a number of times and returns the seconds that this took.
    run: Box<dyn FnMut(u32, ClockId) -> f64 + 'a>,
    repeats: u32,
}

impl<'a> PairedBench<'a> {
    pub fn new() -> Self {
        Self { candidates: Vec::new(), clock_id: ClockId::ThreadCPUTime }
    }

    /// A comparison by wall-clock time, for candidates that start threads of their own.
    pub fn by_wall_clock() -> Self {
        Self { clock_id: ClockId::Monotonic, ..Self::new() }
    }

    /// Adds a candidate. The optimiser keeps the result of `run`.
    pub fn with<T>(self, name: impl Into<String>, mut run: impl FnMut() -> T + 'a) -> Self {
        self.timed_by(name, move |repeats, clock| {
            let start = seconds(clock);
            for _ in 0..repeats {
                black_box(run());
            }
            seconds(clock) - start
        })
    }

    /// Adds a candidate that takes new input in each run, made by `prepare` just before, which is not timed.
    ///
    /// A new frame has no results cached from earlier queries, but lies in the processor's caches as it does in a
    /// program. Reading the clock takes less than a microsecond a run.
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

    /// Runs `rounds` rounds, after one more that finds how often each candidate has to run in a round.
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
    /// Seconds of one run, as the mean over the repeats. An untimed run comes first, because the previous candidate has
    /// filled the caches.
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
    /// The median time of a candidate over the rounds, in seconds.
    pub fn seconds(&self, name: &str) -> f64 {
        let index = self.index(name);
        median(self.rounds.iter().map(|round| round[index]))
    }

    /// The time of a candidate divided by the time of `other`: the median over the rounds of the ratio within a round.
    pub fn ratio(&self, name: &str, other: &str) -> f64 {
        let (index, other) = (self.index(name), self.index(other));
        median(self.rounds.iter().map(|round| round[index] / round[other]))
    }

    fn index(&self, name: &str) -> usize {
        self.names.iter().position(|known| known == name).expect("a candidate's name")
    }
}

/// CPU time of this thread so far, in seconds.
pub fn thread_seconds() -> f64 {
    seconds(ClockId::ThreadCPUTime)
}

fn seconds(clock: ClockId) -> f64 {
    let time = clock_gettime(clock);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
