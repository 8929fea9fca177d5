//! The numbers on the terminal.

use std::fmt::Write;

use comfy_table::presets::ASCII_MARKDOWN;
use comfy_table::{CellAlignment, Table};
use speed::{Clock, GrowthRow, SchemeRow, Speed, Spread, ThreadRow};

/// Everything that was measured.
pub fn page(speed: &Speed) -> String {
    let workload = speed.workload;
    let mut page = String::new();
    let _ = writeln!(
        page,
        "{} paths, {} steps of 2^-8, {}, one thread, noise and statistics included; best of {}, ns for one step of one \
         path {}",
        workload.paths,
        workload.steps,
        speed.simd,
        workload.repetitions,
        match speed.clock {
            Clock::OnCore => "on the core",
            Clock::Wall => "on the wall",
        }
    );
    if !speed.optimised {
        page.push_str("built without optimisation: the numbers say nothing\n");
    }
    if let Some(load) = speed.load_before {
        let _ = writeln!(page, "{load:.2} other processes were at work on average before");
    }
    let _ = writeln!(page, "{}\n", schemes(&speed.schemes));
    let _ =
        writeln!(page, "sexp on the rigid body with three noises:\n{}\n", threads(&speed.threads));
    let _ = writeln!(page, "{}", growth(&speed.growth));
    if let Some(peak) = speed.peak_memory_mb {
        let _ = writeln!(page, "peak memory of the process: {peak:.1} MB");
    }
    page
}

/// A table whose columns from number `first_number` on are numbers.
fn table(header: &[&str], first_number: usize) -> Table {
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN).set_header(header);
    for column in table.column_iter_mut().skip(first_number) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn numbers(spread: &Spread) -> [String; 3] {
    [spread.best, spread.median, spread.worst].map(|number| format!("{number:.2}"))
}

fn schemes(rows: &[SchemeRow]) -> Table {
    let mut table =
        table(&["system", "scheme", "D", "M", "best", "median", "worst", "wall, best"], 2);
    for row in rows {
        let [best, median, worst] = numbers(&row.ns_per_path_step);
        table.add_row([
            row.system.clone(),
            row.scheme.clone(),
            row.dimension.to_string(),
            row.noises.to_string(),
            best,
            median,
            worst,
            format!("{:.2}", row.wall_ns_per_path_step.best),
        ]);
    }
    table
}

fn threads(rows: &[ThreadRow]) -> Table {
    let mut table = table(&["threads", "wall s, best", "median", "worst", "times as fast"], 0);
    for row in rows {
        let [best, median, worst] =
            [row.seconds.best, row.seconds.median, row.seconds.worst].map(|s| format!("{s:.4}"));
        table.add_row([
            row.threads.to_string(),
            best,
            median,
            worst,
            format!("{:.2}", row.speedup),
        ]);
    }
    table
}

fn growth(rows: &[GrowthRow]) -> Table {
    let mut table =
        table(&["grows", "to", "path-steps", "ns, best", "median", "worst", "peak MB"], 1);
    for row in rows {
        let [best, median, worst] = numbers(&row.ns_per_path_step);
        table.add_row([
            row.grows.clone(),
            row.value.to_string(),
            row.path_steps.to_string(),
            best,
            median,
            worst,
            row.peak_memory_mb.map_or_else(|| "unknown".to_owned(), |mb| format!("{mb:.2}")),
        ]);
    }
    table
}
