//! Derivatives of expectations with respect to parameters, along paths.
//!
//! Paths of the problem and of nearby ones, in each of which one parameter is changed a little, go
//! side by side on the same noise. The difference of φ over the change is a sample of the
//! derivative. Its error is of the order of the [distance](Expect::distances) of nearby states over
//! their size, for fields and φ without jumps. Levels and Sobol points serve derivatives as they
//! serve values.

use std::{ops::Range, sync::Arc};

use noise::{StepNoise, StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{PathMask, Row, golden};
use schemes::{About, Method, Step, Stepper};
use systems::Damping;

use super::{Candidate, Expect, Expectation};
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

/// The parameters of derivatives.
pub struct Parameter<'a> {
    pub name: String,
    pub(super) change: f64,
    pub(super) offset: f64,
    pub(super) curvature: f64,
    pub(super) slope: Slope<'a>,
}

/// Samples of a derivative.
pub enum Slope<'a> {
    /// Differences along paths, with the test functions nearby.
    Along(Vec<&'a dyn Observe>),
    /// (φ − c)S with the score S in a row, and c of each test function.
    Score {
        /// The row of S.
        row: usize,
        /// The numbers c.
        centres: Vec<f64>,
    },
}

/// Distance of nearby states, over their size, that a pilot takes for close.
const APART: f64 = 1e-3;
/// Part of a derivative that curvature may add at distances of 10⁻⁷ or 10⁻⁶.
const CURVATURE: f64 = 1e-6;
/// Rounding errors of φ over it.
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
        let mut all: Vec<Vec<Candidate<'a>>> = Vec::new();
        for Nearby { parameter, change, offset, curvature, expect, observables } in nearby {
            let ids = |expect: &Expect<'_>| -> Vec<&str> {
                expect.candidates.iter().map(|one| one.setup.scheme.about().id).collect()
            };
            if ids(&expect) != ids(&self) {
                let why = "the nearby problem has other schemes: choose one that both have";
                return Err(RunError::Setting(format!("derivative by {parameter}: {why}")));
            }
            all.push(expect.candidates);
            let slope = Slope::Along(observables);
            let name = parameter;
            self.parameters.push(Parameter { name, change, offset, curvature, slope });
        }
        for (k, candidate) in self.candidates.iter_mut().enumerate() {
            let problem = &candidate.setup.problem;
            let near = |of: &Candidate<'a>, scheme: &Arc<dyn Method + 'a>| {
                let other = &of.setup.problem;
                let damping = other.damping;
                let shift = problem.y0.iter().zip(&other.y0).map(|(y, near)| near - y).collect();
                Near { method: Arc::clone(scheme), damping, shift }
            };
            let beside = |method: &Arc<dyn Method + 'a>, mirror: bool| {
                let of = |all: &Vec<Candidate<'a>>| {
                    let own = &all[k];
                    let scheme = own.mirror.as_ref().filter(|_| mirror);
                    near(own, scheme.unwrap_or(&own.setup.scheme))
                };
                let nearby = all.iter().map(of).collect();
                let dimension = problem.y0.len();
                Arc::new(SideBySide { method: Arc::clone(method), dimension, nearby }) as _
            };
            let mirror = candidate.mirror.as_ref().map(|mirror| beside(mirror, true));
            let scheme = beside(&candidate.setup.scheme, false);
            (candidate.setup.scheme, candidate.mirror) = (scheme, mirror);
        }
        Ok(self)
    }

    /// Number of paths beside each.
    pub(super) fn number_nearby(&self) -> usize {
        let along = |one: &&Parameter<'_>| matches!(one.slope, Slope::Along(_));
        self.parameters.iter().filter(along).count()
    }

    /// Adds to the bounds of the bias what the changes of parameters leave: of each derivative
    /// 10⁻⁶ of it, or what curvature is known to add, and rounding errors of φ over the change, of
    /// each value its offset, which is taken out.
    pub(super) fn bound(&self, found: &mut Expectation) {
        for (parameter, (_, slopes)) in self.parameters.iter().zip(&mut found.gradient) {
            let pairs = found.estimates.iter_mut().zip(slopes);
            // One without a mean has no bound.
            for (own, slope) in pairs.filter(|(_, slope)| slope.value.is_finite()) {
                let rounding = ROUND_OFF * own.value.abs() / parameter.change.abs();
                slope.bias_bound +=
                    parameter.curvature.max(CURVATURE) * slope.value.abs() + rounding;
                let shift = slope.value * parameter.offset;
                own.value -= shift;
                own.bias_bound += shift.abs();
            }
        }
    }

    /// Distances at T of what is nearby over its size, in the root mean square over 32 paths, for
    /// each parameter: the largest among the components and the test functions. 10⁻⁷ balances
    /// rounding errors and curvature. The size of a component is the largest on the way. Steps are
    /// as short as keeps states close, of some numbers. NaN where all paths fail. Areas are zero.
    pub fn distances(&self, observables: &[&dyn Observe]) -> Vec<f64> {
        let (setup, number) = (&self.candidates[0].setup, self.parameters.len());
        let Apart { mut largest, rows, live, .. } = self.apart(setup, number, &PILOTS);
        let states: Vec<&[Row]> = rows.chunks(setup.problem.y0.len()).collect();
        let parameters = self.parameters.iter().zip(&states[1..]);
        let mut rounded = states[0].to_vec();
        for (n, row) in rounded.iter_mut().enumerate() {
            let part = f64::EPSILON * (4.0 * golden(n as f64 + 1.0) - 2.0);
            row.iter_mut().for_each(|y| *y += part * *y);
        }
        for (distance, (Parameter { slope, .. }, state)) in largest.iter_mut().zip(parameters) {
            let Slope::Along(nearby) = slope else { continue };
            for (phi, near) in observables.iter().zip(nearby) {
                let rounded = phi.values(&rounded, live);
                let [phi, near] =
                    [(phi, states[0]), (near, *state)].map(|(of, y)| of.values(y, live));
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
        let Problem { y0, damping, .. } = &setup.problem;
        let (d, sizes) = (y0.len(), self.apart(&setup, 0, &PILOTS[1..]).sizes);
        let part = |i: usize| SEPARATION * golden(i as f64 + 1.0);
        let shift = (0..d).map(|i| part(i) * sizes[i]).collect();
        let nearby = vec![Near { method: Arc::clone(&setup.scheme), damping: *damping, shift }];
        let moves = (0..d).filter(|&i| sizes[i] > 0.0);
        let begun = moves.map(|i| part(i).powi(2)).sum::<f64>().sqrt();
        let method = Arc::clone(&setup.scheme);
        setup.scheme = Arc::new(SideBySide { method, dimension: d, nearby });
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
            // The larger one; NaN if one is.
            let larger = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
            let largest: Vec<f64> = (0..number).map(|k| parts(k).fold(0.0, larger)).collect();
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
        // Scores come after all rows of a path, and the first is that of the first parameter.
        let own = match self.parameters[0].slope {
            Slope::Score { row, .. } => 0..row,
            Slope::Along(_) => 0..dimension,
        };
        let on_rows = |(n, phi): (usize, &&'b dyn Observe),
                       of: Option<(usize, &'b Parameter<'a>)>| {
            let name = match of {
                Some((_, parameter)) => format!("∂{}/∂{}", phi.name(), parameter.name),
                None => phi.name().to_owned(),
            };
            let sample = of.map(|(k, Parameter { slope, change, .. })| match slope {
                Slope::Along(near) => {
                    let first = (k + 1) * dimension;
                    Sample::Difference(near[n], first..first + dimension, *change)
                }
                Slope::Score { row, centres } => Sample::Weighted(*row, centres[n]),
            });
            OnRows { name, phi: *phi, rows: own.clone(), sample }
        };
        let parameters = self.parameters.iter().enumerate();
        let all = [None].into_iter().chain(parameters.map(Some));
        all.flat_map(|of| observables.iter().enumerate().map(move |phi| (phi, of)))
            .map(|(phi, of)| on_rows(phi, of))
            .collect()
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
    rows: Range<usize>,
    sample: Option<Sample<'a>>,
}

/// A sample of a derivative.
enum Sample<'a> {
    /// The difference from the function nearby of its rows, over the change of the parameter.
    Difference(&'a dyn Observe, Range<usize>, f64),
    /// The difference from a number, times the score in a row.
    Weighted(usize, f64),
}

impl Observe for OnRows<'_> {
    fn name(&self) -> &str {
        &self.name
    }

    fn evaluate(&self, y: &[Row], live: PathMask, values: &mut Row) {
        self.phi.evaluate(&y[self.rows.clone()], live, values);
        match &self.sample {
            Some(Sample::Difference(near, rows, change)) => {
                let nearby = near.values(&y[rows.clone()], live);
                live.paths().for_each(|p| values[p] = (nearby[p] - values[p]) / change);
            }
            Some(Sample::Weighted(row, centre)) => {
                live.paths().for_each(|p| values[p] = (values[p] - centre) * y[*row][p]);
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

impl Method for SideBySide<'_> {
    fn about(&self) -> About {
        self.method.about()
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let (state, others) = y.split_at(self.dimension);
        let mut rows = state.to_vec();
        let mut all = vec![One { stepper: self.method.start(state), damping: None }];
        for (k, near) in self.nearby.iter().enumerate() {
            let shifted = |(row, shift): (&Row, &f64)| row.map(|y| y + shift);
            let known = others.get(k * self.dimension..(k + 1) * self.dimension);
            let start = known.map_or_else(
                || state.iter().zip(&near.shift).map(shifted).collect(),
                <[Row]>::to_vec,
            );
            all.push(One { stepper: near.method.start(&start), damping: Some(near.damping) });
            rows.extend(start);
        }
        Box::new(Side { all, dimension: self.dimension, rows })
    }
}

/// One of several steppers side by side; the damping of the first is that of the steps.
struct One<'a> {
    stepper: Box<dyn Stepper + 'a>,
    damping: Option<&'a dyn Damping>,
}

struct Side<'a> {
    all: Vec<One<'a>>,
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
        for (k, One { stepper, damping }) in self.all.iter_mut().enumerate().rev() {
            let rows = &mut self.rows[k * self.dimension..(k + 1) * self.dimension];
            stepper.state_mut().copy_from_slice(rows);
            let changed =
                damping.and_then(|damping| Step::new(damping, step.number(), step.tau).ok());
            stepper.step(changed.as_ref().unwrap_or(step), noise, &mut own);
            rows.copy_from_slice(stepper.state());
            failed = failed.or(own.failed);
        }
        *status = own;
        status.failed = failed;
    }

    fn rests(&mut self, live: PathMask) -> bool {
        let mut all = true;
        for one in &mut self.all {
            all &= one.stepper.rests(live);
        }
        all
    }
}
