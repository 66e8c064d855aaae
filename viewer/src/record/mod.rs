//! Pictures over time: the scenes of recordings and of finished runs, tours through them, and films.

mod captured;
mod movie;
mod paced_movie;
mod tour;

pub use captured::{CapturedFrames, FinishedScenes};
pub use movie::Movie;
pub use paced_movie::PacedMovie;
pub use tour::Tour;
