//! `docs/stability.md`, made from the results.

use report::{Page, anchor, distinct, number, provenance};

use crate::figures;
use crate::results::{Case, Fuzzed, Growth, Row, Stability, Verdict};

/// The whole page.
pub fn page(results: &Stability) -> Page {
    let mut page = Page::new("Stability");
    page.paragraph(format!(
        "What do the schemes do where numerical codes break? {} All numbers are made from the \
         results; the same seed gives the same bits.",
        provenance::generated_by(&results.provenance)
    ));
    page.paragraph(METHOD);
    page.heading(2, "Summary");
    summary(&mut page, results);
    let plotted = |case: &&Case| case.words.plot.is_some();
    let mut plotted: Vec<&Case> = results.cases.iter().filter(plotted).collect();
    for case in &results.cases {
        let words = case.words;
        page.heading(2, words.title);
        page.paragraph(format!("`{}`. {}", words.id, words.setup));
        page.paragraph(format!("*Exact mathematics.* {}", words.mathematics));
        page.paragraph(format!("*Guarantee.* {}", words.guarantee));
        if words.plot.is_some() && !plotted.is_empty() {
            let svg = figures::cases(&std::mem::take(&mut plotted));
            page.figure("stability-stiff.svg", "Every scheme in the stiff cases", svg);
        }
        page.paragraph(format!("Shown: {}.", words.quantity));
        table(&mut page, case);
    }
    if !results.growth.is_empty() {
        growth(&mut page, &results.growth);
    }
    if !results.fuzz.is_empty() {
        fuzz(&mut page, &results.fuzz);
    }
    page.heading(2, "stability.json");
    page.paragraph(FIELDS);
    page
}

fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::FailsAsItMust => "fails as it must",
        Verdict::Observed => "observed",
        Verdict::Refuted => "**REFUTED**",
    }
}

/// Everything at a glance: one row for a case, and what is refuted.
pub fn summary(page: &mut Page, results: &Stability) {
    let row = |title: &str, verdicts: &[Verdict]| {
        let of = |one| verdicts.iter().filter(|verdict| **verdict == one).count().to_string();
        let counts = [Verdict::Holds, Verdict::FailsAsItMust, Verdict::Observed, Verdict::Refuted];
        let link = format!("[{title}](#{})", anchor(title));
        [link].into_iter().chain(counts.map(of)).collect::<Vec<String>>()
    };
    let verdicts = |case: &Case| case.rows.iter().map(|row| row.verdict).collect::<Vec<_>>();
    let cases = results.cases.iter().map(|case| row(case.words.title, &verdicts(case)));
    let long: Vec<Verdict> = results.growth.iter().map(|run| run.verdict).collect();
    let long = (!long.is_empty()).then(|| row(LONG, &long));
    page.table(["case", "hold", "fail as they must", "observed", "refuted"], cases.chain(long));
    let refuted = |row: &&Row| row.verdict == Verdict::Refuted;
    let refuted = results.cases.iter().flat_map(|case| &case.rows).filter(refuted);
    page.list(refuted.map(|row| format!("{}, {}: {}", row.setting.words, row.scheme, cell(row))));
    if !results.fuzz.is_empty() {
        let (inputs, failures) = totals(&results.fuzz);
        let link = format!("[{FUZZ}](#{})", anchor(FUZZ));
        page.paragraph(format!("{link}: {inputs} inputs, {failures} failures."));
    }
}

/// Inputs and failures of all targets.
fn totals(fuzz: &[Fuzzed]) -> (u64, u64) {
    fuzz.iter().fold((0, 0), |sums, one| (sums.0 + one.inputs, sums.1 + one.failures))
}

const LONG: &str = "Long times";
const FUZZ: &str = "Arbitrary inputs";

/// Settings down, schemes across.
fn table(page: &mut Page, case: &Case) {
    let schemes = distinct(case.rows.iter().map(|row| row.scheme));
    let quoted = schemes.iter().map(|scheme| format!("`{scheme}`"));
    let head = [case.words.varied, "exact", "bound"].map(str::to_owned).into_iter().chain(quoted);
    let lines =
        distinct(case.rows.iter().map(|row| &row.setting.words)).into_iter().map(|setting| {
            let rows: Vec<&Row> =
                case.rows.iter().filter(|row| row.setting.words == *setting).collect();
            let exact = distinct(rows.iter().filter_map(|row| row.exact.map(number)));
            let holding = rows.iter().filter(|row| row.verdict == Verdict::Holds);
            let bound =
                holding.filter_map(|row| row.bound).reduce(f64::max).map_or(String::new(), number);
            let row = |scheme: &&str| rows.iter().find(|row| row.scheme == *scheme);
            let cells =
                schemes.iter().map(|scheme| row(scheme).map_or(String::new(), |row| cell(row)));
            let start = [setting.clone(), exact.join("; "), bound];
            start.into_iter().chain(cells).collect::<Vec<String>>()
        });
    page.table(head, lines.collect::<Vec<_>>());
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
    let text = if parts.is_empty() { "–".to_owned() } else { parts.join("; ") };
    text + mark
}

fn growth(page: &mut Page, growth: &[Growth]) {
    page.heading(2, LONG);
    page.paragraph(GROWTH);
    let description = "Root mean square of the distance over the number of steps";
    page.figure("stability-growth.svg", description, figures::growth(growth));
    let rows = growth.iter().filter_map(|run| {
        let end = run.points.last()?;
        Some([
            format!("`{}`", run.id),
            format!("`{}`", run.scheme),
            run.invariant.to_owned(),
            format!("{:.0e}", end.steps as f64),
            number(end.rms),
            format!("{:+.1e}", end.mean),
            number(end.max),
            number(run.linear),
            format!("{:.3} [{:.3}, {:.3}]", run.exponent, run.lo, run.hi),
            words(run.verdict).to_owned(),
        ])
    });
    page.table(
        [
            "run",
            "scheme",
            "law of",
            "steps",
            "root mean square",
            "mean",
            "largest",
            "n·ε",
            "exponent, 95 %",
            "verdict",
        ],
        rows.collect::<Vec<_>>(),
    );
    let above = growth.iter().filter(|run| run.verdict == Verdict::Holds && run.lo > 0.5);
    let above: Vec<String> = above.map(|run| format!("`{}`", run.id)).collect();
    if !above.is_empty() {
        page.paragraph(format!(
            "The interval of the exponent lies above that of a random walk for {}: the bound \
             holds, but some drift, or a walk that all paths share, is left.",
            above.join(", ")
        ));
    }
    page.list(growth.iter().map(|run| format!("`{}`: {} {} paths.", run.id, run.setup, run.paths)));
}

fn fuzz(page: &mut Page, fuzz: &[Fuzzed]) {
    page.heading(2, FUZZ);
    page.paragraph(FUZZING);
    let rows = fuzz.iter().map(|fuzzed| {
        let Fuzzed { inputs, accepted, refused, most_iterations, failures, .. } = fuzzed;
        let iterations = Some(*most_iterations).filter(|most| *most > 0);
        [
            fuzzed.target.to_owned(),
            fuzzed.checks.to_owned(),
            inputs.to_string(),
            accepted.to_string(),
            refused.to_string(),
            iterations.map_or("–".to_owned(), |most| most.to_string()),
            failures.to_string(),
        ]
    });
    page.table(
        [
            "target",
            "what is checked",
            "inputs",
            "accepted",
            "refused",
            "most iterations",
            "failures",
        ],
        rows.collect::<Vec<_>>(),
    );
    let (inputs, failures) = totals(fuzz);
    page.paragraph(format!(
        "Together {inputs} inputs: {failures} panics, NaN or other broken checks."
    ));
    let examples = fuzz.iter().flat_map(|one| one.examples.iter().map(move |e| (one.target, e)));
    page.list(examples.map(|(target, example)| format!("{target}: {example}")));
}

const METHOD: &str = "\
Each case is run with every scheme: `sexp` with the fixed point first, `sexp-newton` with Newton's \
method first, `sexp-levy` where noises do not commute, `midpoint`, `heun` and `em`. A guarantee is \
a bound that is derived, not fitted; the derivations are in the sources. Marks: ✓ the guarantee \
holds; ✗ the scheme fails, as theory predicts; no mark: nothing is guaranteed, the figure is what \
was measured. A path that cannot go on ends with a typed error, whose words are in the table; no \
result is ever NaN.

The conformal law of a Casimir of degree two requires |y_n|² = e^(−2∫γ)|y₀|² on every path. *To \
rounding* means the worst case of all roundings together: (32n + 4∫|γ| + 8)ε after n steps, derived \
term by term in `crates/lab/src/bin/hard-cases/rounding.rs`. The measured distance is about a \
hundredth of it, since roundings partly cancel.";

const GROWTH: &str = "\
The conformal law holds to rounding in every step. What becomes of it after ten million steps \
depends on whether the roundings have a direction: errors without one make a random walk, √n·ε, \
errors with one a drift, n·ε. Shown: d = F(y_n)e^(p∫γ)/F(y₀) − 1 over independent paths. The \
exponent is the slope of log root mean square over log n, from n = 1024 on; its interval comes from \
resampling whole paths. Paths share the damping factors and their roundings: where γ ≠ 0 a part of \
the walk is common to all of them, which shows as a mean as large as the root mean square, and \
which the interval does not contain.

*Guarantee.* With a settled solver the root mean square stays below 32ε√n, the walk whose steps are \
the worst roundings of a step. Three sources of a drift were found and closed: a damping factor \
that is rounded alike in every step (now dithered between its two neighbours by the golden ratio), \
integrals of γ that do not add up (now differences of a function of one time), and the stopping \
test of the implicit equation, which leaves a residual of up to 2ε in a direction that is the same \
in every step. The last is closed by one more sweep, `Solver::settled()`, and not by default, since \
it costs a sweep: the first run shows what the default does.";

const FUZZING: &str = "\
Numbers are arbitrary bit patterns: NaN, infinities, subnormals, zeros of both signs, the largest \
and smallest numbers, ordinary ones, and pairs that are an ulp apart. Every input must be refused \
with a typed error or accepted. What is accepted must be finite, what is reported as solved must be \
finite, and the iterations of a solve must stay below their bound. A panic, a NaN in a result or a \
solve that does not end counts as a failure.";

const FIELDS: &str = "\
`cases`: one entry for each family, with its words and `rows`: `setting` (and `x`, where it is a \
number), `scheme`, `measured`, `exact`, `bound`, `error` and `verdict` (`holds`, \
`fails-as-it-must`, `observed` or `refuted`); a number that is missing is not finite or not \
defined. `growth`: `points` with `steps`, `rms`, `mean`, `max`; `exponent` with `lo` and `hi`. \
`fuzz`: counts for each target. `schema` is raised whenever a reader of an older version would \
misread a newer one.";
