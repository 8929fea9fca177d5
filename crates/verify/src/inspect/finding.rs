//! Whether an identity holds at all points that were looked at.

use serde::Serialize;

/// An identity holds when no defect is larger, relative to the largest term of which it is made:
/// 2¹² roundings, each good to ε, one after the other in the user's formula. A mistake is larger by
/// ten orders of magnitude, unless it is in the twelfth digit of a constant.
pub(super) const ROUND_OFF: f64 = 4096.0 * f64::EPSILON;

/// Whether an identity holds to round-off, and how badly it fails.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Whether it holds at every point that was looked at.
    pub holds: bool,
    /// The largest defect, relative to the largest term of the identity at that point.
    pub defect: f64,
    /// The point of the largest defect.
    pub at: Vec<f64>,
}

impl Finding {
    /// Nothing seen yet.
    pub(super) fn new() -> Self {
        Self { holds: true, defect: 0.0, at: Vec::new() }
    }

    /// Looks at a defect between terms of size `scale` at the point y. NaN is the largest of all.
    pub(super) fn see(&mut self, defect: f64, scale: f64, y: &[f64]) {
        let relative = if defect == 0.0 { 0.0 } else { defect.abs() / scale };
        let relative = if relative.is_nan() { f64::INFINITY } else { relative };
        if self.at.is_empty() || relative > self.defect {
            self.at = y.to_vec();
            self.defect = relative;
        }
        self.holds = self.defect <= ROUND_OFF;
    }
}
