//! Queries of one point, one half-line or one ray, in double precision and without vectorisation.
//!
//! The [`batch`](super::batch) has to return the same bits, as tests check, and falls back to these queries in rare
//! cases.

mod exit;
mod interval_merge;
mod line_walk;
mod projection;
mod ray_cast;
mod response;
mod view_traversal;
mod window_search;

pub(super) use line_walk::MaskTraversal;
pub(super) use projection::ViewSamples;
pub use ray_cast::RayHit;
pub(super) use ray_cast::nearest_edge_in;
pub(super) use response::towards;
pub use response::{ExitVector, Response};
pub use window_search::NearestEdge;
pub(super) use window_search::{ROUNDING, deciding_window, extent, window_half_width};
