//! How the subject moves between its recorded frames, by words of the command line.

use clap::ValueEnum;
use ode_visual_hull::hull::Motion;

/// [`Motion`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Movement {
    /// Each frame stands still until the next one, and the subject jumps from one to the other.
    Held,
    /// It moves from each frame to the next, one frame late, and pushes bodies with its own speed.
    Interpolated,
    /// It moves on as it moved between the last two frames, without delay, and pushes bodies with its own speed.
    Predicted,
}

impl Movement {
    /// The library's name for it.
    pub fn motion(self) -> Motion {
        match self {
            Self::Held => Motion::Held,
            Self::Interpolated => Motion::Interpolated,
            Self::Predicted => Motion::Predicted,
        }
    }

    /// How the hull moves between frames that are `period` seconds apart.
    pub fn description(self, period: f64) -> String {
        match self {
            Self::Held => "held from frame to frame, contacts carry no speed".into(),
            Self::Interpolated => {
                let late = (1e3 * period).round();
                format!(
                    "interpolated between frames, one frame late ({late} ms), contacts carry the surface's speed"
                )
            }
            Self::Predicted => {
                "predicted from the last two frames, contacts carry the surface's speed".into()
            }
        }
    }
}
