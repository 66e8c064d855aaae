//! The times of images.

use crate::{Error, Result};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The times of a source's images, by their numbers.
#[derive(Debug, Clone, PartialEq)]
pub enum Times {
    /// Images per second; image 0 is at 0 s.
    Rate(f64),
    /// Seconds, by image number.
    Listed(Arc<BTreeMap<u32, f64>>),
}

impl Times {
    /// # Errors
    /// A rate that is not positive.
    pub(crate) fn check(&self) -> Result<()> {
        match self {
            Self::Rate(rate) if !(rate.is_finite() && *rate > 0.0) => {
                Err(Error::argument(format!("expected a positive number of images per second, found {rate}")))
            }
            _ => Ok(()),
        }
    }

    /// The time of image `number` in seconds; an error text if none is listed.
    pub(crate) fn of(&self, number: u32) -> std::result::Result<f64, String> {
        match self {
            Self::Rate(rate) => Ok(f64::from(number) / rate),
            Self::Listed(listed) => listed.get(&number).copied().ok_or_else(|| {
                let extent = match (listed.first_key_value(), listed.last_key_value()) {
                    (Some((first, _)), Some((last, _))) => {
                        format!("{} times for frames {first} to {last}", listed.len())
                    }
                    _ => "no times".into(),
                };

                format!(
                    "frame {number}: expected its time in {}, found {extent}; add it",
                    super::frames_csv::NAME
                )
            }),
        }
    }

    /// The seconds from one image to the next; the median for listed times.
    pub(crate) fn period(&self) -> Option<f64> {
        match self {
            Self::Rate(rate) => Some(1.0 / rate),
            Self::Listed(listed) => {
                let times: Vec<f64> = listed.values().copied().collect();

                let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
                steps.sort_by(f64::total_cmp);
                steps.get(steps.len() / 2).copied()
            }
        }
    }
}
