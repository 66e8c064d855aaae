//! Contenders that take turns: each round runs all of them, and only times of one round are compared.
//!
//! The clock is the thread's own, which stands still while other programs have the core; where several threads race,
//! it is the one on the wall.

use indicatif::ProgressBar;
use rustix::time::{ClockId, clock_gettime};
use std::hint::black_box;

/// The least seconds that one contender runs in a round, so that the clock and a stray interrupt do not count.
const LEAST: f64 = 4e-3;

/// Contenders by name.
pub struct Race<'a> {
    contenders: Vec<Contender<'a>>,
    clock: ClockId,
}

struct Contender<'a> {
    name: String,
    run: Box<dyn FnMut() + 'a>,
    repeats: u32,
}

impl<'a> Race<'a> {
    pub fn new() -> Self {
        Self { contenders: Vec::new(), clock: ClockId::ThreadCPUTime }
    }

    /// A race of contenders that start threads of their own.
    pub fn on_the_wall() -> Self {
        Self { clock: ClockId::Monotonic, ..Self::new() }
    }

    /// Adds a contender; what `run` returns is not optimised away.
    pub fn with<T>(mut self, name: impl Into<String>, mut run: impl FnMut() -> T + 'a) -> Self {
        let run = Box::new(move || {
            black_box(run());
        });
        self.contenders.push(Contender { name: name.into(), run, repeats: 1 });
        self
    }

    /// Runs `rounds` rounds; one more is run before, to see how long each contender takes.
    pub fn run(mut self, rounds: usize, bar: &ProgressBar) -> Times {
        bar.inc_length(rounds as u64);
        for contender in &mut self.contenders {
            let once = contender.seconds(self.clock);
            contender.repeats = (LEAST / once).ceil().clamp(1.0, 1e6) as u32;
        }
        let mut times = Times {
            names: self.contenders.iter().map(|contender| contender.name.clone()).collect(),
            rounds: Vec::new(),
        };
        for _ in 0..rounds {
            let seconds = self.contenders.iter_mut().map(|contender| contender.seconds(self.clock));
            times.rounds.push(seconds.collect());
            bar.inc(1);
        }
        times
    }
}

impl Contender<'_> {
    /// Seconds of one run, the mean over the repeats. One run off the clock comes before: the last contender has left
    /// the caches full of its own.
    fn seconds(&mut self, clock: ClockId) -> f64 {
        (self.run)();
        let start = seconds(clock);
        (0..self.repeats).for_each(|_| (self.run)());
        (seconds(clock) - start) / f64::from(self.repeats)
    }
}

/// How long each contender took in each round, in seconds.
pub struct Times {
    names: Vec<String>,
    rounds: Vec<Vec<f64>>,
}

impl Times {
    /// The median over the rounds.
    pub fn seconds(&self, name: &str) -> f64 {
        let index = self.index(name);
        median(self.rounds.iter().map(|round| round[index]).collect())
    }

    /// How many times as long as `other` a contender takes: the median over the rounds of the ratios within one.
    pub fn ratio(&self, name: &str, other: &str) -> f64 {
        let (index, other) = (self.index(name), self.index(other));
        median(self.rounds.iter().map(|round| round[index] / round[other]).collect())
    }

    fn index(&self, name: &str) -> usize {
        self.names.iter().position(|known| known == name).expect("a contender's name")
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

pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let n = values.len();
    0.5 * (values[(n - 1) / 2] + values[n / 2])
}
