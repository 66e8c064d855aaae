//! Pictures of a real subject and virtual bodies from any viewpoint (free-viewpoint video).
//!
//! ```text
//!   Hull, images ──► Scene ──► Renderer (cpu or gpu) ──► Picture ──► still, film, comparison
//!   bodies ────────────┘            ▲
//!                     a viewpoint of a Tour
//! ```
//!
//! The subject is drawn from its silhouettes, without a mesh: the ray of each pixel is followed to the visual hull, and
//! coloured by the images of the real cameras. Nothing here needs a window or ODE.

pub mod cpu;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod history;
#[cfg(feature = "window")]
pub mod live;
pub mod metrics;
pub mod orbit;
pub mod overlay;
mod picture;
pub mod record;
mod renderer;
pub mod scene;
pub mod supersample;
#[cfg(feature = "window")]
pub mod window;

pub use picture::{Content, DrawOptions, Method, Picture};
pub use renderer::{Renderer, RendererKind};
