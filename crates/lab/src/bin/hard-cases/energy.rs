//! What becomes of the energy over a million periods.
//!
//! State (q, p), H₀ = ½|p|² + V(q), H₁ = σq₁, γ = 0. The trace formula (Chen, Cohen, D'Ambrosio
//! and Lang 2020) gives E[H₀(t)] = E[H₀(0)] + ½σ²t for every V. So d = H₀(y_n) − H₀(y₀) − ½σ²t + Σ
//! σΔW p̂ has mean zero for the solution: p̂ is p in the middle of a step as far as it is known at its
//! start, so the sum is of mean zero for every scheme, and takes most of the variance away.

use anyhow::Result;
use lab::streams;
use noise::{BlockNoise, StreamKey, WienerBlock};
use nonlin::BlockStatus;
use rayon::prelude::*;
use real::{Block, PathMask, Real, WIDTH};
use schemes::{EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLi, Split, Step};
use systems::{Constant, Flows, ImplicitStep, PoissonSystem};

use crate::{
    Arguments,
    fuzz::Bits,
    growth::{Row, bootstrap},
    results::Energy,
    row::Verdict,
};

const PERIODS: u64 = 1_000_000;
const QUICK_PERIODS: u64 = 5000;
pub const PATHS: usize = 2 * WIDTH;
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
/// How far each component of a start is from that of the system.
const SPREAD: f64 = 0.02;

/// V, ∂V/∂q, and a discrete gradient of V; only the first halves of arguments and of gradients
/// count.
trait Potential<const D: usize>: Copy + Send + Sync + 'static {
    fn value<R: Real>(q: [R; D]) -> R;
    fn slope<R: Real>(q: [R; D]) -> [R; D];
    /// From m − d to m + d.
    fn mean<R: Real>(m: [R; D], d: [R; D]) -> [R; D];
}

/// ½|p|² + V(q) with the noise σq₁.
#[derive(Clone, Copy)]
struct Canonical<V>(V, f64);

impl<V> Canonical<V> {
    /// ∇h with the slope of V.
    #[inline(always)]
    fn with<R: Real, const D: usize>(
        &self,
        mut slope: [R; D],
        y: [R; D],
        dt: f64,
        dw: f64,
    ) -> [R; D] {
        for i in 0..D {
            slope[i] = if i < D / 2 { slope[i] * dt } else { y[i] * dt };
        }
        slope[0] = slope[0] + self.1 * dw;
        slope
    }
}

impl<V: Potential<D>, const D: usize> PoissonSystem<D, 1> for Canonical<V> {
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
        (kinetic + V::value(y)) * dt + y[0] * (self.1 * dw[0])
    }

    #[inline(always)]
    fn gradient<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; 1]) -> [R; D] {
        self.with(V::slope(y), y, dt, dw[0])
    }

    #[inline(always)]
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; 1]) -> [R; D] {
        let (mut m, mut d) = (a, b);
        for i in 0..D {
            (m[i], d[i]) = ((a[i] + b[i]) * 0.5, (b[i] - a[i]) * 0.5);
        }
        self.with(V::mean(m, d), m, dt, dw[0])
    }

    const IMPLICIT_STEP: ImplicitStep = ImplicitStep::UnrolledFixedPoint;
}

/// ½|p|², then V with the noise.
impl<V: Potential<D>, const D: usize> Flows<D, 1> for Canonical<V> {
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

macro_rules! potentials {
    ($($name:ident $d:literal $q:ident: $value:expr, $slope:expr, $m:ident $c:ident: $mean:expr;)+) => {$(
        #[derive(Clone, Copy)]
        struct $name;
        impl Potential<$d> for $name {
            #[inline(always)]
            fn value<R: Real>($q: [R; $d]) -> R {
                $value
            }
            #[inline(always)]
            fn slope<R: Real>($q: [R; $d]) -> [R; $d] {
                $slope
            }
            #[inline(always)]
            fn mean<R: Real>($m: [R; $d], $c: [R; $d]) -> [R; $d] {
                $mean
            }
        }
    )+};
}

potentials! {
    Spring 2 q: q[0] * q[0] * 0.5, q, m _d: m;
    Sine 2 q: -q[0].cos(), [q[0].sin(), q[1]], m d: [m[0].sin() * d[0].sinc(), m[1]];
    // LaBudde and Greenspan (1976): V(b) − V(a) is the mean slope times b − a, in closed form.
    Kepler 4 q: -root(q).recip(), {
        let r = root(q);
        along(q, r * r * r)
    }, m d: {
        let mut ends = [m, m];
        for i in 0..2 {
            (ends[0][i], ends[1][i]) = (m[i] - d[i], m[i] + d[i]);
        }
        let [a, b] = ends.map(root);
        along(m, a * b * (a + b) * 0.5)
    };
    HenonHeiles 4 q:
        (q[0] * q[0] + q[1] * q[1]) * 0.5 + (q[0] * q[0] - q[1] * q[1] * (1.0 / 3.0)) * q[1],
        henon_heiles(q, [R::zero(); 4]), m d: henon_heiles(m, d);
    Toda 6 q: { let [a, b, c] = bonds(q).map(R::exp); a + b + c }, toda(q, [R::zero(); 6]),
        m d: toda(m, d);
}

/// (|q|² + ¼)^½.
#[inline(always)]
fn root<R: Real>(q: [R; 4]) -> R {
    (q[0] * q[0] + q[1] * q[1] + 0.25).sqrt()
}

#[inline(always)]
fn along<R: Real>(q: [R; 4], divisor: R) -> [R; 4] {
    let factor = divisor.recip();
    [q[0] * factor, q[1] * factor, q[2], q[3]]
}

/// The mean of ab over a segment is that in the middle and a third of that of the halves.
#[inline(always)]
fn henon_heiles<R: Real>(m: [R; 4], d: [R; 4]) -> [R; 4] {
    let mean = |i: usize, k: usize| m[i] * m[k] + d[i] * d[k] * (1.0 / 3.0);
    [m[0] + mean(0, 1) * 2.0, m[1] + mean(0, 0) - mean(1, 1), m[2], m[3]]
}

#[inline(always)]
fn bonds<R: Real>(q: [R; 6]) -> [R; 3] {
    [q[0] - q[1], q[1] - q[2], q[2] - q[0]]
}

/// The mean of eˣ is that in the middle times sinh(d)/d, to rounding for |d| < ½.
#[inline(always)]
fn toda<R: Real>(m: [R; 6], d: [R; 6]) -> [R; 6] {
    let (middle, half) = (bonds(m), bonds(d));
    let mut mean = middle;
    for i in 0..3 {
        let x = half[i] * half[i];
        let series = [156.0, 110.0, 72.0, 42.0, 20.0, 6.0];
        let sinhc = series.iter().fold(R::one(), |sum, c| sum * x * (1.0 / c) + 1.0);
        mean[i] = middle[i].exp() * sinhc;
    }
    [mean[0] - mean[2], mean[1] - mean[0], mean[2] - mean[1], m[3], m[4], m[5]]
}

/// All systems, with a period and the number of steps in it, a start, and what the noise adds to
/// E[H₀] in all steps.
pub fn run(arguments: &Arguments) -> Result<Vec<Energy>> {
    let near_circle = [1.0, 0.0, 0.0, 0.85];
    let bound = [0.2, 0.1, 0.1, 0.25];
    let apart = [0.5, 0.0, -0.5, 0.0, 0.5, -0.5];
    let all = [
        energies(arguments, 0, Canonical(Spring, 0.1), (6.2832, 12), [1.0, 0.0])?,
        energies(arguments, 1, Canonical(Sine, 0.05), (6.7, 12), [1.0, 0.0])?,
        energies(arguments, 2, Canonical(Kepler, 0.005), (7.43, 12), near_circle)?,
        energies(arguments, 3, Canonical(HenonHeiles, 0.002), (6.2832, 12), bound)?,
        energies(arguments, 4, Canonical(Toda, 0.05), (3.6276, 8), apart)?,
    ];
    Ok(all.into_iter().flatten().collect())
}

pub const SYSTEMS: [&str; 5] = [
    "oscillator, V = ½q²",
    "pendulum, V = −cos q",
    "Kepler, softened, V = −(|q|² + ¼)^(−½)",
    "Hénon–Heiles",
    "Toda ring of three, V = Σ exp(qᵢ − qᵢ₊₁)",
];

/// A scheme with its name, and whether E[H₀] stays near its truth.
type Named<S, const D: usize> = (Box<dyn Scheme<S, D, 1>>, &'static str, bool);

fn energies<V: Potential<D>, const D: usize>(
    arguments: &Arguments,
    number: u64,
    Canonical(potential, added): Canonical<V>,
    (period, per_period): (f64, u64),
    y0: [f64; D],
) -> Result<Vec<Energy>> {
    eprintln!("{}", SYSTEMS[number as usize]);
    let (steps, tau) =
        (arguments.many(PERIODS, QUICK_PERIODS) * per_period, period / per_period as f64);
    let rate = added / (steps as f64 * tau);
    let system = Canonical(potential, (2.0 * rate).sqrt());
    let schemes: [Named<Canonical<V>, D>; 8] = [
        (Box::new(Sexp), "sexp", true),
        (Box::new(Midpoint), "midpoint", true),
        (Box::new(Split), "split", true),
        (Box::new(Nv::of_parts()), "nv", true),
        (Box::new(Nv::new(&system, y0)?), "nv, stages", false),
        (Box::new(SexpLi::new(&system, y0)?), "sexp-li", false),
        (Box::new(Heun), "heun", false),
        (Box::new(EulerMaruyama), "em", false),
    ];
    let key = StreamKey { seed: arguments.seed, experiment: streams::ENERGY + number };
    let starts: Vec<usize> = (0..PATHS).step_by(WIDTH).collect();
    let march = |&first: &usize| march(&system, &schemes, key, (steps, tau), rate, (y0, first));
    let blocks: Vec<Vec<Vec<Row>>> = starts.par_iter().map(march).collect::<Result<_>>()?;
    let energy = |(n, (_, scheme, keeps)): (usize, &Named<Canonical<V>, D>)| {
        let mut rows = blocks[0][n].clone();
        for block in &blocks[1..] {
            rows.iter_mut().zip(&block[n]).for_each(|(row, more)| row.1.extend(&more.1));
        }
        let mean = |d: &[f64]| d.iter().sum::<f64>() / PATHS as f64;
        let (last, early) = (&rows[rows.len() - 1], &rows[rows.len() - 1 - EARLIER]);
        let grown = rate * tau * 0.75 * (last.0 - early.0) as f64;
        let change: Vec<f64> =
            last.1.iter().zip(&early.1).map(|(last, early)| (last - early) / grown).collect();
        let drift = mean(&change);
        let squares: f64 = change.iter().map(|change| (change - drift).powi(2)).sum();
        let error = (squares / (PATHS * (PATHS - 1)) as f64).sqrt();
        let failed = last.1.iter().filter(|d| !d.is_finite()).count();
        let end = mean(&last.1);
        let drifts = drift.abs() > ALLOWED + STANDARD_ERRORS * error || end.abs() > NEAR;
        let outcome = match drifts {
            _ if failed > 0 => "fails",
            false => "bounded",
            true => "drifts",
        };
        let (exponent, lo, hi) =
            bootstrap(&rows, &mut Bits::new(arguments.seed, key.experiment, n as u64), |d| {
                (d.sum::<f64>() / PATHS as f64).abs()
            });
        let verdict = match (*keeps, outcome == "bounded") {
            (true, true) => Verdict::Holds,
            (false, false) => Verdict::FailsAsItMust,
            _ => Verdict::Refuted,
        };
        let system = SYSTEMS[number as usize];
        Energy {
            system,
            scheme,
            steps,
            end,
            drift,
            error,
            exponent,
            lo,
            hi,
            failed,
            outcome,
            verdict,
        }
    };
    Ok(schemes.iter().enumerate().map(energy).collect())
}

/// The means of d over windows for every scheme, of the paths of a block.
fn march<V: Potential<D>, const D: usize>(
    system: &Canonical<V>,
    schemes: &[Named<Canonical<V>, D>],
    key: StreamKey,
    (steps, tau): (u64, f64),
    rate: f64,
    (y0, first): ([f64; D], usize),
) -> Result<Vec<Vec<Row>>> {
    let mut start = Block::splat(y0);
    for p in 0..WIDTH {
        let mut bits = Bits::new(key.seed, key.experiment, (first + p) as u64);
        let mut any = || SPREAD * (bits.below(2001) as f64 / 1000.0 - 1.0);
        start.set_path(p, y0.map(|y| y + any()));
    }
    let step = Step::new(&Constant::new(0.0)?, 0, tau)?;
    let mut noise = WienerBlock::<1>::new(key, first as u64);
    let mut drawn = BlockNoise::increments(Block::splat([0.0]));
    // State, the sum of mean zero, p and σΔW of the step before, paths that have not failed.
    let new = || (start, [0.0; WIDTH], start.0[D / 2], PathMask::first(WIDTH), Vec::<Row>::new());
    let mut runs: Vec<_> = schemes.iter().map(|_| new()).collect();
    let mut before = [0.0; WIDTH];
    let mut status = BlockStatus::explicit();
    let energy = |y| system.energy::<f64>(y, 1.0, [0.0]);
    let (mut window, mut end) = (WINDOWS, 0);
    for n in 1..=steps {
        noise.increments(tau.sqrt(), &mut drawn.increments);
        let kick = drawn.increments.0[0].map(|dw| system.1 * dw);
        while n > end {
            window -= 1;
            end = steps >> window;
        }
        let stride = (end / 2 / SAMPLES) | 1;
        let due = n > end / 2 && (end - n).is_multiple_of(stride);
        for ((scheme, ..), (y, sum, last, live, rows)) in schemes.iter().zip(&mut runs) {
            if !live.is_empty() {
                let p = y.0[D / 2];
                for i in 0..WIDTH {
                    sum[i] += kick[i] * (p[i] + 0.5 * (p[i] - last[i] + before[i]));
                }
                *last = p;
                scheme.step_block(system, &step, &drawn, y, &mut status);
                for p in status.failed.and(*live).paths() {
                    y.set_path(p, start.path(p));
                    *live = live.without(one(p));
                }
            }
            if due {
                if rows.last().is_none_or(|row| row.0 != end) {
                    rows.push((end, vec![0.0; WIDTH]));
                }
                let count = (end - end / 2).div_ceil(stride) as f64;
                let grown = rate * tau * n as f64;
                for (p, d) in
                    rows.last_mut().into_iter().flat_map(|row| row.1.iter_mut().enumerate())
                {
                    let defect = energy(y.path(p)) - energy(start.path(p)) - grown + sum[p];
                    *d += if live.contains(p) { defect / count } else { f64::NAN };
                    if !d.is_finite() {
                        y.set_path(p, start.path(p));
                        *live = live.without(one(p));
                    }
                }
            }
        }
        before = kick;
    }
    Ok(runs.into_iter().map(|run| run.4).collect())
}

fn one(p: usize) -> PathMask {
    let mut mask = PathMask::NONE;
    mask.insert(p);
    mask
}
