//! **Hard inputs: what exact mathematics says, what every scheme does, and what is guaranteed.**
//!
//! `cargo xtask stability`. Each case runs all schemes on inputs that break numerical codes:
//! damping factors that underflow, rates that are infinite, noise past the contraction bound,
//! states of 10¹⁵⁰. A guarantee is a derived bound; a row reports whether it holds, whether a
//! scheme fails where theory predicts failure, or that the guarantee is refuted. What each case is
//! and what exact mathematics says of it stands at its function.
//!
//! *To rounding* means [`verify::rounding`]. Increments are truncated with k = 4 unless said
//! otherwise. A path that cannot go on ends with a typed error, never with NaN. Long runs and
//! arbitrary inputs are the tests in `tests/hard_cases`.

mod body;
mod other_systems;
mod paths;

use std::{fmt::Display, process::ExitCode};

use analysis::number;
use anyhow::Result;
use clap::{Parser, builder::PossibleValuesParser};
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use noise::StreamKey;
use verify::{command, streams};

/// Every scheme on hard inputs: what is guaranteed and what happens.
#[derive(Parser)]
#[command(bin_name = "cargo xtask stability", version)]
struct Arguments {
    /// Fewer paths: seconds instead of a minute.
    #[arg(long)]
    quick: bool,
    /// Run only this case; may be given several times.
    #[arg(long, value_name = "ID")]
    #[arg(value_parser = PossibleValuesParser::new(CASES.iter().map(|case| case.id)))]
    only: Vec<String>,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same bits.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
}

/// A family of hard inputs.
struct Case {
    id: &'static str,
    /// What the settings vary.
    varied: &'static str,
    /// What the figure is.
    shown: &'static str,
    guaranteed: &'static str,
    /// Runs all schemes in all settings.
    rows: fn(&Context) -> Rows,
}

/// What most cases show.
const SQUARED_LENGTH: &str = "largest relative distance of |y|² from its law, before a path ends";
const SOLVABLE: &str = "`sexp` in all forms is on the law to rounding, or ends with a typed error. \
                        `sexp-li` and `split` are on the law to the end, and clip nothing.";

/// All of them, in the order of their streams.
static CASES: [Case; 12] = [
    Case {
        id: "stiff-damping",
        varied: "γτ: exact",
        shown: "factor of |y| in a step, geometric mean while |y| is a normal number",
        guaranteed: "`sexp` has the factor e^(−x), x = γτ, to rounding, underflow included; so have \
                     `sexp-li` and `split`. For large x `midpoint` must hardly damp, `em` and \
                     `heun` must grow.",
        rows: body::stiff_damping,
    },
    Case {
        id: "anti-damping",
        varied: "γτ",
        shown: SQUARED_LENGTH,
        guaranteed: "`sexp`, `sexp-li` and `split` are on the law to rounding, or end with a typed \
                     error. Newton's stopping test keeps the law to 2⁻³⁰ a step only.",
        rows: body::anti_damping,
    },
    Case {
        id: "rough-damping",
        varied: "γ",
        shown: SQUARED_LENGTH,
        guaranteed: "`sexp`, `sexp-li` and `split` read only ∫γ and are on the law to rounding. A \
                     scheme that evaluates γ where it is infinite must stop: `em` and `heun` at the \
                     ends of a step, `midpoint` in its middle.",
        rows: body::rough_damping,
    },
    Case {
        id: "large-noise",
        varied: "size of the increments",
        shown: "largest distance from |y|², relative to what is allowed",
        guaranteed: "Inside the contraction bound (size 0.1) `sexp` solves every step. Beyond, it \
                     keeps |y|² to rounding or fails. `sexp-li` and `split` solve every step and \
                     keep |y|² to rounding.",
        rows: body::large_noise,
    },
    Case {
        id: "extreme-normals",
        varied: "τ",
        shown: SQUARED_LENGTH,
        guaranteed: SOLVABLE,
        rows: body::extreme_normals,
    },
    Case {
        id: "big-steps",
        varied: "τ",
        shown: SQUARED_LENGTH,
        guaranteed: SOLVABLE,
        rows: body::big_steps,
    },
    Case {
        id: "scales",
        varied: "scale",
        shown: "largest difference from the solution of scale one, relative to |y₀|",
        guaranteed: "No scheme or stopping test depends on the scale, up to one sweep.",
        rows: body::scales,
    },
    Case {
        id: "equilibria",
        varied: "system and start",
        shown: "largest distance of a component from y₀",
        guaranteed: "Every scheme stays exactly. The upright pendulum starts an ulp from its \
                     equilibrium and leaves it like εe^t.",
        rows: other_systems::equilibria,
    },
    Case {
        id: "sharp-hamiltonian",
        varied: "κ",
        shown: "largest distance of ½|y|² (relative) and of H (absolute) from the start",
        guaranteed: "`sexp` and `sexp-li` keep |y|² to rounding, `sexp` also H to rounding and the \
                     error of eight nodes, Σ|Δy₁|·min(2, (8!)⁴/(17·16!³)·(κΔy₁)¹⁶); or it ends with \
                     a typed error.",
        rows: other_systems::sharp_hamiltonian,
    },
    Case {
        id: "stiff-hamiltonian",
        varied: "ω",
        shown: "largest relative distance of |y|² and H₀ from their laws",
        guaranteed: "`sexp` is on both laws to rounding, or ends with a typed error; `sexp-li`, \
                     `split` and `nv` are on that of |y|². From ω = 1000 on `em` and `heun` must be \
                     off by more than one.",
        rows: other_systems::stiff_hamiltonian,
    },
    Case {
        id: "lotka-volterra",
        varied: "start and τ",
        shown: "largest relative distance of the Casimir from its law, before a path ends",
        guaranteed: "`sexp` and `sexp-li` are positive and on the law to rounding, or end with a \
                     typed error. No scheme is positive by construction.",
        rows: other_systems::lotka_volterra,
    },
    Case {
        id: "near-singular",
        varied: "δ",
        shown: "change of y₁² + y₂² − y₃², relative to (|y| + |z|)²",
        guaranteed: "32ε whatever the condition, or a typed error.",
        rows: other_systems::near_singular,
    },
];

/// All schemes in all settings of a case.
type Rows = Result<Vec<Row>>;

/// What a case needs to run.
struct Context {
    key: StreamKey,
    quick: bool,
}

/// The rows of every setting.
fn each<T>(settings: impl IntoIterator<Item = T>, rows: impl FnMut(T) -> Rows) -> Rows {
    Ok(settings.into_iter().map(rows).collect::<Result<Vec<_>>>()?.concat())
}

/// What became of a guarantee.
#[derive(Clone, Copy, Default, PartialEq)]
enum Verdict {
    /// The stated bound was kept.
    Holds,
    /// Theory predicts that the scheme fails here, and it does.
    FailsAsItMust,
    /// Nothing is guaranteed; the figure is what was measured.
    #[default]
    Observed,
    /// A stated bound was broken, or a scheme that must fail did not.
    Refuted,
}

/// One scheme in one setting.
#[derive(Clone, Default)]
struct Row {
    setting: String,
    scheme: &'static str,
    /// The measured figure; none where it is not finite.
    measured: Option<f64>,
    /// The bound that is guaranteed.
    bound: Option<f64>,
    /// The typed error that ended the run, if one did.
    error: Option<String>,
    verdict: Verdict,
}

impl Row {
    /// A row without a figure, of which nothing is guaranteed.
    fn new(setting: impl Display, scheme: &'static str, error: Option<String>) -> Self {
        Self { setting: setting.to_string(), scheme, error, ..Self::default() }
    }

    /// With a figure, which must be a number unless there is an error.
    fn with_figure(self, figure: f64) -> Self {
        let measured = Some(figure).filter(|figure| figure.is_finite());
        let seen = measured.is_some() || self.error.is_some();
        let verdict = if seen { self.verdict } else { Verdict::Refuted };
        Self { measured, verdict, ..self }
    }

    /// A guarantee that was kept or not, with its bound where that is one of the figure.
    fn guaranteed(self, kept: bool, bound: impl Into<Option<f64>>) -> Self {
        let verdict = if kept { Verdict::Holds } else { Verdict::Refuted };
        Self { bound: bound.into(), verdict, ..self }
    }

    /// A guarantee that the figure is at most `bound`, up to the end.
    fn at_most(self, bound: f64) -> Self {
        let kept = self.error.is_none() && self.measured.is_some_and(|figure| figure <= bound);
        self.guaranteed(kept, bound)
    }

    /// The scheme must exceed `bound` or stop with an error.
    fn must_exceed(self, bound: f64) -> Self {
        let fails = self.error.is_some() || self.measured.is_some_and(|figure| figure > bound);
        let verdict = if fails { Verdict::FailsAsItMust } else { Verdict::Refuted };
        Self { verdict, ..self }
    }

    /// The figure or why there is none, and what became of the guarantee.
    fn cell(&self) -> String {
        let mark = match self.verdict {
            Verdict::Holds => "✓",
            Verdict::FailsAsItMust => "✗",
            Verdict::Observed => "",
            Verdict::Refuted => "REFUTED",
        };
        let words: Vec<String> =
            self.measured.map(number).into_iter().chain(self.error.clone()).collect();
        format!("{} {mark}", words.join("; ")).trim().into()
    }
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs the cases that are asked for, and prints a table of each. Fails when a guarantee is
/// refuted.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    let mut all = Vec::new();
    for (case, experiment) in CASES.iter().zip(streams::HARD_CASES..) {
        if arguments.only.is_empty() || arguments.only.iter().any(|id| id == case.id) {
            let key = StreamKey { seed: arguments.seed, experiment };
            let rows = (case.rows)(&Context { key, quick: arguments.quick })?;
            let Case { id, guaranteed, shown, varied, .. } = case;
            println!("{id}\nguaranteed: {guaranteed}\nshown: {shown}\n{}\n", table(varied, &rows));
            all.extend(rows);
        }
    }
    use Verdict::{FailsAsItMust, Holds, Observed, Refuted};
    let [hold, fail, observed, refuted] = [Holds, FailsAsItMust, Observed, Refuted]
        .map(|one| all.iter().filter(|row| row.verdict == one).count());
    println!("{hold} hold, {fail} fail as they must, {observed} observed, {refuted} refuted");
    Ok(if refuted == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Settings down, schemes across.
fn table(varied: &str, rows: &[Row]) -> Table {
    let mut schemes: Vec<&str> = Vec::new();
    for row in rows {
        if !schemes.contains(&row.scheme) {
            schemes.push(row.scheme);
        }
    }
    let mut table = Table::new();
    let head = [varied, "bound"].into_iter().chain(schemes.iter().copied());
    table.load_style(ASCII_MARKDOWN).set_header(head);
    for rows in rows.chunk_by(|a, b| a.setting == b.setting) {
        let holding = rows.iter().filter(|row| row.verdict == Verdict::Holds);
        let bound = holding.filter_map(|row| row.bound).reduce(f64::max).map(number);
        let start = [rows[0].setting.clone(), bound.unwrap_or_default()];
        let row = |scheme: &&str| rows.iter().find(|row| row.scheme == *scheme);
        let cells = schemes.iter().map(|scheme| row(scheme).map(Row::cell).unwrap_or_default());
        table.add_row(start.into_iter().chain(cells));
    }
    table
}
