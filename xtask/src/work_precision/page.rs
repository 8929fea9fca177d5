//! `docs/work-precision.md`, made from the measurements.

use precision::cost_at;
use precision::results::{Case, Measurements, StrongSeries, WeakObservable};
use report::provenance::generated_by;
use report::{Page, number};

use super::curves::{strong_costs, strong_figure, weak_costs, weak_figure};
use super::words::{self, cheapest, strong_series, targets};

/// The whole page.
pub fn page(measured: &Measurements) -> Page {
    let mut page = Page::new("Work and precision");
    page.paragraph(format!(
        "Which scheme is cheapest for which error? {} All numbers and all sentences with one are \
         made from the measurements; times hold for that machine. The fields of \
         `work-precision.json` are in [results.md](results.md#work-precisionjson).",
        generated_by(&measured.provenance)
    ));
    page.paragraph(METHOD);
    page.paragraph(format!("Times are: {}.", measured.clock));
    page.heading(2, "Conclusions");
    conclusions(&mut page, &measured.cases);
    page.heading(3, "What being conformal costs");
    page.paragraph(WORTH);
    let head = ["case", "strong error", "cheapest explicit", "`sexp` costs", "Casimir"];
    let defects = ["explicit defect", "`sexp` defect"];
    page.table(head.iter().chain(&defects), measured.cases.iter().filter_map(worth));
    for case in &measured.cases {
        section(&mut page, case);
    }
    page
}

/// What the strong errors say, and whether Lévy areas pay.
pub fn conclusions(page: &mut Page, cases: &[Case]) {
    page.list(cases.iter().map(|case| format!("**{}.** {}", case.title, words::strong(case))));
    for (case, text) in cases.iter().filter_map(|case| Some((case, words::areas(case)?))) {
        page.paragraph(format!("**Are Lévy areas worth their price?** {}: {text}", case.title));
    }
}

/// `sexp` beside the cheapest explicit scheme at one error; none where the two reach no common one.
fn worth(case: &Case) -> Option<[String; 7]> {
    let sexp = strong_series(case, "sexp")?;
    let of = |id: &str| strong_series(case, id).map(|series| (series, strong_costs(series)));
    let (explicit, curves): (Vec<&StrongSeries>, Vec<_>) =
        ["heun", "em"].into_iter().filter_map(of).unzip();
    let own = strong_costs(sexp);
    let mut errors = targets(&curves).into_iter().rev();
    let (error, own) = errors.find_map(|error| Some((error, cost_at(&own, error)?)))?;
    let costs = explicit.iter().zip(&curves).filter_map(|(s, c)| Some((*s, cost_at(c, error)?)));
    let (best, cost) = costs.min_by(|a, b| a.1.total_cmp(&b.1))?;
    let casimir = case.invariants.iter().position(|name| name == "C");
    let defect = |series: &StrongSeries| {
        let point = series.points.iter().find(|point| point.error <= error)?;
        Some(number(*point.defects.get(casimir?)?))
    };
    let [explicit, conformal] = [best, sexp].map(|s| defect(s).unwrap_or_else(|| "–".to_owned()));
    Some([
        case.title.clone(),
        number(error),
        format!("`{}`", best.scheme),
        format!("{} ×", number(own / cost)),
        casimir.map_or("none", |_| "C").to_owned(),
        explicit,
        conformal,
    ])
}

fn section(page: &mut Page, case: &Case) {
    let (strong, weak) = (&case.strong, &case.weak);
    let file = |kind: &str| format!("work-precision-{}-{kind}.svg", case.id);
    page.heading(2, &case.title);
    page.paragraph(format!(
        "`{}`: {}. {} paths, against {}.{}",
        case.id,
        case.setup,
        strong.samples,
        strong.reference,
        failures(strong.failed, &strong.failures)
    ));
    let what = "Strong error against processor time and steps";
    page.figure(&file("strong"), what, strong_figure(case).svg());
    page.paragraph(words::strong(case));
    page.paragraph("Microseconds of a path for a strong error, the cheapest in bold:");
    let curves = strong.series.iter().map(strong_costs).collect();
    costs(page, case, "error", curves);
    steps(page, case);
    page.heading(3, "Expectations");
    page.paragraph(format!(
        "{} paths, against {}. {}{}",
        weak.samples,
        weak.reference,
        checked(&weak.observables),
        failures(weak.failed, &weak.failures)
    ));
    let what = "Accuracy of an expectation against processor time";
    page.figure(&file("weak"), what, weak_figure(case).svg());
    for observable in &weak.observables {
        page.paragraph(format!(
            "{} Seconds of an estimate of a given root-mean-square error:",
            words::weak(observable)
        ));
        costs(page, case, "accuracy", observable.series.iter().map(weak_costs).collect());
    }
}

fn failures(failed: u64, failures: &[String]) -> String {
    match failures.first() {
        Some(first) => format!(
            " {failed} paths are left out of every scheme and step size, because one of them \
             failed; the first: {first}."
        ),
        None => String::new(),
    }
}

/// The reference beside the expectations that are known without sampling.
fn checked(observables: &[WeakObservable]) -> String {
    let known = observables.iter().filter_map(|observable| {
        let deviation = (observable.reference_mean - observable.exact?) / observable.reference_se;
        Some(format!(
            "E[{}] of the reference is {deviation:+.1} standard errors from its exact value. ",
            observable.name
        ))
    });
    known.collect()
}

/// A table of costs by target.
fn costs(page: &mut Page, case: &Case, what: &str, curves: Vec<Vec<(f64, f64)>>) {
    let names = case.strong.series.iter().map(|series| format!("`{}`", series.scheme));
    let rows = targets(&curves).into_iter().map(|error| {
        let best = cheapest(&curves, error);
        let cell = |(n, curve): (usize, &Vec<(f64, f64)>)| match cost_at(curve, error) {
            None => "–".to_owned(),
            Some(cost) if best == Some(n) => format!("**{}**", number(cost)),
            Some(cost) => number(cost),
        };
        std::iter::once(number(error))
            .chain(curves.iter().enumerate().map(cell))
            .collect::<Vec<String>>()
    });
    page.table(std::iter::once(what.to_owned()).chain(names), rows);
}

/// Everything measured at the coarsest steps, in the middle and at the finest.
fn steps(page: &mut Page, case: &Case) {
    let count = case.strong.series.first().map_or(0, |series| series.points.len());
    let mut shown = vec![0, count / 2, count.saturating_sub(1)];
    shown.dedup();
    let points = shown.into_iter().flat_map(|l| {
        let series = case.strong.series.iter();
        series.filter_map(move |series| Some((&series.scheme, series.points.get(l)?.clone())))
    });
    let rows = points.map(|(scheme, point)| {
        let mut error = number(point.error);
        if let Some((lo, hi)) = point.lo.zip(point.hi) {
            error += &format!(" [{}, {}]", number(lo), number(hi));
        }
        if let Some(exact) = point.error_exact_areas {
            error += &format!(", with exact areas {}", number(exact));
        }
        let cells = [
            point.steps.to_string(),
            format!("`{scheme}`"),
            error,
            number(1e9 * point.time.min_s / point.steps as f64),
            format!("+{:.0} %", 100.0 * (point.time.median_s / point.time.min_s - 1.0)),
        ];
        cells.into_iter().chain(point.defects.into_iter().map(number))
    });
    let head = ["steps", "scheme", "strong error, 95 %", "ns a step", "spread"].map(str::to_owned);
    let defects = case.invariants.iter().map(|name| format!("defect of {name}"));
    page.table(head.into_iter().chain(defects), rows);
}

const METHOD: &str = "\
**Errors** come from ladders that drive all schemes at all step sizes with the same noise, untimed;
they are the same bits for the same seed. A strong error is (E|y_N − y(T)|²)^½. The reference is
`sexp` on the finest steps where there is one noise, and `sexp-levy` where noises do not commute,
with areas drawn on the finest steps. Its own error is that of its scheme at its number of steps,
which stands with each case.

**Times** are those of the block kernels on one thread: increments drawn and clipped, areas drawn and
clipped for `sexp-levy`, steps; four blocks of 32 paths share the damping. Every repetition times
every scheme at every step size once. Curves show the smallest time; bars and the column *spread*
show how far the median lies above it. All schemes take the same step sizes and increments: one
normal for each noise and step.

**`sexp-levy`** is timed with areas drawn at its own step by the method of Mrongowius and Rößler, with
as many terms as strong order one needs: a root-mean-square error of at most τ^(3/2) in each area. A
ladder joins areas from those of the finest steps, without such an error; so an error of the size of
the proven bound is added to them. The bound is about twice the actual error: the strong errors of
`sexp-levy` are upper estimates, and its error with exact areas stands beside them.

**Expectations.** A bias is the mean difference to the reference on the same noise, extrapolated in
the step size. A plain Monte Carlo estimate over N paths of time t, with bias b and standard deviation
σ of φ(y_N), has the root-mean-square error ε = (b² + σ²/N)^½ and costs t·σ²/(ε² − b²). The cost of an
accuracy ε is the smallest over the measured step sizes. The bias is taken at the upper end of its
95 % interval, so that an unresolved bias counts as large as it may be.

**Between the points** costs are interpolated linearly in the logarithms; nothing is extrapolated.";

const WORTH: &str = "\
At the smallest of the errors 10^(−k/2) that `sexp` and an explicit scheme both reach: the cheapest
explicit scheme, the cost of `sexp` in multiples of it, and the distance of both from the conformal
law of the Casimir (root mean square of F(y_N)/(e^(−p∫γ)F(y₀)) − 1, at the measured number of steps
next above).";
