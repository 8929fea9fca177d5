//! Energies of `split` on systems from texts over long times, without noise.
//!
//! A composition of flows keeps a modified energy up to errors beyond all powers of τ (Benettin and
//! Giorgilli, *J. Stat. Phys.* 74, 1994): the error of H₀ is as large after 10⁶ periods as after a
//! few. Heun's scheme adds to it in every step. The root mean square of the error along a path is
//! taken over 1024 steps from powers of two on. Its exponent is the slope of its logarithm over
//! that of time; the interval is that of the mean over paths from random states, by Student's law.

use std::thread;

use formula::FormulaSystem;
use noise::{StepNoise, StreamKey, WienerRows};
use nonlin::BlockStatus;
use real::{Row, Rows, WIDTH};
use schemes::{Heun, Split, Step, run_time::Scheme};
use stats::{CentralMoments, two_sided};
use systems::run_time::{System, Weights};

use crate::{constant, system, texts};

/// Steps of `split`, and of Heun's scheme; a period is 2π, or of that size.
const TAU: f64 = 0.2;
const FINE: f64 = 0.025;
/// log₂ of the first step of an average, and of its number of steps.
const FIRST: u32 = 10;
const CONFIDENCE: f64 = 1.0 - 1e-6;
/// With a smaller exponent an error does not double over 10⁶ periods: ln 2/ln 10⁶.
const DOUBLES: f64 = 0.05;

/// Systems, each with a state around which paths start.
fn systems() -> [(&'static str, FormulaSystem, Vec<f64>); 5] {
    let of = |name, state: &str, b: &[&str], energy: &str, y0: &[f64]| {
        (name, system(&texts(state, b, energy, &[]), y0), y0.to_vec())
    };
    let plane = ["0 1 0", "0 1", "0"];
    let space = ["0 0 1 0 0", "0 0 1 0", "0 0 1", "0 0", "0"];
    let springs = "(p1^2 + p2^2)/2 + q1^2/2 + q2^2/3 + 0.3*q1*q2";
    let toda = "(p1^2 + p2^2 + p3^2)/2 + exp(q1 - q2) + exp(q2 - q3) + exp(q3 - q1)";
    let star = "(p1^2 + p2^2)/2 + (q1^2 + q2^2)/2 + q1^2*q2 - q2^3/3";
    [
        of("oscillator", "q p", &["1"], "p^2/2 + q^2/2", &[0.6, 0.8]),
        of("two oscillators", "q1 q2 p1 p2", &plane, springs, &[0.6, 0.1, 0.35, 0.7]),
        of("pendulum", "q p", &["1"], "p^2/2 - cos(q)", &[1.0, 0.9]),
        of("Toda", "q1 q2 q3 p1 p2 p3", &space, toda, &[0.3, -0.1, 0.2, 0.6, 0.1, -0.7]),
        of("Hénon–Heiles", "q1 q2 p1 p2", &plane, star, &[0.0, 0.1, 0.35, 0.1]),
    ]
}

/// How the error of the energy grows.
#[derive(Debug)]
struct Growth {
    /// The mean over paths of the exponent, and half of its interval.
    exponent: f64,
    half: f64,
    /// Root mean squares over the first and the last of the times, and all paths.
    sizes: [f64; 2],
}

impl Growth {
    /// Over 2^last steps of size τ with a rate of damping.
    fn new(
        scheme: &dyn Scheme,
        (system, y0): (&FormulaSystem, &[f64]),
        (tau, rate): (f64, f64),
        last: u32,
    ) -> Self {
        let mut paths = scheme.stepper(system).unwrap();
        let mut scatter = vec![[0.0; WIDTH]; y0.len()];
        WienerRows::new(StreamKey { seed: 1, experiment: 1 }, 0).increments(0.03, &mut scatter);
        let rows = paths.state_mut().iter_mut().zip(&scatter).zip(y0);
        rows.for_each(|((row, scatter), y)| *row = scatter.map(|x| y + x));
        let mut scratch = Rows::zero(system.description().scratch_rows());
        let mut energy = |y: &[Row]| {
            let mut energy = [0.0; WIDTH];
            system.energy(y, Weights { dt: 1.0, ..Weights::NONE }, &mut energy, &mut scratch);
            energy
        };
        let start = energy(paths.state());
        let (damping, nothing) = (constant(rate), StepNoise::zero(0));
        let mut status = BlockStatus::explicit();
        // The logarithms of the root mean squares, and the sum of a mean.
        let (mut sizes, mut sum) = (Vec::<Row>::new(), [0.0; WIDTH]);
        let steps = 1_u64 << FIRST;
        for n in 0..(1 << last) + steps {
            paths.step(&Step::new(&damping, n, tau).unwrap(), &nothing, &mut status);
            let power = n.checked_ilog2().unwrap_or(0);
            if power < FIRST || n >= (1 << power) + steps {
                continue;
            }
            let now = energy(paths.state());
            (0..WIDTH).for_each(|p| sum[p] += (now[p] - start[p]).powi(2));
            if n + 1 == (1 << power) + steps {
                sizes.push(sum.map(|sum| 0.5 * (sum / steps as f64).ln()));
                sum = [0.0; WIDTH];
            }
        }
        let time = |k: usize| (((1 << k) as f64 + 0.5) * steps as f64).ln();
        let mean = (0..sizes.len()).map(time).sum::<f64>() / sizes.len() as f64;
        let square: f64 = (0..sizes.len()).map(|k| (time(k) - mean).powi(2)).sum();
        let mut exponents = CentralMoments::default();
        for p in 0..WIDTH {
            let slope = |(k, row): (usize, &Row)| (time(k) - mean) * row[p];
            exponents.add(sizes.iter().enumerate().map(slope).sum::<f64>() / square);
        }
        let over_paths = |row: &Row| {
            (row.iter().map(|size| (2.0 * size).exp()).sum::<f64>() / WIDTH as f64).sqrt()
        };
        let student = two_sided(CONFIDENCE, Some(WIDTH as f64 - 1.0));
        Self {
            exponent: exponents.mean(),
            half: student * exponents.variance_of_mean().sqrt(),
            sizes: [over_paths(&sizes[0]), over_paths(&sizes[sizes.len() - 1])],
        }
    }

    /// The interval of the exponent.
    fn interval(&self) -> (f64, f64) {
        (self.exponent - self.half, self.exponent + self.half)
    }
}

fn energies_do_not_grow(last: u32) {
    let twins = last.min(17);
    let check = |(name, system, y0): (&str, FormulaSystem, Vec<f64>)| {
        let of = (&system, &y0[..]);
        let found = Growth::new(&Split, of, (TAU, 0.0), last);
        println!("{name}: {found:?}");
        let (lo, hi) = found.interval();
        if name == "oscillator" {
            // The flow is exact. Numbers of its matrix that are rounded are the same in all steps.
            let allowed = f64::EPSILON * 2f64.powi(last as i32);
            assert!(found.sizes[1] < allowed, "{found:?}");
        } else {
            assert!(-DOUBLES < lo && lo <= hi && hi < DOUBLES, "{name}: {found:?}");
        }
        // Heun's scheme with eight times as many steps, and a friction of 10⁻⁶ in place of none.
        for (twin, sizes) in [(&Heun as &dyn Scheme, (FINE, 0.0)), (&Split, (TAU, 1e-6))] {
            let found = Growth::new(twin, of, sizes, twins);
            println!("{name}, twin: {found:?}");
            assert!(found.interval().0 > 2.0 * DOUBLES, "{name}: {found:?}");
        }
    };
    thread::scope(|scope| {
        systems().into_iter().for_each(|system| _ = scope.spawn(|| check(system)));
    });
}

#[test]
fn energies_of_split_on_texts_do_not_grow() {
    energies_do_not_grow(18);
}

#[test]
#[ignore = "long: run by the gate"]
fn energies_of_split_on_texts_do_not_grow_over_a_million_periods() {
    energies_do_not_grow(25);
}
