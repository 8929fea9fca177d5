//! Errors of studies.

use crate::LadderError;

/// An invalid study, detected before the first step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A number is out of range.
    #[error("the {name} must be {allowed}, got {value}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// The values allowed.
        allowed: &'static str,
        /// The value given.
        value: f64,
    },
    /// There is no observable.
    #[error("a study needs at least one observable, got none")]
    NoObservable,
    /// Two observables have the same name.
    #[error("two observables have the name {name:?}; rename one")]
    Observable {
        /// The name.
        name: String,
    },
    /// There is no time.
    #[error("a study needs at least one time after t = 0, got none")]
    NoTime,
    /// The steps cannot be divided into so many equal parts.
    #[error(
        "{steps} steps cannot be divided into {times} equal parts; the nearest possible number is \
         {nearest}, or list the steps"
    )]
    EvenTimes {
        /// The number of times given.
        times: u64,
        /// The number of steps.
        steps: u64,
        /// The nearest number of times that is possible.
        nearest: u64,
    },
    /// A time is not the end of a step.
    #[error(
        "a time must be the number of a step from 1 to {steps}, got {step}; t = 0 is always in the \
         result"
    )]
    Time {
        /// The number given.
        step: u64,
        /// The number of steps.
        steps: u64,
    },
    /// The times are not in increasing order.
    #[error("the times must increase, got step {step} after step {before}")]
    TimeOrder {
        /// A time.
        step: u64,
        /// The one before.
        before: u64,
    },
    /// A quantile is asked for twice.
    #[error("the quantile of level {level} is asked for twice")]
    QuantileTwice {
        /// The level.
        level: f64,
    },
    /// The scheme cannot be run on these steps.
    #[error(transparent)]
    Ladder(#[from] LadderError),
}
