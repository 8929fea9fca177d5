//! **Hard inputs: what exact mathematics says, what every scheme does, and what is guaranteed.**
//!
//! `cargo xtask stability`. Each case runs all schemes on inputs that break numerical codes:
//! damping factors that underflow, rates that are infinite, noise past the contraction bound,
//! states of 10¹⁵⁰. A guarantee is a derived bound; a row reports whether it holds, whether a scheme
//! fails where theory predicts failure, or that the guarantee is refuted. What each case is and what
//! exact mathematics says of it stands at its function in `cases`.
//!
//! *To rounding* means [`verify::rounding`]. Increments are truncated with k = 4 unless said
//! otherwise. A path that cannot go on ends with a typed error, never with NaN. Long runs and
//! arbitrary inputs are the tests in `tests/hard_cases`.

mod cases;
mod paths;
mod row;
mod schemes;

use std::process::ExitCode;

use analysis::number;
use anyhow::Result;
use clap::{Parser, builder::PossibleValuesParser};
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use noise::StreamKey;
use verify::{command, streams};

use cases::CASES;
use row::{Row, Verdict};

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
    /// Identifier.
    id: &'static str,
    /// What the measured figure is.
    quantity: &'static str,
    /// What is guaranteed, and why.
    guarantee: &'static str,
    /// What the settings vary.
    varied: &'static str,
    /// Runs all schemes in all settings.
    rows: fn(&Context) -> Rows,
}

/// All schemes in all settings of a case.
type Rows = Result<Vec<Row>>;

/// What a case needs to run.
struct Context {
    key: StreamKey,
    quick: bool,
}

impl Context {
    /// `full`, or `quick` where seconds count.
    fn many(&self, full: u64, quick: u64) -> u64 {
        if self.quick { quick } else { full }
    }
}

/// The rows of every setting.
fn each<T>(settings: impl IntoIterator<Item = T>, rows: impl FnMut(T) -> Rows) -> Rows {
    Ok(settings.into_iter().map(rows).collect::<Result<Vec<_>>>()?.concat())
}

fn main() -> ExitCode {
    command::exit_code(run(&Arguments::parse()))
}

/// Runs the cases that are asked for, and prints a table of each. Fails when a guarantee is refuted.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    let mut all = Vec::new();
    for (case, experiment) in CASES.iter().zip(streams::HARD_CASES..) {
        if arguments.only.is_empty() || arguments.only.iter().any(|id| id == case.id) {
            let key = StreamKey { seed: arguments.seed, experiment };
            let rows = (case.rows)(&Context { key, quick: arguments.quick })?;
            let Case { id, guarantee, quantity, .. } = case;
            println!("{id}\nguaranteed: {guarantee}\nshown: {quantity}\n{}\n", table(case, &rows));
            all.extend(rows);
        }
    }
    use Verdict::{FailsAsItMust, Holds, Observed, Refuted};
    let count = |one| all.iter().filter(|row| row.verdict == one).count();
    let [hold, fail, observed, refuted] = [Holds, FailsAsItMust, Observed, Refuted].map(count);
    println!("{hold} hold, {fail} fail as they must, {observed} observed, {refuted} refuted");
    Ok(if refuted == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Settings down, schemes across.
fn table(case: &Case, rows: &[Row]) -> Table {
    let mut schemes: Vec<&str> = Vec::new();
    for row in rows {
        if !schemes.contains(&row.scheme) {
            schemes.push(row.scheme);
        }
    }
    let mut table = Table::new();
    let head = [case.varied, "exact", "bound"].into_iter().chain(schemes.iter().copied());
    table.load_style(ASCII_MARKDOWN).set_header(head);
    for rows in rows.chunk_by(|a, b| a.setting == b.setting) {
        let mut exact: Vec<String> = rows.iter().filter_map(|row| row.exact.map(number)).collect();
        exact.dedup();
        let holding = rows.iter().filter(|row| row.verdict == Verdict::Holds);
        let bound = holding.filter_map(|row| row.bound).reduce(f64::max).map(number);
        let start = [rows[0].setting.clone(), exact.join("; "), bound.unwrap_or_default()];
        let row = |scheme: &&str| rows.iter().find(|row| row.scheme == *scheme);
        let cells = schemes.iter().map(|scheme| row(scheme).map(cell).unwrap_or_default());
        table.add_row(start.into_iter().chain(cells));
    }
    table
}

/// The figure of a row or why there is none, and what became of the guarantee.
fn cell(row: &Row) -> String {
    let figure = row.measured.map(number);
    let words: Vec<String> = figure.into_iter().chain(row.error.clone()).collect();
    let mark = match row.verdict {
        Verdict::Holds => "✓",
        Verdict::FailsAsItMust => "✗",
        Verdict::Observed => "",
        Verdict::Refuted => "REFUTED",
    };
    format!("{} {mark}", words.join("; ")).trim().into()
}
