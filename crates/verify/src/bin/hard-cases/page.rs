//! `docs/stability.md`, made from the results.

use report::{Page, anchor, distinct, number, provenance};

use crate::{
    figures,
    results::{CaseResult, Energy, Fuzzed, Growth, Stability},
    row::Row,
    row::Verdict::{self, FailsAsItMust, Holds, Observed, Refuted},
};

/// The whole page.
pub fn page(results: &Stability) -> Page {
    let mut page = Page::new("Stability");
    page.paragraph(format!(
        "What do the schemes do where numerical codes break? {} All numbers are those of \
         `stability.json`, see [results.md](results.md).",
        provenance::generated_by(&results.provenance)
    ));
    page.paragraph(METHOD);
    page.heading(2, "Summary");
    summary(&mut page, results);
    if let Some(svg) = figures::cases(&results.cases) {
        page.figure("stability-stiff.svg", "Every scheme in the stiff cases", svg);
    }
    for CaseResult { case, rows } in &results.cases {
        page.heading(2, case.title);
        page.paragraph(format!(
            "`{}`. {}\n\n*Exact mathematics.* {}\n\n*Guarantee.* {}\n\nShown: {}.",
            case.id, case.setup, case.mathematics, case.guarantee, case.quantity
        ));
        table(&mut page, case.varied, rows);
    }
    if !results.growth.is_empty() {
        growth(&mut page, &results.growth);
    }
    if !results.energy.is_empty() {
        energy(&mut page, &results.energy);
    }
    if !results.fuzz.is_empty() {
        fuzz(&mut page, &results.fuzz);
    }
    page
}

fn mark(verdict: Verdict) -> &'static str {
    match verdict {
        Holds => "✓",
        FailsAsItMust => "✗",
        Observed => "",
        Refuted => "**REFUTED**",
    }
}

/// Everything at a glance: one row for a case, and what is refuted.
pub fn summary(page: &mut Page, results: &Stability) {
    let row = |title: &str, verdicts: &[Verdict]| {
        let count = |one| verdicts.iter().filter(|verdict| **verdict == one).count().to_string();
        let [hold, fail, observed, refuted] = [Holds, FailsAsItMust, Observed, Refuted].map(count);
        [format!("[{title}](#{})", anchor(title)), hold, fail, observed, refuted]
    };
    let cases = results.cases.iter().map(|CaseResult { case, rows }| {
        row(case.title, &rows.iter().map(|row| row.verdict).collect::<Vec<_>>())
    });
    let long: Vec<Verdict> = results.growth.iter().map(|run| run.verdict).collect();
    let energy: Vec<Verdict> = results.energy.iter().map(|run| run.verdict).collect();
    let long = [(LONG, long), (PERIODS, energy)].into_iter().filter(|part| !part.1.is_empty());
    let long = long.map(|(title, verdicts)| row(title, &verdicts));
    page.table(["case", "hold", "fail as they must", "observed", "refuted"], cases.chain(long));
    let rows = results.cases.iter().flat_map(|result| &result.rows);
    let refuted = rows.filter(|row| row.verdict == Refuted);
    page.list(refuted.map(|row| format!("{}, {}: {}", row.setting, row.scheme, cell(row))));
    if !results.fuzz.is_empty() {
        let sum = |count: fn(&Fuzzed) -> u64| results.fuzz.iter().map(count).sum::<u64>();
        let (inputs, failures) = (sum(|fuzzed| fuzzed.inputs), sum(|fuzzed| fuzzed.failures));
        let link = anchor(FUZZ);
        page.paragraph(format!("[{FUZZ}](#{link}): {inputs} inputs, {failures} failures."));
    }
}

const LONG: &str = "Long times";
const PERIODS: &str = "Energy over a million periods";
const FUZZ: &str = "Arbitrary inputs";

/// Settings down, schemes across.
fn table(page: &mut Page, varied: &str, rows: &[Row]) {
    let schemes = distinct(rows.iter().map(|row| row.scheme));
    let quoted = schemes.iter().map(|scheme| format!("`{scheme}`"));
    let head = [varied, "exact", "bound"].map(str::to_owned).into_iter().chain(quoted);
    let lines = rows.chunk_by(|a, b| a.setting == b.setting).map(|rows| {
        let exact = distinct(rows.iter().filter_map(|row| row.exact.map(number))).join("; ");
        let holding = rows.iter().filter(|row| row.verdict == Holds);
        let bound = holding.filter_map(|row| row.bound).reduce(f64::max).map(number);
        let start = [rows[0].setting.clone(), exact, bound.unwrap_or_default()];
        let row = |scheme: &&str| rows.iter().find(|row| row.scheme == *scheme);
        let cells = schemes.iter().map(|scheme| row(scheme).map(cell).unwrap_or_default());
        start.into_iter().chain(cells).collect::<Vec<String>>()
    });
    page.table(head, lines);
}

fn cell(row: &Row) -> String {
    let text = match (row.measured.map(number), &row.error) {
        (Some(figure), Some(error)) => format!("{figure}; {error}"),
        (figure, error) => figure.or(error.clone()).unwrap_or("–".into()),
    };
    format!("{text} {}", mark(row.verdict)).trim_end().into()
}

fn growth(page: &mut Page, growth: &[Growth]) {
    page.heading(2, LONG);
    page.paragraph(GROWTH);
    let svg = figures::growth(growth);
    page.figure("stability-growth.svg", "Distance over the number of steps", svg);
    let rows = growth.iter().filter_map(|run| {
        let end = run.points.last()?;
        Some([
            format!("`{}`", run.id),
            run.setup.clone(),
            format!("`{}`", run.scheme),
            run.invariant.into(),
            format!("{:.0e}", end.steps as f64),
            number(end.rms),
            format!("{:+.1e}", end.mean),
            number(end.max),
            format!("{:.3} [{:.3}, {:.3}]", run.exponent, run.lo, run.hi),
            mark(run.verdict).into(),
        ])
    });
    let head = [
        "run",
        "problem",
        "scheme",
        "law of",
        "steps",
        "root mean square",
        "mean",
        "largest",
        "exponent, 95 %",
        "verdict",
    ];
    page.table(head, rows);
}

fn energy(page: &mut Page, energy: &[Energy]) {
    page.heading(2, PERIODS);
    page.paragraph(ENERGY);
    let rows = energy.iter().map(|run| {
        let (a, lo, hi) = run.exponent;
        let shown = |x: f64, text| if x.is_finite() { text } else { "–".to_owned() };
        [
            run.system.into(),
            format!("`{}`", run.scheme),
            shown(run.end, format!("{:+.1e}", run.end)),
            shown(run.drift, format!("{:+.2e} ± {:.0e}", run.drift, run.error)),
            shown(a, format!("{a:.2} [{lo:.2}, {hi:.2}]")),
            run.failed.to_string(),
            format!("{} {}", run.outcome, mark(run.verdict)),
        ]
    });
    page.table(["system", "scheme", "d", "drift", "exponent, 95 %", "failed", "verdict"], rows);
}

fn fuzz(page: &mut Page, fuzz: &[Fuzzed]) {
    page.heading(2, FUZZ);
    page.paragraph(FUZZING);
    let rows = fuzz.iter().map(|fuzzed| {
        let Fuzzed { inputs, accepted, refused, most_iterations, failures, .. } = fuzzed;
        let counts = [inputs, accepted, refused, most_iterations, failures];
        [fuzzed.target, fuzzed.checks]
            .map(str::to_owned)
            .into_iter()
            .chain(counts.map(u64::to_string))
    });
    let head =
        ["target", "what is checked", "inputs", "accepted", "refused", "iterations", "failures"];
    page.table(head, rows);
    let examples = fuzz.iter().flat_map(|one| one.examples.iter().map(move |e| (one.target, e)));
    page.list(examples.map(|(target, example)| format!("{target}: {example}")));
}

const METHOD: &str = "\
Every case runs `sexp` (fixed point first), `sexp-newton` (Newton's method first), `sexp-levy` \
where noises do not commute, `sexp-li`, `split` and `nv` where flows are known, `midpoint`, `heun` \
and `em`. A guarantee is a derived bound. ✓: it holds; ✗: the scheme fails, as theory predicts; no \
mark: nothing is guaranteed. Increments are truncated with k = 4 unless said otherwise. A path that \
cannot go on ends with a typed error, never with NaN.

*To rounding*: |y_n|² = e^(−2∫γ)|y₀|² up to (32n + 4∫|γ| + 8)ε after n steps, the worst case of \
all roundings, see `crates/verify/src/bin/hard-cases/rounding.rs`; twice that for `sexp-li`, and \
(13m + 6)nε instead of 32nε with m rotations about axes in a step: five of `split`, up to eleven of \
`nv`, and 23 where the noise has no part of its own.";

const GROWTH: &str = "\
Shown: d = F(y_n)e^(p∫γ)/F(y₀) − 1 over 32 paths, or over 512 without iteration. Roundings \
without a direction make a random walk, √n·ε; those with one a drift, n·ε. The exponent is the \
slope of log root mean square over log n from n = 1024 on, its interval that of resampled paths. \
The roundings of the damping factors, which all paths share, show in the mean only.

*Guarantee.* With a settled solver the root mean square stays below 32ε√n, a walk of a step's \
worst roundings. The default solver leaves a residual of up to 2ε in the same direction in every \
step, a drift; one more sweep, `Solver::settled()`, removes it. `sexp-li`, `split` and `nv` solve \
nothing by iteration and have no such option: 2, 2.2 and 3.8 times that bound, and an exponent \
whose interval lies below 0.55. The Maxwell–Bloch system turns by an angle that grows like √t, \
and with it what a step rounds; its steps are short, so that the angle stays small.";

const ENERGY: &str = "\
H₀ = ½|p|² + V(q) with the noise H₁ = σq₁ and no damping; V is ½q², −cos q, −(|q|² + ¼)^(−½) in the \
plane, that of Hénon and Heiles below its escape energy, and Σ exp(qᵢ − qᵢ₊₁) around a ring of \
three. 64 paths, increments not truncated, 12 steps in a period, of the chain 8. Exactly, E[H₀] \
grows by ½σ² in a unit of time, so weakly that paths stay bound: by 0.1, 0.05, 0.005, 0.002 and \
0.05 in all.

Shown: d = E[H₀] less its exact value, in the mean over the second half of the time; its drift since \
1/16 of the time, in units of what the noise added meanwhile; the exponent a of |d| ∝ tᵃ, also where \
d is its sampling error alone; paths that failed.

*Guarantee.* `sexp`, `midpoint`, and `split` and `nv` by exact flows are bounded: a drift of at most \
0.2 and four standard errors, |d| ≤ 0.05. The explicit methods must drift or fail: `heun`, `em`, \
`sexp-li` for constant B, `nv` by stages. On the oscillator `sexp` has the drift −(τω)²/(4 + (τω)²) \
= −0.064, see [theory.md](theory.md).";

const FUZZING: &str = "\
Numbers are arbitrary bit patterns: NaN, infinities, subnormals, ordinary numbers and neighbours. \
Each input must be accepted or refused with a typed error; a panic, a NaN or an endless solve is \
a failure.";
