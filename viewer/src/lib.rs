//! Pictures of a real subject and virtual bodies from any viewpoint (free-viewpoint video).
//!
//! ```text
//!   Hull, images ──► Scene ──► cpu or gpu ──► Picture ──► still, film, comparison
//!   bodies ────────────┘          ▲
//!                    a viewpoint of a tour
//! ```
//!
//! The subject is drawn from its silhouettes, without a mesh: the ray of each pixel is followed to the visual hull, and
//! coloured by the images of the real cameras. Nothing here needs a window or ODE.

pub mod cpu;
pub mod metrics;
mod picture;
pub mod scene;

pub use picture::{Content, DrawOptions, Method, Picture};
