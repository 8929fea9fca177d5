//! `docs/stability.md`, made from the results.

use std::fmt::Write;

use stability::results::{Case, Fuzzed, Growth, Row, Stability, Verdict};

use crate::provenance::generated_by;
use crate::work_precision::number;

/// Writing into a string cannot fail.
macro_rules! line {
    ($page:expr) => {
        $page.push('\n')
    };
    ($page:expr, $($arguments:tt)*) => {
        let _ = writeln!($page, $($arguments)*);
    };
}

/// The whole page.
pub fn page(results: &Stability) -> String {
    let mut page = String::new();
    line!(page, "# Stability\n");
    line!(
        page,
        "What do the schemes do where numerical codes break? {} All numbers are made from the \
         results; the same seed gives the same bits.\n",
        generated_by(&results.provenance)
    );
    page.push_str(METHOD);
    line!(page, "## Summary\n");
    page += &summary_table(results);
    for case in &results.cases {
        section(&mut page, case);
    }
    if !results.growth.is_empty() {
        growth(&mut page, &results.growth);
    }
    if !results.fuzz.is_empty() {
        fuzz(&mut page, &results.fuzz);
    }
    page += FIELDS;
    page
}

/// Counts of verdicts.
#[derive(Clone, Copy, Default)]
struct Counts {
    holds: usize,
    fails: usize,
    observed: usize,
    refuted: usize,
}

fn counts<'a>(verdicts: impl Iterator<Item = &'a Verdict>) -> Counts {
    let mut counts = Counts::default();
    for verdict in verdicts {
        match verdict {
            Verdict::Holds => counts.holds += 1,
            Verdict::FailsAsItMust => counts.fails += 1,
            Verdict::Observed => counts.observed += 1,
            Verdict::Refuted => counts.refuted += 1,
        }
    }
    counts
}

/// A few lines for the terminal.
pub fn summary(results: &Stability) -> String {
    let mut text = String::new();
    for case in &results.cases {
        let Counts { holds, fails, observed, refuted } =
            counts(case.rows.iter().map(|row| &row.verdict));
        line!(
            text,
            "{:<20} {holds:>3} hold, {fails:>3} fail as they must, {observed:>3} observed, {refuted:>3} REFUTED",
            case.id
        );
        for row in case.rows.iter().filter(|row| row.verdict == Verdict::Refuted) {
            line!(text, "  REFUTED {} {}: {}", row.setting, row.scheme, cell(row));
        }
    }
    for growth in &results.growth {
        let end = growth.points.last();
        line!(
            text,
            "{:<34} after {:.0e} steps {} , n^{:.2} [{:.2}, {:.2}] {}",
            growth.id,
            end.map_or(0.0, |point| point.steps as f64),
            number(end.map_or(f64::NAN, |point| point.rms)),
            growth.exponent,
            growth.lo,
            growth.hi,
            words(growth.verdict)
        );
    }
    for fuzzed in &results.fuzz {
        line!(text, "{:<34} {} inputs, {} failures", fuzzed.target, fuzzed.inputs, fuzzed.failures);
        for example in &fuzzed.examples {
            line!(text, "  {example}");
        }
    }
    text
}

fn words(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::FailsAsItMust => "fails as it must",
        Verdict::Observed => "observed",
        Verdict::Refuted => "**REFUTED**",
    }
}

/// Everything at a glance: one row for a case.
fn summary_table(results: &Stability) -> String {
    let mut text = String::new();
    line!(text, "| case | hold | fail as they must | observed | refuted |\n|---|---|---|---|---|");
    for case in &results.cases {
        let Counts { holds, fails, observed, refuted } =
            counts(case.rows.iter().map(|row| &row.verdict));
        line!(
            text,
            "| [{}](#{}) | {holds} | {fails} | {observed} | {refuted} |",
            case.title,
            anchor(&case.title)
        );
    }
    if !results.growth.is_empty() {
        let Counts { holds, fails, observed, refuted } =
            counts(results.growth.iter().map(|growth| &growth.verdict));
        line!(text, "| [{LONG}](#{}) | {holds} | {fails} | {observed} | {refuted} |", anchor(LONG));
    }
    if !results.fuzz.is_empty() {
        let inputs: u64 = results.fuzz.iter().map(|fuzzed| fuzzed.inputs).sum();
        let failures: u64 = results.fuzz.iter().map(|fuzzed| fuzzed.failures).sum();
        line!(text, "\n[Fuzzing](#{}): {inputs} inputs, {failures} failures.", anchor(FUZZ));
    }
    line!(text);
    text
}

/// The anchor that a heading gets.
fn anchor(heading: &str) -> String {
    heading
        .to_lowercase()
        .chars()
        .filter(|c| c.is_alphanumeric() || " -".contains(*c))
        .collect::<String>()
        .replace(' ', "-")
}

const LONG: &str = "Long times";
const FUZZ: &str = "Arbitrary inputs";

fn section(page: &mut String, case: &Case) {
    line!(page, "## {}\n", case.title);
    line!(page, "`{}`. {}\n", case.id, case.setup);
    line!(page, "*Exact mathematics.* {}\n", case.mathematics);
    line!(page, "*Guarantee.* {}\n", case.guarantee);
    if case.id == "stiff-damping" {
        line!(
            page,
            "![The factor of a step over γτ, and the distance from the law over ω](figures/stability-stiff.svg)\n"
        );
    }
    line!(page, "Shown: {}.\n", case.quantity);
    table(page, case);
}

/// Settings down, schemes across.
fn table(page: &mut String, case: &Case) {
    let mut schemes: Vec<&str> = Vec::new();
    let mut settings: Vec<&str> = Vec::new();
    for row in &case.rows {
        if !schemes.contains(&row.scheme.as_str()) {
            schemes.push(&row.scheme);
        }
        if !settings.contains(&row.setting.as_str()) {
            settings.push(&row.setting);
        }
    }
    let exact = case.rows.iter().any(|row| row.exact.is_some());
    let bound = case.rows.iter().any(|row| row.verdict == Verdict::Holds && row.bound.is_some());
    let quoted: Vec<String> = schemes.iter().map(|scheme| format!("`{scheme}`")).collect();
    let more =
        format!("{}{}", if exact { " exact |" } else { "" }, if bound { " bound |" } else { "" });
    line!(page, "| {} |{more} {} |", case.varied, quoted.join(" | "));
    line!(page, "|---|{}", "---|".repeat(schemes.len() + usize::from(exact) + usize::from(bound)));
    for setting in settings {
        let rows: Vec<&Row> = case.rows.iter().filter(|row| row.setting == setting).collect();
        let mut cells = Vec::new();
        if exact {
            cells.push(distinct(rows.iter().filter_map(|row| row.exact)));
        }
        if bound {
            let bounds =
                rows.iter().filter(|row| row.verdict == Verdict::Holds).filter_map(|row| row.bound);
            cells.push(bounds.reduce(f64::max).map_or(String::new(), number));
        }
        for scheme in &schemes {
            cells.push(
                rows.iter()
                    .find(|row| row.scheme == *scheme)
                    .map_or(String::new(), |row| cell(row)),
            );
        }
        line!(page, "| {setting} | {} |", cells.join(" | "));
    }
    line!(page);
}

/// The different numbers of a column, in words.
fn distinct(values: impl Iterator<Item = f64>) -> String {
    let mut seen: Vec<String> = Vec::new();
    for value in values.map(number) {
        if !seen.contains(&value) {
            seen.push(value);
        }
    }
    seen.join("; ")
}

fn cell(row: &Row) -> String {
    let mark = match row.verdict {
        Verdict::Holds => " ✓",
        Verdict::FailsAsItMust => " ✗",
        Verdict::Observed => "",
        Verdict::Refuted => " **REFUTED**",
    };
    match (row.measured, &row.error) {
        (Some(measured), None) => format!("{}{mark}", number(measured)),
        (Some(measured), Some(error)) => format!("{}; {error}{mark}", number(measured)),
        (None, Some(error)) => format!("{error}{mark}"),
        (None, None) => format!("–{mark}"),
    }
}

fn growth(page: &mut String, growth: &[Growth]) {
    line!(page, "## {LONG}\n");
    page.push_str(GROWTH);
    line!(
        page,
        "![Root mean square of the distance over the number of steps](figures/stability-growth.svg)\n"
    );
    line!(
        page,
        "| run | scheme | law of | steps | root mean square | mean | largest | n·ε | exponent, 95 % | |"
    );
    line!(page, "|---|---|---|---|---|---|---|---|---|---|");
    for run in growth {
        let Some(end) = run.points.last() else { continue };
        line!(
            page,
            "| `{}` | `{}` | {} | {:.0e} | {} | {:+.1e} | {} | {} | {:.3} [{:.3}, {:.3}] | {} |",
            run.id,
            run.scheme,
            run.invariant,
            end.steps as f64,
            number(end.rms),
            end.mean,
            number(end.max),
            number(run.linear),
            run.exponent,
            run.lo,
            run.hi,
            words(run.verdict)
        );
    }
    line!(page);
    let above: Vec<String> = growth
        .iter()
        .filter(|run| run.verdict == Verdict::Holds && run.lo > 0.5)
        .map(|run| format!("`{}`", run.id))
        .collect();
    if !above.is_empty() {
        line!(
            page,
            "The interval of the exponent lies above that of a random walk for {}: the bound holds, but some drift, or a walk that all paths share, is left.\n",
            above.join(", ")
        );
    }
    for run in growth {
        line!(page, "- `{}`: {} {} paths.", run.id, run.setup, run.paths);
    }
    line!(page);
}

fn fuzz(page: &mut String, fuzz: &[Fuzzed]) {
    line!(page, "## {FUZZ}\n");
    page.push_str(FUZZING);
    line!(
        page,
        "| target | what is checked | inputs | accepted | refused | most iterations | failures |"
    );
    line!(page, "|---|---|---|---|---|---|---|");
    for fuzzed in fuzz {
        line!(
            page,
            "| {} | {} | {} | {} | {} | {} | {} |",
            fuzzed.target,
            fuzzed.checks,
            fuzzed.inputs,
            fuzzed.accepted,
            fuzzed.refused,
            if fuzzed.most_iterations == 0 {
                "–".to_owned()
            } else {
                fuzzed.most_iterations.to_string()
            },
            fuzzed.failures
        );
    }
    let total: u64 = fuzz.iter().map(|fuzzed| fuzzed.inputs).sum();
    let failures: u64 = fuzz.iter().map(|fuzzed| fuzzed.failures).sum();
    line!(page, "\nTogether {total} inputs: {failures} panics, NaN or other broken checks.\n");
    for fuzzed in fuzz {
        for example in &fuzzed.examples {
            line!(page, "- {}: {example}", fuzzed.target);
        }
    }
}

const METHOD: &str = "\
Each case is run with every scheme: `sexp` with the fixed point first, `sexp-newton` with Newton's method first, `sexp-levy` where noises do not commute, `midpoint`, `heun` \
and `em`. A guarantee is a bound that is derived, not fitted; the derivations stand in the sources. Marks: ✓ the guarantee holds; ✗ the scheme fails, as theory says it \
must; no mark: nothing is guaranteed, this is what was seen. A path that cannot go on ends with a typed error, whose words stand in the table; no result is ever NaN.

The conformal law of a Casimir of degree two asks for |y_n|² = e^(−2∫γ)|y₀|² on every path. *To rounding* means the worst case of all roundings together: \
(32n + 4∫|γ| + 8)ε after n steps, derived term by term in `crates/stability/src/rounding.rs`. What is seen is about a hundredth of it, since roundings do not conspire.

";

const GROWTH: &str = "\
The conformal law holds to rounding in every step. What becomes of it after ten million steps depends on whether the roundings have a direction: errors without one make a random walk, \
√n·ε, errors with one a drift, n·ε. Shown: d = F(y_n)e^(p∫γ)/F(y₀) − 1 over independent paths. The exponent is the slope of log root mean square over log n, from n = 1024 on; its \
interval comes from resampling whole paths. Paths share the damping factors and their roundings: where γ ≠ 0 a part of the walk is common to all of them, which shows as a mean as large as \
the root mean square, and which the interval does not see.

*Guarantee.* With a settled solver the root mean square stays below 32ε√n, the walk whose steps are the worst roundings of a step. Three sources of a drift were found and closed: a damping factor \
that is rounded alike in every step (the number of the step now decides between its two neighbours, by the golden ratio), integrals of γ that do not add up (they are now differences of a function of \
one time), and the stopping test of the implicit equation, which leaves a residual of up to 2ε in a direction that is the same in every step. The last is closed by one more sweep, \
`Solver::settled()`, and not by default, since it costs a sweep: the first run shows what the default does.

";

const FUZZING: &str = "\
Numbers are arbitrary bit patterns: NaN, infinities, subnormals, zeros of both signs, the largest and smallest numbers, ordinary ones, and pairs that are an ulp apart. Every input must be \
refused with a typed error or accepted; what is accepted must be finite, what claims to be solved must be finite, and the iterations of a solve must stay below their bound. A panic, a NaN in \
a result or a solve that does not end counts as a failure.

";

const FIELDS: &str = "\
## stability.json

`cases`: one entry for each family, with its words and `rows`: `setting` (and `x`, where it is a number), `scheme`, `measured`, `exact`, `bound`, `error` and `verdict` (`holds`, \
`fails-as-it-must`, `observed` or `refuted`); a number that is missing is not finite or not defined. `growth`: `points` with `steps`, `rms`, `mean`, `max`; `exponent` with `lo` and `hi`. `fuzz`: counts \
for each target. `schema` is raised whenever a reader of an older version would misread a newer one.
";
