//! `docs/work-precision.md`, made from the measurements.

use analysis::compare::{Curve, Sampled, Series, StrongPoint, WeakObservable, cost_at};
use report::{Page, figure, number, provenance::generated_by};
use verify::setups::Kind;

use crate::{
    conclusions::{self, cheapest, targets, weak_curves, winner},
    results::{Case, Measurements, in_microseconds},
};

/// The whole page with its figures.
pub fn page(measured: &Measurements) -> Page {
    let mut page = Page::new("Work and precision");
    page.paragraph(format!(
        "Which scheme is cheapest for which error? {} Times hold for that machine.",
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
    page.heading(3, "What being conformal costs");
    page.paragraph(PRICE);
    let head = [
        "case",
        "strong error",
        "cheapest explicit",
        "`sexp` costs",
        "explicit defect",
        "`sexp` defect",
    ];
    page.table(head, measured.cases.iter().filter_map(price));
    for case in &measured.cases {
        section(&mut page, case);
    }
    page.paragraph("The fields of `work-precision.json` are in [results.md](results.md).");
    page
}

/// A row that compares `sexp` with the cheapest explicit scheme; nothing where they reach no error
/// in common.
fn price(case: &Case) -> Option<[String; 6]> {
    let sexp = case.series(|kind| kind == Kind::Sexp).next()?;
    let explicit = |kind| matches!(kind, Kind::Heun | Kind::EulerMaruyama);
    let explicit: Vec<_> = case.series(explicit).collect();
    let curves: Vec<Curve> = explicit.iter().copied().map(in_microseconds).collect();
    let own = in_microseconds(sexp).points;
    let error = targets(&curves).into_iter().rfind(|&error| cost_at(&own, error).is_some())?;
    let (best, cost) = cheapest(&curves, error)?;
    let casimir = case.invariants.iter().position(|name| *name == "C");
    let defect = |series: &Series<StrongPoint>| {
        let point = series.points.iter().find(|point| point.error <= error);
        let defect = point.zip(casimir).map(|(point, index)| point.defects[index]);
        defect.map_or("–".into(), number)
    };
    Some([
        case.title.into(),
        number(error),
        format!("`{}`", explicit[best].scheme),
        format!("{} ×", number(cost_at(&own, error)? / cost)),
        defect(explicit[best]),
        defect(sexp),
    ])
}

fn section(page: &mut Page, case: &Case) {
    let (strong, weak) = (&case.strong, &case.weak);
    let name = |kind| format!("work-precision-{}-{kind}.svg", case.id);
    page.heading(2, case.title);
    page.paragraph(format!("`{}`: {}. {}", case.id, case.setup, paths(&strong.sampled)));
    let drawing = figure::strong_against_cost(case.title, &strong.series);
    page.figure(&name("strong"), "Strong error against cost", drawing);
    page.paragraph("Microseconds of a path, the cheapest in bold:");
    costs(page, "error", &case.curves());
    page.paragraph(conclusions::conformal(case).unwrap_or_default());
    steps(page, case);
    page.heading(3, "Expectations");
    page.paragraph(format!("{} {}", paths(&weak.sampled), checked(&weak.observables)));
    let drawing = figure::expectations_against_cost(case.title, &weak.observables);
    page.figure(&name("weak"), "Accuracy of expectations against cost", drawing);
    for observable in &weak.observables {
        page.paragraph(format!("{} Seconds of an estimate:", conclusions::weak(observable)));
        costs(page, "accuracy", &weak_curves(observable));
    }
}

/// How many paths, and which are left out.
fn paths(sampled: &Sampled) -> String {
    let paths = format!("{} paths, against {}.", sampled.samples, sampled.reference);
    match sampled.failures.first() {
        None => paths,
        Some(first) => format!(
            "{paths} {} paths, on which some scheme failed, are left out; the first: {first}.",
            sampled.failed
        ),
    }
}

/// The reference beside the expectations that are known without sampling.
fn checked(observables: &[WeakObservable]) -> String {
    let known = observables.iter().filter_map(|observable| {
        let deviation = (observable.reference_mean - observable.exact?) / observable.reference_se;
        Some(format!(
            "The reference's E[{}] is {deviation:+.1} standard errors off the exact value.",
            observable.name
        ))
    });
    known.collect::<Vec<_>>().join(" ")
}

/// A table of costs by target.
fn costs(page: &mut Page, what: &str, curves: &[Curve]) {
    let names = curves.iter().map(|curve| format!("`{}`", curve.scheme));
    let rows = targets(curves).into_iter().map(|error| {
        let best = winner(curves, error);
        let cell = |(n, curve): (usize, &Curve)| match cost_at(&curve.points, error) {
            None => "–".into(),
            Some(cost) if best == Some(n) => format!("**{}**", number(cost)),
            Some(cost) => number(cost),
        };
        let costs = curves.iter().enumerate().map(cell);
        [number(error)].into_iter().chain(costs).collect::<Vec<_>>()
    });
    page.table([what.into()].into_iter().chain(names), rows);
}

/// Everything measured at the coarsest step, one in the middle and the finest.
fn steps(page: &mut Page, case: &Case) {
    let head = ["steps", "scheme", "strong error, 95 %", "ns a step", "spread"];
    let defects = case.invariants.iter().map(|name| format!("defect of {name}"));
    let series = &case.strong.series;
    let count = series.first().map_or(0, |series| series.points.len());
    let shown = [0, count / 2, count.saturating_sub(1)];
    let rows = shown
        .iter()
        .flat_map(|&l| series.iter().filter_map(move |s| Some(row(&s.scheme, s.points.get(l)?))));
    page.table(head.map(str::to_owned).into_iter().chain(defects), rows);
}

fn row(scheme: &str, point: &StrongPoint) -> Vec<String> {
    let mut error = number(point.error);
    if let Some((lo, hi)) = point.lo.zip(point.hi) {
        error += &format!(" [{}, {}]", number(lo), number(hi));
    }
    if !point.resolved {
        error += ", not resolved";
    }
    if let Some(exact) = point.error_exact_areas {
        error += &format!(", with exact areas {}", number(exact));
    }
    let ns = point.time.map_or("–".into(), |time| number(1e9 * time.min_s / point.steps as f64));
    let spread = point.time.map_or("–".into(), |time| {
        format!("+{:.0} %", 100.0 * (time.median_s / time.min_s - 1.0))
    });
    let mut cells = vec![point.steps.to_string(), format!("`{scheme}`"), error, ns, spread];
    cells.extend(point.defects.iter().map(|&defect| number(defect)));
    cells
}

const METHOD: &str = "\
**Errors.** All schemes at all step sizes see the same noise. A strong error is (E|y_N − \
y(T)|²)^½. The reference is `sexp` on the finest steps, or `sexp-levy` where noises do not \
commute; its own error, bounded by its differences at three step sizes, is added to every interval. \
Points below four times that error are not used.

**Times** are those of `mc::Ladder` on one thread, with noise and truncation. Every repetition \
times every scheme at every step size once. Curves show the smallest, bars and the column \
*spread* how far the median lies above it.

**`sexp-levy`** is timed with areas drawn at its own step by the method of Mrongowius and Rößler, \
with a root-mean-square error of at most τ^(3/2), as strong order one asks. Areas on a ladder \
have no such error, so one of the size of the proven bound, about twice the actual one, is added: \
strong errors are upper estimates. The error with exact areas stands beside them.

**Expectations.** A bias b is the mean difference to the reference on the same noise, \
extrapolated in the step size. N paths of time t, σ being the standard deviation of φ(y_N), give \
the root-mean-square error ε = (b² + σ²/N)^½ and cost t·σ²/(ε² − b²). Shown is the smallest cost \
over the step sizes, with b at the upper end of its 95 % interval.

**Between points** costs are interpolated linearly in the logarithms. The intervals of multiples \
of `heun` are of 95 % and follow from the ratio of both errors at the nearest number of steps, on \
the same paths, and from the order between the neighbouring points. Times have no part in them.";

const PRICE: &str = "\
At the smallest error 10^(−k/2) that `sexp` and an explicit scheme both reach: the cheapest \
explicit scheme, how many times its cost `sexp` costs, and the root mean square of \
F(y_N)/(e^(−p∫γ)F(y₀)) − 1 for the Casimir F.";
