//! The state of every body in every frame.

use crate::body_shape;
use crate::simulated_body::{SimulatedBody, State, Support};
use crate::simulation::Simulation;
use crate::states::HEADER;
use crate::states_writer::write_entry;
use ode_visual_hull::{Error, Result};
use std::path::Path;

/// The states at the end of one frame.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Time of the frame's end, in seconds.
    pub time: f64,
    /// States of the bodies.
    pub states: Vec<State>,
    /// What supports each body.
    pub supports: Vec<Support>,
    /// Height of the real subject's top in metres, where it is known.
    pub real_top: Option<f64>,
    /// Speed of the real subject's fastest part in m/s, where it is known: the 99th percentile over points of a grid just
    /// inside the hull.
    pub subject_speed: Option<f64>,
}

/// The entries of all frames.
#[derive(Debug, Clone)]
pub struct Log {
    /// The word for the real subject.
    pub subject: String,
    /// Name and colour (red, green, blue) of each body.
    pub bodies: Vec<(String, [u8; 3])>,
    /// In the order of time.
    pub entries: Vec<Entry>,
}

impl Log {
    /// An empty log of the bodies of `simulation` and the subject of this name.
    pub fn new(simulation: &Simulation, subject: &str) -> Self {
        let named = |(i, one): (usize, &SimulatedBody)| {
            (format!("{} {}", body_shape::name(&one.parts), i + 1), one.colour())
        };
        let bodies = simulation.bodies().iter().enumerate().map(named).collect();
        Self { subject: subject.into(), bodies, entries: Vec::new() }
    }

    /// Adds the current states, and the subject's height and speed as in [`Entry`].
    pub fn record(&mut self, simulation: &Simulation, real_top: Option<f64>, subject_speed: Option<f64>) {
        self.entries.push(Entry {
            time: simulation.time(),
            states: simulation.states(),
            supports: simulation.supports(),
            real_top,
            subject_speed,
        });
    }

    /// The entries between two times, in seconds.
    pub fn between(&self, from: f64, to: f64) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(move |entry| entry.time >= from && entry.time <= to)
    }

    /// Writes one line for each frame and body, bodies numbered from 1: time, position, rotation (quaternion, real
    /// part first), velocity, angular velocity, all in the world's frame. [`States`](crate::States) reads it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_csv(&self, path: &Path) -> Result<()> {
        let mut text = format!("{HEADER}\n");
        for entry in &self.entries {
            write_entry(&mut text, entry.time, &entry.states);
        }

        std::fs::write(path, text)
            .map_err(|e| Error::file(path, format!("expected to write the states, found: {e}")))
    }
}
