//! A synthetic studio: subjects, cameras, silhouettes and colour images with exact ground truth.
//!
//! It serves to try a camera layout before buying cameras, and for tests, figures and demos.
//!
//! ```text
//!   Layout ──► [Camera]          Subject = [Solid, pose, paint]       Room
//!                  │                   │                               │
//!                  ├───────────────────┼──► silhouette, coverage       │
//!                  └───────────────────┴───────────────┬───────────────┘
//!                                                      └──► render, clean_plate, render_depth ──► noise
//! ```
//!
//! Units are metres and radians, z is up, the floor is at z = 0. Silhouettes are computed by exact ray casting,
//! including grazing rays: to a nanometre at the distances of a studio.
//!
//! # Trying a layout
//!
//! Above a flat table the visual hull has a tent unless a camera looks along the table top. How high is it with six
//! cameras that look down at 30 degrees on a cube of 40 cm, and with six at the height of its top?
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
mod hands;
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
