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

#[cfg(test)]
mod tests {
    use super::*;

    fn coverage(covered: u64, expected: Expected) -> Coverage {
        Coverage { case: "case", interval: "interval", covered, replications: 200, expected }
    }

    #[test]
    fn a_share_is_of_all() {
        assert_eq!(coverage(190, Expected::Calibrated).share(), 0.95);
    }

    #[test]
    fn intervals_contain_their_ends_and_nothing_beyond() {
        let rate = Rate { lo: 0.5, hi: 1.0, ..Rate::default() };
        let covered = [0.4, 0.5, 0.7, 1.0, 1.1].map(|order| rate.covers(order));
        assert_eq!(covered, [false, true, true, true, false]);
        let ends = |lo, hi| Rate { bootstrap_lo: lo, bootstrap_hi: hi, ..rate.clone() };
        let both = ends(Some(0.6), Some(0.9));
        let covered = [0.55, 0.6, 0.7, 0.9, 0.95].map(|order| both.bootstrap_covers(order));
        assert_eq!(covered, [false, true, true, true, false]);
        assert!(!ends(None, Some(0.9)).bootstrap_covers(0.7));
        assert!(!ends(Some(0.6), None).bootstrap_covers(0.7));
    }

    #[test]
    fn a_point_covers_by_its_interval_or_by_its_standard_error() {
        let normal = Point::normal(0.1, 2.0, 0.5);
        // 2 ± 0.98.
        for (truth, covered) in [(1.0, false), (1.03, true), (2.97, true), (3.0, false)] {
            assert_eq!((normal.covers(truth), normal.normal_covers(truth)), (covered, covered));
        }
        let skewed = Point::Error {
            tau: 0.1,
            value: 2.0,
            se: 0.5,
            lo: Some(1.5),
            hi: Some(4.0),
            warning: Some("few".into()),
        };
        for (truth, covered) in [(1.4, false), (1.5, true), (3.0, true), (4.0, true), (4.1, false)]
        {
            assert_eq!(skewed.covers(truth), covered, "{truth}");
        }
        assert!(skewed.normal_covers(1.4) && !skewed.normal_covers(4.0));
        assert!(skewed.warns() && !normal.warns());
        let other = Point::Cost { accuracy: 2.0, path_steps: 2 };
        assert!(!other.covers(2.0) && !other.normal_covers(2.0) && !other.warns());
    }
}
