//! Derivatives of expectations by likelihood ratios, for functions that jump and for events.
//!
//! Where the drift b depends on θ and the fields fₘ = B∇Hₘ do not, and ∂b/∂θ = Σ uₘfₘ, the change
//! of θ is a change of the measure (Girsanov): ∂E\[φ\]/∂θ = E\[(φ − c)S\] with the score
//! S = Σₘ∫uₘdWₘ (Itô) and any number c, here E\[φ\] of a pilot. φ is that of a path, and may jump.

use std::sync::Arc;

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{PathMask, Row, Rows, WIDTH};
use schemes::{About, Method, Step, Stepper};
use systems::run_time::{Op, System, Weights};

use super::{
    Expect,
    gradient::{Nearby, march},
};
use mc::{Observe, Problem, RunError};

/// Largest number of noises whose span is sought.
const MAX_NOISES: usize = 8;
/// Steps of the pilot, in which the span is tested and means are found.
const PILOT: u64 = 64;
/// Largest size of what is not in the span over that of the change of the drift.
const OUTSIDE: f64 = 1e-4;
/// Largest change of the fields of noises over them.
const ROUNDING: f64 = 1e-11;
/// Size of a pivot over the largest one below which a direction is one of those before.
const SINGULAR: f64 = 1e-12;

impl<'a> Expect<'a> {
    /// Adds ∂E\[φ\]/∂θ for every φ, of paths, and the parameter θ of each nearby problem by
    /// likelihood ratios. `systems` are those of this problem and of the nearby ones. φ must not
    /// depend on θ.
    ///
    /// # Errors
    /// [`RunError::Setting`] if θ changes the initial value or a noise, or if it changes the drift
    /// in other directions than those of the noises, as far as 32 paths show.
    pub fn with_scores(
        mut self,
        observables: &[&dyn Observe],
        (own, nearby): (&'a dyn System, Vec<(Nearby<'a>, &'a dyn System)>),
    ) -> Result<Self, RunError> {
        let problem = self.candidates[0].setup.problem.clone();
        let refused = |name: &str, why: &str| {
            RunError::Setting(format!("no likelihood ratio for a derivative by {name}: {why}"))
        };
        let mut laws = vec![Law { system: own, problem: problem.clone(), change: 0.0 }];
        for (one, system) in nearby {
            let near = one.expect.candidates[0].setup.problem.clone();
            if near.y0 != problem.y0 {
                return Err(refused(&one.parameter, "it changes the initial value"));
            }
            if problem.noises > MAX_NOISES {
                let why = format!("there are {} noises, at most {MAX_NOISES}", problem.noises);
                return Err(refused(&one.parameter, &why));
            }
            laws.push(Law { system, problem: near, change: one.change });
            self.parameters.push(Nearby { curvature: 0.0, observables: Vec::new(), ..one });
        }
        let laws: Arc<[Law<'a>]> = laws.into();
        for candidate in &mut self.candidates {
            let scored = |method: &Arc<dyn Method + 'a>| -> Arc<dyn Method + 'a> {
                Arc::new(Scored { method: Arc::clone(method), laws: Arc::clone(&laws) })
            };
            candidate.mirror = candidate.mirror.as_ref().map(scored);
            candidate.setup.scheme = scored(&candidate.setup.scheme);
        }
        let (rows, live) =
            self.pilot(&laws).map_err(|(k, why)| refused(&self.parameters[k].parameter, why))?;
        let first = rows.len() - self.parameters.len();
        let count = live.paths().count().max(1) as f64;
        self.scores = Some((
            first,
            observables
                .iter()
                .map(|phi| {
                    let values = phi.values(&rows[..first], live);
                    live.paths().map(|p| values[p]).sum::<f64>() / count
                })
                .collect(),
        ));
        Ok(self)
    }

    /// The last rows of 32 paths, and the paths that did not fail; or the number of a parameter
    /// that has no score, and the reason.
    fn pilot(&self, laws: &[Law<'_>]) -> Result<(Vec<Row>, PathMask), (usize, &'static str)> {
        let mut scores = Scores::new(laws);
        // Squares of what each component has outside of the span, and of what it may have.
        let mut squares = vec![vec![[0.0; 2]; scores.own.len()]; laws.len() - 1];
        let found =
            march(&self.candidates[0].setup, self.settings.key, PILOT, &mut |step, y, live| {
                scores.at(step.t, y);
                for (one, squares) in scores.parameters.iter().zip(&mut squares) {
                    scores.add_squares(one, live, squares);
                }
            });
        let exceeds = |&[square, allowed]: &[f64; 2]| square > allowed || square.is_nan();
        for (k, squares) in squares.iter().enumerate() {
            let (drifts, noises) = squares.split_at(scores.dimension);
            if noises.iter().any(exceeds) {
                return Err((k, "it changes a noise"));
            }
            if drifts.iter().any(exceeds) {
                return Err((k, "it changes the drift in directions in which no noise acts"));
            }
        }
        Ok(found)
    }
}

/// A system with its damping and friction.
struct Law<'a> {
    system: &'a dyn System,
    problem: Problem<'a>,
    /// The change of the parameter.
    change: f64,
}

impl Law<'_> {
    /// Writes the drift B∇H₀ − Γy, or the field of noise number k − 1.
    fn field(&self, k: usize, t: f64, y: &[Row], out: &mut [Row], rows: &mut [Row]) {
        let Problem { damping, friction, noises, .. } = &self.problem;
        let (v, rest) = rows.split_at_mut(y.len());
        let (dw, scratch) = rest.split_at_mut(*noises);
        (0..*noises).for_each(|m| dw[m] = [f64::from(u8::from(m + 1 == k)); WIDTH]);
        let h = Weights { t, dt: f64::from(u8::from(k == 0)), dw, areas: &[] };
        self.system.apply(Op::Gradient { y }, 0..y.len(), h, v, scratch);
        self.system.apply(Op::Structure { y, v }, 0..y.len(), h, out, scratch);
        if k > 0 {
            return;
        }
        let mut damp = |i: usize, rate: f64| (0..WIDTH).for_each(|p| out[i][p] -= rate * y[i][p]);
        (0..y.len()).for_each(|i| damp(i, damping.rate(t)));
        for one in *friction {
            one.components.iter().for_each(|&i| damp(i, one.damping.rate(t)));
        }
    }
}

/// Changes of the coefficients by a parameter, at the states of 32 paths.
struct Changed<'a> {
    law: &'a Law<'a>,
    /// ∂b/∂θ, and the changes of the fields of noises.
    coefficients: Vec<Row>,
    /// The factors uₘ of the noises in ∂b/∂θ.
    factors: Vec<Row>,
}

/// The coefficients at the states of 32 paths, with what parameters change.
struct Scores<'a> {
    law: &'a Law<'a>,
    dimension: usize,
    noises: usize,
    /// The drift and the fields of noises.
    own: Vec<Row>,
    parameters: Vec<Changed<'a>>,
    scratch: Rows,
}

impl<'a> Scores<'a> {
    fn new(laws: &'a [Law<'a>]) -> Self {
        let Problem { y0, noises, .. } = &laws[0].problem;
        let (d, noises) = (y0.len(), *noises);
        let scratch = laws.iter().map(|law| law.system.description().scratch_rows()).max();
        let rows = |count: usize| vec![[0.0; WIDTH]; count];
        let own = rows(d * (noises + 1));
        let changed = |law| Changed { law, coefficients: own.clone(), factors: rows(noises) };
        Self {
            law: &laws[0],
            dimension: d,
            noises,
            parameters: laws[1..].iter().map(changed).collect(),
            own,
            scratch: Rows::zero(d + noises + scratch.unwrap_or(0)),
        }
    }

    /// Finds ∂b/∂θ and u at the time t and the first rows of y.
    fn at(&mut self, t: f64, y: &[Row]) {
        let (d, noises) = (self.dimension, self.noises);
        let y = &y[..d];
        for (k, own) in self.own.chunks_mut(d).enumerate() {
            self.law.field(k, t, y, own, &mut self.scratch);
        }
        for Changed { law, coefficients, .. } in &mut self.parameters {
            for (k, (change, own)) in coefficients.chunks_mut(d).zip(self.own.chunks(d)).enumerate()
            {
                law.field(k, t, y, change, &mut self.scratch);
                let over = if k == 0 { law.change } else { 1.0 };
                change
                    .as_flattened_mut()
                    .iter_mut()
                    .zip(own.as_flattened())
                    .for_each(|(x, own)| *x = (*x - own) / over);
            }
        }
        let fields = &self.own[d..];
        for p in 0..WIDTH {
            let mut gram = [[0.0; MAX_NOISES]; MAX_NOISES];
            // Fields of length one, since noises have units of their own.
            let mut units = [0.0; MAX_NOISES];
            for (m, unit) in units[..noises].iter_mut().enumerate() {
                let length = (0..d).map(|i| fields[m * d + i][p].powi(2)).sum::<f64>().sqrt();
                *unit = if length > 0.0 { 1.0 / length } else { 0.0 };
            }
            for (m, l) in (0..noises).flat_map(|m| (0..=m).map(move |l| (m, l))) {
                let field = |m: usize, i: usize| units[m] * fields[m * d + i][p];
                gram[m][l] = (0..d).map(|i| field(m, i) * field(l, i)).sum();
            }
            cholesky(&mut gram, noises);
            for Changed { coefficients: drift, factors, .. } in &mut self.parameters {
                let mut u = [0.0; MAX_NOISES];
                for (m, u) in u[..noises].iter_mut().enumerate() {
                    *u = (0..d).map(|i| units[m] * fields[m * d + i][p] * drift[i][p]).sum();
                }
                solve(&gram, &mut u[..noises]);
                (0..noises).for_each(|m| factors[m][p] = units[m] * u[m]);
            }
        }
    }

    /// Adds Σ uₘΔWₘ to the score of each parameter.
    fn add(&self, noise: &StepNoise, scores: &mut [Row]) {
        for (one, score) in self.parameters.iter().zip(scores) {
            for (u, dw) in one.factors.iter().zip(&*noise.increments) {
                (0..WIDTH).for_each(|p| score[p] += u[p] * dw[p]);
            }
        }
    }

    /// Adds squares over paths for a parameter with those that are allowed: of each component of
    /// ∂b/∂θ − Σ uₘfₘ a part of ∂b/∂θ and rounding errors; then of the changes of the components of
    /// the fields of noises, rounding errors.
    fn add_squares(&self, one: &Changed<'_>, live: PathMask, sums: &mut [[f64; 2]]) {
        let (d, noises) = (self.dimension, self.noises);
        for p in live.paths() {
            for (n, [square, allowed]) in sums.iter_mut().enumerate() {
                let (change, own) = (one.coefficients[n][p], self.own[n][p]);
                if n >= d {
                    *square += change.powi(2);
                    *allowed += (ROUNDING * own).powi(2);
                    continue;
                }
                let term = |m: usize| one.factors[m][p] * self.own[(m + 1) * d + n][p];
                let inside: f64 = (0..noises).map(term).sum();
                let terms: f64 = (0..noises).map(|m| term(m).powi(2)).sum();
                let own = own / one.law.change;
                let rounding = ROUNDING * ROUNDING * (terms + own * own);
                *square += (change - inside).powi(2);
                *allowed += OUTSIDE * OUTSIDE * change * change + rounding;
            }
        }
    }
}

/// Cholesky's factor L of a positive semidefinite matrix, in its lower half. A direction that is
/// one of those before has a zero on the diagonal.
fn cholesky(a: &mut [[f64; MAX_NOISES]; MAX_NOISES], n: usize) {
    let largest = (0..n).map(|m| a[m][m]).fold(0.0, f64::max);
    for m in 0..n {
        for l in 0..=m {
            let sum = a[m][l] - (0..l).map(|k| a[m][k] * a[l][k]).sum::<f64>();
            a[m][l] = match l == m {
                true if sum <= SINGULAR * largest => 0.0,
                true => sum.sqrt(),
                false => over(sum, a[l][l]),
            };
        }
    }
}

/// A quotient; zero of a direction that is zero.
fn over(x: f64, pivot: f64) -> f64 {
    if pivot == 0.0 { 0.0 } else { x / pivot }
}

/// Solves LLᵀu = b in place; components of directions that are zero in L are zero.
fn solve(l: &[[f64; MAX_NOISES]; MAX_NOISES], u: &mut [f64]) {
    let n = u.len();

    for m in 0..n {
        u[m] = over(u[m] - (0..m).map(|k| l[m][k] * u[k]).sum::<f64>(), l[m][m]);
    }
    for m in (0..n).rev() {
        u[m] = over(u[m] - (m + 1..n).map(|k| l[k][m] * u[k]).sum::<f64>(), l[m][m]);
    }
}

/// A method whose rows end with the scores of parameters.
struct Scored<'a> {
    method: Arc<dyn Method + 'a>,
    /// The law of the paths, and those nearby.
    laws: Arc<[Law<'a>]>,
}

impl Method for Scored<'_> {
    fn about(&self) -> About {
        self.method.about()
    }

    /// Starts from rows with scores, or else with zero scores.
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let count = self.laws.len() - 1;
        let length = self.method.start(&y[..self.laws[0].problem.y0.len()]).state().len() + count;
        let (state, known) = y.split_at(if y.len() == length { length - count } else { y.len() });
        let inner = self.method.start(state);
        let mut rows = inner.state().to_vec();
        rows.extend_from_slice(known);
        rows.resize(length, [0.0; WIDTH]);
        Box::new(Scoring { inner, scores: Scores::new(&self.laws), rows })
    }
}

struct Scoring<'a> {
    inner: Box<dyn Stepper + 'a>,
    scores: Scores<'a>,
    rows: Vec<Row>,
}

impl Stepper for Scoring<'_> {
    fn state(&self) -> &[Row] {
        &self.rows
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let first = self.rows.len() - self.scores.parameters.len();
        let (state, scores) = self.rows.split_at_mut(first);
        self.scores.at(step.t, state);
        self.scores.add(noise, scores);
        self.inner.state_mut().copy_from_slice(state);
        self.inner.step(step, noise, status);
        state.copy_from_slice(self.inner.state());
    }

    fn rests(&mut self, live: PathMask) -> bool {
        self.inner.rests(live)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// b = Fc, so that Fu = b, and u is c where columns of F are independent. The last one is a
    /// combination of the others, and then has no part.
    #[test]
    fn factors_are_those_of_the_span() {
        let fields = [[1.0, 2.0, -1.0, 0.5], [0.3, -1.0, 2.0, 0.7], [0.0, 1.5, 0.4, -2.0]];
        let mixed = std::array::from_fn(|i| 0.2 * fields[0][i] - 1.7 * fields[2][i]);
        let c = [0.7, -1.1, 0.4];
        let b: [f64; 4] = std::array::from_fn(|i| (0..3).map(|m| c[m] * fields[m][i]).sum());
        let [a, d, e] = fields;
        for all in [vec![a, d, e], vec![a, d, e, mixed], vec![a, a, d, e]] {
            let n = all.len();
            let dot = |x: &[f64; 4], y: &[f64; 4]| (0..4).map(|i| x[i] * y[i]).sum::<f64>();
            let mut gram = [[0.0; MAX_NOISES]; MAX_NOISES];
            for (m, l) in (0..n).flat_map(|m| (0..n).map(move |l| (m, l))) {
                gram[m][l] = dot(&all[m], &all[l]);
            }
            let mut u: Vec<f64> = all.iter().map(|field| dot(field, &b)).collect();
            cholesky(&mut gram, n);
            solve(&gram, &mut u);
            for i in 0..4 {
                let found: f64 = (0..n).map(|m| u[m] * all[m][i]).sum();
                assert!((found - b[i]).abs() < 1e-13, "{u:?}");
            }
            assert_eq!(u.iter().filter(|u| **u == 0.0).count(), n - 3, "{u:?}");
        }
    }
}
