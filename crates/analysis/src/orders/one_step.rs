//! The order of one step as the step size tends to zero.
//!
//! δ = ψ_τ(y) − ψ_{τ/2}(ψ_{τ/2}(y)) is the difference of one step and two half steps on the same
//! noise. If E|δ|² ∝ τ^{2q}, the errors of the steps add up to a strong order of at most q − ½
//! (Milstein, *Theory Probab. Appl.* 32, 1987), and to exactly that unless their conditional means
//! add up faster. Steps cost little, so τ can be as small as rounding allows: far below the step
//! sizes at which whole paths can run, where a small term of low order may not show yet. The same
//! steps with stronger noise find such a term where the noise is weak.
//!
//! Eδ is computed without sampling, by a cubature of degree five over the normals of both halves:
//! exact for terms below τ³, which is all that q = 2 asks for.

use mc::Setup;
use noise::{AreaSampler, Purpose, StepNoise, StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{PathMask, Row, WIDTH, elementary::log2};
use schemes::{Step, Stepper};

use super::{StepSizes, runs::Visit};

/// The order of the error of one step, a multiple of ½: E|δ|² ∝ τ^{2q}.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneStep {
    /// Order q.
    pub order: f64,
    /// Smallest step size at which the order was seen.
    pub tau: f64,
    /// Factor of the noise over that of the problem.
    pub amplification: f64,
    /// Order of the mean |Eδ|, where q = 2 leaves two strong orders; `None` if it is not known.
    pub mean: Option<f64>,
}

impl OneStep {
    /// Strong orders that a one-step order q allows.
    ///
    /// Errors of q = k + ½ are odd in the noise, for a smooth scheme, and have no mean: q − ½.
    /// Those of integer q may have one: q − 1 with a mean of order q, else q − ½. With q = 1, q − 1
    /// is no convergence.
    pub fn strong_orders(&self) -> impl Iterator<Item = f64> {
        let (order, falls) = (self.order, self.mean.is_some_and(|mean| mean > self.order));
        let least = (order > 1.0 && order.fract() == 0.0 && !falls).then_some(order - 1.0);
        let most = self.mean.is_none_or(|mean| mean > order).then_some(order - 0.5);
        least.into_iter().chain(most)
    }

    /// With the order of the mean, from squares |Eδ|², where it tells two orders apart.
    #[must_use]
    pub fn with_mean(self, t_end: f64, sizes: &StepSizes, squares_of: &mut SquaresOf<'_>) -> Self {
        let unknown = self.order == OF_CUBATURE;
        let mean = unknown.then(|| least_order(t_end, sizes, squares_of)).flatten();
        Self { mean: mean.map(|q| q.order), ..self }
    }
}

/// Factors of the noise.
const AMPLIFICATIONS: [f64; 5] = [1.0, 16.0, 256.0, 4096.0, 65_536.0];
/// Step sizes below the finest of the measurement, each a quarter of the one before, until rounding
/// ends it. Coarser ones come first: errors of high order are rounding errors soon.
const SCALES: i32 = 20;
/// Differences below this fraction of |y| are rounding errors to a hundredth.
const ROUND_OFF: f64 = 3e-14;
/// Tolerance of the exponents of the last two pairs of scales to a multiple of ½: a tenth of the
/// distance.
const TOLERANCE: f64 = 0.05;
/// Order of one step whose mean the cubature has right up to the next order.
const OF_CUBATURE: f64 = 2.0;
/// Number of states from which means are computed.
const FEW_VISITS: usize = 8;
/// Largest number of noises for which means are computed.
const MAX_NOISES: usize = 4;

/// Smallest order that one step of a scheme shows with the noise of the problem or an amplified
/// one, from the states `visits` at their times; `None` if the order is not clear.
pub fn one_step(setup: &Setup<'_>, sizes: &StepSizes, visits: &[Visit]) -> Option<OneStep> {
    let (mut steps, t_end) = (Steps::new(setup), setup.problem.t_end);
    let found = least_order(t_end, sizes, &mut |tau, amplifications| {
        differences(&mut steps, sizes.key, visits, tau, amplifications)
    })?;
    let noises = setup.problem.noises;
    if !(1..=MAX_NOISES).contains(&noises) || setup.scheme.about().reads_areas {
        return Some(found);
    }
    let none = setup.scheme.no_noise(noises);
    Some(found.with_mean(t_end, sizes, &mut |tau, amplifications| {
        let variances = amplifications.iter().map(|factor| 0.5 * tau * factor * factor);
        variances.map(|of| mean_square(&mut steps, visits, tau, &nodes(&none, of))).collect()
    }))
}

/// Nodes and weights of a cubature of degree five for n independent standard normals (McNamee and
/// Stenger, *Numer. Math.* 10, 1967).
fn cubature(n: usize) -> Vec<(Vec<f64>, f64)> {
    let size = n as f64 + 2.0;
    let mut nodes = vec![(vec![0.0; n], 2.0 / size)];
    let mut push = |places: &[(usize, f64)], weight: f64| {
        let mut at = vec![0.0; n];
        places.iter().for_each(|&(i, x)| at[i] = x);
        nodes.push((at, weight));
    };
    let (far, near) = (size.sqrt(), (0.5 * size).sqrt());
    for i in 0..n {
        for x in [-far, far] {
            push(&[(i, x)], (4.0 - n as f64) / (2.0 * size * size));
        }
        for j in 0..i {
            for [a, b] in [[-near, -near], [-near, near], [near, -near], [near, near]] {
                push(&[(i, a), (j, b)], 1.0 / (size * size));
            }
        }
    }
    nodes
}

/// Noise of two half steps at the nodes of a cubature, on blocks of 32 paths, with the weights.
/// `variance`: of an increment.
pub fn nodes(none: &StepNoise, variance: f64) -> Vec<([StepNoise; 2], Vec<f64>)> {
    let noises = none.increments.len();
    let of_half = noises + none.space_time.len();
    let nodes = cubature(2 * of_half);
    let blocks = nodes.chunks(WIDTH).map(|nodes| {
        let mut halves = [none.clone(), none.clone()];
        for (p, (at, _)) in nodes.iter().enumerate() {
            for (noise, at) in halves.iter_mut().zip(at.chunks(of_half)) {
                for (row, x) in noise.increments.iter_mut().zip(at) {
                    row[p] = variance.sqrt() * x;
                }
                for (row, x) in noise.space_time.iter_mut().zip(&at[noises..]) {
                    row[p] = (variance / 12.0).sqrt() * x;
                }
            }
        }
        (halves, nodes.iter().map(|(_, weight)| *weight).collect())
    });
    blocks.collect()
}

/// Means of |Eδ|² and of |y|² over states.
fn mean_square(
    steps: &mut Steps<'_>,
    visits: &[Visit],
    tau: f64,
    nodes: &[([StepNoise; 2], Vec<f64>)],
) -> (f64, f64) {
    mean_squares(visits.iter().take(FEW_VISITS).filter_map(|visit| {
        let mut mean = vec![0.0; visit.state.len()];
        for (noises, weights) in nodes {
            steps.noises.iter_mut().zip(noises).for_each(|(to, from)| to.copy_from(from));
            let ends = steps.one_and_two(visit, tau, weights.len());
            let Some(OneAndTwo { one, two, live }) = ends else { continue };
            for (p, weight) in weights.iter().enumerate() {
                // A path that fails leaves no mean.
                let weight = if live.contains(p) { *weight } else { f64::NAN };
                let rows = mean.iter_mut().zip(one).zip(two);
                rows.for_each(|((mean, one), two)| *mean += weight * (one[p] - two[p]));
            }
        }
        difference(&mean, &visit.state)
    }))
}

/// Sums of |δ|² and |y|² over states.
#[derive(Clone, Copy, Default)]
struct Squares {
    difference: f64,
    state: f64,
    count: f64,
}

impl Squares {
    /// Adds |δ|² and |y|² of a state.
    fn add(&mut self, (difference, state): (f64, f64)) {
        self.difference += difference;
        self.state += state;
        self.count += 1.0;
    }

    /// Means of |δ|² and |y|²; NaN if there are none.
    fn means(&self) -> (f64, f64) {
        (self.difference / self.count, self.state / self.count)
    }
}

/// |δ|² and |y|² of a difference and a state, if they are finite.
pub fn difference(delta: &[f64], y: &[f64]) -> Option<(f64, f64)> {
    let square = |x: &[f64]| x.iter().map(|x| x * x).sum();
    delta.iter().chain(y).all(|x| x.is_finite()).then(|| (square(delta), square(y)))
}

/// Means of |δ|² and |y|²; NaN if there are none.
pub fn mean_squares(squares: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let mut sums = Squares::default();
    squares.for_each(|of| sums.add(of));
    sums.means()
}

/// Function that gives mean squares of differences and of states for a step size and factors of the
/// noise.
pub type SquaresOf<'a> = dyn FnMut(f64, &[f64]) -> Vec<(f64, f64)> + 'a;

/// The step sizes of single steps, coarsest first.
pub fn taus(t_end: f64, sizes: &StepSizes) -> impl Iterator<Item = f64> {
    let finest = t_end / sizes.reference_steps() as f64;
    let coarser = sizes.level(0) as i32 / 2;
    (-coarser..SCALES).map(move |scale| 0.25 * finest * f64::powi(0.25, scale))
}

/// The smallest clear order of a mean square of differences.
pub fn least_order(
    t_end: f64,
    sizes: &StepSizes,
    squares_of: &mut SquaresOf<'_>,
) -> Option<OneStep> {
    let mut squares = AMPLIFICATIONS.map(|_| Vec::new());
    // The factors for which rounding does not show yet.
    let mut left: Vec<usize> = (0..AMPLIFICATIONS.len()).collect();
    for tau in taus(t_end, sizes) {
        let factors: Vec<f64> = left.iter().map(|&n| AMPLIFICATIONS[n]).collect();
        let mut found = squares_of(tau, &factors).into_iter();
        left.retain(|&n| {
            let Some((square, size)) = found.next() else { return false };
            let shows = square <= ROUND_OFF * ROUND_OFF * size;
            // A step with very strong noise may fail, or overflow.
            if !shows && square.is_finite() {
                squares[n].push((tau, square));
            }
            !shows
        });
        if left.is_empty() {
            break;
        }
    }
    let clear = squares.iter().zip(AMPLIFICATIONS).filter_map(|(squares, amplification)| {
        let &[(_, first), (_, second), (tau, third)] = squares.last_chunk()?;
        // Squares with τ a quarter as large: E|δ|² falls by 4^{2q}.
        let [before, last] = [first / second, second / third].map(|ratio| 0.25 * log2(ratio));
        let order = 0.5 * (2.0 * last).round();
        let near = [before, last].iter().all(|q| (q - order).abs() < TOLERANCE);
        near.then_some(OneStep { order, tau, amplification, mean: None })
    });
    clear.min_by(|a, b| a.order.total_cmp(&b.order)).filter(|step| step.order > 0.0)
}

/// Means of |δ|² and |y|² for each factor of the noise, over the steps that succeed; NaN if none
/// does.
fn differences(
    steps: &mut Steps<'_>,
    key: StreamKey,
    visits: &[Visit],
    tau: f64,
    amplifications: &[f64],
) -> Vec<(f64, f64)> {
    let setup = steps.setup;
    let none = setup.scheme.no_noise(setup.problem.noises);
    let mut squares = vec![Squares::default(); amplifications.len()];
    for (block, visits) in (0..).zip(visits.chunks(WIDTH)) {
        let noises = amplifications
            .iter()
            .map(|factor| two_steps(&none, key, block * WIDTH as u64, 0.5 * tau, *factor));
        let drawn: Vec<[StepNoise; 2]> = noises.collect();
        for (p, visit) in visits.iter().enumerate() {
            for (lane, drawn) in drawn.iter().enumerate() {
                let noises = steps.noises.iter_mut().zip(drawn);
                noises.for_each(|(to, from)| to.copy_path(lane, from, p));
            }
            let ends = steps.one_and_two(visit, tau, drawn.len());
            let Some(OneAndTwo { one, two, live }) = ends else { continue };
            for lane in live.paths() {
                let square = |x: f64| x * x;
                let errors = one.iter().zip(two).map(|(one, two)| square(one[lane] - two[lane]));
                squares[lane].add((errors.sum(), two.iter().map(|row| square(row[lane])).sum()));
            }
        }
    }
    squares.iter().map(Squares::means).collect()
}

/// The noise of two steps τ of 32 paths, times a factor, with the areas that `none` has. Lévy areas
/// have one term of their series, since one step and two half steps share them and only their law
/// is that of the series.
pub fn two_steps(
    none: &StepNoise,
    key: StreamKey,
    first_path: u64,
    tau: f64,
    factor: f64,
) -> [StepNoise; 2] {
    let mut wiener = WienerRows::new(key, first_path);
    let mut space_time = WienerRows::new(key.beside(Purpose::SpaceTimeAreas), first_path);
    let sampler = || AreaSampler::new(key, first_path, none.increments.len(), 1);
    let mut areas = (!none.areas.is_empty()).then(sampler);
    // Brownian motion times a factor is Brownian motion of another time.
    let time = tau * factor * factor;
    [(); 2].map(|()| {
        let mut noise = none.clone();
        wiener.increments(time.sqrt(), &mut noise.increments);
        if let Some(areas) = &mut areas {
            areas.areas(time, &noise.increments, &mut noise.areas);
        }
        space_time.increments((time / 12.0).sqrt(), &mut noise.space_time);
        noise
    })
}

/// Stepper from one state on 32 noises. Lanes whose noise is not set have zero noise.
pub struct Steps<'a> {
    /// Scheme and problem of the steps.
    pub setup: &'a Setup<'a>,
    /// The noise of a step, or of the two halves of one.
    pub noises: [StepNoise; 2],
    /// Zero noise, and the noise of both halves together.
    zero: StepNoise,
    both: StepNoise,
    state: Box<dyn Stepper + 'a>,
    /// The ends of whole steps.
    one: Vec<Row>,
}

/// The ends of one step and of two half steps on the same noise, on the paths whose steps succeed.
pub struct OneAndTwo<'a> {
    pub one: &'a [Row],
    pub two: &'a [Row],
    pub live: PathMask,
}

impl<'a> Steps<'a> {
    pub fn new(setup: &'a Setup<'a>) -> Self {
        let start = setup.start();
        let none = || setup.scheme.no_noise(setup.problem.noises);
        Self {
            noises: [none(), none()],
            zero: none(),
            both: none(),
            state: setup.scheme.start(&start[..setup.problem.y0.len()]),
            one: start,
            setup,
        }
    }

    /// Sets the given paths to a state.
    fn set(&mut self, state: &[f64], paths: PathMask) {
        for (row, &y) in self.state.state_mut().iter_mut().zip(state) {
            paths.paths().for_each(|p| row[p] = y);
        }
    }

    /// The ends of steps from `state` on the first `count` of the first noises, on the paths whose
    /// steps succeed.
    pub fn step(&mut self, step: &Step, state: &[f64], count: usize) -> (&[Row], PathMask) {
        self.take_noise(PathMask::ALL.without(PathMask::first(count)));
        self.set(state, PathMask::ALL);
        let mut status = BlockStatus::explicit();
        self.state.step(step, &self.noises[0], &mut status);
        (self.state.state(), PathMask::first(count).without(status.failed))
    }

    /// Zeroes the noise of `paths`, which are not, or no longer, asked for.
    fn take_noise(&mut self, paths: PathMask) {
        let Self { noises, zero, .. } = self;
        noises.iter_mut().for_each(|n| paths.paths().for_each(|p| n.copy_path(p, zero, p)));
    }

    /// Takes a step τ from the visit, and two half steps, on the first `count` of the noises;
    /// `None` if there is no such step.
    pub fn one_and_two(&mut self, visit: &Visit, tau: f64, count: usize) -> Option<OneAndTwo<'_>> {
        self.take_noise(PathMask::ALL.without(PathMask::first(count)));
        // Times are multiples of the step size.
        let n = (visit.t / tau).round() as u64;
        let damping = self.setup.problem.damping;
        let step = |n: u64, tau: f64| Step::new(damping, n, tau).ok();
        let whole = step(n, tau)?;
        let halves = [step(2 * n, 0.5 * tau)?, step(2 * n + 1, 0.5 * tau)?];
        self.both.copy_from(&self.noises[0]);
        self.both.join(&self.noises[1]);
        let (mut live, mut status) = (PathMask::first(count), BlockStatus::explicit());
        self.set(&visit.state, PathMask::ALL);
        self.state.step(&whole, &self.both, &mut status);
        self.one.copy_from_slice(self.state.state());
        self.set(&visit.state, PathMask::ALL);
        for (k, half) in halves.iter().enumerate() {
            live = live.without(status.failed);
            // More steps of a path that failed, which may hold anything, would only cost time.
            self.take_noise(status.failed);
            self.set(&visit.state, status.failed);
            self.state.step(half, &self.noises[k], &mut status);
        }
        live = live.without(status.failed);
        Some(OneAndTwo { one: &self.one, two: self.state.state(), live })
    }
}

#[cfg(test)]
mod tests {
    use noise::Truncation;
    use systems::{Constant, Problem, paper::valid};

    use super::super::tests::{Anything, Single};
    use super::*;

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
            let mut all = |tau: f64, strengths: &[f64]| {
                strengths.iter().map(|&strength| squares(tau, strength)).collect()
            };
            let found = least_order(2.0, &sizes(), &mut all);
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
    fn the_cubature_has_all_moments_up_to_the_fifth() {
        let n = 3;
        let nodes = cubature(n);
        assert_eq!(nodes.len(), 2 * n * n + 1);
        let moment = |powers: [i32; 3]| -> f64 {
            let of = |at: &[f64]| at.iter().zip(powers).map(|(x, k)| x.powi(k)).product::<f64>();
            nodes.iter().map(|(at, weight)| weight * of(at)).sum()
        };
        let normal = |k: i32| [1.0, 0.0, 1.0, 0.0, 3.0, 0.0][k as usize];
        for code in 0..216 {
            let powers = [code % 6, code / 6 % 6, code / 36];
            if powers.iter().sum::<i32>() <= 5 {
                let exact: f64 = powers.into_iter().map(normal).product();
                assert!((moment(powers) - exact).abs() < 1e-14, "{powers:?}");
            }
        }
    }

    #[test]
    fn step_sizes_fall_by_quarters_and_factors_end_where_rounding_shows() {
        let mut asked = Vec::new();
        least_order(2.0, &sizes(), &mut |tau, strengths| {
            asked.push((tau, strengths.to_vec()));
            // Rounding at the first step size without a factor, never with the largest.
            let shows = |&strength: &f64| tau < 0.1 && strength < 2e4 || strength == 1.0;
            strengths.iter().map(|s| (if shows(s) { 0.0 } else { 1.0 }, 1.0)).collect()
        });
        // The reference has 4·2⁴ steps on [0, 2]; a quarter of it, and two quarters more up.
        let expected = (-2..20).map(|n| 2.0 / 64.0 / 4.0 * 0.25f64.powi(n));
        assert!(asked.iter().map(|(tau, _)| *tau).eq(expected));
        assert_eq!((&asked[0].1[..], &asked[1].1[..]), (&AMPLIFICATIONS[..], &AMPLIFICATIONS[1..]));
        assert_eq!(asked[21].1, [65_536.0]);
    }

    #[test]
    fn one_step_and_two_half_steps_share_time_and_noise() {
        // y₁ + 2t + 3τ + 5ΔW, and y₂ + τ².
        let scheme =
            Single(|t, tau, dw, y| [y[0] + 2.0 * t + 3.0 * tau + 5.0 * dw, y[1] + tau * tau]);
        let visit = Visit { t: 0.5, state: vec![1.0, -2.0] };
        let problem = problem();
        let setup = Setup::of(&problem, &scheme);
        let mut steps = Steps::new(&setup);
        for (noise, dw) in steps.noises.iter_mut().zip([0.25, -0.5]) {
            noise.increments[0][..2].copy_from_slice(&[7.0, dw]);
        }
        let OneAndTwo { one, two, live } = steps.one_and_two(&visit, 0.25, 2).unwrap();
        assert_eq!(live, real::PathMask::first(2));
        let path = |y: &[real::Row], p: usize| [y[0][p], y[1][p]];
        assert_eq!(path(one, 1), [1.0 + 1.0 + 0.75 - 1.25, -2.0 + 0.0625]);
        assert_eq!(path(two, 1), [1.0 + (1.0 + 1.25) + 0.75 - 1.25, -2.0 + 2.0 * 0.015_625]);
        // The others have no noise.
        assert_eq!(path(one, 2), [1.0 + 1.0 + 0.75, -2.0 + 0.0625]);
        // Visits whose steps fail are left out of both means.
        let partly =
            Single(|_, tau, _, y| [y[0] + tau.sqrt(), if y[0] > 2.0 { f64::NAN } else { y[1] }]);
        let visits =
            [[1.0, 0.0], [0.5, 1.0], [3.0, 0.0]].map(|y| Visit { t: 0.0, state: y.into() });
        let key = StreamKey { seed: 1, experiment: 1 };
        let setup = Setup::of(&problem, &partly);
        let mut steps = Steps::new(&setup);
        let mut of = |visits: &[Visit]| differences(&mut steps, key, visits, 0.04, &[1.0])[0];
        let (square, size) = of(&visits);
        let (one, two) = (0.2, 2.0 * 0.02f64.sqrt());
        let states = [1.0 + two, 0.5 + two];
        let exact = (states[0] * states[0] + states[1] * states[1] + 1.0) / 2.0;
        assert!((square / ((one - two) * (one - two)) - 1.0).abs() < 1e-12, "{square}");
        assert!((size / exact - 1.0).abs() < 1e-12, "{size} {exact}");
        assert!(of(&visits[2..]).0.is_nan());
    }
}
