//! Parameters of the paper's problems (paper, §5).

use crate::{Cosine, SystemError};

/// Moments of inertia of the body, (2, 1, 2/3).
pub const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];
/// Moments of inertia of the noises, (1, 2, 3).
pub const NOISE_INERTIA: [f64; 3] = [1.0, 2.0, 3.0];

/// Initial value of the rigid body, (cos 1.1, 0, sin 1.1).
#[must_use]
pub fn rigid_body_start() -> [f64; 3] {
    [real::elementary::cos(1.1), 0.0, real::elementary::sin(1.1)]
}

/// Initial value of the Lotka–Volterra system, (0.2, 0.4, 0.6).
pub const LOTKA_VOLTERRA_START: [f64; 3] = [0.2, 0.4, 0.6];

/// The paper's parameters are valid, so a constructor that refuses one is a bug here.
pub fn valid<T>(constructed: Result<T, SystemError>) -> T {
    constructed.unwrap_or_else(|error| unreachable!("the set-ups of the paper are valid: {error}"))
}

/// ½ cos 2t.
#[must_use]
pub fn half_cosine() -> Cosine {
    valid(Cosine::new(0.5, 2.0))
}
