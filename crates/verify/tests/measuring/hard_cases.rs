//! **Hard inputs: what exact mathematics says, what every scheme does, and what is guaranteed.**
//!
//! `cargo xtask stability` prints them. Each case runs all schemes, 32 paths of each, on inputs
//! that break numerical codes: damping factors near underflow, rates that are infinite, noise past
//! the contraction bound, states of 10¹⁵⁰. A guarantee is a derived bound
//! ([`rounding`](super::rounding)); a cell says whether it holds (✓), whether a scheme fails where
//! theory predicts failure (✗), or that the guarantee is refuted. What each case is and what exact
//! mathematics says of it stands at its function.
//!
//! Increments are truncated with k = 4 unless said otherwise, and the areas of two noises are the
//! product of their increments: the laws hold for any. A path that cannot go on ends with a reason,
//! never with NaN.

use analysis::{number, worse};
use anyhow::Result;
use kernels::Tuned;
use mc::Setup;
use noise::{StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{PathMask, Row, WIDTH};
use schemes::{
    BuiltIn::{self, EulerMaruyama, Heun, Midpoint, Nv, SexpLevy, SexpLi, SexpLiLevy, Split},
    Energy, Step,
};
use systems::{
    Constant, Damping, LotkaVolterra, Problem, RigidBody, RigidBodyEnergy,
    paper::{INERTIA, NOISE_INERTIA, half_cosine, rigid_body_start, rigid_body_three_noises, sine},
};
use verify::{Compiled, streams};

use super::{
    SEED,
    rounding::{LINEARLY_IMPLICIT, law_bound, residual_share, rotations},
};

/// The law of the invariant to rounding, or an error, is guaranteed in each case. Its number is
/// that of its streams.
fn run(number: u64, seed: u64, case: fn(&mut Table) -> Result<()>) -> Table {
    let key = StreamKey { seed, experiment: streams::HARD_CASES + number };
    let mut table = Table { key, verdicts: Vec::new(), lines: Vec::new() };
    case(&mut table).unwrap();
    println!("{}\n", table.lines.join("\n"));
    assert!(!table.verdicts.contains(&REFUTED), "{}", table.lines.join("\n"));
    table
}

/// That these schemes fail somewhere.
fn fail(table: &Table, schemes: &[BuiltIn]) {
    for scheme in schemes {
        let mut cells = table.lines.iter().flat_map(|line| line.split([':', '|'])).map(str::trim);
        let failed =
            |cell: &str| cell.starts_with(&format!("{} ", scheme.id())) && cell.contains(FAILS);
        assert!(cells.any(failed), "{}: {}", scheme.id(), table.lines.join("\n"));
    }
}

#[test]
fn stiff_damping() {
    let case =
        |table: &mut Table| damped(table, &[0.1, 1.0, 2.0, 4.0, 10.0, 100.0, 300.0], 1, (4.0, 1.0));
    fail(&run(0, SEED, case), INEXACT);
}

#[test]
fn anti_damping() {
    let case =
        |table: &mut Table| damped(table, &[-0.01, -0.1, -1.0, -10.0, -1e4], 64, (0.1, 1e-3));
    fail(&run(1, SEED, case), &[Midpoint]);
}

#[test]
fn rough_damping() {
    fail(&run(2, SEED, rough), &[EulerMaruyama, Midpoint]);
}

/// The same seed gives the same bits.
#[test]
fn large_noises() {
    let lines = |seed| run(3, seed, large_noise).lines;
    assert_eq!(lines(SEED), lines(SEED));
    assert_ne!(lines(SEED), lines(SEED + 1));
}

#[test]
fn sizes() {
    run(4, SEED, scales);
}

#[test]
fn stiff_hamiltonians() {
    fail(&run(5, SEED, stiff_hamiltonian), &[Heun]);
}

#[test]
fn populations_near_their_planes() {
    run(6, SEED, volterra);
}

/// All schemes in one setting, and the conformal law of one invariant.
struct Setting<'a> {
    name: String,
    schemes: Vec<(BuiltIn, Setup<'a>)>,
    steps: u64,
    /// The deviation of normal noise that is not truncated; or else the noise is that of the step.
    deviation: Option<f64>,
    /// The number of the invariant.
    invariant: usize,
    /// How often what is allowed to a quadratic Casimir its relative distance from the law may be.
    allowed: f64,
    /// Of schemes that keep it those that must not end early.
    solved: &'static [BuiltIn],
    /// Other schemes that theory predicts to fail: their distance exceeds this.
    fails: (&'static [BuiltIn], f64),
    /// Where states must stay.
    inside: fn(&[f64]) -> bool,
}

/// Schemes that solve nothing by iteration.
const DIRECT: &[BuiltIn] = &[SexpLi, SexpLiLevy, Split, Nv];
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
        Self {
            name: name.to_string(),
            schemes: curves.map(|curve| (curve.method, curve.setup)).collect(),
            steps,
            deviation: None,
            invariant: 0,
            allowed: 1.0,
            solved: &[],
            fails: (&[], 0.0),
            inside: |_| true,
        }
    }

    /// The largest distance of a scheme in words, and its verdict.
    fn run(
        &self,
        key: StreamKey,
        (scheme, Setup { problem, scheme: method }): &(BuiltIn, Setup<'a>),
    ) -> Result<(String, &'static str)> {
        let tau = problem.t_end / self.steps as f64;
        let mut bound = f64::INFINITY;
        if self.deviation.is_none() && method.about().clips_increments {
            bound = verify::truncation().bound(tau)?;
        }
        let (mut drawn, mut noise) = (WienerRows::new(key, 0), method.no_noise(problem.noises));
        let start: Vec<Row> = problem.y0.iter().map(|y| [*y; WIDTH]).collect();
        let (mut stepper, mut status) = (method.start(&start), BlockStatus::explicit());
        let (law, properties) = (&problem.laws[self.invariant], scheme.properties());
        let value = &law.value;
        let rounding = match scheme {
            SexpLi | SexpLiLevy => LINEARLY_IMPLICIT,
            Split => rotations(5),
            Nv => rotations(19),
            _ => 1.0,
        };
        let (mut live, mut damping, mut residuals) = (PathMask::ALL, 0.0, [0.0; WIDTH]);
        let (mut largest, mut kept, mut cause) = (0.0, true, None);
        for n in 0..self.steps {
            drawn.increments(self.deviation.unwrap_or(tau.sqrt()), &mut noise.increments);
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
                        let allowed = self.allowed * rounding;
                        let distance = (value(&y) / (decay * value(&problem.y0)) - 1.0).abs();
                        largest = worse(largest, distance);
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
        let (expected, found) = if properties.exact_damping && keeps {
            (HOLDS, kept && !(ended && self.solved.contains(scheme)))
        } else if self.fails.0.contains(scheme) {
            (FAILS, ended || largest > self.fails.1)
        } else {
            (OBSERVED, ended || !f64::is_nan(largest))
        };
        let verdict = if found { expected } else { REFUTED };
        let mut words = number(largest) + verdict;
        if let Some(cause) = cause {
            words += &format!("; {} of {WIDTH} paths: {cause}", WIDTH as u32 - live.len());
        }
        Ok((words, verdict))
    }
}

/// What became of a scheme.
const HOLDS: &str = " ✓";
const FAILS: &str = " ✗";
const OBSERVED: &str = "";
const REFUTED: &str = " REFUTED";

/// The noise of a case, all verdicts, and a line for each setting.
struct Table {
    key: StreamKey,
    verdicts: Vec<&'static str>,
    lines: Vec<String>,
}

impl Table {
    /// Adds a line: setting, and what became of each scheme.
    fn add(&mut self, setting: &Setting<'_>) -> Result<()> {
        let mut line = format!("{}:", setting.name);
        for run in &setting.schemes {
            let (words, verdict) = setting.run(self.key, run)?;
            line += &format!(" {} {words} |", run.0.id());
            self.verdicts.push(verdict);
        }
        self.lines.push(line);
        Ok(())
    }
}

/// The paper's rigid body with three noises, with any damping, up to the time `t_end`.
fn body<G: Damping>(damping: G, t_end: f64) -> Result<Problem<RigidBody<3>, G, 3>> {
    let body = rigid_body_three_noises(1.0).into_parts().0;
    Ok(Problem::new::<3>(body, damping, rigid_body_start(), t_end)?)
}

/// Constant γ, so many steps with x = γτ: |y|² is multiplied by e^(−2x) in each. From |x| = `least`
/// on rational functions of x are off by more than `off`: Euler's factor 1 − x, Heun's
/// 1 − x + x²/2, and that of the midpoint rule, (1 − x/2)/(1 + x/2), which tends to −1. For γ < 0
/// the solution overflows in finite time; long before, a step is large for a body that turns so
/// fast.
fn damped(table: &mut Table, xs: &[f64], steps: u64, (least, off): (f64, f64)) -> Result<()> {
    for &x in xs {
        let problem = body(Constant::new(16.0 * x * steps as f64)?, 1.0 / 16.0)?;
        let fails = (if x.abs() < least { &[] } else { INEXACT }, off);
        table.add(&Setting { fails, ..Setting::of(x, &problem, steps) })?;
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

/// Increments past the contraction bound, not truncated, γ = ½cos 2t: 64 steps of τ = 0.1. While
/// the map contracts, for sure while max|kᵢ − kⱼ| < 1 with k = τ/I + ΔW/Î, there is one solution;
/// beyond, there may be several. A scheme keeps the law wherever its equation has a solution.
fn large_noise(table: &mut Table) -> Result<()> {
    for size in [0.1, 1.0, 10.0, 100.0] {
        let problem = body(half_cosine(), 6.4)?;
        let solved = if size > 0.1 { DIRECT } else { &BuiltIn::ALL };
        let deviation = Some(size);
        table.add(&Setting { deviation, solved, ..Setting::of(size, &problem, 64) })?;
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
        table.add(&Setting { invariant, allowed: 3.0, fails, ..setting })?;
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
            let inside = |y: &[f64]| y.iter().all(|y| *y > 0.0);
            table.add(&Setting { invariant: 1, allowed: 2.0, inside, ..setting })?;
        }
    }
    Ok(())
}
