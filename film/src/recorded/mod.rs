//! Recordings of a real subject: played as a capture, and the hulls of single frames.

mod background_images;
mod frame_times;
mod frames_csv;
mod hulls;
mod obstacle;
mod playback;
mod timeline;

pub use background_images::{BackgroundImages, FrameTime};
pub use frame_times::{ASSUMED_RATE, FrameTimes};
pub use frames_csv::FramesCsv;
pub use hulls::RecordedHulls;
pub use obstacle::{ground, in_the_way};
pub use playback::{Playback, check_subject};
