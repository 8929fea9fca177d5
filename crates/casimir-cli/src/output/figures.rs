//! The figures of a run.

use casimir::{
    mc::TimeSeries,
    plot::{
        Series,
        figure::{Trace, bands, evolution, histogram, lines},
    },
    stats::Point,
};

use super::digits;
use crate::{
    commands::Results,
    scene::{MOST_COMPONENTS, Scene},
};

/// A drawing with its file and the words below it.
pub struct Drawn {
    /// The name of its file without `.svg`.
    pub file: String,
    /// The SVG document.
    pub svg: String,
    /// What it shows.
    pub caption: String,
}

/// A section of figures.
pub type Section = (&'static str, Vec<Drawn>);

/// Paths in a figure; more hide each other.
const SHOWN_PATHS: usize = 4;
/// Laws in a report.
const SHOWN_LAWS: usize = 6;
/// Phase portraits in a report.
const PORTRAITS: usize = 3;

/// All figures of a run by section; no section is empty.
pub fn all(scene: &Scene, results: &Results) -> Vec<Section> {
    let mut sections = Vec::new();
    let mut add = |title, figures: Vec<Drawn>| {
        if !figures.is_empty() {
            sections.push((title, figures));
        }
    };
    match &results.study {
        Some(study) => {
            let levels = percent(&study.record.quantiles);
            let bands = study.series.iter().map(|series| Drawn {
                file: file("time", &series.observable),
                svg: bands(&series.observable, series),
                caption: format!(
                    "{} in time, {} paths. Bands between the quantiles {levels}; line: median; \
                     dashes: mean.",
                    series.observable, study.record.paths
                ),
            });
            add("In time", bands.collect());
            let histograms = study.series.iter().map(|series| Drawn {
                file: file("end", &series.observable),
                svg: histogram(&series.observable, &series.observable, series.last()),
                caption: format!(
                    "The law of {} at t = {}, {} paths: density; line: median; dashes: mean.",
                    series.observable,
                    series.last().time,
                    series.last().count
                ),
            });
            add("At the end", histograms.collect());
        }
        None => {
            let columns = scene.observables.iter().map(|observable| {
                let name = &observable.name;
                let traces = traces(results, |table| table.times().to_vec(), name);
                let shown = traces.len();
                Drawn {
                    file: file("time", name),
                    svg: lines(name, "time t", name, &traces),
                    caption: format!("{name} in time on {}.", paths(shown, results)),
                }
            });
            add("In time", columns.collect());
        }
    }
    add("Phase portraits", portraits(scene, results));
    add("Conserved but for the damping", laws(results));
    sections
}

/// `5 %, 25 %, …`
fn percent(levels: &[f64]) -> String {
    let words = levels.iter().map(|level| format!("{} %", digits(Some(100.0 * level))));
    words.collect::<Vec<_>>().join(", ")
}

/// `path 0`, or how many of how many.
fn paths(shown: usize, results: &Results) -> String {
    match (shown, results.tables.len()) {
        (1, 1) => "path 0".into(),
        (shown, all) if shown == all => format!("{all} paths"),
        (shown, all) => format!("the first {shown} of {all} paths"),
    }
}

/// A name of a file.
pub fn file(what: &str, name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() { c } else { '-' };
    format!("{what}-{}", name.chars().map(plain).collect::<String>())
}

/// A column of the first tables against something.
fn traces(results: &Results, x: impl Fn(&TimeSeries) -> Vec<f64>, y: &str) -> Vec<Trace> {
    let trace = |(path, table): (usize, &TimeSeries)| {
        let values = table.column(y).unwrap_or_default();
        Trace {
            name: format!("path {path}"),
            points: x(table).into_iter().zip(values.iter().copied()).collect(),
        }
    };
    results.tables.iter().enumerate().take(SHOWN_PATHS).map(trace).collect()
}

fn portraits(scene: &Scene, results: &Results) -> Vec<Drawn> {
    let names = &scene.components;
    if names.len() > MOST_COMPONENTS || names.len() < 2 {
        return Vec::new();
    }
    let pairs: Vec<(usize, usize)> = match names.len() {
        2 => vec![(0, 1)],
        3 => vec![(0, 1), (1, 2), (0, 2)],
        dimension => (0..dimension - 1).step_by(2).map(|i| (i, i + 1)).collect(),
    };
    let portrait = |&(i, j): &(usize, usize)| {
        let (x, y) = (&names[i], &names[j]);
        let of = |table: &TimeSeries| table.column(x).unwrap_or_default().to_vec();
        let traces = traces(results, of, y);
        let shown = traces.len();
        Drawn {
            file: file("portrait", &format!("{x} {y}")),
            svg: lines(&format!("{y} against {x}"), x, y, &traces),
            caption: format!(
                "{y} against {x} on {}; the marker is the initial value.",
                paths(shown, results)
            ),
        }
    };
    pairs.iter().take(PORTRAITS).map(portrait).collect()
}

/// Casimirs and energies with their conformal law and the defect from it.
fn laws(results: &Results) -> Vec<Drawn> {
    let Some(first) = results.tables.first() else { return Vec::new() };
    let largest = |name: &str| {
        let columns = results.tables.iter().filter_map(|table| table.column(name));
        columns.flatten().fold(0.0f64, |largest, defect| largest.max(defect.abs()))
    };
    let defects = first.columns.iter().filter(|column| column.name.ends_with(" defect"));
    let mut defects: Vec<(&str, f64)> =
        defects.map(|column| (&*column.name, largest(&column.name))).collect();
    let all = defects.len();
    // Those that deviate most, of many.
    if all > SHOWN_LAWS {
        defects.sort_by(|a, b| b.1.total_cmp(&a.1));
        defects.truncate(SHOWN_LAWS);
    }
    let of_all = if all > SHOWN_LAWS {
        format!(", one of the largest of {all} laws")
    } else {
        String::new()
    };
    let law = |(column, largest): (&str, f64)| {
        let name = column.trim_end_matches(" defect");
        let series = |(path, table): (usize, &TimeSeries)| {
            let (values, defects) = (table.column(name)?, table.column(&format!("{name} defect"))?);
            let points = table.times().iter().zip(values).zip(defects);
            let points = points.map(|((&t, &value), &defect)| {
                // The defect is (value − law)/|law|, or the value itself where the law is zero.
                let law = if value == defect { 0.0 } else { law_of(value, defect) };
                Point::Value { t, value, exact: law }
            });
            Some(Series {
                scheme: format!("path {path}"),
                quantity: name.into(),
                points: points.collect(),
                ..Series::default()
            })
        };
        let tables = results.tables.iter().enumerate().take(SHOWN_PATHS);
        let series: Vec<Series> = tables.filter_map(series).collect();
        Drawn {
            file: file("law", name),
            svg: evolution(name, &series),
            caption: format!(
                "{name} on {}: values with the conformal law e^(−p∫γ) {name}(y(0)) above, relative \
                 defects below; the largest is {largest:.1e}{of_all}.",
                paths(series.len(), results)
            ),
        }
    };
    defects.into_iter().map(law).collect()
}

/// The law of which `value` has the relative defect `defect`.
fn law_of(value: f64, defect: f64) -> f64 {
    let size = value / (1.0 + defect);
    // (value − law)/|law| with a negative law: value = law(1 − defect).
    if size < 0.0 { value / (1.0 - defect) } else { size }
}
