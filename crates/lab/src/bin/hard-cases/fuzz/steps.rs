//! The step of every scheme on every system.

use anyhow::{Result, ensure};
use lab::{PaperSystem, compiled};
use noise::{BlockNoise, Noise};
use nonlin::{BlockStatus, Method, Outcome, Solution, Solver};
use real::{Block, WIDTH};
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, Step};
use systems::{Constant, Pendulum, PoissonSystem, RigidBody};

use super::systems::{Visitor, visit};
use super::{Bits, Fed, Target, accepted};
use crate::schemes::schemes;

pub const TARGETS: [Target; 2] = [
    Target {
        name: "steps of single paths",
        checks: "a step that does not report failure has a finite state; iterations below their \
                 bound",
        cost: 1,
        feed: visit::<TakeStep>,
    },
    Target {
        name: "steps of blocks",
        checks: "the same, and every path of a block has the bits of the single path",
        cost: 40,
        feed: block,
    },
];

/// The continuation halves its step in s down to 2⁻¹⁴ and doubles it after each success: at most
/// 2·2¹⁴ attempts, each with at most 20 Newton iterations.
const MOST_ITERATIONS: u64 = 2 * (1 << 14) * 20;

fn step(bits: &mut Bits) -> Result<Option<Step>> {
    let rate = if bits.one_in(4) { bits.number() } else { bits.ordinary() };
    let Some(damping) = accepted(Constant::new(rate))? else { return Ok(None) };
    let tau = bits.positive(8);
    accepted(Step::new(&damping, bits.below(1 << 20), tau))
}

fn noise<const M: usize>(bits: &mut Bits) -> Noise<M> {
    let mut noise = Noise::increments(bits.state());
    for i in 0..M {
        for j in 0..i {
            let area = if bits.one_in(8) { bits.number() } else { bits.ordinary() };
            (noise.areas[i][j], noise.areas[j][i]) = (area, -area);
        }
    }
    noise
}

/// The iterations of a sound solution; none where it failed.
fn sound<const D: usize>(solution: &Solution<D>) -> Fed {
    let (Outcome::Fast { iterations } | Outcome::Robust { iterations, .. }) = solution.outcome
    else {
        return Ok(None);
    };
    let iterations = u64::from(iterations);
    let finite = solution.z.iter().all(|z| z.is_finite());
    ensure!(finite && iterations <= MOST_ITERATIONS, "{solution:?}");
    Ok(Some(iterations))
}

struct TakeStep;

impl Visitor for TakeStep {
    const WILD: u64 = 8;
    fn visit<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize>(
        bits: &mut Bits,
        system: S,
    ) -> Fed {
        let schemes = schemes(&system, [1.0; D]);
        let scheme = &schemes[bits.below(schemes.len() as u64) as usize];
        let Some(step) = step(bits)? else { return Ok(None) };
        let (noise, y) = (noise::<M>(bits), bits.state::<D>());
        sound(&scheme.step(&system, &step, &noise, y)).map_err(|error| {
            let (scheme, system) = (scheme.name, system.name());
            error.context(format!("{scheme} of {system} from {y:?} with {noise:?}, {step:?}"))
        })
    }
}

/// A step of 32 different paths, some ordinary and some not.
fn block_step<S: PaperSystem<D, M> + 'static, const D: usize, const M: usize>(
    bits: &mut Bits,
    system: &S,
) -> Fed {
    let Some(step) = step(bits)? else { return Ok(None) };
    let scheme: Box<dyn Scheme<S, D, M>> = match bits.below(7) {
        0 => compiled(Sexp { solver: Solver::new(Method::FixedPoint) }),
        1 => compiled(Sexp { solver: Solver::new(Method::Newton) }),
        2 => compiled(Sexp { solver: Solver::default().settled() }),
        3 => Box::new(SexpLevy::new(system, [1.0; D])),
        4 => compiled(Midpoint::default()),
        5 => Box::new(Heun),
        _ => compiled(EulerMaruyama),
    };
    let (mut noises, mut start) = (BlockNoise::zero(), Block::zero());
    for p in 0..WIDTH {
        let noise = noise::<M>(bits);
        noises.increments.set_path(p, noise.increments);
        noises.areas.set_path(p, noise.areas);
        start.set_path(p, bits.state::<D>());
    }
    let (mut y, mut status) = (start, BlockStatus::explicit());
    scheme.step_block(system, &step, &noises, &mut y, &mut status);
    let mut most = 0;
    for p in 0..WIDTH {
        let alone = scheme.step(system, &step, &noises.path(p), start.path(p));
        let place = || format!("{} of {}, path {p}", scheme.id(), system.name());
        most = most.max(sound(&alone).map_err(|error| error.context(place()))?.unwrap_or(0));
        // Of a path that failed only the failure is promised.
        let (failed, together) = (status.failed.contains(p), y.path(p));
        let same = failed || together.map(f64::to_bits) == alone.z.map(f64::to_bits);
        ensure!(
            same && failed != alone.outcome.converged(),
            "{}: block {together:?}, alone {alone:?}",
            place()
        );
    }
    Ok(Some(most))
}

/// Two systems whose kernels are compiled anyway.
fn block(bits: &mut Bits) -> Fed {
    let [a, b, c, d, e, f] = [(); 6].map(|()| bits.positive(8));
    if bits.one_in(2) {
        let system = accepted(Pendulum::new(a))?;
        system.map_or(Ok(None), |system| block_step::<_, 2, 1>(bits, &system))
    } else {
        let system = accepted(RigidBody::three_noises([a, b, c], [d, e, f]))?;
        system.map_or(Ok(None), |system| block_step::<_, 3, 3>(bits, &system))
    }
}
