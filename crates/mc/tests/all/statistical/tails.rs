//! Laws without a variance or a mean: no interval of their mean is stated, and nothing is reached.
//! p of [`Additive`](crate::statistical::judged::Additive) is W, so 1 − Φ(p) is uniform at time one.

use expectation::{Expect, ExpectSettings, Expectation, WarningKind};
use mc::{Observable, Setup};
use noise::{StreamKey, Truncation};
use schemes::Sexp;
use study::{Study, StudyResult, StudySettings};

use crate::statistical::judged::additive;

/// The law with P(x > s) = s^{−α}, by its index in tenths. Its mean is α/(α − 1).
fn pareto<const TENTHS: u32>(y: [f64; 2]) -> f64 {
    // erfc to 1.2·10⁻⁷ of itself (Press et al., *Numerical Recipes*, 1992, §6.2).
    let x = y[1].abs() / 2f64.sqrt();
    let t = 1.0 / (1.0 + 0.5 * x);
    let terms = [
        0.170_872_77,
        -0.822_152_23,
        1.488_515_87,
        -1.135_203_98,
        0.278_868_07,
        -0.186_288_06,
        0.096_784_18,
        0.374_091_96,
        1.000_023_68,
        -1.265_512_23,
    ];
    let upper = 0.5 * t * (terms.into_iter().fold(0.0, |sum, term| sum * t + term) - x * x).exp();
    let uniform = if y[1] < 0.0 { 1.0 - upper } else { upper };
    uniform.powf(-10.0 / f64::from(TENTHS))
}

const OBSERVABLES: [Observable<2>; 3] = [
    Observable { name: "no variance", function: pareto::<16> },
    Observable { name: "no mean", function: pareto::<8> },
    Observable { name: "lognormal", function: |y| y[1].exp() },
];
const SEEDS: u64 = 12;
/// Of twelve, of which one in thirty is not seen, four or more are not with probability 5·10⁻⁴.
const LEAST: usize = 9;

fn study(seed: u64) -> StudyResult {
    let key = StreamKey { seed, experiment: 11 };
    let settings = StudySettings::new(2, 2, 5000, Truncation::none(), key);
    Study::new(&Setup::of(&additive(1.0), &Sexp), &OBSERVABLES, &settings).unwrap().run()
}

#[test]
fn a_study_states_no_interval_of_what_has_no_variance() {
    let studies: Vec<StudyResult> = (0..SEEDS).map(study).collect();
    let count = |is: &dyn Fn(&StudyResult) -> bool| studies.iter().filter(|one| is(one)).count();
    let last = |study: &StudyResult, name: &str| study.series(name).unwrap().last().clone();
    let is_named = |study: &StudyResult, name: &str| {
        let point = last(study, name);
        let note = point.interval_note.map_or(String::new(), |note| note.to_string());
        let warned = study.warnings.iter().any(|warning| warning.what.contains(&note));
        point.mean_interval.is_none()
            && point.deviation.is_none()
            && note.contains("tail index")
            && warned
            && study.warnings.iter().any(|warning| warning.what.starts_with(name))
    };
    assert!(count(&|study| is_named(study, "no variance")) >= LEAST);
    assert!(count(&|study| last(study, "no variance").mean.is_some()) >= LEAST);
    assert!(count(&|study| is_named(study, "no mean")) >= LEAST);
    assert!(count(&|study| last(study, "no mean").mean.is_none()) >= LEAST);
    // Less than one in a hundred.
    let exact = 0.5f64.exp();
    let is_known = |study: &StudyResult| last(study, "lognormal").mean_interval.is_some();
    assert!(count(&is_known) + 1 >= SEEDS as usize);
    let covers = |study: &StudyResult| {
        let interval = last(study, "lognormal").mean_interval;
        interval.is_some_and(|(lo, hi)| lo < exact && exact < hi)
    };
    assert!(count(&covers) >= LEAST);
    let mut csv = Vec::new();
    studies[0].write_csv(&mut csv).unwrap();
    assert!(String::from_utf8(csv).unwrap().contains(",no variance,mean,"));
}

#[test]
fn an_expectation_of_what_has_no_variance_is_not_reached() {
    let phi: Vec<&dyn mc::Observe> = OBSERVABLES.iter().map(|phi| phi as _).collect();
    let of = |(seed, random_points)| {
        let key = StreamKey { seed, experiment: 12 };
        let max_cost = 10_000_000;
        let settings = ExpectSettings { key, random_points, max_cost, ..ExpectSettings::default() };
        let problem = additive(1.0);
        let expect = Expect::with_scheme(Setup::of(&problem, &Sexp)).with(settings);
        expect.run(&phi, 0.05).unwrap()
    };
    let all: Vec<Expectation> = (0..SEEDS).map(|seed| of((seed, seed % 2 == 0))).collect();
    let count = |is: &dyn Fn(&Expectation) -> bool| all.iter().filter(|one| is(one)).count();
    let no_interval = |found: &Expectation, k: usize| {
        let estimate = &found.estimates[k];
        let warned = found.warnings.iter().any(|warning| {
            warning.kind == WarningKind::FewSamples && warning.observables.contains(&estimate.name)
        });
        !found.reached()
            && !estimate.judged.variance
            && estimate.half_width().is_infinite()
            && warned
    };
    for k in [0, 1] {
        assert!(count(&|found| no_interval(found, k)) >= LEAST, "{k}");
    }
    assert!(count(&|found| found.estimates[1].value.is_nan()) >= LEAST);
    assert!(count(&|found| found.to_string().contains("= no mean, no interval")) >= LEAST);
    // The others go on until they are reached.
    let covers = |found: &Expectation| {
        let (lo, hi) = found.estimates[2].interval();
        let known = found.estimates[2].judged.all() && hi - lo <= 0.1;
        known && lo < 0.5f64.exp() && 0.5f64.exp() < hi
    };
    assert!(count(&covers) >= 10);
}
