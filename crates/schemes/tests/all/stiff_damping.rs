//! Every conformal scheme on every system for γτ from 10⁻³ to 10⁶: nothing grows, nothing fails but
//! where a formula is not defined at what underflows, and where γ acts alone the factor is exact.

use crate::common::{
    Numbers, Spins, Visit, any_areas, any_increments, body, conformal_defect, every_system,
    schemes_of,
};
use crate::long_time::Oscillator;
use kernels::Tuned;
use noise::Noise;
use nonlin::Outcome;
use real::Real;
use schemes::{BuiltIn, Heun, Midpoint, Nv, Scheme, Sexp, SexpLevy, SexpLi, Split, Step};
use systems::{Constant, Cosine, Damping, Flows, InvariantKind, Linear, PoissonSystem, Sine};

/// γτ.
const STRENGTHS: [f64; 13] = [1e-3, 1e-2, 0.1, 0.5, 1.0, 2.0, 4.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6];
const TAU: f64 = 1.0 / 64.0;
const STEPS: u64 = 32;
/// Largest defect of a Casimir in units of `conformal_defect`: the fixed point leaves up to 256 of
/// them in rare cases, `nv` and areas less than that, see `conformal.rs` and
/// `without_iteration.rs`.
const LAW: f64 = 256.0;

/// What became of a scheme on a system.
#[derive(Default)]
struct Seen {
    /// The largest |y_n|.
    largest: f64,
    /// In which step it failed, and the smallest component in it after all of its damping.
    failed: Option<(u64, f64)>,
    /// The largest defect of a Casimir while no component is below 10⁻¹⁵⁰.
    defect: f64,
}

fn size<const D: usize>(y: [f64; D]) -> f64 {
    y.iter().fold(0.0, |size, y| y.abs().max(size))
}

fn run<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    scheme: &dyn Scheme<S, D, M>,
    system: &S,
    damping: &dyn Damping,
    y0: [f64; D],
    floor: f64,
) -> Seen {
    let (mut numbers, mut seen, mut y) = (Numbers(4), Seen::default(), y0);
    for n in 0..STEPS {
        let step = Step::new(damping, n, TAU).unwrap();
        let dw = any_increments(&mut numbers, TAU);
        let mut noise = Noise::increments(dw);
        if scheme.about().reads_areas {
            noise.areas = any_areas(&mut numbers, TAU);
        }
        let solution = scheme.step(system, &step, &noise, y);
        let decay = step.first_decay * step.second_decay;
        let smallest = y.iter().fold(f64::INFINITY, |small, y| (decay * y).abs().min(small));
        if let Outcome::Failed { .. } = solution.outcome {
            seen.failed = Some((n, smallest));
            return seen;
        }
        let normal = |y: [f64; D]| y.iter().all(|y| *y == 0.0 || y.abs() > 1e-150);
        if normal(y) && normal(solution.z) {
            for (index, invariant) in system.invariants().iter().enumerate() {
                if invariant.kind == InvariantKind::Casimir {
                    let defect = conformal_defect(system, index, &step, dw, y, solution.z);
                    let law = (-invariant.degree * step.damping_integral()).exp();
                    let off: f64 = system.invariant(index, solution.z);
                    let off = off - law * system.invariant::<f64>(index, y);
                    seen.defect = seen.defect.max(if off.abs() > floor { defect } else { 0.0 });
                }
            }
        }
        y = solution.z;
        seen.largest = seen.largest.max(size(y));
    }
    seen
}

/// Rows of the table that fail, and how many there are.
#[derive(Default)]
struct Table {
    /// What an absolute error of a Casimir may be.
    floor: f64,
    rows: usize,
    wrong: Vec<String>,
    undefined: Vec<(String, &'static str)>,
}

impl Table {
    fn row<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        scheme: &dyn Scheme<S, D, M>,
        system: &S,
        y0: [f64; D],
    ) {
        for strength in STRENGTHS {
            let damping = Constant::new(strength / TAU).unwrap();
            let seen = run(scheme, system, &damping, y0, self.floor);
            let name = format!("{} on {} at γτ = {strength}", scheme.about().id, system.name());
            self.rows += 1;
            // Noise and a turning angle may add something in half a unit of time; growth by the
            // factor of an explicit scheme, 5 and more from γτ = 4 on, is 10²² in 32 steps.
            if seen.largest > 3.0 * size(y0) + 1.0 || seen.largest.is_nan() {
                self.wrong.push(format!("{name}: grows to {}", seen.largest));
            }
            if seen.defect > LAW {
                self.wrong.push(format!("{name}: off its law by {}", seen.defect));
            }
            match seen.failed {
                // Below this a product of five components underflows, such as H of Lotka–Volterra.
                Some((_, smallest)) if smallest < 1e-61 => {
                    println!("{name}: fails in step {:?}", seen.failed);
                    let row = (system.name().to_owned() + &system.parameters(), scheme.about().id);
                    if !self.undefined.contains(&row) {
                        self.undefined.push(row);
                    }
                }
                Some(failed) => self.wrong.push(format!("{name}: fails in step {failed:?}")),
                None => {}
            }
        }
    }
}

impl Visit for Table {
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]) {
        use BuiltIn::{Nv, Sexp, SexpLevy, SexpLi, SexpLiLevy, Split};
        for scheme in schemes_of(&[Sexp, SexpLi, SexpLevy, SexpLiLevy, Split, Nv], system, y0) {
            // Flows of its parts move components by up to one and back, and S is rounded there.
            let rounds =
                system.name() == "poisson3" && ["split", "nv"].contains(&scheme.about().id);
            self.floor = if rounds { 4.0 * f64::EPSILON } else { 0.0 };
            self.row(&*scheme, system, y0);
        }
    }
}

#[test]
fn no_growth_and_no_failure_from_weak_to_stiff_damping() {
    let mut table = Table::default();
    every_system(&mut table);
    let spins = [0.6, 0.0, 0.8, 0.0, 1.0, 0.0];
    table.visit(&Spins::<6>, spins);
    let oscillator = Oscillator::new(TAU);
    table.visit(&oscillator, [1.0, 0.0]);
    let momentum = [1.1f64.cos(), 0.0, 1.1f64.sin()];
    println!("{} rows, undefined {:?}", table.rows, table.undefined);
    assert!(table.wrong.is_empty(), "{:#?}", table.wrong);
    // B of Lotka–Volterra has poles where a component is zero.
    assert!(table.undefined.iter().all(|row| row.0.starts_with("lotka-volterra")));

    // A twin: the same measure sees Heun's growth.
    let mut twin = Table::default();
    twin.row(&Heun, &body(), momentum);
    twin.row(&Heun, &oscillator, [1.0, 0.0]);
    assert!(twin.wrong.iter().filter(|row| row.contains("grows")).count() >= 12);
}

/// Nothing but damping.
pub struct Alone;

impl PoissonSystem<2, 1> for Alone {
    fn name(&self) -> &'static str {
        "damping alone"
    }
    #[inline(always)]
    fn structure<R: Real>(&self, _: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    #[inline(always)]
    fn energy<R: Real>(&self, _: [R; 2], _: f64, _: [f64; 1]) -> R {
        R::zero()
    }
}

impl Flows<2, 1> for Alone {
    const PARTS: usize = 1;
    #[inline(always)]
    fn flow<R: Real>(&self, _: usize, y: [R; 2], _: R, _: [R; 1]) -> [R; 2] {
        y
    }
}

#[test]
fn damping_that_acts_alone_is_exact() {
    let dampings: [Box<dyn Damping>; 8] = [
        Box::new(Constant::new(3.7).unwrap()),
        Box::new(Constant::new(-3.7).unwrap()),
        Box::new(Constant::new(500.0).unwrap()),
        Box::new(Constant::new(-500.0).unwrap()),
        Box::new(Linear::new(40.0).unwrap()),
        Box::new(Linear::new(-40.0).unwrap()),
        Box::new(Sine::new(60.0, 7.0).unwrap()),
        Box::new(Cosine::new(-60.0, 7.0).unwrap()),
    ];
    let y0 = [0.7, -1.3];
    let levy = SexpLevy::new(&Alone, y0);
    let li = SexpLi::new(&Alone, y0).unwrap();
    let parts = Nv::default();
    let schemes: [&dyn Scheme<Alone, 2, 1>; 5] = [&Sexp, &levy, &li, &Split, &parts];
    let largest = |scheme: &dyn Scheme<Alone, 2, 1>, damping: &dyn Damping| {
        let (mut y, mut worst) = (y0, 0.0f64);
        for n in 0..64 {
            let step = Step::new(damping, n, TAU).unwrap();
            y = scheme.step(&Alone, &step, &Noise::increments([0.1]), y).z;
            let integral = damping.integral(0.0, (n + 1) as f64 * TAU);
            for i in 0..2 {
                let off = (y[i] / (y0[i] * (-integral).exp()) - 1.0).abs();
                // Two products of factors within an ε in each step; two exponents.
                let allowed = f64::EPSILON * (4.0 * (n + 1) as f64 + 2.0 * integral.abs() + 8.0);
                worst = if off.is_nan() { f64::INFINITY } else { worst.max(off / allowed) };
            }
        }
        worst
    };
    for damping in &dampings {
        for scheme in schemes {
            let worst = largest(scheme, damping.as_ref());
            assert!(worst <= 1.0, "{} {}: {worst}", scheme.about().id, damping.describe());
        }
        // Twins.
        assert!(largest(&Heun, damping.as_ref()) > 1e6, "{}", damping.describe());
        assert!(largest(&Midpoint, damping.as_ref()) > 1e6, "{}", damping.describe());
    }
}
