//! Whether the silhouettes of a frame fit one another, which shows a wrong calibration or a wrong mask without any
//! other reference.
//!
//! - [`EpipolarTangency`]: the outermost planes through two cameras that touch the subject touch both silhouettes.
//!   Where they do not, the image of a view is shifted.
//! - [`silhouette_coherence`]: where a silhouette holds pixels whose viewing rays miss the hull, another view cuts away
//!   what this one sees.

mod coherence;
mod epipolar_tangency;
mod outline;

pub use coherence::{SilhouetteCoherence, silhouette_coherence, total_coherence};
pub use epipolar_tangency::{EpipolarTangency, ViewShift};

/// The upper median, 0 without values.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}
