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
    gradient::{Nearby, Parameter, Slope, march},
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
        let mut laws = vec![Law { system: own, problem: problem.clone() }];
        for (Nearby { parameter, change, offset, expect, .. }, system) in nearby {
            let near = expect.candidates[0].setup.problem.clone();
            if near.y0 != problem.y0 {
                return Err(refused(&parameter, "it changes the initial value"));
            }
            if problem.noises > MAX_NOISES {
                let why = format!("there are {} noises, at most {MAX_NOISES}", problem.noises);
                return Err(refused(&parameter, &why));
            }
            laws.push(Law { system, problem: near });
            let slope = Slope::Score { row: 0, centres: vec![0.0; observables.len()] };
            let (name, curvature) = (parameter, 0.0);
            self.parameters.push(Parameter { name, change, offset, curvature, slope });
        }
        let changes: Arc<[f64]> = self.parameters.iter().map(|one| one.change).collect();
        let laws: Arc<[Law<'a>]> = laws.into();
        for candidate in &mut self.candidates {
            let scored = |method: &Arc<dyn Method + 'a>| -> Arc<dyn Method + 'a> {
                let (laws, changes) = (Arc::clone(&laws), Arc::clone(&changes));
                Arc::new(Scored { method: Arc::clone(method), laws, changes })
            };
            candidate.mirror = candidate.mirror.as_ref().map(scored);
            candidate.setup.scheme = scored(&candidate.setup.scheme);
        }
        let (rows, live) = self
            .pilot(&laws, &changes)
            .map_err(|(k, why)| refused(&self.parameters[k].name, why))?;
        let first = rows.len() - changes.len();
        let count = live.paths().count().max(1) as f64;
        let means = observables.iter().map(|phi| {
            let values = phi.values(&rows[..first], live);
            live.paths().map(|p| values[p]).sum::<f64>() / count
        });
        let means: Vec<f64> = means.collect();
        for (k, parameter) in self.parameters.iter_mut().enumerate() {
            parameter.slope = Slope::Score { row: first + k, centres: means.clone() };
        }
        Ok(self)
    }

    /// The last rows of 32 paths, and the paths that did not fail; or the number of a parameter
    /// that has no score, and the reason.
    fn pilot(
        &self,
        laws: &[Law<'_>],
        changes: &[f64],
    ) -> Result<(Vec<Row>, PathMask), (usize, &'static str)> {
        let mut scores = Scores::new(laws, changes);
        // Squares of what each component has outside of the span, and of what it may have.
        let mut squares = vec![Vec::new(); changes.len()];
        let mut see = |step: &Step, y: &[Row], live: PathMask| {
            scores.at(step.t, y);
            for (k, squares) in squares.iter_mut().enumerate() {
                scores.add_squares(k, live, squares);
            }
        };
        let found = march(&self.candidates[0].setup, self.settings.key, PILOT, &mut see);
        let exceeds = |&[square, allowed]: &[f64; 2]| square > allowed || square.is_nan();
        for (k, squares) in squares.into_iter().enumerate() {
            let (drifts, noises) = squares.split_at(scores.dimension.min(squares.len()));
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

/// Factors uₘ of the noises in the changes of the drift, at the states of 32 paths.
struct Scores<'a> {
    laws: &'a [Law<'a>],
    changes: &'a [f64],
    dimension: usize,
    noises: usize,
    /// The drift and the fields of noises; and those of the nearby problem.
    own: Vec<Row>,
    near: Vec<Row>,
    /// ∂b/∂θ and u of each parameter.
    drifts: Vec<Row>,
    factors: Vec<Row>,
    /// Changes of the fields of noises.
    changed: Vec<Row>,
    scratch: Rows,
}

impl<'a> Scores<'a> {
    fn new(laws: &'a [Law<'a>], changes: &'a [f64]) -> Self {
        let (d, noises) = (laws[0].problem.y0.len(), laws[0].problem.noises);
        let scratch = laws.iter().map(|law| law.system.description().scratch_rows()).max();
        let rows = |count: usize| vec![[0.0; WIDTH]; count];
        Self {
            laws,
            changes,
            dimension: d,
            noises,
            own: rows(d * (noises + 1)),
            near: rows(d),
            drifts: rows(d * changes.len()),
            factors: rows(noises * changes.len()),
            changed: rows(d * noises * changes.len()),
            scratch: Rows::zero(d + noises + scratch.unwrap_or(0)),
        }
    }

    /// Finds ∂b/∂θ and u at the time t and the first rows of y.
    fn at(&mut self, t: f64, y: &[Row]) {
        let (d, noises) = (self.dimension, self.noises);
        let y = &y[..d];
        for k in 0..=noises {
            self.laws[0].field(k, t, y, &mut self.own[k * d..(k + 1) * d], &mut self.scratch);
        }
        for (k, (law, change)) in self.laws[1..].iter().zip(self.changes).enumerate() {
            for m in (0..=noises).rev() {
                law.field(m, t, y, &mut self.near, &mut self.scratch);
                let pairs = self.near.iter().zip(&self.own[m * d..(m + 1) * d]);
                for (i, (near, own)) in pairs.enumerate() {
                    for p in 0..WIDTH {
                        let difference = near[p] - own[p];
                        match m {
                            0 => self.drifts[k * d + i][p] = difference / change,
                            _ => self.changed[(k * noises + m - 1) * d + i][p] = difference,
                        }
                    }
                }
            }
        }
        let (fields, count) = (&self.own[d..], self.changes.len());
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
            for k in 0..count {
                let mut u = [0.0; MAX_NOISES];
                for (m, u) in u[..noises].iter_mut().enumerate() {
                    let product =
                        |i: usize| units[m] * fields[m * d + i][p] * self.drifts[k * d + i][p];
                    *u = (0..d).map(product).sum();
                }
                solve(&gram, &mut u[..noises]);
                (0..noises).for_each(|m| self.factors[k * noises + m][p] = units[m] * u[m]);
            }
        }
    }

    /// Adds Σ uₘΔWₘ to the score of each parameter.
    fn add(&self, noise: &StepNoise, scores: &mut [Row]) {
        for (factors, score) in self.factors.chunks(self.noises.max(1)).zip(scores) {
            for (u, dw) in factors.iter().zip(&*noise.increments) {
                (0..WIDTH).for_each(|p| score[p] += u[p] * dw[p]);
            }
        }
    }

    /// Adds squares over paths for parameter k with those that are allowed: of each component of
    /// ∂b/∂θ − Σ uₘfₘ a part of ∂b/∂θ and rounding errors; then of the changes of the components of
    /// the fields of noises, rounding errors.
    fn add_squares(&self, k: usize, live: PathMask, sums: &mut Vec<[f64; 2]>) {
        let (d, noises) = (self.dimension, self.noises);
        sums.resize(d * (noises + 1), [0.0; 2]);
        for p in live.paths() {
            for i in 0..d {
                let drift = self.drifts[k * d + i][p];
                let term =
                    |m: usize| self.factors[k * noises + m][p] * self.own[(m + 1) * d + i][p];
                let inside: f64 = (0..noises).map(term).sum();
                let terms: f64 = (0..noises).map(|m| term(m).powi(2)).sum();
                let own = self.own[i][p] / self.changes[k];
                let rounding = ROUNDING * ROUNDING * (terms + own * own);
                sums[i][0] += (drift - inside).powi(2);
                sums[i][1] += OUTSIDE * OUTSIDE * drift * drift + rounding;
            }
            for (n, [square, allowed]) in sums[d..].iter_mut().enumerate() {
                *square += self.changed[k * noises * d + n][p].powi(2);
                *allowed += (ROUNDING * self.own[d + n][p]).powi(2);
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
                false if a[l][l] == 0.0 => 0.0,
                false => sum / a[l][l],
            };
        }
    }
}

/// Solves LLᵀu = b in place; components of directions that are zero in L are zero.
fn solve(l: &[[f64; MAX_NOISES]; MAX_NOISES], u: &mut [f64]) {
    let n = u.len();
    let over = |x: f64, pivot: f64| if pivot == 0.0 { 0.0 } else { x / pivot };
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
    changes: Arc<[f64]>,
}

impl Method for Scored<'_> {
    fn about(&self) -> About {
        self.method.about()
    }

    /// Starts from rows with scores, or else with zero scores.
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let count = self.changes.len();
        let length = self.method.start(&y[..self.laws[0].problem.y0.len()]).state().len() + count;
        let (state, known) = y.split_at(if y.len() == length { length - count } else { y.len() });
        let inner = self.method.start(state);
        let mut rows = inner.state().to_vec();
        rows.extend_from_slice(known);
        rows.resize(length, [0.0; WIDTH]);
        Box::new(Scoring { inner, scores: Scores::new(&self.laws, &self.changes), rows })
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
        let first = self.rows.len() - self.scores.changes.len();
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
