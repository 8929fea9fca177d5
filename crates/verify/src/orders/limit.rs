//! Whether a scheme converges to the right limit.
//!
//! [`consistency`] sees it in single steps. Paths on the same noise are compared, too: they say how
//! far a wrong limit is, and where they differ although single steps agree, the step sizes do not
//! show how the scheme converges. With an exact solution paths alone decide.

use mc::{LadderError, Run, View};
use schemes::{Heun, Midpoint, Scheme};
use stats::CrossMoments;
use systems::{Damping, PoissonSystem, Problem};

use super::{
    Exact, Measure, ReferenceSolution, StepSizes,
    consistency::{Consistency, consistency},
    runs::measure,
    visits::Visit,
};
use crate::work_precision::squared_distance;

/// Whether a scheme converges to the solution, the limit of another scheme, or the exact solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// One step has the drift and the noise of the equation as τ → 0.
    Consistent {
        /// The largest error that single steps may have, as a part of |y| per unit of time or root
        /// of it.
        defect: f64,
    },
    /// The distance of the limits is at most this, which is small beside the errors measured.
    Agrees {
        /// The other scheme, or `exact solution`.
        with: &'static str,
        /// Upper end of the interval of the distance.
        distance: f64,
    },
    /// One step has another drift or noise as τ → 0, and no other scheme runs to measure the
    /// distance of the limits.
    Inconsistent {
        /// The error of single steps, as a part of |y| per unit of time or root of it.
        defect: f64,
    },
    /// The scheme converges to something else.
    Differs {
        /// The other scheme, or `exact solution`.
        with: &'static str,
        /// The distance of the limits.
        distance: f64,
    },
    /// The steps are too coarse, or the paths too few, to tell.
    Unclear {
        /// The other scheme, or `exact solution`.
        with: &'static str,
        /// Upper end of the interval of the distance.
        distance: f64,
    },
    /// There was nothing to compare with: the other schemes fail, or are the scheme itself.
    Unchecked,
}

/// Paths on which limits are compared: strong distances are the same on most paths.
const STRONG_PATHS: u64 = 256;
/// Halvings of the step size between the two at which distances are compared.
const SPAN: usize = 3;
/// The part of the mean-square distance at the finest step that may be left in the limit.
const LEFT: f64 = 0.5;
/// 95 %, two-sided.
const QUANTILE: f64 = 1.96;
/// Σ_{j ≥ 1} 2^{−j/2}: an error of order ½, the slowest, is at most so many differences y_τ −
/// y_{τ/2}.
const TAIL: f64 = 2.42;
/// Two schemes whose distance is below this fraction of their errors are the same one.
const SAME: f64 = 1e-6;

/// Compares the limit of `scheme`; there are more than [`SPAN`] step sizes.
pub fn limit<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    visits: &[Visit<D>],
    reference: &ReferenceSolution<'_, S, D, M>,
    what: Measure<D>,
) -> Result<Limit, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let compare = |other: Other<'_, S, D, M>| match what {
        Measure::Strong => {
            let sizes = StepSizes { samples: sizes.samples.min(STRONG_PATHS), ..*sizes };
            compare_strong(scheme, problem, &sizes, other)
        }
        Measure::Weak(_) => compare_weak(scheme, problem, sizes, other, what),
    };
    match *reference {
        ReferenceSolution::Exact(exact) => {
            Ok(compare(Other::Exact(exact))?.unwrap_or(Limit::Unchecked))
        }
        ReferenceSolution::Scheme(other) => {
            Ok(compare(Other::Scheme(other))?.unwrap_or(Limit::Unchecked))
        }
        ReferenceSolution::Independent => {
            let mut paths = Limit::Unchecked;
            for other in [&Heun as &dyn Scheme<S, D, M>, &Midpoint] {
                // One scheme may need finer steps than the other.
                match compare(Other::Scheme(other))? {
                    Some(unclear @ Limit::Unclear { .. }) => paths = unclear,
                    Some(limit) => {
                        paths = limit;
                        break;
                    }
                    None => {}
                }
            }
            let law = matches!(what, Measure::Weak(_));
            Ok(combine(consistency(scheme, problem, sizes, visits, law), paths))
        }
    }
}

/// The limit by single steps and by paths.
fn combine(steps: Consistency, paths: Limit) -> Limit {
    match (steps, paths) {
        (Consistency::Consistent(_), Limit::Differs { with, distance }) => {
            Limit::Unclear { with, distance }
        }
        (Consistency::Consistent(defect), _) => Limit::Consistent { defect },
        (Consistency::Inconsistent(_), Limit::Differs { .. }) => paths,
        (
            Consistency::Inconsistent(_),
            Limit::Agrees { with, distance } | Limit::Unclear { with, distance },
        ) => Limit::Differs { with, distance },
        (Consistency::Inconsistent(defect), _) => Limit::Inconsistent { defect },
        (Consistency::Unclear, _) => paths,
    }
}

/// What a scheme is compared with.
enum Other<'a, S, const D: usize, const M: usize> {
    Scheme(&'a dyn Scheme<S, D, M>),
    Exact(Exact<'a, D, M>),
}

impl<S: PoissonSystem<D, M>, const D: usize, const M: usize> Other<'_, S, D, M> {
    fn name(&self) -> &'static str {
        match self {
            Self::Scheme(scheme) => scheme.id(),
            Self::Exact(_) => "exact solution",
        }
    }
}

/// Moments of the [`distances`] of the states of the scheme and of the other one at the levels 0, 1
/// and [`SPAN`]; `None` if paths fail that would not fail with the scheme alone.
fn moments<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    other: &Other<'_, S, D, M>,
    what: Measure<D>,
) -> Result<Option<CrossMoments>, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let levels = [0, 1, SPAN];
    let mut runs: Vec<Run<'_, S, D, M>> = levels.map(|level| Run::new(scheme, level)).into();
    let exact = match *other {
        Other::Exact(exact) => Some(exact),
        Other::Scheme(other) => {
            runs.extend(levels.map(|level| Run::new(other, level)));
            None
        }
    };
    let of_view = |view: &View<'_, D>, p: usize, numbers: &mut [f64]| {
        let state = |run: usize| view.states[run].path(p);
        let others = match exact {
            None => [3, 4, 5].map(state),
            Some(exact) => [(exact.solution)(view.random_time.0[0][p]); 3],
        };
        numbers.copy_from_slice(&distances(what, [0, 1, 2].map(state), others));
    };
    let time_change = exact.map(|exact| exact.time_change);
    let (moments, failed) = measure(problem, sizes, runs, time_change, 4, &of_view)?;
    let usable = failed <= sizes.samples / 10 && moments.means().iter().all(|x| x.is_finite());
    Ok(usable.then_some(moments))
}

/// With y and z at the levels 0, 1 and [`SPAN`]. Strong: |y − z|² at the last level and at level 0,
/// then the squared differences of levels 0 and 1 of y and of z. Weak: the differences of φ between
/// y and z at level 0, between levels 0 and 1 of y and of z, and between the last level and level 0
/// of y.
fn distances<const D: usize>(what: Measure<D>, y: [[f64; D]; 3], z: [[f64; D]; 3]) -> [f64; 4] {
    match what {
        Measure::Strong => {
            let [far, near] = [2, 0].map(|run| squared_distance(y[run], z[run]));
            let [own, others] = [y, z].map(|y| squared_distance(y[0], y[1]));
            [far, near, own, others]
        }
        Measure::Weak(observable) => {
            let [y, z] = [y, z].map(|states| states.map(observable.function));
            [y[0] - z[0], y[0] - y[1], z[0] - z[1], y[2] - y[0]]
        }
    }
}

/// The distance of the limits, (E|y − z|²)^½, from the mean squares X at two step sizes that are
/// 2^[`SPAN`] apart.
fn compare_strong<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    other: Other<'_, S, D, M>,
) -> Result<Option<Limit>, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let with = other.name();
    let moments = moments(scheme, problem, sizes, &other, Measure::Strong)?;
    let Some(moments) = moments else { return Ok(None) };
    let [near, own, others] = [1, 2, 3].map(|i| moments.mean(i));
    if near <= SAME * SAME * own {
        return Ok(None);
    }
    let (constant, half_width) = constant(&moments, [0, 1], SPAN);
    let distance = (constant.max(0.0) + half_width).min(near).sqrt();
    let errors = TAIL * (own.sqrt() + others.sqrt());
    Ok(Some(if constant + half_width <= LEFT * near || near <= LEFT * LEFT * LEFT * own {
        Limit::Agrees { with, distance }
    } else if constant - half_width > LEFT * near && near.sqrt() > 2.0 * errors {
        Limit::Differs { with, distance: near.sqrt() }
    } else {
        Limit::Unclear { with, distance }
    }))
}

/// The constant c of mean squares X = c + Aτ + … with positive terms, at most, from those at two
/// step sizes that are 2^`halvings` apart: c ≤ (2ⁿX(τ) − X(2ⁿτ))/(2ⁿ − 1), with its 95 %
/// half-width.
fn constant(squares: &CrossMoments, [far, near]: [usize; 2], halvings: usize) -> (f64, f64) {
    let growth = (halvings as f64).exp2();
    let mut row = vec![0.0; squares.length()];
    row[near] = growth / (growth - 1.0);
    row[far] = -1.0 / (growth - 1.0);
    let constant = squares.combined(&[row]);
    (constant.mean(0), half_width(&constant, 0))
}

/// Half the width of the 95 % interval of mean number i. Where all paths agree, rounding may make
/// the variance negative.
fn half_width(moments: &CrossMoments, i: usize) -> f64 {
    QUANTILE * moments.covariance_of_means(i, i).max(0.0).sqrt()
}

/// The distance of the limit from that of a reference, if squared errors against the reference
/// stay while the differences of successive step sizes, coarsest first, fall; `None` where the
/// limits agree or cannot be told apart.
pub fn wrong_limit(errors: &CrossMoments, differences: &CrossMoments) -> Option<f64> {
    let finest = errors.length().checked_sub(1).filter(|&finest| finest > 0)?;
    let near = errors.mean(finest);
    let (constant, half_width) = constant(errors, [0, finest], finest);
    let own = differences.mean(finest - 1);
    (constant - half_width > LEFT * near && near.sqrt() > 2.0 * TAIL * own.sqrt())
        .then_some(near.sqrt())
}

/// The distance of the limits, |E[φ(y) − φ(z)]|, from the finest step. Either error is at most its
/// last difference, as for order one, or half of the one before.
fn compare_weak<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    other: Other<'_, S, D, M>,
    what: Measure<D>,
) -> Result<Option<Limit>, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let with = other.name();
    let Some(moments) = moments(scheme, problem, sizes, &other, what)? else {
        return Ok(None);
    };
    let half_width = |i: usize| half_width(&moments, i);
    let [near, own, others, coarse] = [0, 1, 2, 3].map(|i| moments.mean(i).abs());
    let noise = half_width(0);
    let errors = own + half_width(1) + others + half_width(2);
    if near + noise <= SAME * coarse && matches!(other, Other::Scheme(_)) {
        return Ok(None);
    }
    let distance = near + noise;
    Ok(Some(if near > 2.0 * (noise + errors) {
        Limit::Differs { with, distance: near }
    } else if distance <= (1.0 - LEFT) * coarse.max(own) || distance <= 2.0 * errors.min(coarse) {
        Limit::Agrees { with, distance }
    } else {
        Limit::Unclear { with, distance }
    }))
}
