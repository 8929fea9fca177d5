//! Problems and steps of every system with every scheme.

use anyhow::{Context, Result, ensure};
use kernels::Tuned;
use noise::{BlockNoise, Noise, StepNoise};
use nonlin::{BlockStatus, Method, Outcome, Solution, Solver};
use real::{Block, WIDTH};
use schemes::{
    BuiltIn, EulerMaruyama, Heun, Midpoint, Scheme, Sexp, SexpLevy, SexpLi, Step, WithSolver,
};
use systems::{
    Constant, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, Problem, RigidBody,
    RigidBodyEnergy, SystemError,
};

use super::{Bits, Fed, Refused, accepted};

/// The continuation halves its step in s down to 2⁻¹⁴ and doubles it after each success: at most
/// 2·2¹⁴ attempts, each with at most 20 Newton iterations.
const MAX_ITERATIONS: u64 = 2 * (1 << 14) * 20;

/// What is done with a system.
pub enum Job {
    /// It becomes a problem.
    Problem,
    /// Any scheme makes a step.
    Step,
}

/// Any system; one parameter in `wild` is any number.
pub fn any_system(bits: &mut Bits, job: Job, wild: u64) -> Fed {
    let p @ [a, b, c, d, e, f] = [(); 6].map(|()| bits.positive(wild));
    match bits.below(10) {
        0 => with_system(bits, job, Pendulum::new(a), &p[..1]),
        1 => with_system(bits, job, RigidBody::three_noises([a, b, c], [d, e, f]), &p),
        2 => with_system(bits, job, RigidBody::one_noise([a, b, c], d), &p[..4]),
        3 => with_system(bits, job, RigidBodyEnergy::new([a, b, c], d), &p[..4]),
        4 => with_system(bits, job, LotkaVolterra::<1, 1>::new(a), &p[..1]),
        5 => with_system(bits, job, LotkaVolterra::<2, 2>::new(a), &p[..1]),
        6 => with_system(bits, job, Poisson3::new(a), &p[..1]),
        _ => with_system(bits, job, Ok(MaxwellBloch), &[]),
    }
}

fn with_system<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize>(
    bits: &mut Bits,
    job: Job,
    system: Result<S, SystemError>,
    parameters: &[f64],
) -> Fed {
    let system = accepted(system)?;
    ensure!(parameters.iter().all(|p| p.is_finite()), "accepted {parameters:?}");
    match job {
        Job::Problem => {
            let (y0, t_end) = (bits.state::<D>(), bits.positive(2));
            let damping = accepted(Constant::new(bits.number()))?;
            let problem = accepted(Problem::new::<M>(system, damping, y0, t_end))?;
            let finite = y0.iter().chain([&t_end]).all(|number| number.is_finite());
            let sound = finite && t_end > 0.0 && problem.system().check_domain(y0).is_ok();
            ensure!(sound, "accepted {y0:?}, T = {t_end:e}");
            Ok(())
        }
        Job::Step => {
            let schemes = steps(&system);
            let (scheme, advance) = &schemes[bits.below(schemes.len() as u64) as usize];
            let step = any_step(bits)?;
            let (noise, y) = (noise::<M>(bits), bits.state::<D>());
            let solution = advance(&system, &step, &noise, y);
            sound(&solution).with_context(|| {
                let system = system.name();
                format!("{scheme} of {system} from {y:?} with {noise:?}, {step:?}")
            })?;
            ensure!(solution.outcome.converged(), Refused);
            Ok(())
        }
    }
}

/// A step of a single path: no kernel for blocks has to be compiled for all these systems.
type Advance<S, const D: usize, const M: usize> =
    dyn Fn(&S, &Step, &Noise<M>, [f64; D]) -> Solution<D>;

/// The schemes for a system with their names.
fn steps<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
) -> Vec<(&'static str, Box<Advance<S, D, M>>)> {
    fn boxed<S, const D: usize, const M: usize>(
        scheme: impl Scheme<S, D, M> + 'static,
    ) -> (&'static str, Box<Advance<S, D, M>>) {
        (
            scheme.about().id,
            Box::new(move |system, step, noise, y| scheme.step(system, step, noise, y)),
        )
    }
    let sexp = |method| boxed(WithSolver { formula: Sexp, solver: Solver::new(method) });
    let mut all = vec![sexp(Method::FixedPoint), sexp(Method::Newton)];
    if M > 1 {
        all.push(boxed(SexpLevy::new(system, [1.0; D])));
    }
    all.extend(SexpLi::new(system, [1.0; D]).ok().map(boxed));
    all.extend([boxed(Midpoint), boxed(Heun), boxed(EulerMaruyama)]);
    all
}

fn any_step(bits: &mut Bits) -> Result<Step> {
    let rate = if bits.one_in(4) { bits.number() } else { bits.ordinary() };
    let damping = accepted(Constant::new(rate))?;
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

/// A solution that converged is finite, and took no more iterations than there are.
fn sound<const D: usize>(solution: &Solution<D>) -> Result<()> {
    if let Outcome::Fast { iterations } | Outcome::Robust { iterations, .. } = solution.outcome {
        let finite = solution.z.iter().all(|z| z.is_finite());
        ensure!(finite && u64::from(iterations) <= MAX_ITERATIONS, "{solution:?}");
    }
    Ok(())
}

/// A block of two systems whose kernels are compiled anyway.
pub fn block(bits: &mut Bits) -> Fed {
    let [a, b, c, d, e, f] = [(); 6].map(|()| bits.positive(8));
    if bits.one_in(2) {
        block_step(bits, &accepted(Pendulum::new(a))?)
    } else {
        block_step(bits, &accepted(RigidBody::three_noises([a, b, c], [d, e, f]))?)
    }
}

/// A step of 32 different paths, some ordinary and some not.
fn block_step<S: Tuned<D, M> + 'static, const D: usize, const M: usize>(
    bits: &mut Bits,
    system: &S,
) -> Fed {
    let step = any_step(bits)?;
    let compiled = |scheme| S::scheme(scheme, system, [1.0; D]);
    let with_solver = |solver| Box::new(WithSolver { formula: Sexp, solver });
    let scheme: Box<dyn Scheme<S, D, M>> = match bits.below(10) {
        0 => with_solver(Solver::new(Method::FixedPoint)),
        1 => with_solver(Solver::new(Method::Newton)),
        2 => with_solver(Solver::default().settled()),
        3 => Box::new(SexpLevy::new(system, [1.0; D])),
        4 => compiled(BuiltIn::Midpoint)?,
        5 => compiled(BuiltIn::Heun)?,
        6 => compiled(BuiltIn::SexpLi)?,
        7 => compiled(BuiltIn::Split)?,
        8 => compiled(BuiltIn::Nv)?,
        _ => compiled(BuiltIn::EulerMaruyama)?,
    };
    let (mut noises, mut start) = (StepNoise::with_areas(M), Block::zero());
    for p in 0..WIDTH {
        let noise = noise::<M>(bits);
        noises.set_path(p, &noise);
        start.set_path(p, bits.state::<D>());
    }
    let noises = BlockNoise::from(&noises);
    let (mut y, mut status) = (start, BlockStatus::explicit());
    scheme.step_block(system, &step, &noises, &mut y, &mut status);
    for p in 0..WIDTH {
        let alone = scheme.step(system, &step, &noises.path(p), start.path(p));
        let place = || format!("{} of {}, path {p}", scheme.about().id, system.name());
        sound(&alone).with_context(place)?;
        // Of a path that failed only the failure is promised.
        let (failed, together) = (status.failed.contains(p), y.path(p));
        let same = failed || together.map(f64::to_bits) == alone.z.map(f64::to_bits);
        let agree = same && failed != alone.outcome.converged();
        ensure!(agree, "{}: block {together:?}, alone {alone:?}", place());
    }
    Ok(())
}
