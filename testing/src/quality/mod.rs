//! The hull from pixels, compared with the analytic hull of its cameras.
//!
//! ```text
//!   contour    a solid's exact outline in a camera's image
//!   analytic   the hull of such outlines
//!   scene      solids and cameras, their analytic hull and their hull from pixels
//!   accuracy   errors of the hull from pixels
//! ```

pub mod accuracy;
pub mod analytic;
pub mod contour;
pub mod scene;
