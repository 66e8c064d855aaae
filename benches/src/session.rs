//! One run of the program: its number of rounds, its figures so far, and its progress bar.

use crate::timing::{PairedBench, Times};
use indicatif::{ProgressBar, ProgressStyle};
use ode_visual_hull_testing::figure::{Bound, Figure};
use std::path::{Path, PathBuf};

/// The stage from which on a figure's time counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartTime {
    /// From colour images: the time includes segmentation.
    Images,
    /// From masks: the time includes preparing the frame.
    Masks,
    /// From a prepared frame: the time of the queries alone.
    Frame,
    /// A step of a simulation whose frame is prepared already.
    Step,
}

/// A figure with its description.
#[derive(Debug, Clone)]
pub struct Row {
    pub figure: Figure,
    pub start: StartTime,
    /// A phrase for the table: what was measured.
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
    /// A run of `rounds` rounds for each comparison, which writes its plots below the folder `docs`.
    pub fn new(rounds: usize, docs: PathBuf) -> Self {
        let style = ProgressStyle::with_template("{msg:28} [{bar:40}] {pos}/{len} rounds, {elapsed}")
            .expect("a valid template")
            .progress_chars("=> ");
        let bar = ProgressBar::new(0).with_style(style);
        Self { rounds, docs, bar, rows: Vec::new() }
    }

    /// Shows the name of the next group beside the progress bar.
    pub fn start_group(&self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    /// Times the candidates, which take turns in each round.
    pub fn run(&self, bench: PairedBench<'_>) -> Times {
        bench.run(self.rounds, &self.bar)
    }

    /// Number of rounds of a comparison.
    pub fn rounds(&self) -> usize {
        self.rounds
    }

    /// Prints that a measurement is left out, and why.
    pub fn leave_out(&self, what: &str) {
        self.bar.println(format!("left out: {what}"));
    }

    /// Adds a figure with or without a bound.
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

    /// Adds a figure with a bound.
    pub fn bounded(&mut self, name: &str, value: f64, bound: Bound, start: StartTime, what: &'static str) {
        self.rows.push(Row { figure: Figure::bounded(name, value, bound), start, what });
    }

    /// Adds a figure without a bound.
    pub fn reported(&mut self, name: &str, value: f64, start: StartTime, what: &'static str) {
        self.rows.push(Row { figure: Figure::reported(name, value), start, what });
    }

    /// The folder that documentation is written to.
    pub fn docs(&self) -> &Path {
        &self.docs
    }

    /// All figures, in the order of measurement.
    pub fn into_rows(self) -> Vec<Row> {
        self.bar.finish_and_clear();
        self.rows
    }
}

impl StartTime {
    /// The name in the table of figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Images => "images",
            Self::Masks => "masks",
            Self::Frame => "prepared frame",
            Self::Step => "step",
        }
    }
}
