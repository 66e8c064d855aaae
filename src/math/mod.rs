//! Boxes, rectangles, points in blocks, and operations for loops over many points.

pub(crate) mod aabb;
pub(crate) mod lanes;
pub(crate) mod point_cloud;
pub(crate) mod rect;
mod vectorised;

pub(crate) use vectorised::vectorised;
