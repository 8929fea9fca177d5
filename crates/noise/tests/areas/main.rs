//! Do the samplers draw areas of the right law, from the coefficients that they claim, with the
//! errors that they claim?
//!
//! [`law`] derives what is expected, [`battery`] compares, and the tests below also show that wrong
//! samplers are rejected. Given the increments, A and −A have the same law (the path run
//! backwards), so no statistic sees a change of the sign of all areas: that is shown on paths
//! rebuilt from the coefficients, in [`rebuilt`]. [`truncation`] measures the errors of cutting the
//! series. All checks of all files together fail with probability at most [`battery::FALSE_ALARM`]
//! if everything is right; `AREA_SEED` in the environment replaces the seed.

mod battery;
mod law;
mod rebuilt;
mod truncation;
mod written_out;

use std::f64::consts::{FRAC_2_PI, PI};

use noise::{AreaSampler, StreamKey, WienerRows};
use real::{Block, Row, WIDTH};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::battery::{CHECKS, FALSE_ALARM, battery};
use crate::law::Law;
use crate::written_out::{AreaMethod, Knobs, RIGHT, WrittenOut};

/// A step that is no power of two.
const STEP: f64 = 0.3;

/// The key of an experiment.
pub fn key(experiment: u64) -> StreamKey {
    let seed =
        std::env::var("AREA_SEED").map_or(1, |seed| seed.parse().expect("AREA_SEED is a number"));
    StreamKey { seed, experiment }
}

/// The areas of M noises: those of path p are `block.0[i][j][p]`, i < j.
#[derive(Clone, Copy)]
pub struct AreaBlock<const M: usize>(pub [[Row; M]; M]);

impl<const M: usize> AreaBlock<M> {
    /// All zero.
    pub fn zero() -> Self {
        Self([[[0.0; WIDTH]; M]; M])
    }

    /// The skew matrix of path `p`.
    pub fn path(&self, p: usize) -> [[f64; M]; M] {
        noise::skew(&self.0.each_ref(), p)
    }

    /// Replaces the areas of path `p` by those above the diagonal.
    pub fn set_path(&mut self, p: usize, area: [[f64; M]; M]) {
        for i in 0..M {
            (i + 1..M).for_each(|j| self.0[i][j][p] = area[i][j]);
        }
    }
}

/// Chen's relation.
fn join<const M: usize>(
    one: &AreaBlock<M>,
    first: &[Row; M],
    other: &AreaBlock<M>,
    second: &[Row; M],
) -> AreaBlock<M> {
    let mut joined = *one;
    noise::join(joined.0.as_flattened_mut(), first, other.0.as_flattened(), second);
    joined
}

/// A sampler as a function, as batteries want it.
fn sampler<const M: usize>(
    key: StreamKey,
    terms: usize,
) -> impl FnMut(f64, &Block<M>, &mut AreaBlock<M>) {
    let mut sampler = AreaSampler::new(key, 0, M, terms);
    move |step, dw, areas| sampler.areas(step, &dw.0, areas.0.as_flattened_mut())
}

/// A method that leaves out a tail.
fn written<const M: usize>(
    key: StreamKey,
    method: AreaMethod,
    terms: usize,
) -> impl FnMut(f64, &Block<M>, &mut AreaBlock<M>) {
    let mut written = WrittenOut::new(key, 0, method, terms, RIGHT);
    move |step, dw, areas| written.areas(step, dw, areas)
}

/// Two half steps, the increment split by a Brownian bridge, and `chen` of the pieces.
fn halves<const M: usize>(
    key: StreamKey,
    mut sampler: impl FnMut(f64, &Block<M>, &mut AreaBlock<M>),
    chen: fn(&AreaBlock<M>, &[Row; M], &AreaBlock<M>, &[Row; M]) -> AreaBlock<M>,
) -> impl FnMut(f64, &Block<M>, &mut AreaBlock<M>) {
    let mut bridge =
        WienerRows::new(StreamKey { experiment: key.experiment + 1_000_000, ..key }, 0);
    move |step, dw, areas| {
        let mut first = Block::<M>::zero();
        let mut second = Block::<M>::zero();
        bridge.increments(0.5 * step.sqrt(), &mut first.0);
        for m in 0..M {
            for p in 0..WIDTH {
                let half = 0.5 * dw.0[m][p];
                (first.0[m][p], second.0[m][p]) = (half + first.0[m][p], half - first.0[m][p]);
            }
        }
        let (mut one, mut other) = (AreaBlock::zero(), AreaBlock::zero());
        sampler(0.5 * step, &first, &mut one);
        sampler(0.5 * step, &second, &mut other);
        *areas = chen(&one, &first.0, &other, &second.0);
    }
}

#[test]
fn few_terms_have_the_law_of_their_series() {
    let law = |terms| Law::of(AreaMethod::MrongowiusRoessler, terms);
    // Five terms: the tails matter.
    assert_eq!(battery(law(5), key(3), STEP, None, sampler::<3>(key(3), 5)), Ok(()));
    assert_eq!(battery(law(0), key(5), 2.0, None, sampler::<2>(key(5), 0)), Ok(()));
    assert_eq!(battery(law(2), key(5), 1e-6, None, sampler::<4>(key(5), 2)), Ok(()));
}

/// With eleven terms and both tails the variances are exact, E[A⁴] is short of 3e-5 of its value
/// and the characteristic functions are off by (½ + u)x⁴/(3π⁴·11³)·e^{−c₀−uc₁} < 2e-4 (see
/// [`law`]): at 2¹⁸ samples less than a quarter of the standard error of each check.
#[test]
fn eleven_terms_have_the_law_of_the_area() {
    let (key, w) = (key(11), [3.0, -1.0, 0.5]);
    assert_eq!(battery(Law::EXACT, key, STEP, None, sampler::<3>(key, 11)), Ok(()));
    assert_eq!(battery(Law::EXACT, key, STEP, Some(w), sampler::<3>(key, 24)), Ok(()));
}

/// Two half steps joined by Chen's relation have the law of one whole step.
#[test]
fn joined_halves_have_the_law_of_the_area() {
    let key = key(30);
    let joined = halves(key, sampler::<3>(key, 11), join);
    assert_eq!(battery(Law::EXACT, key, STEP, None, joined), Ok(()));
}

/// √n sup|Fₙ − F| of an area of two noises against F(a) = (2/π) arctan e^{πa/h}, the distribution
/// function of the density sech(πa/h)/h.
fn kolmogorov_smirnov(
    key: StreamKey,
    mut sampler: impl FnMut(f64, &Block<2>, &mut AreaBlock<2>),
) -> f64 {
    let mut noise = WienerRows::new(key, 0);
    let (mut dw, mut areas) = (Block::<2>::zero(), AreaBlock::zero());
    let mut all = Vec::new();
    for _ in 0..1 << 13 {
        noise.increments(f64::sqrt(STEP), &mut dw.0);
        sampler(STEP, &dw, &mut areas);
        all.extend(areas.0[0][1]);
    }
    all.sort_unstable_by(f64::total_cmp);
    let n = all.len() as f64;
    let distance = all.iter().enumerate().fold(0.0, |distance, (i, &a)| {
        let f = FRAC_2_PI * (PI * a / STEP).exp().atan();
        f64::max(distance, f64::max(f - i as f64 / n, (i + 1) as f64 / n - f))
    });
    n.sqrt() * distance
}

/// The distance exceeds x with probability at most 2e^{−2x²} (Massart 1990).
#[test]
fn the_distribution_function_is_that_of_a_hyperbolic_secant() {
    let critical = (0.5 * (2.0 * CHECKS as f64 / FALSE_ALARM).ln()).sqrt();
    let distance = kolmogorov_smirnov(key(41), sampler(key(41), 11));
    assert!(distance < critical, "{distance}");
    // The twin: a normal of the right variance given the increments.
    let distance = kolmogorov_smirnov(key(43), sampler(key(43), 0));
    assert!(distance > critical, "{distance}");
}

/// Asserts that the battery against the exact law rejects, and that the named checks are among
/// those that do.
fn rejected(
    what: &str,
    experiment: u64,
    names: &[&str],
    sampler: impl FnMut(f64, &Block<3>, &mut AreaBlock<3>),
) {
    let failures = battery(Law::EXACT, key(experiment), STEP, None, sampler).expect_err(what);
    for name in names {
        assert!(
            failures.iter().any(|failure| failure.starts_with(name)),
            "{name} does not reject {what}: {failures:?}"
        );
    }
}

#[test]
fn samplers_that_forget_something_are_rejected() {
    let key = key(100);
    let good = || sampler::<3>(key, 11);

    // A short series sold as the area: E[A²] is short of (3/2π²)h²ψ₁(n+1), 11 % with five terms.
    let short = written::<3>(key, AreaMethod::Fourier, 5);
    rejected("five terms of Fourier", 100, &["variance", "variance given w", "cos"], short);
    // 4 % with five terms; the coupling to w is right.
    rejected(
        "no tail of the pairs",
        100,
        &["variance", "cos"],
        written::<3>(key, AreaMethod::Milstein, 5),
    );

    // Normals with the right covariance given w: only what looks at more than second moments can
    // tell.
    let normal = sampler::<3>(key, 0);
    rejected("no series", 100, &["fourth moment given w", "cos given w"], normal);

    // The increments ignored, and the variance repaired.
    let mut deaf = good();
    rejected(
        "w ignored",
        100,
        &["variance", "regression on w_i²", "regression on w_j²"],
        |step, _, areas| {
            deaf(step, &Block::zero(), areas);
        },
    );
    let mut deaf = good();
    let repaired = ["regression on w_i²", "cos given w", "cos times", "shared noise with"];
    rejected("w ignored, with a variance of h²/4", 100, &repaired, |step, _, areas| {
        deaf(3f64.sqrt() * step, &Block::zero(), areas);
    });

    // Right marginals for each pair, given w, but each from noise of its own.
    let mut pairs = [(0, 1), (0, 2), (1, 2)]
        .map(|pair| (pair, sampler::<2>(self::key(200 + pair.0 + 3 * pair.1), 11)));
    rejected(
        "independent pairs",
        100,
        &["shared noise with", "squares with a shared noise"],
        |step, dw, areas| {
            for ((i, j), sampler) in &mut pairs {
                let (i, j) = (*i as usize, *j as usize);
                let mut area = AreaBlock::zero();
                sampler(step, &Block([dw.0[i], dw.0[j]]), &mut area);
                areas.0[i][j] = area.0[0][1];
            }
        },
    );

    const NONE: [Row; 3] = [[0.0; WIDTH]; 3];
    // Areas added without the triangle between the halves.
    let mut triangle = halves(key, good(), |one, _, other, _| join(one, &NONE, other, &NONE));
    rejected("halves without Chen's term", 100, &["variance", "regression on w_i²"], &mut triangle);

    // Every area handed out twice.
    let mut again = good();
    let mut even = true;
    let mut kept = AreaBlock::zero();
    rejected("areas used twice", 100, &["from step to step"], |step, dw, areas| {
        if even {
            again(step, dw, &mut kept);
        }
        even = !even;
        *areas = kept;
    });

    // One stream for all paths.
    let mut shared = good();
    rejected("paths that share a stream", 100, &["from path to path"], |step, dw, areas| {
        shared(step, dw, areas);
        for row in areas.0.iter_mut().flatten() {
            for p in 0..WIDTH {
                row[p] = row[p - p % 2];
            }
        }
    });
}

#[test]
fn samplers_with_wrong_constants_and_signs_are_rejected() {
    let key = key(110);
    let wrong = |terms, knobs| {
        let mut written = WrittenOut::new(key, 0, AreaMethod::MrongowiusRoessler, terms, knobs);
        move |step: f64, dw: &Block<3>, areas: &mut AreaBlock<3>| written.areas(step, dw, areas)
    };
    // The knobs as they should be.
    assert_eq!(battery(Law::EXACT, key, STEP, None, wrong(11, RIGHT)), Ok(()));

    // The sign of one of the two couplings to w: right for each pair alone, wrong for two that
    // share a noise.
    let coupling = wrong(5, Knobs { coupling: -1.0, ..RIGHT });
    rejected("a sign of w", 110, &["shared noise with w_j w_k"], coupling);
    let tail = wrong(1, Knobs { tail: -1.0, ..RIGHT });
    rejected("a sign in the tail", 110, &["shared noise with w_j w_k"], tail);
    // ψ₁(n) for ψ₁(n+1): 2 % of the variance at five terms.
    rejected(
        "a tail off by one",
        110,
        &["variance", "variance given w"],
        wrong(5, Knobs { shift: 0, ..RIGHT }),
    );

    // Variances h²/3 and 0.220 h² in place of h²/4.
    for ratio in [4.0 / 3.0, 0.88] {
        let mut good = sampler::<3>(key, 11);
        rejected(
            "a wrong variance",
            110,
            &["variance", "fourth moment", "cos"],
            |step, dw, areas| {
                good(step, dw, areas);
                areas.0.iter_mut().flatten().flatten().for_each(|a| *a *= f64::sqrt(ratio));
            },
        );
    }

    // J_ij = ½W_iW_j + A_ij handed out for A_ij.
    let mut good = sampler::<3>(key, 11);
    rejected("J for A", 110, &["area with w_i w_j", "variance"], |step, dw, areas| {
        good(step, dw, areas);
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            for p in 0..WIDTH {
                areas.0[i][j][p] += 0.5 * dw.0[i][p] * dw.0[j][p];
            }
        }
    });
}

/// The samplers compute what is written out, from the normals in the documented order.
#[test]
fn samplers_agree_with_the_formulas_written_out() {
    fn agree<const M: usize>(terms: usize) {
        let key = key(300);
        let mut noise = WienerRows::new(key, 64);
        let mut ours = AreaSampler::new(key, 64, M, terms);
        let mut theirs = WrittenOut::new(key, 64, AreaMethod::MrongowiusRoessler, terms, RIGHT);
        let (mut dw, mut a, mut b) =
            (Block::<M>::zero(), AreaBlock::<M>::zero(), AreaBlock::zero());
        for step in [1.0, 0.25, 0.3, 1e-4] {
            noise.increments(f64::sqrt(step), &mut dw.0);
            ours.areas(step, &dw.0, a.0.as_flattened_mut());
            theirs.areas(step, &dw, &mut b);
            for p in 0..WIDTH {
                for (i, j) in (0..M).flat_map(|i| (i + 1..M).map(move |j| (i, j))) {
                    // Some hundred roundings of terms that are a few steps at most.
                    let difference = (a.0[i][j][p] - b.0[i][j][p]).abs();
                    assert!(difference < 1e-13 * step, "M = {M}, n = {terms}: {difference:e}");
                }
            }
        }
    }
    for terms in [0, 1, 7] {
        agree::<2>(terms);
        agree::<3>(terms);
        agree::<4>(terms);
        agree::<5>(terms);
    }
}

/// The normal quantile of one of [`CHECKS`] checks.
pub fn critical() -> f64 {
    Normal::standard().inverse_cdf(1.0 - 0.5 * FALSE_ALARM / CHECKS as f64)
}
