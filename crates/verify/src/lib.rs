//! **Whether a system and a scheme do what is claimed of them, by measurements that can fail.**
//!
//! [`inspect()`] says what a system is; [`strong_order`] and [`weak_order`] measure the order of a
//! scheme with an interval; [`order_verdict`] says whether an order holds, is refuted or undecided.
//! [`results::Results`] is what a run of many such measurements says, as data.
//!
//! | item | job |
//! |---|---|
//! | [`strong_order`], [`strong_order_against`], [`weak_order`] | the order of any scheme |
//! | [`strong_order_within`], [`weak_order_within`] | the same within a budget |
//! | [`strong_order_of`], [`weak_order_of`], [`DynReference`] | of systems known at run time |
//! | [`strong_order_of_within`], [`weak_order_of_within`] | these within a budget |
//! | [`local_weak_order()`], [`local_weak_order_of`] | weak orders of one step, without sampling |
//! | [`Order`], [`Decision`], [`OneStep`], [`Limit`], [`wrong_limit`] | an order, its reasons |
//! | [`StepSizes`], [`ReferenceSolution`] | how it is measured, and against what |
//! | [`exact_mean`], [`Exact`] | exact solutions on sampled paths |
//! | [`inspect()`], [`inspect_problem`] | what a system is, and which statements apply |
//! | [`order_verdict`], [`bound_verdict`] | when an order is said to hold |
//! | [`compare()`], [`Candidates`], [`CompareSettings`] | which scheme is cheapest for an error |
//! | [`compare_of`], [`DynCandidates`], [`DynCompareSettings`] | of systems known at run time |
//! | [`OtherNoise`] | a scheme on other noise than the driver's |
//! | [`FinalMoments`], [`Stopwatch`], [`Spread`], [`number()`] | moments of final states; times; digits |
//! | [`results::Evidence`], [`results::Claim`] | a measurement as data, its verdict in words |
//! | [`exact`], [`runge_kutta`], [`rigid_body_expectations`] | references |
//! | [`step_check()`], [`StepCheck`], [`StepError`] | whether the steps of a run are short enough |
//! | [`Settings`], [`Mode`], [`Progress`], [`Silent`] | how much to compute; progress |
//! | [`results`] | the `results.json` contract |

pub mod compare;
mod evidence;
pub mod exact;
mod final_moments;
pub mod inspect;
mod local_weak_order;
mod number;
mod orders;
mod other_noise;
pub mod results;
pub mod runge_kutta;
mod settings;
mod sphere;
mod step_check;
mod stopwatch;
mod verdict;

pub use compare::{
    Candidates, CompareSettings, Comparison, DynCandidates, DynCompareSettings, compare, compare_of,
};
pub use evidence::{DEVIATIONS, worse};
pub use final_moments::{FinalMoments, FinalRows, FinalValues};
pub use inspect::{
    inspect, inspect_formula_problem, inspect_formulas, inspect_large, inspect_problem,
};
pub use local_weak_order::{
    LocalError, LocalWeakOrder, LocalWeakOrderError, local_weak_order, local_weak_order_of,
};
pub use number::number;
pub use orders::{
    Decision, DynExact, DynReference, Exact, Limit, OneStep, Order, ReferenceSolution, StepSizes,
    exact_mean, strong_order, strong_order_against, strong_order_of, strong_order_of_within,
    strong_order_within, weak_order, weak_order_of, weak_order_of_within, weak_order_within,
    wrong_limit,
};
pub use other_noise::OtherNoise;
pub use settings::{Mode, Progress, Settings, Silent};
pub use sphere::rigid_body_expectations;
pub use step_check::{
    Halved, STIFF, StepCheck, StepError, StepErrors, TURN, checked_paths, step_check,
};
pub use stopwatch::{Spread, Stopwatch};
pub use verdict::{ORDER_MARGIN, Verdict, bound_verdict, order_verdict};
