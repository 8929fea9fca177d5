//! Orders of solvers that are not ours: their noise goes out, their states come back.
//!
//! A solver gets the increments of every step size, with areas joined by Chen's relation, and gives
//! y(T). Its results are judged as our schemes are: by differences of successive step sizes, by
//! single steps as τ → 0, and by a limit. This is compared with a reference of order one on the
//! finest noise, since the coefficients of the solver are not known.
//!
//! **Noise.** All of it is made of finest steps, those of the reference. Space-time areas H =
//! ∫(W − t ΔW/τ)dt/τ are drawn there, N(0, τ/12), independent of the Lévy areas given W, and joined
//! exactly: H = ½(H₁ + H₂) + ¼(ΔW₁ − ΔW₂).

use mc::{ConformalLaw, LadderError, NextNoise, Observe, Setup, View, drawn};
use noise::{DyadicLadder, Purpose, StepNoise, WienerRows};
use rayon::prelude::*;
use real::{PathMask, Row, WIDTH};
use stats::{Against, CrossMoments};

use super::{
    Decision, Limit, More, OneStep, Order, StepSizes,
    decision::undecided,
    limit::{strong_limit, weak_limit},
    one_step::{least_order, taus, two_steps},
    order::{strong, weak},
    runs::{Collected, state},
};

/// Factors of the noise of single steps; stronger noise would overflow solvers that do not expect
/// it.
const STRENGTHS: [f64; 3] = [1.0, 16.0, 256.0];
/// Number of states from which single steps start.
pub const VISITS: usize = 64;
/// Number of step sizes of single steps.
const SINGLE: usize = 16;
/// Number of paths on which interpretations of the noise are compared.
const FEW: usize = 256;
/// The part of a squared distance that an interpretation may leave.
const EXPLAINED: f64 = 0.25;
/// Rounding errors of a step as a part of a Casimir.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// The noise of a step size, each array by [step, path, noise].
#[derive(Clone, Debug, Default)]
pub struct LevelNoise {
    /// Increments ΔW.
    pub increments: Vec<f64>,
    /// Lévy areas ½∫(W_i dW_j − W_j dW_i), [step, path, i, j]; empty for one noise.
    pub areas: Vec<f64>,
    /// Space-time areas H.
    pub space_time: Vec<f64>,
}

impl LevelNoise {
    /// Adds a step of 32 paths.
    fn push(&mut self, noise: &StepNoise, space_time: &[Row]) {
        let noises = noise.increments.len();
        for p in 0..WIDTH {
            self.increments.extend(noise.increments.iter().map(|row| row[p]));
            self.space_time.extend(space_time.iter().map(|row| row[p]));
            for (i, j) in (0..noises).flat_map(|i| (0..noises).map(move |j| (i, j))) {
                let area = |i: usize, j: usize| noise.areas.get(i * noises + j).map(|row| row[p]);
                let area = if i < j { area(i, j) } else { area(j, i).map(|area| -area) };
                self.areas.extend(area.map(|area| if i == j { 0.0 } else { area }));
            }
        }
    }

    /// Joins `blocks` of 32 paths side by side in each of `steps` steps.
    fn joined(blocks: &[&Self], steps: usize) -> Self {
        let of = |values: fn(&Self) -> &[f64]| -> Vec<f64> {
            let step = |n: usize, all: &[f64]| {
                let length = all.len() / steps;
                all[n * length..(n + 1) * length].to_vec()
            };
            let all = (0..steps).flat_map(|n| blocks.iter().map(move |b| step(n, values(b))));
            all.flatten().collect()
        };
        Self {
            increments: of(|block| &block.increments),
            areas: of(|block| &block.areas),
            space_time: of(|block| &block.space_time),
        }
    }
}

/// Squared distance |a − b|².
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// The space-time area of two steps on this noise.
fn joined_space_time([a, b]: [&[Row]; 2], [one, two]: [&StepNoise; 2]) -> Vec<Row> {
    let of = |m: usize, p: usize| {
        0.5 * (a[m][p] + b[m][p]) + 0.25 * (one.increments[m][p] - two.increments[m][p])
    };
    (0..a.len()).map(|m| std::array::from_fn(|p| of(m, p))).collect()
}

/// Values of φ at the states of the given paths.
fn values(phi: &dyn Observe, d: usize, states: &[f64], paths: &[usize]) -> Vec<f64> {
    let block = |paths: &[usize]| {
        let of = |i: usize, p: usize| paths.get(p).map_or(0.0, |path| states[path * d + i]);
        let rows: Vec<Row> = (0..d).map(|i| std::array::from_fn(|p| of(i, p))).collect();
        phi.values(&rows, PathMask::first(paths.len())).into_iter().take(paths.len())
    };
    paths.chunks(WIDTH).flat_map(block).collect()
}

/// Gives noise to a solver, and judges the states that it gives back.
///
/// A solver of y₁ alone, here of dy = −½y dt + dW by Euler's method:
///
/// ```
/// use std::sync::Arc;
/// use analysis::{LevelNoise, Referee, SolverStates, StepSizes};
/// use formula::{Definition, FormulaSystem};
/// use mc::Setup;
/// use noise::{StreamKey, Truncation};
/// use schemes::Sexp;
/// use systems::{Constant, run_time::Problem};
///
/// let words = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect::<Vec<_>>();
/// let walk = Definition {
///     name: "walk".into(),
///     state: words(&["y", "z"]),
///     structure: vec![words(&["1"])],
///     energy: "0".into(),
///     noises: words(&["z"]),
///     ..Definition::default()
/// };
/// let system = Arc::new(FormulaSystem::new(&walk, &[1.0, 0.0])?);
/// let problem = Problem::new(system, Arc::new(Constant::new(0.5)?), vec![1.0, 0.0], 1.0)?;
/// let key = StreamKey { seed: 1, experiment: 0 };
/// let sizes = StepSizes { refinement: 3, ..StepSizes::new(8, Truncation::new(4)?, key) };
/// let referee = Referee { setup: Setup::at_run_time(&problem, &Sexp)?, sizes };
///
/// let euler = |y0: &[f64], tau: f64, noise: &LevelNoise| -> Vec<f64> {
///     let mut y = y0.to_vec();
///     for dw in noise.increments.chunks(y0.len() / 2) {
///         for (y, dw) in y.chunks_mut(2).zip(dw) {
///             y[0] += -0.5 * tau * y[0] + dw;
///         }
///     }
///     y
/// };
/// let (noise, [start, finest, coarse]) = (referee.noise(0, 512)?, referee.reference(0, 512)?);
/// let taus = (3..).map(|n| 0.5f64.powi(n));
/// let levels = noise.iter().zip(taus).map(|(noise, tau)| euler(&start, tau, noise));
/// let single = referee.single_taus().into_iter().map(|tau| {
///     let [one, two] = referee.single_noise(tau);
///     let y0 = &[0.3, 0.0].repeat(one.increments.len());
///     [euler(y0, tau, &one), euler(y0, 0.5 * tau, &two)]
/// });
/// let (levels, single) = (levels.collect(), single.collect());
/// let states = SolverStates { start, levels, reference: [finest, coarse], single };
/// let found = referee.judge(&[], &states);
/// assert_eq!(found.strong.order(), Some(1.0), "{}", found.strong);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Referee<'a> {
    /// The problem, with a scheme of order one for the reference.
    pub setup: Setup<'a>,
    /// The step sizes of the solver; the reference has the finest of the refinement.
    pub sizes: StepSizes,
}

/// The final states of a solver, each array by [path, component].
#[derive(Clone, Debug, Default)]
pub struct SolverStates {
    /// Initial states.
    pub start: Vec<f64>,
    /// Final states at each step size, coarsest first.
    pub levels: Vec<Vec<f64>>,
    /// Final states of the reference, and of the reference with steps twice as long.
    pub reference: [Vec<f64>; 2],
    /// States after one step and after two half steps, at each of [`Referee::single_taus`]; empty
    /// for a solver that draws noise of its own.
    pub single: Vec<[Vec<f64>; 2]>,
}

/// Judgement on a solver: orders, errors and laws that its states show.
#[derive(Debug)]
pub struct Judged {
    /// The strong order.
    pub strong: Order,
    /// The weak order of each function.
    pub weak: Vec<(String, Order)>,
    /// The step sizes, coarsest first.
    pub taus: Vec<f64>,
    /// Root mean squares of the errors against the reference, coarsest first.
    pub errors: Vec<f64>,
    /// Estimate of the error of the reference.
    pub reference_error: f64,
    /// Name of each law, its largest relative defect, and the part of it that may be rounding.
    pub laws: Vec<(String, f64, f64)>,
    /// Equation that the solver solves instead, if known.
    pub solves: Option<&'static str>,
}

impl Referee<'_> {
    fn noises(&self) -> usize {
        self.setup.problem.noises
    }

    /// Space-time areas of the 32 paths from path number `first` on.
    fn space_time(&self, first: u64) -> WienerRows {
        WienerRows::new(self.sizes.key.beside(Purpose::SpaceTimeAreas), first)
    }

    /// Noise of `paths` paths from path number `first` on, both multiples of 32, at every step size
    /// of the solver, coarsest first.
    ///
    /// # Errors
    /// [`LadderError`] if areas would take too many terms.
    pub fn noise(&self, first: u64, paths: usize) -> Result<Vec<LevelNoise>, LadderError> {
        let sizes = &self.sizes;
        let tau = self.setup.problem.t_end / sizes.reference_steps() as f64;
        let areas = (self.noises() > 1).then_some(self.noises());
        let source = drawn(sizes.key.paths_of(Purpose::Paths)?, tau, areas)?;
        let blocks = (0..paths / WIDTH).into_par_iter().map(|block| {
            let first = first + (block * WIDTH) as u64;
            self.block(first, tau, source(first))
        });
        let blocks: Vec<_> = blocks.collect();
        let of_level = |l: usize| {
            let blocks: Vec<&LevelNoise> = blocks.iter().map(|block| &block[l]).collect();
            LevelNoise::joined(&blocks, (sizes.coarsest_steps << l) as usize)
        };
        Ok((0..sizes.levels).map(of_level).collect())
    }

    /// The noise of 32 paths.
    fn block(&self, first: u64, tau: f64, mut next: NextNoise) -> Vec<LevelNoise> {
        let (sizes, mut others) = (&self.sizes, self.space_time(first));
        let (top, finest) = (sizes.level(0), sizes.refinement as usize);
        let mut ladder = DyadicLadder::new(top, &StepNoise::none(self.noises(), self.noises() > 1));
        let zero = vec![[0.0; WIDTH]; self.noises()];
        // Of the whole step of each level, and of its first half.
        let (mut whole, mut half) = (vec![zero.clone(); top + 1], vec![zero; top + 2]);
        let mut found = vec![LevelNoise::default(); sizes.levels];
        for _ in 0..sizes.reference_steps() {
            let complete = ladder.push(|noise| next(noise));
            others.increments((tau / 12.0).sqrt(), &mut whole[0]);
            for level in 1..=complete {
                let noise = [ladder.first_half(level), ladder.whole(level - 1)];
                whole[level] = joined_space_time([&half[level], &whole[level - 1]], noise);
            }
            half[complete + 1].clone_from(&whole[complete]);
            for level in finest..=complete {
                found[top - level].push(ladder.whole(level), &whole[level]);
            }
        }
        found
    }

    /// The states of paths at time 0, and at the end by the reference and by its steps of twice the
    /// size, [path, component]; NaN where it fails.
    ///
    /// # Errors
    /// [`LadderError`] as in [`Setup::ladder`].
    pub fn reference(&self, first: u64, paths: usize) -> Result<[Vec<f64>; 3], LadderError> {
        let Self { setup, sizes } = self;
        let d = setup.problem.y0.len();
        let ladder = sizes.ladder(setup, sizes.reference_steps(), 1, paths as u64)?;
        let end = |view: &View<'_>, p: usize| {
            let last = view.time == ladder.coarse_steps();
            last.then(|| (view.first_path + p as u64, [1, 0].map(|run| state(view, run, p))))
        };
        let new = || Collected { of: &end, found: Vec::new() };
        let ends = ladder.run_until(&sizes.stop, first, paths as u64, new).statistic.found;
        let mut found = [(); 3].map(|()| vec![f64::NAN; paths * d]);
        for block in (0..paths).step_by(WIDTH) {
            let start = setup.problem.start(sizes.key, first + block as u64);
            for (p, y) in found[0][block * d..(block + WIDTH) * d].chunks_mut(d).enumerate() {
                y.iter_mut().zip(&start).for_each(|(y, row)| *y = row[p]);
            }
        }
        for (path, states) in ends {
            let at = (path - first) as usize * d;
            for (found, state) in found[1..].iter_mut().zip(states) {
                found[at..at + d].copy_from_slice(&state[..d]);
            }
        }
        Ok(found)
    }

    /// The step sizes of single steps.
    pub fn single_taus(&self) -> Vec<f64> {
        taus(self.setup.problem.t_end, &self.sizes).take(SINGLE).collect()
    }

    /// The noise of one step and of two half steps from each of [`VISITS`] states, and from these
    /// again with stronger noise, by [strength, state].
    pub fn single_noise(&self, tau: f64) -> [LevelNoise; 2] {
        let (noises, key) = (self.noises(), self.sizes.key);
        let block = |strength: f64, first: u64| {
            let [mut one, two] = two_steps(noises, noises > 1, key, first, 0.5 * tau, strength);
            let mut others = self.space_time(first);
            let [a, b] = [(); 2].map(|()| {
                let mut areas = vec![[0.0; WIDTH]; noises];
                others.increments((tau / 24.0).sqrt() * strength, &mut areas);
                areas
            });
            let [mut whole, mut halves] = [(); 2].map(|()| LevelNoise::default());
            halves.push(&one, &a);
            halves.push(&two, &b);
            let space_time = joined_space_time([&a, &b], [&one, &two]);
            one.join(&two);
            whole.push(&one, &space_time);
            [whole, halves]
        };
        let firsts = || (0..VISITS as u64).step_by(WIDTH);
        let of = |strength: f64| firsts().map(move |first| block(strength, first));
        let blocks: Vec<[LevelNoise; 2]> = STRENGTHS.into_iter().flat_map(of).collect();
        [0, 1].map(|n| {
            let blocks: Vec<&LevelNoise> = blocks.iter().map(|block| &block[n]).collect();
            LevelNoise::joined(&blocks, n + 1)
        })
    }

    /// Judges the strong order of a solver, its weak order for functions, and laws, by its states.
    pub fn judge(&self, observables: &[&dyn Observe], states: &SolverStates) -> Judged {
        let Self { setup: Setup { problem, .. }, sizes } = self;
        let (d, levels, number) =
            (problem.y0.len(), sizes.levels, states.start.len() / problem.y0.len());
        // At each step size, and of the reference.
        let all: Vec<&Vec<f64>> = states.levels.iter().chain(&states.reference).collect();
        let of = |level: usize, path: usize| &all[level][path * d..(path + 1) * d];
        let finite =
            |path: &usize| (0..all.len()).all(|l| of(l, *path).iter().all(|y| y.is_finite()));
        let (paths, failing): (Vec<usize>, Vec<usize>) = (0..number).partition(finite);
        // Differences, errors against the reference, and one of the reference.
        let mut squares = CrossMoments::new(2 * levels);
        for &path in &paths {
            let to_reference = (0..levels).map(|l| distance(of(l, path), of(levels, path)));
            let next = (1..levels).map(|l| distance(of(l - 1, path), of(l, path)));
            let own = distance(of(levels, path), of(levels + 1, path));
            squares.add(&next.chain(to_reference).chain([own]).collect::<Vec<f64>>());
        }
        let (differences, errors) =
            (squares.part(0..levels - 1), squares.part(levels - 1..2 * levels - 1));
        let reference_error = squares.mean(2 * levels - 1).sqrt();
        let limit = strong_limit(&errors, &differences, reference_error);
        let taus = sizes.taus(problem.t_end)[..levels].to_vec();
        let between = &taus[..levels - 1];
        let mut strong = strong(between, &differences, self.one_step(&states.single), limit);
        // Of a solver that is exact the differences are rounding errors.
        let steps = sizes.coarsest_steps << (levels - 1);
        let size: f64 = states.start.iter().map(|y| y * y).sum::<f64>() / number as f64;
        let rounding = (ROUND_OFF * steps as f64).powi(2) * size;
        let exact = differences.means().into_iter().all(|square| square <= rounding);
        if exact && matches!(limit, Limit::Agrees { .. }) {
            strong.decision = Decision::Kept;
        }
        let solves = match limit {
            Limit::Differs { .. } if !states.single.is_empty() => self.solves(states, &paths),
            _ => None,
        };
        let weak = observables.iter().map(|phi| {
            let values = |y: &[f64], paths: &[usize]| values(*phi, d, y, paths);
            let at: Vec<Vec<f64>> = all.iter().map(|y| values(y, &paths)).collect();
            let mut moments = CrossMoments::new(levels);
            for k in 0..paths.len() {
                // The weak error of the reference is extrapolated.
                let last = at[levels - 1][k] - (2.0 * at[levels][k] - at[levels + 1][k]);
                let next = (1..levels).map(|l| at[l - 1][k] - at[l][k]);
                moments.add(&next.chain([last]).collect::<Vec<f64>>());
            }
            let rounding = (steps, values(&states.start, &[0])[0]);
            let (fitted, limit) = (moments.part(0..levels - 1), weak_limit(&moments));
            let order = weak(between, &fitted, Against::HalfStep, limit, rounding);
            (phi.name().to_owned(), order)
        });
        let mut weak: Vec<(String, Order)> = weak.collect();
        // Paths that converge have means that converge.
        let other = weak.iter().find(|(_, order)| matches!(order.limit, Limit::Differs { .. }));
        if let Some((_, order)) = other {
            (strong.limit, strong.decision) = (order.limit, Decision::WrongLimit);
        }
        for order in [&mut strong].into_iter().chain(weak.iter_mut().map(|(_, order)| order)) {
            order.failed = failing.len() as u64;
            // The rest says little about the solver.
            if 10 * failing.len() > number {
                let because = format!("{} of {number} paths failed", failing.len());
                (order.rate, order.one_step) = (None, None);
                order.decision = undecided(More::Steps, because);
            }
            order.settle();
        }
        let laws = self.laws(states, &paths);
        let errors = errors.means().into_iter().map(f64::sqrt).collect();
        Judged { strong, weak, taus, errors, reference_error, laws, solves }
    }

    /// The order of single steps.
    fn one_step(&self, single: &[[Vec<f64>; 2]]) -> Option<OneStep> {
        let d = self.setup.problem.y0.len();
        let mut known = single.iter();
        least_order(self.setup.problem.t_end, &self.sizes, &mut |_, strengths| {
            let Some(ends) = known.next() else { return Vec::new() };
            let of = |place: usize| {
                let range = place * VISITS * d..(place + 1) * VISITS * d;
                let [one, two] = ends.each_ref().map(|ends| ends[range.clone()].chunks(d));
                let (mut square, mut size, mut count) = (0.0, 0.0, 0.0);
                let finite = |(a, b): &(&[f64], &[f64])| a.iter().chain(*b).all(|y| y.is_finite());
                for (one, two) in one.zip(two).filter(finite) {
                    square += distance(one, two);
                    size += two.iter().map(|y| y * y).sum::<f64>();
                    count += 1.0;
                }
                (square / count, size / count)
            };
            let places = strengths.iter().filter_map(|a| STRENGTHS.iter().position(|b| a == b));
            places.map(of).collect()
        })
    }

    /// The largest defects of laws at the end, over all paths and step sizes, beside rounding.
    fn laws(&self, states: &SolverStates, paths: &[usize]) -> Vec<(String, f64, f64)> {
        let (problem, coarsest) = (&self.setup.problem, self.sizes.coarsest_steps);
        let (d, t_end) = (problem.y0.len(), problem.t_end);
        let integrals: Vec<f64> = problem.dampings().map(|one| one.integral(0.0, t_end)).collect();
        let of = |law: &ConformalLaw<'_>| {
            let levels = states.levels.iter().enumerate();
            let all = levels.flat_map(|level| paths.iter().map(move |path| (level, path)));
            let defects = all.map(|((l, level), path)| {
                let at = |states: &[f64]| (law.value)(&states[path * d..(path + 1) * d]);
                let exact = law.decay(&integrals) * at(&states.start);
                let defect = (at(level) - exact).abs() / exact.abs().max(f64::MIN_POSITIVE);
                (defect, ROUND_OFF * (coarsest << l) as f64)
            });
            let worst = defects.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
            let (defect, rounding) = worst.unwrap_or_default();
            (law.name.clone(), defect, rounding)
        };
        problem.laws.iter().map(of).collect()
    }

    /// Finds another interpretation of the noise that has the limit of a solver: Euler's method on
    /// the noise of the reference, with a multiple of the Itô correction.
    fn solves(&self, states: &SolverStates, paths: &[usize]) -> Option<&'static str> {
        let Self { setup: Setup { problem, .. }, sizes } = self;
        let (d, steps) = (problem.y0.len(), sizes.reference_steps());
        let tau = problem.t_end / steps as f64;
        let finest = states.levels.last()?;
        // The squared distance from the ends of Euler's method, of the paths of a block.
        let of_block = |part: f64, paths: &[usize]| -> f64 {
            let mut wiener = WienerRows::new(sizes.key, (paths[0] / WIDTH * WIDTH) as u64);
            let mut dw = vec![[0.0; WIDTH]; problem.noises];
            let at = |states: &[f64], path: &usize| states[path * d..(path + 1) * d].to_vec();
            let mut ends: Vec<_> = paths.iter().map(|path| at(&states.start, path)).collect();
            for n in 0..steps {
                let t = n as f64 * tau;
                wiener.increments(tau.sqrt(), &mut dw);
                // Friction is in the drift.
                let rate = problem.damping.rate(t);
                for (y, path) in ends.iter_mut().zip(paths) {
                    let at = (problem.coefficients)(t, y);
                    for i in 0..d {
                        let drift = at.drift[i] + part * at.correction[i] - rate * y[i];
                        let noises = at.noises.iter().zip(&dw);
                        let noise: f64 = noises.map(|(b, dw)| b[i] * dw[path % WIDTH]).sum();
                        y[i] += drift * tau + noise;
                    }
                }
            }
            paths.iter().zip(&ends).map(|(path, end)| distance(&at(finest, path), end)).sum()
        };
        let few: Vec<usize> = paths.iter().copied().filter(|&path| path < FEW).collect();
        let blocks: Vec<&[usize]> = few.chunk_by(|a, b| a / WIDTH == b / WIDTH).collect();
        let distance = |part: f64| -> f64 {
            let of_blocks = blocks.par_iter().map(|paths| of_block(part, paths));
            of_blocks.collect::<Vec<f64>>().iter().sum()
        };
        let wrong = [
            (0.0, "the equation in the sense of Itô, without the correction ½Σb′b"),
            (0.5, "an equation with half of the Itô correction ½Σb′b"),
            (2.0, "an equation with twice the Itô correction ½Σb′b"),
        ];
        let found = wrong.map(|(part, words)| (distance(part), words));
        let (least, words) = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        (least < EXPLAINED * distance(1.0)).then_some(words)
    }
}
