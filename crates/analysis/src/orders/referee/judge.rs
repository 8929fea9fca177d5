//! What the states of a solver show: orders, errors, laws.

use std::fmt;

use mc::{ConformalLaw, Observe};
use real::{PathMask, Row, WIDTH};
use serde::Serialize;
use stats::{Against, CrossMoments};

use super::{
    super::{
        Decision, Limit, More, OneStep, Order,
        decision::undecided,
        limit::{strong_limit, weak_limit},
        one_step::{difference, least_order, mean_squares},
        order::{strong, weak},
    },
    Referee, VISITS, distance,
    noise::STRENGTHS,
};

/// Rounding errors of a step as a part of a Casimir.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;
/// Largest difference of two answers to the same noise, as a part of the states: sums in another
/// order.
const SAME: f64 = 1e-6;

/// The final states of a solver, each array by [path, component].
#[derive(Clone, Debug, Default)]
pub struct SolverStates {
    /// Initial states.
    pub start: Vec<f64>,
    /// Final states at each step size, coarsest first.
    pub levels: Vec<Vec<f64>>,
    /// Final states of the first paths at the coarsest step size, asked once more.
    pub again: Vec<f64>,
    /// Final states of the reference, and of the reference with steps twice as long.
    pub reference: [Vec<f64>; 2],
    /// States after one step and after two half steps, at each of [`Referee::single_taus`].
    pub single: Vec<[Vec<f64>; 2]>,
    /// Seconds at each step size; none where they were not taken.
    pub seconds: Vec<f64>,
}

/// Orders, errors and laws that the states of a solver show.
///
/// [`Display`](fmt::Display) prints a table of the errors.
#[derive(Debug, Serialize)]
pub struct Judged {
    /// The strong order.
    #[serde(skip)]
    pub strong: Order,
    /// The weak order of each function.
    #[serde(skip)]
    pub weak: Vec<(String, Order)>,
    /// The step sizes, coarsest first.
    pub steps: Vec<f64>,
    /// Root mean squares of the errors against the reference, coarsest first.
    pub errors: Vec<f64>,
    /// Estimate of the error of the reference.
    pub reference_error: f64,
    /// Defects of the laws.
    pub laws: Vec<Law>,
    /// Equation that the solver solves instead, if known.
    pub solves: Option<&'static str>,
    /// Whether two answers to the same noise differ: the solver draws noise of its own.
    pub own_noise: bool,
    /// Seconds at each step size; none where they were not taken.
    pub seconds: Vec<f64>,
    /// Number of paths times the final time.
    #[serde(skip)]
    path_time: f64,
}

/// The largest defect of a law over all paths and step sizes.
#[derive(Clone, Debug, Serialize)]
pub struct Law {
    /// Name of the law.
    pub law: String,
    /// Relative defect.
    pub defect: f64,
    /// Part of the defect that may be rounding.
    pub rounding: f64,
}

impl fmt::Display for Judged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { steps, errors, reference_error, seconds, path_time, .. } = self;
        writeln!(
            f,
            "root mean square errors of y(T), to {reference_error:.0e}, the error of the \
             reference:\n  step      error     ns per path-step"
        )?;
        (0..steps.len()).try_for_each(|l| {
            let (tau, error) = (steps[l], errors[l]);
            let cost = seconds.get(l).map(|all| format!("{:.0}", all * tau / path_time * 1e9));
            writeln!(f, "  {tau:<8.2e}  {error:<8.2e}  {}", cost.as_deref().unwrap_or("–"))
        })
    }
}

impl SolverStates {
    /// Whether two answers to the same noise differ.
    fn differ(&self) -> bool {
        let pairs = self.levels.iter().take(1).flatten().zip(&self.again);
        let known = pairs.filter(|(a, b)| a.is_finite() && b.is_finite());
        let (apart, size) = known.fold((0.0, 0.0), |(apart, size), (a, b)| {
            (f64::max(apart, (a - b).abs()), f64::max(size, a.abs()))
        });
        apart > SAME * size
    }
}

/// The value of φ at a state.
fn value(phi: &dyn Observe, y: &[f64]) -> f64 {
    let rows: Vec<Row> = y.iter().map(|y| [*y; WIDTH]).collect();
    phi.values(&rows, PathMask::first(1))[0]
}

impl Referee<'_> {
    /// Judges the strong order of a solver, its weak order for functions, and laws, by its states.
    pub fn judge(&self, observables: &[&dyn Observe], states: &SolverStates) -> Judged {
        let Self { setup, sizes } = self;
        let (d, levels, t_end) = (setup.problem.y0.len(), sizes.levels, setup.problem.t_end);
        let number = states.start.len() / d;
        // At each step size, and of the reference.
        let all: Vec<&Vec<f64>> = states.levels.iter().chain(&states.reference).collect();
        let of = |level: usize, path: usize| &all[level][path * d..(path + 1) * d];
        let finite =
            |path: &usize| (0..all.len()).all(|l| of(l, *path).iter().all(|y| y.is_finite()));
        let paths: Vec<usize> = (0..number).filter(finite).collect();
        let failed = number - paths.len();
        // Differences, errors against the reference, and one of the reference.
        let mut squares = CrossMoments::new(2 * levels);
        for &path in &paths {
            let apart = |a: usize, b: usize| distance(of(a, path), of(b, path));
            let next = (1..levels).map(|l| apart(l - 1, l));
            let to_reference = (0..levels).map(|l| apart(l, levels));
            let own = apart(levels, levels + 1);
            squares.add(&next.chain(to_reference).chain([own]).collect::<Vec<f64>>());
        }
        let differences = squares.part(0..levels - 1);
        let errors = squares.part(levels - 1..2 * levels - 1);
        let reference_error = squares.mean(2 * levels - 1).sqrt();
        let limit = strong_limit(&errors, &differences, reference_error);
        let own_noise = states.differ();
        let taus = sizes.taus(t_end)[..levels].to_vec();
        let between = &taus[..levels - 1];
        let one_step = self.one_step(&states.single).filter(|_| !own_noise);
        let steps = sizes.coarsest_steps << (levels - 1);
        let size = (states.start.iter().map(|y| y * y).sum::<f64>() / number as f64).sqrt();
        let mut strong = strong(between, &differences, one_step, limit, (steps, size));
        let solves = match limit {
            Limit::Differs { .. } if !own_noise => self.solves(states, &paths),
            _ => None,
        };
        let of_observable = |phi: &&dyn Observe| {
            let mut moments = CrossMoments::new(levels);
            for &path in &paths {
                let at = |level: usize| value(*phi, of(level, path));
                // The weak error of the reference is extrapolated.
                let last = at(levels - 1) - (2.0 * at(levels) - at(levels + 1));
                let next = (1..levels).map(|l| at(l - 1) - at(l));
                moments.add(&next.chain([last]).collect::<Vec<f64>>());
            }
            let rounding = (steps, value(*phi, &states.start[..d]));
            let (fitted, limit) = (moments.part(0..levels - 1), weak_limit(&moments));
            let order = weak(between, &fitted, Against::HalfStep, limit, rounding);
            (phi.name().to_owned(), order)
        };
        let mut weak: Vec<_> = observables.iter().map(of_observable).collect();
        // Paths that converge have means that converge.
        let mut limits = weak.iter().map(|(_, order)| order.limit);
        if let Some(other) = limits.find(|limit| matches!(limit, Limit::Differs { .. })) {
            (strong.limit, strong.decision) = (other, Decision::WrongLimit);
        }
        for order in weak.iter_mut().map(|(_, order)| order).chain([&mut strong]) {
            order.failed = failed as u64;
            // The rest says little about the solver.
            if 10 * failed > number {
                (order.rate, order.one_step) = (None, None);
                let because = format!("{failed} of {number} paths failed");
                order.decision = undecided(More::Steps, because);
            }
            order.settle();
        }
        Judged {
            strong,
            weak,
            steps: taus,
            errors: errors.means().into_iter().map(f64::sqrt).collect(),
            reference_error,
            laws: setup.problem.laws.iter().map(|law| self.law(law, states, &paths)).collect(),
            solves,
            own_noise,
            seconds: states.seconds.clone(),
            path_time: number as f64 * t_end,
        }
    }

    /// The order of single steps.
    fn one_step(&self, single: &[[Vec<f64>; 2]]) -> Option<OneStep> {
        let (d, t_end) = (self.setup.problem.y0.len(), self.setup.problem.t_end);
        let mut known = single.iter();
        let found = least_order(t_end, &self.sizes, &mut |_, strengths| {
            let Some([one, two]) = known.next() else { return Vec::new() };
            let places = strengths.iter().filter_map(|a| STRENGTHS.iter().position(|b| a == b));
            let of = |place: usize| {
                mean_squares((place * VISITS..(place + 1) * VISITS).filter_map(|state| {
                    let [one, two] = [one, two].map(|ends| &ends[state * d..(state + 1) * d]);
                    let apart: Vec<f64> = one.iter().zip(two).map(|(a, b)| a - b).collect();
                    difference(&apart, two)
                }))
            };
            places.map(of).collect()
        })?;
        let (weights, mut known) = (self.weights(), single.iter());
        if weights.is_empty() {
            return Some(found);
        }
        Some(found.with_mean(t_end, &self.sizes, &mut |_, strengths| {
            // The noise is that of the problem.
            let ends = known.next().filter(|_| strengths.contains(&1.0));
            let of = |[one, two]: &[Vec<f64>; 2]| {
                mean_squares((0..VISITS).filter_map(|state| {
                    let mut mean = vec![0.0; d];
                    for (node, weight) in weights.iter().enumerate() {
                        let at = ((STRENGTHS.len() + node) * VISITS + state) * d;
                        for (i, mean) in mean.iter_mut().enumerate() {
                            *mean += weight * (one[at + i] - two[at + i]);
                        }
                    }
                    difference(&mean, &two[state * d..(state + 1) * d])
                }))
            };
            ends.map(of).into_iter().collect()
        }))
    }

    /// The defect of a law at the end that is largest beside rounding.
    fn law(&self, law: &ConformalLaw<'_>, states: &SolverStates, paths: &[usize]) -> Law {
        let (problem, coarsest) = (&self.setup.problem, self.sizes.coarsest_steps);
        let (d, t_end) = (problem.y0.len(), problem.t_end);
        let integrals: Vec<f64> = problem.dampings().map(|one| one.integral(0.0, t_end)).collect();
        let decay = law.decay(&integrals);
        let levels = states.levels.iter().enumerate();
        let all = levels.flat_map(|(l, level)| paths.iter().map(move |path| (l, level, path)));
        let defects = all.map(|(l, level, path)| {
            let at = |states: &[f64]| (law.value)(&states[path * d..(path + 1) * d]);
            let exact = decay * at(&states.start);
            let defect = (at(level) - exact).abs() / exact.abs().max(f64::MIN_POSITIVE);
            (defect, ROUND_OFF * (coarsest << l) as f64)
        });
        let worst = defects.max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
        let (defect, rounding) = worst.unwrap_or_default();
        Law { law: law.name.clone(), defect, rounding }
    }
}
