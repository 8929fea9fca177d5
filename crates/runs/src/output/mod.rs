//! Output of results: a page, figures, tables and arrays.

pub mod cluster;
mod figures;
mod npz;
mod page;
mod steps;
mod sweep;

use std::{iter, mem, path::Path};

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
        let more = table.len().saturating_sub(1 + MAX_LINES);
        let mut words = String::new();
        if self.single().is_none() && more > 0 {
            words = format!("{more} more lines in the report\n");
            table.truncate(1 + MAX_LINES);
        }
        format!("{warnings}{}\n{}{words}", self.computed(), aligned(&table))
    }

    /// Warnings with the combinations that they are about.
    fn warnings(&self) -> Vec<Warning> {
        let mut all = Vec::new();
        for (one, results) in self.found() {
            all.extend(results.warnings(&one.scene).into_iter().map(|mut warning| {
                warning.what.insert_str(0, &one.prefix());
                warning
            }));
        }
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
        let row = |label: &str, cells: Vec<String>| -> Vec<String> {
            single.is_none().then(|| label.to_owned()).into_iter().chain(cells).collect()
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
            let write = |name: &str, mut bytes: Vec<u8>| {
                if let Format::Json = format {
                    bytes.push(b'\n');
                }
                let ending = format!("{format:?}").to_lowercase();
                files::write(&folder.join(format!("{name}.{ending}")), bytes)
            };
            let single = self.single();
            let statistics = || -> Done<Vec<u8>> {
                Ok(match (format, single) {
                    (Format::Csv, _) => self.csv(Results::series)?,
                    (Format::Npz, _) => npz::bytes(self.arrays())?,
                    (Format::Json, Some((_, found))) => serde_json::to_vec(&found.study)?,
                    (Format::Json, None) => serde_json::to_vec_pretty(
                        &self.of_each(|(_, found)| json!({ "series": found.series() })),
                    )?,
                })
            };
            let Some((one, found)) = single else {
                write("sweep", statistics()?)?;
                continue;
            };
            let (tables, mut csv) = (kept(&one.scene, found.tables.clone()), Vec::new());
            let paths = match format {
                Format::Csv => write_csv(&tables, &mut csv).map(|()| csv)?,
                Format::Json => serde_json::to_vec(&tables)?,
                Format::Npz => {
                    let spectra = found.spectra.iter().cloned();
                    npz::bytes(npz::paths(&one.scene, tables).into_iter().chain(spectra))?
                }
            };
            write("paths", paths)?;
            if found.study.is_some() {
                write("study", statistics()?)?;
            }
            match format {
                Format::Csv if !found.lagged().is_empty() => {
                    write("lags", self.csv(Results::lagged)?)?;
                }
                Format::Json if !found.spectra.is_empty() => {
                    write("spectra", serde_json::to_vec(&found.spectra)?)?;
                }
                _ => {}
            }
        }
        Ok(files::write(&folder.join("index.html"), self.page(&figures))?)
    }
}

/// Arrays of paths, which are taken, and of statistics.
pub fn arrays(outcomes: &mut Outcomes<'_>) -> [Vec<Array>; 2] {
    let (statistics, sweep) = (outcomes.arrays(), outcomes.sweep);
    let mut paths = Vec::new();
    for results in outcomes.results.iter_mut().flatten().filter(|_| sweep.varied.is_empty()) {
        paths = npz::paths(sweep.scene(), kept(sweep.scene(), mem::take(&mut results.tables)));
        paths.append(&mut results.spectra);
    }
    [paths, statistics]
}

/// Tables with the columns that a scene keeps.
fn kept(scene: &Scene, mut tables: Vec<TimeSeries>) -> Vec<TimeSeries> {
    // Of thousands of components it is found once for all tables.
    let kept: Vec<bool> = tables
        .first()
        .map_or(&[][..], |table| &table.columns)
        .iter()
        .map(|column| scene.keeps(column))
        .collect();
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
    let mut titles = vec!["at the end"];
    for statistic in STATISTICS.iter().filter(|statistic| statistic.title.is_some()) {
        titles.extend(statistic.title);
        titles.extend(statistic.interval.iter().flat_map(|_| ["95 % interval", "step error"]));
    }
    titles.extend(["median", "5 % … 95 %"]);
    titles.into_iter().map(String::from).collect()
}

/// The statistics at the final time: the step error stands behind what has an interval.
fn at_end(series: &Series, results: &Results) -> Vec<String> {
    let (name, last) = (&series.observable, series.last());
    let between = |(lo, hi)| format!("[{}, {}]", digits(lo), digits(hi));
    let quantile = |level: f64| match last.quantile(level).map(|of| (of.value, of.lo.zip(of.hi))) {
        Some((None, Some(ends))) => between(ends),
        found => known(found.and_then(|(value, _)| value)),
    };
    let mut cells = vec![name.clone()];
    for statistic in STATISTICS.iter().filter(|statistic| statistic.title.is_some()) {
        cells.push(known((statistic.of)(last)));
        if let Some(interval) = statistic.interval {
            cells.push(interval(last).map_or_else(
                || last.interval_note.as_ref().map_or("–".into(), ToString::to_string),
                between,
            ));
            cells.push(step_cell(step_errors(results, name)));
        }
    }
    cells.extend([
        quantile(0.5),
        if last.quantiles.is_empty() {
            "–".into()
        } else {
            [0.05, 0.95].map(quantile).join(" … ")
        },
    ]);
    cells
}

/// Paths whose values at the end are shown.
const SHOWN_PATHS: usize = 5;

/// The values at the end of the first of a few paths.
fn paths_at_end(scene: &Scene, tables: &[TimeSeries]) -> Vec<Vec<String>> {
    let shown = &tables[..tables.len().min(SHOWN_PATHS)];
    let mut rows = vec![vec!["at the end".into()]];
    rows[0].extend((0..shown.len()).map(|path| format!("path {path}")));
    rows.extend(scene.observables.iter().map(|Observable { name, .. }| {
        let last = |table: &TimeSeries| table.column(name)?.last().copied();
        iter::once(name.clone()).chain(shown.iter().map(|table| known(last(table)))).collect()
    }));
    rows
}

/// The results of a run for programs.
fn summary((one, results): Run<'_>) -> Value {
    let scene = &one.scene;
    let at_end = |study: &StudyResult| {
        study
            .series
            .iter()
            .map(|series| {
                let mut last = json!(series.last());
                last["step_error"] = json!(
                    step_errors(results, &series.observable)
                        .map(|[mean, deviation]| json!({ "mean": mean, "deviation": deviation }))
                );
                (series.observable.clone(), last)
            })
            .collect::<Value>()
    };
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
