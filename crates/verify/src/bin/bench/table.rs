//! The numbers on the terminal.

use analysis::Spread;
use comfy_table::Table;
use verify::command::table;

use crate::results::Speed;

/// Everything that was measured.
pub fn page(speed: &Speed) -> String {
    let workload = speed.workload;
    let parts = [
        Some(format!(
            "{} paths, {} steps of 2^-8, {}, one thread, noise and statistics included; best of \
             {}, ns ({}) for one step of one path",
            workload.paths, workload.steps, speed.simd, workload.repetitions, speed.clock
        )),
        (!speed.optimised).then(|| "built without optimisation".into()),
        speed.load_before.map(|load| format!("load before: {load:.2} processes")),
        Some(format!("{}\n", schemes(speed))),
        Some(format!("sexp on the rigid body with three noises:\n{}\n", threads(speed))),
        Some(growth(speed).to_string()),
        speed.peak_memory_mb.map(|peak| format!("peak memory of the process: {peak:.1} MB")),
    ];
    parts.into_iter().flatten().collect::<Vec<_>>().join("\n")
}

fn numbers(spread: &Spread, digits: usize) -> [String; 3] {
    [spread.best, spread.median, spread.worst].map(|number| format!("{number:.digits$}"))
}

fn schemes(speed: &Speed) -> Table {
    let header = ["system", "scheme", "D", "M", "best", "median", "worst", "wall, best"];
    let rows = speed.schemes.iter().map(|row| {
        let [best, median, worst] = numbers(&row.ns_per_path_step, 2);
        let [wall, ..] = numbers(&row.wall_ns_per_path_step, 2);
        let [dimension, noises] = [row.dimension, row.noises].map(|size| size.to_string());
        let [system, scheme] = [row.system, row.scheme].map(str::to_owned);
        [system, scheme, dimension, noises, best, median, worst, wall]
    });
    table(header, 2, rows)
}

fn threads(speed: &Speed) -> Table {
    let header = ["threads", "wall s, best", "median", "worst", "times as fast"];
    let rows = speed.threads.iter().map(|row| {
        let [best, median, worst] = numbers(&row.seconds, 4);
        [row.threads.to_string(), best, median, worst, format!("{:.2}", row.speedup)]
    });
    table(header, 0, rows)
}

fn growth(speed: &Speed) -> Table {
    let header = ["grows", "to", "path-steps", "ns, best", "median", "worst", "peak MB"];
    let rows = speed.growth.iter().map(|row| {
        let [best, median, worst] = numbers(&row.ns_per_path_step, 2);
        let peak = row.peak_memory_mb.map_or("unknown".into(), |mb| format!("{mb:.2}"));
        let [value, steps] = [row.value, row.path_steps].map(|number| number.to_string());
        [row.grows.into(), value, steps, best, median, worst, peak]
    });
    table(header, 1, rows)
}
