//! Quantities that a path collects along its way: the time, integrals over it, and the first
//! passage of a function through zero.
//!
//! [`Setup::collecting`] appends their rows to the states of a scheme, and their equations to the
//! coefficients of its problem, so that whatever reads states can read them: tables, studies,
//! expectations, orders and step checks.
//!
//! **First passage.** At the ends of steps alone a passage is seen too late: the bias is of order
//! √τ, since a path that noise drives may be beyond zero between two ends that are not. Given both
//! ends a, b < 0, a Brownian motion of variance rate s passes zero within the step with the
//! probability exp(−2ab/(sτ)) (Gobet 2000), which leaves a bias of order τ. Of its time t within
//! the step, t/(τ − t) is inverse Gaussian with the mean |a/b| and λ = a²/(sτ), for any b (the
//! bridge is a Brownian motion with drift in that time; drawn as by Michael, Schucany and Haas
//! 1976). The random numbers for this come from the last bits of the increments of the step, which
//! are independent of their leading ones but for rounding. So streams are the same with and without
//! events. (What is clipped from increments counts, so that clipped paths have numbers of their
//! own.) Where no noise acts on the function, s is zero.

use std::sync::Arc;

use noise::{StepNoise, inverse_normal};
use nonlin::BlockStatus;
use real::{PathMask, Row, Rows, WIDTH, elementary::exp};
use schemes::{About, Method, Step, Stepper};
use systems::run_time::{Op, System, Weights};

use crate::{Coefficients, Observe, Problem, Setup, setup::CoefficientsAt};

/// A function of the states of 32 paths.
pub type OfStates = Arc<dyn Observe + Send + Sync>;

/// A quantity that a path collects.
#[derive(Clone)]
pub enum Along {
    /// The time t.
    Time,
    /// The integral ∫₀ᵗ v(y(s)) ds by the trapezoidal rule.
    Integral(OfStates),
    /// The first passage, two numbers: an indicator, one from the passage on and zero before; and
    /// the time of the passage, before it the time so far.
    Passage(Passage),
}

/// The first time at which a function is positive.
#[derive(Clone)]
pub struct Passage {
    /// The function φ.
    pub phi: OfStates,
    /// Writer of ∇φ; `None` if passages are seen at the ends of steps only, as they are for systems
    /// of several tiles.
    pub gradient: Option<Arc<Gradient>>,
    /// Whether the path stays where it is at the end of the step of its passage.
    pub stops: bool,
}

/// Gradient of a function: maps the states of 32 paths to its derivatives by each component.
pub type Gradient = dyn Fn(&[Row], &mut [Row]) + Send + Sync;

/// The variance rate s(y) = Σₘ(∇φ·B∇Hₘ)² of a function with this gradient, for a system with one
/// tile. Memory is allocated in the first call with these rows.
fn variance_rate(
    system: &dyn System,
    gradient: &Gradient,
    (y, t): (&[Row], f64),
    rows: &mut Vec<Row>,
) -> Row {
    let (d, description) = (y.len(), system.description());
    rows.resize(3 * d + description.noises + description.scratch_rows(), [0.0; WIDTH]);
    let (slope, rest) = rows.split_at_mut(d);
    let (v, rest) = rest.split_at_mut(d);
    let (field, rest) = rest.split_at_mut(d);
    let (dw, scratch) = rest.split_at_mut(description.noises);
    slope.fill([0.0; WIDTH]);
    gradient(y, slope);
    let mut rate = [0.0; WIDTH];
    for m in 0..description.noises {
        dw.fill([0.0; WIDTH]);
        dw[m] = [1.0; WIDTH];
        let h = Weights { t, dw, ..Weights::NONE };
        system.apply(Op::Gradient { y }, 0..d, h, v, scratch);
        system.apply(Op::Structure { y, v }, 0..d, Weights::NONE, field, scratch);
        for p in 0..WIDTH {
            let change: f64 = slope.iter().zip(&*field).map(|(a, b)| a[p] * b[p]).sum();
            rate[p] += change * change;
        }
    }
    rate
}

impl Along {
    /// Number of rows that the quantity has.
    pub fn rows(&self) -> usize {
        if let Self::Passage(_) = self { 2 } else { 1 }
    }

    /// Value of the followed function at the state and the quantities collected before; zero for
    /// the time.
    fn value(&self, rows: &[Row]) -> Row {
        match self {
            Self::Time => [0.0; WIDTH],
            Self::Integral(phi) | Self::Passage(Passage { phi, .. }) => {
                phi.values(rows, PathMask::ALL)
            }
        }
    }
}

impl<'a> Setup<'a> {
    /// Appends `quantities` to the states of the paths, row after row, behind the components.
    ///
    /// The system is that of the scheme. In the coefficients of the problem, the time has the drift
    /// 1, an integral that of its function; the dimension of the problem stays that of the state.
    #[must_use]
    pub fn collecting(self, system: &'a dyn System, quantities: Vec<Along>) -> Self {
        if quantities.is_empty() {
            return self;
        }
        let Self { problem: Problem { coefficients, damping, .. }, scheme: method } = self.clone();
        let of = quantities.clone();
        let coefficients = Arc::new(move |t: f64, y: &[f64]| {
            extended(&*coefficients, &of, damping.rate(t), (t, y))
        });
        let scheme = Arc::new(Collecting { method, system, quantities });
        Self { problem: Problem { coefficients, ..self.problem }, scheme }
    }
}

/// Coefficients extended by those of the quantities: dt for a time, φ dt for an integral, and dt
/// for the time of a passage until the passage. A path that stays where it is has zero
/// coefficients. Rows without damping get γy besides, which cancels the damping of the equation.
fn extended(
    of_state: &CoefficientsAt<'_>,
    quantities: &[Along],
    gamma: f64,
    (t, y): (f64, &[f64]),
) -> Coefficients {
    let rows = Rows::splat(y);
    let first = y.len() - quantities.iter().map(Along::rows).sum::<usize>();
    let (mut at, mut stays) = (of_state(t, &y[..first]), false);
    for quantity in quantities {
        let row = at.drift.len();
        match quantity {
            Along::Time => at.drift.push(1.0),
            Along::Integral(_) => at.drift.push(quantity.value(&rows)[0]),
            Along::Passage(passage) => {
                at.drift.extend([0.0, 1.0 - y[row]]);
                stays |= passage.stops && y[row] > 0.0;
            }
        }
    }
    let moving = if stays { 0 } else { first };
    at.drift[moving..first].fill(0.0);
    for of in at.noises.iter_mut().chain([&mut at.correction]) {
        of.truncate(moving);
        of.resize(y.len(), 0.0);
    }
    (moving..y.len()).for_each(|i| at.drift[i] += gamma * y[i]);
    at
}

/// The quantities that paths of a method collect.
struct Collecting<'a> {
    method: Arc<dyn Method + 'a>,
    /// System of the method.
    system: &'a dyn System,
    /// Collected quantities, row after row.
    quantities: Vec<Along>,
}

impl Method for Collecting<'_> {
    fn about(&self) -> About {
        self.method.about()
    }

    /// Starts with nothing collected so far, or with the rows that `y` has after the state.
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let (state, collected) = y.split_at(self.system.description().dimension);
        let inner = self.method.start(state);
        let before = inner.state().to_vec();
        let mut rows = [&before, collected].concat();
        for quantity in self.quantities.iter().filter(|_| collected.is_empty()) {
            if let Along::Passage(_) = quantity {
                let value = quantity.value(&rows);
                rows.push(value.map(|phi| f64::from(u8::from(phi > 0.0))));
            }
            rows.push([0.0; WIDTH]);
        }
        let values = vec![[0.0; WIDTH]; self.quantities.len()];
        Box::new(Collector {
            inner,
            of: self,
            before,
            rows,
            values: values.clone(),
            ends: values,
            scratch: Vec::new(),
            stopped: PathMask::NONE,
            is_set: true,
            rests: false,
        })
    }
}

struct Collector<'a> {
    inner: Box<dyn Stepper + 'a>,
    of: &'a Collecting<'a>,
    /// The state before the last step.
    before: Vec<Row>,
    /// The state and the collected quantities.
    rows: Vec<Row>,
    /// Values of the followed functions at the state.
    values: Vec<Row>,
    /// Values at the end of a step.
    ends: Vec<Row>,
    /// Scratch rows for variance rates.
    scratch: Vec<Row>,
    /// The paths that stay where they are.
    stopped: PathMask,
    /// Whether `rows` were set, so that all else follows from them.
    is_set: bool,
    /// Whether all live paths are stopped.
    rests: bool,
}

impl Collector<'_> {
    /// Sets the inner stepper, the values and the stopped paths from the rows.
    fn follow(&mut self) {
        let mut first = self.before.len();
        self.inner.state_mut().copy_from_slice(&self.rows[..first]);
        (self.stopped, self.is_set, self.rests) = (PathMask::NONE, false, false);
        for (quantity, value) in self.of.quantities.iter().zip(&mut self.values) {
            *value = quantity.value(&self.rows);
            if let Along::Passage(passage) = quantity {
                passage.stop(&self.rows[first], &mut self.stopped);
            }
            first += quantity.rows();
        }
    }
}

impl Stepper for Collector<'_> {
    fn state(&self) -> &[Row] {
        &self.rows
    }

    fn state_mut(&mut self) -> &mut [Row] {
        self.is_set = true;
        &mut self.rows
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        if self.is_set {
            self.follow();
        }
        let held = self.stopped;
        if self.rests {
            *status = BlockStatus::explicit();
        } else {
            self.inner.step(step, noise, status);
        }
        // A path that stays where it is makes no step that could fail.
        status.failed = status.failed.without(held);
        let Self { of: Collecting { system, quantities, .. }, before, values, ends, .. } = self;
        let (own, all) = (before.len(), &mut self.rows);
        before.copy_from_slice(&all[..own]);
        let state = self.inner.state_mut();
        for p in held.paths() {
            state.iter_mut().zip(&*before).for_each(|(y, before)| y[p] = before[p]);
        }
        all[..own].copy_from_slice(state);
        // The part of the step after which a path stops on a straight line.
        let (mut first, mut part) = (own, [1.0f64; WIDTH]);
        for ((quantity, value), next) in quantities.iter().zip(&*values).zip(&mut *ends) {
            *next = quantity.value(all);
            let rows = &mut all[first..first + quantity.rows()];
            first += rows.len();
            match (quantity, rows) {
                (Along::Time, [time]) => time.fill(step.t + step.tau),
                (Along::Integral(_), [sum]) => {
                    for p in 0..WIDTH {
                        sum[p] += step.tau * (0.5 * (value[p] + next[p]));
                    }
                }
                (Along::Passage(passage), [crossed, time]) => {
                    let straight = passage.advance(
                        *system,
                        before,
                        (value, next),
                        (step, noise, held),
                        [&mut *crossed, &mut *time],
                        &mut self.scratch,
                    );
                    passage.stop(crossed, &mut self.stopped);
                    for p in straight.and(self.stopped.without(held)).paths() {
                        part[p] = part[p].min((time[p] - step.t) / step.tau);
                    }
                }
                _ => unreachable!("each quantity has its number of rows"),
            }
        }
        let early = PathMask::of(|p| part[p] < 1.0);
        if !early.is_empty() {
            for (y, before) in all[..own].iter_mut().zip(&*before) {
                early.paths().for_each(|p| y[p] = before[p] + part[p] * (y[p] - before[p]));
            }
            first = own;
            for ((quantity, value), next) in quantities.iter().zip(&*values).zip(&mut *ends) {
                let held = quantity.value(all);
                if let Along::Integral(_) = quantity {
                    for p in early.paths() {
                        let moving = 0.5 * (value[p] + held[p]) - held[p];
                        let whole = 0.5 * (value[p] + next[p]) - held[p];
                        all[first][p] += step.tau * (part[p] * moving - whole);
                    }
                }
                first += quantity.rows();
                *next = held;
            }
        }
        std::mem::swap(values, ends);
    }

    fn rests(&mut self, live: PathMask) -> bool {
        self.rests = live.without(self.stopped).is_empty();
        self.rests
    }
}

impl Passage {
    /// Adds the paths that have passed to `stopped`, if paths stay where they passed.
    fn stop(&self, crossed: &Row, stopped: &mut PathMask) {
        if self.stops {
            *stopped = stopped.or(PathMask::of(|p| crossed[p] > 0.0));
        }
    }

    /// Marks the paths that pass zero within a step from `before`, with φ at both ends. Those that
    /// are `held` where they are pass by the time alone. Returns those that pass with φ on a
    /// straight line, as no noise moves it.
    fn advance(
        &self,
        system: &dyn System,
        before: &[Row],
        (a, b): (&Row, &Row),
        (step, noise, held): (&Step, &StepNoise, PathMask),
        [crossed, time]: [&mut Row; 2],
        scratch: &mut Vec<Row>,
    ) -> PathMask {
        let open = PathMask::of(|p| crossed[p] == 0.0);
        let moves = !open.without(held).is_empty();
        let middle = (before, step.t + 0.5 * step.tau);
        let rate = match &self.gradient {
            Some(gradient) if moves => variance_rate(system, &**gradient, middle, scratch),
            _ => [0.0; WIDTH],
        };
        let mut straight = PathMask::NONE;
        for p in open.paths() {
            let variance = if held.contains(p) { 0.0 } else { rate[p] * step.tau };
            let (a, b) = (a[p], b[p]);
            let mut word = word(noise, step, p);
            let mut next = || {
                word = mix(word);
                word
            };
            let uniform = |word: u64| ((word >> 11) as f64 + 0.5) * 2f64.powi(-53);
            let between = |u: f64| variance > 0.0 && u < exp(-2.0 * a * b / variance);
            if b <= 0.0 && !between(uniform(next())) {
                time[p] = step.t + step.tau;
                continue;
            }
            let mean = (a / b).abs();
            // c = mean·χ²/2λ; zero without noise, where a straight line passes.
            let chi = inverse_normal(next());
            let c = 0.5 * mean * chi * chi * variance / (a * a).max(f64::MIN_POSITIVE);
            let root = 1.0 + c + (c * (c + 2.0)).sqrt();
            let ratio =
                if uniform(next()) * (1.0 + root) < root { mean / root } else { mean * root };
            crossed[p] = 1.0;
            time[p] = step.t + step.tau / (1.0 + 1.0 / ratio);
            if variance == 0.0 && self.gradient.is_some() {
                straight.insert(p);
            }
        }
        straight
    }
}

/// A random number from the bits of the increments of path p in a step.
fn word(noise: &StepNoise, step: &Step, p: usize) -> u64 {
    let first = step.number() ^ noise.clipped.get(p).copied().unwrap_or_default();
    noise.increments.iter().fold(first, |hash, row| mix(hash ^ row[p].to_bits()))
}

/// The next number of SplitMix64 after the state x.
fn mix(x: u64) -> u64 {
    noise::mix(x.wrapping_add(noise::GOLDEN))
}

#[cfg(test)]
mod tests {
    use systems::{RigidBody, run_time::Compiled};

    use super::*;

    /// ∇Hₘ = yₘeₘ/Îₘ and B(y)v = ±y × v, so that the first component of the field of H₂ is
    /// ∓y₂y₃/Î₂, that of H₃ ±y₂y₃/Î₃, and H₁ has none.
    #[test]
    fn variance_rates_are_sums_over_noises_whatever_the_rows_had() {
        let (y, moments) = ([0.3, 0.5, 0.7], [1.0, 2.0, 4.0]);
        let body = Compiled::new(RigidBody::three_noises([1.0; 3], moments).unwrap(), y);
        let (y, mut rows) = (y.map(|y| [y; WIDTH]), Vec::new());
        let all = |_: &[Row], slope: &mut [Row]| slope.fill([1.0; WIDTH]);
        let one = |_: &[Row], slope: &mut [Row]| slope[0] = [1.0; WIDTH];
        variance_rate(&body, &all, (&y, 0.0), &mut rows);
        let found = variance_rate(&body, &one, (&y, 0.0), &mut rows);
        let [second, third] = [2.0, 4.0].map(|moment| 0.5 * 0.7 / moment);
        let exact: f64 = second * second + third * third;
        assert!(found.iter().all(|rate| (rate - exact).abs() < 1e-15), "{found:?} {exact}");
    }
}
