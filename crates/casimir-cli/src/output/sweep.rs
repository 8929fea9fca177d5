//! What a sweep found: against its parameters, in time, and as arrays over both.

use std::{borrow::Cow, io, iter::zip, path::Path};

use casimir::{
    mc::{
        quoted,
        study::{COLUMNS, Series, Summary, write_rows},
    },
    plot::{
        Document,
        figure::{Sampled, against, multiples},
        files,
    },
};
use serde_json::{Value, json};

use super::{AT_END, aligned, digits, figures::file, npz, rows_at_end, summary};
use crate::{
    arguments::Format,
    commands::{Outcomes, Results},
    failure::Done,
    scene::{Combination, Scene, Sweep, Varied},
};

/// Curves in one figure, and small multiples.
const MOST_CURVES: usize = 5;
const MOST_PANELS: usize = 24;
/// Lines of a table on a terminal, or of warnings.
const MOST_LINES: usize = 24;

/// The runs of a sweep that are here.
pub struct SweepReport<'a> {
    sweep: &'a Sweep,
    scene: &'a Scene,
    runs: Vec<Run<'a>>,
}

/// One run.
struct Run<'a> {
    one: &'a Combination,
    results: &'a Results,
    series: Cow<'a, [Series]>,
}

/// The observables in time: statistics of many paths, the mean of a few.
fn series<'a>(scene: &Scene, results: &'a Results) -> Cow<'a, [Series]> {
    if let Some(study) = &results.study {
        return Cow::Borrowed(&study.series);
    }
    let tables = &results.tables;
    let longest = tables.iter().map(|table| table.times()).max_by_key(|times| times.len());
    let series = |name: &String| {
        let columns: Vec<&[f64]> = tables.iter().filter_map(|table| table.column(name)).collect();
        let point = |(k, &time): (usize, &f64)| {
            let values = columns.iter().filter_map(|values| values.get(k));
            let (sum, count) = values.fold((0.0, 0), |(sum, n), value| (sum + value, n + 1));
            Summary { time, count, mean: Some(sum / count as f64), ..Summary::default() }
        };
        let points = longest.unwrap_or_default().iter().enumerate().map(point).collect();
        Series { observable: name.clone(), points }
    };
    scene.observables.iter().map(|observable| series(&observable.name)).collect()
}

/// `number` of many, evenly spaced.
fn spread<T>(all: Vec<T>, number: usize) -> Vec<T> {
    let many = all.len();
    let kept = |k: usize| many <= number || k * number / many != (k + 1) * number / many;
    all.into_iter().enumerate().filter(|(k, _)| kept(*k)).map(|(_, one)| one).collect()
}

impl<'a> SweepReport<'a> {
    /// What is found of a sweep.
    pub fn new(outcomes: &'a Outcomes<'_>) -> Self {
        let run = |(one, results): (&'a Combination, &'a Results)| Run {
            one,
            results,
            series: series(&one.scene, results),
        };
        Self {
            sweep: outcomes.sweep,
            scene: &outcomes.sweep.combinations[0].scene,
            runs: outcomes.found().map(run).collect(),
        }
    }

    /// Figures with their files and captions: for each observable one against the parameter that
    /// has most values, and one in time.
    fn figures(&self) -> Vec<(String, String, String)> {
        let varied = self.sweep.varied.iter().enumerate().rev();
        let most = varied.max_by_key(|(_, varied)| varied.values.len());
        let Some((x, Varied { name: parameter, values })) = most else { return Vec::new() };
        let own = format!("{parameter} = ");
        let drawn = &self.scene.drawn;
        let of = |(k, Series { observable: name, .. }): (usize, &Series)| {
            let mut curves: Vec<(String, Vec<Sampled>)> = Vec::new();
            for Run { one, series, .. } in &self.runs {
                let others: Vec<&str> =
                    one.label.split(", ").filter(|part| !part.starts_with(&own)).collect();
                let (last, others) = (series[k].last(), others.join(", "));
                let value = last.mean.unwrap_or(f64::NAN);
                let point = (values[one.places[x]], value, last.mean_interval);
                match curves.iter_mut().find(|(of, _)| *of == others) {
                    Some((_, points)) => points.push(point),
                    None => curves.push((others, vec![point])),
                }
            }
            curves.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
            let curves = spread(curves, MOST_CURVES);
            let words = format!("{name} against {parameter}");
            let svg = against(&words, drawn.title(parameter), drawn.title(name), &curves);
            let caption = format!("{name} at the end against {parameter}: mean, 95 % intervals.");
            let panels =
                self.runs.iter().map(|run| (run.one.label.clone(), &run.series[k])).collect();
            let panels = spread(panels, MOST_PANELS);
            let in_time = format!(
                "{name} in time: bands between quantiles, line: median, dashes: mean. {} of {} \
                 combinations.",
                panels.len(),
                self.runs.len()
            );
            [
                (file("against", name), svg, caption),
                (file("time", name), multiples(name, drawn.title(name), &panels), in_time),
            ]
        };
        let first = self.runs.first().into_iter().flat_map(|run| run.series.iter());
        let is_shown = |name| drawn.show.as_ref().is_none_or(|show| show.contains(name));
        let shown = first.enumerate().filter(|(_, series)| is_shown(&series.observable));
        shown.flat_map(of).collect()
    }

    /// The table at the end: the combination, and the columns of a run.
    fn table(&self) -> Vec<Vec<String>> {
        let header = [""].iter().chain(&AT_END).map(|&cell| cell.into()).collect();
        let rows = self.runs.iter().flat_map(|Run { one, results, series }| {
            let rows = rows_at_end(series, results.study.as_ref().zip(results.check.as_ref()));
            rows.into_iter().map(|row| [vec![one.label.clone()], row.to_vec()].concat())
        });
        [header].into_iter().chain(rows).collect()
    }

    /// Warnings with the combinations that they are about.
    fn warnings(&self) -> Vec<String> {
        let of = |Run { one, results, .. }: &Run<'_>| {
            let warnings = results.warnings(&one.scene).into_iter();
            warnings.map(|warning| format!("{}: {warning}", one.label)).collect::<Vec<_>>()
        };
        let mut all: Vec<String> = self.runs.iter().flat_map(of).collect();
        let more = all.len().saturating_sub(MOST_LINES);
        all.truncate(MOST_LINES);
        all.extend((more > 0).then(|| format!("and {more} more")));
        all
    }

    /// What was computed, in a line.
    fn computed(&self) -> String {
        let mut schemes: Vec<&str> = self.runs.iter().map(|run| &*run.results.scheme).collect();
        schemes.dedup();
        format!(
            "{} of {} combinations, each {} paths with {} steps of {}, {:.2} s",
            self.runs.len(),
            self.sweep.combinations.len(),
            self.scene.settings.paths,
            self.scene.settings.steps,
            schemes.join(", "),
            self.runs.iter().map(|run| run.results.seconds).sum::<f64>()
        )
    }

    /// The results in words.
    pub fn text(&self, folder: &Path) -> String {
        let warnings = self.warnings().into_iter().map(|warning| format!("warning: {warning}\n"));
        let mut table = self.table();
        let more = table.len().saturating_sub(1 + MOST_LINES);
        table.truncate(1 + MOST_LINES);
        let more = (more > 0).then(|| format!("{more} more lines in the report\n"));
        format!(
            "{}{}\n{}{}report: {}\n",
            warnings.collect::<String>(),
            self.computed(),
            aligned(&table),
            more.unwrap_or_default(),
            folder.join("index.html").display()
        )
    }

    /// The results for programs: `of` each combination.
    fn json(
        &self,
        of: impl Fn(&Run<'_>) -> serde_json::Result<Value>,
    ) -> serde_json::Result<Value> {
        let run = |run: &Run<'_>| {
            let both = zip(&self.sweep.varied, &run.one.places);
            let both = both.map(|(varied, &k)| (varied.name.clone(), json!(varied.values[k])));
            let mut found = of(run)?;
            found["parameters"] = both.collect();
            Ok(found)
        };
        let varied = self.sweep.varied.iter();
        let varied = varied.map(|varied| (varied.name.clone(), json!(varied.values)));
        Ok(json!({
            "title": self.scene.title,
            "sweep": varied.collect::<Value>(),
            "runs": self.runs.iter().map(run).collect::<serde_json::Result<Vec<_>>>()?,
        }))
    }

    /// The results at the end.
    pub fn summary(&self, folder: &Path) -> serde_json::Result<Value> {
        self.json(|run| summary(&run.one.scene, run.results, folder))
    }

    /// Writes the report with its figures, and what else is asked for.
    pub fn write(&self, folder: &Path, formats: &[Format], same_noise: bool) -> Done {
        let (figures, drawings) = (self.figures(), folder.join("figures"));
        files::prepare(&drawings)?;
        for (file, svg, _) in &figures {
            files::write(&drawings.join(format!("{file}.svg")), svg)?;
        }
        for format in formats {
            match format {
                Format::Csv => files::write(&folder.join("sweep.csv"), self.csv()?)?,
                Format::Json => {
                    let json = self.json(|run| Ok(json!({ "series": run.series })))?;
                    files::write_json(&folder.join("sweep.json"), &json)?;
                }
                Format::Npz => npz::write(&folder.join("sweep.npz"), self.arrays())?,
            }
        }
        let mut page = Document::new("casimir run", &self.scene.title);
        page.section("What was computed");
        let varied = self.sweep.varied.iter().map(|Varied { name, values }| {
            let values = values.iter().map(|value| digits(Some(*value))).collect::<Vec<_>>();
            (name.clone(), values.join(", "))
        });
        let noise = if same_noise { "the same" } else { "others" };
        let seed = self.scene.settings.key.seed;
        let facts = [
            ("runs".to_owned(), self.computed()),
            ("random numbers".into(), format!("seed {seed}, {noise} for each combination")),
            ("program".into(), format!("casimir {}", env!("CARGO_PKG_VERSION"))),
        ];
        page.facts(varied.chain(facts));
        self.warnings().iter().for_each(|warning| page.warning(warning));
        page.section("Against the parameters, and in time");
        page.figures(figures.into_iter().map(|(_, svg, caption)| (svg, caption)));
        page.section("At the end");
        let mut table = self.table().into_iter();
        page.table(table.next().unwrap_or_default(), table);
        page.section("The scene");
        page.verbatim(&self.scene.source.name, &self.scene.source.text);
        Ok(files::write(&folder.join("index.html"), page.html())?)
    }

    /// The rows of each combination after the values of its parameters.
    fn csv(&self) -> io::Result<Vec<u8>> {
        let names = self.sweep.varied.iter().map(|varied| quoted(&varied.name) + ",");
        let mut csv = (names.collect::<String>() + COLUMNS + "\n").into_bytes();
        for Run { one, series, .. } in &self.runs {
            let values = zip(&self.sweep.varied, &one.places);
            let values: String = values.map(|(of, &k)| format!("{},", of.values[k])).collect();
            write_rows(series, &values, &mut csv)?;
        }
        Ok(csv)
    }

    /// The values of each parameter, the times, and statistics as arrays over the parameters and
    /// times. What is not known is NaN.
    fn arrays(&self) -> Vec<npz::Array> {
        let varied = &self.sweep.varied;
        let axes: Vec<usize> = varied.iter().map(|varied| varied.values.len()).collect();
        let axis = |one: &Varied| (one.name.clone(), vec![one.values.len()], one.values.clone());
        let mut arrays: Vec<_> = varied.iter().map(axis).collect();
        let (times, until) = (self.scene.settings.times as usize, self.scene.settings.until);
        let time = |k: usize| until * k as f64 / times as f64;
        arrays.push(("t".into(), vec![times + 1], (0..=times).map(time).collect()));
        let place = |run: &Run<'_>| zip(&axes, &run.one.places).fold(0, |at, (n, k)| at * n + k);
        let runs: Vec<_> = self.runs.iter().map(|run| (place(run), &*run.series)).collect();
        arrays.extend(npz::statistics(&axes, &runs));
        arrays
    }
}
