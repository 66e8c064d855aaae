//! One run of the program: its number of rounds, its results, and its progress bar.

use crate::timing::{PairedBench, Times};
use indicatif::{ProgressBar, ProgressStyle};
use ode_visual_hull_testing::figure::{Bound, Figure};
use std::path::{Path, PathBuf};

/// The input at which a figure's clock starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StartTime {
    /// Colour images: segmentation is included.
    Images,
    /// Masks: preparing the frame is included.
    Masks,
    /// A prepared frame: only queries are timed.
    Frame,
    /// A step of a simulation, whose frame is prepared before.
    Step,
}

/// A figure and its description.
#[derive(Debug, Clone)]
pub struct Row {
    pub figure: Figure,
    pub start: StartTime,
    /// The description, without a full stop.
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
    /// A run of comparisons with `rounds` rounds each, and plots below the folder `docs`.
    pub fn new(rounds: usize, docs: PathBuf) -> Self {
        let style = ProgressStyle::with_template("{msg:28} [{bar:40}] {pos}/{len} rounds, {elapsed}")
            .expect("a valid template")
            .progress_chars("=> ");
        let bar = ProgressBar::new(0).with_style(style);
        Self { rounds, docs, bar, rows: Vec::new() }
    }

    /// Shows the group that is measured next.
    pub fn start_group(&self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    /// Lets the candidates take turns.
    pub fn run(&self, bench: PairedBench<'_>) -> Times {
        bench.run(self.rounds, &self.bar)
    }

    /// Number of rounds of a comparison.
    pub fn rounds(&self) -> usize {
        self.rounds
    }

    /// Prints that something is left out.
    pub fn leave_out(&self, what: &str) {
        self.bar.println(format!("left out: {what}"));
    }

    /// Adds a figure, with a bound or without.
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

    /// The folder of the documentation.
    pub fn docs(&self) -> &Path {
        &self.docs
    }

    /// All figures.
    pub fn into_rows(self) -> Vec<Row> {
        self.bar.finish_and_clear();
        self.rows
    }
}

impl StartTime {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Images => "images",
            Self::Masks => "masks",
            Self::Frame => "prepared frame",
            Self::Step => "step",
        }
    }
}
