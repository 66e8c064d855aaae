//! The hull from pixels beside the analytic hull of the same cameras.
//!
//! ```text
//!   contour    a solid's exact outline in a camera's image
//!   analytic   the hull of such outlines
//!   scene      solids and cameras, their analytic hull and the one from pixels
//!   accuracy   how far the one is from the other
//! ```

pub mod accuracy;
pub mod analytic;
pub mod contour;
pub mod scene;
