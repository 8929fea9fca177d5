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
//! arbitrary inputs are the tests in `tests/measuring`.

mod body;
mod other_systems;
mod paths;

use std::{fmt::Display, process::ExitCode};

use analysis::number;
use anyhow::Result;
use clap::{Parser, builder::PossibleValuesParser};
use comfy_table::Table;
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
    #[arg(value_parser = PossibleValuesParser::new(CASES.iter().map(|case| case.0)))]
    only: Vec<String>,
    /// Master seed, 0 to 2^64 − 1; the same seed gives the same bits.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    seed: u64,
}

/// A family of hard inputs: its identifier, what the settings vary, what the figure is, what is
/// guaranteed, and what runs all schemes in all settings.
type Case = (&'static str, &'static str, &'static str, &'static str, fn(&Context) -> Rows);

/// What most cases show.
const SQUARED_LENGTH: &str = "largest relative distance of |y|² from its law, before a path ends";
const SOLVABLE: &str = "to rounding: `sexp`, or it ends with a typed error; the others to the end";

/// All of them, in the order of their streams.
static CASES: [Case; 12] = [
    (
        "stiff-damping",
        "γτ: exact",
        "factor of |y| in a step, geometric mean while |y| is a normal number",
        "e^(−γτ) to rounding; large γτ: `midpoint` hardly damps, `em` and `heun` grow",
        body::stiff_damping,
    ),
    (
        "anti-damping",
        "γτ",
        SQUARED_LENGTH,
        "to rounding, by Newton's method to 2⁻³⁰ a step, or a typed error",
        body::anti_damping,
    ),
    (
        "rough-damping",
        "γ",
        SQUARED_LENGTH,
        "to rounding; schemes that evaluate γ where it is infinite stop",
        body::rough_damping,
    ),
    (
        "large-noise",
        "size of the increments",
        "largest distance from |y|², relative to what is allowed",
        "at most 1; `sexp` solves every step of size 0.1 or fails, the others every step",
        body::large_noise,
    ),
    ("extreme-normals", "τ", SQUARED_LENGTH, SOLVABLE, body::extreme_normals),
    ("big-steps", "τ", SQUARED_LENGTH, SOLVABLE, body::big_steps),
    (
        "scales",
        "scale",
        "largest difference from the solution of scale one, relative to |y₀|",
        "none, up to one sweep",
        body::scales,
    ),
    (
        "equilibria",
        "system and start",
        "largest distance of a component from y₀",
        "none; εe^t from the upright pendulum, an ulp from its equilibrium",
        other_systems::equilibria,
    ),
    (
        "sharp-hamiltonian",
        "κ",
        "largest distance of ½|y|² (relative) and of H (absolute) from the start",
        "|y|² to rounding; H of `sexp` also up to Σ|Δy₁|·min(2, (8!)⁴/(17·16!³)·(κΔy₁)¹⁶)",
        other_systems::sharp_hamiltonian,
    ),
    (
        "stiff-hamiltonian",
        "ω",
        "largest relative distance of |y|² and H₀ from their laws",
        "to rounding: both of `sexp`, |y|² of the others; from ω = 1000 on `em`, `heun` off by 1",
        other_systems::stiff_hamiltonian,
    ),
    (
        "lotka-volterra",
        "start and τ",
        "largest relative distance of the Casimir from its law, before a path ends",
        "positive and to rounding, or a typed error; no scheme is positive by construction",
        other_systems::lotka_volterra,
    ),
    (
        "near-singular",
        "δ",
        "change of y₁² + y₂² − y₃², relative to (|y| + |z|)²",
        "32ε whatever the condition, or a typed error",
        other_systems::near_singular,
    ),
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

/// What is expected of a figure.
enum Expected {
    /// Nothing: it is what was measured.
    Anything,
    /// A guarantee that was kept or not, with its bound where that is one of the figure.
    Guarantee(bool, Option<f64>),
    /// It exceeds this bound, or the scheme stops with an error.
    MoreThan(f64),
}

impl Expected {
    /// A guarantee that the figure is at most `bound`, and no path has `ended` early.
    fn at_most(bound: f64, figure: f64, ended: bool) -> Self {
        Self::Guarantee(!ended && figure <= bound, Some(bound))
    }
}

/// What became of it, in tables.
const HOLDS: &str = " ✓";
const FAILS_AS_IT_MUST: &str = " ✗";
const OBSERVED: &str = "";
const REFUTED: &str = " REFUTED";

/// One scheme in one setting.
#[derive(Clone)]
struct Row {
    setting: String,
    scheme: &'static str,
    /// The bound that is guaranteed.
    bound: Option<f64>,
    /// The figure or why there is none.
    words: String,
    verdict: &'static str,
}

impl Row {
    /// Of a figure, or NaN, and the error that ended the paths, of which one must be.
    fn new(
        setting: impl Display,
        scheme: &'static str,
        error: Option<String>,
        figure: f64,
        expected: Expected,
    ) -> Self {
        let measured = figure.is_finite();
        let (verdict, bound) = match expected {
            Expected::Guarantee(true, bound) => (HOLDS, bound),
            Expected::MoreThan(least) if error.is_some() || figure > least => {
                (FAILS_AS_IT_MUST, None)
            }
            Expected::Anything if measured || error.is_some() => (OBSERVED, None),
            _ => (REFUTED, None),
        };
        let words: Vec<_> = measured.then(|| number(figure)).into_iter().chain(error).collect();
        Self { setting: setting.to_string(), scheme, bound, words: words.join("; "), verdict }
    }
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs the cases that are asked for, and prints a table of each. Fails when a guarantee is
/// refuted.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    let mut all = Vec::new();
    for ((id, varied, shown, guaranteed, rows), experiment) in
        CASES.iter().zip(streams::HARD_CASES..)
    {
        if arguments.only.is_empty() || arguments.only.iter().any(|only| only == id) {
            let key = StreamKey { seed: arguments.seed, experiment };
            let rows = rows(&Context { key, quick: arguments.quick })?;
            println!("{id}\nshown: {shown}\nguaranteed: {guaranteed}\n{}\n", table(varied, &rows));
            all.extend(rows);
        }
    }
    let [hold, fail, observed, refuted] = [HOLDS, FAILS_AS_IT_MUST, OBSERVED, REFUTED]
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
    let settings = rows.chunk_by(|a, b| a.setting == b.setting).map(|rows| {
        let bound = rows.iter().filter_map(|row| row.bound).reduce(f64::max).map(number);
        let cell = |scheme: &&str| {
            let row = rows.iter().find(|row| row.scheme == *scheme);
            row.map(|row| format!("{}{}", row.words, row.verdict)).unwrap_or_default()
        };
        let start = [rows[0].setting.clone(), bound.unwrap_or_default()];
        start.into_iter().chain(schemes.iter().map(cell)).collect::<Vec<_>>()
    });
    let head = [varied, "bound"].into_iter().chain(schemes.iter().copied());
    command::table(head, usize::MAX, settings)
}
