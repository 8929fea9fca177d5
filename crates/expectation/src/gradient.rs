//! Derivatives of expectations with respect to parameters, along paths.
//!
//! Paths of the problem and of nearby ones, in each of which one parameter is changed a little, go
//! side by side on the same noise. The difference of φ over the change is a sample of the
//! derivative. Its error is of the order of the [distance](Expect::distances) of nearby states over
//! their size, for fields and φ without jumps. Levels and Sobol points serve derivatives as they
//! serve values.

use std::sync::Arc;

use noise::{StepNoise, StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{PathMask, Row, golden};
use schemes::{About, Method, Step, Stepper};
use stats::{Warning as Message, worse};
use systems::Damping;

use super::{Candidate, Expect, Expectation, Warning, WarningKind, short};
use mc::{Observe, Problem, RunError, Setup};

/// A problem in which one parameter is changed a little.
pub struct Nearby<'a> {
    /// Name of the parameter.
    pub parameter: String,
    /// The change of the parameter.
    pub change: f64,
    /// Difference of the parameter in the problem from the wanted one, small beside the change.
    pub offset: f64,
    /// Part of the derivative that curvature may add, if it is known to be more than 10⁻⁶.
    pub curvature: f64,
    /// Expectations of the changed problem, by the same schemes.
    pub expect: Expect<'a>,
    /// The test functions, which may depend on the parameter.
    pub observables: Vec<&'a dyn Observe>,
}

impl Nearby<'_> {
    /// Error that the change leaves of the derivative `slope` of φ: 10⁻⁶ of it, or what curvature
    /// is known to add, and the rounding errors of φ over the change.
    fn left(&self, steps: f64, phi: f64, slope: f64) -> f64 {
        let rounding = ROUND_OFF * (0.5 * steps.sqrt()).max(1.0) * phi.abs();
        self.curvature.max(CURVATURE) * slope.abs() + rounding / self.change.abs()
    }
}

/// Whether samples for the rest of the accuracy are drawn.
fn is_within(least: f64, accuracy: f64) -> bool {
    least <= 0.5 * accuracy
}

/// Distance of nearby states, over their size, that a pilot takes for close.
const APART: f64 = 1e-3;
/// Part of a derivative that curvature may add at distances of 10⁻⁷ or 10⁻⁶.
const CURVATURE: f64 = 1e-6;
/// Rounding errors of φ over it; of n steps √n/2 times as much, as those of values are bounded.
const ROUND_OFF: f64 = 64.0 * f64::EPSILON;
/// Distance of initial values, over their size, by which growth is seen.
const SEPARATION: f64 = 1e-10;
/// Numbers of steps by which distances are found, the first that keeps nearby states close.
const PILOTS: [u64; 4] = [64, 512, 4096, 32_768];

impl<'a> Expect<'a> {
    /// Adds ∂E\[φ(y(T))\]/∂θ for every φ and the parameter θ of each nearby problem, to the same
    /// accuracy: [`Expectation::gradient`](super::Expectation::gradient).
    ///
    /// φ must have no jumps: paths do not see them. Where paths at θ and nearby separate, as in
    /// chaos over long times, few samples carry the variance: see [`Judged`](super::Judged).
    ///
    /// # Errors
    /// [`RunError::Setting`] if a nearby problem has other schemes. Laws of random initial values
    /// must not depend on parameters, and are not looked at.
    pub fn with_gradient(mut self, nearby: Vec<Nearby<'a>>) -> Result<Self, RunError> {
        let ids = |expect: &Expect<'_>| -> Vec<&str> {
            expect.candidates.iter().map(|one| one.setup.scheme.about().id).collect()
        };
        if let Some(one) = nearby.iter().find(|one| ids(&one.expect) != ids(&self)) {
            let why = "the nearby problem has other schemes: choose one that both have";
            return Err(RunError::Setting(format!("derivative by {}: {why}", one.parameter)));
        }
        for (k, candidate) in self.candidates.iter_mut().enumerate() {
            let problem = &candidate.setup.problem;
            let beside = |method: &Arc<dyn Method + 'a>, is_mirror: bool| {
                let near = |one: &Nearby<'a>| {
                    let Candidate { setup, mirror, .. } = &one.expect.candidates[k];
                    let method = mirror.as_ref().filter(|_| is_mirror).unwrap_or(&setup.scheme);
                    Near::new(problem, &setup.problem, method)
                };
                SideBySide::of(method, problem, nearby.iter().map(near).collect())
            };
            let mirror = candidate.mirror.as_ref().map(|mirror| beside(mirror, true));
            let scheme = beside(&candidate.setup.scheme, false);
            (candidate.setup.scheme, candidate.mirror) = (scheme, mirror);
        }
        self.parameters.extend(nearby);
        Ok(self)
    }

    /// Adds to the bounds of the bias what the changes of parameters leave: of each derivative what
    /// is too much for samples to be drawn for the rest of the accuracy, of each value its offset,
    /// which is taken out.
    pub(super) fn bound(&self, found: &mut Expectation) {
        let t_end = self.candidates[0].setup.problem.t_end;
        let steps = found.levels.iter().map(|level| t_end / level.tau).fold(1.0, f64::max);
        for (one, (_, slopes)) in self.parameters.iter().zip(&mut found.gradient) {
            // One without a mean has no bound.
            for (own, slope) in
                found.estimates.iter_mut().zip(slopes).filter(|(_, slope)| slope.value.is_finite())
            {
                let least = one.left(steps, own.value, slope.value);
                let was_reached = slope.half_width() <= found.accuracy;
                if !is_within(least, found.accuracy) {
                    slope.bias_bound += least;
                }
                if was_reached && slope.half_width() > found.accuracy {
                    let what = "the change of the parameter alone leaves an error";
                    let message = Message::new(format!("{what} up to {}", short(least)))
                        .with_remedy("ask for less accurate derivatives");
                    Warning { kind: WarningKind::Level, observables: vec![], message }
                        .add_to(&mut found.warnings, &slope.name);
                }
                let shift = slope.value * one.offset;
                own.value -= shift;
                own.bias_bound += shift.abs();
            }
        }
    }

    /// Error that the change of a parameter leaves of test function number k of `number`, with its
    /// value, if it is a derivative and half of the accuracy is more; `value_of` has the others.
    pub(super) fn beside(
        &self,
        (k, number): (usize, usize),
        (steps, accuracy): (f64, f64),
        value: f64,
        value_of: impl Fn(usize) -> f64,
    ) -> f64 {
        let plain = number / (1 + self.parameters.len());
        let Some(slope) = k.checked_sub(plain) else { return 0.0 };
        let one = &self.parameters[slope / plain];
        let least = one.left(steps, value_of(slope % plain), value);
        if is_within(least, accuracy) { least } else { 0.0 }
    }

    /// Distances at T of what is nearby over its size, in the root mean square over 32 paths, for
    /// each parameter: the largest among the components and the test functions. 10⁻⁷ balances
    /// rounding errors and curvature. The size of a component is the largest on the way. Steps are
    /// as short as keeps states close, of some numbers. NaN where all paths fail. Areas are zero.
    pub fn distances(&self, observables: &[&dyn Observe]) -> Vec<f64> {
        let setup = &self.candidates[0].setup;
        let Apart { mut largest, rows, live, .. } =
            self.apart(setup, self.parameters.len(), &PILOTS);
        let (state, others) = rows.split_at(setup.problem.y0.len());
        let mut rounded = state.to_vec();
        for (n, row) in rounded.iter_mut().enumerate() {
            let part = f64::EPSILON * (4.0 * golden(n as f64 + 1.0) - 2.0);
            row.iter_mut().for_each(|y| *y += part * *y);
        }
        let nearby = self.parameters.iter().zip(others.chunks(state.len()));
        for (distance, (one, other)) in largest.iter_mut().zip(nearby) {
            for (phi, near) in observables.iter().zip(&one.observables) {
                let (rounded, near) = (phi.values(&rounded, live), near.values(other, live));
                let phi = phi.values(state, live);
                let finite = || live.paths().filter(|&p| phi[p].is_finite());
                let size = rms(finite().map(|p| phi[p]));
                // φ is zero but for rounding errors, and shows no distance.
                let noise = rms(finite().map(|p| rounded[p] - phi[p]));
                if noise > APART * size {
                    continue;
                }
                let apart = rms(finite().map(|p| near[p] - phi[p])) / size;
                // It is zero where all is, and far where φ is finite and not nearby.
                let apart = if apart.is_nan() && near != phi { f64::INFINITY } else { apart };
                *distance = distance.max(apart);
            }
        }
        largest
    }

    /// Factor by which the distance of paths grows until T, from 10⁻¹⁰ of the size of each
    /// component between their initial values: exponential where motion is chaotic.
    pub fn growth(&self) -> f64 {
        let mut setup = self.candidates[0].setup.clone();
        let Setup { problem, scheme } = &setup;
        let sizes = self.apart(&setup, 0, &PILOTS[1..]).sizes;
        let part = |i: usize| SEPARATION * golden(i as f64 + 1.0);
        let shift = (0..sizes.len()).map(|i| part(i) * sizes[i]).collect();
        let near = Near { method: Arc::clone(scheme), damping: problem.damping, shift };
        let begun = (0..sizes.len())
            .filter(|&i| sizes[i] > 0.0)
            .map(|i| part(i).powi(2))
            .sum::<f64>()
            .sqrt();
        setup.scheme = SideBySide::of(scheme, problem, vec![near]);
        self.apart(&setup, 1, &PILOTS[1..]).all[0] / begun
    }

    /// States side by side with `number` others, in the first number of steps that keeps them
    /// close.
    fn apart(&self, setup: &Setup<'_>, number: usize, pilots: &[u64]) -> Apart {
        let d = setup.problem.y0.len();
        let mut found = Apart::default();
        for &steps in pilots {
            let mut sizes = vec![0.0f64; d];
            let mut see = |rows: &[Row], live: PathMask| {
                for (size, row) in sizes.iter_mut().zip(rows) {
                    *size = size.max(rms(live.paths().map(|p| row[p])));
                }
            };
            let key = self.settings.key;
            let (rows, live) = march(setup, key, steps, &mut |_, rows, live| see(rows, live));
            see(&rows, live);
            let part = |k: usize, i: usize| {
                let apart = rms(live.paths().map(|p| rows[(k + 1) * d + i][p] - rows[i][p]));
                if apart == 0.0 && !live.is_empty() { 0.0 } else { apart / sizes[i] }
            };
            let parts = |k: usize| (0..d).map(move |i| part(k, i));
            let largest: Vec<f64> = (0..number).map(|k| parts(k).fold(0.0, worse)).collect();
            let all = (0..number).map(|k| parts(k).map(|x| x * x).sum::<f64>().sqrt()).collect();
            let close = largest.iter().all(|&distance| distance < APART);
            found = Apart { sizes, largest, all, rows, live };
            if close {
                break;
            }
        }
        found
    }

    /// The test functions on the rows of paths, and their derivatives.
    pub(super) fn with_slopes<'b>(&'b self, observables: &[&'b dyn Observe]) -> Vec<OnRows<'b>> {
        let dimension = self.candidates[0].setup.problem.y0.len();
        // Scores come after all rows of a path.
        let rows = self.scores.as_ref().map_or(dimension, |(first, _)| *first);
        let plain = |phi: &&'b dyn Observe| OnRows {
            name: phi.name().to_owned(),
            phi: *phi,
            rows,
            sample: None,
        };
        let slopes = self.parameters.iter().enumerate().flat_map(|(k, one)| {
            observables.iter().enumerate().map(move |(n, phi)| OnRows {
                name: format!("∂{}/∂{}", phi.name(), one.parameter),
                sample: Some(match &self.scores {
                    Some((first, centres)) => Sample::Weighted(first + k, centres[n]),
                    None => Sample::Difference(one.observables[n], (k + 1) * dimension, one.change),
                }),
                ..plain(phi)
            })
        });
        observables.iter().map(plain).chain(slopes).collect()
    }
}

/// States of a pilot side by side.
#[derive(Default)]
struct Apart {
    /// The largest size of each component on the way, in the root mean square over paths.
    sizes: Vec<f64>,
    /// Distances over these sizes at the end: the largest among components, and of all together.
    largest: Vec<f64>,
    all: Vec<f64>,
    /// The states at the end, and the paths that did not fail.
    rows: Vec<Row>,
    live: PathMask,
}

/// Root mean square; NaN of nothing.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(count, sum), x| (count + 1.0, sum + x * x));
    (sum / count).sqrt()
}

/// The last rows of 32 paths, and the paths that did not fail. `see` has the rows before each step.
pub(super) fn march(
    Setup { problem, scheme }: &Setup<'_>,
    key: StreamKey,
    steps: u64,
    see: &mut dyn FnMut(&Step, &[Row], PathMask),
) -> (Vec<Row>, PathMask) {
    let tau = problem.t_end / steps as f64;
    let mut paths = scheme.start(&problem.start(key, 0));
    let mut noise = scheme.no_noise(problem.noises);
    let mut wiener = WienerRows::new(key, 0);
    let (mut status, mut live) = (BlockStatus::explicit(), PathMask::ALL);
    for n in 0..steps {
        let Ok(step) = Step::new(problem.damping, n, tau) else { break };
        see(&step, paths.state(), live);
        wiener.increments(tau.sqrt(), &mut noise.increments);
        paths.step(&step, &noise, &mut status);
        live = live.without(status.failed);
    }
    (paths.state().to_vec(), live)
}

/// A test function of the rows of a path, or a sample of its derivative.
pub struct OnRows<'a> {
    name: String,
    phi: &'a dyn Observe,
    /// Number of rows that φ reads.
    rows: usize,
    sample: Option<Sample<'a>>,
}

/// A sample of a derivative.
enum Sample<'a> {
    /// The difference from the function nearby of rows from this one on, over the change of the
    /// parameter.
    Difference(&'a dyn Observe, usize, f64),
    /// The difference from a number, times the score in a row.
    Weighted(usize, f64),
}

impl Observe for OnRows<'_> {
    fn name(&self) -> &str {
        &self.name
    }

    fn evaluate(&self, y: &[Row], live: PathMask, values: &mut Row) {
        self.phi.evaluate(&y[..self.rows], live, values);
        match self.sample {
            Some(Sample::Difference(near, first, change)) => {
                let nearby = near.values(&y[first..first + self.rows], live);
                live.paths().for_each(|p| values[p] = (nearby[p] - values[p]) / change);
            }
            Some(Sample::Weighted(row, centre)) => {
                live.paths().for_each(|p| values[p] = (values[p] - centre) * y[row][p]);
            }
            None => {}
        }
    }

    fn is_smooth(&self) -> Option<bool> {
        match self.sample {
            Some(Sample::Weighted(..)) => None,
            _ => self.phi.is_smooth(),
        }
    }

    fn weak_order(&self) -> f64 {
        self.phi.weak_order()
    }
}

/// A method and nearby ones on the same noise, with the rows of all states.
pub struct SideBySide<'a> {
    /// Method of the problem.
    pub method: Arc<dyn Method + 'a>,
    /// Dimension of a state.
    pub dimension: usize,
    /// Nearby methods.
    pub nearby: Vec<Near<'a>>,
}

/// A method whose parameter is changed.
pub struct Near<'a> {
    /// Method of the nearby problem.
    pub method: Arc<dyn Method + 'a>,
    /// Damping of all components.
    pub damping: &'a dyn Damping,
    /// Difference of the initial values.
    pub shift: Vec<f64>,
}

impl<'a> SideBySide<'a> {
    /// The method of a problem beside nearby ones.
    pub fn of(
        method: &Arc<dyn Method + 'a>,
        problem: &Problem<'_>,
        nearby: Vec<Near<'a>>,
    ) -> Arc<dyn Method + 'a> {
        Arc::new(Self { method: Arc::clone(method), dimension: problem.y0.len(), nearby })
    }
}

impl<'a> Near<'a> {
    /// The method of a problem near another one.
    pub fn new(own: &Problem<'_>, near: &Problem<'a>, method: &Arc<dyn Method + 'a>) -> Self {
        let shift = own.y0.iter().zip(&near.y0).map(|(y, near)| near - y).collect();
        Self { method: Arc::clone(method), damping: near.damping, shift }
    }
}

impl Method for SideBySide<'_> {
    fn about(&self) -> About {
        self.method.about()
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let (state, others) = y.split_at(self.dimension);
        let (mut rows, mut known) = (state.to_vec(), others.chunks(self.dimension));
        let mut all = vec![(self.method.start(state), None)];
        for Near { method, damping, shift } in &self.nearby {
            let shifted =
                || state.iter().zip(shift).map(|(row, shift)| row.map(|y| y + shift)).collect();
            let start = known.next().map_or_else(shifted, <[Row]>::to_vec);
            all.push((method.start(&start), Some(*damping)));
            rows.extend(start);
        }
        Box::new(Side { all, dimension: self.dimension, rows })
    }
}

/// A stepper with its damping; that of the first is in the steps.
type Damped<'a> = (Box<dyn Stepper + 'a>, Option<&'a dyn Damping>);

struct Side<'a> {
    all: Vec<Damped<'a>>,
    dimension: usize,
    rows: Vec<Row>,
}

impl Stepper for Side<'_> {
    fn state(&self) -> &[Row] {
        &self.rows
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let mut failed = PathMask::default();
        let mut own = BlockStatus::explicit();
        let states = self.rows.chunks_mut(self.dimension);
        for ((stepper, damping), rows) in self.all.iter_mut().zip(states).rev() {
            stepper.state_mut().copy_from_slice(rows);
            let changed = damping.and_then(|of| Step::new(of, step.number(), step.tau).ok());
            stepper.step(changed.as_ref().unwrap_or(step), noise, &mut own);
            rows.copy_from_slice(stepper.state());
            failed = failed.or(own.failed);
        }
        *status = own;
        status.failed = failed;
    }

    fn rests(&mut self, live: PathMask) -> bool {
        let mut all = true;
        for (stepper, _) in &mut self.all {
            all &= stepper.rests(live);
        }
        all
    }
}
