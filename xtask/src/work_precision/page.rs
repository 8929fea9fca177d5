//! `docs/work-precision.md`, made from the measurements.

use std::fmt::Write;

use precision::cost_at;
use precision::results::{Case, Measurements, WeakObservable};

use super::curves::{strong_costs, weak_costs};
use super::words::{self, number, targets};
use crate::provenance::generated_by;

/// The file of a figure.
pub fn figure_name(case: &Case, kind: &str) -> String {
    format!("work-precision-{}-{kind}.svg", case.id)
}

/// The whole page.
pub fn page(measured: &Measurements) -> String {
    let mut page = String::new();
    head(&mut page, measured);
    for case in &measured.cases {
        section(&mut page, case);
    }
    page += FIELDS;
    page
}

/// Writing into a string cannot fail.
macro_rules! line {
    ($page:expr) => {
        $page.push('\n')
    };
    ($page:expr, $($arguments:tt)*) => {
        let _ = writeln!($page, $($arguments)*);
    };
}

fn head(page: &mut String, measured: &Measurements) {
    line!(page, "# Work and precision\n");
    line!(
        page,
        "Which scheme is cheapest for which error? {} All numbers and \
         all sentences that contain one are made from the measurements; times hold for that machine.\n",
        generated_by(&measured.provenance)
    );
    page.push_str(METHOD);
    line!(page, "\nTimes are: {}.\n", measured.clock);
    line!(page, "## Conclusions\n");
    for case in &measured.cases {
        line!(page, "- **{}.** {}", case.title, words::strong(case));
    }
    line!(page);
    for case in &measured.cases {
        if let Some(text) = words::areas(case) {
            line!(page, "**Are Lévy areas worth their price?** {}: {text}\n", case.title);
        }
    }
    worth(page, measured);
}

/// What being conformal costs: `sexp` beside the cheapest explicit scheme, at one error of each
/// case.
fn worth(page: &mut String, measured: &Measurements) {
    line!(page, "### What being conformal costs\n");
    line!(
        page,
        "At the smallest of the errors 10^(−k/2) that `sexp` and an explicit scheme both reach: the cheapest explicit scheme, what `sexp` \
         costs in multiples of it, and how far both are from the conformal law of the Casimir there (root mean square of \
         F(y_N)/(e^(−p∫γ)F(y₀)) − 1, at the measured number of steps next above).\n"
    );
    line!(
        page,
        "| case | strong error | cheapest explicit | `sexp` costs | Casimir | explicit defect | `sexp` defect |"
    );
    line!(page, "|---|---|---|---|---|---|---|");
    for case in &measured.cases {
        let series = |id: &str| case.strong.series.iter().find(|series| series.scheme == id);
        let Some(sexp) = series("sexp") else { continue };
        let explicit: Vec<_> = ["heun", "em"].iter().filter_map(|id| series(id)).collect();
        let curves: Vec<_> = explicit.iter().map(|series| strong_costs(series)).collect();
        let own = strong_costs(sexp);
        let both = targets(&curves).into_iter().rfind(|&error| cost_at(&own, error).is_some());
        let Some(error) = both else { continue };
        let costs = explicit
            .iter()
            .zip(&curves)
            .filter_map(|(series, curve)| Some((*series, cost_at(curve, error)?)));
        let Some((best, cost)) = costs.min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        let casimir = case.invariants.iter().position(|name| name == "C");
        let defect = |series: &precision::results::StrongSeries| {
            let point = series.points.iter().find(|point| point.error <= error);
            point
                .zip(casimir)
                .and_then(|(point, index)| point.defects.get(index))
                .map_or("–".to_owned(), |defect| number(*defect))
        };
        line!(
            page,
            "| {} | {} | `{}` | {} × | {} | {} | {} |",
            case.title,
            number(error),
            best.scheme,
            cost_at(&own, error).map_or("–".to_owned(), |own| number(own / cost)),
            casimir.map_or("none", |_| "C"),
            defect(best),
            defect(sexp)
        );
    }
    line!(page);
}

fn section(page: &mut String, case: &Case) {
    line!(page, "## {}\n", case.title);
    line!(
        page,
        "`{}`: {}. {} paths, against {}.",
        case.id,
        case.setup,
        case.strong.samples,
        case.strong.reference
    );
    failures(page, case.strong.failed, &case.strong.failures);
    line!(
        page,
        "\n![Strong error against processor time and steps](figures/{})\n",
        figure_name(case, "strong")
    );
    line!(page, "{}\n", words::strong(case));
    let names: Vec<&str> = case.strong.series.iter().map(|series| series.scheme.as_str()).collect();
    let curves: Vec<_> = case.strong.series.iter().map(strong_costs).collect();
    line!(page, "Microseconds of a path for a strong error, the cheapest in bold:\n");
    costs(page, "error", &names, &curves);
    steps(page, case);
    line!(
        page,
        "### Expectations\n\n{} paths, against {}. {}\n",
        case.weak.samples,
        case.weak.reference,
        checked(&case.weak.observables)
    );
    failures(page, case.weak.failed, &case.weak.failures);
    line!(
        page,
        "![Accuracy of an expectation against processor time](figures/{})\n",
        figure_name(case, "weak")
    );
    for observable in &case.weak.observables {
        line!(
            page,
            "{} Seconds of an estimate of a given root-mean-square error:\n",
            words::weak(observable)
        );
        let curves: Vec<_> = observable.series.iter().map(weak_costs).collect();
        costs(page, "accuracy", &names, &curves);
    }
}

fn failures(page: &mut String, failed: u64, failures: &[String]) {
    if failed > 0 {
        line!(
            page,
            " {failed} paths are left out of every scheme and step size, because one of them failed; the first: {}.",
            failures.first().map_or("not described", String::as_str)
        );
    }
}

/// The reference beside the expectations that are known without sampling.
fn checked(observables: &[WeakObservable]) -> String {
    let known = observables.iter().filter_map(|observable| {
        let deviation = (observable.reference_mean - observable.exact?) / observable.reference_se;
        Some(format!(
            "E[{}] of the reference is {deviation:+.1} standard errors from its exact value",
            observable.name
        ))
    });
    let known: Vec<String> = known.collect();
    if known.is_empty() { String::new() } else { format!("{}.", known.join("; ")) }
}

/// A table of costs by target.
fn costs(page: &mut String, what: &str, names: &[&str], curves: &[Vec<(f64, f64)>]) {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    line!(page, "| {what} | {} |", quoted.join(" | "));
    line!(page, "|---|{}", "---|".repeat(names.len()));
    for error in targets(curves) {
        let best = words::cheapest(curves, error);
        let cells: Vec<String> = curves
            .iter()
            .enumerate()
            .map(|(n, curve)| match cost_at(curve, error) {
                None => "–".to_owned(),
                Some(cost) if best == Some(n) => format!("**{}**", number(cost)),
                Some(cost) => number(cost),
            })
            .collect();
        line!(page, "| {} | {} |", number(error), cells.join(" | "));
    }
    line!(page);
}

/// Everything measured at some step sizes.
fn steps(page: &mut String, case: &Case) {
    let invariants: Vec<String> =
        case.invariants.iter().map(|name| format!("defect of {name}")).collect();
    let columns = if invariants.is_empty() {
        String::new()
    } else {
        format!(" {} |", invariants.join(" | "))
    };
    line!(page, "| steps | scheme | strong error, 95 % | ns a step | spread |{columns}");
    line!(page, "|---|---|---|---|---|{}", "---|".repeat(invariants.len()));
    let count = case.strong.series.first().map_or(0, |series| series.points.len());
    // The coarsest, one in the middle and the finest.
    let mut shown = vec![0, count / 2, count.saturating_sub(1)];
    shown.dedup();
    for l in shown {
        for series in &case.strong.series {
            let Some(point) = series.points.get(l) else { continue };
            let interval = point.lo.zip(point.hi);
            let interval = interval
                .map_or(String::new(), |(lo, hi)| format!(" [{}, {}]", number(lo), number(hi)));
            let exact = point
                .error_exact_areas
                .map_or(String::new(), |e| format!(", with exact areas {}", number(e)));
            let defects: Vec<String> = point.defects.iter().map(|defect| number(*defect)).collect();
            let defects = if defects.is_empty() {
                String::new()
            } else {
                format!(" {} |", defects.join(" | "))
            };
            line!(
                page,
                "| {} | `{}` | {}{interval}{exact} | {} | +{:.0} % |{defects}",
                point.steps,
                series.scheme,
                number(point.error),
                number(1e9 * point.time.min_s / point.steps as f64),
                100.0 * (point.time.median_s / point.time.min_s - 1.0)
            );
        }
    }
    line!(page);
}

const METHOD: &str = "\
**Errors** come from ladders that drive all schemes at all step sizes with the same noise, untimed, and are the same bits for the same seed. A strong \
error is (E|y_N − y(T)|²)^½; the reference is `sexp` on the finest steps where there is one noise, and `sexp-levy` where noises do not commute, with \
areas drawn on the finest steps. It has an error of its own: that of its scheme at its number of steps, which stands with each case.

**Times** are those of the block kernels on one thread: increments drawn and clipped, areas drawn and clipped for `sexp-levy`, steps; four blocks of 32 paths \
share the damping. Every repetition times every scheme at every step size once; curves show the smallest of the repetitions, bars and the column *spread* how far \
the median lies above it. Step sizes are the same for all schemes, and so are the increments of a step: one normal for each noise.

**`sexp-levy`** is timed with areas drawn at its own step by the method of Mrongowius and Rößler, with as many terms as strong order one asks: a root-mean-square \
error of at most τ^(3/2) in each area. On a ladder areas are joined from those of the finest steps and have no such error; so an error of the size of the proven bound \
is added to them. The bound is about twice the actual error: the strong errors of `sexp-levy` are upper estimates, and its error with exact areas stands beside them.

**Expectations.** A bias is the mean difference to the reference on the same noise, extrapolated in the step size. A plain Monte Carlo estimate over N paths of time t, with \
bias b and standard deviation σ of φ(y_N), has the root-mean-square error ε = (b² + σ²/N)^½; it costs t·σ²/(ε² − b²). What an accuracy ε costs with a scheme is the smallest of these over \
the measured step sizes. The bias is taken at the upper end of its 95 % interval, so that a bias that is not resolved counts as large as it may be.

**Between the points** costs are interpolated linearly in the logarithms; nothing is extrapolated.
";

const FIELDS: &str = "\
## `work-precision.json`

The Rust types are in `crates/precision/src/results.rs`. `schema` is 1 and is raised whenever a reader of an older version would misread a newer one. Everything but \
`provenance` and what is called `time`, with the `costs` that follow from it, is the same for the same seed and mode.

| field | meaning |
|---|---|
| `schema`, `provenance` | as in [`results.json`](results.md) |
| `clock` | what the times are |
| `cases` | the problems |

A **case** has `id`, `title`, `setup`, `invariants` (names), `strong` and `weak`. `strong` and `weak` have `samples`, `failed` (paths left out of everything), `failures` (the first few in \
words) and `reference`; `strong` has `series` of `scheme` and `points`, `weak` has `observables` of `name`, `exact` (where E φ(y(T)) is known without sampling), `reference_mean`, `reference_se` and \
`series` of `scheme`, `points` and `costs`.

| point of | fields |
|---|---|
| `strong` | `steps` of a path, `tau`, `error`, `se`, `lo` and `hi` (bootstrap-t interval of 95 %), `error_exact_areas` and `area_terms` (of `sexp-levy`), `defects` (root mean square of F(y_N)/(e^(−p∫γ)F(y₀)) − 1 for each of the case's invariants), `time` |
| `weak` | `steps`, `tau`, `bias`, `se`, `standard_deviation` (of φ(y_N)), `time` |

The **costs** of a weak series are those of the accuracies 10^(−k/4): `accuracy`, `steps` (the cheapest for it), `paths`, `cost_s`.

A **time** is that of one path in seconds: `min_s`, `median_s` and `max_s` over `repetitions`, each over `paths` paths.
";
