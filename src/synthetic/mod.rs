//! A studio that does not exist: subjects, cameras, silhouettes and colour images with a known truth.
//!
//! Users try a camera layout here before they buy cameras; tests, figures and demos stand on it.
//!
//! ```text
//!   Layout ──► [Camera]          Subject = [Solid, pose, paint]       Room
//!                  │                   │                               │
//!                  ├───────────────────┼──► silhouette, coverage       │
//!                  └───────────────────┴───────────────┬───────────────┘
//!                                                      └──► render, clean_plate, render_depth ──► noise
//! ```
//!
//! Metres and radians, z up, floor at z = 0. A silhouette is decided by exact ray casting, grazing rays included: to a
//! nanometre at the distances of a studio.
//!
//! # Trying a layout
//!
//! Above a flat table the visual hull is a tent unless a camera looks along the table top. How high is it with
//! six cameras that look down at 30 degrees on a cube of 40 cm, and with six at the height of its top?
//!
//! ```
//! use nalgebra::Point3;
//! use ode_visual_hull::synthetic::{Tent, layout};
//!
//! let top = Point3::new(0.0, 0.0, 0.4);
//! let size = (96, 72);
//! let looking_down = layout::ring(6, 2.6, 0.4 + 1.5, top, size, 0.5)?;
//! let grazing = layout::ring(6, 3.0, 0.4, top, size, 0.5)?;
//! assert!(Tent::above(&looking_down, top, 0.4)?.middle > 0.10);
//! assert!(Tent::above(&grazing, top, 0.4)?.middle < 1e-6);
//! # Ok::<(), ode_visual_hull::Error>(())
//! ```

mod eye;
pub mod layout;
mod noise;
mod person;
mod random;
mod render;
mod room;
mod silhouette;
mod solid;
mod subject;
mod tent;
mod texture;
mod torus;

pub use noise::{add_noise, flip_boundary};
pub use person::PERSON_PERIOD;
pub use render::{Scene, clean_plate, render, render_depth, render_over};
pub use room::Room;
pub use silhouette::{coverage, silhouette};
pub use solid::{Hit, Solid};
pub use subject::{Placed, Subject};
pub use tent::Tent;
pub use texture::{Pattern, Texture};

#[cfg(test)]
mod tests;
