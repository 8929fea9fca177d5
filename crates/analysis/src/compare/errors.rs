//! Errors of schemes at several step sizes on the same noise, against a reference.

use std::{ops::Range, sync::Arc};

use mc::{ConformalLaw, Ladder, LadderError, Problem, Run, View, parts::Stop};
use real::{
    Row,
    elementary::{exp2, log2},
};
use schemes::Method;
use serde::{Deserialize, Serialize};
use stats::{CrossMoments, root_mean_square_interval};

use super::search::Search;
use crate::{
    FinalMoments, Spread,
    orders::{kept, squared_distance},
};
use inspect::facts::Form;

/// The error of one scheme at one step size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorPoint {
    /// Number of steps of a path.
    pub steps: u64,
    /// Strong error (E|y_N − y_ref|²)^½.
    pub error: f64,
    /// Lower end of the 95 % interval of `error`, less the error of the reference.
    pub lo: f64,
    /// Upper end of the interval, with the error of the reference added.
    pub hi: f64,
    /// Whether the error of the reference is at most a quarter of `error`. Other points are not
    /// used.
    pub resolved: bool,
    /// Defect (E max_C|C(y_N)/(e^{−p∫γ}C(y₀)) − 1|²)^½ over the Casimirs C; `None` if no Casimir is
    /// known.
    pub defect: Option<f64>,
    /// Seconds of processor time of a path, where they were measured.
    pub time: Option<Spread>,
}

/// Paths behind all errors, and the reference.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sampled {
    /// Number of paths.
    pub samples: u64,
    /// Number of paths left out because some scheme at some step size had no solution.
    pub failed: u64,
    /// Messages of the first few failures.
    pub failures: Vec<String>,
    /// Identifier of the reference scheme.
    pub reference: String,
    /// Number of steps of the reference.
    pub steps: u64,
    /// Strong difference (E|y_τ − y_{2τ}|²)^½ of the reference at its finest two step sizes.
    pub last_difference: f64,
    /// Distance (E|y(T) − y′(T)|²)^½ of two independent paths of the reference.
    pub spread: f64,
}

impl Sampled {
    /// Whether paths of the reference separate: at its finest two step sizes they are nearly as far
    /// apart as independent ones.
    pub fn parts(&self) -> bool {
        const PARTED: f64 = 0.25;
        self.last_difference > PARTED * self.spread
    }
}

/// The errors of all schemes.
pub struct Errors {
    pub sampled: Sampled,
    /// Upper bound of the error of the reference, with 95 %. Every interval includes it.
    pub of_reference: f64,
    /// The points of each scheme, coarsest first.
    pub points: Vec<Vec<ErrorPoint>>,
}

/// Step sizes of the reference: with the next two, its own error is estimated.
const REFERENCES: usize = 3;
/// The part of an error that the error of the reference may be.
const RESOLVED: f64 = 0.25;

impl<'a> Search<'a> {
    /// Measures distances to the reference on the same noise, at these step sizes of each scheme
    /// and of the reference. The error of the reference is estimated from its own differences.
    pub fn measure(
        &self,
        sizes: &[Range<u32>],
        reference: u32,
        samples: u64,
        stop: &Stop,
    ) -> Result<Errors, LadderError> {
        let Self { problem, candidates, settings, base, .. } = *self;
        let finest = sizes.iter().map(|sizes| sizes.end.saturating_sub(1));
        let finest = finest.fold(reference, u32::max);
        let run = |scheme: &Arc<dyn Method + 'a>, size: u32| {
            Run::new(Arc::clone(scheme), (finest - size) as usize)
        };
        let references = (reference + 1 - REFERENCES as u32..=reference).rev();
        let mut runs: Vec<Run<'_>> =
            references.map(|size| run(&candidates.reference, size)).collect();
        for (scheme, sizes) in candidates.schemes.iter().zip(sizes) {
            runs.extend(sizes.clone().map(|size| run(scheme, size)));
        }
        let length = 2 * runs.len() - REFERENCES;
        let top = runs.iter().map(|run| run.level).max().unwrap_or(0);
        let casimirs = defects(problem, &candidates.casimirs);
        let values = |view: &View<'_>, values: &mut [Row]| squares(view, &casimirs, values);
        let key = self.key(0);
        let ladder = Ladder::new(problem, base << finest, top, settings.truncation, key, runs)?;
        let ladder = ladder.fitting(samples)?;
        let new = || FinalMoments::new(ladder.coarse_steps(), length, &values);
        let (job, name) = (settings.job.as_deref(), format!("{sizes:?}, reference {reference}"));
        let measured = kept(&ladder, (job, stop), &name, samples, new);
        let moments = measured.statistic.moments;

        let rms = |index: usize| moments.mean(index).sqrt();
        let of_reference = left(rms(1), root_mean_square(&moments, 0));
        let mut squares = (REFERENCES..).step_by(2);
        let mut point = |(size, square): (u32, usize)| {
            let [lo, error, hi] = root_mean_square(&moments, square);
            ErrorPoint {
                steps: base << size,
                error,
                lo: (lo - of_reference).max(0.0),
                hi: hi + of_reference,
                resolved: of_reference <= RESOLVED * error,
                defect: (!casimirs.is_empty()).then(|| rms(square + 1)),
                time: None,
            }
        };
        let mut of_scheme = |sizes: &Range<u32>| {
            sizes.clone().zip(&mut squares).map(&mut point).collect::<Vec<_>>()
        };
        let points = sizes.iter().map(&mut of_scheme).collect();
        let sampled = Sampled {
            samples,
            failed: measured.failed,
            failures: measured.failures.iter().map(ToString::to_string).collect(),
            reference: candidates.reference.about().id.to_owned(),
            steps: base << reference,
            last_difference: rms(0),
            spread: rms(2),
        };
        Ok(Errors { sampled, of_reference, points })
    }
}

/// Function of the state.
type Value<'a> = Box<dyn Fn(&[f64]) -> f64 + Sync + 'a>;

/// Relative defects (C(y) − c)/c of a final state, one for each Casimir C of degree p that the
/// problem names or that was found, with c = e^{−p∫γ}C(y₀); relative to e^{−p∫γ} where c is zero.
fn defects<'a>(problem: &'a Problem<'a>, found: &'a [Form]) -> Vec<Value<'a>> {
    let integrals = problem.dampings().map(|damping| damping.integral(0.0, problem.t_end));
    let integrals: Vec<f64> = integrals.collect();
    // With friction those that still hold are among the laws of the problem.
    let found =
        found.iter().filter(|_| problem.friction.is_empty()).map(|form| form.law(String::new()));
    let laws = problem.laws.iter().cloned().chain(found).filter(|law| law.casimir);
    let defect = |law: ConformalLaw<'a>| -> Value<'a> {
        let decay = law.decay(&integrals);
        let at_end = decay * (law.value)(&problem.y0);
        let scale = if at_end == 0.0 { decay } else { at_end };
        Box::new(move |y| ((law.value)(y) - at_end) / scale)
    };
    laws.map(defect).collect()
}

/// Writes the squared differences of the reference from itself with half and a quarter of the
/// steps, and of neighbouring paths; then the squared error and the largest squared defect of every
/// point.
fn squares(view: &View<'_>, casimirs: &[Value<'_>], values: &mut [Row]) {
    let distance = |a: usize, b: usize| squared_distance(view.state(a), view.state(b), view.live);
    (values[0], values[1]) = (distance(0, 1), distance(1, 2));
    let (mut other, reference) = (view.live.paths().last().unwrap_or(0), view.state(0));
    for p in view.live.paths() {
        values[2][p] = reference.iter().map(|row| (row[p] - row[other]).powi(2)).sum();
        other = p;
    }
    for (run, pair) in (REFERENCES..).zip(values[REFERENCES..].chunks_exact_mut(2)) {
        pair[0] = distance(run, 0);
        for p in view.live.paths().filter(|_| !casimirs.is_empty()) {
            let y: Vec<f64> = view.state(run).iter().map(|row| row[p]).collect();
            let squares = casimirs.iter().map(|defect| defect(&y).powi(2));
            pair[1][p] = squares.fold(0.0, |most, square| crate::worse(square, most));
        }
    }
}

/// The root of a mean square between the ends of its bootstrap-t interval of 95 %, which fewer than
/// 32 paths do not have.
fn root_mean_square(squares: &CrossMoments, index: usize) -> [f64; 3] {
    let value = squares.mean(index).sqrt();
    let ends = match value == 0.0 {
        true => Some((0.0, 0.0)),
        false => root_mean_square_interval(squares, index),
    };
    let (lo, hi) = ends.unwrap_or((0.0, f64::INFINITY));
    [lo, value, hi]
}

/// Upper bound of the error at the finest of three step sizes from the root-mean-square differences
/// of successive ones, d₁ = |y_{4τ} − y_{2τ}| and d₀ = |y_{2τ} − y_τ|: the sum of the differences
/// that would follow, d₀/(2^p − 1) with p = log₂(d₁/d₀), at most 1 and at least ½, for the upper
/// end of d₀. Infinite if the differences do not fall.
fn left(before: f64, [_, last, most]: [f64; 3]) -> f64 {
    const FALLS: f64 = 0.25;
    let p = log2(before / last);
    match last {
        0.0 => 0.0,
        _ if p >= FALLS => most.max(last) / (exp2(p.clamp(0.5, 1.0)) - 1.0),
        _ => f64::INFINITY,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_follows_a_difference_is_bounded_where_differences_fall() {
        let of = |before: f64, last: f64| left(before, [last, last, last]);
        // Order one leaves the last difference, order ½ 1/(√2 − 1) of it, and no order is trusted
        // beyond one.
        assert_eq!((of(2.0, 1.0), of(8.0, 1.0), of(1.0, 0.0)), (1.0, 1.0, 0.0));
        assert!((of(2f64.sqrt(), 1.0) - (1.0 + 2f64.sqrt())).abs() < 1e-12);
        assert!(of(1.1, 1.0).is_infinite() && of(1.0, f64::NAN).is_infinite());
        assert_eq!(left(2.0, [0.5, 1.0, 1.5]), 1.5);
    }
}
