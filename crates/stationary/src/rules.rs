//! Numbers that decide: each is a judgement, tuned or checked on known answers, with what goes
//! wrong without it. Everything else in this crate follows from theory.

// Where chains begin, and what is left out.

/// Factors of the noise of every four chains at first. With ones only, all chains begin in the well
/// of the initial value, and averages over others are missed.
pub const HEAT: [f64; 4] = [1.0, 2.0, 3.0, 4.0];
/// Number of standard errors by which early batches differ from late ones: chance does it once in
/// 2000. With more, the drift of the beginning is in averages; with less, chains look as if they
/// drift.
pub const DRIFTS: f64 = 3.5;
/// Largest variance over the chains of a batch after the burn-in, over that of late ones. Without
/// it chains that begin far apart around the right mean count from the beginning.
pub const WIDER: f64 = 3.0;
/// Half-widths by which the motion that all chains share exceeds that of an average. Without it an
/// orbit that noise does not reach has the average of its last turn with no error.
pub const SHARED: f64 = 10.0;
/// Number of deviations from the mean that a histogram reaches.
pub const REACH: f64 = 6.0;

// Steps.

/// The part of the sampling error that a bias may have. With more, errors are smaller than the
/// interval says.
pub const BIAS_PART: f64 = 0.5;
/// The part of the accuracy of a bias that is small. Without it steps are halved for ever where the
/// sampling error vanishes.
pub const BIAS_ENOUGH: f64 = 1.0 / 32.0;
/// Standard errors by which differences of step sizes exceed what they should be, or zero. With
/// fewer, steps are halved for noise.
pub const EXCEEDS: f64 = 3.0;
/// Least part of 2ᵖ by which differences fall: the next power of τ makes it less. Without it steps
/// that are too long are extrapolated.
pub const MIN_FALL: f64 = 0.85;
/// Largest number of halvings where all chains fail, or where more than half of the failures
/// remain. Without it steps are halved at a singular point, where chains fail at any step size.
pub const MAX_REVIVALS: u32 = 3;

/// Part of the moves by H₀ that are rejected, and of those by noises, for which the exact sampler
/// chooses its step. With fewer, steps are short; with more, chains turn round or stand still.
pub const REJECTED: f64 = 0.04;
pub const BY_NOISE: f64 = 0.4;

// Whether chains are long enough.

/// Least length of a chain in autocorrelation times. Shorter ones may have seen one side of a slow
/// motion only, so that their spread is too small.
pub const MIN_LENGTH: f64 = 20.0;
/// Largest variance of the exponent of a chain over that of independent batches: the same for
/// exponents.
pub const ALIKE: f64 = 3.0;
/// Part of the accuracy of an exponent below which a change does not count: differences that carry
/// tangent vectors round. Without it exponents of linear systems drift for ever.
pub const NEGLIGIBLE: f64 = 1e-3;
/// Part of the path-steps allowed after which a forecast may end the computation, and factor by
/// which it exceeds those allowed. Without them what is out of reach takes all path-steps, or what
/// is within reach is given up.
pub const FORECAST: f64 = 1.0 / 64.0;
pub const MARGIN: f64 = 2.0;
/// Least length of a chain for exponents, over that in which directions whose exponents differ by
/// the accuracy part by a factor e. Shorter ones average over directions.
pub const APART: f64 = 3.0;

// Wells.

/// z of a function that keeps its wells. With less, chance finds wells in 61 components.
pub const KEEPS: f64 = 4.0;
/// z² of an average that depends on those of one function.
pub const DEPENDS: f64 = 9.0;
/// Part of a deviation up to which a change is none: functions that are conserved are parameters.
pub const CONSERVED: f64 = 1e-6;

// Growth.

/// Standard errors by which λ and k are seen.
pub const SEEN: f64 = 2.0;
/// Standard errors by which growth is bent.
pub const BENT: f64 = 3.0;
/// The largest power of t that explains an exponent: a shear has one, and less symmetric systems
/// seldom more than 3. With more, small exponents that are true have 0 in their intervals.
pub const MAX_POWER: f64 = 3.0;
