//! The order of one step as the step size tends to zero.
//!
//! δ = ψ_τ(y) − ψ_{τ/2}(ψ_{τ/2}(y)) is the difference of one step and two half steps on the same
//! noise. If E|δ|² ∝ τ^{2q}, the errors of the steps add up to a strong order of at most q − ½
//! (Milstein, *Theory Probab. Appl.* 32, 1987), and to exactly that unless their conditional means
//! add up faster. Steps cost little, so τ can be as small as rounding allows: far below the step
//! sizes at which whole paths can run, where a small term of low order may not show yet. The same
//! steps with stronger noise find such a term where the noise is weak.

use mc::{Ladder, LadderError, NextNoise, NoiseSource, Run, Statistic, View};
use noise::{AreaMethod, AreaSampler, StreamKey, Truncation, WienerBlock};
use schemes::Scheme;
use stats::Moments;
use systems::{Damping, PoissonSystem, Problem};

use super::StepSizes;

/// The order of the error of one step, a multiple of ½: E|δ|² ∝ τ^{2q}.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneStep {
    /// q.
    pub order: f64,
    /// The smallest step size at which it was seen.
    pub tau: f64,
    /// How much stronger the noise was than that of the problem.
    pub amplification: f64,
}

impl OneStep {
    /// The strong orders that belong to q.
    ///
    /// Errors of q = k + ½ are odd in the noise, for a smooth scheme, and have no mean: q − ½.
    /// Those of integer q may have one: q − 1 or q − ½. With q = 1, q − 1 is no convergence.
    pub fn strong_orders(&self) -> impl Iterator<Item = f64> {
        let mean = (self.order > 1.0 && self.order.fract() == 0.0).then_some(self.order - 1.0);
        mean.into_iter().chain([self.order - 0.5])
    }
}

/// Factors of the noise.
const AMPLIFICATIONS: [f64; 3] = [1.0, 16.0, 256.0];
/// Step sizes below the finest of the measurement, each a quarter of the one before. Coarser ones
/// come first: errors of high order are rounding errors soon.
const SCALES: u32 = 9;
/// States from which steps are taken, each of a path of its own.
const STATES: u64 = 512;
/// Differences below this fraction of |y| are rounding errors to a hundredth.
const ROUND_OFF: f64 = 3e-14;
/// How far the exponents of the last two pairs of scales may be from a multiple of ½: a tenth of
/// the distance.
const TOLERANCE: f64 = 0.05;

/// The smallest order that one step of `scheme` shows with the noise of the problem or an amplified
/// one; `None` if it is not clear.
pub fn one_step<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
) -> Result<Option<OneStep>, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let states = visited(scheme, problem, sizes)?;
    let mut least: Option<OneStep> = None;
    for amplification in AMPLIFICATIONS {
        let last = sizes.reference_steps().ilog2();
        let coarser = (last - sizes.coarsest_steps.ilog2()) / 2;
        let mut squares = Vec::new();
        for scale in 0..coarser + SCALES {
            let exponent = last + 2 + 2 * scale - 2 * coarser;
            let steps = 2u64 << exponent.min(61);
            let tau = 2.0 * problem.t_end() / steps as f64;
            let runs = vec![Run::new(scheme, 1), Run::new(scheme, 0)];
            let noise = Amplified {
                key: sizes.key,
                tau: 0.5 * tau,
                factor: amplification,
                areas: scheme.reads_areas(),
            };
            let ladder = Ladder::new(problem, steps, 1, Truncation::none(), sizes.key, runs)?
                .with_noise(noise)?
                .starting_at(states.clone())?
                .ending_after(1);
            let Differences { squares: of_step, size, .. } =
                ladder.run(STATES, Differences::default, &|_| ()).statistic;
            let square = of_step.mean();
            if square <= ROUND_OFF * ROUND_OFF * size.mean() {
                break;
            }
            // A step with very strong noise may fail, or overflow.
            if square.is_finite() {
                squares.push((tau, square));
            }
        }
        // Squares with τ a quarter as large: E|δ|² falls by 4^{2q}.
        let exponents: Vec<f64> =
            squares.windows(2).map(|pair| 0.25 * (pair[0].1 / pair[1].1).log2()).collect();
        let found = match exponents[..] {
            [.., before, last] => {
                let order = 0.5 * (2.0 * last).round();
                let clear = [before, last].iter().all(|q| (q - order).abs() < TOLERANCE);
                clear.then(|| OneStep { order, tau: squares[squares.len() - 1].0, amplification })
            }
            _ => None,
        };
        least = match (least, found) {
            (Some(least), Some(found)) if found.order >= least.order => Some(least),
            (least, found) => found.or(least),
        };
    }
    Ok(least.filter(|step| step.order > 0.0))
}

/// States of some paths of the scheme, each at a time of its own, or y₀ if none survives.
fn visited<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
) -> Result<Vec<[f64; D]>, LadderError>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let steps = sizes.coarsest_steps << (sizes.levels - 1);
    let runs = vec![Run::new(scheme, 0)];
    let ladder = Ladder::new(problem, steps, 0, sizes.truncation, sizes.key, runs)?;
    let none = || Visited { steps, states: Vec::new() };
    let mut states = ladder.run(STATES, none, &|_| ()).statistic.states;
    if states.is_empty() {
        states.push(problem.y0());
    }
    Ok(states)
}

/// Collects states.
struct Visited<const D: usize> {
    steps: u64,
    states: Vec<[f64; D]>,
}

impl<const D: usize> Statistic<D> for Visited<D> {
    fn observe(&mut self, view: &View<'_, D>) {
        // Multiples of the golden ratio, modulo one, are spread evenly.
        let fraction = |path: u64| (path as f64 * 0.618_033_988_749_894_8).fract();
        for p in view.live.paths() {
            let time = 1 + (fraction(view.first_path + p as u64) * self.steps as f64) as u64;
            if time.min(self.steps) == view.time {
                self.states.push(view.states[0].path(p));
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.states.extend(later.states);
    }
}

/// E|δ|² and E|y|² over the first step.
#[derive(Default)]
struct Differences {
    squares: Moments,
    size: Moments,
}

impl<const D: usize> Statistic<D> for Differences {
    fn observe(&mut self, view: &View<'_, D>) {
        for p in view.live.paths() {
            let [one, two] = [0, 1].map(|run| view.states[run].path(p));
            self.squares.add((0..D).map(|i| (one[i] - two[i]).powi(2)).sum());
            self.size.add(two.iter().map(|y| y * y).sum());
        }
    }

    fn merge(&mut self, later: Self) {
        self.squares.merge(later.squares);
        self.size.merge(later.size);
    }
}

/// Noise of steps τ times a factor; areas by one term of their series, since one step and two half
/// steps share them and only their law is that of the series.
struct Amplified {
    key: StreamKey,
    tau: f64,
    factor: f64,
    areas: bool,
}

impl<const M: usize> NoiseSource<M> for Amplified {
    fn block(&self, first_path: u64) -> NextNoise<'_, M> {
        let mut increments = WienerBlock::new(self.key, first_path);
        let method = AreaMethod::MrongowiusRoessler;
        let mut areas = self.areas.then(|| AreaSampler::<M>::new(self.key, first_path, method, 1));
        // Brownian motion times a factor is Brownian motion of another time.
        let tau = self.tau * self.factor * self.factor;
        Box::new(move |noise| {
            increments.increments(tau.sqrt(), &mut noise.increments);
            if let Some(sampler) = &mut areas {
                sampler.areas(tau, &noise.increments, &mut noise.areas);
            }
        })
    }
}
