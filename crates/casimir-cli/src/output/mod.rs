//! What results are written as: a page, figures, tables and arrays.

pub mod cluster;
mod expectation;
mod figures;
mod npz;
mod page;
mod steps;
mod sweep;

use std::path::Path;

use casimir::{
    analysis::StepCheck,
    mc::{
        TimeSeries,
        study::{COLUMNS, Series, StudyResult, write_rows},
        write_csv,
    },
    plot::files,
};
use serde_json::{Value, json};

use steps::{step_cell, step_errors};

pub use steps::step_lines;
pub use sweep::SweepReport;

pub use expectation::{expectation_json, expectation_text};

use crate::{
    arguments::Format,
    commands::Results,
    failure::Done,
    scene::{Observable, Scene},
};

/// Writes the report with its figures, and what else is asked for.
pub fn write(scene: &Scene, results: &Results, folder: &Path, formats: &[Format]) -> Done {
    let figures = figures::all(scene, results);
    let drawings = folder.join("figures");
    files::prepare(&drawings)?;
    for figure in figures.iter().flat_map(|(_, figures)| figures) {
        files::write(&drawings.join(format!("{}.svg", figure.file)), &figure.svg)?;
    }
    for format in formats {
        write_as(*format, scene, results, folder)?;
    }
    Ok(files::write(&folder.join("index.html"), page::page(scene, results, &figures))?)
}

fn write_as(format: Format, scene: &Scene, results: &Results, folder: &Path) -> Done {
    let Results { tables, study, .. } = results;
    let mut tables = tables.clone();
    // Of thousands of components it is found once for all tables.
    let columns = tables.first().map_or(&[][..], |table| &table.columns);
    let kept: Vec<bool> = columns.iter().map(|column| scene.keeps(&column.name)).collect();
    for table in &mut tables {
        let mut kept = kept.iter();
        table.columns.retain(|_| kept.next().is_some_and(|kept| *kept));
    }
    let tables = &tables[..];
    let file = |name: &str| folder.join(name);
    match format {
        Format::Csv => {
            let mut text = Vec::new();
            write_csv(tables, &mut text)?;
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
            files::write(&file("paths.json"), serde_json::to_string(tables)? + "\n")?;
            if let Some(study) = study {
                files::write(&file("study.json"), serde_json::to_string(study)? + "\n")?;
            }
        }
        Format::Npz => {
            npz::paths(&file("paths.npz"), scene, tables)?;
            study.iter().try_for_each(|study| npz::study(&file("study.npz"), study))?;
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
            let decimals = (3.0 - value.abs().log10().floor()).clamp(0.0, 8.0) as usize;
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
pub const AT_END: [&str; 7] =
    ["at the end", "mean", "95 % interval", "step error", "deviation", "median", "5 % … 95 %"];

/// The statistics at the final time.
pub fn rows_at_end(
    series: &[Series],
    checked: Option<(&StudyResult, &StepCheck)>,
) -> Vec<[String; 7]> {
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

/// The same as text, with columns as wide as their widest cell.
pub fn table_at_end(study: &StudyResult, check: Option<&StepCheck>) -> String {
    let all: Vec<_> = [AT_END.map(String::from)]
        .into_iter()
        .chain(rows_at_end(&study.series, Some(study).zip(check)))
        .collect();
    aligned(&all)
}

/// Paths whose values at the end are shown.
const SHOWN_PATHS: usize = 5;

/// The values at the end of the first of a few paths as text.
pub fn paths_at_end(scene: &Scene, tables: &[TimeSeries]) -> String {
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
    aligned(&rows)
}

/// Lines of cells, with columns as wide as their widest cell.
fn aligned<R: AsRef<[String]>>(rows: &[R]) -> String {
    let cell = |row: &R, k: usize| row.as_ref().get(k).map_or(0, |cell| cell.chars().count());
    let width = |k: usize| rows.iter().map(|row| cell(row, k)).max().unwrap_or(0);
    let line = |row: &R| {
        let cells = row.as_ref().iter().enumerate();
        let cells = cells.map(|(k, cell)| format!("{cell:<0$}", width(k)));
        format!("{}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// The results of a run for programs.
pub fn summary(scene: &Scene, results: &Results, folder: &Path) -> serde_json::Result<Value> {
    let Results { scheme, because, tables, study, check, seconds, .. } = results;
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
    let halted: Vec<Value> = tables
        .iter()
        .enumerate()
        .filter_map(|(path, table)| Some(json!({ "path": path, "why": table.halted.as_ref()? })))
        .collect();
    Ok(json!({
        "title": scene.title,
        "scheme": scheme,
        "because": because,
        "steps": scene.settings.steps,
        "paths": results.paths(),
        "seed": scene.settings.key.seed,
        "at_end": study.as_ref().map(last).transpose()?,
        "step_check": check,
        "warnings": study.as_ref().map_or(&[][..], |study| &study.warnings),
        "halted": halted,
        "seconds": seconds,
        "report": folder.join("index.html"),
    }))
}
