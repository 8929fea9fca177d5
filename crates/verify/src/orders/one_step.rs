//! The order of one step as the step size tends to zero.
//!
//! δ = ψ_τ(y) − ψ_{τ/2}(ψ_{τ/2}(y)) is the difference of one step and two half steps on the same
//! noise. If E|δ|² ∝ τ^{2q}, the errors of the steps add up to a strong order of at most q − ½
//! (Milstein, *Theory Probab. Appl.* 32, 1987), and to exactly that unless their conditional means
//! add up faster. Steps cost little, so τ can be as small as rounding allows: far below the step
//! sizes at which whole paths can run, where a small term of low order may not show yet. The same
//! steps with stronger noise find such a term where the noise is weak.
//!
//! If the means of δ and of the differences of squares are of order τ^{r+1}, the weak order of
//! these test functions is r. Means are those of a cubature of degree five (Stroud, *Approximate
//! Calculation of Multiple Integrals*, 1971), exact for the terms up to τ^{5/2}.

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
    least_order(problem, sizes, &|tau, amplification| {
        difference(scheme, problem, sizes.key, visits, tau, amplification)
    })
}

/// The smallest weak order that the means of one step leave, for the components and their squares,
/// with the noise of the problem or an amplified one; `None` if it is not clear, or if the scheme
/// reads areas, which the cubature has not.
pub fn mean_order<S, G, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    visits: &[Visit<D>],
) -> Option<f64>
where
    S: PoissonSystem<D, M>,
    G: Damping,
{
    if scheme.reads_areas() {
        return None;
    }
    let visits = &visits[..visits.len().min(MEAN_VISITS)];
    let least = least_order(problem, sizes, &|tau, amplification| {
        mean_difference(scheme, problem, visits, tau, amplification)
    });
    least.map(|step| step.order - 1.0)
}

/// The smallest clear order of a mean square of differences, which is given with that of the states
/// for a step size and a factor of the noise.
fn least_order<S, G: Damping, const D: usize>(
    problem: &Problem<S, G, D>,
    sizes: &StepSizes,
    squares_of: &dyn Fn(f64, f64) -> (f64, f64),
) -> Option<OneStep> {
    let mut least: Option<OneStep> = None;
    for amplification in AMPLIFICATIONS {
        let mut squares = Vec::new();
        let finest = problem.t_end() / sizes.reference_steps() as f64;
        let coarser = sizes.level(0) as i32 / 2;
        for scale in -coarser..SCALES {
            let tau = 0.25 * finest * f64::powi(0.25, scale);
            let (square, size) = squares_of(tau, amplification);
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

/// Visits from which means are formed.
const MEAN_VISITS: usize = 16;

/// Means over visits of the squares of E[g(one step) − g(two half steps)] and of g, where g are the
/// components and their squares; NaN if no step succeeds.
fn mean_difference<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    visits: &[Visit<D>],
    tau: f64,
    amplification: f64,
) -> (f64, f64) {
    let (mut square, mut size, mut count) = (0.0, 0.0, 0.0);
    let root = amplification * (0.5 * tau).sqrt();
    for visit in visits {
        let mut means = [[0.0; D]; 2];
        let mut add = |weight: f64, normals: [[f64; M]; 2]| {
            let noises = normals.map(|normals| Noise::increments(normals.map(|x| root * x)));
            let (one, two) = one_and_two(scheme, problem, visit, tau, noises)?;
            for i in 0..D {
                let difference = one[i] - two[i];
                means[0][i] += weight * difference;
                means[1][i] += weight * difference * (one[i] + two[i]);
            }
            Some(())
        };
        if cubature::<M>().try_for_each(|(weight, normals)| add(weight, normals)).is_some() {
            square += means.map(square_of).iter().sum::<f64>();
            size += square_of(visit.state) + square_of(visit.state.map(|y| y * y));
            count += 1.0;
        }
    }
    (square / count, size / count)
}

fn square_of<const D: usize>(x: [f64; D]) -> f64 {
    x.iter().map(|x| x * x).sum()
}

/// A step τ from the visit and two half steps on the same noise; `None` if one fails.
fn one_and_two<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    problem: &Problem<S, G, D>,
    visit: &Visit<D>,
    tau: f64,
    [first, second]: [Noise<M>; 2],
) -> Option<([f64; D], [f64; D])> {
    let step = |n: u64, tau: f64, noise: &Noise<M>, y: [f64; D]| {
        let step = Step::new(problem.damping(), n, tau).ok()?;
        let solution = scheme.step(problem.system(), &step, noise, y);
        solution.outcome.converged().then_some(solution.z)
    };
    // Times are multiples of the step size.
    let n = (visit.t / tau).round() as u64;
    let one = step(n, tau, &join(first, second), visit.state)?;
    let half = step(2 * n, 0.5 * tau, &first, visit.state)?;
    Some((one, step(2 * n + 1, 0.5 * tau, &second, half)?))
}

/// Weights and points of a cubature of degree five for two vectors of M normals.
fn cubature<const M: usize>() -> impl Iterator<Item = (f64, [[f64; M]; 2])> {
    let n = 2 * M;
    let r = n as f64 + 2.0;
    let point = move |entries: &[(usize, f64)]| {
        let mut point = [[0.0; M]; 2];
        entries.iter().for_each(|&(i, x)| point[i / M][i % M] = x);
        point
    };
    let centre = std::iter::once((2.0 / r, [[0.0; M]; 2]));
    let axes = (0..n).flat_map(move |i| {
        [r.sqrt(), -r.sqrt()].map(|x| ((4.0 - n as f64) / (2.0 * r * r), point(&[(i, x)])))
    });
    let pairs = (0..n).flat_map(move |i| (i + 1..n).map(move |j| (i, j)));
    let planes = pairs.flat_map(move |(i, j)| {
        let x = (0.5 * r).sqrt();
        let signs = [(x, x), (x, -x), (-x, x), (-x, -x)];
        signs.map(|(a, b)| (1.0 / (r * r), point(&[(i, a), (j, b)])))
    });
    centre.chain(axes).chain(planes)
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
        let noises = two_steps(key, path, 0.5 * tau, amplification, scheme.reads_areas());
        if let Some((one, two)) = one_and_two(scheme, problem, visit, tau, noises) {
            square += square_of(std::array::from_fn::<f64, D, _>(|i| one[i] - two[i]));
            size += square_of(two);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cubature_has_the_moments_of_normals_up_to_the_fifth() {
        let points: Vec<(f64, [[f64; 3]; 2])> = cubature().collect();
        let moment = |of: &dyn Fn([f64; 6]) -> f64| {
            let flat = |p: [[f64; 3]; 2]| std::array::from_fn(|i| p[i / 3][i % 3]);
            points.iter().map(|&(weight, p)| weight * of(flat(p))).sum::<f64>()
        };
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-13, "{a} {b}");
        close(moment(&|_| 1.0), 1.0);
        for i in 0..6 {
            close(moment(&|x| x[i]), 0.0);
            close(moment(&|x| x[i].powi(2)), 1.0);
            close(moment(&|x| x[i].powi(4)), 3.0);
            close(moment(&|x| x[i].powi(5)), 0.0);
            for j in 0..i {
                close(moment(&|x| x[i] * x[j]), 0.0);
                close(moment(&|x| x[i].powi(3) * x[j]), 0.0);
                close(moment(&|x| (x[i] * x[j]).powi(2)), 1.0);
            }
        }
    }

    use noise::Truncation;
    use systems::{Constant, paper::valid};

    use super::super::tests::{Anything, Single};

    fn problem() -> Problem<Anything, Constant, 2> {
        valid(Problem::new(Anything, valid(Constant::new(0.0)), [1.0, 0.0], 2.0))
    }

    fn sizes() -> StepSizes {
        let key = StreamKey { seed: 1, experiment: 1 };
        StepSizes { levels: 3, ..StepSizes::new(4, Truncation::none(), key) }
    }

    #[test]
    fn the_least_clear_order_of_all_strengths_of_noise_is_taken() {
        // From T/64 times 4² down: two levels above the finest of four sizes.
        let of = |squares: &dyn Fn(f64, f64) -> (f64, f64)| {
            let found = least_order(&problem(), &sizes(), squares);
            found.map(|step| (step.order, step.amplification, step.tau))
        };
        // Halfway to rounding: (3e-14)² < τ³ down to τ = 2⁻²⁷ (from 2⁻³, by quarters).
        let tau = |n: i32| 2f64.powi(-n);
        assert_eq!(of(&|tau, _| (tau.powi(3), 1.0)), Some((1.5, 1.0, tau(29))));
        // Rounding is relative to the states.
        assert_eq!(of(&|tau, _| (tau.powi(3), 1e6)), Some((1.5, 1.0, tau(23))));
        // A term that noise of 16 shows, and one that none does; equal orders keep the first.
        let weak = |tau: f64, strength: f64| {
            let extra = if strength > 1.0 { tau * tau } else { 0.0 };
            (tau.powi(3) + 1e3 * extra, 1.0)
        };
        assert_eq!(of(&weak).map(|found| (found.0, found.1)), Some((1.0, 16.0)));
        // Exponents within a twentieth of a multiple of ½ are one.
        let power = |q: f64| of(&|tau, _| (tau.powf(2.0 * q), 1.0)).map(|found| found.0);
        assert_eq!([1.04, 1.06, 1.46].map(power), [Some(1.0), None, Some(1.5)]);
        // What does not shrink has no order, as what is always rounding.
        assert_eq!((of(&|_, _| (1.0, 1.0)), of(&|_, _| (0.0, 1.0))), (None, None));
        // Steps that overflow are passed over.
        let late = |tau: f64, _: f64| (if tau > 1e-3 { f64::NAN } else { tau.powi(4) }, 1.0);
        assert_eq!(of(&late).map(|found| found.0), Some(2.0));
    }

    #[test]
    fn step_sizes_begin_above_the_finest_and_fall_by_quarters() {
        let asked = std::cell::RefCell::new(Vec::new());
        least_order(&problem(), &sizes(), &|tau, strength| {
            if strength == 1.0 {
                asked.borrow_mut().push(tau);
            }
            (1.0, 1.0)
        });
        // The reference has 4·2⁴ steps on [0, 2]; a quarter of it, and two quarters more up.
        let finest = 2.0 / 64.0 / 4.0;
        let expected: Vec<f64> = (-2..20).map(|n| finest * 0.25f64.powi(n)).collect();
        assert_eq!(asked.into_inner(), expected);
    }

    #[test]
    fn one_step_and_two_half_steps_share_time_and_noise() {
        // y₁ + 2t + 3τ + 5ΔW, and y₂ + τ².
        let scheme =
            Single(|t, tau, dw, y| [y[0] + 2.0 * t + 3.0 * tau + 5.0 * dw, y[1] + tau * tau]);
        let visit = Visit { t: 0.5, state: [1.0, -2.0] };
        let noises = [0.25, -0.5].map(|dw| Noise::increments([dw]));
        let (one, two) = one_and_two(&scheme, &problem(), &visit, 0.25, noises).unwrap();
        assert_eq!(one, [1.0 + 1.0 + 0.75 - 1.25, -2.0 + 0.0625]);
        assert_eq!(two, [1.0 + (1.0 + 1.25) + 0.75 - 1.25, -2.0 + 2.0 * 0.015_625]);
        // Visits whose steps fail are left out of both means.
        let partly =
            Single(|_, tau, _, y| [y[0] + tau.sqrt(), if y[0] > 2.0 { f64::NAN } else { y[1] }]);
        let visits = [[1.0, 0.0], [0.5, 1.0], [3.0, 0.0]].map(|state| Visit { t: 0.0, state });
        let key = StreamKey { seed: 1, experiment: 1 };
        let (square, size) = difference(&partly, &problem(), key, &visits, 0.04, 1.0);
        let (one, two) = (0.2, 2.0 * 0.02f64.sqrt());
        let states = [1.0 + two, 0.5 + two];
        let exact = (states[0] * states[0] + states[1] * states[1] + 1.0) / 2.0;
        assert!((square / ((one - two) * (one - two)) - 1.0).abs() < 1e-12, "{square}");
        assert!((size / exact - 1.0).abs() < 1e-12, "{size} {exact}");
        assert!(difference(&partly, &problem(), key, &visits[2..], 0.04, 1.0).0.is_nan());
    }

    #[test]
    fn means_of_one_step_are_those_over_the_noise() {
        // y₁ + ΔW + ½τ² and y₂: the means of y₁ and y₁² differ by τ²/4 and by what ΔW² adds.
        let scheme = Single(|_, tau, dw, y| [y[0] + dw + 0.5 * tau * tau, y[1]]);
        let visits = [Visit { t: 0.0, state: [3.0, 1.0] }];
        let (tau, strength) = (0.5, 2.0);
        let (square, size) = mean_difference(&scheme, &problem(), &visits, tau, strength);
        // One step ends at 3 + ΔW + 0.125 and two at 3 + ΔW + 0.0625.
        let second = 0.0625 * (2.0 * 3.0 + 0.1875);
        assert!((square - 0.0625 * 0.0625 - second * second).abs() < 1e-12, "{square}");
        assert_eq!(size, 10.0 + 82.0);
        // Two steps of ΔW² each have twice the mean; squares of increments are strength²·τ.
        let scheme = Single(|_, tau, dw, y| [y[0] + if tau < 0.5 { dw * dw } else { 0.0 }, y[1]]);
        let visits = [Visit { t: 0.0, state: [0.0, 0.0] }];
        let (square, _) = mean_difference(&scheme, &problem(), &visits, tau, strength);
        // E of the sum, 4·0.5 = 2, and of its square, 2·3·1² + 2·1·1 = 8.
        assert!((square - 4.0 - 64.0).abs() < 1e-9, "{square}");
        // Of order τ² in the mean: weak order one, from sixteen visits at most.
        let drift = Single(|_, tau, dw, y| [y[0] + dw + tau * tau, y[1]]);
        let visits = vec![Visit { t: 0.0, state: [1.0, 1.0] }; 20];
        assert_eq!(mean_order(&drift, &problem(), &sizes(), &visits), Some(1.0));
    }

    #[test]
    fn areas_of_two_steps_add_up_by_chens_relation() {
        let noise = |increments: [f64; 2], area: f64| Noise {
            increments,
            areas: [[0.0, area], [-area, 0.0]],
        };
        let both = join(noise([1.0, 2.0], 0.25), noise([3.0, 5.0], 0.5));
        // ½(1·5 − 2·3) = −½.
        assert_eq!(both.increments, [4.0, 7.0]);
        assert_eq!(both.areas, [[0.0, 0.25], [-0.25, 0.0]]);
        // Brownian motion times two is that of four times the time.
        let key = StreamKey { seed: 7, experiment: 1 };
        let of = |tau, factor| two_steps::<2>(key, 3, tau, factor, true);
        assert_eq!(of(0.5, 2.0).map(|n| n.increments), of(2.0, 1.0).map(|n| n.increments));
        assert_eq!(of(0.5, 2.0).map(|n| n.areas), of(2.0, 1.0).map(|n| n.areas));
        assert!(of(0.5, 2.0)[0].areas[0][1] != 0.0);
        let without = two_steps::<2>(key, 3, 2.0, 1.0, false);
        assert_eq!(without.map(|n| n.increments), of(2.0, 1.0).map(|n| n.increments));
        assert_eq!(without[0].areas, [[0.0; 2]; 2]);
    }
}
