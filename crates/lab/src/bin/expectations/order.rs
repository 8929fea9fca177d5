//! The weak order of `nv` and of its twins.
//!
//! An error is E[φ(y_n)] − E[φ(y(T))] where the exact value is known, otherwise E[φ(y_n)] −
//! E[φ(y_{2n})] on the same increments: if the first is cτᵖ + …, the second is c(1 − 2⁻ᵖ)τᵖ + …, of
//! the same order.

use std::{f64::consts::LN_2, ops::Range};

use anyhow::Result;
use lab::{Compiled, compiled, streams, weak_observables};
use mc::{Observable, Run, Statistic, View};
use noise::StreamKey;
use schemes::{Nv, Scheme, Sexp, Sweep};
use systems::{
    Damping, Flows, Invariant, InvariantKind, Problem,
    paper::{maxwell_bloch, poisson3_strong, rigid_body_three_noises},
};
use verify::{FinalMoments, rigid_body_expectations, worse};

use crate::{
    cost::degree,
    results::{BiasPoint, FunctionOrder, Orders, ProblemOrders, SchemeOrders, Slope},
    scrambles::{Scrambles, means},
};

/// Numbers of steps n at which errors are measured on a problem: so many, twice and four times.
const STEPS: usize = 3;
/// Test functions: each component and its square, the first of the twelve.
const FUNCTIONS: usize = 6;
/// Streams of a problem, one for each n.
const PROBLEM_STREAMS: u64 = 32;

/// What is the same for all schemes on a problem.
struct Settings {
    key: StreamKey,
    /// Independent scrambles.
    scrambles: u64,
    /// The least n.
    first: u64,
    /// Points of a scramble at each n, and the least number for twins.
    points: [u64; STEPS],
    least_points: u64,
    /// Whether the noises have flows that are exact up to high order. Triple jumps leave odd powers
    /// of τ in the expansion of the error.
    even: bool,
}

impl Settings {
    /// A twin has larger errors.
    fn points_of<S, const D: usize, const M: usize>(&self, entry: &Entry<S, D, M>) -> [u64; STEPS] {
        let of_twin = |points: u64| (points / 16).max(self.least_points);
        if entry.twin { self.points.map(of_twin) } else { self.points }
    }
}

/// One scheme, or several over which φ is averaged on the same increments.
struct Entry<S, const D: usize, const M: usize> {
    name: &'static str,
    /// Whether its order is one.
    twin: bool,
    schemes: Vec<Box<dyn Scheme<S, D, M>>>,
}

/// The orders on all problems. Numbers of steps and points are from pilots with other seeds.
pub fn measure(seed: u64, quick: bool) -> Result<Orders> {
    let scrambles = if quick { 16 } else { 32 };
    // Points are powers of two, given by their logarithms.
    let settings = |number: u64, first, least: u32, points: [u32; STEPS], even| {
        let experiment = streams::EXPECTATION_ORDER + number * PROBLEM_STREAMS;
        Settings {
            key: StreamKey { seed, experiment },
            scrambles,
            first,
            points: points.map(|points| 1 << if quick { least } else { points }),
            least_points: 1 << least,
            even,
        }
    };
    let functions = &weak_observables()[..FUNCTIONS];
    let body = rigid_body_three_noises(1.0);
    let exact = rigid_body_expectations(&body, degree(quick), functions);
    let problems = vec![
        on_problem(&body, functions, Some(&exact), &settings(0, 4, 13, [18, 20, 21], true))?,
        on_problem(&maxwell_bloch(1.0), functions, None, &settings(1, 8, 11, [16, 16, 17], true))?,
        on_problem(&poisson3_strong(), functions, None, &settings(2, 64, 10, [14, 16, 15], false))?,
    ];
    Ok(Orders { scrambles, problems })
}

fn entries<S, const D: usize, const M: usize>() -> Vec<Entry<S, D, M>>
where
    S: Flows<D, M> + Compiled<Sexp, D, M> + 'static,
{
    let nv = |sweep| Box::new(Nv::of_parts().with_sweep(sweep)) as Box<dyn Scheme<S, D, M>>;
    let entry = |name, twin, schemes| Entry { name, twin, schemes };
    let mut entries = vec![entry("nv", false, vec![nv(Sweep::Alternating)])];
    if M > 1 {
        let both = [Sweep::Forward, Sweep::Backward].map(nv);
        entries.push(entry("nv, both orders", false, both.into()));
        entries.push(entry("nv, one order", true, vec![nv(Sweep::Forward)]));
    }
    entries.push(entry("sexp", true, vec![compiled(Sexp)]));
    entries
}

fn on_problem<S, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    functions: &[Observable<D>],
    exact: Option<&[f64]>,
    settings: &Settings,
) -> Result<ProblemOrders>
where
    S: Flows<D, M> + Compiled<Sexp, D, M> + 'static,
{
    let entries = entries().into_iter();
    let schemes = entries.map(|entry| of_scheme(problem, &entry, functions, exact, settings));
    let schemes = schemes.collect::<Result<_>>()?;
    let (name, t_end) = (problem.system().name(), problem.t_end());
    Ok(ProblemOrders { problem: name, t_end, exact: exact.is_some(), schemes })
}

fn of_scheme<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    entry: &Entry<S, D, M>,
    functions: &[Observable<D>],
    exact: Option<&[f64]>,
    settings: &Settings,
) -> Result<SchemeOrders> {
    // Without an exact value 2n steps are the finest level, and n steps the one above. The mean of
    // the fine path and of that with neighbouring increments exchanged is nearer to the coarse one.
    let level = usize::from(exact.is_none());
    let at = |level| entry.schemes.iter().map(move |scheme| Run::new(scheme.as_ref(), level));
    let swapped = || entry.schemes.iter().map(|scheme| Run::swapped(scheme.as_ref(), 0));
    let runs = || match exact {
        Some(_) => at(0).collect(),
        None => at(1).chain(at(0)).chain(swapped()).collect(),
    };
    let values = |view: &View<'_>, p: usize, numbers: &mut [f64]| {
        for (index, number) in numbers.iter_mut().enumerate() {
            let phi = |run: usize| (functions[index].function)(view.path(run, p));
            let mean = |runs: Range<usize>| {
                let count = runs.len() as f64;
                runs.map(phi).sum::<f64>() / count
            };
            let (coarse, all) = (entry.schemes.len(), view.runs());
            *number =
                mean(0..coarse) - exact.map_or_else(|| mean(coarse..all), |exact| exact[index]);
        }
    };
    let mut errors = vec![Vec::new(); functions.len()];
    let mut defect = 0.0;
    for (doublings, points) in settings.points_of(entry).into_iter().enumerate() {
        let steps = settings.first << doublings;
        let experiment = settings.key.experiment + u64::from(steps.ilog2());
        let key = StreamKey { experiment, ..settings.key };
        let defect_of = casimir_defect(problem, steps);
        let new = || AlongPaths {
            last: FinalMoments::new(steps, functions.len(), &values),
            defect_of: &defect_of,
            defect: 0.0,
        };
        let scrambles = Scrambles { key, count: settings.scrambles, points };
        let measured = scrambles.each(problem, (steps << level, level), runs, new)?;
        defect = measured.iter().map(|one| one.statistic.defect).fold(defect, worse);
        let (means, failed) = means(&measured, |along| &along.last.moments);
        for (errors, (bias, half_width)) in errors.iter_mut().zip(means) {
            errors.push(BiasPoint { steps, points, bias, half_width, failed });
        }
    }
    let even = settings.even && !entry.twin;
    let function = |(function, points): (&Observable<D>, Vec<BiasPoint>)| FunctionOrder {
        name: function.name.into(),
        coarse: order(&points, COARSE),
        fine: order(&points, FINE),
        order: order(&points, if even { WITHOUT_EVEN } else { WITHOUT_ODD }),
        points,
    };
    let functions = functions.iter().zip(errors).map(function).collect();
    Ok(SchemeOrders { scheme: entry.name, twin: entry.twin, even, defect, functions })
}

/// Weights of log₂ |error| at n, 2n and 4n steps: for the orders p₁ and p₂ between neighbours, for
/// (4p₂ − p₁)/3, which a next term of relative size τ² does not change to first order, and for
/// 2p₂ − p₁, which one of relative size τ does not.
const COARSE: [f64; STEPS] = [1.0, -1.0, 0.0];
const FINE: [f64; STEPS] = [0.0, 1.0, -1.0];
const WITHOUT_EVEN: [f64; STEPS] = [-1.0 / 3.0, 5.0 / 3.0, -4.0 / 3.0];
const WITHOUT_ODD: [f64; STEPS] = [-1.0, 3.0, -2.0];

/// The weighted sum of log₂ |error|. The half-width of a logarithm is that of the number, relative.
/// None where an interval has both signs, or the errors have.
fn order(points: &[BiasPoint], weights: [f64; STEPS]) -> Option<Slope> {
    let (mut value, mut square) = (0.0, 0.0);
    let used = || points.iter().zip(weights).filter(|(_, weight)| *weight != 0.0);
    let sign = used().next()?.0.bias.signum();
    for (point, weight) in used() {
        let relative = point.half_width / (sign * point.bias);
        if !(0.0..1.0).contains(&relative) {
            return None;
        }
        value += weight * point.bias.abs().log2();
        square += (weight * relative / LN_2).powi(2);
    }
    Some(Slope::within(value, square.sqrt()))
}

/// The largest relative defect of a Casimir among the paths of a view, at one of so many equally
/// spaced times.
fn casimir_defect<S: Flows<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    times: u64,
) -> impl Fn(&View<'_>) -> f64 + Sync {
    let system = problem.system();
    let invariants = system.invariants().into_iter().enumerate();
    let casimirs: Vec<_> =
        invariants.filter(|(_, invariant)| invariant.kind == InvariantKind::Casimir).collect();
    let law = |time: u64| {
        let integral =
            problem.damping().integral(0.0, problem.t_end() * time as f64 / times as f64);
        let exact = |(index, casimir): &(usize, Invariant)| {
            let start: f64 = system.invariant(*index, problem.y0());
            (*index, (-casimir.degree * integral).exp() * start)
        };
        casimirs.iter().map(exact).collect::<Vec<_>>()
    };
    let laws: Vec<_> = (1..=times).map(law).collect();
    move |view| {
        let mut largest = 0.0;
        for &(index, exact) in &laws[view.time as usize - 1] {
            for run in 0..view.runs() {
                for p in view.live.paths() {
                    let value: f64 = system.invariant(index, view.path(run, p));
                    largest = worse(largest, (value / exact - 1.0).abs());
                }
            }
        }
        largest
    }
}

/// Moments at the end, and the largest defect on the way.
struct AlongPaths<'a> {
    last: FinalMoments<'a>,
    defect_of: &'a (dyn Fn(&View<'_>) -> f64 + Sync),
    defect: f64,
}

impl Statistic for AlongPaths<'_> {
    fn observe(&mut self, view: &View<'_>) {
        self.defect = worse(self.defect, (self.defect_of)(view));
        self.last.observe(view);
    }

    fn merge(&mut self, later: Self) {
        self.defect = worse(self.defect, later.defect);
        self.last.merge(later.last);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors cτᵖ(1 + bτ^q) at 4, 8 and 16 steps, with half-widths of 1 %.
    fn points(c: f64, p: i32, b: f64, q: i32) -> Vec<BiasPoint> {
        let point = |steps: u64| {
            let tau = 1.0 / steps as f64;
            let bias = c * tau.powi(p) * (1.0 + b * tau.powi(q));
            BiasPoint { steps, points: 1, bias, half_width: 0.01 * bias.abs(), failed: 0 }
        };
        [4, 8, 16].map(point).into()
    }

    #[test]
    fn a_known_order_is_recovered() {
        for (c, p) in [(1e-3, 2), (-0.2, 1)] {
            let off = |b, q, weights| {
                let order = order(&points(c, p, b, q), weights).unwrap();
                (order.value - f64::from(p)).abs()
            };
            for weights in [COARSE, FINE, WITHOUT_EVEN, WITHOUT_ODD] {
                assert!(off(0.0, 1, weights) < 1e-12);
            }
            // A next term bends the line. What is left without it is of its square.
            for (b, q, without) in [(2.0, 2, WITHOUT_EVEN), (0.5, 1, WITHOUT_ODD)] {
                let [coarse, fine, rest] = [COARSE, FINE, without].map(|w| off(b, q, w));
                assert!(coarse > 0.07 && fine > 0.03 && rest < 0.006, "{coarse} {fine} {rest}");
            }
        }
    }

    #[test]
    fn an_interval_is_that_of_independent_errors_or_there_is_none() {
        let mut measured = points(1.0, 2, 0.0, 1);
        for (weights, square) in [(FINE, 2.0), (WITHOUT_EVEN, 42.0 / 9.0), (WITHOUT_ODD, 14.0f64)] {
            let half_width = order(&measured, weights).unwrap().half_width();
            assert!((half_width - square.sqrt() * 0.01 / LN_2).abs() < 1e-12);
        }
        measured[2].half_width = 2.0 * measured[2].bias;
        assert!(order(&measured, COARSE).is_some() && order(&measured, FINE).is_none());
        measured[0].bias *= -1.0;
        assert!(order(&measured, COARSE).is_none());
    }
}
