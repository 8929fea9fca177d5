//! How much work the implicit steps take, counted in sweeps and not timed: the same numbers on
//! every machine.
//!
//! Two bounds. One is derived from the equation of each step: the plain iteration z ← ψ(z) is
//! evaluated until it moves by no more than the tolerance 2ε‖z‖₁. The solver foresees the last
//! change from the two before and so needs no more evaluations than that, rounded up to its sweeps
//! of eleven and then three. A solver that tests worse, asks for more digits than there are or
//! evaluates in vain is beyond that bound; a formula that contracts worse changes it along with the
//! count. Therefore the other: the sweeps of the slowest path of a block, which are what a block
//! costs, in the mean over blocks and steps, and the most sweeps of a path, both pinned a little
//! above what they are.

use crate::common::{Visit, body, every_system, schemes_of};
use kernels::Tuned;
use noise::{AreaPath, Noise, StreamKey, Truncation, WienerPath, strong_order_one_error};
use nonlin::{Outcome, Solver};
use real::WIDTH;
use schemes::{BuiltIn, Scheme, Step};
use systems::{Cosine, ImplicitStep, PoissonSystem, RigidBody, vector_field};

/// Evaluations of ψ in the first sweep and in each later one, as `nonlin::Method::FixedPoint` says.
const FIRST: u32 = 11;
const LATER: u32 = 3;
const TOLERANCE: f64 = 2.0 * f64::EPSILON;

const BLOCKS: u64 = 8;
const STEPS: u64 = 256;
const KEY: StreamKey = StreamKey { seed: 1, experiment: 1 };

/// ψ(z) of one step from y, which is damped already where the scheme damps first.
fn map<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    midpoint: bool,
    (system, step): (&S, &Step),
    (dw, areas): ([f64; M], Option<[[f64; M]; M]>),
    y: [f64; D],
    z: [f64; D],
) -> [f64; D] {
    let middle: [f64; D] = std::array::from_fn(|i| 0.5 * (y[i] + z[i]));
    let mut change = match midpoint {
        true => vector_field(system, middle, step.tau, dw),
        false => system.averaged_field(y, z, step.tau, dw),
    };
    let commutators = areas.map_or([0.0; D], |areas| system.commutators(middle, areas));
    for i in 0..D {
        change[i] += commutators[i];
        if midpoint {
            change[i] -= step.tau * step.rate_at_middle * middle[i];
        }
    }
    std::array::from_fn(|i| y[i] + change[i])
}

/// Sweeps that the evaluations up to the tolerance fill.
fn derived<const D: usize>(start: [f64; D], map: impl Fn([f64; D]) -> [f64; D]) -> u32 {
    let norm = |x: [f64; D]| x.iter().map(|component| component.abs()).sum::<f64>();
    let mut z = start;
    for evaluations in 1u32.. {
        let next = map(z);
        let change: [f64; D] = std::array::from_fn(|i| next[i] - z[i]);
        z = next;
        // A cycle of roundings that is wider than the tolerance never gets there; no contraction
        // here takes so many.
        if norm(change) <= TOLERANCE * norm(z) || evaluations == 100 {
            return 1 + evaluations.saturating_sub(FIRST).div_ceil(LATER);
        }
    }
    unreachable!("the loop ends after a hundred evaluations")
}

/// The sweeps of all paths and steps.
#[derive(Debug, Default)]
struct Count {
    steps: u64,
    sweeps: u64,
    derived: u64,
    /// Steps that took more sweeps than derived.
    beyond: u64,
    /// Steps on which the fixed point gave up.
    rescued: u64,
    /// Sum over blocks and steps of the sweeps of the slowest path.
    slowest: u64,
    /// The most sweeps of a step that was not rescued.
    most: u32,
}

impl Count {
    fn block_mean(&self) -> f64 {
        self.slowest as f64 / (BLOCKS * STEPS) as f64
    }
}

/// Counts on single paths, whose steps have the same bits as those of a block, of which 32
/// neighbours are one. The scheme sees the increments of the derived bound times `stretch`, which
/// is one but for the twin.
fn count<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    system: &S,
    y0: [f64; D],
    (exponent, stretch): (i32, f64),
) -> Count {
    let (tau, midpoint) = (2f64.powi(-exponent), scheme.about().id == "midpoint");
    let truncation = Truncation::new(4).unwrap();
    let (bound, area_bound) = (truncation.bound(tau).unwrap(), truncation.area_bound(tau).unwrap());
    let terms = noise::area_terms(strong_order_one_error(tau), tau, M).unwrap();
    let damping = Cosine::new(0.5, 2.0).unwrap();
    let steps: Vec<Step> = (0..STEPS).map(|n| Step::new(&damping, n, tau).unwrap()).collect();
    let mut count = Count::default();
    for block in 0..BLOCKS {
        let mut slowest = vec![0; steps.len()];
        for path in block * WIDTH as u64..(block + 1) * WIDTH as u64 {
            let mut noise = WienerPath::<M>::new(KEY, path);
            let mut sampler = AreaPath::<M>::new(KEY, path, terms);
            let mut y = y0;
            for (step, slowest) in steps.iter().zip(&mut slowest) {
                let dw = noise.increments(tau.sqrt());
                let drawn = scheme.about().reads_areas.then(|| sampler.areas(tau, dw));
                let clip = |area: f64| area.clamp(-area_bound, area_bound);
                let drawn = drawn.map(|areas| areas.map(|row| row.map(clip)));
                let dw = dw.map(|w| w.clamp(-bound, bound));
                let decay = if midpoint { 1.0 } else { step.first_decay };
                let start = y.map(|x| decay * x);
                let allowed =
                    derived(start, |z| map(midpoint, (system, step), (dw, drawn), start, z));
                let areas = drawn.unwrap_or([[0.0; M]; M]);
                let noise = Noise { areas, ..Noise::increments(dw.map(|w| stretch * w)) };
                let solution = scheme.step(system, step, &noise, y);
                let sweeps = match solution.outcome {
                    Outcome::Fast { iterations } => {
                        count.most = count.most.max(iterations);
                        iterations
                    }
                    Outcome::Robust { .. } => {
                        count.rescued += 1;
                        Solver::default().max_sweeps
                    }
                    Outcome::Failed { .. } => {
                        panic!("{} {}: {:?}", system.name(), scheme.about().id, solution.outcome)
                    }
                };
                y = solution.z;
                count.steps += 1;
                count.sweeps += u64::from(sweeps);
                count.derived += u64::from(allowed);
                count.beyond += u64::from(sweeps > allowed);
                *slowest = sweeps.max(*slowest);
            }
        }
        count.slowest += slowest.into_iter().map(u64::from).sum::<u64>();
    }
    count
}

/// At 2⁻⁸ the mean over blocks of the sweeps of the slowest path, rounded up to a tenth, and the
/// most sweeps of a path. Two entries for the rigid body with one noise, W₁ or H₀, would differ by
/// a tenth.
const PINNED: [(&str, usize, f64, u32); 6] = [
    ("pendulum", 1, 2.0, 2),
    ("rigid-body", 3, 1.1, 2),
    ("rigid-body", 1, 1.2, 3),
    ("lotka-volterra", 1, 2.1, 4),
    ("maxwell-bloch", 1, 1.1, 2),
    ("poisson3", 1, 2.1, 3),
];
/// The same at 2⁻¹² for every system: the first sweep is enough on nearly every block. A rescue
/// from a cycle of roundings costs 55 sweeps, so that four of them on 2048 blocks add a tenth to
/// the mean.
const PINNED_SMALL: (f64, u32) = (1.15, 2);
/// Of `sexp` on systems that predict its solutions: every prediction is accepted.
const PINNED_PREDICTED: (f64, u32) = (1.0, 1);

/// Steps beyond their derived bound, where changes of the size of round-off do not shrink: at most
/// 15 of the 65 536.
const LARGEST_SHARE_BEYOND: f64 = 1e-3;
/// Rescues from cycles of roundings: none, or up to four of the 65 536 on Lotka–Volterra.
const LARGEST_SHARE_RESCUED: f64 = 1e-4;

/// What is wrong with a count; empty if nothing. The derived bound is one for the fixed point, and
/// not for systems that prefer Newton's method, whose sweeps are other sweeps.
fn wrong(count: &Count, newton: bool, (block_mean, most): (f64, u32)) -> String {
    let share = |number: u64| number as f64 / count.steps as f64;
    let mut words = Vec::new();
    if !newton && share(count.beyond) > LARGEST_SHARE_BEYOND {
        words.push("more sweeps than derived");
    }
    if share(count.rescued) > LARGEST_SHARE_RESCUED {
        words.push("more rescues than pinned");
    }
    let fast = count.sweeps - count.rescued * u64::from(Solver::default().max_sweeps);
    if !newton && fast as f64 > count.derived as f64 * (1.0 + LARGEST_SHARE_BEYOND) {
        words.push("more sweeps in all than derived");
    }
    if count.block_mean() > block_mean || count.most > most {
        words.push("more sweeps than pinned");
    }
    words.join(", ")
}

#[derive(Default)]
struct Guard {
    seen: usize,
    wrong: Vec<String>,
}

impl Visit for Guard {
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]) {
        use BuiltIn::{Midpoint, Sexp, SexpLevy};
        let name = system.name();
        let pinned = PINNED.iter().find(|&&(system, noises, ..)| system == name && noises == M);
        let &(_, _, block_mean, most) =
            pinned.unwrap_or_else(|| panic!("{name} is not in the table"));
        let predicted = S::IMPLICIT_STEP == ImplicitStep::Predicted;
        let newton = predicted || S::IMPLICIT_STEP == ImplicitStep::Newton;
        for (exponent, pinned) in [(8, (block_mean, most)), (12, PINNED_SMALL)] {
            for scheme in schemes_of(&[Sexp, SexpLevy, Midpoint], system, y0) {
                let is_predicted = predicted && scheme.about().id == "sexp";
                let pinned = if is_predicted { PINNED_PREDICTED } else { pinned };
                let count = count(&*scheme, system, y0, (exponent, 1.0));
                let (words, mean) = (wrong(&count, newton, pinned), count.block_mean());
                self.seen += 1;
                if !words.is_empty() {
                    let scheme = scheme.about().id;
                    self.wrong
                        .push(format!("{name} {scheme} 2^-{exponent}: {mean}, {count:?} {words}"));
                }
            }
        }
    }
}

#[test]
fn no_step_takes_more_sweeps_than_its_equation_needs() {
    let mut guard = Guard::default();
    every_system(&mut guard);
    // Eight systems, two schemes, one of the systems with a third, two step sizes.
    assert_eq!(guard.seen, (8 * 2 + 1) * 2);
    assert!(guard.wrong.is_empty(), "{}", guard.wrong.join("\n"));
}

/// The twins: larger steps than those that are pinned, and harder equations than those that the
/// bound is derived from.
#[test]
fn more_work_is_noticed() {
    let (body, y0) = (body(), [1.1f64.cos(), 0.0, 1.1f64.sin()]);
    let (pinned, sexp) = ((1.1, 2), RigidBody::scheme(BuiltIn::Sexp, &body, y0).unwrap());
    let right = count(&*sexp, &body, y0, (8, 1.0));
    assert_eq!(wrong(&right, false, pinned), "");
    let larger = count(&*sexp, &body, y0, (7, 1.0));
    assert_eq!(wrong(&larger, false, pinned), "more sweeps than pinned");
    let harder = count(&*sexp, &body, y0, (8, 2.0));
    assert!(
        wrong(&harder, false, pinned).starts_with("more sweeps than derived, more sweeps in all"),
        "{harder:?}"
    );
}
