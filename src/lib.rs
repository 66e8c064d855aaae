//! The visual hull of a real, moving subject as a collision shape for rigid bodies.

#![deny(unsafe_code)]

pub mod camera;
mod capi;
pub mod contact;
mod error;
pub mod hull;
mod image_file;
pub mod ode;
pub mod recording;
pub mod rig;
pub mod sample;
pub mod segment;
pub mod silhouette;
pub mod synthetic;

pub use error::{Error, Result};
