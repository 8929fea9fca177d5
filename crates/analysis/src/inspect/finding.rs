//! Whether an identity holds, and how that is known.

use real::{Bounded, Degree};
use serde::Serialize;

/// How a statement about a system is known, from the worst to the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// It is false: there is a counterexample beyond round-off.
    Refuted,
    /// It cannot be told: round-off is too large, or a value is not finite.
    Unknown,
    /// It held to round-off at every point that was probed.
    Found,
    /// It holds to round-off. An identity between polynomials of lower degree than there are random
    /// points is false with probability zero if it holds at them; eigenvalues are off by less than
    /// their error bound.
    Shown,
}

impl Status {
    /// Shown or found.
    #[must_use]
    pub fn holds(self) -> bool {
        self >= Self::Found
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Refuted => "refuted",
            Self::Unknown => "cannot tell",
            Self::Found => "found by search",
            Self::Shown => "shown",
        }
    }
}

/// Whether an identity holds, and its largest defect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// How it is known.
    pub status: Status,
    /// The largest defect, of those beyond round-off if there are any; not relative to anything.
    pub defect: f64,
    /// The bound of the rounding error of this defect; of an identity that holds the largest one,
    /// which is the accuracy to which it holds.
    pub round_off: f64,
    /// The point of the defect; for a damping, the time.
    pub at: Vec<f64>,
    /// The largest term of the identity.
    pub scale: f64,
    /// The number of points.
    pub points: usize,
    /// Whether a defect is beyond its round-off.
    #[serde(skip)]
    beyond: bool,
    #[serde(skip)]
    last: Vec<f64>,
    #[serde(skip)]
    degree: Degree,
}

/// Shown, since nothing has been compared yet.
impl Default for Finding {
    fn default() -> Self {
        Self {
            status: Status::Shown,
            defect: 0.0,
            round_off: 0.0,
            at: Vec::new(),
            scale: 0.0,
            points: 0,
            beyond: false,
            last: Vec::new(),
            degree: Degree::CONSTANT,
        }
    }
}

/// Round-off above this part of the largest term leaves an identity undecided.
const COARSE: f64 = 1e-11;
/// So does a defect below this part of the largest term: a constant beside it may be rounded, as is
/// cos(π/2) = 6e-17.
const FAINT: f64 = 2.0 * f64::EPSILON;

impl Finding {
    /// Records a defect of an identity with terms of size `scale` at the point y.
    pub(super) fn record(&mut self, defect: Bounded, scale: f64, y: &[f64]) {
        let Bounded { value, error, degree } = defect;
        if self.points == 0 || self.last != y {
            self.points += 1;
            self.last = y.to_vec();
        }
        self.degree = self.degree.max(degree);
        if !(value.is_finite() && error.is_finite()) {
            if !self.beyond {
                (self.defect, self.round_off) = (value, f64::INFINITY);
                self.at = y.to_vec();
            }
        } else if value.abs() > error {
            if !self.beyond || value.abs() > self.defect {
                (self.defect, self.round_off) = (value.abs(), error);
                self.at = y.to_vec();
            }
            self.beyond = true;
        } else if !self.beyond {
            if self.at.is_empty() || value.abs() > self.defect {
                self.defect = value.abs();
                self.at = y.to_vec();
            }
            self.round_off = self.round_off.max(error);
        }
        // False for NaN, which leaves the scale.
        if scale > self.scale {
            self.scale = scale;
        }
        self.status = if self.beyond && self.defect > FAINT * self.scale {
            Status::Refuted
        } else if self.beyond {
            self.round_off = FAINT * self.scale;
            Status::Unknown
        } else if self.round_off > COARSE * self.scale && self.round_off > 0.0 {
            Status::Unknown
        } else if self.degree < Degree::of(self.points as u32) {
            Status::Shown
        } else {
            Status::Found
        };
    }

    /// Records the difference of two vectors, component by component.
    pub(super) fn compare(&mut self, given: &[Bounded], expected: &[Bounded], y: &[f64]) {
        for (&a, &b) in given.iter().zip(expected) {
            self.record(a - b, a.value.abs() + b.value.abs(), y);
        }
    }

    /// Whether it holds at every point, shown or found.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.status.holds()
    }

    /// Whether it is false.
    #[must_use]
    pub fn refuted(&self) -> bool {
        self.status == Status::Refuted
    }
}
