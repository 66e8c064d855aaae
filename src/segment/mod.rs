//! Colour images to silhouettes.
//!
//! [`CleanPlate`] compares each image with one of the empty room. It wants a fixed camera, steady light and a subject
//! whose colours differ from what is behind it. Other ways to a mask fit as well: the hull takes any
//! [`image::GrayImage`] that is at least 128 on the subject.

mod clean_plate;

pub use clean_plate::{CleanPlate, Thresholds};
