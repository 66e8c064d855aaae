//! `bodies.toml`: how the bodies of a run look, and how the recording that they met was played.
//!
//! The file stands beside `states.csv`, which tells where the bodies were. Lengths are in metres, quaternions w, x, y, z:
//!
//! ```toml
//! [[body]]                          # body 1 of states.csv
//!
//! [[body.part]]
//! shape = "box"
//! sides = [0.2, 0.1, 0.1]
//! colour = [222, 86, 62]            # red, green, blue from 0 to 255
//! position = [0.0, 0.0, 0.0]        # in the body's frame
//! quaternion = [1.0, 0.0, 0.0, 0.0]
//!
//! [[fixed]]                         # what does not move; its pose is in the world
//! shape = "capsule"
//! radius = 0.05
//! length = 1.0
//! # and so on
//!
//! [playback]                        # only where a recording was played or made
//! wait = 3.0                        # seconds for which the first frame is held, and the last one
//! linger = 1.0
//! frames = "0..90"
//! rate = 30.0                       # images a second, where the recording does not tell them
//! bounds = [-1.0, 1.0, -1.0, 1.0, 0.0, 2.0]
//! unseen = "outside"                # or "abstain"
//! motion = "interpolated"           # or "held", "predicted"
//! ```
//!
//! The other shapes are `sphere` (`radius`), `cylinder` (`radius`, `length`), `plane` (`normal`, `offset`), `convex`
//! (`points`, `faces`), `trimesh` (`points`, `triangles`) and `heightfield` (`counts`, `size`, `heights`, `thickness`,
//! `wraps`), with the numbers of [`Shape`](ode_visual_hull::shape::Shape).

mod playback;
mod reader;
mod shapes;
mod table;
#[cfg(test)]
mod tests;
mod writer;

pub use playback::PlayedRecording;

use crate::compositor::Drawn;
use nalgebra::Isometry3;
use ode_visual_hull::shape::Shape;
use ode_visual_hull::{Error, Result};
use std::path::Path;

/// The bodies of a run as they are drawn, and how the recording was played.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct BodiesFile {
    /// The parts of each body, in the order of the numbers in `states.csv`.
    pub bodies: Vec<Vec<DrawnPart>>,
    /// What does not move.
    pub fixed: Vec<Drawn>,
    /// How the recording was played; `None` where there is none.
    pub playback: Option<PlayedRecording>,
}

/// A part of a body as it is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnPart {
    /// Any shape but a ray.
    pub shape: Shape,
    /// The pose of the part in the body's frame.
    pub body_from_part: Isometry3<f64>,
    /// Red, green, blue.
    pub colour: [u8; 3],
}

impl DrawnPart {
    /// The part as it is drawn where its body has the pose `world_from_body`.
    pub fn at(&self, world_from_body: &Isometry3<f64>) -> Drawn {
        Drawn {
            shape: self.shape.clone(),
            world_from_body: world_from_body * self.body_from_part,
            colour: self.colour,
        }
    }
}

impl BodiesFile {
    /// The file's name in the folder of a run.
    pub const NAME: &'static str = "bodies.toml";

    /// Reads the file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, and all errors of [`from_toml`](Self::from_toml).
    pub fn read(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let text = std::fs::read_to_string(path).map_err(|e| {
            let name = Self::NAME;
            Error::file(
                path,
                format!("expected the bodies of a run, found: {e}; give the {name} beside its states"),
            )
        })?;
        Self::from_toml(&text).map_err(|e| Error::file(path, e))
    }

    /// Reads the text of such a file.
    ///
    /// # Errors
    /// Text that is not TOML; a field that is unknown, missing, or of another type; a body without parts; a length, number
    /// or colour out of range, a quaternion of length 0, points that [`Convex`](ode_visual_hull::shape::Convex),
    /// [`TriMesh`](ode_visual_hull::shape::TriMesh) or [`Heightfield`](ode_visual_hull::shape::Heightfield) refuses. The
    /// message names the line, the part and the field.
    pub fn from_toml(text: &str) -> Result<Self> {
        reader::read(text)
    }

    /// The text of the file. Reading it back gives the same bodies, but for the last digits of their rotations.
    ///
    /// # Errors
    /// A body without parts; a ray, which is not drawn.
    pub fn to_toml(&self) -> Result<String> {
        writer::write(self)
    }

    /// Writes the file to `path`.
    ///
    /// # Errors
    /// All errors of [`to_toml`](Self::to_toml); a file that cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<()> {
        let path = path.as_ref();
        let text = self.to_toml().map_err(|e| Error::file(path, e))?;
        std::fs::write(path, text)
            .map_err(|e| Error::file(path, format!("expected to write the bodies, found: {e}")))
    }
}
