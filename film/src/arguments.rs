//! Options of the command line that the tool and the examples share, and parsers of their values.

use clap::ValueEnum;
use nalgebra::Point3;
use ode_visual_hull::Result;
use ode_visual_hull::hull::{Aabb, HullData, Motion, Unseen};
use ode_visual_hull::rig::Rig;
use std::ops::Range;

/// The work volume, and how a camera decides points that it does not see.
#[derive(Debug, Clone, Copy, Default, PartialEq, clap::Args)]
pub struct VolumeOptions {
    /// Work volume, in metres [default: around the point that the cameras look at, sized by their distance from it].
    #[arg(
        long,
        value_name = "X0,X1,Y0,Y1,Z0,Z1",
        value_parser = parse_bounds,
        allow_hyphen_values = true
    )]
    pub bounds: Option<Aabb>,
    /// How a camera decides points outside its image.
    #[arg(long, value_enum, default_value_t = UnseenPolicy::Outside)]
    pub unseen: UnseenPolicy,
}

impl VolumeOptions {
    /// The bounds, by default those derived from the poses of the cameras of `rig`.
    ///
    /// # Errors
    /// Poses that give no work volume.
    pub fn of(&self, rig: &Rig) -> Result<Aabb> {
        self.bounds.map_or_else(|| rig.work_volume(), Ok)
    }

    /// Adds the cameras of `rig` to `data`, and sets its work volume and its policy for unseen points.
    ///
    /// # Errors
    /// Cameras that `data` refuses, or poses without a work volume.
    pub fn prepare(&self, data: &HullData, rig: &Rig) -> Result<()> {
        data.add_views(rig.cameras())?;
        data.set_unseen(self.unseen.into())?;
        data.set_bounds(self.of(rig)?)
    }
}

/// Values of `--unseen`; see [`Unseen`].
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum UnseenPolicy {
    /// Points outside the image are outside the hull.
    #[default]
    Outside,
    /// The camera does not decide them; at least two cameras must see a point of the hull.
    Abstain,
}

impl From<UnseenPolicy> for Unseen {
    fn from(policy: UnseenPolicy) -> Self {
        match policy {
            UnseenPolicy::Outside => Self::Outside,
            UnseenPolicy::Abstain => Self::ABSTAIN,
        }
    }
}

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

/// Parses a work volume, six numbers in metres separated by commas.
pub fn parse_bounds(text: &str) -> std::result::Result<Aabb, String> {
    let [x0, x1, y0, y1, z0, z1] = numbers(text, "x0,x1,y0,y1,z0,z1")?;
    Aabb::new(Point3::new(x0, y0, z0), Point3::new(x1, y1, z1)).map_err(|error| error.to_string())
}

/// Parses width and height of an image in pixels, as `640x480`.
pub fn parse_size(text: &str) -> std::result::Result<(u32, u32), String> {
    let numbers = text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    numbers
        .filter(|&(w, h)| w > 0 && h > 0)
        .ok_or_else(|| format!("expected two whole numbers above zero as in 640x480, found {text}"))
}

/// Parses a finite number above zero.
pub fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse().ok().filter(|&number: &f64| number.is_finite() && number > 0.0);
    number.ok_or_else(|| format!("expected a number above zero, found {text}"))
}

/// Parses a frame rate in images per second, above zero.
pub fn parse_rate(text: &str) -> std::result::Result<f64, String> {
    parse_positive(text).map_err(|_| format!("expected a positive number of images per second, found {text}"))
}

/// Parses a half-open range of frames, `A..B`. A defaults to 0, B to `u32::MAX`, which stands for all that follow.
pub fn parse_frames(text: &str) -> std::result::Result<Range<u32>, String> {
    let number = |part: &str, open: u32| if part.is_empty() { Some(open) } else { part.parse().ok() };
    let range = text.split_once("..").and_then(|(a, b)| Some(number(a, 0)?..number(b, u32::MAX)?));
    range
        .filter(|range| !range.is_empty())
        .ok_or_else(|| format!("expected A..B with A below B, as in 20..60, 20.. or ..60, found {text}"))
}

/// Parses a range of seconds, `A..B`, from A up to but not B. A defaults to 0, B to the end.
pub fn parse_times(text: &str) -> std::result::Result<Range<f64>, String> {
    let number = |part: &str, open: f64| if part.is_empty() { Some(open) } else { part.trim().parse().ok() };
    let range = text.split_once("..").and_then(|(a, b)| Some(number(a, 0.0)?..number(b, f64::INFINITY)?));
    range.filter(|range| range.start >= 0.0 && range.start.is_finite() && range.start < range.end).ok_or_else(
        || format!("expected seconds A..B with A below B, as in 3..4.5, 3.. or ..2, found {text}"),
    )
}

/// Formats a range of frames so that [`parse_frames`] reads it again.
pub fn shown_frames(range: &Range<u32>) -> String {
    let end = if range.end == u32::MAX { String::new() } else { range.end.to_string() };
    format!("{}..{end}", range.start)
}

/// Parses `N` finite numbers separated by commas; `named` lists their names for the error.
pub fn numbers<const N: usize>(text: &str, named: &str) -> std::result::Result<[f64; N], String> {
    let parse = |part: &str| part.trim().parse().ok().filter(|x: &f64| x.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
    let numbers =
        numbers.ok_or_else(|| format!("expected numbers separated by commas, {named}, found {text}"))?;
    let count = numbers.len();
    numbers.try_into().map_err(|_| format!("expected {N} numbers, {named}, found {count}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_end_of_a_range_of_frames_may_be_left_out() {
        for (text, range) in [("3..7", 3..7), ("3..", 3..u32::MAX), ("..7", 0..7), ("..", 0..u32::MAX)] {
            assert_eq!(parse_frames(&shown_frames(&range)), Ok(range.clone()));
            assert_eq!(parse_frames(text), Ok(range));
        }
        for bad in ["", "3", "7..3", "3..3", "a..b", "-1..3", "1..2..3"] {
            assert!(parse_frames(bad).unwrap_err().contains(&format!("found {bad}")), "{bad}");
        }
    }

    #[test]
    fn a_range_of_seconds_begins_at_0_or_later_and_before_it_ends() {
        assert_eq!(parse_times("3..4.5"), Ok(3.0..4.5));
        assert_eq!(parse_times("3.."), Ok(3.0..f64::INFINITY));
        assert_eq!(parse_times("..2"), Ok(0.0..2.0));
        for nonsense in ["", "3", "4..3", "3..3", "-1..2", "NaN..2", "1..NaN", "inf..", "a..b", "1..2..3"] {
            let error = parse_times(nonsense).unwrap_err();
            assert!(error.contains("as in 3..4.5") && error.ends_with(nonsense), "{error}");
        }
    }
}
