use mc::CrossMoments;
use noise::{StreamKey, WienerPath};

use super::*;
use crate::results::{Rate, Verdict};

const TAUS: [f64; 8] =
    [0.03125, 0.015625, 0.0078125, 0.00390625, 0.001953125, 0.0009765625, 0.00048828125, 0.000244140625];

/// Squared errors C τ^{2p}(1 + τ)(1 − c τ_ref/τ) Z² of 400 paths; Z is normal, half shared between the levels.
fn synthetic(seed: u64, order: f64, reference: Option<f64>) -> CrossMoments {
    let mut squares = CrossMoments::new(TAUS.len());
    for path in 0..400 {
        let mut noise = WienerPath::<1>::new(StreamKey { seed, experiment: 1 }, path);
        let shared = noise.normal();
        let errors: Vec<f64> = TAUS
            .iter()
            .map(|tau| {
                let z = (shared + noise.normal()) / 2f64.sqrt();
                let near_reference = 1.0 - reference.map_or(0.0, |reference| reference / tau);
                tau.powf(2.0 * order) * (1.0 + tau) * near_reference * z * z
            })
            .collect();
        squares.add(&errors);
    }
    squares
}

#[test]
fn strong_intervals_cover_the_order() {
    // 95 % intervals on 200 data sets: 190 expected; fewer than 176 or 200 of 200 has probability below 1e-4.
    for (order, reference) in [(0.5, None), (1.0, None), (0.5, Some(TAUS[7] / 4.0))] {
        let covered = (0..200)
            .filter(|&seed| {
                let rate = fit_strong(&TAUS, reference, &synthetic(seed, order, reference)).unwrap();
                rate.lo <= order && order <= rate.hi
            })
            .count();
        assert!((176..200).contains(&covered), "order {order}, reference {reference:?}: {covered} of 200");
    }
}

#[test]
fn forgetting_the_reference_biases_the_order() {
    // The twin: the same data without the reference term.
    let reference = Some(TAUS[7] / 2.0);
    let covered = (0..50)
        .filter(|&seed| {
            let rate = fit_strong(&TAUS, None, &synthetic(seed, 0.5, reference)).unwrap();
            rate.lo <= 0.5 && 0.5 <= rate.hi
        })
        .count();
    assert!(covered < 40, "{covered} of 50");
}

#[test]
fn wrong_orders_are_refuted_and_wide_intervals_undecided() {
    let rate = fit_strong(&TAUS, None, &synthetic(1, 0.5, None)).unwrap();
    assert_eq!(order_verdict(Some(&rate), 0.5), Verdict::Holds);
    assert_eq!(order_verdict(Some(&rate), 1.0), Verdict::Refuted);
    let wide = Rate { lo: 0.1, hi: 0.9, ..rate.clone() };
    assert_eq!(order_verdict(Some(&wide), 0.5), Verdict::Undecided);
    // Precise, near the order, and yet not it.
    let off = Rate { estimate: 0.55, lo: 0.54, hi: 0.56, ..rate };
    assert_eq!(order_verdict(Some(&off), 0.5), Verdict::Undecided);
    assert_eq!(order_verdict(None, 0.5), Verdict::Undecided);
}

#[test]
fn zero_errors_and_too_few_paths_name_no_order() {
    let mut exact = CrossMoments::new(8);
    let mut few = CrossMoments::new(8);
    for path in 0..5 {
        exact.add(&[0.0; 8]);
        few.add(&TAUS.map(|tau| tau * (1.0 + f64::from(path) * tau)));
    }
    assert!(fit_strong(&TAUS, None, &exact).is_none());
    assert!(fit_strong(&TAUS, None, &few).is_none());
}

/// Errors Aτᵖ + Bτ^{p+1} with noise proportional to τ, half of it shared.
fn weak(seed: u64, p: f64, a: f64, b: f64, noise_size: f64) -> (Vec<f64>, Vec<Vec<f64>>) {
    let mut noise = WienerPath::<1>::new(StreamKey { seed, experiment: 2 }, 0);
    let shared = noise.normal();
    let errors = TAUS
        .iter()
        .map(|&tau| {
            let scatter = (shared + noise.normal()) / 2f64.sqrt();
            a * tau.powf(p) + b * tau.powf(p + 1.0) + noise_size * tau * scatter
        })
        .collect();
    let covariance = (0..8)
        .map(|l| (0..8).map(|m| noise_size * noise_size * TAUS[l] * TAUS[m] * if l == m { 1.0 } else { 0.5 }).collect())
        .collect();
    (errors, covariance)
}

#[test]
fn weak_intervals_cover_the_order_through_a_change_of_sign() {
    // B = −40 makes the error change its sign at τ = 1/40, between the first two step sizes.
    for b in [1.0, -40.0] {
        let covered = (0..200)
            .filter(|&seed| {
                let (errors, covariance) = weak(seed, 1.0, 1.0, b, 0.02);
                let rate = fit_weak(&TAUS, &errors, &covariance).unwrap();
                rate.lo <= 1.0 && 1.0 <= rate.hi
            })
            .count();
        assert!((176..200).contains(&covered), "{b}: {covered} of 200");
    }
}

#[test]
fn an_error_inside_the_noise_has_no_order() {
    let (errors, covariance) = weak(3, 1.0, 1e-3, 0.0, 1.0);
    assert!(fit_weak(&TAUS, &errors, &covariance).is_none());
    // A constant bias is no convergence: the order is far from one.
    let (errors, covariance) = weak(4, 0.0, 1.0, 0.0, 0.02);
    let rate = fit_weak(&TAUS, &errors, &covariance);
    assert_eq!(order_verdict(rate.as_ref(), 1.0), Verdict::Refuted);
}

#[test]
fn curvature_is_named_and_the_straight_line_refuted() {
    let squares = |curvature: f64| {
        let mut squares = CrossMoments::new(8);
        for path in 0..1000 {
            let mut noise = WienerPath::<1>::new(StreamKey { seed: 5, experiment: 3 }, path);
            let shared = noise.normal();
            squares.add(&TAUS.map(|tau| tau * (1.0 + curvature * tau) * (shared + 0.3 * noise.normal()).powi(2)));
        }
        squares
    };
    let curved = fit_strong(&TAUS, None, &squares(20.0)).unwrap();
    let line = curved.straight.as_ref().unwrap();
    assert!(line.refuted && line.lo > 0.5, "{line:?}");
    assert!(curved.lo < 0.5 && 0.5 < curved.hi && curved.curvature_t.unwrap() > 3.0, "{curved:?}");
    assert!(curved.method.contains("not yet asymptotic"), "{}", curved.method);
    let straight = fit_strong(&TAUS, None, &squares(0.0)).unwrap();
    let line = straight.straight.unwrap();
    assert!(!line.refuted && line.lo < 0.5 && 0.5 < line.hi, "{line:?}");
    assert!(straight.method.contains("do not contradict"), "{}", straight.method);
}

/// Squared errors of order one; path 123 has 30 times the error at the `hit` coarsest levels.
fn with_an_outlier(hit: usize) -> CrossMoments {
    let mut squares = CrossMoments::new(8);
    for path in 0..1000 {
        let mut noise = WienerPath::<1>::new(StreamKey { seed: 6, experiment: 3 }, path);
        let shared = noise.normal();
        let mut errors = TAUS.map(|tau| tau * tau * (shared + 0.5 * noise.normal()).powi(2));
        if path == 123 {
            errors[..hit].iter_mut().zip(&TAUS).for_each(|(error, tau)| *error = 2000.0 * tau * tau);
        }
        squares.add(&errors);
    }
    squares
}

#[test]
fn levels_that_one_path_dominates_are_left_out_and_named() {
    let rate = fit_strong(&TAUS, None, &with_an_outlier(2)).unwrap();
    assert_eq!(rate.left_out, TAUS[..2]);
    assert!(rate.effective_paths.unwrap() < 10.0 && rate.method.contains("left out"), "{}", rate.method);
    assert_eq!(order_verdict(Some(&rate), 1.0), Verdict::Holds);
    // The twin: with all levels the outlier bends the line.
    let logarithms =
        Logarithms::new(&TAUS, &with_an_outlier(2), (0..8).collect()).unwrap().fit(Terms::STRAIGHT).unwrap();
    assert!(logarithms.order > 1.05, "{}", logarithms.order);
}

#[test]
fn an_order_that_hangs_on_one_path_comes_with_a_wide_interval() {
    let few = fit_strong(&TAUS, None, &with_an_outlier(6)).unwrap();
    assert!(few.left_out.is_empty() && few.method.contains("wider of both"), "{}", few.method);
    let calm = fit_strong(&TAUS, None, &with_an_outlier(0)).unwrap();
    assert!(few.hi - few.lo > 5.0 * (calm.hi - calm.lo), "{few:?} {calm:?}");
    assert_eq!(order_verdict(Some(&few), 1.0), Verdict::Undecided);
}

#[test]
fn intervals_are_the_same_bits_every_time() {
    let squares = synthetic(1, 0.5, None);
    assert_eq!(fit_strong(&TAUS, None, &squares), fit_strong(&TAUS, None, &squares));
}
