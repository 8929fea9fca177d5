//! What results are written as: a page, figures, tables and arrays.

pub mod cluster;
mod figures;
mod npz;
mod page;
mod steps;
mod sweep;

use casimir::real::elementary;
use std::{borrow::Cow, path::Path};

use casimir::{
    analysis::{StepCheck, aligned},
    mc::{
        TimeSeries,
        study::{COLUMNS, Series, StudyResult, write_rows},
        write_csv,
    },
    plot::files,
};
use clap::ValueEnum;
use serde_json::{Value, json};

use steps::{step_cell, step_errors};

pub use figures::{Drawn, Section};
pub use npz::Array;
pub use steps::step_lines;

use crate::{
    failure::Done,
    scene::{Combination, Observable, Scene, Sweep},
    verbs::{Outcomes, Results, warnings},
};

/// What a run writes beside its report.
#[derive(ValueEnum, Clone, Copy, Debug)]
pub enum Format {
    /// Tables as text
    Csv,
    /// Everything, for programs
    Json,
    /// Arrays for NumPy
    Npz,
}

/// What was computed, ready to be told: a run, or runs at each combination of what is varied.
pub struct Report<'a> {
    sweep: &'a Sweep,
    scene: &'a Scene,
    /// The runs that are here; one if nothing is varied.
    runs: Vec<Run<'a>>,
}

/// One run, with observables in time: statistics of many paths, the mean of a few.
struct Run<'a> {
    one: &'a Combination,
    results: &'a Results,
    series: Cow<'a, [Series]>,
}

/// Lines of the table of a sweep on a terminal, or of warnings.
const MOST_LINES: usize = 24;

impl<'a> Report<'a> {
    /// What was found.
    pub fn new(outcomes: &'a Outcomes<'_>) -> Self {
        let Outcomes { sweep, .. } = outcomes;
        let run = |(one, results): (&'a Combination, &'a Results)| {
            let series = match &results.study {
                Some(study) => Cow::Borrowed(&study.series[..]),
                None if sweep.varied.is_empty() => Cow::default(),
                None => sweep::means(&one.scene, &results.tables).into(),
            };
            Run { one, results, series }
        };
        let runs = outcomes.found().map(run).collect();
        Self { sweep, scene: &sweep.combinations[0].scene, runs }
    }

    /// The run, if nothing is varied.
    fn single(&self) -> Option<&Run<'a>> {
        self.runs.first().filter(|_| self.sweep.varied.is_empty())
    }

    /// The results in words.
    pub fn text(&self) -> String {
        let mut table = self.table();
        let most = if self.single().is_some() { table.len() } else { 1 + MOST_LINES };
        let more = table.len().saturating_sub(most);
        table.truncate(most);
        let more = (more > 0).then(|| format!("{more} more lines in the report\n"));
        let (warnings, computed) = (warnings(&self.warnings()), self.computed());
        format!("{warnings}{computed}\n{}{}", aligned(&table), more.unwrap_or_default())
    }

    /// Warnings with the combinations that they are about.
    fn warnings(&self) -> Vec<String> {
        let of = |Run { one, results, .. }: &Run<'_>| {
            let of = if one.label.is_empty() { String::new() } else { format!("{}: ", one.label) };
            let warnings = results.warnings(&one.scene).into_iter();
            warnings.map(|warning| format!("{of}{warning}")).collect::<Vec<_>>()
        };
        let mut all: Vec<String> = self.runs.iter().flat_map(of).collect();
        let more = all.len().saturating_sub(MOST_LINES);
        all.truncate(MOST_LINES);
        all.extend((more > 0).then(|| format!("and {more} more")));
        all
    }

    /// What was computed, in a line, and why by this scheme.
    fn computed(&self) -> String {
        let seconds = self.runs.iter().map(|run| run.results.seconds).sum::<f64>();
        let mut schemes: Vec<&str> = self.runs.iter().map(|run| &*run.results.scheme).collect();
        schemes.dedup();
        let (schemes, steps) = (schemes.join(", "), self.scene.settings.steps);
        let because = self.single().and_then(|run| run.results.because.as_ref());
        let because = because.map_or(String::new(), |because| format!("\n{schemes}: {because}"));
        let (here, all) = (self.runs.len(), self.sweep.combinations.len());
        let of =
            if all > 1 { format!("{here} of {all} combinations, each ") } else { String::new() };
        let paths = self.runs.first().map_or(0, |run| run.results.paths());
        let word = if paths == 1 { "path" } else { "paths" };
        format!("{of}{paths} {word}, {steps} steps of {schemes}, {seconds:.2} s{because}")
    }

    /// The table at the end, after a header: of each combination, or of the first paths.
    fn table(&self) -> Vec<Vec<String>> {
        if let Some(Run { results: Results { study: None, tables, .. }, .. }) = self.single() {
            return paths_at_end(self.scene, tables);
        }
        let header = [""].iter().chain(&AT_END).map(|&cell| cell.into()).collect();
        let rows = self.runs.iter().flat_map(|Run { one, results, series }| {
            let rows = rows_at_end(series, results.study.as_ref().zip(results.check.as_ref()));
            rows.into_iter().map(|row| [vec![one.label.clone()], row.to_vec()].concat())
        });
        let mut table: Vec<Vec<String>> = [header].into_iter().chain(rows).collect();
        if self.single().is_some() {
            table.iter_mut().for_each(|row| drop(row.remove(0)));
        }
        table
    }

    /// The results for programs.
    ///
    /// # Errors
    /// None that is known.
    pub fn json(&self) -> serde_json::Result<Value> {
        match self.single() {
            Some(run) => summary(run),
            None => {
                let mut json = self.of_each(summary)?;
                json["warnings"] = self.warnings().into();
                Ok(json)
            }
        }
    }

    /// All figures by section.
    pub fn figures(&self) -> Vec<Section> {
        match self.single() {
            Some(run) => figures::all(self.scene, run.results),
            None => self.of_sweep(),
        }
    }

    /// Writes the report with its figures, and what else is asked for.
    pub fn write(&self, folder: &Path, formats: &[Format]) -> Done {
        let (figures, drawings) = (self.figures(), folder.join("figures"));
        files::prepare(&drawings)?;
        for figure in figures.iter().flat_map(|(_, figures)| figures) {
            files::write(&drawings.join(format!("{}.svg", figure.file)), &figure.svg)?;
        }
        for format in formats {
            match (self.single(), format) {
                (Some(run), _) => write_as(*format, self.scene, run.results, folder)?,
                (None, Format::Csv) => files::write(&folder.join("sweep.csv"), self.csv()?)?,
                (None, Format::Json) => {
                    let json = self.of_each(|run| Ok(json!({ "series": run.series })))?;
                    files::write_json(&folder.join("sweep.json"), &json)?;
                }
                (None, Format::Npz) => npz::write(&folder.join("sweep.npz"), self.arrays())?,
            }
        }
        Ok(files::write(&folder.join("index.html"), self.page(&figures))?)
    }
}

/// Arrays of paths, which are taken, and of statistics.
pub fn arrays(outcomes: &mut Outcomes<'_>) -> [Vec<Array>; 2] {
    let both = outcomes.sweep.combinations.iter().zip(&mut outcomes.results);
    let found = both.filter_map(|(one, results)| Some((&one.scene, results.as_mut()?))).next();
    match found.filter(|_| outcomes.sweep.varied.is_empty()) {
        None => [Vec::new(), Report::new(outcomes).arrays()],
        Some((scene, results)) => {
            let tables = kept(scene, std::mem::take(&mut results.tables));
            let statistics = results.study.as_ref().map_or_else(Vec::new, npz::study);
            [npz::paths(scene, tables).collect(), statistics]
        }
    }
}

/// Tables with the columns that a scene keeps.
fn kept(scene: &Scene, mut tables: Vec<TimeSeries>) -> Vec<TimeSeries> {
    // Of thousands of components it is found once for all tables.
    let columns = tables.first().map_or(&[][..], |table| &table.columns);
    let kept: Vec<bool> = columns.iter().map(|column| scene.keeps(&column.name)).collect();
    for table in &mut tables {
        let mut kept = kept.iter();
        table.columns.retain(|_| kept.next().is_some_and(|kept| *kept));
    }
    tables
}

fn write_as(format: Format, scene: &Scene, results: &Results, folder: &Path) -> Done {
    let study = &results.study;
    let tables = kept(scene, results.tables.clone());
    let file = |name: &str| folder.join(name);
    match format {
        Format::Csv => {
            let mut text = Vec::new();
            write_csv(&tables, &mut text)?;
            files::write(&file("paths.csv"), &text)?;
            let both = study
                .iter()
                .flat_map(|study| [("study.csv", &study.series), ("lags.csv", &study.lagged)]);
            for (name, series) in both.filter(|(_, series)| !series.is_empty()) {
                let mut text = format!("{COLUMNS}\n").into_bytes();
                write_rows(series, "", &mut text)?;
                files::write(&file(name), &text)?;
            }
        }
        Format::Json => {
            files::write(&file("paths.json"), serde_json::to_string(&tables)? + "\n")?;
            if let Some(study) = study {
                files::write(&file("study.json"), serde_json::to_string(study)? + "\n")?;
            }
        }
        Format::Npz => {
            let paths = npz::paths(scene, tables);
            npz::write(&file("paths.npz"), paths)?;
            let write = |study| npz::write(&file("study.npz"), npz::study(study));
            study.iter().try_for_each(write)?;
        }
    }
    Ok(())
}

/// A number with as many digits as a reader needs.
pub fn digits(value: Option<f64>) -> String {
    match value {
        None => "–".into(),
        Some(0.0) => "0".into(),
        Some(value) if (1e-3..1e5).contains(&value.abs()) => {
            let decimals = (3.0 - elementary::log10(value.abs()).floor()).clamp(0.0, 8.0) as usize;
            let text = format!("{value:.decimals$}");
            // 0.2 and not 0.2000.
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        Some(value) => format!("{value:.3e}"),
    }
}

/// The columns of [`rows_at_end`].
const AT_END: [&str; 7] =
    ["at the end", "mean", "95 % interval", "step error", "deviation", "median", "5 % … 95 %"];

/// The statistics at the final time.
fn rows_at_end(series: &[Series], checked: Option<(&StudyResult, &StepCheck)>) -> Vec<[String; 7]> {
    let row = |series: &Series| {
        let last = series.last();
        let between = |(lo, hi)| format!("[{}, {}]", digits(Some(lo)), digits(Some(hi)));
        let quantile = |level: f64| {
            let found = last.quantiles.iter().find(|quantile| quantile.level == level);
            let ends = found.filter(|found| found.value.is_none());
            let ends = ends.and_then(|found| found.lo.zip(found.hi));
            ends.map_or_else(|| digits(found.and_then(|found| found.value)), between)
        };
        let why = || last.interval_note.clone().unwrap_or("–".into());
        [
            series.observable.clone(),
            digits(last.mean),
            last.mean_interval.map_or_else(why, between),
            step_cell(
                checked.and_then(|(study, check)| step_errors(check, study, &series.observable)),
            ),
            digits(last.deviation),
            quantile(0.5),
            match last.quantiles.is_empty() {
                true => "–".into(),
                false => format!("{} … {}", quantile(0.05), quantile(0.95)),
            },
        ]
    };
    series.iter().map(row).collect()
}

/// Paths whose values at the end are shown.
const SHOWN_PATHS: usize = 5;

/// The values at the end of the first of a few paths.
fn paths_at_end(scene: &Scene, tables: &[TimeSeries]) -> Vec<Vec<String>> {
    let shown = &tables[..tables.len().min(SHOWN_PATHS)];
    let header = (0..shown.len()).map(|path| format!("path {path}"));
    let row = |observable: &Observable| {
        let last = |table: &TimeSeries| table.column(&observable.name)?.last().copied();
        let values = shown.iter().map(|table| digits(last(table)));
        [observable.name.clone()].into_iter().chain(values).collect()
    };
    let mut rows: Vec<Vec<String>> =
        vec![["at the end".into()].into_iter().chain(header).collect()];
    rows.extend(scene.observables.iter().map(row));
    rows
}

/// The results of a run for programs.
fn summary(Run { one, results, .. }: &Run<'_>) -> serde_json::Result<Value> {
    let (scene, results) = (&one.scene, *results);
    let Results { scheme, because, study, check, seconds, .. } = results;
    let last = |study: &StudyResult| {
        let last = |series: &Series| {
            let mut last = serde_json::to_value(series.last())?;
            let check = check.as_ref();
            let errors = check.and_then(|check| step_errors(check, study, &series.observable));
            last["step_error"] = json!(errors.map(|[mean, deviation]| json!({
                "mean": mean, "deviation": deviation,
            })));
            Ok((series.observable.clone(), last))
        };
        study.series.iter().map(last).collect::<serde_json::Result<serde_json::Map<_, _>>>()
    };
    let halted = results.halted(scene).map(|(path, why)| json!({ "path": path, "why": why }));
    Ok(json!({
        "title": scene.title,
        "scheme": scheme,
        "because": because,
        "steps": scene.settings.steps,
        "paths": results.paths(),
        "seed": scene.settings.key.seed,
        "at_end": study.as_ref().map(last).transpose()?,
        "step_check": check,
        "warnings": results.warnings(scene),
        "halted": halted.collect::<Vec<_>>(),
        "seconds": seconds,
    }))
}
