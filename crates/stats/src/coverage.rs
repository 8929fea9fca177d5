//! How often an interval covers the truth, and how often it should.

use crate::{
    point::Point,
    quantile::{CONFIDENCE, two_sided},
    rate::Rate,
};

/// How often one kind of interval covered the truth, or one kind of warning was raised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// The data.
    pub case: &'static str,
    /// The interval, with what it is an interval for; or the warning.
    pub interval: &'static str,
    /// Data sets whose interval contains the truth, or that are warned about; one without an
    /// interval does not count.
    pub covered: u64,
    /// Data sets.
    pub replications: u64,
    /// What is required of it.
    pub expected: Expected,
}

/// What is required of an interval or of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// The interval covers as often as it says.
    Calibrated,
    /// The interval covers at least as often as it says: it leaves open which model is right.
    Covers,
    /// The interval must not cover as often as it says: it ignores something.
    Miscovers,
    /// The warning is raised on nearly every data set.
    Raised,
    /// The warning is raised on nearly none.
    Silent,
    /// Nothing: the figure is stated for comparison. Either the interval is not in use, or what
    /// spoils it is absent from most data sets, so that neither an interval nor a warning can know
    /// of it.
    Stated,
}

impl Expected {
    /// The nominal share: 0.95 of an interval, 1 or 0 of a warning.
    pub fn nominal(self) -> f64 {
        match self {
            Self::Raised => 1.0,
            Self::Silent => 0.0,
            Self::Calibrated | Self::Covers | Self::Miscovers | Self::Stated => CONFIDENCE,
        }
    }
}

impl Coverage {
    /// Share of the data sets that are covered, or warned about. With R data sets a true share of
    /// 0.95 has the standard error √(0.95·0.05/R): 0.49 % for 2000.
    pub fn share(&self) -> f64 {
        self.covered as f64 / self.replications as f64
    }
}

/// Whether `value` ± 1.96 `se` contains the truth.
pub fn normal_covers(value: f64, se: f64, truth: f64) -> bool {
    (value - truth).abs() <= two_sided(CONFIDENCE, None) * se
}

impl Rate {
    /// Whether the interval contains the order.
    pub fn covers(&self, order: f64) -> bool {
        self.lo <= order && order <= self.hi
    }

    /// Whether there is a bootstrap interval and it contains the order.
    pub fn bootstrap_covers(&self, order: f64) -> bool {
        self.bootstrap_lo.is_some_and(|lo| lo <= order)
            && self.bootstrap_hi.is_some_and(|hi| order <= hi)
    }
}

impl Point {
    /// Whether the interval of a measured error contains the true one: [`lo`, `hi`] where there is
    /// one, else `value` ± 1.96 `se`.
    pub fn covers(&self, truth: f64) -> bool {
        match *self {
            Self::Error { lo: Some(lo), hi: Some(hi), .. } => lo <= truth && truth <= hi,
            _ => self.normal_covers(truth),
        }
    }

    /// Whether `value` ± 1.96 `se` of a measured error contains the true one.
    pub fn normal_covers(&self, truth: f64) -> bool {
        matches!(*self, Self::Error { value, se, .. } if normal_covers(value, se, truth))
    }

    /// Whether there is a warning at the point.
    pub fn warns(&self) -> bool {
        matches!(self, Self::Error { warning: Some(_), .. })
    }
}
