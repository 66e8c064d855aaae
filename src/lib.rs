//! The visual hull of a real, moving subject as a collision shape for rigid bodies.

#![deny(unsafe_code)]

pub mod camera;
mod error;
pub mod ode;

pub use error::{Error, Result};
