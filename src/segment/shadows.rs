//! The test whether a pixel that differs from the background is background in a shadow.

use crate::{Error, Result};

/// A model of shadows on the background.
///
/// A shadow dims a pixel and keeps its hue: its colour is the background's times a ratio below 1, with a small
/// remainder.
///
/// The test is that of Horprasert, Harwood and Davis, *A statistical approach for real-time robust background
/// subtraction and shadow detection* (1999), in grey levels: the colour's distance from the line through black and the
/// background's colour, and its position along that line. Parts of the subject that look like a shadow on the
/// background behind them are lost; [`Cleanup`](super::Cleanup) closes such gaps if they are small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shadows {
    /// The deepest shadow, as a ratio to the unshaded background, 0 to 1. Default 0.75; MOG2 calls it the shadow
    /// threshold, with default 0.5.
    pub darkest: f64,
    /// The brightest light that still counts as background, as a ratio of at least 1. Default 1.2.
    pub brightest: f64,
    /// The largest distance of the colour from the background's times the ratio, in grey levels. Default 6.
    pub hue_tolerance: f64,
}

/// The thresholds in the form that the test compares with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub(super) darkest: f32,
    pub(super) brightest: f32,
    pub(super) chroma_squared: f32,
}

impl Shadows {
    /// Soft shadows of ceiling lamps or daylight, hardly darker than three quarters of the background. Darker pixels
    /// are the subject, such as dark clothes in front of a grey wall. The default.
    pub const SOFT: Self = Self { darkest: 0.75, brightest: 1.2, hue_tolerance: 6.0 };

    /// Deep shadows of one or two lamps, down to less than half of the background's light. The subject's colours must
    /// differ from the background's in hue, or be brighter.
    pub const DEEP: Self = Self { darkest: 0.45, brightest: 1.2, hue_tolerance: 14.0 };
}

impl Default for Shadows {
    fn default() -> Self {
        Self::SOFT
    }
}

impl Shadows {
    /// Checks the ranges.
    /// A ratio outside its range, a tolerance that is negative or not finite.
    pub(super) fn check(&self) -> Result<()> {
        let Self { darkest, brightest, hue_tolerance } = *self;
        if !((0.0..=1.0).contains(&darkest) && brightest >= 1.0 && brightest.is_finite()) {
            return Err(Error::argument(format!(
                "expected shadows of a ratio from 0 to 1 and light of one of at least 1, found {darkest} and \
                 {brightest}; 1 and 1 allow neither"
            )));
        }

        if !(hue_tolerance >= 0.0 && hue_tolerance.is_finite()) {
            return Err(Error::argument(format!(
                "expected a shadow's hue tolerance of 0 grey levels or more, found {hue_tolerance}"
            )));
        }

        Ok(())
    }

    pub(super) fn limits(&self) -> Limits {
        Limits {
            darkest: self.darkest as f32,
            brightest: self.brightest as f32,
            chroma_squared: (self.hue_tolerance * self.hue_tolerance) as f32,
        }
    }
}
