//! One measured number and what is asked of it.

use std::fmt;

/// A measured number.
#[derive(Debug, Clone)]
pub struct Figure {
    /// Lower case, words joined by underscores, the unit last.
    pub name: String,
    pub value: f64,
    /// `None`: reported whatever it is.
    pub bound: Option<Bound>,
}

/// What is asked of a number.
#[derive(Debug, Clone, Copy)]
#[allow(dead_code, reason = "which bounds are used is up to the groups")]
pub enum Bound {
    AtMost(f64),
    AtLeast(f64),
    Between(f64, f64),
}

impl Figure {
    pub fn bounded(name: &str, value: f64, bound: Bound) -> Self {
        Self { name: name.into(), value, bound: Some(bound) }
    }

    pub fn reported(name: &str, value: f64) -> Self {
        Self { name: name.into(), value, bound: None }
    }

    /// Whether the bound, if any, holds; NaN keeps none.
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
