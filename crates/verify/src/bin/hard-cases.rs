//! **Hard inputs: what exact mathematics says, what every scheme does, and what is guaranteed.**
//!
//! `cargo xtask stability`. Each case runs all schemes, 32 paths of each, on inputs that break
//! numerical codes: damping factors near underflow, rates that are infinite, noise past the
//! contraction bound, states of 10¹⁵⁰. A guarantee is a derived bound ([`verify::rounding`]); a
//! cell says whether it holds (✓), whether a scheme fails where theory predicts failure (✗), or
//! that the guarantee is refuted. What each case is and what exact mathematics says of it stands at
//! its function.
//!
//! Increments are truncated with k = 4 unless said otherwise, and the areas of two noises are the
//! product of their increments: the laws hold for any. A path that cannot go on ends with a reason,
//! never with NaN. Long runs and arbitrary inputs are the tests in `tests/measuring`.

use std::process::ExitCode;

use analysis::{number, worse};
use anyhow::Result;
use clap::{Parser, builder::PossibleValuesParser};
use comfy_table::presets::ASCII_MARKDOWN;
use kernels::Tuned;
use mc::Setup;
use noise::{StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{PathMask, Real, Row, WIDTH};
use schemes::{
    BuiltIn::{self, EulerMaruyama, Heun, Midpoint, Nv, SexpLevy, SexpLiLevy, Split},
    Energy, SexpLi, Step,
};
use systems::{
    Constant, Damping, Invariant, LotkaVolterra, PoissonSystem, Problem, RigidBody,
    RigidBodyEnergy,
    paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, rigid_body_three_noises, sine},
};
use verify::{
    Compiled, command,
    rounding::{LINEARLY_IMPLICIT, law_bound, length, residual_share, rotations},
    streams,
};

/// Every scheme on hard inputs: what is guaranteed and what happens.
#[derive(Parser)]
#[command(bin_name = "cargo xtask stability", version)]
struct Arguments {
    /// Run only this case; may be given several times.
    #[arg(long, value_name = "ID")]
    #[arg(value_parser = PossibleValuesParser::new(CASES.iter().map(|case| case.0)))]
    only: Vec<String>,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same bits.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
}

/// A family of hard inputs: its identifier, what is guaranteed, and what runs it.
type Case = (&'static str, &'static str, fn(&mut Table) -> Result<()>);

const LAW: &str = "the law of the invariant to rounding, or an error";
const SOLVABLE: &str = "the law of |y|² to rounding; only `sexp` and `sexp-levy` may end early";

/// All of them, in the order of their streams.
static CASES: [Case; 9] = [
    ("stiff-damping", LAW, stiff),
    ("anti-damping", LAW, anti_damping),
    ("rough-damping", LAW, rough),
    ("large-noise", SOLVABLE, large_noise),
    ("big-steps", SOLVABLE, big_steps),
    ("scales", LAW, scales),
    ("stiff-hamiltonian", LAW, stiff_hamiltonian),
    ("lotka-volterra", LAW, volterra),
    ("near-singular", "the law to 32ε(|y| + |z|)², or an error", near_singular),
];

/// All schemes in one setting, and the conformal law of one invariant.
struct Setting<'a> {
    name: String,
    schemes: Vec<(BuiltIn, Setup<'a>)>,
    steps: u64,
    noise: Noise,
    /// The number of the invariant.
    invariant: usize,
    /// Its relative distance from the law that is allowed in a state, from what is allowed to a
    /// quadratic Casimir.
    allowed: fn(&[f64], f64) -> f64,
    /// Of schemes that keep it those that must not end early.
    solved: &'static [BuiltIn],
    /// Other schemes that theory predicts to fail: their distance exceeds this.
    fails: (&'static [BuiltIn], f64),
    /// Where states must stay.
    inside: fn(&[f64]) -> bool,
}

/// Increments.
enum Noise {
    /// Those of the step, truncated.
    Truncated,
    /// Normal numbers of this deviation.
    Normal(f64),
    /// This size.
    Fixed(f64),
}

/// Schemes that solve nothing by iteration.
const DIRECT: &[BuiltIn] = &[BuiltIn::SexpLi, SexpLiLevy, Split, Nv];
const EXPLICIT: &[BuiltIn] = &[Heun, EulerMaruyama];
const INEXACT: &[BuiltIn] = &[Midpoint, Heun, EulerMaruyama];

impl<'a> Setting<'a> {
    /// The first invariant on truncated noise, by all schemes that are compiled for the system.
    fn of<S: Tuned<D, M>, G: Damping, const D: usize, const M: usize>(
        name: impl ToString,
        problem: &'a Problem<S, G, D>,
        steps: u64,
    ) -> Self {
        let curves = Compiled::of(problem).curves(&BuiltIn::ALL).into_iter();
        Self::new(name, curves.map(|curve| (curve.method, curve.setup)).collect(), steps)
    }

    fn new(name: impl ToString, schemes: Vec<(BuiltIn, Setup<'a>)>, steps: u64) -> Self {
        Self {
            name: name.to_string(),
            schemes,
            steps,
            noise: Noise::Truncated,
            invariant: 0,
            allowed: |_, rounding| rounding,
            solved: &[],
            fails: (&[], 0.0),
            inside: |_| true,
        }
    }

    /// The largest distance of a scheme in words, its verdict, and what was allowed.
    fn run(
        &self,
        key: StreamKey,
        (scheme, Setup { problem, scheme: method }): &(BuiltIn, Setup<'a>),
    ) -> Result<(String, &'static str, f64)> {
        let tau = problem.t_end / self.steps as f64;
        let mut bound = f64::INFINITY;
        if let Noise::Truncated = self.noise
            && method.clips_increments()
        {
            bound = verify::truncation().bound(tau)?;
        }
        let (mut drawn, mut noise) = (WienerRows::new(key, 0), method.no_noise(problem.noises));
        let start: Vec<Row> = problem.y0.iter().map(|y| [*y; WIDTH]).collect();
        let (mut stepper, mut status) = (method.start(&start), BlockStatus::explicit());
        let (law, properties) = (&problem.laws[self.invariant], scheme.properties());
        let value = |y: &[f64]| problem.formulas.law(self.invariant, y);
        let rounding = match scheme {
            BuiltIn::SexpLi | SexpLiLevy => LINEARLY_IMPLICIT,
            Split => rotations(5),
            Nv => rotations(19),
            _ => 1.0,
        };
        let (mut live, mut damping, mut residuals) = (PathMask::ALL, 0.0, [0.0; WIDTH]);
        let (mut largest, mut most, mut kept, mut cause) = (0.0, 0.0, true, None);
        for n in 0..self.steps {
            match self.noise {
                Noise::Truncated => drawn.increments(tau.sqrt(), &mut noise.increments),
                Noise::Normal(deviation) => drawn.increments(deviation, &mut noise.increments),
                Noise::Fixed(size) => noise.increments.as_flattened_mut().fill(size),
            }
            for dw in noise.increments.as_flattened_mut() {
                *dw = dw.clamp(-bound, bound);
            }
            for (place, area) in noise.areas.iter_mut().enumerate() {
                let (m, l) = (place / problem.noises, place % problem.noises);
                let [a, b] = [m, l].map(|m| noise.increments[m]);
                *area = std::array::from_fn(|p| if m < l { a[p] * b[p] } else { 0.0 });
            }
            stepper.step(&Step::new(problem.damping, n, tau)?, &noise, &mut status);
            let [before, t] = [n, n + 1].map(|n| n as f64 * tau);
            damping += problem.damping.integral(before, t).abs();
            let decay = (-law.degree * problem.damping.integral(0.0, t)).exp();
            for p in live.paths() {
                let y: Vec<f64> = stepper.state().iter().map(|row| row[p]).collect();
                let ends = match () {
                    () if !value(&y).is_finite() => "overflow",
                    () if status.failed.contains(p) => "no solution",
                    () if !(self.inside)(&y) => "outside the domain",
                    () => {
                        residuals[p] += residual_share(status.residual(p), &y);
                        let rounding = rounding * law_bound(n + 1, damping) + residuals[p];
                        let allowed = (self.allowed)(&y, rounding);
                        let distance = (value(&y) / (decay * value(&problem.y0)) - 1.0).abs();
                        (largest, most) = (worse(largest, distance), f64::max(most, allowed));
                        kept &= distance <= allowed;
                        continue;
                    }
                };
                live.remove(p);
                cause.get_or_insert(format!("{ends} in step {}", n + 1));
                stepper.state_mut().iter_mut().zip(&start).for_each(|(y, y0)| y[p] = y0[p]);
            }
        }
        let ended = cause.is_some();
        let keeps = law.casimir || properties.energy == Energy::Kept;
        let verdict = if properties.exact_damping && keeps {
            if kept && !(ended && self.solved.contains(scheme)) { HOLDS } else { REFUTED }
        } else if !self.fails.0.contains(scheme) {
            if ended || !f64::is_nan(largest) { OBSERVED } else { REFUTED }
        } else if ended || largest > self.fails.1 {
            FAILS
        } else {
            REFUTED
        };
        let mut words = number(largest) + verdict;
        if let Some(cause) = cause {
            words += &format!("; {} of {WIDTH} paths: {cause}", WIDTH as u32 - live.len());
        }
        Ok((words, verdict, if verdict == HOLDS { most } else { 0.0 }))
    }
}

/// What became of a scheme.
const HOLDS: &str = " ✓";
const FAILS: &str = " ✗";
const OBSERVED: &str = "";
const REFUTED: &str = " REFUTED";

/// The settings of a case, and all verdicts.
struct Table {
    key: StreamKey,
    rows: Vec<Vec<String>>,
    verdicts: Vec<&'static str>,
}

impl Table {
    /// Adds a row: setting, bound, and the cell of each scheme.
    fn add(&mut self, setting: &Setting<'_>) -> Result<()> {
        let mut row = vec![String::new(); 2 + BuiltIn::ALL.len()];
        let mut bound = 0.0;
        for run in &setting.schemes {
            let (words, verdict, allowed) = setting.run(self.key, run)?;
            bound = f64::max(bound, allowed);
            row[2 + run.0 as usize] = words;
            self.verdicts.push(verdict);
        }
        (row[0], row[1]) = (setting.name.clone(), number(bound));
        self.rows.push(row);
        Ok(())
    }
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs the cases that are asked for, and prints a table of each. Fails when a guarantee is
/// refuted.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    let key = StreamKey { seed: arguments.seed, experiment: 0 };
    let mut table = Table { key, rows: Vec::new(), verdicts: Vec::new() };
    for ((id, guaranteed, case), experiment) in CASES.iter().zip(streams::HARD_CASES..) {
        if arguments.only.is_empty() || arguments.only.iter().any(|only| only == id) {
            table.key.experiment = experiment;
            case(&mut table)?;
            let head = ["setting", "bound"].into_iter().chain(BuiltIn::ALL.map(BuiltIn::id));
            let mut rows = comfy_table::Table::new();
            rows.load_style(ASCII_MARKDOWN).set_header(head).add_rows(table.rows.drain(..));
            println!("{id}\nguaranteed: {guaranteed}\n{rows}\n");
        }
    }
    let [hold, fail, observed, refuted] = [HOLDS, FAILS, OBSERVED, REFUTED]
        .map(|one| table.verdicts.iter().filter(|verdict| **verdict == one).count());
    println!("{hold} hold, {fail} fail as they must, {observed} observed, {refuted} refuted");
    Ok(if refuted == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The paper's rigid body with three noises, with any damping, up to the time `t_end`.
fn body<G: Damping>(damping: G, t_end: f64) -> Result<Problem<RigidBody<3>, G, 3>> {
    let body = rigid_body_three_noises(1.0).into_parts().0;
    Ok(Problem::new::<3>(body, damping, rigid_body_start(), t_end)?)
}

/// Constant γ with γτ up to 300, one step: |y|² is multiplied by e^(−2γτ). From 4 on rational
/// functions of γτ are off by more than the value: Euler's factor 1 − x, Heun's 1 − x + x²/2, and
/// that of the midpoint rule, (1 − x/2)/(1 + x/2), which tends to −1.
fn stiff(table: &mut Table) -> Result<()> {
    for x in [0.1, 1.0, 2.0, 4.0, 10.0, 100.0, 300.0] {
        let problem = body(Constant::new(16.0 * x)?, 1.0 / 16.0)?;
        let fails = (if x < 4.0 { &[] } else { INEXACT }, 1.0);
        table.add(&Setting { fails, ..Setting::of(x, &problem, 1) })?;
    }
    Ok(())
}

/// Constant γ < 0, up to 64 steps of τ = 1/64: |y(t)|² = e^(2|γ|t)|y₀|² overflows in finite time.
/// Long before, a step is large for a body that turns so fast.
fn anti_damping(table: &mut Table) -> Result<()> {
    for x in [-0.01, -0.1, -1.0, -10.0, -100.0, -1e4] {
        let problem = body(Constant::new(64.0 * x)?, 1.0)?;
        let fails = (if x > -0.1 { &[] } else { INEXACT }, 1e-6);
        table.add(&Setting { fails, ..Setting::of(x, &problem, 64) })?;
    }
    Ok(())
}

/// γ = ½|t − s|^{−½} with the pole s.
struct Pole(f64);

impl Damping for Pole {
    fn rate(&self, t: f64) -> f64 {
        0.5 / (t - self.0).abs().sqrt()
    }

    fn integral(&self, a: f64, b: f64) -> f64 {
        let [a, b] = [a, b].map(|t| (t - self.0).abs().sqrt().copysign(t - self.0));
        b - a
    }

    fn describe(&self) -> String {
        "γ with a pole".into()
    }
}

/// γ that is infinite at a time but integrable, 64 steps of τ = 1/64: |y(t)|² = e^(−2∫γ)|y₀|² all
/// the same. With each the schemes that read γ where it is infinite.
fn rough(table: &mut Table) -> Result<()> {
    let settings: [(_, _, &'static [BuiltIn]); 3] = [
        ("at the start", 0.0, EXPLICIT),
        ("in a middle", 32.5 / 64.0, &[Midpoint]),
        ("inside a step", 0.7, &[]),
    ];
    for (name, pole, schemes) in settings {
        let problem = body(Pole(pole), 1.0)?;
        let (fails, solved) = ((schemes, f64::INFINITY), &BuiltIn::ALL);
        table.add(&Setting { fails, solved, ..Setting::of(name, &problem, 64) })?;
    }
    Ok(())
}

/// Increments past the contraction bound, not truncated, γ = 0: one step of τ = 0.1. While the map
/// contracts, for sure while max|kᵢ − kⱼ| < 1 with k = τ/I + ΔW/Î, there is one solution; beyond,
/// there may be several.
fn large_noise(table: &mut Table) -> Result<()> {
    for size in [0.1, 1.0, 10.0, 100.0] {
        let problem = body(Constant::new(0.0)?, 0.1)?;
        let solved = if size > 0.1 { DIRECT } else { &BuiltIn::ALL };
        let noise = Noise::Normal(size);
        table.add(&Setting { noise, solved, ..Setting::of(size, &problem, 1) })?;
    }
    Ok(())
}

/// Steps up to 0.9, where truncation is still defined, γ = ½cos 2t. A scheme keeps the law for
/// every τ at which its equation has a solution.
fn big_steps(table: &mut Table) -> Result<()> {
    for tau in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let problem = body(half_cosine(), 64.0 * tau)?;
        table.add(&Setting { solved: DIRECT, ..Setting::of(tau, &problem, 64) })?;
    }
    Ok(())
}

/// States from 10⁻¹⁵⁰ to 10¹⁵⁰, γ = ½cos 2t, 64 steps of τ = 1/64. State and moments of inertia are
/// multiplied by a power of two; the solution scales with them. The weights 1/Î² of areas overflow
/// or underflow.
fn scales(table: &mut Table) -> Result<()> {
    for exponent in [-498, -166, 166, 498] {
        let [inertia, noise, start] = [INERTIA, NOISE_INERTIA, rigid_body_start()]
            .map(|values| values.map(|x| x * 2f64.powi(exponent)));
        let body = RigidBody::three_noises(inertia, noise)?;
        let problem = Problem::new::<3>(body, half_cosine(), start, 1.0)?;
        let mut setting = Setting::of(format!("2^{exponent}"), &problem, 64);
        setting.schemes.retain(|(scheme, _)| ![SexpLevy, SexpLiLevy].contains(scheme));
        table.add(&Setting { solved: &BuiltIn::ALL, ..setting })?;
    }
    Ok(())
}

/// Frequencies ω far above 1/τ: the body with noise H₀ and moments of inertia (2, 1, 2/3)/ω, γ =
/// ½cos 2t, 256 steps of τ = 1/64. |y|² and H₀ decay as e^(−2∫γ) for every ω; the phase is not
/// guaranteed. At ω = 10⁴ explicit schemes multiply the fast components by about ωτ in every step.
/// Rounding in H₀, a form whose largest coefficient is three times its smallest, is at most three
/// times that in ½|y|².
fn stiff_hamiltonian(table: &mut Table) -> Result<()> {
    for (invariant, omega) in [0, 1].into_iter().flat_map(|i| [1.0, 100.0, 1e4].map(|w| (i, w))) {
        let body = RigidBodyEnergy::new(INERTIA.map(|i| i / omega), 1.0)?;
        let problem = Problem::new::<1>(body, half_cosine(), rigid_body_start(), 4.0)?;
        let setting = Setting::of(format!("{}, {omega}", ["C", "H"][invariant]), &problem, 256);
        let fails = (if omega < 1e3 { &[] } else { EXPLICIT }, 1.0);
        let allowed = |_: &[f64], rounding| 3.0 * rounding;
        table.add(&Setting { invariant, allowed, fails, ..setting })?;
    }
    Ok(())
}

/// Next to the coordinate planes, where B has its poles: Lotka–Volterra, a = −1, b = −2, γ = sin t,
/// up to t = 2. The solution stays positive. The Casimir 2y₁ + y₂ + y₃ follows e^(−∫γ): half of
/// what a quadratic one costs, but its coefficients differ by two.
fn volterra(table: &mut Table) -> Result<()> {
    for y0 in [[1e-12, 0.4, 0.6], [0.2, 1e-12, 0.6], [0.2, 0.4, 1e-12], [1e-12; 3]] {
        for steps in [32, 128, 512] {
            let system = LotkaVolterra::<2, 2>::new(1.0)?;
            let problem = Problem::new::<1>(system, sine(), y0, 2.0)?;
            let setting = Setting::of(format!("{y0:?}, 2/{steps}"), &problem, steps);
            let allowed = |_: &[f64], rounding| 2.0 * rounding;
            let inside = |y: &[f64]| y.iter().all(|y| *y > 0.0);
            table.add(&Setting { invariant: 1, allowed, inside, ..setting })?;
        }
    }
    Ok(())
}

/// so(2,1) with one noise along an axis: B(y)v = K(y × v), K = diag(1, 1, −1), H₁ = y₁.
struct Hyperbolic;

impl PoissonSystem<3, 1> for Hyperbolic {
    fn name(&self) -> &'static str {
        "hyperbolic"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let along = y[1] * v[0] - y[0] * v[1];
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], along]
    }
    fn energy<R: Real>(&self, y: [R; 3], _dt: f64, dw: [f64; 1]) -> R {
        y[0] * dw[0]
    }
    fn invariants(&self) -> Vec<Invariant> {
        vec![Invariant::quadratic_casimir("C", "y₁² + y₂² − y₃²")]
    }
    fn invariant<R: Real>(&self, _index: usize, y: [R; 3]) -> R {
        y[0] * y[0] + y[1] * y[1] - y[2] * y[2]
    }
}

/// One step of `sexp-li` with ΔW = 2(1 − δ): (y₂, y₃) are boosted, and I − ½A has the determinant 1
/// − ¼ΔW². |z| grows like 1/δ with C = y₁² + y₂² − y₃² kept; at δ = 0 there is no solution. The
/// rounding of the determinant scales the change of the state: C changes by a multiple of its own
/// value. Otherwise fewer than 64 halves of ε, each times at most (|y| + |z|)².
fn near_singular(table: &mut Table) -> Result<()> {
    const START: [f64; 3] = [0.3, 0.8, 0.1];
    for delta in [0.5, 1e-2, 1e-5, 1e-10, 1e-15, 0.0] {
        let problem = Problem::new::<1>(Hyperbolic, Constant::new(0.0)?, START, 0.1)?;
        let scheme = SexpLi::new(problem.system(), START)?;
        let schemes = vec![(BuiltIn::SexpLi, Setup::of(&problem, &scheme))];
        let noise = Noise::Fixed(2.0 * (1.0 - delta));
        let allowed = |z: &[f64], _| {
            let size = length(&START) + length(z);
            32.0 * f64::EPSILON * size * size / Hyperbolic.invariant(0, START)
        };
        let setting = Setting::new(delta, schemes, 1);
        table.add(&Setting { noise, allowed, ..setting })?;
    }
    Ok(())
}
