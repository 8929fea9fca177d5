//! Output of results: a page, figures, tables and arrays.

pub mod cluster;
mod figures;
mod npz;
mod page;
mod steps;
mod sweep;

use std::path::Path;

use casimir::{
    analysis::aligned,
    mc::{TimeSeries, files, write_csv},
    stats::Warning,
    study::{STATISTICS, Series, StudyResult},
};
use serde_json::{Value, json};

use steps::{step_cell, step_errors};

pub use figures::{Figure, Section, distinct};
pub use npz::{Array, bytes as npz_bytes};
pub use steps::step_lines;

use crate::{Outcomes, Results, failure::Done, lines_of};
use scenes::{Combination, Observable, Scene, digits};

/// A format of files that a run writes beside its report.
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[derive(Clone, Copy, Debug)]
pub enum Format {
    /// Tables as text
    Csv,
    /// Everything, for programs
    Json,
    /// Arrays for NumPy
    Npz,
}

/// A combination with its results.
type Run<'a> = (&'a Combination, &'a Results);

/// Lines of the table of a sweep on a terminal, or of warnings.
const MAX_LINES: usize = 24;

/// Outcomes as words, JSON, figures and files.
impl Outcomes<'_> {
    /// The run, if nothing is varied.
    fn single(&self) -> Option<Run<'_>> {
        self.found().next().filter(|_| self.sweep.varied.is_empty())
    }

    /// The results in words.
    pub fn text(&self) -> String {
        let (warnings, mut table) = (lines_of(&self.warnings()), self.table());
        let mut more = String::new();
        if self.single().is_none() && table.len() > 1 + MAX_LINES {
            more = format!("{} more lines in the report\n", table.len() - 1 - MAX_LINES);
            table.truncate(1 + MAX_LINES);
        }
        format!("{warnings}{}\n{}{more}", self.computed(), aligned(&table))
    }

    /// Warnings with the combinations that they are about.
    fn warnings(&self) -> Vec<Warning> {
        let of = |(one, results): Run<'_>| {
            let (prefix, warnings) = (one.prefix(), results.warnings(&one.scene).into_iter());
            warnings.map(move |warning| {
                let what = format!("{prefix}{}", warning.what);
                Warning { what, ..warning }
            })
        };
        let mut all: Vec<Warning> = self.found().flat_map(of).collect();
        let more = all.len().saturating_sub(MAX_LINES);
        all.truncate(MAX_LINES);
        all.extend((more > 0).then(|| Warning::new(format!("and {more} more"))));
        all
    }

    /// Summary of the computation in a line, and the reason for its scheme.
    fn computed(&self) -> String {
        let seconds = self.found().map(|(_, found)| found.seconds).sum::<f64>();
        let mut schemes: Vec<&str> = self.found().map(|(_, found)| &*found.scheme).collect();
        schemes.dedup();
        let (schemes, steps) = (schemes.join(", "), self.sweep.scene().settings.steps);
        let because = self.single().and_then(|(_, found)| found.because.as_ref());
        let because = because.map_or(String::new(), |because| format!("\n{schemes}: {because}"));
        let of = match self.sweep.combinations.len() {
            1 => String::new(),
            all => format!("{} of {all} combinations, each ", self.found().count()),
        };
        let paths = self.found().next().map_or(0, |(_, found)| found.paths());
        let s = if paths == 1 { "" } else { "s" };
        format!("{of}{paths} path{s}, {steps} steps of {schemes}, {seconds:.2} s{because}")
    }

    /// The table at the end, after a header: of each combination, or of the first paths.
    fn table(&self) -> Vec<Vec<String>> {
        let single = self.single();
        if let Some((_, Results { study: None, tables, .. })) = single {
            return paths_at_end(self.sweep.scene(), tables);
        }
        let row = |label: &str, cells: Vec<String>| {
            let label = single.is_none().then(|| label.to_owned());
            label.into_iter().chain(cells).collect()
        };
        let mut table = vec![row("", titles())];
        for (one, results) in self.found() {
            let series = results.series().iter();
            table.extend(series.map(|series| row(&one.label, at_end(series, results))));
        }
        table
    }

    /// The results for programs.
    pub fn json(&self) -> Value {
        if let Some(run) = self.single() {
            return summary(run);
        }
        let mut json = self.of_each(summary);
        json["warnings"] = json!(self.warnings());
        json
    }

    /// All figures by section.
    pub fn figures(&self) -> Vec<Section> {
        let mut figures = match self.single() {
            Some((one, found)) => figures::all(&one.scene, found),
            None => self.of_sweep(),
        };
        distinct(figures.iter_mut().flat_map(|(_, figures)| figures));
        figures
    }

    /// Writes the report with its figures, and what else is asked for.
    pub fn write(&self, folder: &Path, formats: &[Format]) -> Done {
        let (figures, drawings) = (self.figures(), folder.join("figures"));
        files::prepare(&drawings)?;
        for figure in figures.iter().flat_map(|(_, figures)| figures) {
            files::write(&drawings.join(format!("{}.svg", figure.file)), &figure.svg)?;
        }
        for format in formats {
            let ending = format!("{format:?}").to_lowercase();
            let write = |name: &str, mut bytes: Vec<u8>| {
                if let Format::Json = format {
                    bytes.push(b'\n');
                }
                files::write(&folder.join(format!("{name}.{ending}")), bytes)
            };
            let single = self.single();
            if let Some((one, found)) = single {
                let tables = kept(&one.scene, found.tables.clone());
                let mut text = Vec::new();
                match format {
                    Format::Csv => write_csv(&tables, &mut text)?,
                    Format::Json => text = serde_json::to_vec(&tables)?,
                    Format::Npz => {
                        let paths = npz::paths(&one.scene, tables);
                        text = npz::bytes(paths.chain(found.spectra.iter().cloned()))?;
                    }
                }
                write("paths", text)?;
                if let (Format::Json, [_, ..]) = (format, &found.spectra[..]) {
                    write("spectra", serde_json::to_vec(&found.spectra)?)?;
                }
            }
            let name = if single.is_some() { "study" } else { "sweep" };
            let found = match (format, single.map(|(_, found)| found.study.as_ref())) {
                (_, Some(None)) => continue,
                (Format::Csv, _) => self.csv(Results::series)?,
                (Format::Json, Some(study)) => serde_json::to_vec(&study)?,
                (Format::Json, None) => {
                    let json = self.of_each(|(_, found)| json!({ "series": found.series() }));
                    serde_json::to_vec_pretty(&json)?
                }
                (Format::Npz, _) => npz::bytes(self.arrays())?,
            };
            write(name, found)?;
            if let (Format::Csv, Some((_, found))) = (format, single)
                && !found.lagged().is_empty()
            {
                write("lags", self.csv(Results::lagged)?)?;
            }
        }
        Ok(files::write(&folder.join("index.html"), self.page(&figures))?)
    }
}

/// Arrays of paths, which are taken, and of statistics.
pub fn arrays(outcomes: &mut Outcomes<'_>) -> [Vec<Array>; 2] {
    let (statistics, sweep) = (outcomes.arrays(), outcomes.sweep);
    let single = outcomes.results.iter_mut().flatten().filter(|_| sweep.varied.is_empty());
    let (mut tables, mut spectra) = (Vec::new(), Vec::new());
    for results in single {
        tables.append(&mut results.tables);
        spectra.append(&mut results.spectra);
    }
    let paths = npz::paths(sweep.scene(), kept(sweep.scene(), tables));
    [paths.chain(spectra).collect(), statistics]
}

/// Tables with the columns that a scene keeps.
fn kept(scene: &Scene, mut tables: Vec<TimeSeries>) -> Vec<TimeSeries> {
    // Of thousands of components it is found once for all tables.
    let columns = tables.first().map_or(&[][..], |table| &table.columns);
    let kept: Vec<bool> = columns.iter().map(|column| scene.keeps(column)).collect();
    for table in &mut tables {
        let mut kept = kept.iter();
        table.columns.retain(|_| kept.next().is_some_and(|kept| *kept));
    }
    tables
}

/// Formats a value that may be unknown.
fn known(value: Option<f64>) -> String {
    value.map_or("–".into(), digits)
}

/// The titles of the columns of [`at_end`].
fn titles() -> Vec<String> {
    let of_table = STATISTICS.iter().filter(|statistic| statistic.title.is_some());
    let of_table = of_table.flat_map(|statistic| {
        let beside = statistic.interval.map(|_| ["95 % interval", "step error"]);
        statistic.title.into_iter().chain(beside.into_iter().flatten())
    });
    let all = ["at the end"].into_iter().chain(of_table).chain(["median", "5 % … 95 %"]);
    all.map(String::from).collect()
}

/// The statistics at the final time: the step error stands behind what has an interval.
fn at_end(series: &Series, results: &Results) -> Vec<String> {
    let (name, last) = (&series.observable, series.last());
    let between = |(lo, hi)| format!("[{}, {}]", digits(lo), digits(hi));
    let quantile = |level: f64| match last.quantile(level).map(|of| (of.value, of.lo.zip(of.hi))) {
        Some((None, Some(ends))) => between(ends),
        found => known(found.and_then(|(value, _)| value)),
    };
    let why = || last.interval_note.as_ref().map_or("–".into(), ToString::to_string);
    let mut cells = vec![name.clone()];
    for statistic in STATISTICS.iter().filter(|statistic| statistic.title.is_some()) {
        cells.push(known((statistic.of)(last)));
        if let Some(interval) = statistic.interval {
            cells.push(interval(last).map_or_else(why, between));
            cells.push(step_cell(step_errors(results, name)));
        }
    }
    let ends = [0.05, 0.95].map(quantile).join(" … ");
    cells.extend([quantile(0.5), if last.quantiles.is_empty() { "–".into() } else { ends }]);
    cells
}

/// Paths whose values at the end are shown.
const SHOWN_PATHS: usize = 5;

/// The values at the end of the first of a few paths.
fn paths_at_end(scene: &Scene, tables: &[TimeSeries]) -> Vec<Vec<String>> {
    let shown = &tables[..tables.len().min(SHOWN_PATHS)];
    let mut rows = vec![vec!["at the end".into()]];
    rows[0].extend((0..shown.len()).map(|path| format!("path {path}")));
    for Observable { name, .. } in &scene.observables {
        let last =
            |table: &TimeSeries| known(table.column(name).and_then(|all| all.last().copied()));
        let mut row = vec![name.clone()];
        row.extend(shown.iter().map(last));
        rows.push(row);
    }
    rows
}

/// The results of a run for programs.
fn summary((one, results): Run<'_>) -> Value {
    let scene = &one.scene;
    let last = |series: &Series| {
        let mut last = json!(series.last());
        last["step_error"] = json!(
            step_errors(results, &series.observable)
                .map(|[mean, deviation]| json!({ "mean": mean, "deviation": deviation }))
        );
        (series.observable.clone(), last)
    };
    let at_end = |study: &StudyResult| study.series.iter().map(last).collect::<Value>();
    let halted = results.halted(scene).map(|(path, why)| json!({ "path": path, "why": why }));
    json!({
        "title": scene.title,
        "scheme": results.scheme,
        "because": results.because,
        "steps": scene.settings.steps,
        "paths": results.paths(),
        "seed": scene.settings.key.seed,
        "at_end": results.study.as_ref().map(at_end),
        "step_check": results.check,
        "warnings": results.warnings(scene),
        "halted": halted.collect::<Vec<_>>(),
        "seconds": results.seconds,
    })
}
