//! A battery of checks of a sampler against a law: each is a sum of terms, one for each step and
//! path, whose mean is zero under the law.

use std::f64::consts::TAU;

use noise::{StepNoise, StreamKey, WienerRows};
use real::WIDTH;

use crate::statistical::{check::Sum, law::Law};

/// Steps of the 32 paths in a battery: 2¹⁸ samples, so that E[A²] is known to 4 parts in a thousand
/// and E[A⁴] to 15.
const STEPS: usize = 1 << 13;

/// λh of the characteristic functions; 1/cosh(λh/2) from 0.89 to 0.037.
const LAMBDAS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// One area of a sample, in units of h/2π, and its two increments in units of √h, with u = v² + w².
struct Pair {
    a: f64,
    v: f64,
    w: f64,
    u: f64,
    /// sin λA for each λ.
    sin: [f64; LAMBDAS.len()],
    /// cos λA, and E[cos λA | w].
    cos: [(f64, f64); LAMBDAS.len()],
}

impl Pair {
    fn new(a: f64, v: f64, w: f64, exponents: &[(f64, f64); LAMBDAS.len()]) -> Self {
        let u = v * v + w * w;
        let waves = LAMBDAS.map(|lambda| (lambda / TAU * a).sin_cos());
        let mean = |(c0, c1): (f64, f64)| (-c0 - c1 * u).exp();
        let cos = std::array::from_fn(|k| (waves[k].1, mean(exponents[k])));
        Self { a, v, w, u, sin: waves.map(|(sin, _)| sin), cos }
    }
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
    mut sampler: impl FnMut(f64, &mut StepNoise),
) -> Result<(), Vec<String>> {
    let exponents = LAMBDAS.map(|lambda| law.exponents(lambda / TAU));
    let mut wiener = WienerRows::new(key, 0);
    let mut noise = StepNoise::with_areas(M);
    let mut before = None;
    // By the name of their check: every sample adds to the same ones in the same order.
    let mut sums: Vec<(&'static str, Sum)> = Vec::new();
    let unit = TAU / step;
    for _ in 0..STEPS {
        match fixed {
            Some(w) => (0..M).for_each(|m| noise.increments[m] = [w[m] * step.sqrt(); WIDTH]),
            None => wiener.increments(step.sqrt(), &mut noise.increments),
        }
        sampler(step, &mut noise);
        for p in 0..WIDTH {
            let of_path = noise.path::<M>(p);
            let w = of_path.increments.map(|w| w / step.sqrt());
            let a = of_path.areas.map(|row| row.map(|a| a * unit));
            let pairs: Vec<Pair> = (0..M)
                .flat_map(|i| (i + 1..M).map(move |j| (i, j)))
                .map(|(i, j)| Pair::new(a[i][j], w[i], w[j], &exponents))
                .collect();
            // One independent term for each sample.
            let mean =
                |f: &dyn Fn(&Pair) -> f64| pairs.iter().map(f).sum::<f64>() / pairs.len() as f64;
            let mut number = 0;
            let mut check = |name, term| {
                if number == sums.len() {
                    sums.push((name, Sum::default()));
                }
                assert_eq!(sums[number].0, name);
                sums[number].1.add(term);
                number += 1;
            };
            let residual = |x: &Pair| x.a * x.a - law.variance(x.u);
            check("mean", mean(&|x| x.a));
            check("variance given w", mean(&residual));
            check("fourth moment given w", mean(&|x| x.a.powi(4) - law.fourth_given(x.u)));
            for (k, (c0, c1)) in exponents.into_iter().enumerate() {
                let residual = |x: &Pair| x.cos[k].0 - x.cos[k].1;
                check("sin", mean(&|x| x.sin[k]));
                check("cos given w", mean(&residual));
                if fixed.is_none() {
                    let expected = (-c0).exp() / (1.0 + 2.0 * c1);
                    check("cos times (|w|² - 2)", mean(&|x| residual(x) * (x.u - 2.0)));
                    check("cos", mean(&|x| x.cos[k].0 - expected));
                }
            }
            if fixed.is_none() {
                check("variance", mean(&|x| x.a * x.a - Law::SECOND));
                check("fourth moment", mean(&|x| x.a.powi(4) - law.fourth()));
                check("regression on w_i²", mean(&|x| residual(x) * (x.v * x.v - 1.0)));
                check("regression on w_j²", mean(&|x| residual(x) * (x.w * x.w - 1.0)));
                check("area with w_i", mean(&|x| x.a * x.v));
                check("area with w_j", mean(&|x| x.a * x.w));
                check("area with w_i w_j", mean(&|x| x.a * x.v * x.w));
            }
            if M == 3 {
                // Products of two areas that share a noise, and the two other increments.
                for (product, ww) in [
                    (a[0][1] * a[0][2], w[1] * w[2]),
                    (-a[0][1] * a[1][2], w[0] * w[2]),
                    (a[0][2] * a[1][2], w[0] * w[1]),
                ] {
                    let residual = product - Law::COUPLING * ww;
                    check("shared noise given w", residual);
                    if fixed.is_none() {
                        check("shared noise with w_j w_k", residual * ww);
                        let squares = product * product - law.fourth() / 3.0;
                        check("squares with a shared noise", squares);
                    }
                }
            }
            // With the area of the step before and with that of the next path, both independent.
            if let Some(before) = before {
                let before: [f64; WIDTH] = before;
                check("from step to step", a[0][1] * before[p] * unit);
                check("from path to path", a[0][1] * noise.areas[1][(p + 1) % WIDTH] * unit);
            }
        }
        before = Some(noise.areas[1]);
    }
    let failures: Vec<String> = sums
        .iter()
        .filter_map(|(name, sum)| Some(format!("{name}: {}", sum.verdict().err()?)))
        .collect();
    if failures.is_empty() { Ok(()) } else { Err(failures) }
}
