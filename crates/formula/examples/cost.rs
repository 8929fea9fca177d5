//! What a path costs: B(y)v, h, ∇h, ∇²h·u and the linearly implicit step of the paper's systems,
//! as formulas and compiled, in nanoseconds per path on one core. Run it with `--release`.

mod paper;

use std::{hint::black_box, time::Instant};

use formula::{Definition, FormulaSystem};
use real::{Level, Rows, WIDTH};
use systems::{
    IntegerExponents, Linearity, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, RigidBody,
    run_time::{Compiled, System, Weights},
};

/// Rounds of which the fastest counts, and evaluations in a round.
const ROUNDS: usize = 40;
const EVALUATIONS: usize = 4000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("{}; nanoseconds per path: formula / compiled\n", Level::current().name());
    println!("{:16}{:>16}{:>16}{:>16}{:>16}{:>16}", "", "B v", "h", "grad h", "hess h u", "cayley");
    let (inertia, noise) = ([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]);
    let body = RigidBody::three_noises(inertia, noise)?;
    let y3 = [0.6, 0.3, 0.8];
    row(&paper::pendulum(0.5), &Compiled::new(Pendulum::new(0.5)?, [0.2, 1.0]), &[0.2, 1.0])?;
    row(&paper::rigid_body(inertia, noise), &Compiled::new(body, y3), &y3)?;
    let populations = LotkaVolterra::<IntegerExponents<2, 2>>::integer(0.5)?;
    row(&paper::lotka_volterra(0.5), &Compiled::new(populations, y3), &y3)?;
    row(&paper::maxwell_bloch(), &Compiled::new(MaxwellBloch, y3), &y3)?;
    row(&paper::poisson3(0.5), &Compiled::new(Poisson3::new(0.5)?, y3), &y3)?;
    Ok(())
}

/// The costs of one system in two forms.
fn row(
    definition: &Definition,
    compiled: &dyn System,
    y0: &[f64],
) -> Result<(), Box<dyn std::error::Error>> {
    let formula = FormulaSystem::new(definition, y0)?;
    let (ours, theirs) = (costs(&formula, y0)?, costs(compiled, y0)?);
    print!("{:16}", definition.name);
    for (ours, theirs) in ours.iter().zip(theirs) {
        print!("{:>16}", format!("{ours:.2} / {theirs:.2}"));
    }
    println!("   {:?}", formula.instructions());
    Ok(())
}

/// The costs of B(y)v, h, ∇h, ∇²h·u and the linearly implicit step; zero where there is none.
fn costs(system: &dyn System, y0: &[f64]) -> Result<[f64; 5], Box<dyn std::error::Error>> {
    let all = || 0..y0.len();
    let (y, v) = (Rows::splat(y0)?, Rows::splat(&vec![0.01; y0.len()])?);
    let dw = Rows::splat(&vec![0.1; system.noises()])?;
    let (mut out, mut scratch) = (Rows::zero(y0.len())?, Rows::zero(system.scratch_rows())?);
    let h = Weights { dt: 0.01, dw: &dw };
    let affine = system.linearity() != Linearity::Other;
    Ok([
        cost(|| system.structure(all(), &y, &v, &mut out, &mut scratch)),
        cost(|| system.energy(&y, h, &mut out[0], &mut scratch)),
        cost(|| system.gradient(all(), &y, h, &mut out, &mut scratch)),
        cost(|| system.hessian(all(), &y, &v, h, &mut out, &mut scratch)),
        cost(|| {
            if affine {
                system.cayley(all(), &y, &v, &mut out, &mut scratch);
            }
        }),
    ])
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
