//! A battery of checks of a sampler against a law.
//!
//! Every check is a sum of terms, one for each step and path, whose mean is zero under the law; it
//! is divided by the root of the sum of squares and compared with a two-sided critical value of
//! probability [`FALSE_ALARM`]/[`CHECKS`]. The critical value is the normal quantile with the
//! corrections for the skewness (of a studentised sum, γ(2z² + 1)/(6√n)) and the excess of the
//! terms that were seen.

use std::f64::consts::TAU;

use noise::{StreamKey, WienerRows};
use real::{Block, WIDTH};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::{AreaBlock, law::Law};

/// Probability that perfect samplers fail anywhere in these tests.
pub const FALSE_ALARM: f64 = 1e-4;
/// Upper bound of the number of checks: 40 in each of 20 batteries, and 40 others.
pub const CHECKS: usize = 1000;

/// Steps of the 32 paths in a battery: 2¹⁸ samples, so that E[A²] is known to 4 parts in a thousand
/// and E[A⁴] to 15.
const STEPS: usize = 1 << 13;

/// λh of the characteristic functions; 1/cosh(λh/2) from 0.89 to 0.037.
const LAMBDAS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// A sum of terms with mean zero under the hypothesis.
#[derive(Clone, Copy, Default)]
pub struct Sum {
    count: f64,
    powers: [f64; 4],
}

impl Sum {
    pub fn add(&mut self, term: f64) {
        self.count += 1.0;
        let square = term * term;
        self.powers[0] += term;
        self.powers[1] += square;
        self.powers[2] += square * term;
        self.powers[3] += square * square;
    }

    /// Says by how much the sum is off, if it is; a NaN is.
    pub fn verdict(&self) -> Result<(), String> {
        let [first, second, third, fourth] = self.powers;
        let n = self.count;
        let statistic = first / second.sqrt();
        let variance = second / n;
        let skewness = third / n / variance.powf(1.5);
        let excess = fourth / n / (variance * variance) - 3.0;
        let z = Normal::standard().inverse_cdf(1.0 - 0.5 * FALSE_ALARM / CHECKS as f64);
        let corrections = skewness.abs() * (2.0 * z * z + 1.0) / (6.0 * n.sqrt())
            + excess.abs() / n * (z * z - 3.0) * z / 24.0;
        let critical = z + corrections;
        if statistic.abs() < critical {
            Ok(())
        } else {
            Err(format!("{statistic:.1} exceeds {critical:.1}"))
        }
    }
}

/// Sums by the name of their check, in the order of their first terms.
#[derive(Default)]
struct Sums(Vec<(&'static str, usize, Sum)>);

impl Sums {
    /// Adds a term to check number `number` of that name.
    fn add(&mut self, cursor: &mut usize, name: &'static str, number: usize, term: f64) {
        if *cursor == self.0.len() {
            self.0.push((name, number, Sum::default()));
        }
        // Every sample adds to the same checks in the same order.
        let (known, _, sum) = &mut self.0[*cursor];
        assert_eq!(*known, name);
        sum.add(term);
        *cursor += 1;
    }
}

/// One area of a sample, in units of h/2π, its two increments in units of √h, and for each λ sin
/// λA, cos λA and E[cos λA | w].
struct Pair {
    a: f64,
    v: f64,
    w: f64,
    waves: [[f64; 3]; LAMBDAS.len()],
}

impl Pair {
    fn new(a: f64, v: f64, w: f64, exponents: &[(f64, f64); LAMBDAS.len()]) -> Self {
        let wave = |number: usize| {
            let (sin, cos) = (LAMBDAS[number] / TAU * a).sin_cos();
            let (c0, c1) = exponents[number];
            [sin, cos, (-c0 - c1 * (v * v + w * w)).exp()]
        };
        Self { a, v, w, waves: std::array::from_fn(wave) }
    }

    fn u(&self) -> f64 {
        self.v * self.v + self.w * self.w
    }
}

/// The mean of `f` over the pairs of a sample: one independent term for each sample.
fn mean(pairs: &[Pair], f: impl Fn(&Pair) -> f64) -> f64 {
    pairs.iter().map(f).sum::<f64>() / pairs.len() as f64
}

/// Whether `sampler` draws areas of M noises with the given law, over steps of size `step`, given
/// normal increments or always the `fixed` ones (in units of √h).
///
/// The names of the checks that reject are returned.
pub fn battery<const M: usize>(
    law: Law,
    key: StreamKey,
    step: f64,
    fixed: Option<[f64; M]>,
    mut sampler: impl FnMut(f64, &Block<M>, &mut AreaBlock<M>),
) -> Result<(), Vec<String>> {
    let m = law.moments();
    let exponents = LAMBDAS.map(|lambda| law.exponents(lambda / TAU));
    let mut noise = WienerRows::new(key, 0);
    let mut dw = Block::<M>::zero();
    let mut areas = AreaBlock::zero();
    let mut before = AreaBlock::<M>::zero();
    let mut sums = Sums::default();
    let mut pairs = Vec::new();
    let unit = TAU / step;
    for n in 0..STEPS {
        match fixed {
            Some(w) => dw = Block::splat(w.map(|w| w * step.sqrt())),
            None => noise.increments(step.sqrt(), &mut dw.0),
        }
        sampler(step, &dw, &mut areas);
        for p in 0..WIDTH {
            let w = dw.path(p).map(|w| w / step.sqrt());
            let a = areas.path(p).map(|row| row.map(|a| a * unit));
            pairs.clear();
            for (i, j) in (0..M).flat_map(|i| (i + 1..M).map(move |j| (i, j))) {
                pairs.push(Pair::new(a[i][j], w[i], w[j], &exponents));
            }
            let mut cursor = 0;
            let mut check = |name, number, term| sums.add(&mut cursor, name, number, term);
            check("mean", 0, mean(&pairs, |x| x.a));
            check("variance given w", 0, mean(&pairs, |x| x.a * x.a - m.variance(x.u())));
            check(
                "fourth moment given w",
                0,
                mean(&pairs, |x| x.a.powi(4) - m.fourth_given(x.u())),
            );
            for number in 0..LAMBDAS.len() {
                check("sin", number, mean(&pairs, |x| x.waves[number][0]));
                check(
                    "cos given w",
                    number,
                    mean(&pairs, |x| x.waves[number][1] - x.waves[number][2]),
                );
                if fixed.is_none() {
                    let weighted =
                        |x: &Pair| (x.waves[number][1] - x.waves[number][2]) * (x.u() - 2.0);
                    check("cos times (|w|² - 2)", number, mean(&pairs, weighted));
                    let (c0, c1) = exponents[number];
                    check(
                        "cos",
                        number,
                        mean(&pairs, |x| x.waves[number][1] - (-c0).exp() / (1.0 + 2.0 * c1)),
                    );
                }
            }
            if fixed.is_none() {
                check("variance", 0, mean(&pairs, |x| x.a * x.a - m.second));
                check("fourth moment", 0, mean(&pairs, |x| x.a.powi(4) - m.fourth));
                let residual = |x: &Pair| x.a * x.a - m.variance(x.u());
                check("regression on w_i²", 0, mean(&pairs, |x| residual(x) * (x.v * x.v - 1.0)));
                check("regression on w_j²", 0, mean(&pairs, |x| residual(x) * (x.w * x.w - 1.0)));
                check("area with w_i", 0, mean(&pairs, |x| x.a * x.v));
                check("area with w_j", 0, mean(&pairs, |x| x.a * x.w));
                check("area with w_i w_j", 0, mean(&pairs, |x| x.a * x.v * x.w));
            }
            if M == 3 {
                // Products of two areas that share a noise, and the two other increments.
                let products = [
                    (a[0][1] * a[0][2], w[1] * w[2]),
                    (-a[0][1] * a[1][2], w[0] * w[2]),
                    (a[0][2] * a[1][2], w[0] * w[1]),
                ];
                for (number, (product, ww)) in products.into_iter().enumerate() {
                    check("shared noise given w", number, product - m.coupling() * ww);
                    if fixed.is_none() {
                        check(
                            "shared noise with w_j w_k",
                            number,
                            (product - m.coupling() * ww) * ww,
                        );
                        check(
                            "squares with a shared noise",
                            number,
                            product * product - m.fourth / 3.0,
                        );
                    }
                }
            }
            if n > 0 {
                // With the area of the step before and with that of the next path, both
                // independent.
                check("from step to step", 0, a[0][1] * before.0[0][1][p] * unit);
                check("from path to path", 0, a[0][1] * areas.0[0][1][(p + 1) % WIDTH] * unit);
            }
        }
        before = areas;
    }
    let failures: Vec<String> = sums
        .0
        .iter()
        .filter_map(|(name, number, sum)| {
            Some(format!("{name} {number}: {}", sum.verdict().err()?))
        })
        .collect();
    if failures.is_empty() { Ok(()) } else { Err(failures) }
}
