//! Do the samplers draw areas of the right law, from the coefficients that they claim, with the
//! errors that they claim?
//!
//! [`law`](crate::statistical::law) derives what is expected, [`battery`] compares, and the tests
//! below also show that wrong samplers are rejected. Given the increments, A and −A have the same
//! law (the path run backwards), so no statistic sees a change of the sign of all areas: that is
//! shown on paths rebuilt from the coefficients, in [`rebuilt`](crate::rebuilt).
//! [`truncation`](crate::statistical::truncation) measures the errors of cutting the series.
//! `AREA_SEED` in the environment replaces the seed.

use std::f64::consts::{FRAC_2_PI, PI};

use noise::{AreaSampler, StepNoise, StreamKey, WienerRows};
use real::WIDTH;

use crate::statistical::battery::battery;
use crate::statistical::check::kolmogorov_smirnov;
use crate::statistical::law::Law;
use crate::written_out::{Knobs, RIGHT, written_out};

/// A step that is no power of two.
const STEP: f64 = 0.3;

/// The key of an experiment.
pub fn key(experiment: u64) -> StreamKey {
    let seed =
        std::env::var("AREA_SEED").map_or(1, |seed| seed.parse().expect("AREA_SEED is a number"));
    StreamKey { seed, experiment }
}

/// A sampler of M noises as a function, as batteries want it.
fn sampler(key: StreamKey, noises: usize, terms: usize) -> impl FnMut(f64, &mut StepNoise) {
    let mut sampler = AreaSampler::new(key, 0, noises, terms);
    move |step, noise| sampler.areas(step, &noise.increments, &mut noise.areas)
}

/// Two half steps, the increment split by a Brownian bridge, joined with Chen's triangle between
/// the pieces or without.
fn halves(
    key: StreamKey,
    mut sampler: impl FnMut(f64, &mut StepNoise),
    triangle: bool,
) -> impl FnMut(f64, &mut StepNoise) {
    let mut bridge =
        WienerRows::new(StreamKey { experiment: key.experiment + 1_000_000, ..key }, 0);
    let [mut first, mut second] = [(); 2].map(|()| StepNoise::with_areas(3));
    move |step, noise| {
        bridge.increments(0.5 * step.sqrt(), &mut first.increments);
        for m in 0..3 {
            for p in 0..WIDTH {
                let (half, off) = (0.5 * noise.increments[m][p], first.increments[m][p]);
                (first.increments[m][p], second.increments[m][p]) = (half + off, half - off);
            }
        }
        sampler(0.5 * step, &mut first);
        sampler(0.5 * step, &mut second);
        if !triangle {
            first.increments.fill([0.0; WIDTH]);
        }
        first.join(&second);
        noise.areas.copy_from_slice(&first.areas);
    }
}

/// With eleven terms and both tails the variances are exact, E[A⁴] is short of 3e-5 of its value
/// and the characteristic functions are off by (½ + u)x⁴/(3π⁴·11³)·e^{−c₀−uc₁} < 2e-4 (see
/// [`crate::statistical::law`]): at 2¹⁸ samples less than a quarter of the standard error of each check.
#[test]
fn areas_have_the_law_of_the_area_or_of_a_short_series() {
    let (few, key, w) = (key(5), key(11), [3.0, -1.0, 0.5]);
    // Five terms and fewer: the tails matter.
    assert_eq!(
        battery::<3>(Law::of(5), self::key(3), STEP, None, sampler(self::key(3), 3, 5)),
        Ok(())
    );
    assert_eq!(battery::<2>(Law::of(0), few, 2.0, None, sampler(few, 2, 0)), Ok(()));
    assert_eq!(battery::<4>(Law::of(2), few, 1e-6, None, sampler(few, 4, 2)), Ok(()));
    assert_eq!(battery::<3>(Law::EXACT, key, STEP, None, sampler(key, 3, 11)), Ok(()));
    assert_eq!(battery(Law::EXACT, key, STEP, Some(w), sampler(key, 3, 24)), Ok(()));
    // Two half steps joined by Chen's relation have the law of one whole step.
    let key = self::key(30);
    let joined = halves(key, sampler(key, 3, 11), true);
    assert_eq!(battery::<3>(Law::EXACT, key, STEP, None, joined), Ok(()));
}

/// F(a) = (2/π) arctan e^{πa/h} is the distribution function of the density sech(πa/h)/h.
#[test]
fn the_distribution_function_is_that_of_a_hyperbolic_secant() {
    let compared = |key, terms| {
        let (mut wiener, mut sampler) = (WienerRows::new(key, 0), sampler(key, 2, terms));
        let mut noise = StepNoise::with_areas(2);
        let mut all = Vec::new();
        for _ in 0..1 << 13 {
            wiener.increments(f64::sqrt(STEP), &mut noise.increments);
            sampler(STEP, &mut noise);
            all.extend(noise.areas[1]);
        }
        kolmogorov_smirnov(all, |a| FRAC_2_PI * (PI * a / STEP).exp().atan())
    };
    assert_eq!(compared(key(41), 11), Ok(()));
    // The twin: a normal of the right variance given the increments.
    assert!(compared(key(43), 0).is_err());
}

/// Asserts that the battery against the exact law rejects, and that the named checks are among
/// those that do.
fn rejected(what: &str, experiment: u64, names: &[&str], sampler: impl FnMut(f64, &mut StepNoise)) {
    let failures = battery::<3>(Law::EXACT, key(experiment), STEP, None, sampler).expect_err(what);
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
    let good = || sampler(key, 3, 11);
    let rejected = |what, names: &[&str], sampler: &mut dyn FnMut(f64, &mut StepNoise)| {
        rejected(what, 100, names, sampler)
    };

    // Normals with the right covariance given w: only what looks at more than second moments can
    // tell.
    let names = ["fourth moment given w", "cos given w"];
    rejected("no series", &names, &mut sampler(key, 3, 0));

    // The increments ignored, and the variance repaired to h²/4.
    let repaired = ["regression on w_i²", "cos given w", "cos times", "shared noise with"];
    for (factor, names) in
        [(1.0, &["variance", "regression on w_i²", "regression on w_j²"][..]), (3.0, &repaired)]
    {
        let (mut deaf, mut still) = (good(), StepNoise::with_areas(3));
        rejected("w ignored", names, &mut |step, noise| {
            deaf(f64::sqrt(factor) * step, &mut still);
            noise.areas.copy_from_slice(&still.areas);
        });
    }

    // Right marginals for each pair, given w, but each from noise of its own.
    let mut pairs = [(0, 1), (0, 2), (1, 2)].map(|(i, j)| {
        let own = sampler(self::key(200 + i as u64 + 3 * j as u64), 2, 11);
        (i, j, own, StepNoise::with_areas(2))
    });
    let names = ["shared noise with", "squares with a shared noise"];
    rejected("independent pairs", &names, &mut |step, noise| {
        for (i, j, sampler, pair) in &mut pairs {
            pair.increments.copy_from_slice(&[noise.increments[*i], noise.increments[*j]]);
            sampler(step, pair);
            noise.areas[*i * 3 + *j] = pair.areas[1];
        }
    });

    let names = ["variance", "regression on w_i²"];
    rejected("halves without Chen's term", &names, &mut halves(key, good(), false));

    // Every area handed out twice.
    let (mut again, mut even, mut kept) = (good(), true, StepNoise::with_areas(3));
    rejected("areas used twice", &["from step to step"], &mut |step, noise| {
        if even {
            again(step, noise);
            kept.copy_from(noise);
        }
        even = !even;
        noise.areas.copy_from_slice(&kept.areas);
    });

    // One stream for all paths.
    let mut shared = good();
    rejected("paths that share a stream", &["from path to path"], &mut |step, noise| {
        shared(step, noise);
        for row in noise.areas.iter_mut() {
            (0..WIDTH).for_each(|p| row[p] = row[p - p % 2]);
        }
    });
}

#[test]
fn samplers_with_wrong_constants_and_signs_are_rejected() {
    let key = key(110);
    let wrong = |terms, knobs| written_out::<3>(key, 0, terms, knobs);
    // The knobs as they should be.
    assert_eq!(battery::<3>(Law::EXACT, key, STEP, None, wrong(11, RIGHT)), Ok(()));

    let shared = &["shared noise with w_j w_k"][..];
    for (what, terms, knobs, names) in [
        // The sign of one of the two couplings to w: right for each pair alone, wrong for two that
        // share a noise.
        ("a sign of w", 5, Knobs { coupling: -1.0, ..RIGHT }, shared),
        ("a sign in the tail", 1, Knobs { sign: -1.0, ..RIGHT }, shared),
        // ψ₁(n) for ψ₁(n+1): 2 % of the variance at five terms.
        ("off by one", 5, Knobs { shift: 0, ..RIGHT }, &["variance", "variance given w"]),
        // A short series sold as the area: E[A²] is short of (3/2π²)h²ψ₁(n+1), 11 %.
        (
            "five terms of Fourier",
            5,
            Knobs { of_noises: 0.0, of_pairs: 0.0, ..RIGHT },
            &["variance", "variance given w", "cos"],
        ),
        // 4 %; the coupling to w is right.
        ("no tail of the pairs", 5, Knobs { of_pairs: 0.0, ..RIGHT }, &["variance", "cos"]),
    ] {
        rejected(what, 110, names, wrong(terms, knobs));
    }

    // Variances h²/3 and 0.220 h² in place of h²/4.
    for ratio in [4.0 / 3.0, 0.88] {
        let mut good = sampler(key, 3, 11);
        let names = ["variance", "fourth moment", "cos"];
        rejected("a wrong variance", 110, &names, |step, noise| {
            good(step, noise);
            noise.areas.as_flattened_mut().iter_mut().for_each(|a| *a *= f64::sqrt(ratio));
        });
    }

    // J_ij = ½W_iW_j + A_ij handed out for A_ij.
    let mut good = sampler(key, 3, 11);
    rejected("J for A", 110, &["area with w_i w_j", "variance"], |step, noise| {
        good(step, noise);
        let StepNoise { increments, areas, .. } = noise;
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let products = increments[i].iter().zip(&increments[j]);
            areas[3 * i + j].iter_mut().zip(products).for_each(|(a, (v, w))| *a += 0.5 * v * w);
        }
    });
}

/// The samplers compute what is written out, from the normals in the documented order.
#[test]
fn samplers_agree_with_the_formulas_written_out() {
    fn agree<const M: usize>(terms: usize) {
        let key = key(300);
        let mut wiener = WienerRows::new(key, 64);
        let mut ours = AreaSampler::new(key, 64, M, terms);
        let mut theirs = written_out::<M>(key, 64, terms, RIGHT);
        let [mut a, mut b] = [(); 2].map(|()| StepNoise::with_areas(M));
        for step in [1.0, 0.25, 0.3, 1e-4] {
            wiener.increments(f64::sqrt(step), &mut a.increments);
            b.copy_from(&a);
            ours.areas(step, &a.increments, &mut a.areas);
            theirs(step, &mut b);
            for (a, b) in a.areas.as_flattened().iter().zip(b.areas.as_flattened()) {
                // Some hundred roundings of terms that are a few steps at most.
                assert!((a - b).abs() < 1e-13 * step, "M = {M}, n = {terms}: {a} {b}");
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
