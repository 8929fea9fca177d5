//! Whether an interval covers the truth.

use crate::{
    point::Point,
    quantile::{CONFIDENCE, two_sided},
    rate::Rate,
};

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
