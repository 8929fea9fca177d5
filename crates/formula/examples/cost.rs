//! What a path costs in nanoseconds on one core, as formulas and compiled: B(y)v, h, ∇h, ∇²h·u and
//! the linearly implicit step of the paper's systems. Run it with `--release`; `step_cost` has whole
//! steps.

mod paper;

use std::{error::Error, hint::black_box, time::Instant};

use formula::{Definition, FormulaSystem};
use real::{Level, Rows, WIDTH};
use systems::{
    IntegerExponents, Linearity, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem,
    RigidBody,
    run_time::{Compiled, Op, System, Weights},
};

/// Rounds of which the fastest counts, and evaluations in a round.
const ROUNDS: usize = 30;
const EVALUATIONS: usize = 3000;

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    let (inertia, noise, y3) = ([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0], [0.6, 0.3, 0.8]);
    let body = RigidBody::three_noises(inertia, noise)?;
    let populations = LotkaVolterra::<IntegerExponents<2, 2>>::integer(0.5)?;
    println!("{}: nanoseconds per path, formula / compiled", Level::current().name());
    row(&paper::pendulum(0.5), Pendulum::new(0.5)?, [0.2, 1.0])?;
    row(&paper::rigid_body(inertia, noise), body, y3)?;
    row(&paper::lotka_volterra(0.5), populations, y3)?;
    row(&paper::maxwell_bloch(), MaxwellBloch, y3)?;
    row(&paper::poisson3(0.5), Poisson3::new(0.5)?, y3)
}

/// The costs of one system in two forms; those of schemes also at compile time.
fn row<S, const D: usize, const M: usize>(
    definition: &Definition,
    system: S,
    y0: [f64; D],
) -> Outcome<()>
where
    S: PoissonSystem<D, M> + Copy,
{
    let (formula, compiled) = (FormulaSystem::new(definition, &y0)?, Compiled::new(system, y0));
    println!("{}", definition.name);
    let names = ["B v", "h", "grad h", "hess h u", "cayley"];
    let (ours, theirs) = (operations(&formula, &y0)?, operations(&compiled, &y0)?);
    for (name, (ours, theirs)) in names.iter().zip(ours.iter().zip(theirs)) {
        println!("  {name:10} {ours:8.2} / {theirs:.2}");
    }
    Ok(())
}

/// The costs of B(y)v, h, ∇h, ∇²h·u and the linearly implicit step; zero where there is none.
fn operations(system: &dyn System, y0: &[f64]) -> Outcome<[f64; 5]> {
    let (y, v) = (Rows::splat(y0)?, Rows::splat(&vec![0.01; y0.len()])?);
    let description = system.description();
    let dw = Rows::splat(&vec![0.1; description.noises])?;
    let (mut out, mut scratch) = (Rows::zero(y0.len())?, Rows::zero(description.scratch_rows())?);
    let h = Weights { dt: 0.01, dw: &dw, areas: &[] };
    let affine = description.linearity != Linearity::Other;
    let (y, v): (&[real::Row], &[real::Row]) = (&y, &v);
    let mut of = |op| cost(|| system.apply(op, 0..y.len(), h, &mut out, &mut scratch));
    let [field, gradient, hessian] =
        [Op::Structure { y, v }, Op::Gradient { y }, Op::Hessian { y, u: v }].map(&mut of);
    let cayley = if affine { of(Op::Cayley { y, v }) } else { 0.0 };
    let energy = cost(|| system.energy(y, h, &mut out[0], &mut scratch));
    Ok([field, energy, gradient, hessian, cayley])
}

/// Nanoseconds per path.
fn cost(mut evaluate: impl FnMut()) -> f64 {
    let mut fastest = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for _ in 0..EVALUATIONS {
            evaluate();
            black_box(());
        }
        fastest = fastest.min(start.elapsed().as_secs_f64());
    }
    fastest * 1e9 / (EVALUATIONS * WIDTH) as f64
}
