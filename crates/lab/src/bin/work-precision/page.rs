//! `docs/work-precision.md`, made from the measurements.

use report::provenance::generated_by;
use report::{Page, number};
use verify::work_precision::cost_at;

use crate::conclusions::{self, cheapest, targets, winner};
use crate::figures;
use crate::results::{
    Case, Curve, Kind, Measurements, Sampled, Series, StrongPoint, WeakObservable,
};

/// The whole page with its figures.
pub fn page(measured: &Measurements) -> Page {
    let mut page = Page::new("Work and precision");
    page.paragraph(format!(
        "Which scheme is cheapest for which error? {} All numbers and all sentences that contain one \
         are made from the measurements; times hold for that machine.",
        generated_by(&measured.provenance)
    ));
    page.paragraph(METHOD);
    page.paragraph(format!("Times are: {}.", measured.clock));
    page.heading(2, "Conclusions");
    let conclusion = |case: &Case| format!("**{}.** {}", case.title, conclusions::strong(case));
    page.list(measured.cases.iter().map(conclusion));
    for case in &measured.cases {
        if let Some(text) = conclusions::areas(case) {
            page.paragraph(format!("**Are Lévy areas worth their price?** {}: {text}", case.title));
        }
    }
    price_of_structure(&mut page, measured);
    for case in &measured.cases {
        section(&mut page, case);
    }
    page.paragraph(
        "The numbers are in `work-precision.json`, whose fields stand in [results.md](results.md).",
    );
    page
}

/// `sexp` beside the cheapest explicit scheme, at one error of each case.
fn price_of_structure(page: &mut Page, measured: &Measurements) {
    page.heading(3, "What being conformal costs");
    page.paragraph(
        "At the smallest of the errors 10^(−k/2) that `sexp` and an explicit scheme both reach: the \
         cheapest explicit scheme, what `sexp` costs in multiples of it, and how far both are from \
         the conformal law of the Casimir there (root mean square of F(y_N)/(e^(−p∫γ)F(y₀)) − 1, at \
         the measured number of steps next above).",
    );
    page.table(
        [
            "case",
            "strong error",
            "cheapest explicit",
            "`sexp` costs",
            "Casimir",
            "explicit defect",
            "`sexp` defect",
        ],
        measured.cases.iter().filter_map(price),
    );
}

/// A row of that table; nothing where no error is reached by both.
fn price(case: &Case) -> Option<[String; 7]> {
    let sexp = conclusions::series(case, Kind::Sexp).next()?;
    let explicit: Vec<_> = conclusions::series(case, Kind::Explicit).collect();
    let curves: Vec<Curve> = explicit.iter().map(|series| series.curve()).collect();
    let own = sexp.curve();
    let error = targets(&curves).into_iter().rfind(|&error| cost_at(&own, error).is_some())?;
    let (best, cost) = cheapest(&curves, error)?;
    let casimir = case.invariants.iter().position(|name| name == "C");
    let defect = |series: &Series<StrongPoint>| {
        let point = series.points.iter().find(|point| point.work.error <= error);
        let defect = point.zip(casimir).and_then(|(point, index)| point.defects.get(index));
        defect.map_or("–".to_owned(), |defect| number(*defect))
    };
    Some([
        case.title.to_owned(),
        number(error),
        format!("`{}`", explicit[best].scheme),
        format!("{} ×", number(cost_at(&own, error)? / cost)),
        casimir.map_or("none", |_| "C").to_owned(),
        defect(explicit[best]),
        defect(sexp),
    ])
}

fn section(page: &mut Page, case: &Case) {
    page.heading(2, case.title);
    let sampled = &case.strong.sampled;
    page.paragraph(format!("`{}`: {}. {}", case.id, case.setup, paths(sampled)));
    let figure = |kind| format!("work-precision-{}-{kind}.svg", case.id);
    page.figure(
        &figure("strong"),
        "Strong error against processor time and steps",
        figures::strong(case),
    );
    page.paragraph(conclusions::strong(case));
    let names: Vec<&str> = case.strong.series.iter().map(|series| series.scheme).collect();
    let curves: Vec<Curve> = case.strong.series.iter().map(Series::<StrongPoint>::curve).collect();
    page.paragraph("Microseconds of a path for a strong error, the cheapest in bold:");
    costs(page, "error", &names, &curves);
    steps(page, case);
    page.heading(3, "Expectations");
    let weak = &case.weak;
    page.paragraph(format!("{} {}", paths(&weak.sampled), checked(&weak.observables)));
    page.figure(
        &figure("weak"),
        "Accuracy of an expectation against processor time",
        figures::weak(case),
    );
    for observable in &weak.observables {
        page.paragraph(format!(
            "{} Seconds of an estimate of a given root-mean-square error:",
            conclusions::weak(observable)
        ));
        let curves: Vec<Curve> = observable.series.iter().map(|series| series.curve()).collect();
        costs(page, "accuracy", &names, &curves);
    }
}

/// How many paths, and which are left out.
fn paths(sampled: &Sampled) -> String {
    let paths = format!("{} paths, against {}.", sampled.samples, sampled.reference);
    match sampled.failures.first() {
        None => paths,
        Some(first) => format!(
            "{paths} {} paths are left out of every scheme and step size, because one of them \
             failed; the first: {first}.",
            sampled.failed
        ),
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
fn costs(page: &mut Page, what: &str, names: &[&str], curves: &[Curve]) {
    let head = [what.to_owned()].into_iter().chain(names.iter().map(|name| format!("`{name}`")));
    let rows = targets(curves).into_iter().map(|error| {
        let best = winner(curves, error);
        let cell = |(n, curve): (usize, &Curve)| match cost_at(curve, error) {
            None => "–".to_owned(),
            Some(cost) if best == Some(n) => format!("**{}**", number(cost)),
            Some(cost) => number(cost),
        };
        [number(error)].into_iter().chain(curves.iter().enumerate().map(cell)).collect::<Vec<_>>()
    });
    page.table(head, rows);
}

/// Everything measured at the coarsest step, one in the middle and the finest.
fn steps(page: &mut Page, case: &Case) {
    let head = ["steps", "scheme", "strong error, 95 %", "ns a step", "spread"];
    let defects = case.invariants.iter().map(|name| format!("defect of {name}"));
    let count = case.strong.series.first().map_or(0, |series| series.points.len());
    let mut shown = vec![0, count / 2, count.saturating_sub(1)];
    shown.dedup();
    let mut rows = Vec::new();
    for l in shown {
        for series in &case.strong.series {
            rows.extend(series.points.get(l).map(|point| row(series.scheme, point)));
        }
    }
    page.table(head.map(str::to_owned).into_iter().chain(defects), rows);
}

fn row(
    scheme: &str,
    StrongPoint { work, defects, error_exact_areas, .. }: &StrongPoint,
) -> Vec<String> {
    let mut error = number(work.error);
    if let (Some(lo), Some(hi)) = (work.lo, work.hi) {
        error += &format!(" [{}, {}]", number(lo), number(hi));
    }
    if let Some(exact) = error_exact_areas {
        error += &format!(", with exact areas {}", number(*exact));
    }
    let mut cells = vec![
        work.steps.to_string(),
        format!("`{scheme}`"),
        error,
        number(1e9 * work.time.min_s / work.steps as f64),
        format!("+{:.0} %", 100.0 * (work.time.median_s / work.time.min_s - 1.0)),
    ];
    cells.extend(defects.iter().map(|&defect| number(defect)));
    cells
}

const METHOD: &str = "\
**Errors** come from ladders that drive all schemes at all step sizes with the same noise. They are \
not timed and are the same bits for the same seed. A strong error is (E|y_N − y(T)|²)^½. The \
reference is `sexp` on the finest steps where there is one noise, and `sexp-levy` where noises do not \
commute, with areas drawn on the finest steps. The reference has the error of its scheme at its \
number of steps, which each case names.

**Times** are those of `mc::Ladder` on one thread: increments drawn and clipped, areas drawn and \
clipped for `sexp-levy`, steps, and a check that every state is finite; four blocks of 32 paths share \
the damping. Every repetition times \
every scheme at every step size once. Curves show the smallest of the repetitions; bars and the \
column *spread* show how far the median lies above it. Step sizes are the same for all schemes, and \
so are the increments of a step: one normal for each noise.

**`sexp-levy`** is timed with areas drawn at its own step by the method of Mrongowius and Rößler, \
with as many terms as strong order one asks: a root-mean-square error of at most τ^(3/2) in each \
area. On a ladder areas are joined from those of the finest steps and have no such error, so an error \
of the size of the proven bound is added to them. The bound is about twice the actual error: the \
strong errors of `sexp-levy` are upper estimates, and its error with exact areas stands beside them.

**Expectations.** A bias is the mean difference to the reference on the same noise, extrapolated in \
the step size. A plain Monte Carlo estimate over N paths of time t, with bias b and standard \
deviation σ of φ(y_N), has the root-mean-square error ε = (b² + σ²/N)^½; it costs t·σ²/(ε² − b²). \
What an accuracy ε costs with a scheme is the smallest of these over the measured step sizes. The \
bias is taken at the upper end of its 95 % interval, so that a bias that is not resolved counts as \
large as it may be.

**Between the points** costs are interpolated linearly in the logarithms; nothing is extrapolated.";
