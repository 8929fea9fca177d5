//! Studies: against laws that are known, against tables of the same paths, and in parts.
//!
//! p of [`Additive`] is W, so it is normal with variance t at any step size. The bounds of a test
//! are each exceeded by a right program with the probability that stands there.

use std::path::Path;

use mc::{
    LadderError, Observable, RunError, Setup, Simulation, StateFunction,
    parts::{Job, JobError, Program, Share},
};
use noise::{StreamKey, Truncation};
use nonlin::{Method, Solver};
use schemes::{Sexp, WithSolver};
use study::{IntervalNote, Place, STATISTICS, Study, StudyResult, StudySettings, Wanted};
use systems::{Constant, Problem};

use crate::{
    explosive::Explosive,
    ladder::{body, on_threads},
    statistical::judged::additive,
};

fn settings(steps: u64, times: u64, paths: u64, seed: u64) -> StudySettings {
    let key = StreamKey { seed, experiment: 4 };
    StudySettings::new(steps, times, paths, Truncation::none(), key)
}

const P: Observable<2> = Observable { name: "p", function: |y| y[1] };
const OFFSET: Observable<2> = Observable { name: "1e8 + p", function: |y| 1e8 + y[1] };
const ROOT: Observable<2> = Observable { name: "√p", function: |y| y[1].sqrt() };

fn run(observables: &[Observable<2>], settings: &StudySettings) -> StudyResult {
    Study::new(&Setup::of(&additive(1.0), &Sexp), observables, settings).unwrap().run()
}

/// Quantiles of the normal law at the default levels, and its density there.
const NORMAL: [(f64, f64, f64); 5] = [
    (0.05, -1.644_853_6, 0.103_135_6),
    (0.25, -0.674_489_8, 0.317_776_6),
    (0.5, 0.0, 0.398_942_3),
    (0.75, 0.674_489_8, 0.317_776_6),
    (0.95, 1.644_853_6, 0.103_135_6),
];

/// Whether mean, variance and quantiles of every time and of p shifted by `shift` are those of
/// N(shift, factor·t), within 4.5 standard errors: 56 comparisons with 7·10⁻⁶ each.
fn is_normal(result: &StudyResult, observable: &str, shift: f64, factor: f64) -> bool {
    let series = result.series(observable).unwrap();
    series.points[1..].iter().all(|point| {
        let (n, variance) = (point.count as f64, factor * point.time);
        let near = |found: f64, exact: f64, error: f64| (found - exact).abs() <= 4.5 * error;
        let quantiles =
            point.quantiles.iter().zip(NORMAL).all(|(quantile, (level, z, density))| {
                let error = (level * (1.0 - level) / n).sqrt() / density * variance.sqrt();
                // Interpolation is exact to a tenth of a bin.
                let bin = 0.1 * point.histogram.as_ref().unwrap().grid.width / 4.5;
                let exact = shift + z * variance.sqrt();
                quantile.level == level && near(quantile.value.unwrap(), exact, error + bin)
            });
        quantiles
            && near(point.mean.unwrap(), shift, (variance / n).sqrt())
            && near(point.variance.unwrap() / variance, 1.0, (2.0 / n).sqrt())
    })
}

#[test]
fn moments_and_quantiles_are_those_of_the_law() {
    let result = run(&[P, OFFSET], &settings(16, 4, 20_000, 1));
    assert!(is_normal(&result, "p", 0.0, 1.0) && is_normal(&result, "1e8 + p", 1e8, 1.0));
    // The twin: the law of another noise.
    assert!(!is_normal(&result, "p", 0.0, 1.1) && !is_normal(&result, "1e8 + p", 1e8, 1.1));
    let points = &result.series("p").unwrap().points;
    let times: Vec<f64> = points.iter().map(|point| point.time).collect();
    assert_eq!(times, [0.0, 0.25, 0.5, 0.75, 1.0]);
    for point in &points[1..] {
        assert_eq!((point.count, point.not_finite), (20_000, 0));
        assert_eq!(point.deviation, Some(point.variance.unwrap().sqrt()));
        let (lo, hi) = point.mean_interval.unwrap();
        let width = 2.0 * 1.96 * point.deviation.unwrap() / 20_000f64.sqrt();
        // What was not seen widens it by a thousandth.
        assert!((1e-4..3e-3).contains(&((hi - lo) / width - 1.0)));
    }
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
}

#[test]
fn the_initial_value_is_exact() {
    let constant = Observable { name: "c", function: |_: [f64; 2]| 0.1 };
    let result = run(&[P, constant], &settings(4, 2, 1000, 1));
    for (series, exact) in result.series.iter().zip([0.0, 0.1]) {
        let first = &series.points[0];
        assert_eq!((first.step, first.time, first.count), (0, 0.0, 1000));
        assert_eq!((first.mean, first.mean_interval), (Some(exact), Some((exact, exact))));
        assert_eq!(
            (first.variance, first.least, first.largest),
            (Some(0.0), Some(exact), Some(exact))
        );
        assert!(first.quantiles.iter().all(|q| q.value == Some(exact) && q.lo == q.hi));
    }
    // A constant is one to the last bit at all times.
    let last = result.series("c").unwrap().last();
    assert_eq!((last.mean, last.variance), (Some(0.1), Some(0.0)));
    for quantile in &last.quantiles {
        assert_eq!([quantile.value, quantile.lo, quantile.hi], [Some(0.1); 3]);
    }
    assert!(result.warnings.is_empty(), "{:?}", result.warnings);
}

#[test]
fn a_study_is_made_of_the_values_of_its_paths() {
    let (problem, k) = (body(), Truncation::new(4).unwrap());
    let key = StreamKey { seed: 5, experiment: 2 };
    let observables = [
        Observable { name: "y1", function: |y: [f64; 3]| y[0] },
        Observable { name: "y2 y3", function: |y: [f64; 3]| y[1] * y[2] },
    ];
    // More than two groups of paths, and no full block at the end.
    let paths = 333;
    let settings = StudySettings {
        bins: 20,
        quantiles: vec![0.9, 0.1],
        ..StudySettings::new(12, 2, paths, k, key)
    };
    let result = Study::new(&Setup::of(&problem, &Sexp), &observables, &settings).unwrap().run();
    assert_eq!(result.record.quantiles, [0.1, 0.9]);
    let simulation = Simulation::new(Setup::of(&problem, &Sexp), k)
        .observing(StateFunction::new("y2 y3", |y: [f64; 3]| y[1] * y[2]));
    let tables = simulation.paths(12, key, 0..paths).unwrap();
    for name in ["y1", "y2 y3"] {
        for (point, step) in result.series(name).unwrap().points[1..].iter().zip([6, 12]) {
            assert_eq!((point.step, point.time), (step, tables[0].times()[step as usize]));
            let value = |table: &mc::TimeSeries| table.column(name).unwrap()[step as usize];
            let mut values: Vec<f64> = tables.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            let (n, all) = (paths as f64, paths as usize);
            let mean = values.iter().sum::<f64>() / n;
            let squares = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            assert!((point.mean.unwrap() - mean).abs() < 1e-14);
            assert!((point.variance.unwrap() / (squares / (n - 1.0)) - 1.0).abs() < 1e-12);
            assert_eq!((point.least, point.largest), (Some(values[0]), Some(values[all - 1])));
            let histogram = point.histogram.as_ref().unwrap();
            let grid = &histogram.grid;
            let between = |lo: f64, hi: f64| values.iter().filter(|&&x| lo <= x && x < hi).count();
            for (k, &count) in (0..).zip(&histogram.counts) {
                assert_eq!(count as usize, between(grid.edge(k), grid.edge(k + 1)));
            }
            assert_eq!(histogram.below as usize, between(f64::NEG_INFINITY, grid.lo));
            assert_eq!(histogram.above as usize, between(grid.edge(20), f64::INFINITY));
            for quantile in &point.quantiles {
                let (l, u) = stats::quantile_ranks(paths, quantile.level);
                let sample = values[(quantile.level * n) as usize];
                let [lo, hi] = [quantile.lo, quantile.hi].map(Option::unwrap);
                assert!((quantile.value.unwrap() - sample).abs() <= grid.width);
                assert!(lo <= values[l as usize - 1] && values[u as usize - 1] <= hi);
                assert!(
                    hi - lo <= values[u as usize - 1] - values[l as usize - 1] + 2.0 * grid.width
                );
            }
        }
    }
    // Other times give the same numbers where they coincide.
    let even = StudySettings { times: 1, ..settings };
    let even = Study::new(&Setup::of(&problem, &Sexp), &observables, &even).unwrap().run();
    assert_eq!(even.series[1].last(), result.series[1].last());
}

/// Bits are the same for any number of threads, and the work is reported.
#[test]
fn threads_change_no_bit_of_a_study() {
    let json = |threads: usize| {
        let done = std::sync::atomic::AtomicU64::new(0);
        let count = |steps| _ = done.fetch_add(steps, std::sync::atomic::Ordering::Relaxed);
        let settings = settings(6, 3, 3000, 2);
        let result = on_threads(threads, || {
            Study::new(&Setup::of(&additive(1.0), &Sexp), &[P, OFFSET], &settings)
                .unwrap()
                .telling(count)
                .run()
        });
        assert_eq!(done.load(std::sync::atomic::Ordering::Relaxed), 6 * 3000);
        serde_json::to_string(&result).unwrap()
    };
    let one = json(1);
    assert!([2, 3, 7].into_iter().all(|threads| json(threads) == one));
}

fn program() -> Program {
    Program { name: "study".into(), ..Program::default() }
}

pub fn run_part(study: &Study<'_>, folder: &Path, number: u64, of: u64) {
    let job = Job::part(folder, Share::new(number, of).unwrap(), program()).unwrap();
    assert!(study.run_in(&job, "study").is_none());
    job.finish().unwrap();
}

pub fn merged(study: &Study<'_>, folder: &Path) -> Result<StudyResult, JobError> {
    let job = Job::merge(folder, program())?;
    let found = study.run_in(&job, "study");
    job.finish().map(|()| found.unwrap())
}

#[test]
fn a_study_in_parts_has_the_same_bits() {
    let (problem, observables) = (additive(1.0), [P, ROOT]);
    let study = |paths: u64, times: u64| {
        Study::new(&Setup::of(&problem, &Sexp), &observables, &settings(8, times, paths, 3))
            .unwrap()
    };
    let whole = study(1700, 4).run();
    let folder = tempfile::tempdir().unwrap();
    for number in [3, 1, 2] {
        run_part(&study(1700, 4), folder.path(), number, 3);
    }
    let merge_as = |study: Study<'_>| merged(&study, folder.path());
    assert_eq!(merge_as(study(1700, 4)).unwrap(), whole);
    // Other times, other bins, and pairs are another study.
    let bins = StudySettings { bins: 255, ..settings(8, 4, 1700, 3) };
    let binned = Study::new(&Setup::of(&problem, &Sexp), &observables, &bins).unwrap();
    let wanted = Wanted { pairs: vec![(0, 1)], ..Wanted::default() };
    let pairs = StudySettings { wanted, ..settings(8, 4, 1700, 3) };
    let pairs = Study::new(&Setup::of(&problem, &Sexp), &observables, &pairs).unwrap();
    for other in [study(1700, 2), pairs, binned] {
        let error = merge_as(other).unwrap_err().to_string();
        assert!(error.contains("the fingerprint"), "{error}");
    }
    let read: StudyResult = serde_json::from_str(&serde_json::to_string(&whole).unwrap()).unwrap();
    assert_eq!(read, whole);
}

/// Of 2000 intervals that cover with probability 0.95 to 0.97 (ranks are integers), the share that
/// covers lies between 0.95 − 4.2·0.0049 and 0.97 + 4.2·0.0038, but for 2·10⁻⁵. Six are asked.
#[test]
fn intervals_cover_as_often_as_they_say() {
    let (replications, paths) = (2000, 400);
    let (mut covered, mut halves) = ([0; 6], [0; 6]);
    for seed in 0..replications {
        let settings = StudySettings { bins: 4096, ..settings(2, 1, paths, 100 + seed) };
        let result = run(&[P], &settings);
        let last = result.series[0].last();
        let mut count = |n: usize, value: f64, (lo, hi): (f64, f64), exact: f64| {
            covered[n] += u32::from(lo <= exact && exact <= hi);
            // The twin: half as wide.
            let (lo, hi) = (0.5 * (value + lo), 0.5 * (value + hi));
            halves[n] += u32::from(lo <= exact && exact <= hi);
        };
        count(5, last.mean.unwrap(), last.mean_interval.unwrap(), 0.0);
        for (n, (quantile, (_, z, _))) in last.quantiles.iter().zip(NORMAL).enumerate() {
            let interval = quantile.lo.zip(quantile.hi).unwrap();
            count(n, quantile.value.unwrap(), interval, z);
        }
    }
    let share = |covered: u32| f64::from(covered) / replications as f64;
    assert!(covered.iter().all(|&n| (0.93..0.986).contains(&share(n))), "{covered:?}");
    assert!(halves.iter().all(|&n| share(n) < 0.8), "{halves:?}");
}

/// With few bins the interval contains their width: it covers at least as often.
#[test]
fn intervals_contain_the_width_of_the_bins() {
    let mut covered = [0; 5];
    for seed in 0..400 {
        let result = run(&[P], &StudySettings { bins: 12, ..settings(2, 1, 2000, 5000 + seed) });
        for (n, (quantile, (_, z, _))) in
            result.series[0].last().quantiles.iter().zip(NORMAL).enumerate()
        {
            covered[n] += u32::from(quantile.lo.unwrap() <= z && z <= quantile.hi.unwrap());
        }
    }
    // 0.95 − 4·0.011.
    assert!(covered.iter().all(|&n| n >= 363), "{covered:?}");
}

#[test]
fn failed_paths_are_left_out_counted_and_described() {
    let problem = Problem::new(Explosive, Constant::new(0.0).unwrap(), [0.1, 0.5], 1.0).unwrap();
    let scheme = WithSolver { formula: Sexp, solver: Solver::new(Method::Newton) };
    let observables = [Observable { name: "y2", function: |y: [f64; 2]| y[1] }];
    let settings =
        StudySettings { truncation: Truncation::new(4).unwrap(), ..settings(16, 4, 400, 1) };
    let result = Study::new(&Setup::of(&problem, &scheme), &observables, &settings).unwrap().run();
    let counts: Vec<u64> = result.series[0].points.iter().map(|point| point.count).collect();
    assert!(counts[0] == 400 && counts.is_sorted_by(|a, b| a >= b), "{counts:?}");
    assert!(result.losses.failed > 20 && counts[4] + result.losses.failed == 400);
    assert_eq!(result.losses.failures.len(), 8);
    let text = &result.losses.failures[0];
    assert!(text.starts_with("path ") && text.contains("seed 1, experiment 4"), "{text}");
    let warning = format!("{} of 400 paths failed", result.losses.failed);
    assert!(result.warnings[0].to_string().starts_with(&warning), "{:?}", result.warnings);
}

#[test]
fn values_that_are_not_finite_are_counted_and_in_no_mean() {
    let pole = Observable { name: "1/p", function: |y: [f64; 2]| 1.0 / y[1] };
    let result = run(&[P, ROOT, pole], &settings(4, 2, 1000, 7));
    let (p, root) = (result.series("p").unwrap(), result.series("√p").unwrap());
    for (p, root) in p.points.iter().zip(&root.points).skip(1) {
        let grid = &p.histogram.as_ref().unwrap().grid;
        let below_zero: u64 = (0..)
            .zip(&p.histogram.as_ref().unwrap().counts)
            .filter(|(k, _)| grid.edge(*k) < 0.0)
            .map(|(_, count)| count)
            .sum();
        // Zero is an edge, or the grid lies above it.
        assert!(
            grid.lo < 0.0 && root.not_finite == below_zero + p.histogram.as_ref().unwrap().below
        );
        assert_eq!(root.count + root.not_finite, 1000);
        // E[√p | p > 0] is 0.822 179 for p normal, times t^¼.
        assert!((root.mean.unwrap() - 0.822_179 * root.time.powf(0.25)).abs() < 0.08);
        assert!(root.least.unwrap() >= 0.0);
    }
    // The initial value of 1/p is infinite.
    let first = &result.series("1/p").unwrap().points[0];
    assert_eq!((first.count, first.not_finite, first.mean), (0, 1000, None));
    assert_eq!(first.quantiles[0].place, Place::NoValues);
    assert_eq!(result.record.initial, [Some(0.0), Some(0.0), None]);
    let warning = "√p: values that are not finite, left out at 2 times, first t = 0.500000";
    assert!(
        result.warnings.iter().any(|text| text.to_string() == warning),
        "{:?}",
        result.warnings
    );
}

fn csv(result: &StudyResult) -> String {
    let mut csv = Vec::new();
    result.write_csv(&mut csv).unwrap();
    String::from_utf8(csv).unwrap()
}

#[test]
fn a_table_has_a_row_for_each_quantity() {
    let quoted = Observable { name: "p, again", function: |y: [f64; 2]| y[1] };
    let result = run(&[P, quoted], &settings(4, 4, 1000, 7));
    let csv = csv(&result);
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines[0], "t,observable,quantity,value,lo,hi,note");
    // Counts, statistics and quantiles; and counts outside of the bins.
    let each = 2 + STATISTICS.len() + 5;
    assert_eq!(lines.len(), 1 + 2 * (each + 4 * (each + 2)));
    assert_eq!(lines[1], "0.0,p,count,1000,,,");
    assert_eq!(lines[3], "0.0,p,mean,0.0,0.0,0.0,");
    let point = &result.series[0].points[4];
    let (lo, hi) = point.mean_interval.unwrap();
    assert!(
        lines.contains(&format!("1.0,p,mean,{:?},{lo:?},{hi:?},", point.mean.unwrap()).as_str())
    );
    let quantile = point.quantiles[4];
    let [value, lo, hi] = [quantile.value, quantile.lo, quantile.hi].map(Option::unwrap);
    assert!(lines.contains(&format!("1.0,p,q0.95,{value:?},{lo:?},{hi:?},").as_str()));
    assert!(lines.iter().any(|line| line.starts_with("0.25,\"p, again\",above grid,")));

    let json = serde_json::to_value(&result).unwrap();
    assert_eq!(json["record"]["system"], "additive");
    assert_eq!(json["record"]["truncation"], serde_json::Value::Null);
    assert_eq!(json["record"]["times"], serde_json::json!([1, 2, 3, 4]));
    assert_eq!(json["series"][1]["points"][1]["quantiles"][0]["place"], "inside");
}

#[test]
fn impossible_studies_are_refused() {
    let good = || settings(12, 4, 100, 1);
    let refuse = |settings: StudySettings, observables: &[Observable<2>]| {
        Study::new(&Setup::of(&additive(1.0), &Sexp), observables, &settings).err().unwrap()
    };
    let message = |settings| refuse(settings, &[P]).to_string();
    let with = |times| message(StudySettings { times, ..good() });
    let none = refuse(good(), &[]).to_string();
    assert_eq!(none, "the number of observables must be at least 1, got 0");
    let same = refuse(good(), &[P, ROOT, P]).to_string();
    assert_eq!(same, "two observables have the name \"p\"; rename one");
    for times in [0, 5, 9, 24] {
        let told = with(times);
        assert!(told.starts_with(&format!("12 steps cannot be divided into {times}")), "{told}");
    }
    let key = StreamKey { seed: 0, experiment: 1 << 40 };
    for (settings, told) in [
        (StudySettings { paths: 0, ..good() }, "the number of paths must be at least 1, got 0"),
        (StudySettings { pilot: 127, ..good() }, "128, got 127"),
        (StudySettings { bins: 1, ..good() }, "from 2 to 65536"),
        (StudySettings { bins: 65_537, ..good() }, "from 2 to 65536"),
        (StudySettings { quantiles: vec![0.5, 0.1, 0.5], ..good() }, "once each, got 0.5"),
        (StudySettings { key, ..good() }, "below 2^40"),
        (StudySettings { steps: 0, ..good() }, "at least 1, got 0"),
    ] {
        let text = message(settings);
        assert!(text.contains(told), "{text}");
    }
    for level in [0.0, 1.0, -0.5, f64::NAN] {
        let text = message(StudySettings { quantiles: vec![0.5, level], ..good() });
        assert!(text.ends_with(&format!("between 0 and 1, once each, got {level}")), "{text}");
    }
    let coarse = StudySettings { truncation: Truncation::new(4).unwrap(), ..settings(1, 1, 9, 1) };
    assert!(matches!(refuse(coarse, &[P]), RunError::Ladder(LadderError::Noise(_))));
}

/// A value that many paths share: at an end it is known, elsewhere it is not made up.
#[test]
fn quantiles_at_atoms_have_no_false_digits() {
    let zero = Observable { name: "max(0, p − 1.6)", function: |y| f64::max(0.0, y[1] - 1.6) };
    let negative =
        Observable { name: "min(0, 1.6 − p)", function: |y| f64::min(0.0, 1.6 - y[1]) };
    let whole = Observable { name: "round", function: |y| (2.0 * y[1]).round() };
    let exponential = Observable { name: "e^p", function: |y| (2.0 * y[1]).exp() };
    let result = run(&[zero, negative, whole, exponential], &settings(2, 1, 20_000, 5));
    let quantiles = |name: &str| result.series(name).unwrap().last().quantiles.clone();
    // The 95 % quantile is 0.0449, at the atom's edge P = 0.9452.
    let above = quantiles("max(0, p − 1.6)");
    for quantile in &above[..4] {
        assert_eq!([quantile.value, quantile.lo, quantile.hi], [Some(0.0); 3]);
    }
    assert!(above[4].lo.unwrap() <= 0.0449 && above[4].hi.unwrap() >= 0.0449, "{:?}", above[4]);
    for quantile in &quantiles("min(0, 1.6 − p)")[1..] {
        assert_eq!([quantile.value, quantile.lo, quantile.hi], [Some(0.0); 3]);
    }
    // ±3, ±1 and 0, in bins of their own.
    for (quantile, exact) in quantiles("round").iter().zip([-3.0, -1.0, 0.0, 1.0, 3.0]) {
        assert_eq!((quantile.value, quantile.place), (None, Place::Crowded));
        let (lo, hi) = (quantile.lo.unwrap(), quantile.hi.unwrap());
        assert!(lo <= exact && exact <= hi && hi - lo < 0.2, "{quantile:?}");
    }
    assert!(
        result
            .warnings
            .iter()
            .any(|text| text.what.contains("many more values than its neighbours"))
    );
    // Most values of a heavy law lie in one bin: a quantile within is not known.
    assert_eq!(quantiles("e^p")[0].place, Place::Crowded);
}

/// Numbers whose squares are no numbers have the statistics of p.
#[test]
fn tiny_and_huge_values_have_their_deviation() {
    const TINY: f64 = f64::from_bits((1023 - 668) << 52);
    let tiny = Observable { name: "tiny", function: |y| TINY * y[1] };
    let huge = Observable { name: "huge", function: |y| y[1] / TINY };
    let small = Observable { name: "small", function: |y| f64::powi(0.5, 300) * y[1] };
    let result = run(&[P, tiny, huge, small], &settings(2, 1, 1000, 5));
    let p = result.series("p").unwrap().last();
    let factors = [("tiny", TINY), ("huge", 1.0 / TINY), ("small", 0.5f64.powi(300))];
    for (name, factor) in factors {
        let last = result.series(name).unwrap().last();
        let scaled = |x: Option<f64>| x.map(|x| x * factor);
        assert_eq!((last.mean, last.deviation), (scaled(p.mean), scaled(p.deviation)), "{name}");
        let interval = p.mean_interval.map(|(lo, hi)| (lo * factor, hi * factor));
        assert_eq!((last.mean_interval, last.least), (interval, scaled(p.least)));
        let representable = (name == "small").then(|| p.variance.unwrap() * factor * factor);
        assert_eq!(last.variance, representable, "{name}");
    }
}

#[test]
fn what_was_not_seen_is_not_excluded() {
    let rare = Observable { name: "p > 4", function: |y| f64::from(u8::from(y[1] > 4.0)) };
    let steady = Observable { name: "1 + ε", function: |y| 1.0 + 1e-15 * y[1] };
    let seldom = Observable { name: "p > 2", function: |y| f64::from(u8::from(y[1] > 2.0)) };
    let result = run(&[rare, steady, seldom], &settings(2, 1, 100, 5));
    for (name, mean) in [("p > 4", 0.0), ("1 + ε", 1.0)] {
        let last = result.series(name).unwrap().last();
        assert!((last.mean.unwrap() - mean).abs() < 1e-14 && last.mean_interval.is_none());
        assert_eq!(last.interval_note, Some(IntervalNote::Equal(33)));
    }
    let csv = csv(&result);
    assert!(csv.contains("1.0,p > 4,mean,0.0,,,all equal; others < 1 path in 33\n"));
    // One event of 100.
    let one = (1..100).map(|seed| run(&[seldom], &settings(2, 1, 100, seed)));
    let one = one.into_iter().find(|result| result.series[0].last().mean == Some(0.01)).unwrap();
    let last = one.series[0].last();
    assert_eq!(last.interval_note, Some(IntervalNote::TooFew));
    // In files a note is its words.
    for note in [IntervalNote::TooFew, IntervalNote::Equal(33), IntervalNote::Heavy("x".into())] {
        let words = serde_json::to_string(&note).unwrap();
        assert_eq!(
            (words.clone(), note.clone()),
            (format!("\"{note}\""), serde_json::from_str(&words).unwrap())
        );
    }
    let warning = "p > 2: too few values carry the mean at t = 1.000000";
    assert!(one.warnings.iter().any(|text| text.to_string() == warning), "{:?}", one.warnings);
}
