//! How the distance from a conformal law grows over a long time.
//!
//! d_n = F(y_n)e^{pΓ(t_n)}/F(y₀) − 1 on independent paths, at powers of two of n. Errors of
//! rounding without a direction make a random walk, d_n ~ √n·ε; errors with one a drift, d_n ~ n·ε.
//! The exponent is the slope of ln RMS(d_n) over ln n, from n = 1024 on; its interval is the
//! percentile interval of the bootstrap over whole paths, which are independent of each other as
//! points of one path are not.
//!
//! With a settled solver the root mean square stays below 32ε√n, a walk of a step's worst
//! roundings. The default solver leaves a residual of up to 2ε in the same direction in every step,
//! a drift; one more sweep, `Solver::settled()`, removes it. `sexp-li`, `split` and `nv` solve
//! nothing by iteration and have no such option: 2, 2.2 and 3.8 times that bound, and an exponent
//! whose interval lies below 0.55.

use anyhow::{Context, Result};
use kernels::Tuned;
use mc::{Ladder, Run, Statistic, View, bind};
use noise::StreamKey;
use nonlin::{Method, Solver};
use real::{WIDTH, elementary};
use schemes::{BuiltIn, Scheme, Sexp, WithSolver};
use systems::{
    Constant, Damping, Linear, Problem,
    paper::{half_cosine, lotka_volterra_1_1, maxwell_bloch, rigid_body_three_noises, sine},
};
use verify::streams;

use crate::{
    SEED,
    bits::Bits,
    rounding::{LINEARLY_IMPLICIT, PER_STEP, rotations},
};

const STEPS: u64 = 10_000_000;
const QUICK_STEPS: u64 = 65_536;
/// The exponent is fitted from here on: before, a handful of roundings has not become a walk.
const FIRST: u64 = 1024;
/// Intervals of the exponents of the schemes without iteration lie below this. Before a million
/// steps the walk that all paths share, which intervals do not contain, is too large beside the
/// others to tell.
const MAX_EXPONENT: f64 = 0.55;
const TELLING: u64 = 1_000_000;
/// Paths of a run, and of one without iteration, whose exponent is held to a bound.
const PATHS: usize = WIDTH;
const MANY_PATHS: usize = 16 * WIDTH;
/// Samples of the bootstrap.
const RESAMPLES: usize = 2000;

/// A scheme under the name of a run.
#[derive(Clone, Copy)]
enum Rule {
    /// `sexp` with this solver.
    Sexp(&'static str, Solver),
    SexpLi,
    Split,
    Nv,
}

/// A system, and of Lotka–Volterra the number of the invariant; of the others the only Casimir.
#[derive(Clone, Copy)]
enum Followed {
    Body,
    Volterra(usize),
    Light,
}

/// A long run of one scheme: its name, damping, step, rule, and what is followed.
type LongRun<'a> = (&'static str, &'a dyn Damping, f64, Rule, Followed);

#[test]
fn roundings_make_a_random_walk() -> Result<()> {
    all(QUICK_STEPS)
}

#[test]
#[ignore = "ten million steps of some hundred paths: minutes"]
fn roundings_make_a_random_walk_over_ten_million_steps() -> Result<()> {
    all(STEPS)
}

/// All runs.
fn all(steps: u64) -> Result<()> {
    use Followed::{Body, Light, Volterra};
    let (none, sine, cosine) = (&Constant::new(0.0)?, &sine(), &half_cosine());
    let (weak, negative) = (&Constant::new(2e-5)?, &Constant::new(-2e-5)?);
    let linear = &Linear::new(1e-8)?;
    let default = Rule::Sexp("sexp", Solver::default());
    let settled = Rule::Sexp("sexp, settled", Solver::default().settled());
    let newton = Rule::Sexp("sexp-newton, settled", Solver::new(Method::Newton).settled());
    let (li, split) = (Rule::SexpLi, Rule::Split);
    // 1/100 is rounded, so that steps of a grid differ in their last bits; 1/128 is not, and a
    // constant γ gives the same factor in every step.
    let (rounded, dyadic) = (1.0 / 100.0, 1.0 / 128.0);
    // Maxwell–Bloch turns by an angle that grows like √t, and with it what a step rounds: steps are
    // so short that the angle stays small.
    let short = 1.0 / 1024.0;
    let runs: [LongRun<'_>; 21] = [
        ("default solver, undamped", none, dyadic, default, Body),
        ("undamped", none, dyadic, settled, Body),
        ("undamped, Newton", none, dyadic, newton, Body),
        ("constant γ", weak, dyadic, settled, Body),
        ("constant γ < 0", negative, dyadic, settled, Body),
        ("γ = 1e-8 t", linear, dyadic, settled, Body),
        ("γ = ½cos 2t", cosine, dyadic, settled, Body),
        ("γ = ½cos 2t, τ rounded", cosine, rounded, settled, Body),
        ("γ = sin t, τ = ¹⁄₁₀", sine, 0.1, settled, Body),
        ("Lotka–Volterra, H, undamped", none, dyadic, settled, Volterra(0)),
        ("Lotka–Volterra, H, γ = sin t", sine, rounded, settled, Volterra(0)),
        ("Lotka–Volterra, C, γ = sin t", sine, rounded, settled, Volterra(1)),
        ("sexp-li, undamped", none, dyadic, li, Body),
        ("sexp-li, constant γ", weak, dyadic, li, Body),
        ("sexp-li, γ = ½cos 2t", cosine, dyadic, li, Body),
        ("sexp-li, Maxwell–Bloch", none, short, li, Light),
        ("sexp-li, Maxwell–Bloch, γ = ½cos 2t", cosine, short, li, Light),
        ("split, undamped", none, dyadic, split, Body),
        ("split, γ = ½cos 2t", cosine, dyadic, split, Body),
        ("split, Maxwell–Bloch", none, short, split, Light),
        ("nv, γ = ½cos 2t", cosine, dyadic, Rule::Nv, Body),
    ];
    let growth = |(run, number): (LongRun<'_>, u64)| match run.4 {
        Body => growth(steps, number, run, &rigid_body_three_noises(1.0)),
        Volterra(_) => growth(steps, number, run, &lotka_volterra_1_1()),
        Light => growth(steps, number, run, &maxwell_bloch(1.0)),
    };
    runs.into_iter().zip(0..).try_for_each(growth)
}

/// The scheme, its name, and what a step of it rounds in units of [`PER_STEP`].
fn scheme<S: Tuned<D, M> + 'static, G, const D: usize, const M: usize>(
    rule: Rule,
    problem: &Problem<S, G, D>,
) -> Result<(Box<dyn Scheme<S, D, M>>, &'static str, f64)> {
    let compiled = |scheme| S::scheme(scheme, problem.system(), problem.y0());
    Ok(match rule {
        Rule::Sexp(name, solver) => (Box::new(WithSolver { formula: Sexp, solver }), name, 1.0),
        Rule::SexpLi => (compiled(BuiltIn::SexpLi)?, "sexp-li", LINEARLY_IMPLICIT),
        Rule::Split => (compiled(BuiltIn::Split)?, "split", rotations(5)),
        // Of the body with three noises.
        Rule::Nv => (compiled(BuiltIn::Nv)?, "nv", rotations(9)),
    })
}

fn growth<S: Tuned<D, M> + Copy + 'static, G, const D: usize, const M: usize>(
    steps: u64,
    number: u64,
    (id, damping, tau, rule, followed): LongRun<'_>,
    of: &Problem<S, G, D>,
) -> Result<()> {
    let key = StreamKey { seed: SEED, experiment: streams::GROWTH + number };
    let y0 = of.y0();
    let problem = Problem::new::<M>(*of.system(), damping, y0, steps as f64 * tau)?;
    let index = if let Followed::Volterra(index) = followed { index } else { 0 };
    let invariant = problem.system().invariants()[index];
    let value = |y| problem.system().invariant(index, y);
    let defect = |n: u64, y| {
        let damping = damping.integral(0.0, n as f64 * tau);
        value(y) / (value(y0) * elementary::exp(-invariant.degree * damping)) - 1.0
    };
    let (scheme, name, rounding) = scheme(rule, &problem)?;
    let runs = vec![Run::new(bind(&problem, scheme.as_ref()), 0)];
    let ladder =
        Ladder::new(&mc::Problem::of(&problem), steps, 0, verify::truncation(), key, runs)?;
    let new = || Defects::<_, D> { steps, defect: &defect, rows: Vec::new() };
    let paths = if let Rule::Sexp(..) = rule { PATHS } else { MANY_PATHS };
    let measured = ladder.run(paths as u64, new);
    let rows = measured.statistic.rows;
    let bits = &mut Bits::new(SEED, streams::GROWTH, number);
    let (exponent, lo, hi) = bootstrap(&rows, bits);
    let d = &rows.last().context("no steps")?.1;
    let (end, mean) = (rms(d.iter().copied()), d.iter().sum::<f64>() / paths as f64);
    println!(
        "{id:38} {name:22} {end:.2e} mean {mean:+.1e} exponent {exponent:.3} [{lo:.3}, {hi:.3}]"
    );
    // A walk whose steps are independent, each no larger than the worst case of a step; NaN is not.
    let walk = end <= rounding * PER_STEP * f64::EPSILON * (steps as f64).sqrt();
    match rule {
        Rule::SexpLi | Rule::Split | Rule::Nv => {
            assert!(walk && (steps < TELLING || hi <= MAX_EXPONENT), "{id}: {end:e}, {hi}");
        }
        Rule::Sexp(_, solver) if solver.settle => assert!(walk, "{id}: {end:e}"),
        // The twin: the stopping test leaves a residual that has a direction.
        Rule::Sexp(..) => assert!(lo > 0.5, "{id} does not drift: {lo}"),
    }
    Ok(())
}

/// d_n of every path for one n; NaN of a path that failed.
type Row = (u64, Vec<f64>);

/// d of every path at powers of two of n and at the end.
struct Defects<'a, F, const D: usize> {
    steps: u64,
    defect: &'a F,
    rows: Vec<Row>,
}

impl<F, const D: usize> Defects<'_, F, D> {
    fn add(&mut self, n: u64, d: impl IntoIterator<Item = f64>) {
        match self.rows.iter_mut().find(|row| row.0 == n) {
            Some(row) => row.1.extend(d),
            None => self.rows.push((n, d.into_iter().collect())),
        }
    }
}

impl<F: Fn(u64, [f64; D]) -> f64 + Sync, const D: usize> Statistic for Defects<'_, F, D> {
    fn observe(&mut self, view: &View<'_>) {
        let n = view.time;
        if n.is_power_of_two() || n == self.steps {
            let of_path = |p: usize| match view.live.contains(p) {
                true => (self.defect)(n, view.path(0, p)),
                false => f64::NAN,
            };
            self.add(n, (0..WIDTH).map(of_path));
        }
    }

    fn merge(&mut self, later: Self) {
        later.rows.into_iter().for_each(|(n, d)| self.add(n, d));
    }
}

fn rms(d: impl Iterator<Item = f64>) -> f64 {
    let (sum, paths) = d.fold((0.0, 0.0), |(sum, paths), d| (sum + d * d, paths + 1.0));
    (sum / paths).sqrt()
}

/// The exponent of the size of d, with the percentile interval of the bootstrap over paths.
fn bootstrap(rows: &[Row], bits: &mut Bits) -> (f64, f64, f64) {
    let paths = rows[0].1.len();
    let mut resampled =
        || (0..paths).map(|_| bits.below(paths as u64) as usize).collect::<Vec<_>>();
    let mut slopes: Vec<f64> = (0..RESAMPLES).map(|_| slope(rows, &resampled())).collect();
    slopes.sort_unstable_by(f64::total_cmp);
    let all = slope(rows, &(0..paths).collect::<Vec<_>>());
    (all, slopes[RESAMPLES / 40], slopes[RESAMPLES - 1 - RESAMPLES / 40])
}

/// The slope of the logarithm of the size over ln n by least squares, over the given paths.
fn slope(rows: &[Row], paths: &[usize]) -> f64 {
    let points: Vec<(f64, f64)> = rows
        .iter()
        .filter(|(n, _)| *n >= FIRST)
        .map(|(n, d)| ((*n as f64).ln(), rms(paths.iter().map(|&path| d[path])).ln()))
        .filter(|(_, y)| y.is_finite())
        .collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let sum = |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|p| f(p.0 - x, p.1 - y)).sum::<f64>();
    sum(&|x, y| x * y) / sum(&|x, _| x * x)
}
