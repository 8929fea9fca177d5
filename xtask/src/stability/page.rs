//! `docs/stability.md`, made from the results.

use report::provenance::generated_by;
use report::{Page, anchor, distinct, number};
use stability::results::{Case, Fuzzed, Growth, Row, Stability, Verdict};

use super::curves;

/// The whole page.
pub fn page(results: &Stability) -> Page {
    let mut page = Page::new("Stability");
    page.paragraph(format!(
        "How the schemes behave where numerical codes break. {} The same seed gives the same bits. \
         The fields of `stability.json` are in [results.md](results.md#stabilityjson).",
        generated_by(&results.provenance)
    ));
    page.paragraph(METHOD);
    page.heading(2, "Summary");
    summary(&mut page, results);
    for case in &results.cases {
        section(&mut page, case);
        // The figure stands with the first of its two cases.
        if case.id == "stiff-damping"
            && let Some(figure) = curves::stiff(results)
        {
            let what = "The factor of a step over γτ, and the distance from the law over ω";
            page.figure("stability-stiff.svg", what, figure.svg());
        }
    }
    if !results.growth.is_empty() {
        growth(&mut page, &results.growth);
    }
    if !results.fuzz.is_empty() {
        fuzz(&mut page, &results.fuzz);
    }
    page
}

/// The verdicts in the order of the columns of the summary, in words.
const VERDICTS: [(Verdict, &str); 4] = [
    (Verdict::Holds, "holds"),
    (Verdict::FailsAsItMust, "fails as predicted"),
    (Verdict::Observed, "observed"),
    (Verdict::Refuted, "**REFUTED**"),
];

fn words(verdict: Verdict) -> &'static str {
    VERDICTS.iter().find(|(kind, _)| *kind == verdict).map_or("", |(_, words)| words)
}

/// The counts of every case, and what was refuted.
pub fn summary(page: &mut Page, results: &Stability) {
    let row = |title: &str, verdicts: Vec<Verdict>| {
        let count = |kind| verdicts.iter().filter(|verdict| **verdict == kind).count();
        let link = format!("[{title}](#{})", anchor(title));
        std::iter::once(link).chain(VERDICTS.map(|(kind, _)| count(kind).to_string()))
    };
    let case = |case: &Case| row(&case.title, case.rows.iter().map(|row| row.verdict).collect());
    let runs = || results.growth.iter();
    let long = runs().next().map(|_| row(LONG, runs().map(|run| run.verdict).collect()));
    let head = std::iter::once("case").chain(VERDICTS.map(|(_, words)| words));
    page.table(head, results.cases.iter().map(case).chain(long));
    if !results.fuzz.is_empty() {
        let (link, (inputs, failures)) = (anchor(FUZZ), total(&results.fuzz));
        page.paragraph(format!("[{FUZZ}](#{link}): {inputs} inputs, {failures} failures."));
    }
    let refuted = |case: &Case| -> Vec<String> {
        let rows = case.rows.iter().filter(|row| row.verdict == Verdict::Refuted);
        rows.map(|row| format!("{} {} {}: {}", case.id, row.setting, row.scheme, cell(row)))
            .collect()
    };
    let runs = runs().filter(|run| run.verdict == Verdict::Refuted);
    let runs = runs.map(|run| format!("{}: {} {}", run.id, exponent(run), words(run.verdict)));
    page.list(results.cases.iter().flat_map(refuted).chain(runs));
}

/// Inputs and failures of all fuzzed targets.
fn total(fuzz: &[Fuzzed]) -> (u64, u64) {
    (fuzz.iter().map(|f| f.inputs).sum(), fuzz.iter().map(|f| f.failures).sum())
}

const LONG: &str = "Long times";
const FUZZ: &str = "Arbitrary inputs";

fn section(page: &mut Page, case: &Case) {
    page.heading(2, &case.title);
    page.paragraph(format!("`{}`. {}", case.id, case.setup));
    page.paragraph(format!("*Exact mathematics.* {}", case.mathematics));
    page.paragraph(format!("*Guarantee.* {}", case.guarantee));
    page.paragraph(format!("Shown: {}.", case.quantity));
    let schemes = distinct(case.rows.iter().map(|row| row.scheme.as_str()));
    let settings = distinct(case.rows.iter().map(|row| row.setting.as_str()));
    let rows = settings.into_iter().map(|setting| {
        let rows = || case.rows.iter().filter(move |row| row.setting == setting);
        let exact = distinct(rows().filter_map(|row| row.exact).map(number)).join("; ");
        let held = rows().filter(|row| row.verdict == Verdict::Holds);
        let bound = held.filter_map(|row| row.bound).reduce(f64::max);
        let of = |scheme: &&str| rows().find(|row| row.scheme == *scheme);
        let cells = schemes.iter().map(|scheme| of(scheme).map_or(String::new(), cell));
        [setting.to_owned(), exact, bound.map_or(String::new(), number)]
            .into_iter()
            .chain(cells)
            .collect::<Vec<String>>()
    });
    let first = [case.varied.clone(), "exact".to_owned(), "bound".to_owned()];
    page.table(first.into_iter().chain(schemes.iter().map(|scheme| format!("`{scheme}`"))), rows);
}

fn cell(row: &Row) -> String {
    let mark = match row.verdict {
        Verdict::Holds => " ✓",
        Verdict::FailsAsItMust => " ✗",
        Verdict::Observed => "",
        Verdict::Refuted => " **REFUTED**",
    };
    let parts: Vec<String> =
        row.measured.map(number).into_iter().chain(row.error.clone()).collect();
    format!("{}{mark}", if parts.is_empty() { "–".to_owned() } else { parts.join("; ") })
}

fn exponent(run: &Growth) -> String {
    format!("{:.3} [{:.3}, {:.3}]", run.exponent, run.lo, run.hi)
}

fn growth(page: &mut Page, growth: &[Growth]) {
    page.heading(2, LONG);
    page.paragraph(GROWTH);
    let what = "Root mean square of the distance over the number of steps";
    page.figure("stability-growth.svg", what, curves::growth(growth).svg());
    let rows = growth.iter().filter_map(|run| {
        let end = run.points.last()?;
        Some([
            format!("`{}`", run.id),
            format!("`{}`", run.scheme),
            run.invariant.clone(),
            format!("{:.0e}", end.steps as f64),
            number(end.rms),
            format!("{:+.1e}", end.mean),
            number(end.max),
            number(run.linear),
            exponent(run),
            words(run.verdict).to_owned(),
        ])
    });
    let head = ["run", "scheme", "law of", "steps", "root mean square", "mean", "largest", "n·ε"];
    page.table(head.into_iter().chain(["exponent, 95 %", "verdict"]), rows);
    let above = growth.iter().filter(|run| run.verdict == Verdict::Holds && run.lo > 0.5);
    let above: Vec<String> = above.map(|run| format!("`{}`", run.id)).collect();
    if !above.is_empty() {
        page.paragraph(format!(
            "The interval of the exponent lies above that of a random walk for {}: the bound holds, \
             but a small drift remains, or a walk that all paths share.",
            above.join(", ")
        ));
    }
    let setup = |run: &Growth| format!("`{}`: {} {} paths.", run.id, run.setup, run.paths);
    page.list(growth.iter().map(setup));
}

fn fuzz(page: &mut Page, fuzz: &[Fuzzed]) {
    page.heading(2, FUZZ);
    page.paragraph(FUZZING);
    let rows = fuzz.iter().map(|fuzzed| {
        let numbers = [fuzzed.inputs, fuzzed.accepted, fuzzed.refused].map(|n| n.to_string());
        let iterations = match fuzzed.most_iterations {
            0 => "–".to_owned(),
            most => most.to_string(),
        };
        let words = [fuzzed.target.clone(), fuzzed.checks.clone()].into_iter();
        words.chain(numbers).chain([iterations, fuzzed.failures.to_string()])
    });
    let head = ["target", "what is checked", "inputs", "accepted", "refused", "most iterations"];
    page.table(head.into_iter().chain(["failures"]), rows);
    let (inputs, failures) = total(fuzz);
    page.paragraph(format!(
        "Together {inputs} inputs: {failures} panics, NaN or other broken checks."
    ));
    let of = |fuzzed: &Fuzzed| -> Vec<String> {
        fuzzed.examples.iter().map(|example| format!("{}: {example}", fuzzed.target)).collect()
    };
    page.list(fuzz.iter().flat_map(of));
}

const METHOD: &str = "\
Every case runs every scheme: `sexp` starts with the fixed point, `sexp-newton` with Newton's
method; `sexp-levy` runs where noises do not commute; `midpoint`, `heun` and `em` run everywhere. A
guarantee is a bound that is derived, not fitted; the derivations stand in the sources. Marks: ✓ the
guarantee holds; ✗ the scheme fails, as theory predicts and the test requires; no mark: nothing is
guaranteed, the number is what was observed. A path that cannot go on ends with a typed error, which
the table shows; no result is ever NaN.

The conformal law of a Casimir of degree two is |y_n|² = e^(−2∫γ)|y₀|² on every path. *To rounding*
means within the worst case of all roundings together, (32n + 4∫|γ| + 8)ε after n steps, which the
sources derive term by term. Observed distances are about a hundredth of it, since roundings partly
cancel.";

const GROWTH: &str = "\
The conformal law holds to rounding in every step. Its error after ten million steps depends on
whether the roundings are biased: unbiased ones make a random walk, √n·ε, biased ones a drift, n·ε.
Shown: d = F(y_n)e^(p∫γ)/F(y₀) − 1 over independent paths. The exponent is the slope of log root mean
square over log n, from n = 1024 on; its interval resamples whole paths. All paths share the damping
factors and their roundings. Where γ ≠ 0 a part of the walk is therefore common to all: the mean is
as large as the root mean square, and the interval does not include this part.

*Guarantee.* With a settled solver the root mean square stays below 32ε√n, a walk whose steps are the
worst roundings of a step. Three sources of drift are removed. Damping factors would be rounded alike
in every step: deterministic dithering by the golden ratio chooses between the two neighbours.
Integrals of γ would not add up: they are differences of a function of one time. The stopping test
of the implicit equation leaves a residual of up to 2ε in the same direction in every step: one more
sweep, `Solver::settled()`, removes it. It is not the default, since it costs a sweep; the first run
shows the default.";

const FUZZING: &str = "\
Numbers are arbitrary bit patterns: NaN, infinities, subnormals, zeros of both signs, the largest and
smallest numbers, ordinary ones, and pairs that are an ulp apart. Every input must be refused with a
typed error or accepted. What is accepted must give finite results, and a solve must stay below its
bound on iterations. A panic, a NaN in a result or a solve that does not end is a failure.";
