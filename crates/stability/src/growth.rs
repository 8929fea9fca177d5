//! How the distance from a conformal law grows over a long time.
//!
//! d_n = F(y_n)e^{pΓ(t_n)}/F(y₀) − 1 on blocks of 32 independent paths, at powers of two of n.
//! Errors of rounding without a direction make a random walk, d_n ~ √n·ε; errors with one a drift,
//! d_n ~ n·ε. The exponent is the slope of ln RMS(d_n) over ln n, from n = 1024 on; its interval is
//! the percentile interval of the bootstrap over whole paths, which are independent of each other
//! as points of one path are not.

use noise::{StreamKey, Truncation, WienerBlock, clip};
use nonlin::{BlockStatus, Method, Solver};
use real::{Block, WIDTH, elementary};
use schemes::{Scheme, Sexp, Step};
use systems::{
    Constant, Cosine, Damping, IntegerExponents, Linear, LotkaVolterra, PoissonSystem, RigidBody,
    Sine,
};

use crate::cases::{INERTIA, NOISE_INERTIA, body_start, valid};
use crate::fuzz::Bits;
use crate::results::{Growth, GrowthPoint, Verdict};
use crate::{Effort, Settings};

/// Steps of a full run: 10⁷.
const STEPS: u64 = 10_000_000;
const QUICK_STEPS: u64 = 65_536;
/// Blocks of 32 independent paths.
const BLOCKS: u64 = 1;
/// The exponent is fitted from here on: before, a handful of roundings has not become a walk.
const FIRST: u64 = 1024;
/// Samples of the bootstrap.
const RESAMPLES: usize = 2000;
/// Experiments of long runs count from here.
const FIRST_EXPERIMENT: u64 = (1 << 33) + (1 << 16);

/// A long run.
struct Run<'a, S, const D: usize> {
    id: &'static str,
    setup: String,
    system: S,
    damping: &'a dyn Damping,
    y0: [f64; D],
    tau: f64,
    scheme: Sexp,
    /// Number of the invariant.
    invariant: usize,
}

/// Runs the long runs. `begin` is told the name of each.
#[must_use]
pub fn run_growth(settings: Settings, begin: &dyn Fn(&str)) -> Vec<Growth> {
    let body = || valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    let lotka_volterra = || valid(LotkaVolterra::<IntegerExponents<1, 1>>::integer(1.0));
    let (none, slow, pumped) =
        (valid(Constant::new(0.0)), valid(Constant::new(2e-5)), valid(Constant::new(-2e-5)));
    let (linear, cosine, sine) =
        (valid(Linear::new(1e-8)), valid(Cosine::new(0.5, 2.0)), valid(Sine::new(1.0, 1.0)));
    let plain = Sexp::default();
    let fixed = Sexp { solver: plain.solver.settled() };
    let newton = Sexp { solver: Solver::new(Method::Newton).settled() };
    // 1/100 is rounded, so that steps of a grid differ in their last bits; 1/128 is not, and a
    // constant γ gives the same factor in every step.
    let (rounded, dyadic) = (1.0 / 100.0, 1.0 / 128.0);
    let of_body = |id, damping, tau, scheme: &Sexp| Run {
        id,
        setup: String::new(),
        system: body(),
        damping,
        y0: body_start(),
        tau,
        scheme: *scheme,
        invariant: 0,
    };
    let bodies = [
        of_body("default solver, undamped", &none as &dyn Damping, dyadic, &plain),
        of_body("undamped", &none, dyadic, &fixed),
        of_body("undamped, Newton", &none, dyadic, &newton),
        of_body("constant γ", &slow, dyadic, &fixed),
        of_body("constant γ < 0", &pumped, dyadic, &fixed),
        of_body("γ = 1e-8 t", &linear, dyadic, &fixed),
        of_body("γ = ½cos 2t", &cosine, dyadic, &fixed),
        of_body("γ = ½cos 2t, τ rounded", &cosine, rounded, &fixed),
        of_body("γ = sin t, τ = ¹⁄₁₀", &sine, 0.1, &fixed),
    ];
    let energy = |id, damping, tau, invariant| Run {
        id,
        setup: String::new(),
        system: lotka_volterra(),
        damping,
        y0: [0.2, 0.4, 0.6],
        tau,
        scheme: fixed,
        invariant,
    };
    let volterras = [
        energy("Lotka–Volterra, H, undamped", &none as &dyn Damping, dyadic, 0),
        energy("Lotka–Volterra, H, γ = sin t", &sine, rounded, 0),
        energy("Lotka–Volterra, C, γ = sin t", &sine, rounded, 1),
    ];
    let mut growths = Vec::new();
    let mut number = 0;
    for mut run in bodies {
        run.setup =
            format!("Rigid body with three noises, {}, τ = {}.", run.damping.describe(), run.tau);
        begin(run.id);
        growths.push(growth::<_, 3, 3>(settings, number, &run));
        number += 1;
    }
    for mut run in volterras {
        run.setup =
            format!("Lotka–Volterra with a = b = −1, {}, τ = {}.", run.damping.describe(), run.tau);
        begin(run.id);
        growths.push(growth::<_, 3, 1>(settings, number, &run));
        number += 1;
    }
    growths
}

/// d of every path at every time.
struct Defects {
    times: Vec<u64>,
    of_path: Vec<Vec<f64>>,
}

fn growth<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    settings: Settings,
    number: u64,
    run: &Run<'_, S, D>,
) -> Growth {
    let steps = match settings.effort {
        Effort::Full => STEPS,
        Effort::Quick => QUICK_STEPS,
    };
    let key = StreamKey { seed: settings.seed, experiment: FIRST_EXPERIMENT + number };
    let defects = defects::<S, D, M>(run, steps, key);
    let paths = defects.of_path.len();
    let points: Vec<GrowthPoint> = (0..defects.times.len())
        .map(|k| {
            let d = defects.of_path.iter().map(|path| path[k]);
            GrowthPoint {
                steps: defects.times[k],
                rms: (d.clone().map(|d| d * d).sum::<f64>() / paths as f64).sqrt(),
                mean: d.clone().sum::<f64>() / paths as f64,
                max: d.map(f64::abs).fold(0.0, f64::max),
            }
        })
        .collect();
    let all: Vec<usize> = (0..paths).collect();
    let exponent = slope(&defects, &all);
    let mut bits = Bits::new(settings.seed, FIRST_EXPERIMENT, number);
    let mut slopes: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let sample: Vec<usize> =
                (0..paths).map(|_| bits.below(paths as u64) as usize).collect();
            slope(&defects, &sample)
        })
        .collect();
    slopes.sort_unstable_by(f64::total_cmp);
    let (lo, hi) = (slopes[RESAMPLES / 40], slopes[RESAMPLES - 1 - RESAMPLES / 40]);
    let end = points.last().map_or(f64::NAN, |point| point.rms);
    let settled = run.scheme.solver.settle;
    let walk = end <= WALK * f64::EPSILON * (steps as f64).sqrt();
    let verdict = match (settled, walk) {
        (true, true) => Verdict::Holds,
        // NaN is no walk.
        (true, false) => Verdict::Refuted,
        // The stopping test leaves a residual that has a direction: a drift is expected, and no
        // bound is stated.
        (false, _) if lo > 0.5 => Verdict::FailsAsItMust,
        (false, _) => Verdict::Observed,
    };
    Growth {
        id: run.id.to_owned(),
        setup: run.setup.clone(),
        scheme: match run.scheme.solver.method {
            Some(Method::Newton) => "sexp-newton, settled".to_owned(),
            _ if settled => "sexp, settled".to_owned(),
            _ => "sexp".to_owned(),
        },
        invariant: run.system.invariants()[run.invariant].name.to_owned(),
        paths,
        points,
        exponent,
        lo,
        hi,
        linear: steps as f64 * f64::EPSILON,
        verdict,
    }
}

/// Units of ε√n that a walk may have: steps whose roundings are independent, each no larger than
/// the worst case of a step, 32ε.
const WALK: f64 = 32.0;

fn defects<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    run: &Run<'_, S, D>,
    steps: u64,
    key: StreamKey,
) -> Defects {
    let bound = Truncation::new(4)
        .ok()
        .and_then(|truncation| truncation.bound(run.tau).ok())
        .unwrap_or(f64::INFINITY);
    let mut noises: Vec<WienerBlock<M>> =
        (0..BLOCKS).map(|b| WienerBlock::new(key, b * WIDTH as u64)).collect();
    let mut states = vec![Block::splat(run.y0); BLOCKS as usize];
    let mut defects =
        Defects { times: Vec::new(), of_path: vec![Vec::new(); (BLOCKS as usize) * WIDTH] };
    let (mut drawn, mut dw) = (Block::zero(), Block::zero());
    let degree = run.system.invariants()[run.invariant].degree;
    let start: f64 = run.system.invariant(run.invariant, run.y0);
    for n in 1..=steps {
        let Ok(step) = Step::new(run.damping, n - 1, run.tau) else { continue };
        for (noise, y) in noises.iter_mut().zip(&mut states) {
            noise.increments(run.tau.sqrt(), &mut drawn);
            clip(&drawn, bound, &mut dw);
            let mut status = BlockStatus::explicit();
            run.scheme.step_block(&run.system, &step, &dw, y, &mut status);
        }
        if n.is_power_of_two() || n == steps {
            defects.times.push(n);
            let law =
                start * elementary::exp(-degree * run.damping.integral(0.0, n as f64 * run.tau));
            for (path, of_path) in defects.of_path.iter_mut().enumerate() {
                let value: f64 =
                    run.system.invariant(run.invariant, states[path / WIDTH].path(path % WIDTH));
                of_path.push(value / law - 1.0);
            }
        }
    }
    defects
}

/// The slope of ln RMS over ln n by least squares, over the given paths.
fn slope(defects: &Defects, paths: &[usize]) -> f64 {
    let points =
        defects.times.iter().enumerate().filter(|(_, n)| **n >= FIRST).filter_map(|(k, &n)| {
            let square = paths.iter().map(|&path| defects.of_path[path][k].powi(2)).sum::<f64>()
                / paths.len() as f64;
            (square > 0.0).then(|| ((n as f64).ln(), 0.5 * square.ln()))
        });
    let points: Vec<(f64, f64)> = points.collect();
    let count = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / count, y + p.1 / count));
    let (xy, xx) = points
        .iter()
        .fold((0.0, 0.0), |(xy, xx), p| (xy + (p.0 - x) * (p.1 - y), xx + (p.0 - x).powi(2)));
    xy / xx
}
