//! What becomes of the energy over a million periods.
//!
//! State (q, p), H₀ = ½|p|² + V(q), H₁ = σq₁, γ = 0. The trace formula (Chen, Cohen, D'Ambrosio and
//! Lang 2020) gives E[H₀(t)] = E[H₀(0)] + ½σ²t for every V. So d = H₀(y_n) − H₀(y₀) − ½σ²t + Σ σΔW
//! p̂ has mean zero for the solution: p̂ is p in the middle of a step as far as it is known at its
//! start, so the sum is of mean zero for every scheme, and takes most of the variance away.
//!
//! V is ½q², −cos q, and −(|q|² + ¼)^(−½) in the plane; the noise is so weak that paths stay bound.
//! `sexp`, `midpoint`, and `split` and `nv` by exact flows are bounded; the explicit methods must
//! drift or fail: `heun`, `em`, `sexp-li` for constant B.

use std::f64::consts::TAU;

use anyhow::Result;
use noise::{StepNoise, StreamKey, WienerRows};
use nonlin::BlockStatus;
use rayon::prelude::*;
use real::{Block, Real, WIDTH};
use schemes::{EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLi, Split, Step};
use stats::CrossMoments;
use systems::{Constant, Flows, ImplicitStep, PoissonSystem};
use verify::streams;

use crate::{
    SEED,
    bits::Bits,
    growth::{Row, Values, bootstrap},
};

const PERIODS: u64 = 1_000_000;
const QUICK_PERIODS: u64 = 5000;
const PATHS: usize = 2 * WIDTH;
/// The steps of a window, between n/2 and n for dyadic fractions n of all steps, of which so many
/// are looked at, or one more.
const SAMPLES: u64 = 61;
const WINDOWS: u32 = 14;
/// A drift is the change of d from a window to the one of 16 times the time. Beyond this share of
/// what the noise adds meanwhile, and four standard errors, it is one.
const EARLIER: usize = 4;
const ALLOWED: f64 = 0.2;
const STANDARD_ERRORS: f64 = 4.0;
/// And |d| is at most this: no energy here is far from one.
const NEAR: f64 = 0.05;
/// V.
const SPRING: usize = 0;
const SINE: usize = 1;
const KEPLER: usize = 2;
/// Steps of a period.
const PER_PERIOD: u64 = 12;

/// ½|p|² + V(q) with the noise σq₁.
#[derive(Clone, Copy)]
struct Canonical<const V: usize> {
    sigma: f64,
}

impl<const V: usize> Canonical<V> {
    /// ∇̄h from m − d to m + d, ∇h in m for d = 0.
    #[inline(always)]
    fn mean<R: Real, const D: usize>(&self, m: [R; D], d: [R; D], dt: f64, dw: f64) -> [R; D] {
        let mut mean = m;
        match V {
            SPRING => {}
            SINE => mean[0] = m[0].sin() * d[0].sinc(),
            // LaBudde and Greenspan (1976): V(b) − V(a) is the mean slope times b − a, in closed
            // form.
            _ => {
                let a = root([m[0] - d[0], m[1] - d[1]]);
                let b = root([m[0] + d[0], m[1] + d[1]]);
                let factor = (a * b * (a + b) * 0.5).recip();
                (mean[0], mean[1]) = (m[0] * factor, m[1] * factor);
            }
        }
        let mut mean = mean.map(|slope| slope * dt);
        mean[0] = mean[0] + self.sigma * dw;
        mean
    }
}

impl<const V: usize, const D: usize> PoissonSystem<D, 1> for Canonical<V> {
    fn name(&self) -> &'static str {
        "canonical"
    }

    #[inline(always)]
    fn structure<R: Real>(&self, _: [R; D], v: [R; D]) -> [R; D] {
        let mut field = v;
        for i in 0..D / 2 {
            (field[i], field[i + D / 2]) = (v[i + D / 2], -v[i]);
        }
        field
    }

    #[inline(always)]
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 1]) -> R {
        let kinetic = (D / 2..D).fold(R::zero(), |sum, i| sum + y[i] * y[i] * 0.5);
        let potential = match V {
            SPRING => y[0] * y[0] * 0.5,
            SINE => -y[0].cos(),
            _ => -root(y).recip(),
        };
        (kinetic + potential) * dt + y[0] * (self.sigma * dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 1]) -> [R; D] {
        self.mean(y, [R::zero(); D], dt, dw[0])
    }

    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; 1]) -> [R; D] {
        let (mut m, mut d) = (a, b);
        for i in 0..D {
            (m[i], d[i]) = ((a[i] + b[i]) * 0.5, (b[i] - a[i]) * 0.5);
        }
        self.mean(m, d, dt, dw[0])
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
}

/// ½|p|², then V with the noise.
impl<const V: usize, const D: usize> Flows<D, 1> for Canonical<V> {
    const PARTS: usize = 2;
    const NOISE_PARTS: [Option<usize>; 1] = [Some(1)];

    #[inline(always)]
    fn flow(&self, part: usize, mut y: [f64; D], dt: f64, dw: [f64; 1]) -> [f64; D] {
        let slope = self.gradient(y, dt, dw);
        for i in 0..D / 2 {
            match part {
                0 => y[i] += dt * y[i + D / 2],
                _ => y[i + D / 2] -= slope[i],
            }
        }
        y
    }

    #[inline(always)]
    fn precise_flow(&self, part: usize, y: [f64; D], dt: f64, dw: [f64; 1]) -> [f64; D] {
        self.flow(part, y, dt, dw)
    }
}

/// (|q|² + ¼)^½.
#[inline(always)]
fn root<R: Real, const D: usize>(q: [R; D]) -> R {
    (q[0] * q[0] + q[1] * q[1] + 0.25).sqrt()
}

#[test]
fn energies_stay_near_the_truth() -> Result<()> {
    all(QUICK_PERIODS)
}

#[test]
#[ignore = "a million periods: many minutes"]
fn energies_stay_near_the_truth_over_a_million_periods() -> Result<()> {
    all(PERIODS)
}

/// All systems, with what the noise adds to E[H₀] in all steps, a period, and a start.
fn all(periods: u64) -> Result<()> {
    energies::<SPRING, 2>(periods, "oscillator", 0.1, TAU, [1.0, 0.0])?;
    energies::<SINE, 2>(periods, "pendulum", 0.05, 6.7, [1.0, 0.0])?;
    // Nearly a circle.
    energies::<KEPLER, 4>(periods, "Kepler", 0.005, 7.43, [1.0, 0.0, 0.0, 0.85])
}

type Schemes<S, const D: usize> = [(&'static str, Box<dyn Scheme<S, D, 1>>); 7];
/// So many of them, the first, stay near the truth.
const NEAR_IT: usize = 4;

fn energies<const V: usize, const D: usize>(
    periods: u64,
    name: &str,
    added: f64,
    period: f64,
    y0: [f64; D],
) -> Result<()> {
    let steps = periods * PER_PERIOD;
    let tau = period / PER_PERIOD as f64;
    let rate = added / (steps as f64 * tau);
    let system = Canonical::<V> { sigma: (2.0 * rate).sqrt() };
    let schemes: Schemes<_, D> = [
        ("sexp", Box::new(Sexp)),
        ("midpoint", Box::new(Midpoint)),
        ("split", Box::new(Split)),
        ("nv", Box::new(Nv::default())),
        ("sexp-li", Box::new(SexpLi::new(&system, y0)?)),
        ("heun", Box::new(Heun)),
        ("em", Box::new(EulerMaruyama)),
    ];
    let experiment = streams::ENERGY + u64::from(name.as_bytes()[0]);
    let key = StreamKey { seed: SEED, experiment };
    let blocks: Vec<Vec<Vec<Row>>> = (0..PATHS / WIDTH)
        .into_par_iter()
        .map(|block| march(&system, &schemes, key, (steps, tau), (rate, y0, block * WIDTH)))
        .collect::<Result<_>>()?;
    for (n, (scheme, _)) in schemes.iter().enumerate() {
        let mut rows = blocks[0][n].clone();
        for block in &blocks[1..] {
            rows.iter_mut().zip(&block[n]).for_each(|(row, more)| row.1.extend(&more.1));
        }
        let [early, .., last] = &rows[rows.len() - 1 - EARLIER..] else { unreachable!() };
        let grown = rate * tau * 0.75 * (last.0 - early.0) as f64;
        let mut change = CrossMoments::new(1);
        last.1.iter().zip(&early.1).for_each(|(last, early)| change.add(&[(last - early) / grown]));
        let mean = |d: Values<'_>| d.sum::<f64>() / PATHS as f64;
        let (end, drift) = (mean(&mut last.1.iter().copied()), change.mean(0));
        let error = change.standard_error(0);
        let failed = last.1.iter().filter(|d| !d.is_finite()).count();
        let drifts = drift.abs() > ALLOWED + STANDARD_ERRORS * error || end.abs() > NEAR;
        let outcome = if failed > 0 { "fails" } else { ["bounded", "drifts"][usize::from(drifts)] };
        let bits = &mut Bits::new(SEED, experiment, n as u64);
        let (a, lo, hi) = bootstrap(&rows, bits, |d| mean(d).abs());
        let words = format!(
            "{name:12} {scheme:10} d {end:+.1e} drift {drift:+.2e} ± {error:.0e} exponent {a:.2} \
             [{lo:.2}, {hi:.2}] failed {failed}: {outcome}"
        );
        println!("{words}");
        // The explicit methods are the twins.
        assert_eq!(n < NEAR_IT, outcome == "bounded", "{words}");
    }
    Ok(())
}

/// The means of d over windows for every scheme, of a block of paths.
fn march<const V: usize, const D: usize>(
    system: &Canonical<V>,
    schemes: &Schemes<Canonical<V>, D>,
    key: StreamKey,
    (steps, tau): (u64, f64),
    (rate, y0, first): (f64, [f64; D], usize),
) -> Result<Vec<Vec<Row>>> {
    let start = Block::splat(y0);
    let step = Step::new(&Constant::new(0.0)?, 0, tau)?;
    let mut noise = WienerRows::new(key, first as u64);
    let mut drawn = StepNoise::zero(1);
    // State, the sum of mean zero, p before, windows, whether a path has not failed.
    let new = |_| (start, [0.0; WIDTH], start.0[D / 2], Vec::<Row>::new(), true);
    let mut runs: Vec<_> = schemes.iter().map(new).collect();
    let (mut before, mut status) = ([0.0; WIDTH], BlockStatus::explicit());
    let energy = |y| system.energy::<f64>(y, 1.0, [0.0]);
    let (mut window, mut end) = (WINDOWS, 0);
    for n in 1..=steps {
        noise.increments(tau.sqrt(), &mut drawn.increments);
        let kick = drawn.increments[0].map(|dw| system.sigma * dw);
        while n > end {
            window -= 1;
            end = steps >> window;
        }
        let stride = (end / 2 / SAMPLES) | 1;
        let count = (end - end / 2).div_ceil(stride) as f64;
        for ((_, scheme), (y, sum, last, rows, alive)) in schemes.iter().zip(&mut runs) {
            if *alive {
                let p = y.0[D / 2];
                for i in 0..WIDTH {
                    sum[i] += kick[i] * (p[i] + 0.5 * (p[i] - last[i] + before[i]));
                }
                *last = p;
                scheme.step_block(system, &step, &(&drawn).into(), y, &mut status);
                for p in status.failed.paths() {
                    sum[p] = f64::NAN;
                    y.set_path(p, y0);
                }
            }
            if n <= end / 2 || !(end - n).is_multiple_of(stride) {
                continue;
            }
            if rows.last().is_none_or(|row| row.0 != end) {
                rows.push((end, vec![0.0; WIDTH]));
            }
            let grown = energy(y0) + rate * tau * n as f64;
            let d = &mut rows.last_mut().expect("a window").1;
            for p in 0..WIDTH {
                d[p] += (energy(y.path(p)) - grown + sum[p]) / count;
            }
            *alive = d.iter().any(|d| d.is_finite());
        }
        before = kick;
    }
    Ok(runs.into_iter().map(|run| run.3).collect())
}
