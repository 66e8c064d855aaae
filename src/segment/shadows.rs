//! When a pixel that differs from the room is the room in a shadow.

use crate::{Error, Result};

/// What a shadow may look like.
///
/// A shadow dims a pixel and keeps its hue: its colour is the room's times a ratio below 1, and little is left over.
///
/// The test is that of Horprasert, Harwood and Davis, *A statistical approach for real-time robust background
/// subtraction and shadow detection* (1999), in grey levels: the colour's distance from the line through black and the
/// room's colour, and where along that line it lies. It costs the parts of the subject that look like a shadow on what is
/// behind them; [`Cleanup`](super::Cleanup) closes such gaps where they are small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shadows {
    /// The deepest shadow, as a ratio to the unshaded room, 0 to 1. Default 0.75; MOG2 calls it the shadow threshold
    /// and has 0.5.
    pub darkest: f64,
    /// The brightest reflection or light that still counts as the room, at least 1. Default 1.2.
    pub brightest: f64,
    /// How far the colour may be from the room's times the ratio, in grey levels. Default 6.
    pub hue_tolerance: f64,
}

/// Squares and ratios, ready to compare with.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    pub(super) darkest: f32,
    pub(super) brightest: f32,
    pub(super) chroma_squared: f32,
}

impl Shadows {
    /// Of lamps on the ceiling or of daylight: soft, and hardly darker than three quarters of the room. What is darker is
    /// the subject, also dark clothes before a grey wall. The default.
    pub const SOFT: Self = Self { darkest: 0.75, brightest: 1.2, hue_tolerance: 6.0 };

    /// Of a lamp or two: down to less than half of the room's light. The subject's colours must differ from the room's
    /// in hue, or be brighter.
    pub const DEEP: Self = Self { darkest: 0.45, brightest: 1.2, hue_tolerance: 14.0 };
}

impl Default for Shadows {
    fn default() -> Self {
        Self::SOFT
    }
}

impl Shadows {
    /// # Errors
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
