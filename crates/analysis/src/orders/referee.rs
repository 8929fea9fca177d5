//! Orders of solvers that are not ours: their noise goes out, their states come back.
//!
//! A solver gets the increments of every step size, with areas joined by Chen's relation, and gives
//! y(T). What it shows is judged as our schemes are: by differences of successive step sizes, by
//! single steps as τ → 0, and by a limit. This is compared with a reference of order one on the
//! finest noise, since the coefficients of the solver are not known.
//!
//! **Noise.** All of it is made of finest steps, those of the reference. Space-time areas H =
//! ∫(W − t ΔW/τ)dt/τ are drawn there, N(0, τ/12), independent of the Lévy areas given W, and joined
//! exactly: H = ½(H₁ + H₂) + ¼(ΔW₁ − ΔW₂).

use std::sync::Arc;

use mc::{Ladder, LadderError, NextNoise, Observe, Run, Setup, Statistic, View, drawn};
use noise::{DyadicLadder, Purpose, StepNoise, StreamKey, WienerRows};
use rayon::prelude::*;
use real::{PathMask, Row, WIDTH};
use stats::{Against, CrossMoments};

use super::{
    Decision, Limit, More, Order, StepSizes,
    decision::undecided,
    limit::{strong_limit, weak_limit},
    one_step::{least_order, taus, two_steps},
    order::{evaluate, strong, weak},
};

/// Factors of the noise of single steps; stronger noise would overflow solvers that do not expect
/// it.
const STRENGTHS: [f64; 3] = [1.0, 16.0, 256.0];
/// States from which single steps start.
pub const VISITS: usize = 64;
/// Step sizes of single steps.
const SINGLE: usize = 16;
/// Paths that interpretations of the noise are compared on.
const FEW: usize = 256;
/// The part of a squared distance that an interpretation may leave.
const EXPLAINED: f64 = 0.25;
/// Rounding errors of a step as a part of a Casimir.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// The noise of a step size, each array by [step, path, noise].
#[derive(Clone, Debug, Default)]
pub struct LevelNoise {
    /// ΔW.
    pub increments: Vec<f64>,
    /// Lévy areas ½∫(W_i dW_j − W_j dW_i), [step, path, i, j]; none of one noise.
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

    /// Blocks of 32 paths side by side in each of these steps.
    fn joined(blocks: &[&Self], steps: usize) -> Self {
        let of = |values: fn(&Self) -> &Vec<f64>| -> Vec<f64> {
            let mut all = Vec::new();
            for n in 0..steps {
                for block in blocks {
                    let length = values(block).len() / steps;
                    all.extend(&values(block)[n * length..(n + 1) * length]);
                }
            }
            all
        };
        let increments = of(|block| &block.increments);
        Self {
            increments,
            areas: of(|block| &block.areas),
            space_time: of(|block| &block.space_time),
        }
    }
}

/// |a − b|².
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// The space-time area of two steps.
fn joined_space_time(first: &[Row], second: &[Row], dw: [&[Row]; 2]) -> Vec<Row> {
    let of = |m: usize| {
        std::array::from_fn(|p| {
            0.5 * (first[m][p] + second[m][p]) + 0.25 * (dw[0][m][p] - dw[1][m][p])
        })
    };
    (0..first.len()).map(of).collect()
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
    /// At time 0.
    pub start: Vec<f64>,
    /// At each step size, coarsest first.
    pub levels: Vec<Vec<f64>>,
    /// Those of the reference, and with steps twice as long.
    pub reference: [Vec<f64>; 2],
    /// After one step, and after two half steps, at each of [`Referee::single_taus`]; none of a
    /// solver that draws noise of its own.
    pub single: Vec<[Vec<f64>; 2]>,
}

/// What the states of a solver show.
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
    /// That of the reference, about.
    pub reference_error: f64,
    /// For each law its name, the largest relative defect, and how much of it may be rounding.
    pub laws: Vec<(String, f64, f64)>,
    /// What the solver solves instead.
    pub solves: Option<&'static str>,
}

impl Referee<'_> {
    fn noises(&self) -> usize {
        self.setup.problem.noises
    }

    fn no_noise(&self) -> StepNoise {
        match self.noises() {
            noises @ ..=1 => StepNoise::zero(noises),
            noises => StepNoise::with_areas(noises),
        }
    }

    fn space_time_key(&self) -> StreamKey {
        self.sizes.key.beside(Purpose::SpaceTimeAreas)
    }

    /// The noise of so many paths from path number `first` on, multiples of 32, at every step size
    /// of the solver, coarsest first.
    ///
    /// # Errors
    /// [`LadderError`] if areas would take too many terms.
    pub fn noise(&self, first: u64, paths: usize) -> Result<Vec<LevelNoise>, LadderError> {
        let sizes = &self.sizes;
        let steps = sizes.reference_steps();
        let tau = self.setup.problem.t_end / steps as f64;
        let areas = (self.noises() > 1).then_some(self.noises());
        let source = drawn(sizes.key.paths_of(Purpose::Paths)?, tau, areas)?;
        let blocks = (0..paths / WIDTH).into_par_iter();
        let blocks: Vec<_> = blocks
            .map(|block| {
                let first = first + (block * WIDTH) as u64;
                self.block(first, steps, tau, source(first))
            })
            .collect();
        let of_level = |l: usize| {
            let blocks: Vec<&LevelNoise> = blocks.iter().map(|block| &block[l]).collect();
            LevelNoise::joined(&blocks, (sizes.coarsest_steps << l) as usize)
        };
        Ok((0..sizes.levels).map(of_level).collect())
    }

    /// The noise of 32 paths.
    fn block(&self, first: u64, steps: u64, tau: f64, mut next: NextNoise) -> Vec<LevelNoise> {
        let (sizes, noises) = (&self.sizes, self.noises());
        let (top, finest) = (sizes.level(0), sizes.refinement as usize);
        let mut others = WienerRows::new(self.space_time_key(), first);
        let mut ladder = DyadicLadder::new(top, || self.no_noise());
        let zero = vec![[0.0; WIDTH]; noises];
        // Of the whole step of each level, and of its first half.
        let (mut whole, mut half) = (vec![zero.clone(); top + 1], vec![zero; top + 2]);
        let mut found = vec![LevelNoise::default(); sizes.levels];
        for _ in 0..steps {
            let complete = ladder.push(|noise| next(noise));
            others.increments((tau / 12.0).sqrt(), &mut whole[0]);
            for level in 1..=complete {
                let dw = [ladder.first_half(level), ladder.whole(level - 1)];
                let dw = dw.map(|noise| &noise.increments[..]);
                whole[level] = joined_space_time(&half[level], &whole[level - 1], dw);
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
    /// [`LadderError`] as of a [`Ladder`].
    pub fn reference(&self, first: u64, paths: usize) -> Result<[Vec<f64>; 3], LadderError> {
        let Self { setup: Setup { problem, scheme }, sizes } = self;
        let d = problem.y0.len();
        let runs = [0, 1].map(|level| Run::new(Arc::clone(scheme), level)).into();
        let (steps, levels) = (sizes.reference_steps(), sizes.level(0));
        let ladder = Ladder::new(problem, steps, levels, sizes.truncation, sizes.key, runs)?;
        let none = || Ends { time: ladder.coarse_steps(), d, ends: Vec::new() };
        let ends = ladder.run_until(&sizes.stop, first, paths as u64, none).statistic.ends;
        let mut found = [(); 3].map(|()| vec![f64::NAN; paths * d]);
        for block in (0..paths).step_by(WIDTH) {
            let start = problem.start(sizes.key, first + block as u64);
            for (p, y) in found[0][block * d..(block + WIDTH) * d].chunks_mut(d).enumerate() {
                y.iter_mut().zip(&start).for_each(|(y, row)| *y = row[p]);
            }
        }
        for (path, states) in ends {
            let at = (path - first) as usize * d;
            for (found, state) in found[1..].iter_mut().zip(states) {
                found[at..at + d].copy_from_slice(&state);
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
        let noises = self.noises();
        let mut blocks = [Vec::new(), Vec::new()];
        for (strength, first) in
            STRENGTHS.iter().flat_map(|a| (0..VISITS).step_by(WIDTH).map(move |b| (a, b)))
        {
            let key = self.sizes.key;
            let drawn = two_steps(noises, noises > 1, key, first as u64, 0.5 * tau, *strength);
            let mut others = WienerRows::new(self.space_time_key(), first as u64);
            let areas = [(); 2].map(|()| {
                let mut areas = vec![[0.0; WIDTH]; noises];
                others.increments((tau / 24.0).sqrt() * strength, &mut areas);
                areas
            });
            let mut both = LevelNoise::default();
            let halves = drawn.iter().zip(&areas);
            halves.for_each(|(noise, space_time)| both.push(noise, space_time));
            let dw = drawn.each_ref().map(|noise| &noise.increments[..]);
            let space_time = joined_space_time(&areas[0], &areas[1], dw);
            let [mut one, second] = drawn;
            one.join(&second);
            let mut whole = LevelNoise::default();
            whole.push(&one, &space_time);
            blocks[0].push(whole);
            blocks[1].push(both);
        }
        let joined = |number: usize| {
            let blocks: Vec<&LevelNoise> = blocks[number].iter().collect();
            LevelNoise::joined(&blocks, number + 1)
        };
        [joined(0), joined(1)]
    }

    /// What the states of a solver show of its strong order, of its weak order for functions, and
    /// of laws.
    pub fn judge(&self, observables: &[&dyn Observe], states: &SolverStates) -> Judged {
        let Self { setup: Setup { problem, .. }, sizes } = self;
        let (d, levels) = (problem.y0.len(), sizes.levels);
        let steps = sizes.coarsest_steps << (levels - 1);
        let all: Vec<&[f64]> = states.levels.iter().map(|level| &level[..]).collect();
        let all = [all, states.reference.iter().map(|level| &level[..]).collect()].concat();
        let finite = |path: &usize| {
            all.iter().all(|y| y[path * d..(path + 1) * d].iter().all(|y| y.is_finite()))
        };
        let (paths, failed): (Vec<usize>, Vec<usize>) =
            (0..states.start.len() / d).partition(finite);
        let of = |level: usize, path: usize| &all[level][path * d..(path + 1) * d];
        // Differences, errors against the reference, and one of the reference.
        let mut squares = CrossMoments::new(2 * levels);
        for &path in &paths {
            let to_reference = (0..levels).map(|l| distance(of(l, path), of(levels, path)));
            let next = (1..levels).map(|l| distance(of(l - 1, path), of(l, path)));
            let own = distance(of(levels, path), of(levels + 1, path));
            squares.add(&next.chain(to_reference).chain([own]).collect::<Vec<f64>>());
        }
        let taus = &sizes.taus(problem.t_end)[..levels - 1];
        let (differences, errors) =
            (squares.part(0..levels - 1), squares.part(levels - 1..2 * levels - 1));
        let reference_error = squares.mean(2 * levels - 1).sqrt();
        let limit = strong_limit(&errors, &differences, reference_error);
        let mut strong = strong(taus, &differences, self.one_step(&states.single), limit);
        strong.failed = failed.len() as u64;
        // Of a solver that is exact the differences are rounding errors.
        let all_paths = paths.len() + failed.len();
        let size: f64 = states.start.iter().map(|y| y * y).sum::<f64>() / all_paths as f64;
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
            let mut moments = CrossMoments::new(levels);
            for paths in paths.chunks(WIDTH) {
                let live = PathMask::first(paths.len());
                let values = |level: usize| {
                    let row = |i: usize| {
                        std::array::from_fn(|p| {
                            paths.get(p).map_or(0.0, |&path| of(level, path)[i])
                        })
                    };
                    evaluate(*phi, &(0..d).map(row).collect::<Vec<Row>>(), live)
                };
                let values: Vec<Row> = (0..levels + 2).map(values).collect();
                for p in live.paths() {
                    let at = |level: usize| values[level][p];
                    // The weak error of the reference is extrapolated.
                    let limit = 2.0 * at(levels) - at(levels + 1);
                    let next = (1..levels).map(|l| at(l - 1) - at(l));
                    let last = at(levels - 1) - limit;
                    moments.add(&next.chain([last]).collect::<Vec<f64>>());
                }
            }
            let y0: Vec<Row> = states.start[..d].iter().map(|&y| [y; WIDTH]).collect();
            let size = evaluate(*phi, &y0, PathMask::first(1))[0];
            let (fitted, limit) = (moments.part(0..levels - 1), weak_limit(&moments));
            let order = weak(taus, &fitted, Against::HalfStep, limit, (steps, size));
            (phi.name().to_owned(), Order { failed: failed.len() as u64, ..order })
        });
        let mut weak: Vec<(String, Order)> = weak.collect();
        // Paths that converge have means that converge.
        let other = weak.iter().find(|(_, order)| matches!(order.limit, Limit::Differs { .. }));
        if let Some((_, order)) = other {
            (strong.limit, strong.decision) = (order.limit, Decision::WrongLimit);
        }
        // The rest says little about the solver.
        if 10 * failed.len() > all_paths {
            let because = format!("{} of {all_paths} paths failed", failed.len());
            for order in [&mut strong].into_iter().chain(weak.iter_mut().map(|(_, order)| order)) {
                (order.rate, order.one_step) = (None, None);
                order.decision = undecided(More::Steps, because.clone());
            }
        }
        let weak = weak.into_iter().map(|(name, order)| (name, order.settled())).collect();
        Judged {
            weak,
            taus: sizes.taus(problem.t_end)[..levels].to_vec(),
            errors: errors.means().into_iter().map(f64::sqrt).collect(),
            reference_error,
            laws: self.laws(states, &paths),
            solves,
            strong: strong.settled(),
        }
    }

    /// The order of single steps.
    fn one_step(&self, single: &[[Vec<f64>; 2]]) -> Option<super::OneStep> {
        let d = self.setup.problem.y0.len();
        let mut known = single.iter();
        least_order(self.setup.problem.t_end, &self.sizes, &mut |_, strengths| {
            let Some([one, two]) = known.next() else { return Vec::new() };
            let of = |strength: &f64| {
                let place = STRENGTHS.iter().position(|a| a == strength).unwrap_or(0);
                let range = place * VISITS * d..(place + 1) * VISITS * d;
                let pairs = one[range.clone()].chunks(d).zip(two[range].chunks(d));
                let (mut square, mut size, mut count) = (0.0, 0.0, 0.0);
                for (one, two) in pairs.filter(|(a, b)| a.iter().chain(*b).all(|y| y.is_finite())) {
                    square += distance(one, two);
                    size += two.iter().map(|y| y * y).sum::<f64>();
                    count += 1.0;
                }
                (square / count, size / count)
            };
            strengths.iter().filter(|strength| STRENGTHS.contains(strength)).map(of).collect()
        })
    }

    /// The largest defects of laws at the end, over all paths and step sizes.
    fn laws(&self, states: &SolverStates, paths: &[usize]) -> Vec<(String, f64, f64)> {
        let (problem, sizes) = (&self.setup.problem, &self.sizes);
        let (d, t_end) = (problem.y0.len(), problem.t_end);
        let integrals: Vec<f64> =
            problem.dampings().map(|damping| damping.integral(0.0, t_end)).collect();
        let of = |law: &mc::ConformalLaw<'_>| {
            let mut worst = (0.0f64, 0.0f64);
            for (l, level) in states.levels.iter().enumerate() {
                let rounding = ROUND_OFF * (sizes.coarsest_steps << l) as f64;
                for path in paths {
                    let at = |states: &[f64]| (law.value)(&states[path * d..(path + 1) * d]);
                    let exact = law.decay(&integrals) * at(&states.start);
                    let defect = (at(level) - exact).abs() / exact.abs().max(f64::MIN_POSITIVE);
                    if defect / rounding >= worst.0 / worst.1 || worst.1 == 0.0 {
                        worst = (defect, rounding);
                    }
                }
            }
            (law.name.clone(), worst.0, worst.1)
        };
        problem.laws.iter().map(of).collect()
    }

    /// Which other interpretation of the noise has the limit of a solver: Euler's method on the
    /// noise of the reference, with a multiple of the Itô correction.
    fn solves(&self, states: &SolverStates, paths: &[usize]) -> Option<&'static str> {
        let Self { setup: Setup { problem, .. }, sizes } = self;
        let (d, steps) = (problem.y0.len(), sizes.reference_steps());
        let tau = problem.t_end / steps as f64;
        let finest = states.levels.last()?;
        // The squared distance from the ends of Euler's method, of the paths of a block.
        let of_block = |part: f64, paths: &[usize]| -> f64 {
            let block = (paths[0] / WIDTH * WIDTH) as u64;
            let mut wiener = WienerRows::new(sizes.key, block);
            let mut dw = vec![[0.0; WIDTH]; problem.noises];
            let state = |path: &usize| states.start[path * d..(path + 1) * d].to_vec();
            let mut ends: Vec<Vec<f64>> = paths.iter().map(state).collect();
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
            let found = paths.iter().map(|path| &finest[path * d..(path + 1) * d]);
            found.zip(&ends).map(|(a, b)| distance(a, b)).sum()
        };
        let few: Vec<usize> = paths.iter().copied().filter(|&path| path < FEW).collect();
        let blocks: Vec<&[usize]> = few.chunk_by(|a, b| a / WIDTH == b / WIDTH).collect();
        let distance = |part: f64| -> f64 {
            let of_blocks = blocks.par_iter().map(|paths| of_block(part, paths));
            of_blocks.collect::<Vec<f64>>().iter().sum()
        };
        let right = distance(1.0);
        let wrong = [
            (0.0, "the equation in the sense of Itô, without the correction ½Σb′b"),
            (0.5, "an equation with half of the Itô correction ½Σb′b"),
            (2.0, "an equation with twice the Itô correction ½Σb′b"),
        ];
        let found = wrong.map(|(part, words)| (distance(part), words));
        let least = found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
        (least.0 < EXPLAINED * right).then_some(least.1)
    }
}

/// Final states of two runs by path.
struct Ends {
    time: u64,
    d: usize,
    ends: Vec<(u64, [Vec<f64>; 2])>,
}

impl Statistic for Ends {
    fn observe(&mut self, view: &View<'_>) {
        if view.time == self.time {
            for p in view.live.paths() {
                let of = |run| view.state(run)[..self.d].iter().map(|row| row[p]).collect();
                self.ends.push((view.first_path + p as u64, [0, 1].map(of)));
            }
        }
    }

    fn merge(&mut self, later: Self) {
        self.ends.extend(later.ends);
    }
}
