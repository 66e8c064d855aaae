//! One measured number and its bound.

use std::fmt;

/// A measured number.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Name in lower case with underscores, with the unit last.
    pub name: String,
    /// Value in the unit that the name ends with.
    pub value: f64,
    /// Bound of the value; `None` for a figure that is only reported.
    pub bound: Option<Bound>,
}

/// The allowed range of a value.
#[derive(Debug, Clone, Copy)]
pub enum Bound {
    /// Up to and including the value.
    AtMost(f64),
    /// At or above the value.
    AtLeast(f64),
    /// From the first to the second value, both included.
    Between(f64, f64),
}

impl Figure {
    /// A figure whose value has to be within `bound`.
    pub fn bounded(name: &str, value: f64, bound: Bound) -> Self {
        Self { name: name.into(), value, bound: Some(bound) }
    }

    /// A figure without a bound.
    pub fn reported(name: &str, value: f64) -> Self {
        Self { name: name.into(), value, bound: None }
    }

    /// Whether the value is within the bound, if there is one. NaN is within none.
    pub fn holds(&self) -> bool {
        match self.bound {
            None => true,
            Some(Bound::AtMost(most)) => self.value <= most,
            Some(Bound::AtLeast(least)) => self.value >= least,
            Some(Bound::Between(least, most)) => (least..=most).contains(&self.value),
        }
    }
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::AtMost(most) => write!(f, "<= {most}"),
            Self::AtLeast(least) => write!(f, ">= {least}"),
            Self::Between(least, most) => write!(f, "{least} to {most}"),
        }
    }
}
