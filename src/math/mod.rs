//! What loops over many points are made of.

pub(crate) mod lanes;
pub(crate) mod point_cloud;
