//! Schemes on systems known at run time: the bits of compiled ones where formulas are explicit, the
//! same solutions where they are implicit, and Newton's method without a matrix.

use kernels::Tuned;
use noise::{BlockNoise, StepNoise, StreamKey, WienerRows};
use nonlin::{BlockStatus, Method, Solver};
use real::{Block, Real, Rows, WIDTH};
use schemes::{
    BuiltIn, Heun, Implicit, Increment, Midpoint, Scheme, Sexp, SexpLi, Split, Step, WithSolver,
    run_time,
};
use systems::{
    Constant, Cosine, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody,
    lattice::{Couplings, Shape, SpinLattice},
    run_time::{Compiled, System, Weights},
};

use crate::{
    common::{INERTIA, Numbers, Spins, body, populations_1},
    own_schemes::Wide,
};

const STEPS: u64 = 40;

/// The largest difference, relative to the size of the state, after some steps of 32 paths.
fn difference<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    (scheme, at_run_time): (&dyn Scheme<S, D, M>, &dyn run_time::Scheme),
    adapter: &dyn System,
    y0: [f64; D],
    tau: f64,
) -> f64 {
    let mut paths = at_run_time.stepper(adapter).unwrap();
    let mut y = Block::splat(y0);
    paths.state_mut().copy_from_slice(&y.0);
    let mut wiener = WienerRows::new(StreamKey { seed: 3, experiment: 1 }, 0);
    let (mut noise, mut numbers) = (StepNoise::with_areas(M), Numbers(8));
    let (mut status, mut other) = (BlockStatus::explicit(), BlockStatus::explicit());
    let damping = Cosine::new(0.5, 2.0).unwrap();
    let mut largest = 0.0f64;
    for n in 0..STEPS {
        wiener.increments(tau.sqrt(), &mut noise.increments);
        noise.increments.iter_mut().flatten().for_each(|dw| *dw = dw.clamp(-0.4, 0.4));
        for m in 0..M {
            let rows = &mut noise.areas[m * M + m + 1..(m + 1) * M];
            rows.iter_mut().flatten().for_each(|area| *area = 0.3 * tau * numbers.next());
        }
        let step = Step::new(&damping, n, tau).unwrap();
        scheme.step_block(system, &step, &(&noise).into(), &mut y, &mut status);
        paths.step(&step, &noise, &mut other);
        assert!(status.failed.is_empty() && other.failed.is_empty(), "{}", system.name());
        for (row, expected) in paths.state().iter().zip(&y.0) {
            for p in 0..WIDTH {
                let size: f64 = y.0.iter().map(|row| row[p].abs()).sum();
                largest = largest.max((row[p] - expected[p]).abs() / size);
            }
        }
    }
    largest
}

fn check<S: PoissonSystem<D, M> + Tuned<D, M> + Clone, const D: usize, const M: usize>(
    system: S,
    y0: [f64; D],
) {
    let adapter = Compiled::new(system.clone(), y0);
    let flows = |kind: &BuiltIn| {
        use BuiltIn::{Baoab, HeunLevy, Nv, SexpH, Split, SplitH};
        matches!(kind, Nv | Split | SplitH | SexpH | Baoab | HeunLevy)
    };
    for kind in BuiltIn::ALL.into_iter().filter(|kind| !flows(kind)) {
        let compiled = S::scheme(kind, &system, y0).unwrap();
        let at_run_time = kind.at_run_time(&adapter).unwrap();
        let found = difference(&system, (&*compiled, &*at_run_time), &adapter, y0, 1.0 / 64.0);
        let allowed = match kind {
            // Residuals are at most 2ε of the size in each step, and errors of some forty steps add
            // up. Commutators are in closed form, and by Jacobi's identity.
            BuiltIn::Sexp | BuiltIn::Midpoint | BuiltIn::SexpLevy => {
                8.0 * STEPS as f64 * f64::EPSILON
            }
            _ => 0.0,
        };
        assert!(found <= allowed, "{} on {}: {found:e}", kind.id(), system.name());
    }
    let (li, with_areas) = (SexpLi::new(&system, y0), SexpLi::with_areas(&system, y0));
    assert_eq!(SexpLi::at_run_time(&adapter).as_ref(), li.as_ref());
    assert_eq!(SexpLi::at_run_time_with_areas(&adapter).as_ref(), with_areas.as_ref());
}

#[test]
fn schemes_at_run_time_are_those_of_compiled_systems() {
    let momentum = [1.1f64.cos(), 0.0, 1.1f64.sin()];
    check(Pendulum::new(1.0).unwrap(), [0.2, 1.0]);
    check(body(), momentum);
    check(RigidBody::one_noise(INERTIA, 1.0).unwrap(), momentum);
    check(MaxwellBloch, [1.0, 2.0, 3.0]);
    check(Poisson3::new(1.0).unwrap(), [1.0, 2.0, 3.0]);
}

/// φ₀(½) φ₁(½) φ₂(1) φ₁(½) φ₀(½) between two halves of the damping, to the bit.
#[test]
fn a_split_step_composes_the_flows_of_the_system() {
    let couplings = Couplings { exchange: 0.8, noise: 0.5, ..Couplings::default() };
    let chain = SpinLattice::on_paths(Shape::periodic(&[4]).unwrap(), couplings).unwrap();
    assert_eq!(chain.description().parts.as_ref().map(|parts| parts.number), Ok(3));
    let mut paths = run_time::Scheme::stepper(&Split, &chain).unwrap();
    let mut numbers = Numbers(2);
    paths.state_mut().iter_mut().flatten().for_each(|y| *y = numbers.next());
    let mut y = Rows::zero(12);
    y.copy_from_slice(paths.state());
    let (dw, half) = (Rows::splat(&[0.2, -0.3, 0.4]), Rows::splat(&[0.1, -0.15, 0.2]));
    let (noise, half) = (StepNoise::from(dw), half);
    let step = Step::new(&Cosine::new(0.5, 2.0).unwrap(), 3, 0.1).unwrap();
    paths.step(&step, &noise, &mut BlockStatus::explicit());
    y.iter_mut().flatten().for_each(|y| *y *= step.first_decay);
    for part in [0, 1, 2, 1, 0] {
        let (dt, dw) = if part == 2 { (0.1, &noise.increments) } else { (0.05, &half) };
        chain.flow(part, &mut y, Weights { dt, dw, ..Weights::NONE }, &mut []);
    }
    y.iter_mut().flatten().for_each(|y| *y *= step.second_decay);
    assert_eq!(paths.state(), &y[..]);
}

/// Explicit schemes in nine dimensions are the same to the bit, and fixed-point iteration in single
/// sweeps.
#[test]
fn nine_dimensions_have_the_same_bits() {
    // Poisson3 begins with a plain sweep; others write it out.
    let (system, y0) = (Spins::<9>, [0.6, 0.0, 0.8, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0]);
    let adapter = Compiled::new(system, y0);
    let sexp_li = SexpLi::new(&system, y0).unwrap();
    let settled = WithSolver { formula: Sexp, solver: Solver::default().settled() };
    type Both<'a> = (&'a dyn Scheme<Spins<9>, 9, 3>, &'a dyn run_time::Scheme);
    let schemes: [Both<'_>; 6] = [
        (&Heun, &Heun),
        (&Wide, &Wide),
        (&sexp_li, &sexp_li),
        (&Sexp, &Sexp),
        (&Midpoint, &Midpoint),
        (&settled, &settled),
    ];
    for (tau, both) in [1.0 / 64.0, 0.2].into_iter().flat_map(|tau| schemes.map(|both| (tau, both)))
    {
        assert_eq!(difference(&system, both, &adapter, y0, tau), 0.0, "{}", both.0.about().id);
    }
}

/// One step on 32 paths from states around y0 with large increments: the solutions, and on how many
/// paths Newton's method was needed.
fn one_step<F: Implicit>(
    scheme: &F,
    adapter: &dyn System,
    y0: &[f64],
    (tau, noise): (f64, &StepNoise),
) -> (Rows, BlockStatus) {
    let mut paths = run_time::Scheme::stepper(scheme, adapter).unwrap();
    let mut numbers = Numbers(5);
    paths.state_mut().iter_mut().zip(y0).for_each(|(row, y)| {
        *row = std::array::from_fn(|_| y + 0.1 * numbers.next());
    });
    let mut status = BlockStatus::explicit();
    let step = Step::new(&Cosine::new(0.5, 2.0).unwrap(), 0, tau).unwrap();
    paths.step(&step, noise, &mut status);
    let mut z = Rows::zero(y0.len());
    z.copy_from_slice(paths.state());
    (z, status)
}

#[test]
fn newton_without_a_matrix_finds_the_same_solutions() {
    fn check<S: PoissonSystem<D, M> + Clone, const D: usize, const M: usize>(
        system: S,
        y0: [f64; D],
        scale: f64,
    ) {
        let adapter = Compiled::new(system.clone(), y0);
        let mut noise = StepNoise::zero(M);
        let mut numbers = Numbers(11);
        noise.increments.iter_mut().flatten().for_each(|dw| *dw = scale * numbers.next());
        let h = (0.1, &noise);
        let one_sweep = Solver { max_sweeps: 1, ..Solver::new(Method::FixedPoint) };
        let forced = WithSolver { formula: Sexp, solver: one_sweep };
        let (z, status) = one_step(&forced, &adapter, &y0, h);
        let (expected, fast) = one_step(&Sexp, &adapter, &y0, h);
        assert!(status.robust.len() > 20, "{}: {}", system.name(), status.robust.len());
        assert!(status.failed.is_empty() && fast.failed.is_empty(), "{}", system.name());
        for (z, expected) in z.iter().flatten().zip(expected.iter().flatten()) {
            // Residuals of both of a few ε, amplified by (1 − contraction)⁻¹.
            let error = (z - expected).abs() / (1.0 + expected.abs());
            assert!(error < 200.0 * f64::EPSILON, "{}: {error:e}", system.name());
        }
    }
    check(body(), [0.6, 0.0, 0.8], 0.5);
    check(Pendulum::new(1.0).unwrap(), [0.2, 1.0], 0.5);
    check(MaxwellBloch, [1.0, 0.5, 0.8], 0.3);
    check(Poisson3::new(1.0).unwrap(), [1.0, 0.5, 0.8], 0.1);
    check(populations_1(), [0.8, 1.4, 0.6], 0.1);
    check(Spins::<9>, [0.6, 0.0, 0.8, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0], 0.5);
}

/// Where the iteration does not contract, the solution is that of the compiled system.
#[test]
fn large_increments_are_solved_on_the_branch_of_the_flow() {
    let (system, y0) = (body(), [0.6, 0.0, 0.8]);
    let adapter = Compiled::new(system, y0);
    let dw = Rows::splat(&[3.0, -2.5, 2.0]).into();
    let (z, status) = one_step(&Sexp, &adapter, &y0, (0.5, &dw));
    assert!(status.failed.is_empty() && !status.robust.is_empty());
    let mut numbers = Numbers(5);
    let mut y = Block::<3>::zero();
    for i in 0..3 {
        y.0[i] = std::array::from_fn(|_| y0[i] + 0.1 * numbers.next());
    }
    let step = Step::new(&Cosine::new(0.5, 2.0).unwrap(), 0, 0.5).unwrap();
    let dw = Block::splat([3.0, -2.5, 2.0]);
    let noise = BlockNoise::increments(&dw.0);
    let mut compiled = BlockStatus::explicit();
    Sexp.step_block(&system, &step, &noise, &mut y, &mut compiled);
    assert!(compiled.failed.is_empty());
    for (z, expected) in z.iter().flatten().zip(y.0.iter().flatten()) {
        assert!((z - expected).abs() < 1e-12, "{z} {expected}");
    }
}

/// An oscillator with a quartic potential whose unit of length, and of time, is `unit`.
#[derive(Clone, Copy)]
struct Quartic {
    unit: f64,
}

impl PoissonSystem<2, 1> for Quartic {
    fn name(&self) -> &'static str {
        "quartic"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; 2], dt: f64, dw: [f64; 1]) -> R {
        let square = y[0] * y[0] * self.unit.powi(-2);
        (y[1] * y[1] + square + square * square * 0.5) * (0.5 * dt) - y[0] * dw[0]
    }
}

/// Positions are 10⁻⁸ times the momenta, and the equations are still solved, for steps of one and
/// of two units of time.
#[test]
fn units_do_not_matter() {
    for time in [1.0, 2.0] {
        let solve = |unit: f64| {
            let adapter = Compiled::new(Quartic { unit }, [unit, 0.5]);
            let mut paths = run_time::Scheme::stepper(&Sexp, &adapter).unwrap();
            let mut numbers = Numbers(5);
            for p in 0..WIDTH {
                let [q, momentum] = numbers.point([1.0, 0.5], 1.0);
                (paths.state_mut()[0][p], paths.state_mut()[1][p]) = (unit * q, momentum);
            }
            let step = Step::new(&Constant::new(0.0).unwrap(), 0, unit * time).unwrap();
            let mut status = BlockStatus::explicit();
            paths.step(&step, &StepNoise::zero(1), &mut status);
            assert!(status.failed.is_empty(), "{unit} {time}: {}", status.failed.len());
            assert!(!status.robust.is_empty());
            let [q, p] = [0, 1].map(|i| paths.state()[i]);
            (q.map(|q| q / unit), p)
        };
        let unit = 1e-8;
        let ((q, p), (expected_q, expected_p)) = (solve(unit), solve(1.0));
        for l in 0..WIDTH {
            // Residuals are a few ε of |p|, which is ε/unit of q.
            let error = (q[l] - expected_q[l]).abs() + (p[l] - expected_p[l]).abs();
            assert!(error < 200.0 * f64::EPSILON / unit, "{time}: {error:e}");
        }
    }
}

/// z = z + B(ẑ)∇h(ẑ), which has no solution: z − ψ(z) has the derivative 0.
struct Unsolvable;

impl Implicit for Unsolvable {
    const ID: &'static str = "unsolvable";

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        z + h.field(start)
    }
}

#[test]
fn an_equation_without_a_solution_fails() {
    let (y0, noise) = ([0.6, 0.0, 0.8], StepNoise::zero(3));
    let (_, status) = one_step(&Unsolvable, &Compiled::new(body(), y0), &y0, (0.5, &noise));
    assert_eq!(status.failed.len(), WIDTH as u32);
}

#[test]
fn schemes_that_cannot_run_say_why() {
    let adapter = Compiled::new(body(), [0.6, 0.0, 0.8]);
    let error = |scheme: &dyn run_time::Scheme| {
        scheme.stepper(&adapter).map(|_| ()).unwrap_err().to_string()
    };
    let nv = BuiltIn::Nv.at_run_time(&adapter).map(|_| ()).unwrap_err().to_string();
    assert!(nv.starts_with("nv needs a sum of parts with flows"), "{nv}");
    assert!(error(&Split).contains("are for compiled schemes"), "{}", error(&Split));
}
