//! The ladder against paths followed one at a time, its reproducibility, and what it does with
//! paths that fail.

use std::sync::atomic::{AtomicU64, Ordering};

use mc::{
    Cause, Ladder, LadderError, Run, RunError, Setup, Simulation, Statistic, TimeSeries, View, bind,
};
use noise::{
    AreaPath, Noise, NoiseError, StreamKey, Truncation, WienerPath, strong_order_one_error,
};
use schemes::{EulerMaruyama, Midpoint, Scheme, Sexp, SexpLevy, Step};
use systems::{Constant, Cosine, Damping, PoissonSystem, Problem, RigidBody};

use crate::driver::{BackwardEuler, Euler};
use crate::explosive::Explosive;

pub type Body = Problem<RigidBody<3>, Cosine, 3>;

pub fn body() -> Body {
    let system = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).unwrap();
    Problem::new(system, Cosine::new(0.5, 2.0).unwrap(), [1.1f64.cos(), 0.0, 1.1f64.sin()], 1.0)
        .unwrap()
}

pub const KEY: StreamKey = StreamKey { seed: 5, experiment: 9 };

/// Keeps every final state of every run, in order.
pub struct Keep<const D: usize> {
    last_time: u64,
    pub runs: Vec<Vec<[f64; D]>>,
}

impl<const D: usize> Keep<D> {
    pub fn new(last_time: u64, runs: usize) -> Self {
        Self { last_time, runs: vec![Vec::new(); runs] }
    }
}

impl<const D: usize> Statistic for Keep<D> {
    fn observe(&mut self, view: &View<'_>) {
        if view.time == self.last_time {
            for (run, kept) in self.runs.iter_mut().enumerate() {
                kept.extend(view.live.paths().map(|p| view.path::<D>(run, p)));
            }
        }
    }
    fn merge(&mut self, later: Self) {
        for (kept, more) in self.runs.iter_mut().zip(later.runs) {
            kept.extend(more);
        }
    }
}

/// So many finest steps and levels, with increments clipped by `k`.
pub fn ladder<'a, S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &'a Problem<S, G, D>,
    (steps, levels): (u64, usize),
    k: u32,
    runs: Vec<Run<'a>>,
) -> Result<Ladder<'a>, LadderError> {
    let truncation = Truncation::new(k).unwrap();
    Ladder::new(&mc::Problem::of(problem), steps, levels, truncation, KEY, runs)
}

/// What `run` gives on so many threads.
pub fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// A path of a problem, from a table.
pub fn path<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    problem: &Problem<S, G, D>,
    scheme: &dyn Scheme<S, D, M>,
    steps: u64,
    truncation: Truncation,
    path: u64,
) -> Result<TimeSeries, RunError> {
    Simulation::new(Setup::of(problem, scheme), truncation).path(steps, KEY, path)
}

/// Chen's relation, written out once more.
fn join(first: &Noise<3>, second: &Noise<3>) -> Noise<3> {
    let (v, w) = (first.increments, second.increments);
    let areas = std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let wedge = v[i] * w[j] - w[i] * v[j];
            (first.areas[i][j] + second.areas[i][j]) + 0.5 * wedge
        })
    });
    Noise { areas, ..Noise::increments(std::array::from_fn(|m| v[m] + w[m])) }
}

/// The final state of one path at 2^level finest steps a step, by hand: fine increments summed
/// pairwise and their areas joined, clipped, optionally with the two halves of every pair of steps
/// exchanged.
fn by_hand(
    problem: &Body,
    scheme: &dyn Scheme<RigidBody<3>, 3, 3>,
    steps: u64,
    level: u32,
    path: u64,
    swapped: bool,
) -> [f64; 3] {
    let fine_tau = problem.t_end() / steps as f64;
    let mut wiener = WienerPath::<3>::new(KEY, path);
    let terms = noise::area_terms(strong_order_one_error(fine_tau), fine_tau, 3).unwrap();
    let mut area_noise = AreaPath::<3>::new(KEY, path, terms);
    let draw = |_| {
        let increments = wiener.increments(fine_tau.sqrt());
        Noise { areas: area_noise.areas(fine_tau, increments), ..Noise::increments(increments) }
    };
    let mut noises: Vec<Noise<3>> = (0..steps).map(draw).collect();
    for _ in 0..level {
        noises = noises.chunks(2).map(|pair| join(&pair[0], &pair[1])).collect();
    }
    if swapped {
        for pair in noises.chunks_mut(2) {
            pair.swap(0, 1);
        }
    }
    let tau = fine_tau * f64::from(1 << level);
    let truncation = if scheme.about().clips_increments {
        Truncation::new(2).unwrap()
    } else {
        Truncation::none()
    };
    let (bound, area_bound) = (truncation.bound(tau).unwrap(), truncation.area_bound(tau).unwrap());
    let mut y = problem.y0();
    for (n, noise) in noises.iter().enumerate() {
        let step = Step::new(problem.damping(), n as u64, tau).unwrap();
        let clipped = Noise {
            increments: noise.increments.map(|w| w.clamp(-bound, bound)),
            areas: noise.areas.map(|row| row.map(|area| area.clamp(-area_bound, area_bound))),
            space_time: [0.0; 3],
        };
        y = scheme.step(problem.system(), &step, &clipped, y).z;
    }
    y
}

#[test]
fn every_run_is_the_path_that_one_would_follow_by_hand() {
    let problem = body();
    let levy = SexpLevy::new(problem.system(), problem.y0());
    let schemes: [&dyn Scheme<RigidBody<3>, 3, 3>; 6] =
        [&Sexp, &EulerMaruyama, &Midpoint, &levy, &Euler::<false>, &BackwardEuler];
    let mut runs = Vec::new();
    let mut expected = Vec::new();
    for scheme in schemes {
        for level in [0, 2, 3] {
            runs.push(Run::new(bind(&problem, scheme), level));
            expected.push((scheme, level as u32, false));
        }
        for level in [0, 2] {
            runs.push(Run::swapped(bind(&problem, scheme), level));
            expected.push((scheme, level as u32, true));
        }
    }
    // Not a multiple of the block, more than one group.
    let (samples, done) = (150, AtomicU64::new(0));
    let progress = |work| _ = done.fetch_add(work, Ordering::Relaxed);
    let ladder = ladder(&problem, (32, 3), 2, runs).unwrap().telling(progress);
    let measured = ladder.run(samples, || Keep::new(ladder.coarse_steps(), expected.len()));
    assert_eq!(measured.failed, 0);
    // Every path-step of the six schemes: 32, 8 and 4, and the swapped ones.
    assert_eq!(ladder.steps_per_path(), 6 * (32 + 8 + 4 + 32 + 8));
    assert_eq!(done.load(Ordering::Relaxed), ladder.steps_per_path() * samples);
    // Some increments of the largest steps are clipped, for the schemes that want it.
    assert!(measured.clipped[3] > 0);
    for (kept, (scheme, level, swapped)) in measured.statistic.runs.iter().zip(&expected) {
        assert_eq!(kept.len(), samples as usize);
        for path in [0, 1, 31, 32, 77, 149] {
            let alone = by_hand(&problem, *scheme, 32, *level, path, *swapped);
            assert_eq!(
                kept[path as usize],
                alone,
                "{} level {level} swapped {swapped} path {path}",
                scheme.about().id
            );
            if *level == 0 && !swapped {
                let k = Truncation::new(2).unwrap();
                let followed = super::ladder::path(&problem, *scheme, 32, k, path).unwrap();
                let end = followed.columns[1..4].iter().map(|column| column.values[32]);
                assert!(end.eq(alone), "{} path {path}", scheme.about().id);
            }
        }
    }
}

#[test]
fn impossible_ladders_are_refused() {
    let problem = body();
    let refuse = |steps, levels, level, swapped| {
        let run = Run { scheme: bind(&problem, &Sexp), level, swapped };
        ladder(&problem, (steps, levels), 2, vec![run]).err()
    };
    for steps in [0, 10] {
        let expected = LadderError::Steps { steps, multiple_of: 4 };
        assert_eq!(refuse(steps, 2, 0, false), Some(expected));
    }
    for (levels, level, swapped) in [(2, 3, false), (2, 2, true), (0, 0, true)] {
        let expected = LadderError::Level { level, swapped, levels };
        assert_eq!(refuse(8, levels, level, swapped), Some(expected));
    }
    let error = "truncated increments need a step size with 0 < tau < 1, got tau = 1";
    let error = LadderError::Noise(NoiseError(error.into()));
    assert_eq!(refuse(4, 2, 2, false), Some(error));
    // Found by fuzzing: the finest step of a tiny final time is zero.
    let short = body().until(5e-324).unwrap();
    let run = Run::new(bind(&short, &EulerMaruyama), 0);
    assert!(matches!(ladder(&short, (4, 0), 2, vec![run]).err(), Some(LadderError::Step(_))));
}

#[test]
fn paths_without_a_solution_are_left_out_counted_and_described() {
    let problem = Problem::new(Explosive, Constant::new(0.0).unwrap(), [0.1, 0.5], 1.0).unwrap();
    let runs = vec![
        Run::new(bind(&problem, &Sexp), 0),
        Run::new(bind(&problem, &Sexp), 2),
        Run::new(bind(&problem, &EulerMaruyama), 0),
    ];
    let ladder = ladder(&problem, (16, 2), 4, runs).unwrap();
    let samples = 400;
    let measured = ladder.run(samples, || Keep::<2>::new(ladder.coarse_steps(), 3));
    let kept = measured.statistic.runs[0].len() as u64;
    // y₂ = tan(arctan ½ + t + W) leaves every bound when t + W passes 1.1: on many paths, and not
    // on all.
    assert!(measured.failed > 20 && kept > 20, "{} failed", measured.failed);
    assert_eq!(measured.failed + kept, samples);
    assert!(
        measured.statistic.runs.iter().flatten().flatten().all(|component| component.is_finite())
    );
    assert!(measured.failures.len() <= 8 && !measured.failures.is_empty());
    for failure in &measured.failures {
        let text = failure.to_string();
        for part in ["path ", "seed 5", "experiment 9", failure.scheme, "tau = ", "step ", "t = "] {
            assert!(text.contains(part), "{text}");
        }
        // Replayed alone, the path fails at the same step.
        if failure.scheme == "sexp"
            && failure.tau == 1.0 / 16.0
            && matches!(failure.cause, Cause::NoSolution { .. })
        {
            let alone = path(&problem, &Sexp, 16, Truncation::new(4).unwrap(), failure.path);
            let halted = alone.unwrap().halted.unwrap();
            assert!(halted.starts_with(&format!("step {} of", failure.step)), "{halted}: {text}");
        }
    }
    // Alone, a coarse run names its own steps.
    let coarse = vec![Run::new(bind(&problem, &Sexp), 2)];
    let coarse = self::ladder(&problem, (16, 2), 4, coarse).unwrap();
    let coarse = coarse.run(samples, || Keep::<2>::new(4, 1));
    assert!(!coarse.failures.is_empty());
    for failure in &coarse.failures {
        let words =
            format!("tau = 0.25, step {}, t = {}", failure.step, 0.25 * failure.step as f64);
        assert!(failure.to_string().contains(&words), "{failure}");
    }
}

/// An explicit scheme that blows up says so in the step in which it does, the first one too.
#[test]
fn a_blown_up_path_names_its_step() {
    for (rate, y0) in [(1e4, [1.0, 1.0, 1.0]), (0.0, [1e200, 1e200, 1.0])] {
        let damping = Constant::new(rate).unwrap();
        let problem = Problem::new::<3>(*body().system(), damping, y0, 1.0).unwrap();
        let path = path(&problem, &EulerMaruyama, 16, Truncation::new(4).unwrap(), 0).unwrap();
        let (step, t) = (path.times().len() - 1, path.times().last().unwrap());
        assert_eq!(step == 0, rate == 0.0);
        let words = format!("step {step} of size 0.0625, at t = {t}: the state is not finite");
        assert_eq!(path.halted, Some(words));
        assert!(path.columns[1..4].iter().flat_map(|column| &column.values).all(|y| y.is_finite()));
    }
}
