//! Coverage of the intervals of time averages.

use noise::{StreamKey, WienerPath};
use stats::{StationaryMean, TimeAverage, TimeAverageError};

/// Series for each case.
const SERIES: u64 = 2000;

/// A stationary series of mean zero.
#[derive(Clone, Copy, Debug)]
enum Law {
    /// xₙ₊₁ = ρxₙ + √(1 − ρ²)·ξ. Correlation time (1 + ρ)/(1 − ρ).
    Autoregressive { rho: f64 },
    /// x = r·(rotation by ω)x + noise, first component: correlations rᵏ cos ωk.
    Oscillating { r: f64, omega: f64 },
    /// ±1, changing with probability p, and a fast normal.
    Bimodal { p: f64 },
    /// White noise and a slow autoregressive part of a hundredth of its variance.
    Hidden { rho: f64 },
}

fn series(law: Law, length: usize, path: u64) -> TimeAverage {
    let mut noise = WienerPath::<1>::new(StreamKey { seed: 7, experiment: 50 }, path);
    let mut average = TimeAverage::default();
    let (mut x, mut y) = (noise.normal(), noise.normal());
    let mut mode = x.signum();
    for _ in 0..length {
        average.add(match law {
            Law::Autoregressive { .. } | Law::Oscillating { .. } => x,
            Law::Bimodal { .. } => mode + 0.3 * noise.normal(),
            Law::Hidden { .. } => noise.normal() + 0.1 * x,
        });
        match law {
            Law::Autoregressive { rho } | Law::Hidden { rho } => {
                x = rho * x + (1.0 - rho * rho).sqrt() * noise.normal();
            }
            Law::Oscillating { r, omega } => {
                let (sin, cos) = (r * omega.sin(), r * omega.cos());
                let rest = (1.0 - r * r).sqrt();
                (x, y) = (
                    cos * x - sin * y + rest * noise.normal(),
                    sin * x + cos * y + rest * noise.normal(),
                );
            }
            // |ξ| exceeds its quantile with probability p: 2(1 − Φ(2.5758)) = 0.01.
            Law::Bimodal { p } => {
                assert_eq!(p, 0.01);
                if noise.normal().abs() > 2.575_829_303_5 {
                    mode = -mode;
                }
            }
        }
    }
    average
}

/// Σγₖ/γ₀ and T = 2Σkγₖ/Σγₖ for γₖ/γ₀ = s·Re zᵏ, k > 0.
fn times(law: Law) -> (f64, f64) {
    let (share, r, omega) = match law {
        Law::Autoregressive { rho } => (1.0, rho, 0.0),
        Law::Oscillating { r, omega } => (1.0, r, omega),
        Law::Bimodal { p } => (1.0 / 1.09, 1.0 - 2.0 * p, 0.0),
        Law::Hidden { rho } => (0.01 / 1.01, rho, 0.0),
    };
    let sum = |weight: &dyn Fn(f64) -> f64| -> f64 {
        (1..100_000).map(f64::from).map(|k| weight(k) * r.powi(k as i32) * (k * omega).cos()).sum()
    };
    let time = 1.0 + 2.0 * share * sum(&|_| 1.0);
    (time, 2.0 * share * sum(&|k| k) / time)
}

/// The band of a share of `of` series that has probability 0.999 if the true share is 0.95.
fn binomial_band(of: u64) -> (f64, f64) {
    let half = 3.29 * (0.95 * 0.05 / of as f64).sqrt();
    (0.95 - half, 0.95 + half)
}

/// Share of covering intervals, and the results.
fn coverage(law: Law, length: usize, chains: u64) -> (f64, Vec<StationaryMean>, u64) {
    let (mut found, mut refused) = (Vec::new(), 0);
    for n in 0..SERIES {
        let chains: Vec<_> =
            (0..chains).map(|chain| series(law, length, n * chains + chain)).collect();
        match TimeAverage::of_chains(&chains) {
            Ok(mean) => found.push(mean),
            Err(_) => refused += 1,
        }
    }
    let covered = found.iter().filter(|mean| mean.lo <= 0.0 && 0.0 <= mean.hi).count();
    (covered as f64 / found.len() as f64, found, refused)
}

#[test]
fn intervals_cover() {
    let ar = |rho| Law::Autoregressive { rho };
    let oscillating = |r, omega| Law::Oscillating { r, omega };
    let cases = [
        (ar(0.0), 600, 1),
        (ar(0.5), 2000, 1),
        (ar(0.9), 16_000, 1),
        (ar(0.9), 4000, 5),
        (ar(0.98), 100_000, 1),
        (ar(0.98), 600, 40),
        (ar(-0.6), 3000, 1),
        (oscillating(0.9, 1.0), 5000, 1),
        (oscillating(0.99, 2.5), 20_000, 1),
        (Law::Bimodal { p: 0.01 }, 80_000, 1),
        (Law::Hidden { rho: 0.99 }, 100_000, 1),
    ];
    for (law, length, chains) in cases {
        let (share, found, refused) = coverage(law, length, chains);
        let mean = |f: &dyn Fn(&StationaryMean) -> f64| {
            found.iter().map(f).sum::<f64>() / found.len() as f64
        };
        let (measured, degrees) = (mean(&|m| m.correlation_time), mean(&|m| m.degrees));
        let (time, decorrelation) = times(law);
        println!(
            "{law:?} {length} x {chains}: covered {share:.4}, refused {refused}, time \
             {measured:.3} of {time:.3}, degrees {degrees:.0}"
        );
        let (lo, hi) = binomial_band(found.len() as u64);
        assert!(lo <= share && share <= hi, "{law:?}: {share}");
        assert!(refused <= SERIES / 100, "{law:?}: {refused}");
        // Batches of b samples see the factor 1 − T/b.
        let batch = (length as u64 * chains) as f64 / (degrees + chains as f64);
        let batch = if chains < 32 { batch } else { length as f64 };
        let seen = measured / time + decorrelation / batch;
        assert!((seen - 1.0).abs() < 0.03, "{law:?}: {measured} for {time}, {seen}");
        let effective = mean(&|m| m.effective_samples * m.correlation_time);
        assert!((effective / (length as u64 * chains) as f64 - 1.0).abs() < 1e-12);
    }
}

/// The twin: samples taken for independent.
#[test]
fn independent_samples_would_not_cover() {
    for (law, length) in [
        (Law::Autoregressive { rho: 0.5 }, 2000),
        (Law::Autoregressive { rho: -0.6 }, 3000),
        (Law::Bimodal { p: 0.01 }, 60_000),
        (Law::Oscillating { r: 0.9, omega: 1.0 }, 5000),
    ] {
        let (_, found, _) = coverage(law, length, 1);
        let naive = |m: &&StationaryMean| m.mean.abs() <= 1.96 * m.se / m.correlation_time.sqrt();
        let share = found.iter().filter(naive).count() as f64 / found.len() as f64;
        let (lo, hi) = binomial_band(found.len() as u64);
        println!("{law:?}: {share:.4}");
        assert!(share < lo || share > hi, "{law:?}: {share}");
    }
}

/// What is accepted covers nearly as it says wherever the limit of acceptance lies, and far beyond
/// the limit everything is refused.
#[test]
fn too_short_series_are_refused() {
    // T/b = 0.05: at the limit, where some are refused.
    let (share, _, refused) = coverage(Law::Autoregressive { rho: 0.864 }, 8000, 1);
    println!("at the limit: covered {share:.4}, refused {refused}");
    assert!(share >= 0.92, "{share}");
    assert!((SERIES / 10..SERIES * 9 / 10).contains(&refused), "{refused}");
    let (_, _, refused) = coverage(Law::Autoregressive { rho: 0.9 }, 4000, 1);
    assert_eq!(refused, SERIES);
    let slow = series(Law::Hidden { rho: 0.9999 }, 100_000, 1).interval();
    assert!(matches!(slow, Err(TimeAverageError::Correlated { .. })), "{slow:?}");
}

#[test]
fn chains_that_disagree_are_refused() {
    let chain = |shift: f64, path: u64| {
        let mut noise = WienerPath::<1>::new(StreamKey { seed: 8, experiment: 50 }, path);
        let mut average = TimeAverage::default();
        (0..1000).for_each(|_| average.add(shift + noise.normal()));
        average
    };
    let agreeing = [chain(0.0, 0), chain(0.0, 1), chain(0.0, 2)];
    assert!(TimeAverage::of_chains(&agreeing).is_ok());
    let other = [chain(0.0, 0), chain(0.0, 1), chain(0.3, 2)];
    let error = TimeAverage::of_chains(&other).unwrap_err();
    assert!(matches!(error, TimeAverageError::Disagree { .. }), "{error}");
}
