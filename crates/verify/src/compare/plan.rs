//! What is known of schemes, which step sizes they get, and what their errors still lack.

use super::{
    Series, StrongPoint, WeakPoint,
    pilot::{Pilot, steps_beyond},
};

/// Halvings of the step size that a round may add.
pub const HALVINGS: u32 = 4;

/// What is known of a scheme before errors are measured.
pub struct Known {
    /// Its pilot.
    pub pilot: Pilot,
    /// How far single steps miss the coefficients, if they do.
    pub inconsistent: Option<f64>,
}

impl Known {
    /// Whether the scheme may be recommended.
    pub fn sound(&self) -> bool {
        self.pilot.failure.is_none() && self.inconsistent.is_none()
    }
}

/// The finest step sizes of the schemes and that of the reference.
#[derive(Clone, PartialEq)]
pub struct Plan {
    /// Of each scheme.
    pub last: Vec<u32>,
    /// Of the reference.
    pub reference: u32,
}

impl Plan {
    /// The finest of all.
    pub fn finest(&self) -> u32 {
        self.last.iter().copied().fold(self.reference, u32::max)
    }
}

/// The longest of the coarsest step sizes that all schemes have.
pub fn common(known: &[Known]) -> u32 {
    let running = known.iter().filter(|known| known.pilot.failure.is_none());
    running.map(|known| known.pilot.first).max().unwrap_or(0)
}

/// Whether an error is resolved and its whole interval at most the wanted one.
pub fn below(point: &StrongPoint, wanted: f64) -> bool {
    point.resolved && point.hi.unwrap_or(point.error) <= wanted
}

/// What a scheme lacks of a resolved error below the wanted one.
pub enum Lacks {
    /// Nothing.
    Nothing,
    /// A finer reference.
    Reference,
    /// So many halvings of the step size.
    Halvings(u32),
}

/// What the errors of a scheme lack.
pub fn lacks(series: &Series<StrongPoint>, wanted: f64) -> Lacks {
    let Some(last) = series.points.last() else { return Lacks::Nothing };
    if series.points.iter().any(|point| below(point, wanted)) {
        return Lacks::Nothing;
    }
    if !last.resolved {
        return Lacks::Reference;
    }
    let p = match &series.points[..] {
        [.., before, last] => (before.error / last.error).log2().clamp(0.5, 1.0),
        _ => 1.0,
    };
    Lacks::Halvings(steps_beyond(last.error, wanted, p).clamp(1, HALVINGS))
}

/// Whether an expectation of this accuracy is not much dearer for the bias of the point.
pub fn good(point: &WeakPoint, accuracy: f64) -> bool {
    point.hi <= std::f64::consts::FRAC_1_SQRT_2 * accuracy
}
