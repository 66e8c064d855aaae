//! Whether the silhouettes of a frame fit one another: what a wrong calibration shows in, without any other reference.
//!
//! Where the epipolar tangents of two silhouettes miss each other, some view's pixels are shifted; where a silhouette
//! holds pixels that no point of the hull explains, another view cuts off what it sees.

mod coherence;
mod epipolar_tangency;

pub use coherence::SilhouetteCoherence;
pub use epipolar_tangency::{EpipolarTangency, ViewShift};
