//! Whether an identity holds at all points of an inspection.

use serde::Serialize;

/// Threshold of a relative defect: an identity holds if no defect is larger. The user's formula may
/// lose 2¹² roundings; a mistake is larger by ten orders of magnitude, unless it is in the twelfth
/// digit of a constant.
pub const ROUND_OFF: f64 = 4096.0 * f64::EPSILON;

/// Whether an identity holds to round-off, and its largest defect.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// Whether it holds at every point of the inspection.
    pub holds: bool,
    /// The largest defect, relative to the largest term of the identity at that point.
    pub defect: f64,
    /// The point of the largest defect.
    pub at: Vec<f64>,
}

/// Holds, since no point has been checked yet.
impl Default for Finding {
    fn default() -> Self {
        Self { holds: true, defect: 0.0, at: Vec::new() }
    }
}

impl Finding {
    /// Records a defect of an identity with terms of size `scale` at the point y. NaN counts as
    /// infinite.
    pub(super) fn record(&mut self, defect: f64, scale: f64, y: &[f64]) {
        let relative = if defect == 0.0 { 0.0 } else { defect.abs() / scale };
        let relative = if relative.is_nan() { f64::INFINITY } else { relative };
        if self.at.is_empty() || relative > self.defect {
            self.at = y.to_vec();
            self.defect = relative;
        }
        self.holds = self.defect <= ROUND_OFF;
    }

    /// Records the difference of two vectors, component by component.
    pub(super) fn compare(&mut self, given: &[f64], expected: &[f64], scale: f64, y: &[f64]) {
        for (a, b) in given.iter().zip(expected) {
            self.record(a - b, scale, y);
        }
    }
}
