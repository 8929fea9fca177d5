//! The arithmetic and the rules of the algorithm on samples that are made up.

use std::cell::RefCell;

use noise::{StreamKey, Truncation};
use real::{Block, PathMask};
use schemes::Heun;
use stats::{CentralMoments, ROUND_OFF};
use systems::{Constant, Pendulum, Problem};

use super::{
    algorithm::{Halt, Sampler},
    diagnosis::{Evidence, level_values},
    error::MultilevelError,
    level::{Drawn, PathValues, Samples, Sums, Values, hull},
    plan::{self, Term},
    report::{Estimate, Expectation, Judged, Level, LevelValue, QUANTILE, Rate, Warning},
    resolution::{Motion, coupled, is_near, share, unresolved},
    settings::{Coupling, Estimator, ExpectationSettings},
    tails::{Tail, UNSEEN, is_heavy, tails},
};
use crate::{Observable, Observe, SeenDamping, Statistic, View};

fn close(found: f64, exact: f64) -> bool {
    (found - exact).abs() <= 1e-12 * exact.abs()
}

fn moments(samples: &[f64]) -> CentralMoments {
    let mut moments = CentralMoments::default();
    samples.iter().for_each(|&x| moments.add(x));
    moments
}

/// Differences of fine and coarse values.
fn pairs(fine: &[f64], coarse: &[f64]) -> Values {
    let differences: Vec<f64> = fine.iter().zip(coarse).map(|(a, b)| a - b).collect();
    let (sample, fine, coarse) = (moments(&differences), moments(fine), moments(coarse));
    Values { sample, fine, coarse, ..Values::default() }
}

fn level(level: usize, paths: u64, values: Values) -> Samples {
    let coupling = (level > 0).then_some(Coupling::Plain);
    Samples {
        level,
        coupling,
        cost_per_path: 6 << level,
        values: vec![values],
        motion: Motion::default(),
        paths,
        failed: 0,
    }
}

/// Sample differences with this mean and these deviations from it, again and again.
fn difference(number: usize, mean: f64, deviations: &[f64], times: usize) -> Samples {
    let samples: Vec<f64> = deviations.iter().map(|x| mean + x).collect::<Vec<_>>().repeat(times);
    let values = Values { sample: moments(&samples), ..Values::default() };
    level(number, samples.len() as u64, values)
}

fn settings() -> ExpectationSettings {
    let key = StreamKey { seed: 1, experiment: 1 };
    ExpectationSettings::new(key, Truncation::none(), 4, Coupling::Plain)
}

#[test]
fn moments_of_four_numbers() {
    // Deviations −2, −1, 0, 3 of 3: Σx² = 14, Σx⁴ = 98.
    let four = moments(&[1.0, 2.0, 3.0, 6.0]);
    assert_eq!((four.mean(), four.range()), (3.0, Some((1.0, 6.0))));
    assert!(close(four.variance(), 14.0 / 3.0) && close(four.variance_of_mean(), 14.0 / 12.0));
    assert!(close(four.kurtosis(), 4.0 * 98.0 / 196.0));
    assert_eq!(four.largest_deviation(), 3.0);
    assert_eq!(moments(&[-1.0, -2.0, -3.0, -6.0]).largest_deviation(), 3.0);
    // Two numbers whose mean is rounded are equal all the same.
    assert_eq!(moments(&[0.1, 0.1, 0.1]).largest_deviation(), 0.0);
    let limit = (14.0f64 / 3.0).sqrt() / ROUND_OFF;
    assert!(four.is_spread(0.999 * limit) && !four.is_spread(1.001 * limit));
    assert_eq!(CentralMoments::default().range(), None);
}

#[test]
fn values_know_their_range_and_what_never_differs() {
    let values = pairs(&[1.0, 4.0], &[0.0, 2.0]);
    assert_eq!((values.range(), values.spread()), (Some((0.0, 4.0)), 4.0));
    assert!(!values.is_blind() && values.varies());
    assert!(pairs(&[1.0, 1.0], &[2.0, 2.0]).is_blind());
    assert!(!pairs(&[1.0, 1.0], &[2.0, 3.0]).is_blind());
    assert!(!pairs(&[1.0, 2.0], &[3.0, 3.0]).is_blind());
    assert!(Values::default().is_blind() && Values::default().spread() == 0.0);
    // Differences of a rounding of φ do not vary.
    assert!(!pairs(&[1.0, 1.0 + f64::EPSILON], &[1.0, 1.0]).varies());
    let mut merged = pairs(&[1.0], &[0.5]);
    merged.merge(&pairs(&[3.0], &[1.0]));
    assert_eq!((merged.range(), merged.sample.mean()), (Some((0.5, 3.0)), 1.25));
    assert_eq!(hull(None, Some((1.0, 2.0))), Some((1.0, 2.0)));
    assert_eq!(hull(Some((0.0, 1.0)), None), Some((0.0, 1.0)));
    assert_eq!(hull(None, None), None);
}

#[test]
fn path_values_are_those_of_the_runs() {
    let observable = Observable { name: "y", function: |y: [f64; 1]| 10.0 * y[0] };
    let observables = [&observable as &dyn Observe];
    let new = |coupled| PathValues {
        observables: &observables,
        y0: &[0.0],
        starts: &[0.0],
        last_time: 2,
        coupled,
        sums: Sums { values: vec![Values::default()], motion: Motion::new(&[0.0]) },
    };
    let observe = |states: &Vec<Block<1>>, times: &[u64]| {
        let mut seen = new(states.len() > 1);
        for &time in times {
            seen.observe(&View { time, ..View::of(states, PathMask::first(3)) });
        }
        seen
    };
    let state = |y: f64| Block::splat([y]);
    // Alone; with a coarse path; and with the twin, whose mean with the fine path counts.
    for (states, fine, sample) in [
        (vec![state(3.0)], 30.0, 30.0),
        (vec![state(3.0), state(2.0)], 30.0, 10.0),
        (vec![state(3.0), state(2.0), state(5.0)], 40.0, 20.0),
        (vec![state(3.0), state(2.0), state(5.0), state(1.0)], 40.0, 25.0),
    ] {
        let mut seen = observe(&states, &[1, 2]);
        assert_eq!(
            (seen.sums.values[0].fine.mean(), seen.sums.values[0].sample.mean()),
            (fine, sample)
        );
        // Motion is seen at all times, φ at the last; of single paths there is none.
        let apart = if states.len() == 1 { 0.0 } else { 0.1 * sample / 3.0 };
        assert!(close(seen.sums.motion.difference(0), apart));
        assert!(observe(&states, &[1]).sums.values[0].range().is_none());
        seen.merge(observe(&states, &[2]));
        assert_eq!(seen.sums.values[0].fine.variance(), 0.0);
    }
}

#[test]
fn sums_of_terms() {
    let tail = |size| Tail { size, enough: 90.0 };
    let terms = [
        Term { cost: 4.0, count: 4.0, mean: 1.0, variance: 1.0, tail: tail(3.0) },
        Term { cost: 6.0, count: 8.0, mean: 0.5, variance: 2.0, tail: tail(8.0) },
    ];
    assert_eq!((plan::variance_of_sum(&terms), plan::tail_of_sum(&terms)), (0.5, 1.25));
    assert!(close(plan::half_width(0.5, 1.25), (0.5 * QUANTILE * QUANTILE + 1.5625).sqrt()));
    // The next level costs twice as much, and its variance falls as the last one did: by a quarter
    // at most, for the order of the twin, and never up.
    for (before, last, fall) in
        [(2.0, 1.0, 0.5), (10.0, 1.0, 0.25), (1.0, 3.0, 1.0), (0.0, 1.0, 1.0)]
    {
        let [mut one, mut two] = terms;
        (one.variance, two.variance) = (before, last);
        let next = plan::next_level(&[terms[0], one, two]);
        assert_eq!((next.cost, next.variance), (12.0, last * fall), "{before} {last}");
        assert_eq!((next.count, next.tail), (8.0, tail(8.0)));
    }
    let samples = [difference(1, 0.5, &[-1.0, 1.0], 4)];
    let [Term { cost, count, mean, variance, .. }] = plan::terms(&samples, 0, 1.0)[..] else {
        panic!("one level is one term")
    };
    assert_eq!((cost, count, mean), (12.0, 8.0, 0.5));
    assert!(close(variance, 8.0 / 7.0));
}

/// The weighted line through (l, y, weight): slope and the half-width of its 95 % interval, by the
/// normal equations.
fn line(points: &[(f64, f64, f64)]) -> (f64, f64) {
    let sum =
        |f: &dyn Fn(f64, f64) -> f64| points.iter().map(|&(x, y, w)| w * f(x, y)).sum::<f64>();
    let (w, x, y) = (sum(&|_, _| 1.0), sum(&|x, _| x), sum(&|_, y| y));
    let (xx, xy) = (sum(&|x, _| x * x), sum(&|x, y| x * y));
    let determinant = w * xx - x * x;
    let slope = (w * xy - x * y) / determinant;
    let offset = (y - slope * x) / w;
    let chi_square = sum(&|x, y| (y - offset - slope * x).powi(2));
    let excess = (chi_square / (points.len() as f64 - 2.0)).max(1.0);
    (slope, QUANTILE * (excess * w / determinant).sqrt())
}

fn is_line(rate: Rate, points: &[(f64, f64, f64)]) -> bool {
    let (slope, half_width) = line(points);
    (rate.value + slope).abs() < 1e-9
        && (rate.upper - rate.value - half_width).abs() < 1e-9
        && (rate.value - rate.lower - half_width).abs() < 1e-9
}

#[test]
fn exponents_are_slopes_of_weighted_lines() {
    let ln_2 = std::f64::consts::LN_2;
    // On no line, with errors of different sizes; the fourth is within four standard errors.
    let means = [(1, 0.5, 100), (2, -0.2, 40), (3, 0.15, 400), (4, 0.004, 100)];
    for sign in [1.0, -1.0] {
        let of = |(l, mean, times): (usize, f64, usize)| {
            let mean = sign * if l == 2 { mean.abs() } else { mean };
            difference(l, mean, &[-0.05, -0.01, 0.01, 0.05], times)
        };
        let levels = means.map(of);
        let terms = plan::terms(&levels, 0, 1.0);
        let points: Vec<_> = terms[..3]
            .iter()
            .zip(1..)
            .map(|(term, l)| {
                let relative = term.variance / (term.count * term.mean.powi(2)) / ln_2.powi(2);
                (f64::from(l), term.mean.abs().log2(), 1.0 / relative)
            })
            .collect();
        assert!(is_line(plan::alpha(&levels, &terms, 0).unwrap(), &points));
    }
    // Variances: the variance of the logarithm of a sample variance is (κ − 1 + 1/N)/N.
    let levels = [(1, 1.0, 50), (2, 0.4, 100), (3, 0.3, 25)].map(|(l, size, times)| {
        difference(l, 0.0, &[-size, -0.5 * size, 0.2 * size, 1.3 * size], times)
    });
    let points: Vec<_> = levels
        .iter()
        .map(|samples| {
            let (moments, n) = (&samples.values[0].sample, samples.count() as f64);
            let relative = (moments.kurtosis() - 1.0 + 1.0 / n) / n / ln_2.powi(2);
            (samples.level as f64, moments.variance().log2(), 1.0 / relative)
        })
        .collect();
    assert!(is_line(plan::beta(&levels, 0).unwrap(), &points));
    assert_eq!(plan::beta(&levels[..1], 0), None);
    assert_eq!(plan::alpha(&levels, &plan::terms(&levels, 0, 1.0), 0), None);
}

/// Motion whose fine path moves by one and whose coarse path is `q` away from it.
fn moved(y0: f64, q: f64) -> Motion {
    let mut motion = Motion::new(&[y0]);
    let states = vec![Block::splat([y0 + 1.0]), Block::splat([y0 + 1.0 + q])];
    motion.add(&View::of(&states, PathMask::ALL), &[y0]);
    motion
}

#[test]
fn motion_is_compared_over_the_paths_that_live() {
    let mut motion = Motion::new(&[1.0, 0.0]);
    let states = |fine: f64, coarse: f64, twin: f64| {
        [fine, coarse, twin].map(|y| Block::splat([1.0 + y, 2.0 * y])).to_vec()
    };
    // Differences ½(2 + 4) − 1 = 2 and twice that, of motions 2 and 4.
    motion.add(&View::of(&states(2.0, 1.0, 4.0), PathMask::ALL), &[1.0, 0.0]);
    assert!(close(motion.difference(0), 1.0) && close(motion.difference(1), 1.0));
    // Three paths more with the difference 3 of the motion 1: √((32·4 + 3·9)/(32·4 + 3)).
    let few = PathMask::first(3);
    let exact = (155.0f64 / 131.0).sqrt();
    let mut merged = motion.clone();
    motion.add(&View::of(&states(1.0, -1.0, 3.0), few), &[1.0, 0.0]);
    assert!(close(motion.difference(0), exact) && close(motion.difference(1), exact));
    let mut later = Motion::new(&[1.0, 0.0]);
    later.add(&View::of(&states(1.0, -1.0, 3.0), few), &[1.0, 0.0]);
    merged.merge(&later);
    assert!(close(merged.difference(0), exact));
    let mut none = Motion::default();
    none.merge(&later);
    assert!(close(none.difference(0), 3.0));
    // A single path shows nothing.
    let mut alone = Motion::new(&[1.0, 0.0]);
    let single = states(2.0, 0.0, 0.0)[..1].to_vec();
    alone.add(&View::of(&single, PathMask::ALL), &[1.0, 0.0]);
    assert_eq!(alone.difference(0), 0.0);
}

#[test]
fn round_off_of_the_state_is_no_difference() {
    // ROUND_OFF is 4096 roundings, 9e-13, of √(y₀² + 1).
    for y0 in [0.0, 1.0, 1000.0f64] {
        let size = (y0 * y0 + 1.0).sqrt() * ROUND_OFF;
        assert_eq!(moved(y0, 0.5 * size).difference(0), 0.0, "{y0}");
        assert!((moved(y0, 2.0 * size).difference(0) / (2.0 * size) - 1.0).abs() < 0.2, "{y0}");
    }
}

/// Three levels whose paths differ by these quotients.
fn quotients(of: [f64; 3]) -> Vec<Samples> {
    let with = |(l, q): (usize, f64)| Samples {
        motion: moved(0.0, q),
        ..level(l, 64, pairs(&[1.0, 2.0], &[1.5, 1.0]))
    };
    (1..).zip(of).map(with).collect()
}

#[test]
fn a_motion_is_resolved_when_the_last_paths_agree_and_better_than_those_below() {
    // Near: at most ½ on the last level, 1/√2 on the one below and 1 on the one below that.
    for (of, near, resolved) in [
        ([0.99, 0.69, 0.48], true, true),
        ([1.01, 0.5, 0.3], false, false),
        ([0.5, 0.72, 0.3], false, false),
        ([0.5, 0.5, 0.51], false, false),
        // Not below 1/√2 of the larger of those below.
        ([0.4, 0.3, 0.27], true, true),
        ([0.3, 0.4, 0.27], true, true),
        ([0.4, 0.3, 0.29], true, false),
        ([1.2, 1.2, 0.0], false, true),
    ] {
        let levels = quotients(of);
        assert_eq!(is_near(&levels), near, "{of:?}");
        let found = unresolved(&levels);
        assert_eq!(found.is_none(), resolved, "{of:?}");
        if let Some(found) = found {
            let before = f64::max(of[0], of[1]);
            assert!(close(found.last, of[2]) && close(found.before, before), "{of:?}");
            assert_eq!(found.component, 0);
        }
    }
    let two = &quotients([0.1; 3])[..2];
    assert!(!is_near(two) && unresolved(two).is_none());
}

#[test]
fn a_test_function_is_coupled_where_its_differences_are_small_or_do_not_matter() {
    // The differences of ±1 and ±(1 − d) are ±d: a share d²/(1 + (1 − d)²) of the variances, ¼ for
    // d = (√7 − 1)/3.
    let of = |d: f64| pairs(&[-1.0, 1.0], &[d - 1.0, 1.0 - d]);
    assert!(close(share(&of(0.5)), 0.25 / 1.25));
    let limit = (7f64.sqrt() - 1.0) / 3.0;
    assert!(coupled(&of(limit - 0.01), 0.1) && !coupled(&of(limit + 0.01), 0.1));
    // A range of two.
    assert!(coupled(&of(limit + 0.01), 2.0) && !coupled(&of(limit + 0.01), 1.99));
}

#[test]
fn tails_reach_as_far_as_what_was_seen_on_a_level_or_below() {
    // Kurtosis 1 of ±1: thirty samples are enough.
    let heavy = |times: usize| difference(1, 0.0, &[-1.0, 1.0], times);
    let of = |samples: Samples| tails(&[samples], 0, 9.0)[0];
    let is =
        |tail: Tail, size: f64, enough: f64| close(tail.size, size) && close(tail.enough, enough);
    assert!(is(of(heavy(14)), UNSEEN, 30.0) && is(of(heavy(16)), 0.0, 30.0));
    // Single paths reach over the range of φ, and a level without a difference too.
    let single = Samples { coupling: None, ..heavy(14) };
    assert!(is(of(single), 9.0 * UNSEEN, 30.0));
    let still = difference(1, 0.0, &[0.0], 10);
    assert!(is(of(still), 9.0 * UNSEEN, 300.0));
    // Below: a larger deviation, and a larger kurtosis, 2 of −2, −1, 0, 3.
    let below = difference(1, 0.0, &[-2.0, -1.0, 0.0, 3.0], 20);
    let both = tails(&[below, Samples { level: 2, ..heavy(29) }], 0, 9.0);
    assert_eq!(both[0].size, 0.0);
    assert!(close(both[1].enough, 60.0) && close(both[1].size, 3.0 * UNSEEN), "{both:?}");
}

#[test]
fn paths_are_heavy_below_thirty_that_carry_the_variance() {
    let of = |values: &[f64], times: usize| {
        let fine = values.repeat(times);
        level(0, fine.len() as u64, Values { fine: moments(&fine), ..Values::default() })
    };
    // Kurtosis 2: sixty samples.
    let four = [-2.0, -1.0, 0.0, 3.0];
    assert!(is_heavy(&of(&four, 14), 0) && !is_heavy(&of(&four, 16), 0));
    assert!(!is_heavy(&of(&[-1.0, 1.0], 4), 0));
}

#[test]
fn neighbours_are_compared_in_standard_errors() {
    // Fine values 0 and 2 below, coarse values 3 and 5 above, eight of each.
    let below = level(1, 8, pairs(&[0.0, 2.0].repeat(4), &[0.0; 8]));
    let above = level(2, 8, pairs(&[7.0, 9.0].repeat(4), &[3.0, 5.0].repeat(4)));
    let levels = [below, above];
    let [value] = level_values(&levels, &levels[1])[..] else { panic!("one test function") };
    // Variances 8/7 over 8 each: 3 is 3/√(2/7) of their standard errors.
    assert!(close(value.deviation, 3.0 / (2.0f64 / 7.0).sqrt()));
    assert_eq!((value.mean, value.variance), (4.0, 0.0));
    assert!(value.kurtosis.is_nan());
    let [lowest] = level_values(&levels, &levels[0])[..] else { panic!("one test function") };
    assert_eq!((lowest.deviation, lowest.mean), (0.0, 1.0));
    assert!(close(lowest.kurtosis, 1.0));
    // What never varies is compared in 64 roundings.
    let same = level(1, 8, pairs(&[1.0; 8], &[0.0; 8]));
    let rounded = level(2, 8, pairs(&[2.0; 8], &[1.0 + 1024.0 * f64::EPSILON; 8]));
    let levels = [same, rounded];
    assert!(close(level_values(&levels, &levels[1])[0].deviation, 16.0));
}

fn rate(lower: f64, upper: f64) -> Option<Rate> {
    Some(Rate { value: 0.5 * (lower + upper), lower, upper })
}

/// What is said of three levels of differences above single paths, with these properties of the
/// last one.
fn judged(value: LevelValue, samples: u64, estimate: &Estimate) -> (Judged, Vec<Warning>) {
    judged_at([0.1, 0.05, 0.02], value, samples, estimate)
}

/// The same with these quotients of the motion.
fn judged_at(
    motion: [f64; 3],
    value: LevelValue,
    samples: u64,
    estimate: &Estimate,
) -> (Judged, Vec<Warning>) {
    let mut levels = vec![level(0, 64, pairs(&[1.0, 2.0, 4.0], &[]))];
    levels[0].values[0].sample = moments(&[1.0, 2.0, 4.0].repeat(60));
    levels[0].paths = 180;
    levels.extend(quotients(motion));
    let good = LevelValue { mean: 0.0, variance: 1.0, kurtosis: 3.0, deviation: 0.0 };
    let report = |l: usize, samples: u64, value: LevelValue| Level {
        level: l,
        tau: 1.0,
        coupling: levels[l].coupling,
        samples,
        failed: 0,
        cost_per_path: 1,
        values: vec![value],
    };
    let mut reports: Vec<_> = (0..3).map(|l| report(l, 180, good)).collect();
    reports.push(report(3, samples, value));
    let evidence = Evidence {
        levels: &levels,
        first: 0,
        terms: 4,
        accuracy: 1e9,
        order: 1.0,
        damping: None,
        random: true,
    };
    let mut estimates = [estimate.clone()];
    let warnings = evidence.judge(&reports, &mut estimates);
    (estimates[0].judged, warnings)
}

#[test]
fn each_assumption_is_judged_at_its_limit() {
    let estimate = Estimate {
        quantile: QUANTILE,
        name: "phi".into(),
        value: 0.0,
        standard_error: 0.0,
        bias: 0.0,
        bias_bound: 0.0,
        missed: 0.0,
        alpha: rate(0.9, 1.1),
        beta: rate(1.8, 2.2),
        failed: 0,
        judged: Judged::default(),
    };
    let good = LevelValue { mean: 0.0, variance: 1.0, kurtosis: 3.0, deviation: 0.0 };
    let all = Judged { variance: true, bias: true, resolution: true };
    assert_eq!(judged(good, 1000, &estimate), (all, vec![]));
    // Components are counted from one.
    let (coarse, warnings) = judged_at([1.2, 1.3, 0.75], good, 1000, &estimate);
    assert_eq!(coarse, Judged { resolution: false, ..all });
    let [Warning::Unresolved { component: 1, level: 3, difference, before }] = warnings[..] else {
        panic!("{warnings:?}")
    };
    assert!(close(difference, 0.75) && close(before, 1.3));
    // Four and a half standard errors between neighbours.
    let deviation = |deviation: f64| judged(LevelValue { deviation, ..good }, 1000, &estimate);
    assert_eq!(deviation(4.5), (all, vec![]));
    let (apart, warnings) = deviation(4.6);
    assert_eq!(apart, Judged { bias: false, ..all });
    assert!(matches!(warnings[..], [Warning::Inconsistent { level: 3, .. }]));
    // A weak order below the one given by more than a quarter is named, and below ½ not believed.
    let alpha =
        |upper: f64| judged(good, 1000, &Estimate { alpha: rate(0.1, upper), ..estimate.clone() });
    assert_eq!(alpha(0.76), (all, vec![]));
    let (named, warnings) = alpha(0.74);
    assert!(named == all && matches!(warnings[..], [Warning::WeakOrder { .. }]));
    let (slow, warnings) = alpha(0.49);
    assert_eq!(slow, Judged { bias: false, ..all });
    assert!(matches!(warnings[..], [Warning::WeakOrder { .. }]));
}

#[test]
fn an_interval_adds_the_bias_to_the_rest() {
    let estimate = Estimate {
        quantile: QUANTILE,
        name: "phi".into(),
        value: 2.0,
        standard_error: 3.0 / QUANTILE,
        bias: 0.0,
        bias_bound: 1.0,
        missed: 4.0,
        alpha: None,
        beta: None,
        failed: 0,
        judged: Judged { variance: true, bias: true, resolution: true },
    };
    assert!(close(estimate.half_width(), 6.0));
    let (lower, upper) = estimate.interval();
    assert!(close(lower, -4.0) && close(upper, 8.0));
    let result = |accuracy: f64, judged: Judged| Expectation {
        scheme: "sexp",
        decisions: Vec::new(),
        estimates: vec![Estimate { judged, ..estimate.clone() }],
        accuracy,
        cost: 0,
        levels: vec![],
        warnings: vec![],
    };
    let all = estimate.judged;
    assert!(result(6.001, all).reached() && !result(5.999, all).reached());
    for one in [
        Judged { variance: false, ..all },
        Judged { bias: false, ..all },
        Judged { resolution: false, ..all },
    ] {
        assert!(!result(7.0, one).reached());
    }
}

#[test]
fn settings_are_allowed_up_to_their_limits() {
    let good = settings();
    let key = |experiment| StreamKey { experiment, ..good.key };
    let allowed = |settings: ExpectationSettings| settings.check(0.1).is_ok();
    for coarsest_steps in [1, 1 << 24] {
        assert!(allowed(ExpectationSettings { coarsest_steps, ..good }));
    }
    assert!(!allowed(ExpectationSettings { coarsest_steps: (1 << 24) + 1, ..good }));
    for max_level in [3, 24] {
        assert!(allowed(ExpectationSettings { max_level, ..good }));
    }
    assert!(allowed(ExpectationSettings { pilot: 128, ..good }));
    assert!(allowed(ExpectationSettings { key: key((1 << 40) - 1), ..good }));
    assert!(!allowed(ExpectationSettings { key: key(1 << 40), ..good }));
    assert_eq!((good.steps(0), good.steps(3)), (4, 32));
}

/// Level l of a made-up problem: φ is one third on average, with the bias −2^{−l}/10 and the
/// variance one; the differences have the standard deviation 2^{−l}.
fn made_up(level: &Samples, paths: u64) -> Drawn {
    let mut values = Values::default();
    let mut motion = Motion::new(&[0.0]);
    let size = |l: usize| 0.5f64.powi(l as i32);
    let mean = |l: usize| (1.0 - 0.3 * size(l)) / 3.0;
    let l = level.level;
    // Numbers of two steps of one golden ratio each: nearly uniform, of variance one.
    let uniform = |n: u64, ratio: f64| 12f64.sqrt() * ((n as f64 * ratio).fract() - 0.5);
    for n in 1..=paths {
        let (shared, own) =
            (uniform(n, 0.618_033_988_749_894_8), uniform(n, 0.414_213_562_373_095_1));
        let fine = mean(l) + shared;
        values.fine.add(fine);
        match level.coupling {
            None => values.sample.add(fine),
            Some(_) => {
                let coarse = mean(l - 1) + shared - size(l) * own;
                values.coarse.add(coarse);
                values.sample.add(fine - coarse);
            }
        }
    }
    let states = [Block::splat([1.0]), Block::splat([1.0 + 0.2 * size(l)])];
    let runs = if level.coupling.is_some() { 2 } else { 1 };
    motion.add(&View::of(&states[..runs].to_vec(), PathMask::ALL), &[0.0]);
    Drawn { sums: Sums { values: vec![values], motion }, failed: 0, first_failure: None }
}

/// Of every round its level, whether of differences, and the number of paths.
type Rounds = Vec<(usize, bool, u64)>;

/// The result on the made-up problem, with its rounds.
fn run(
    accuracy: f64,
    settings: &ExpectationSettings,
) -> (Result<Expectation, MultilevelError>, Rounds) {
    let rounds = RefCell::new(Vec::new());
    let draw = |level: &Samples, paths: u64, _: u64| {
        rounds.borrow_mut().push((level.level, level.coupling.is_some(), paths - level.paths));
        Ok(Some(made_up(level, paths)))
    };
    let undamped = Constant::new(0.0).unwrap();
    let problem = Problem::new(Pendulum::new(1.0).unwrap(), undamped, [0.2, 1.0], 2.0).unwrap();
    let sampler = Sampler {
        scheme: "sexp",
        draw: &draw,
        t_end: 2.0,
        damping: SeenDamping::new(&crate::Setup::of(&problem, &Heun), settings.coarsest_steps),
        names: vec!["phi".into()],
        accuracy,
        settings,
        ranges: vec![None],
        cost: 0,
        reserve: 0,
        stopped: &|| false,
    };
    let result = sampler.expectation().map_err(|halt| match halt {
        Halt::Error(error) => error,
        Halt::Elsewhere => unreachable!("all samples are drawn here"),
    });
    (result, rounds.into_inner())
}

#[test]
fn the_accuracy_is_reached_with_little_more_than_it_takes() {
    for estimator in [Estimator::Multilevel, Estimator::SinglePaths] {
        for accuracy in [0.05, 0.02, 0.01] {
            let settings = ExpectationSettings { estimator, pilot: 256, ..settings() };
            let (result, rounds) = run(accuracy, &settings);
            let result = result.unwrap();
            let estimate = &result.estimates[0];
            assert!(result.reached() && result.warnings.is_empty(), "{result:?}");
            let (lower, upper) = estimate.interval();
            assert!(lower < 1.0 / 3.0 && 1.0 / 3.0 < upper, "{result:?}");
            // The bias has a quarter at most, and the rest is used up to the pilots.
            assert!(estimate.bias_bound <= 0.25 * accuracy, "{estimate:?}");
            assert!(estimate.half_width() > 0.5 * accuracy, "{estimate:?}");
            // What is reported is what was drawn.
            let drawn = |l: usize, coupled: bool| -> u64 {
                let of_level = rounds.iter().filter(|round| (round.0, round.1) == (l, coupled));
                of_level.map(|round| round.2).sum()
            };
            let mut cost = 0;
            for level in &result.levels {
                let steps = 4u64 << level.level;
                let per_path = if level.coupling.is_some() { steps + steps / 2 } else { steps };
                assert_eq!((level.cost_per_path, level.tau), (per_path, 2.0 / steps as f64));
                assert_eq!(level.samples, drawn(level.level, level.coupling.is_some()));
                cost += level.samples * per_path;
            }
            assert_eq!(result.cost, cost);
            // Whole groups, and each round adds a 32nd or more.
            assert!(rounds.iter().all(|&(.., paths)| paths.is_multiple_of(128)), "{rounds:?}");
            let terms = if estimator == Estimator::Multilevel { result.levels.len() } else { 1 };
            let summed = &result.levels[..terms];
            let value: f64 = summed.iter().map(|level| level.values[0].mean).sum();
            let variances =
                summed.iter().map(|level| level.values[0].variance / level.samples as f64);
            assert!(close(estimate.value, value));
            assert!(close(estimate.standard_error, variances.sum::<f64>().sqrt()));
            assert_eq!(estimate.missed, 0.0);
            // −2^{−L}/10 is missing at the finest step.
            let finest = result.levels.iter().map(|level| level.level).max().unwrap();
            let bias = 0.1 * 0.5f64.powi(finest as i32);
            assert!(
                bias < estimate.bias_bound
                    && (estimate.bias - bias).abs() < bias + estimate.bias_bound
            );
        }
    }
}

#[test]
fn a_finer_level_is_added_until_the_bias_is_small() {
    // −2^{−L}/10 below a quarter of the accuracy, with its half-width.
    let finest = |accuracy: f64| {
        let settings = ExpectationSettings { pilot: 2048, ..settings() };
        let (result, _) = run(accuracy, &settings);
        result.unwrap().levels.last().unwrap().level
    };
    let levels = [0.1, 0.02, 0.004].map(finest);
    for (level, accuracy) in levels.into_iter().zip([0.1, 0.02, 0.004]) {
        let least = f64::log2(0.1 / (0.25 * accuracy)).ceil().max(3.0) as usize;
        assert!((least..=least + 2).contains(&level), "{accuracy}: {level}, {least}");
    }
}

#[test]
fn limits_end_the_algorithm_with_an_estimate() {
    for estimator in [Estimator::Multilevel, Estimator::SinglePaths] {
        let settings = ExpectationSettings { estimator, pilot: 256, ..settings() };
        let (free, _) = run(0.002, &settings);
        let enough = free.unwrap().cost;
        for max_cost in [enough / 2, enough / 5, 30_000, 25_000, 22_000, 20_000] {
            let limited = ExpectationSettings { max_cost, ..settings };
            let (result, rounds) = run(0.002, &limited);
            let result = result.unwrap();
            assert!(result.cost <= max_cost && !result.reached(), "{max_cost}: {result:?}");
            assert!(result.warnings.contains(&Warning::CostLimit { max_cost }), "{result:?}");
            // No level is begun that has no paths.
            assert!(result.levels.iter().all(|level| level.samples > 0), "{result:?}");
            // The first pilot of single paths is reserved for.
            if estimator == Estimator::SinglePaths {
                let (_, _, paths) = rounds.iter().find(|round| !round.1).unwrap();
                assert!(*paths >= 256, "{max_cost}: {rounds:?}");
            }
        }
        let few = ExpectationSettings { max_level: 3, ..settings };
        let (result, _) = run(0.01, &few);
        let result = result.unwrap();
        assert!(result.warnings.contains(&Warning::LevelLimit { level: 3 }), "{result:?}");
        // The pilot of levels 1 and 2 and, of single paths, of level 2, or of level 0.
        let cost = match estimator {
            Estimator::Multilevel => 256 * (4 + 12 + 24),
            Estimator::SinglePaths => 256 * (12 + 24 + 16),
        };
        for (max_cost, fits) in [(cost, true), (cost - 1, false)] {
            let (result, _) = run(0.01, &ExpectationSettings { max_cost, ..settings });
            assert_eq!(result.is_ok(), fits, "{result:?}");
            if let Err(error) = result {
                assert_eq!(error, MultilevelError::PilotCost { pilot_cost: cost, max_cost });
            }
        }
    }
}
