//! Films of what a window shows, which has pictures at uneven times.

use super::Movie;
use image::RgbImage;
use image::imageops::{FilterType, resize};
use ode_visual_hull::Result;
use std::path::Path;
use std::time::Instant;

/// Frames of the film a second.
const RATE: f64 = 15.0;

/// A film by the wall clock: each of its frames is the picture that was shown at its time.
pub struct PacedMovie {
    movie: Movie,
    size: (u32, u32),
    started: Option<Instant>,
    frames: u64,
}

impl PacedMovie {
    /// A film of `size` pixels that begins with the first picture.
    ///
    /// # Errors
    /// As [`Movie::create`].
    pub fn create(path: &Path, size: (u32, u32)) -> Result<Self> {
        Ok(Self { movie: Movie::create(path, size, RATE)?, size, started: None, frames: 0 })
    }

    /// Shows `picture` from now on; one of another size is scaled.
    ///
    /// # Errors
    /// As [`Movie::push`].
    pub fn push(&mut self, picture: &RgbImage) -> Result<()> {
        let elapsed = self.started.get_or_insert_with(Instant::now).elapsed().as_secs_f64();
        let due = (elapsed * RATE) as u64 + 1;
        if due <= self.frames {
            return Ok(());
        }
        let (width, height) = self.size;
        let scaled = if picture.dimensions() == self.size {
            picture.clone()
        } else {
            resize(picture, width, height, FilterType::Triangle)
        };
        while self.frames < due {
            self.movie.push(scaled.clone())?;
            self.frames += 1;
        }
        Ok(())
    }

    /// Completes the file.
    ///
    /// # Errors
    /// As [`Movie::finish`].
    pub fn finish(self) -> Result<()> {
        self.movie.finish()
    }
}
