//! The order of one step as the step size tends to zero.
//!
//! δ = ψ_τ(y) − ψ_{τ/2}(ψ_{τ/2}(y)) is the difference of one step and two half steps on the same
//! noise. If E|δ|² ∝ τ^{2q}, the errors of the steps add up to a strong order of at most q − ½
//! (Milstein, *Theory Probab. Appl.* 32, 1987), and to exactly that unless their conditional means
//! add up faster. Steps cost little, so τ can be as small as rounding allows: far below the step
//! sizes at which whole paths can run, where a small term of low order may not show yet. The same
//! steps with stronger noise find such a term where the noise is weak.

use noise::{AreaMethod, AreaPath, Noise, StreamKey, WienerPath};
use schemes::{Scheme, Step};
use systems::{Damping, PoissonSystem, Problem};

use super::{StepSizes, visits::Visit};

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
const AMPLIFICATIONS: [f64; 5] = [1.0, 16.0, 256.0, 4096.0, 65_536.0];
/// Step sizes below the finest of the measurement, each a quarter of the one before, until rounding
/// ends it. Coarser ones come first: errors of high order are rounding errors soon.
const SCALES: i32 = 20;
/// Differences below this fraction of |y| are rounding errors to a hundredth.
const ROUND_OFF: f64 = 3e-14;
/// How far the exponents of the last two pairs of scales may be from a multiple of ½: a tenth of
/// the distance.
const TOLERANCE: f64 = 0.05;

/// The smallest order that one step of `scheme` shows with the noise of the problem or an amplified
/// one, from these states at their times; `None` if it is not clear.
pub fn one_step<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    visits: &[Visit<D>],
) -> Option<OneStep>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    let mut least: Option<OneStep> = None;
    for amplification in AMPLIFICATIONS {
        let mut squares = Vec::new();
        let finest = problem.t_end() / sizes.reference_steps() as f64;
        let coarser = sizes.level(0) as i32 / 2;
        for scale in -coarser..SCALES {
            let tau = 0.25 * finest * f64::powi(0.25, scale);
            let (square, size) = difference(scheme, problem, sizes.key, visits, tau, amplification);
            if square <= ROUND_OFF * ROUND_OFF * size {
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
    least.filter(|step| step.order > 0.0)
}

/// Means of |δ|² and |y|² over the steps that succeed; NaN if none does.
fn difference<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    key: StreamKey,
    visits: &[Visit<D>],
    tau: f64,
    amplification: f64,
) -> (f64, f64) {
    let (mut square, mut size, mut count) = (0.0, 0.0, 0.0);
    for (path, visit) in (0..).zip(visits) {
        let [first, second] = two_steps(key, path, 0.5 * tau, amplification, scheme.reads_areas());
        let both = join(first, second);
        // Times are multiples of the step size.
        let n = (visit.t / tau).round() as u64;
        let step = |n: u64, tau: f64, noise: &Noise<M>, y: [f64; D]| {
            let step = Step::new(problem.damping(), n, tau).ok()?;
            let solution = scheme.step(problem.system(), &step, noise, y);
            solution.outcome.converged().then_some(solution.z)
        };
        let one = step(n, tau, &both, visit.state);
        let half = step(2 * n, 0.5 * tau, &first, visit.state);
        let two = half.and_then(|y| step(2 * n + 1, 0.5 * tau, &second, y));
        if let (Some(one), Some(two)) = (one, two) {
            square += (0..D).map(|i| (one[i] - two[i]).powi(2)).sum::<f64>();
            size += two.iter().map(|y| y * y).sum::<f64>();
            count += 1.0;
        }
    }
    (square / count, size / count)
}

/// The noise of two steps τ, times a factor. Areas have one term of their series, since one step
/// and two half steps share them and only their law is that of the series.
fn two_steps<const M: usize>(
    key: StreamKey,
    path: u64,
    tau: f64,
    factor: f64,
    areas: bool,
) -> [Noise<M>; 2] {
    let mut wiener = WienerPath::<M>::new(key, path);
    let method = AreaMethod::MrongowiusRoessler;
    let mut sampler = areas.then(|| AreaPath::<M>::new(key, path, method, 1));
    // Brownian motion times a factor is Brownian motion of another time.
    let time = tau * factor * factor;
    [(); 2].map(|()| {
        let mut noise = Noise::increments(wiener.increments(time.sqrt()));
        if let Some(sampler) = &mut sampler {
            noise.areas = sampler.areas(time, noise.increments);
        }
        noise
    })
}

/// The noise of a step that consists of two: areas by Chen's relation.
fn join<const M: usize>(first: Noise<M>, second: Noise<M>) -> Noise<M> {
    let mut both = first;
    for i in 0..M {
        both.increments[i] += second.increments[i];
        for j in 0..M {
            let (a, b) = (first.increments, second.increments);
            both.areas[i][j] += second.areas[i][j] + 0.5 * (a[i] * b[j] - b[i] * a[j]);
        }
    }
    both
}
