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
//! six cameras that look down at 30 degrees, and with six at the height of the top?
//!
//! ```
//! use nalgebra::{Isometry3, Point3, Vector3};
//! use ode_visual_hull::camera::Camera;
//! use ode_visual_hull::synthetic::{layout, silhouette, Paint, Placed, Solid, Subject};
//!
//! let table = Solid::cuboid(Vector3::new(0.4, 0.4, 0.4))?;
//! let table = Subject::new(vec![Placed::new(table, Isometry3::translation(0.0, 0.0, 0.2), Paint::plain([180, 40, 40]))]);
//! let top = Point3::new(0.0, 0.0, 0.4);
//!
//! let tent_height = |cameras: &[Camera]| {
//!     let masks: Vec<_> = cameras.iter().map(|camera| silhouette(camera, &table)).collect();
//!     let in_hull = |point: &Point3<f64>| {
//!         cameras.iter().zip(&masks).all(|(camera, mask)| {
//!             let pixel = camera.project(point).expect("in front of every camera");
//!             mask.get_pixel(pixel.u as u32, pixel.v as u32).0[0] >= 128
//!         })
//!     };
//!     (0..200).map(|mm| f64::from(mm) * 1e-3).find(|&h| !in_hull(&(top + Vector3::z() * h))).unwrap()
//! };
//! let size = (96, 72);
//! let looking_down = layout::ring(6, 2.6, 0.4 + 1.5, top, size, 0.5)?;
//! let grazing = layout::ring(6, 3.0, 0.4, top, size, 0.5)?;
//! assert!(tent_height(&looking_down) > 0.10);
//! assert!(tent_height(&grazing) < 0.02); // a pixel's footprint, at this size
//! # Ok::<(), ode_visual_hull::Error>(())
//! ```

mod eye;
pub mod layout;
mod noise;
mod paint;
mod person;
mod random;
mod render;
mod room;
mod silhouette;
mod solid;
mod subject;
mod torus;

pub use noise::{add_noise, flip_boundary};
pub use paint::{Paint, Pattern};
pub use person::PERSON_PERIOD;
pub use render::{Scene, clean_plate, render, render_depth, render_over};
pub use room::Room;
pub use silhouette::{coverage, silhouette};
pub use solid::{Hit, Solid};
pub use subject::{Placed, Subject};

#[cfg(test)]
mod tests;
