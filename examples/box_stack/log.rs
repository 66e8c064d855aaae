//! What happened: every box's state in every frame.

use super::simulation::{Simulation, State, Support};
use ode_visual_hull::{Error, Result};
use std::fmt::Write;
use std::path::Path;

/// One frame.
pub struct Entry {
    /// In seconds, at the frame's end.
    pub time: f64,
    /// Of the boxes.
    pub states: Vec<State>,
    /// What holds them up.
    pub supports: Vec<Support>,
    /// Height of the real subject's top, in metres, where known.
    pub real_top: Option<f64>,
}

/// All frames.
pub struct Log {
    /// Red, green, blue of each box.
    pub colours: Vec<[u8; 3]>,
    /// In the order of time.
    pub entries: Vec<Entry>,
}

impl Log {
    /// An empty log of the boxes of `simulation`.
    pub fn new(simulation: &Simulation) -> Self {
        Self { colours: simulation.boxes().iter().map(|one| one.colour).collect(), entries: Vec::new() }
    }

    /// Notes the present states.
    pub fn record(&mut self, simulation: &Simulation, real_top: Option<f64>) {
        self.entries.push(Entry {
            time: simulation.time(),
            states: simulation.states(),
            supports: simulation.supports(),
            real_top,
        });
    }

    /// The entries between two times, in seconds.
    pub fn between(&self, from: f64, to: f64) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(move |entry| entry.time >= from && entry.time <= to)
    }

    /// Writes one line per frame and box.
    pub fn write_csv(&self, path: &Path) -> Result<()> {
        let mut text = String::from("time_s,box,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz\n");
        for entry in &self.entries {
            for (i, state) in entry.states.iter().enumerate() {
                let (p, q) = (state.pose.translation.vector, state.pose.rotation.coords);
                let (v, w) = (state.linear_velocity, state.angular_velocity);
                let numbers = [p.x, p.y, p.z, q.w, q.x, q.y, q.z, v.x, v.y, v.z, w.x, w.y, w.z];
                let _ = write!(text, "{:.4},{}", entry.time, i + 1);
                for number in numbers {
                    let _ = write!(text, ",{number:.6}");
                }
                text.push('\n');
            }
        }
        std::fs::write(path, text)
            .map_err(|e| Error::file(path, format!("expected to write the states, found: {e}")))
    }
}
