//! The step of every scheme on every system.

use noise::AreaBlock;
use nonlin::{BlockStatus, Outcome, Solution, Solver};
use real::{Block, WIDTH};
use schemes::{EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, Step};
use systems::{
    Constant, Damping, IntegerExponents, Linear, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3,
    PoissonSystem, RealExponents, RigidBody, RigidBodyEnergy,
};

use super::{Bits, Report, Target, check};
use crate::method::{Method, Noise};

pub(super) const TARGETS: [Target; 2] = [
    Target {
        name: "steps of single paths",
        checks: "a step that does not report failure has a finite state; iterations below their bound",
        cost: 1,
        run: single,
    },
    Target {
        name: "steps of blocks",
        checks: "the same, and every path of a block has the bits of the single path",
        cost: 40,
        run: block,
    },
];

/// Attempts at most of the continuation: its step in s is halved down to 2⁻¹⁴ and doubled after
/// each success, so that there are at most 2·2¹⁴ of them, each with at most 20 Newton iterations.
const MOST_ITERATIONS: u64 = 2 * (1 << 14) * 20;

fn damping(bits: &mut Bits) -> Box<dyn Damping> {
    let rate = if bits.below(4) == 0 { bits.number() } else { bits.ordinary() };
    match Constant::new(rate) {
        Ok(constant) => Box::new(constant),
        Err(_) => match Linear::new(1.0) {
            Ok(linear) => Box::new(linear),
            Err(error) => unreachable!("one is finite: {error}"),
        },
    }
}

/// A step, if there is one.
fn step(bits: &mut Bits) -> Option<Step> {
    let tau = if bits.below(8) == 0 { bits.number() } else { bits.plausible() };
    Step::new(damping(bits).as_ref(), bits.below(1 << 20), tau).ok()
}

fn noise<const M: usize>(bits: &mut Bits) -> Noise<M> {
    let dw = bits.state::<M>();
    let mut areas = [[0.0; M]; M];
    for i in 0..M {
        for j in 0..i {
            areas[i][j] = if bits.below(8) == 0 { bits.number() } else { bits.ordinary() };
            areas[j][i] = -areas[i][j];
        }
    }
    Noise { dw, areas }
}

fn sound<const D: usize>(
    solution: &Solution<D>,
    what: impl FnOnce() -> String,
) -> Result<Report, String> {
    let finite = solution.z.iter().all(|z| z.is_finite());
    let (converged, iterations) = match solution.outcome {
        Outcome::Fast { iterations } | Outcome::Robust { iterations, .. } => {
            (true, u64::from(iterations))
        }
        Outcome::Failed { .. } => (false, 0),
    };
    if converged && !finite || iterations > MOST_ITERATIONS {
        return Err(format!("{}: {solution:?}", what()));
    }
    Ok(if converged { Report::accepted() } else { Report::refused() }.with_iterations(iterations))
}

fn one<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    bits: &mut Bits,
) -> Result<Report, String> {
    let methods = Method::all(M);
    let method = methods[bits.below(methods.len() as u64) as usize];
    let Some(step) = step(bits) else { return Ok(Report::refused()) };
    let (noise, y) = (noise::<M>(bits), bits.state::<D>());
    let levy = SexpLevy::new(system, [1.0; D]);
    let solution = method.step(system, &levy, &step, noise, y);
    sound(&solution, || {
        format!("{} of {} from {y:?} with {noise:?}, {step:?}", method.id(), system.name())
    })
}

fn body(bits: &mut Bits) -> Option<RigidBody<3>> {
    RigidBody::three_noises(
        [bits.plausible(), bits.plausible(), bits.plausible()],
        [bits.plausible(), bits.plausible(), bits.plausible()],
    )
    .ok()
}

fn single(bits: &mut Bits) -> Result<Report, String> {
    let refused = Ok(Report::refused());
    match bits.below(8) {
        0 => {
            Pendulum::new(bits.plausible()).map_or(refused, |system| one::<_, 2, 1>(&system, bits))
        }
        1 | 2 => body(bits).map_or(refused, |system| one::<_, 3, 3>(&system, bits)),
        3 => RigidBodyEnergy::new(
            [bits.plausible(), bits.plausible(), bits.plausible()],
            bits.plausible(),
        )
        .map_or(refused, |system| one::<_, 3, 1>(&system, bits)),
        4 => LotkaVolterra::<IntegerExponents<2, 2>>::integer(bits.plausible())
            .map_or(refused, |system| one::<_, 3, 1>(&system, bits)),
        5 => LotkaVolterra::<RealExponents>::new(
            -bits.plausible(),
            -bits.plausible(),
            bits.plausible(),
        )
        .map_or(refused, |system| one::<_, 3, 1>(&system, bits)),
        6 => one::<_, 3, 1>(&MaxwellBloch, bits),
        _ => {
            Poisson3::new(bits.plausible()).map_or(refused, |system| one::<_, 3, 1>(&system, bits))
        }
    }
}

/// Bits are compared as the block promises them: of a path that failed only the failure.
fn same<const D: usize>(
    status: &BlockStatus,
    y: &Block<D>,
    p: usize,
    solution: &Solution<D>,
) -> bool {
    let failed = status.failed.contains(p);
    failed != solution.outcome.converged()
        && (failed || y.path(p).map(f64::to_bits) == solution.z.map(f64::to_bits))
}

/// 32 different paths, some ordinary and some not.
fn blocks<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    bits: &mut Bits,
) -> Result<Report, String> {
    let Some(step) = step(bits) else { return Ok(Report::refused()) };
    let levy = SexpLevy::new(system, [1.0; D]);
    let newton = Sexp { solver: Solver::new(nonlin::Method::Newton) };
    let (fixed, settled) = (
        Sexp { solver: Solver::new(nonlin::Method::FixedPoint) },
        Sexp { solver: Solver::default().settled() },
    );
    let schemes: [&dyn Scheme<S, D, M>; 7] =
        [&fixed, &newton, &settled, &levy, &Midpoint::default(), &Heun, &EulerMaruyama];
    let scheme = schemes[bits.below(7) as usize];
    let (mut dw, mut areas, mut start) =
        (Block::<M>::zero(), AreaBlock::<M>::zero(), Block::<D>::zero());
    for p in 0..WIDTH {
        let noise = noise::<M>(bits);
        dw.set_path(p, noise.dw);
        areas.set_path(p, noise.areas);
        start.set_path(p, bits.state::<D>());
    }
    let (mut y, mut status) = (start, BlockStatus::explicit());
    scheme.step_block_with_areas(system, &step, &dw, &areas, &mut y, &mut status);
    let mut most = 0;
    for p in 0..WIDTH {
        let alone = scheme.step_with_areas(system, &step, dw.path(p), areas.path(p), start.path(p));
        let report = sound(&alone, || format!("{} of {}, path {p}", scheme.id(), system.name()))?;
        most = most.max(report.iterations);
        check(same(&status, &y, p, &alone), || {
            format!(
                "{} of {}, path {p}: block {:?}, alone {alone:?}",
                scheme.id(),
                system.name(),
                y.path(p)
            )
        })?;
    }
    Ok(Report::accepted().with_iterations(most))
}

/// Two systems: each is compiled for every instruction set, which takes longer than all the rest.
fn block(bits: &mut Bits) -> Result<Report, String> {
    let refused = Ok(Report::refused());
    match bits.below(2) {
        0 => Pendulum::new(bits.plausible())
            .map_or(refused, |system| blocks::<_, 2, 1>(&system, bits)),
        _ => body(bits).map_or(refused, |system| blocks::<_, 3, 3>(&system, bits)),
    }
}
