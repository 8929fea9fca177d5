//! Numbers that decide: each is a judgement, tuned or checked on known answers, with what goes
//! wrong without it. Everything else in this crate follows from theory.

use std::f64::consts::FRAC_1_SQRT_2;

// Bias.

/// Largest part of the accuracy for the bound on the bias, which falls by eight or more from a
/// level to the next. Near one, no room is left for sampling; near zero, levels are added in vain.
pub const BIAS_SHARE: f64 = 1.0 / 3.0;
/// Largest part of the statistical half-width for the bound on the bias. With more, errors are
/// smaller than the interval says; with less, most work is on fine levels.
pub const BIAS_PART: f64 = 0.5;
/// Part of the accuracy below which a bound on the bias is small enough in any case. Without it
/// levels are added for ever where φ hardly varies: half of the statistical half-width is round-off
/// there.
pub const BIAS_ENOUGH: f64 = 1.0 / 64.0;
/// Largest distance of samples of φ, over φ, that are the same but for rounding errors, which large
/// increments and terms that cancel make larger than those of single operations.
pub const ROUNDED: f64 = 1e-9;
/// Part of the accuracy for which that is asked. Without it, and without rounding errors, samples
/// of a constant look like rare events.
pub const NEGLIGIBLE: f64 = 1e-3;
/// Part of the accuracy for the bias on the finest level allowed, above which more points are of no
/// use. Without it points are doubled up to the limit although the bias alone misses the accuracy.
pub const MAX_BIAS: f64 = 0.5;
/// Largest amount by which an observed order may be below the one given. With large steps it is by
/// a tenth or so, and the bound allows for it; with more, orders that are wrong are extrapolated.
pub const ORDER_TOLERANCE: f64 = 0.25;
/// Least order of extrapolation, unless half of the order given is less. A lower one multiplies the
/// last difference, and its error, by more than 2.4.
pub const LOWEST_ORDER: f64 = 0.5;
/// Order of the variances of differences below which φ is rough. They fall by two for a smooth φ on
/// steps that resolve the motion, by 3/2 for one with kinks, by one for one with jumps (Giles
/// 2015). Without it means of a rough φ that pass through zero bound the bias.
pub const SMOOTH: f64 = 1.25;
/// Distance from a whole number within which a slope without noise is that order. With less, no
/// order is found; with more, orders that are none remove the wrong power.
pub const WHOLE: f64 = 0.2;
/// Number of standard errors from which on the logarithm of a difference is nearly normal. With
/// fewer, orders are fitted to noise.
pub const SIGNIFICANT: f64 = 4.0;
/// Largest number of standard errors between two means of one expectation: exceeded once in 10⁵
/// comparisons of normals. With fewer, right answers are refused.
pub const DEVIATION_LIMIT: f64 = 4.5;

// Sampling.

/// Upper limit u at 97.5 % of the expected number of events where N samples show none, −ln 0.025.
/// With k events the interval k ± √(1.96²k + u²) covers a Poisson number with 93 % or more for any
/// mean, and events of several levels with more. With thirty events k ± 1.96√k covers as well
/// without u.
pub const UNSEEN: f64 = 3.688_879_454_113_936;
/// The confidence for random points: with 95 %, 3.7 % of known answers were missed; with this 1.4
/// %, also with seeds that the choice did not see, for 7 % more work.
pub const OF_RANDOM_POINTS: f64 = 0.98;
/// The part of the variance from which on the largest and the least value of a replicate decide.
/// Without it a few large values make an interval that looks narrow.
pub const FEW_DECIDE: f64 = 0.5;
/// Confidence of Student's quantile where the largest and the least value decide.
pub const HIGH_CONFIDENCE: f64 = 0.99;
/// Number of samples of the first level beyond which more do not show a variance not shown so far.
/// Without it a φ with a heavy tail takes all path-steps that are allowed.
pub const MAX_SAMPLES: u64 = 1 << 24;
/// Least exponent with which points grow with the inverse error: the error of scrambled points
/// falls as N^{−3/2} at most (Owen 1997). With more, what is within reach is given up.
pub const MIN_GROWTH: f64 = 2.0 / 3.0;
/// Root of the part of the path-steps below which single paths are taken in place of levels.
pub const SINGLE: f64 = 0.5;
/// Least part of the variance of φ that φ(fine) − φ(coarse) has on the last level where single
/// paths are taken: paths that levels couple no more. Without it differences are known well, and
/// single paths hide a bias.
pub const UNCOUPLED: f64 = 0.25;

// Failed paths.

/// Part of the accuracy that failed paths may have: with more, steps are halved.
pub const LOST: f64 = 0.25;
/// Part of the accuracy that failed paths may have where halving does not help.
pub const MAX_LOST: f64 = 0.5;
/// Factor to which the share of failed paths must fall over the first levels for halving to help.
/// Without it steps are halved at a singular point, where paths fail at any step size.
pub const FEWER: f64 = 0.5;

// Resolution.

/// The largest quotient that counts as resolved, on the last level: a rotation differs by half a
/// radian to one, and the fine path is wrong by a third of that (phases have order two). The same
/// number for φ: the correlation of φ(fine) and φ(coarse) is then ¾ or more. Near √(2/3), phases
/// that are not correlated pass.
pub const RESOLVED: f64 = 0.5;
/// Largest factor by which quotients fall from a level to the next: strong order ½ gives 1/√2. With
/// one, a fast motion that looks slow passes.
pub const GAIN: f64 = FRAC_1_SQRT_2;
/// Largest factor from level to level, twice, of a motion that is an error of the scheme: a true
/// one has a limit. Without it components that the equation conserves are never resolved.
pub const VANISHES: f64 = 0.75;
/// Largest part of the largest component that a motion by errors of the scheme has.
pub const ERROR: f64 = 0.1;
/// Largest square of the mean of a difference over its variance that is scatter. With more, one
/// phase error of all paths passes for scatter.
pub const SCATTERED: f64 = 0.25;
/// Least size of the motion in a first part of the time, relative to that in all. With less, a
/// beginning at rest resolves any motion.
pub const BEGUN: f64 = 0.1;
/// Least number of coarse steps in a first part of the time.
pub const MIN_TIMES: f64 = 8.0;
/// The largest ∫|γ| over a step that is resolved: noise of a step that enters in its middle has the
/// variance x/sinh x of the true one, x = γτ, which has an expansion in τ where x is below one.
/// With more, step sizes agree that all forget noise and forces.
pub const LARGEST_EXPONENT: f64 = 1.0;
/// The largest angle by which the fastest motion turns in a step of the last level, and by two and
/// four times as much on the levels below. With π, squares of a rotation look constant at all
/// steps, and noise that enters once in a turn adds up.
pub const LARGEST_TURN: f64 = 1.0;
/// The part of the accuracy that an error of ∫γ may have, beside φ. Without it dampings are refused
/// for errors that no answer shows.
pub const DAMPED: f64 = 0.01;
