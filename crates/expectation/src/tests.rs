//! The arithmetic and the rules of the algorithm on samples that are made up.

use noise::StepNoise;
use nonlin::BlockStatus;
use real::{Block, PathMask, Row, WIDTH};
use schemes::{Heun, Step, Stepper};
use stats::{CentralMoments, ROUND_OFF};
use systems::{Constant, Pendulum, Problem};

use super::{
    extrapolation::{Extrapolation, alpha, beta},
    judge::{Evidence, deviation},
    level::{PathValues, Samples, Values, hull},
    report::{Estimate, Expectation, Judged, QUANTILE, Rate, Warning, WarningKind},
    resolution::{Motion, coupled, part, share, unresolved},
    rules::UNSEEN,
    sum::{Sum, Term},
};
use mc::{DampingResolution, Observable, Observe, Setup, Statistic, View};

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

/// A level of one replicate, whose variance is not known.
fn level(level: usize, paths: u64, values: Values) -> Samples {
    let (cost_per_path, means) = (6 << level, vec![Default::default()]);
    let (values, functions) = (vec![values], Motion::new(&[0.0]));
    let points = paths;
    Samples { level, cost_per_path, values, paths, points, means, functions, ..Samples::default() }
}

/// Sample differences with this mean and these deviations from it, again and again.
fn difference(number: usize, mean: f64, deviations: &[f64], times: usize) -> Samples {
    let samples: Vec<f64> = deviations.iter().map(|x| mean + x).collect::<Vec<_>>().repeat(times);
    let values = Values { sample: moments(&samples), ..Values::default() };
    level(number, samples.len() as u64, values)
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
    let hull = |a: Option<(f64, f64)>, b| hull(a.into_iter().chain(b));
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
        last_time: 2,
        coupled,
        values: vec![Values::default()],
        motion: [(); 3].map(|()| Motion::new(&[0.0])),
        functions: Motion::new(&[0.0]),
    };
    let observe = |states: &Vec<Block<1>>, times: &[u64]| {
        let mut seen = new(states.len() > 1);
        for &time in times {
            show(states, time, PathMask::first(3), &mut |view| seen.observe(view));
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
        assert_eq!((seen.values[0].fine.mean(), seen.values[0].sample.mean()), (fine, sample));
        // Motion is seen at all times, φ at the last; of single paths there is none.
        let apart = if states.len() == 1 { 0.0 } else { 0.1 * sample / 3.0 };
        assert!(close(seen.motion[0].difference(0), apart));
        assert!(observe(&states, &[1]).values[0].range().is_none());
        seen.merge(observe(&states, &[2]));
        assert_eq!(seen.values[0].fine.variance(), 0.0);
    }
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
        let term = |samples: &Samples| {
            let sample = &samples.values[0].sample;
            let (mean, variance) = (sample.mean(), sample.variance_of_mean());
            Term { mean, variance, ..Term::default() }
        };
        let terms: Vec<Term> = levels.iter().map(term).collect();
        let point = |(term, l): (&Term, i32)| {
            let relative = term.variance / term.mean.powi(2) / ln_2.powi(2);
            (f64::from(l), term.mean.abs().log2(), 1.0 / relative)
        };
        let points: Vec<_> = terms[..3].iter().zip(1..).map(point).collect();
        assert!(is_line(alpha(&levels, &terms, 0).unwrap(), &points));
        // No rate is named where significant signs differ, though |d_l| falls.
        let mut signs = terms.clone();
        signs[1].mean *= -1.0;
        assert_eq!(alpha(&levels, &signs, 0), None);
        // What was missed counts as an error.
        let missed: Vec<Term> = terms.iter().map(|term| Term { missed: 1.0, ..*term }).collect();
        assert_eq!(alpha(&levels, &missed, 0), None);
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
    assert!(is_line(beta(&levels, 0).unwrap(), &points));
    assert_eq!(beta(&levels[..1], 0), None);
}

/// Sixteen replicates of skewness g: Hall's term of the two-sided coverage, by hand.
#[test]
fn a_skew_mean_has_a_wider_interval() {
    let sum = |third: f64| Sum {
        terms: vec![Term { variance: 0.25, third, ..Term::default() }],
        extrapolation: Extrapolation { weights: [0.0; 2], size: 0.0, standard_error: 0.0 },
        single: false,
        replicates: 16.0,
        confidence: 0.95,
        lost: 0.0,
        rounding: 0.0,
        beside: 0.0,
    };
    // Student's quantile of fifteen degrees of freedom, of tables.
    let x: f64 = 2.131_449_546;
    assert!((sum(0.0).quantile() - x).abs() < 1e-8);
    // The variance of a replicate is four, its third moment 8g.
    for g in [1.5, -1.5] {
        let more = x * (x.powi(4) + 2.0 * x * x - 3.0) * g * g / (18.0 * 16.0);
        assert!((sum(8.0 * g).quantile() - x - more).abs() < 1e-7, "{g}");
    }
}

/// Motion whose fine path moves by one and whose coarse path is `q` away from it.
fn moved(y0: f64, q: f64) -> Motion {
    let mut motion = Motion::new(&[y0]);
    let states = vec![Block::splat([y0 + 1.0]), Block::splat([y0 + 1.0 + q])];
    show(&states, 1, PathMask::ALL, &mut |view| motion.add(view));
    motion
}

#[test]
fn motion_is_compared_over_the_paths_that_live() {
    let mut motion = Motion::new(&[1.0, 0.0]);
    let states = |fine: f64, coarse: f64, twin: f64| {
        [fine, coarse, twin].map(|y| Block::splat([1.0 + y, 2.0 * y])).to_vec()
    };
    // Differences ½(2 + 4) − 1 = 2 and twice that, of motions 2 and 4.
    show(&states(2.0, 1.0, 4.0), 1, PathMask::ALL, &mut |view| motion.add(view));
    assert!(close(motion.difference(0), 1.0) && close(motion.difference(1), 1.0));
    // Three paths more with the difference 3 of the motion 1: √((32·4 + 3·9)/(32·4 + 3)).
    let few = PathMask::first(3);
    let exact = (155.0f64 / 131.0).sqrt();
    let mut merged = motion.clone();
    show(&states(1.0, -1.0, 3.0), 1, few, &mut |view| motion.add(view));
    assert!(close(motion.difference(0), exact) && close(motion.difference(1), exact));
    let mut later = Motion::new(&[1.0, 0.0]);
    show(&states(1.0, -1.0, 3.0), 1, few, &mut |view| later.add(view));
    merged.merge(&later);
    assert!(close(merged.difference(0), exact));
    let mut none = Motion::default();
    none.merge(&later);
    assert!(close(none.difference(0), 3.0));
    // A single path shows nothing.
    let mut alone = Motion::new(&[1.0, 0.0]);
    let single = states(2.0, 0.0, 0.0)[..1].to_vec();
    show(&single, 1, PathMask::ALL, &mut |view| alone.add(view));
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
        motion: [moved(0.0, q), Motion::new(&[0.0]), Motion::new(&[0.0])],
        ..level(l, 64, pairs(&[1.0, 2.0], &[1.5, 1.0]))
    };
    (1..).zip(of).map(with).collect()
}

/// Warnings of what the steps of these levels do not resolve, without damping.
fn found(levels: &[Samples], accuracy: f64) -> Vec<Warning> {
    found_of(levels, (accuracy, false))
}

fn found_of(levels: &[Samples], wanted: (f64, bool)) -> Vec<Warning> {
    let undamped = Constant::new(0.0).unwrap();
    let problem = Problem::new(Pendulum::new(1.0).unwrap(), undamped, [0.2, 1.0], 2.0).unwrap();
    let damping = DampingResolution::new(&Setup::of(&problem, &Heun), 4);
    unresolved(levels, (&damping, None, 0.0), &["phi"], wanted)
}

#[test]
fn a_motion_is_resolved_when_the_last_paths_agree_and_better_than_those_below() {
    // Near: at most ½ on the last level, 1/√2 on the one below and 1 on the one below that.
    for (of, resolved) in [
        ([0.99, 0.69, 0.48], true),
        ([1.01, 0.5, 0.3], false),
        ([0.5, 0.72, 0.3], false),
        ([0.5, 0.5, 0.51], false),
        // Not below 1/√2 of the larger of those below.
        ([0.4, 0.3, 0.27], true),
        ([0.3, 0.4, 0.27], true),
        ([0.4, 0.3, 0.29], false),
    ] {
        let found = found(&quotients(of), 9.0);
        assert_eq!(found.is_empty(), resolved, "{of:?}");
        if !resolved {
            let [Warning { kind, ref message, .. }] = found[..] else { panic!("{found:?}") };
            assert_eq!(kind, WarningKind::Component(1));
            assert!(message.to_string().contains(&format!(
                "y1: on level 3 fine and coarse paths differ by {:.1e}",
                of[2]
            )));
        }
    }
    assert!(found(&quotients([0.1; 3])[..2], 9.0).is_empty());
}

#[test]
fn paths_that_part_are_resolved_where_they_begin() {
    // Motion of size `size` up to T/8, with 32 sums.
    let empty = |of: [f64; 3], early: [f64; 3], size: f64, paths: u64| {
        let mut levels = quotients(of);
        for (samples, q) in levels.iter_mut().zip(early) {
            let states = [1.0, 1.0 + q].map(|y| Block::splat([size * y])).to_vec();
            let motion = &mut samples.motion[1];
            show(&states, 1, PathMask::ALL, &mut |view| motion.add(view));
            samples.paths = paths;
        }
        found(&levels, 9.0).is_empty()
    };
    let (apart, near) = ([1.4; 3], [0.1, 0.05, 0.02]);
    assert!(empty(apart, near, 0.11, 4));
    // Not a tenth of the motion, fewer than eight times, and not resolved there either.
    assert!(!empty(apart, near, 0.09, 4) && !empty(apart, near, 1.0, 5));
    assert!(!empty(apart, [0.1, 0.2, 0.51], 1.0, 4));
    // Finer steps help.
    assert!(!empty([1.4, 1.2, 0.98], near, 1.0, 4) && empty([1.4, 1.2, 1.0], near, 1.0, 4));
    // Up to T, T/8 and T/64.
    assert_eq!([64, 9, 8, 2, 1].map(|time| part(time, 64)), [0, 0, 1, 1, 2]);
}

#[test]
fn of_single_paths_the_means_agree() {
    let (resolved, d) = ([0.1, 0.05, 0.02], 0.9);
    let of = |mean: f64, single: bool| {
        let mut levels = quotients(resolved);
        for samples in &mut levels {
            samples.values = vec![pairs(&[0.0, 1.0], &[1.0 + mean, mean])];
        }
        found_of(&levels, (d, single)).is_empty()
    };
    // Differences −1 − mean and 1 − mean, of variance two.
    assert!(of(0.7, true) && !of(0.72, true) && !of(0.0, false));
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
    let mut levels = quotients([0.1, 0.05, 0.02]);
    levels[2].values = vec![of(limit + 0.01)];
    let named = |warning: &Warning| warning.kind == WarningKind::Function;
    assert!(found(&levels, 0.1).iter().any(named) && found(&levels, 2.0).is_empty());
}

#[test]
fn missed_events_reach_as_far_as_what_was_seen_on_a_level_or_below() {
    // Kurtosis 1 of ±1: thirty samples are enough.
    let heavy = |times: usize| difference(1, 0.0, &[-1.0, 1.0], times);
    let of = |samples: Samples| Term::differences(&[samples], 0, 9.0)[0].missed;
    assert!(close(of(heavy(14)), UNSEEN / 28.0) && of(heavy(16)) == 0.0);
    // φ itself reaches over its range, and a level without a difference too.
    let fine = |times: usize| {
        let fine = [-1.0, 1.0].repeat(times);
        level(0, fine.len() as u64, Values { fine: moments(&fine), ..Values::default() })
    };
    assert!(close(Term::first(&fine(14), 0, 9.0).missed, 9.0 * UNSEEN / 28.0));
    assert_eq!(Term::first(&fine(16), 0, 9.0).missed, 0.0);
    assert!(close(of(difference(1, 0.0, &[0.0], 10)), 9.0 * UNSEEN / 10.0));
    // Below: a larger deviation, and a larger kurtosis, 2 of −2, −1, 0, 3.
    let below = difference(1, 0.0, &[-2.0, -1.0, 0.0, 3.0], 20);
    let both = Term::differences(&[below, Samples { level: 2, ..heavy(29) }], 0, 9.0);
    assert!(both[0].missed == 0.0 && close(both[1].missed, 3.0 * UNSEEN / 58.0), "{both:?}");
}

/// P(X ≤ k), X Poisson with mean λ.
fn poisson(k: i32, mean: f64) -> f64 {
    let terms = (0..=k).scan((-mean).exp(), |term, j| {
        let now = *term;
        *term *= mean / f64::from(j + 1);
        Some(now)
    });
    terms.sum()
}

#[test]
fn poisson_numbers_are_covered_with_what_was_missed_and_not_without() {
    let covered = |mean: f64, missed: bool| {
        let inside = |k: i32| {
            let k = f64::from(k);
            let tail = if missed && k < 30.0 { UNSEEN } else { 0.0 };
            (k - mean).abs() <= (1.96 * 1.96 * k + tail * tail).sqrt()
        };
        let probability =
            |k: i32| poisson(k, mean) - if k > 0 { poisson(k - 1, mean) } else { 0.0 };
        (0..200).filter(|&k| inside(k)).map(probability).sum::<f64>()
    };
    for tenths in 1..800 {
        let mean = 0.1 * f64::from(tenths);
        assert!(covered(mean, true) > 0.925, "{mean}: {}", covered(mean, true));
    }
    // An interval of no width where no event is seen.
    assert!(covered(1.0, false) < 0.65 && covered(3.0, false) < 0.91);
}

#[test]
fn paths_are_heavy_below_thirty_that_carry_the_variance() {
    let of = |values: &[f64], times: usize| {
        let fine = values.repeat(times);
        Values { fine: moments(&fine), ..Values::default() }
    };
    // Kurtosis 2: sixty samples.
    let four = [-2.0, -1.0, 0.0, 3.0];
    assert!(of(&four, 14).is_heavy() && !of(&four, 16).is_heavy());
    assert!(!of(&[-1.0, 1.0], 4).is_heavy());
}

#[test]
fn neighbours_are_compared_in_standard_errors() {
    // Fine values 0 and 2 below, coarse values 3 and 5 above, eight of each.
    let below = level(1, 8, pairs(&[0.0, 2.0].repeat(4), &[0.0; 8]));
    let above = level(2, 8, pairs(&[7.0, 9.0].repeat(4), &[3.0, 5.0].repeat(4)));
    // Variances 8/7 over 8 each: 3 is 3/√(2/7) of their standard errors.
    assert!(close(deviation(&below, &above, 0), 3.0 / (2.0f64 / 7.0).sqrt()));
    // What never varies is compared in 64 roundings.
    let same = level(1, 8, pairs(&[1.0; 8], &[0.0; 8]));
    let rounded = level(2, 8, pairs(&[2.0; 8], &[1.0 + 1024.0 * f64::EPSILON; 8]));
    assert!(close(deviation(&same, &rounded, 0), 16.0));
}

fn rate(lower: f64, upper: f64) -> Option<Rate> {
    Some(Rate { value: 0.5 * (lower + upper), lower, upper })
}

fn estimate() -> Estimate {
    Estimate {
        quantile: QUANTILE,
        name: "phi".into(),
        value: 2.0,
        standard_error: 3.0 / QUANTILE,
        bias: 0.0,
        bias_bound: 1.0,
        missed: 4.0,
        alpha: rate(0.9, 1.1),
        beta: rate(1.8, 2.2),
        failed: 0,
        judged: Judged { variance: true, bias: true, resolution: true },
    }
}

/// Verdict on three levels of differences above single paths, with these quotients of the motion,
/// and coarse means of the last level that are `apart` from the fine ones below.
fn judged(
    motion: [f64; 3],
    apart: f64,
    alpha: Option<Rate>,
    change: impl Fn(&mut [Samples]),
) -> (Judged, Vec<Warning>) {
    let good = || pairs(&[-1.0, 1.0].repeat(200), &[-0.9, 0.9].repeat(200));
    let mut levels = vec![level(0, 400, good())];
    levels.extend(quotients(motion));
    levels[1..].iter_mut().for_each(|samples| samples.values = vec![good()]);
    let coarse: Vec<f64> = [-0.9, 0.9].repeat(200).iter().map(|x| x + apart).collect();
    levels[3].values = vec![pairs(&[-1.0, 1.0].repeat(200), &coarse)];
    change(&mut levels);
    let unresolved = found(&levels[1..], 9.0);
    let (noisy, still) = (true, vec![false]);
    let evidence = Evidence { levels: &levels, first: 0, order: 1.0, noisy, still, unresolved };
    let mut estimates = [Estimate { alpha, ..estimate() }];
    let warnings = evidence.judge(&mut estimates);
    (estimates[0].judged, warnings)
}

#[test]
fn each_assumption_is_judged_at_its_limit() {
    let all = Judged { variance: true, bias: true, resolution: true };
    let (steps, alpha) = ([0.1, 0.05, 0.02], rate(0.9, 1.1));
    let same = |_: &mut [Samples]| ();
    assert_eq!(judged(steps, 0.0, alpha, same), (all, vec![]));
    let (coarse, warnings) = judged([1.2, 1.3, 0.75], 0.0, alpha, same);
    assert_eq!(coarse, Judged { resolution: false, ..all });
    let kinds = |warnings: &[Warning]| warnings.iter().map(|one| one.kind).collect::<Vec<_>>();
    assert_eq!(kinds(&warnings), [WarningKind::Component(1)]);
    // Four and a half standard errors between neighbours, of √((1 + 0.81)/399).
    let error = (1.81f64 / 399.0).sqrt();
    assert_eq!(judged(steps, 4.45 * error, alpha, same), (all, vec![]));
    let (apart, warnings) = judged(steps, 4.55 * error, alpha, same);
    assert_eq!(apart, Judged { bias: false, ..all });
    assert_eq!(kinds(&warnings), [WarningKind::Telescope]);
    // A weak order below the one given by more than a quarter is named, and below ½ not believed.
    assert_eq!(judged(steps, 0.0, rate(0.1, 0.76), same), (all, vec![]));
    let (named, warnings) = judged(steps, 0.0, rate(0.1, 0.74), same);
    assert_eq!((named, kinds(&warnings)), (all, vec![WarningKind::Order]));
    let (slow, warnings) = judged(steps, 0.0, rate(0.1, 0.49), same);
    assert_eq!(slow, Judged { bias: false, ..all });
    assert_eq!(kinds(&warnings), [WarningKind::Slow]);
    // φ is the same on every path of a level that decides.
    let blind = |levels: &mut [Samples]| levels[2].values = vec![pairs(&[1.0; 400], &[1.0; 400])];
    let (same_on_all, warnings) = judged(steps, 0.0, alpha, blind);
    assert!(!same_on_all.variance);
    let few = |warnings: &[Warning], text: &str| {
        let is =
            |one: &Warning| one.kind == WarningKind::FewSamples && one.message.what.contains(text);
        assert!(warnings.iter().any(is), "{warnings:?}");
    };
    let none = "0 of 64 samples carry the variance on level 2";
    few(&warnings, none);
    // One sample has the variance of the level that the sum begins with.
    let heavy = |levels: &mut [Samples]| {
        let mut values = vec![0.0; 400];
        (values[0], values[1]) = (100.0, 1.0);
        levels[0].values = vec![pairs(&values, &[])];
    };
    let (heavy, warnings) = judged(steps, 0.0, alpha, heavy);
    assert!(!heavy.variance);
    few(&warnings, "on level 0");
}

#[test]
fn an_interval_adds_the_bias_to_the_rest() {
    let estimate = estimate();
    assert!(close(estimate.half_width(), 6.0));
    let (lower, upper) = estimate.interval();
    assert!(close(lower, -4.0) && close(upper, 8.0));
    let result = |accuracy: f64, judged: Judged| Expectation {
        gradient: Vec::new(),
        scheme: "sexp",
        estimates: vec![Estimate { judged, ..estimate.clone() }],
        accuracy,
        single_steps: None,
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
fn an_expectation_says_what_it_is_and_what_it_lacks() {
    let estimate = |name: &str, standard_error: f64| Estimate {
        name: name.into(),
        value: 0.123_456_789,
        standard_error,
        quantile: 2.0,
        bias_bound: 3e-5,
        missed: 0.0,
        ..estimate()
    };
    let mut found = Expectation {
        gradient: Vec::new(),
        scheme: "sexp",
        estimates: vec![estimate("y1", 2e-5), estimate("cos y1", 0.0)],
        accuracy: 1e-4,
        single_steps: None,
        cost: 1234,
        levels: Vec::new(),
        warnings: Vec::new(),
    };
    let text = found.to_string();
    let first = "E[y1]     = 0.123457 ± 7.0e-5 (95 %): sampling 4.0e-5, bias at most 3.0e-5\n";
    assert!(found.reached() && text.starts_with(first), "{text}");
    assert!(text.contains("\nE[cos y1] = 0.123457 ± 3.0e-5"), "{text}");
    assert!(text.ends_with("path-steps\n") && text.contains("1.23e3"), "{text}");

    found.warnings.push(Warning::of_all(WarningKind::Cost, stats::Warning::new("too dear")));
    found.estimates[0].missed = 1e-3;
    found.estimates[1].judged.bias = false;
    let text = found.to_string();
    assert!(text.contains("± 1.0e-3 (95 %): sampling 1.0e-3"), "{text}");
    assert!(text.contains("bias at most 3.0e-5; NOT to be believed\n"), "{text}");
    let last = "warning: too dear\nthe accuracy 1.0e-4 was NOT reached\n";
    assert!(text.ends_with(last), "{text}");
}

/// States that are given.
struct Given<const D: usize>(Block<D>);

impl<const D: usize> Stepper for Given<D> {
    fn step(&mut self, _: &Step, _: &StepNoise, _: &mut BlockStatus) {}

    fn state(&self) -> &[Row] {
        &self.0.0
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.0.0
    }
}

/// Shows the states of runs at a time.
pub fn show<const D: usize>(
    states: &[Block<D>],
    time: u64,
    live: PathMask,
    observe: &mut dyn FnMut(&View<'_>),
) {
    let states: Vec<_> =
        states.iter().map(|&state| Box::new(Given(state)) as Box<dyn Stepper>).collect();
    let random_time = &[0.0; WIDTH];
    observe(&View { time, first_path: 0, states: &states, clipped: &[], random_time, live });
}
