//! Whether a scheme converges to the right limit.
//!
//! [`consistency`] sees it in single steps. Paths on the same noise are compared, too: they say how
//! far a wrong limit is, and where they differ although single steps agree, the step sizes do not
//! show how the scheme converges. With an exact solution paths alone decide.

use std::sync::Arc;

use mc::{LadderError, Run, View, parts::Stop};
use real::{PathMask, Row};
use schemes::Method;
use stats::CrossMoments;

use super::{
    Exact, Measure, ReferenceSolution, StepSizes,
    consistency::consistency,
    difference,
    errors::squared_distance,
    evaluate,
    runs::{Visit, measure},
    steps::Subject,
};

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
    /// There was nothing to compare with: the other schemes fail, or are the scheme itself, and
    /// single steps show nothing.
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

/// Compares the limit of a scheme; there are more than [`SPAN`] step sizes.
pub fn limit(
    subject: Subject<'_>,
    sizes: &StepSizes,
    visits: &[Visit],
    reference: &ReferenceSolution<'_>,
    what: Measure<'_>,
) -> Result<Limit, LadderError> {
    // With the exact solution or another scheme; `None` if paths fail that would not fail with the
    // scheme alone, or if the schemes are the same one.
    let compare = |exact: Option<&Exact<'_>>, other: Option<&Arc<dyn Method + '_>>| {
        let samples = match what {
            Measure::Strong => sizes.samples.min(STRONG_PATHS),
            Measure::Weak(_) => sizes.samples,
        };
        let moments = moments(subject, &StepSizes { samples, ..*sizes }, exact, other, what)?;
        let with = other.map_or("exact solution", |other| other.id());
        Ok::<_, LadderError>(moments.and_then(|moments| match what {
            Measure::Strong => strong_limit(&moments, with),
            Measure::Weak(_) => weak_limit(&moments, with, other.is_some()),
        }))
    };
    match reference {
        ReferenceSolution::Exact(exact) => {
            Ok(compare(Some(exact), None)?.unwrap_or(Limit::Unchecked))
        }
        ReferenceSolution::Independent(others) => {
            let mut paths = Limit::Unchecked;
            for other in others {
                paths = compare(None, Some(other))?.unwrap_or(paths);
                // One scheme may need finer steps than the other.
                if !matches!(paths, Limit::Unclear { .. } | Limit::Unchecked) {
                    break;
                }
            }
            let law = matches!(what, Measure::Weak(_));
            Ok(combine(consistency(subject, sizes, visits, law, &Stop::default()), paths))
        }
    }
}

/// The limit by single steps and by paths.
fn combine(steps: Limit, paths: Limit) -> Limit {
    use Limit::{Agrees, Consistent, Differs, Inconsistent, Unclear};
    match (steps, paths) {
        (Consistent { .. }, Differs { with, distance }) => Unclear { with, distance },
        (Inconsistent { .. }, Agrees { with, distance } | Unclear { with, distance }) => {
            Differs { with, distance }
        }
        (Consistent { .. } | Inconsistent { .. }, _) if !matches!(paths, Differs { .. }) => steps,
        _ => paths,
    }
}

/// Moments of the [`distances`] of the states of the scheme and of the other one at the levels 0, 1
/// and [`SPAN`]; `None` if paths fail that would not fail with the scheme alone.
fn moments<'a>(
    subject: Subject<'a>,
    sizes: &StepSizes,
    exact: Option<&Exact<'a>>,
    other: Option<&Arc<dyn Method + 'a>>,
    what: Measure<'_>,
) -> Result<Option<CrossMoments>, LadderError> {
    let on_levels = |scheme: &Arc<dyn Method + 'a>| {
        [0, 1, SPAN].map(|level| Run::new(Arc::clone(scheme), level))
    };
    let runs: Vec<Run<'_>> =
        [subject.scheme].into_iter().chain(other).flat_map(on_levels).collect();
    let of_view = |view: &View<'_>, numbers: &mut [Row]| {
        let state = |run: usize| view.state(run);
        let solution = exact.map(|exact| exact.rows(view, subject.problem.y0.len()));
        let others = solution.as_ref().map_or_else(|| [3, 4, 5].map(state), |y| [&y[..]; 3]);
        let distances = distances(what, [0, 1, 2].map(state), others, view.live);
        numbers.copy_from_slice(&distances);
    };
    let time_change = exact.map(|exact| exact.time_change);
    let (moments, failed) = measure(subject.problem, sizes, runs, time_change, 4, &of_view)?;
    let usable =
        failed.paths <= sizes.samples / 10 && moments.means().iter().all(|x| x.is_finite());
    Ok(usable.then_some(moments))
}

/// With y and z at the levels 0, 1 and [`SPAN`]. Strong: |y − z|² at the last level and at level 0,
/// then the squared differences of levels 0 and 1 of y and of z. Weak: the differences of φ between
/// y and z at level 0, between levels 0 and 1 of y and of z, and between the last level and level 0
/// of y.
fn distances(what: Measure<'_>, y: [&[Row]; 3], z: [&[Row]; 3], live: PathMask) -> [Row; 4] {
    match what {
        Measure::Strong => {
            let [far, near] = [2, 0].map(|run| squared_distance(y[run], z[run], live));
            let [own, others] = [y, z].map(|y| squared_distance(y[0], y[1], live));
            [far, near, own, others]
        }
        Measure::Weak(observable) => {
            let [y, z] = [y, z].map(|states| states.map(|y| evaluate(observable, y, live)));
            [(&y[0], &z[0]), (&y[0], &y[1]), (&z[0], &z[1]), (&y[2], &y[0])]
                .map(|(a, b)| difference(a, b))
        }
    }
}

/// The distance of the limits, (E|y − z|²)^½, from the means of [`distances`], mean squares at two
/// step sizes that are 2^[`SPAN`] apart; `None` if the schemes are the same one.
fn strong_limit(moments: &CrossMoments, with: &'static str) -> Option<Limit> {
    let [near, own, others] = [1, 2, 3].map(|i| moments.mean(i));
    if near <= SAME * SAME * own {
        return None;
    }
    let (constant, half_width) = constant(moments, [0, 1], SPAN);
    let distance = (constant.max(0.0) + half_width).min(near).sqrt();
    let errors = TAIL * (own.sqrt() + others.sqrt());
    Some(if constant + half_width <= LEFT * near || near <= LEFT * LEFT * LEFT * own {
        Limit::Agrees { with, distance }
    } else if constant - half_width > LEFT * near && near.sqrt() > 2.0 * errors {
        Limit::Differs { with, distance: near.sqrt() }
    } else {
        Limit::Unclear { with, distance }
    })
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

/// The distance of the limits, |E[φ(y) − φ(z)]|, from the means of [`distances`] at the finest
/// step. Either error is at most its last difference, as for order one, or half of the one before.
/// `None` if the schemes are the same one, where they may be.
fn weak_limit(moments: &CrossMoments, with: &'static str, may_be_same: bool) -> Option<Limit> {
    let half_width = |i: usize| half_width(moments, i);
    let [near, own, others, coarse] = [0, 1, 2, 3].map(|i| moments.mean(i).abs());
    let noise = half_width(0);
    let errors = own + half_width(1) + others + half_width(2);
    if may_be_same && near + noise <= SAME * coarse {
        return None;
    }
    let distance = near + noise;
    Some(if near > 2.0 * (noise + errors) {
        Limit::Differs { with, distance: near }
    } else if distance <= (1.0 - LEFT) * coarse.max(own) || distance <= 2.0 * errors.min(coarse) {
        Limit::Agrees { with, distance }
    } else {
        Limit::Unclear { with, distance }
    })
}

#[cfg(test)]
mod tests {
    use mc::Observable;
    use real::WIDTH;

    use super::*;

    #[test]
    fn single_steps_and_paths_are_combined() {
        let (with, distance) = ("heun", 0.25);
        let differs = Limit::Differs { with, distance };
        let (agrees, unclear) =
            (Limit::Agrees { with, distance }, Limit::Unclear { with, distance });
        let of = |steps: Limit| {
            [differs, agrees, unclear, Limit::Unchecked].map(|paths| combine(steps, paths))
        };
        let right = Limit::Consistent { defect: 0.5 };
        assert_eq!(of(right), [unclear, right, right, right]);
        let wrong = Limit::Inconsistent { defect: 0.5 };
        assert_eq!(of(wrong), [differs, differs, differs, wrong]);
        assert_eq!(of(Limit::Unchecked), [differs, agrees, unclear, Limit::Unchecked]);
    }

    #[test]
    fn distances_are_between_schemes_and_between_their_step_sizes() {
        let (y, z) = ([[1.0, 0.0], [4.0, 4.0], [1.0, 6.0]], [[3.0, 0.0], [3.0, 1.0], [1.0, 0.0]]);
        let [y, z] = [y, z].map(|states| states.map(|y| y.map(|y| [y; WIDTH])));
        let of = |what| {
            let (y, z) = (y.each_ref().map(|y| &y[..]), z.each_ref().map(|z| &z[..]));
            distances(what, y, z, PathMask::ALL).map(|row| row[7])
        };
        assert_eq!(of(Measure::Strong), [36.0, 4.0, 25.0, 1.0]);
        let sum = Observable { name: "sum", function: |y: [f64; 2]| y[0] + y[1] };
        assert_eq!(of(Measure::Weak(&sum)), [-2.0, -7.0, -1.0, 6.0]);
    }

    #[test]
    fn the_constant_of_a_line_is_extrapolated_with_its_noise() {
        // 9 and 2 three halvings apart: (8·2 − 9)/7 = 1, times 1 ± ½ on 64 paths.
        let mut squares = CrossMoments::new(2);
        (0..64).for_each(|n| {
            let size = if n % 2 == 0 { 1.5 } else { 0.5 };
            squares.add(&[9.0 * size, 2.0 * size]);
        });
        let (found, width) = constant(&squares, [0, 1], 3);
        assert!((found - 1.0).abs() < 1e-12, "{found}");
        assert!((width / (1.96 * 0.5 / 63f64.sqrt()) - 1.0).abs() < 1e-9, "{width}");
        let (found, width) = constant(&squares, [1, 0], 1);
        assert!(
            (found - 16.0).abs() < 1e-12
                && (width / 16.0 * 2.0 * 63f64.sqrt() / 1.96 - 1.0).abs() < 1e-9
        );
    }

    /// Moments of 64 paths with these means, of which each is spread by this part of it.
    fn spread<const N: usize>(means: [f64; N], parts: [f64; N]) -> CrossMoments {
        let mut moments = CrossMoments::new(N);
        for path in 0..64 {
            let sign = if path % 2 == 0 { 1.0 } else { -1.0 };
            let numbers: Vec<f64> = (0..N).map(|i| means[i] * (1.0 + sign * parts[i])).collect();
            moments.add(&numbers);
        }
        moments
    }

    /// Half the width of the interval of a mean of one that is spread by a half.
    const HALF: f64 = 0.5 * 1.96 / 7.937_253_933_193_772;

    /// A, D or U for agrees, differs or unclear, with the distance.
    fn told(limit: Option<Limit>) -> Option<(char, f64)> {
        limit.map(|limit| match limit {
            Limit::Agrees { distance, .. } => ('A', distance),
            Limit::Differs { distance, .. } => ('D', distance),
            Limit::Unclear { distance, .. } => ('U', distance),
            other => panic!("{other:?}"),
        })
    }

    /// Up to rounding, whose root is the standard error of what is not spread.
    fn is(limit: Option<Limit>, what: char, distance: f64) -> bool {
        let rounding = 64.0 * f64::EPSILON.sqrt();
        told(limit).is_some_and(|(a, b)| a == what && (b / distance - 1.0).abs() < rounding)
    }

    #[test]
    fn paths_agree_where_most_of_their_distance_shrinks_and_differ_beyond_their_errors() {
        // Near 1 and far 8 − 7c leave the constant c, named as the distance √c.
        let of = |c: f64, own: f64, others: f64, part: f64| {
            let means = [8.0 - 7.0 * c, 1.0, own * own, others * others];
            strong_limit(&spread(means, [part, part, 0.0, 0.0]), "heun")
        };
        assert!(is(of(0.499, 0.1, 0.1, 0.0), 'A', 0.499f64.sqrt()));
        // Two errors of 2.42 times the last differences, 0.968 and 1.016.
        assert!(is(of(0.501, 0.1, 0.1, 0.0), 'D', 1.0));
        assert!(is(of(0.501, 0.1, 0.11, 0.0), 'U', 0.501f64.sqrt()));
        assert!(is(of(0.501, 0.11, 0.1, 0.0), 'U', 0.501f64.sqrt()));
        // Below the root of an eighth of the last difference it is no difference.
        assert!(is(of(1.0, 8.1f64.sqrt(), 0.1, 0.0), 'A', 1.0));
        assert!(is(of(1.0, 7.9f64.sqrt(), 0.1, 0.0), 'U', 1.0));
        // Noise: 0.46 ± 0.057 is not below ½, and 0.55 ± 0.068 not above.
        for c in [0.46, 0.55] {
            assert!(is(of(c, 0.1, 0.1, 0.5), 'U', (c * (1.0 + HALF)).sqrt()), "{c}");
        }
        assert!(is(of(0.44, 0.1, 0.1, 0.5), 'A', (0.44 * (1.0 + HALF)).sqrt()));
        assert!(is(of(0.58, 0.1, 0.1, 0.5), 'D', 1.0));
        // A scheme is itself within 1e-6 of the last difference.
        let same = |near: f64| strong_limit(&spread([near, near, 1.0, 1.0], [0.0; 4]), "heun");
        assert!(same(0.9e-12).is_none() && is(same(1.1e-12), 'A', 1.1e-12f64.sqrt()));
    }

    #[test]
    fn means_differ_beyond_twice_their_noise_and_errors() {
        let of = |own: f64, others: f64, coarse: f64, parts: [f64; 3]| {
            let [a, b, c] = parts;
            weak_limit(&spread([-1.0, own, -others, coarse], [a, b, c, 0.0]), "heun", true)
        };
        let none = [0.0; 3];
        assert!(is(of(0.3, 0.19, 0.1, none), 'D', 1.0));
        // Twice errors of 0.51, half of the change by the step size, or twice of that.
        assert!(is(of(0.3, 0.21, 0.45, none), 'U', 1.0));
        assert!(is(of(0.3, 0.21, 0.51, none), 'A', 1.0));
        assert!(is(of(1.9, 0.21, 0.45, none), 'U', 1.0));
        assert!(is(of(2.1, 0.21, 0.45, none), 'A', 1.0));
        assert!(is(of(0.2, 0.2, 2.1, none), 'D', 1.0));
        // Noise of the distance, and of either error.
        assert!(is(of(0.37, 0.0, 0.1, [0.5, 0.0, 0.0]), 'D', 1.0));
        assert!(is(of(0.38, 0.0, 0.1, [0.5, 0.0, 0.0]), 'U', 1.0 + HALF));
        assert!(is(of(0.2, 0.27, 0.1, [0.0, 0.5, 0.0]), 'D', 1.0));
        assert!(is(of(0.2, 0.28, 0.1, [0.0, 0.5, 0.0]), 'U', 1.0));
        assert!(is(of(0.27, 0.2, 0.1, [0.0, 0.0, 0.5]), 'D', 1.0));
        assert!(is(of(0.28, 0.2, 0.1, [0.0, 0.0, 0.5]), 'U', 1.0));
        let same = |coarse: f64, may_be| {
            weak_limit(&spread([1e-6, 1e-6, 0.0, coarse], [0.0; 4]), "heun", may_be)
        };
        assert!(same(1.1, true).is_none() && is(same(1.1, false), 'A', 1e-6));
        assert!(is(same(0.9, true), 'A', 1e-6));
    }
}
