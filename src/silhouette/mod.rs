//! One view's mask: read from a file, and freed of lens distortion.

mod mask;
mod undistort;

pub use mask::load_mask;
pub use undistort::Undistortion;
