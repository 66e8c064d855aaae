//! Pictures over time: the scenes of recordings and of finished runs, tours through them, and films.

mod captured;
mod movie;
mod tour;

pub use captured::{CapturedFrames, FinishedScenes};
pub use movie::Movie;
pub use tour::Tour;
