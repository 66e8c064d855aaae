//! One run of the program: how long it measures, what it has measured, and where it reports progress.

use crate::timing::{PairedBench, Times};
use indicatif::{ProgressBar, ProgressStyle};
use ode_visual_hull_testing::figure::{Bound, Figure};
use std::path::{Path, PathBuf};

/// What a figure's clock starts with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartTime {
    /// Colour images: they are segmented on the clock.
    Images,
    /// Masks: the frame is prepared on the clock.
    Masks,
    /// A prepared frame: queries alone.
    Frame,
    /// A step of a simulation, its frame prepared before.
    Step,
}

/// A figure, and what it is about.
#[derive(Debug, Clone)]
pub struct Row {
    pub figure: Figure,
    pub start: StartTime,
    /// Half a sentence.
    pub what: &'static str,
}

/// One run of the program.
pub struct Session {
    rounds: usize,
    docs: PathBuf,
    bar: ProgressBar,
    rows: Vec<Row>,
}

impl Session {
    /// Races of `rounds` rounds, and plots below the folder `docs`.
    pub fn new(rounds: usize, docs: PathBuf) -> Self {
        let style = ProgressStyle::with_template("{msg:28} [{bar:40}] {pos}/{len} rounds, {elapsed}")
            .expect("a valid template")
            .progress_chars("=> ");
        let bar = ProgressBar::new(0).with_style(style);
        Self { rounds, docs, bar, rows: Vec::new() }
    }

    /// Tells what comes next.
    pub fn start_group(&self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    /// Lets the candidates take turns.
    pub fn run(&self, bench: PairedBench<'_>) -> Times {
        bench.run(self.rounds, &self.bar)
    }

    /// How many rounds a comparison has.
    pub fn rounds(&self) -> usize {
        self.rounds
    }

    /// Tells of something that is left out.
    pub fn leave_out(&self, what: &str) {
        self.bar.println(format!("left out: {what}"));
    }

    /// A figure, with a bound or without.
    pub fn figure(
        &mut self,
        name: &str,
        value: f64,
        bound: Option<Bound>,
        start: StartTime,
        what: &'static str,
    ) {
        match bound {
            Some(bound) => self.bounded(name, value, bound, start, what),
            None => self.reported(name, value, start, what),
        }
    }

    /// A figure with a bound.
    pub fn bounded(&mut self, name: &str, value: f64, bound: Bound, start: StartTime, what: &'static str) {
        self.rows.push(Row { figure: Figure::bounded(name, value, bound), start, what });
    }

    /// A figure that is reported whatever it is.
    pub fn reported(&mut self, name: &str, value: f64, start: StartTime, what: &'static str) {
        self.rows.push(Row { figure: Figure::reported(name, value), start, what });
    }

    /// Where documentation is written.
    pub fn docs(&self) -> &Path {
        &self.docs
    }

    /// All that was measured.
    pub fn into_rows(self) -> Vec<Row> {
        self.bar.finish_and_clear();
        self.rows
    }
}

impl StartTime {
    /// As a table has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Images => "images",
            Self::Masks => "masks",
            Self::Frame => "prepared frame",
            Self::Step => "step",
        }
    }
}
