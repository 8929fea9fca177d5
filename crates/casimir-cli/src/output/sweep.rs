//! What a sweep found: against its parameters, in time, and as arrays over both.

use std::{borrow::Cow, iter::zip, path::Path};

use casimir::{
    mc::study::{Series, Summary},
    plot::{
        Document,
        csv::field,
        figure::{Sampled, Title, against, multiples},
        files,
    },
};
use serde_json::{Value, json};

use super::{AT_END, aligned, digits, figures::file, npz, rows_at_end, summary};
use crate::{
    arguments::Format,
    commands::{Outcomes, Results},
    failure::Done,
    scene::{Combination, Scene, Varied},
};

/// Curves in one figure, and small multiples.
const MOST_CURVES: usize = 5;
const MOST_PANELS: usize = 24;
/// Lines of a table on a terminal, and warnings.
const MOST_LINES: usize = 48;
const MOST_WARNINGS: usize = 8;

/// The runs of a sweep that are here.
pub struct SweepReport<'a> {
    varied: &'a [Varied],
    all: usize,
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
            let values: Vec<f64> =
                columns.iter().filter_map(|values| values.get(k).copied()).collect();
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            Summary { time, count: values.len() as u64, mean: Some(mean), ..Summary::default() }
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

fn median(point: &Summary) -> Option<f64> {
    point.quantiles.iter().find(|quantile| quantile.level == 0.5)?.value
}

impl<'a> SweepReport<'a> {
    /// What is found of a sweep.
    pub fn new(outcomes: &'a Outcomes<'_>) -> Self {
        let combinations = &outcomes.sweep.combinations;
        let run = |(one, results): (&'a Combination, &'a Results)| Run {
            one,
            results,
            series: series(&one.scene, results),
        };
        Self {
            varied: &outcomes.sweep.varied,
            all: combinations.len(),
            scene: &combinations[0].scene,
            runs: outcomes.found().map(run).collect(),
        }
    }

    /// What is known of each combination.
    fn names(&self) -> impl Iterator<Item = &Series> {
        self.runs.first().into_iter().flat_map(|run| run.series.iter())
    }

    /// Figures with their files and captions: for each observable one against the parameter that
    /// has most values, and one in time.
    fn figures(&self) -> Vec<(String, String, String)> {
        let varied = self.varied.iter().enumerate().rev();
        let x = varied.max_by_key(|(_, varied)| varied.values.len()).map_or(0, |(x, _)| x);
        let parameter = &self.varied[x].name;
        let (number, of_paths) = (self.runs.len(), self.scene.settings.paths);
        let of = |(k, name): (usize, &str)| {
            let mut curves: Vec<(String, Vec<Sampled>)> = Vec::new();
            for Run { one, series, .. } in &self.runs {
                let last = series[k].last();
                let value = |k: usize| self.varied[k].values[one.places[k]];
                let others = (0..self.varied.len()).filter(|k| *k != x);
                let others =
                    others.map(|k| format!("{} = {}", self.varied[k].name, digits(Some(value(k)))));
                let others = others.collect::<Vec<_>>().join(", ");
                let point = (value(x), last.mean.unwrap_or(f64::NAN), last.mean_interval);
                match curves.iter_mut().find(|(of, _)| *of == others) {
                    Some((_, points)) => points.push(point),
                    None => curves.push((others, vec![point])),
                }
            }
            curves.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
            let all = curves.len();
            let curves = spread(curves, MOST_CURVES);
            let title = |words| Title { words, logarithmic: self.scene.drawn.is_logarithmic(words) };
            let words = format!("{name} against {parameter}");
            let svg = against(&words, title(parameter), title(name), &curves);
            let caption = format!(
                "The mean of {name} at the end on {of_paths} paths against {parameter}; bars: 95 % \
                 intervals. {} of {all} curves.",
                curves.len()
            );
            let panels =
                self.runs.iter().map(|run| (run.one.label.clone(), &run.series[k])).collect();
            let panels = spread(panels, MOST_PANELS);
            let in_time = format!(
                "{name} in time: bands between quantiles, line: median, dashes: mean. {} of {number} \
                 combinations.",
                panels.len()
            );
            [
                (file("against", name), svg, caption),
                (file("time", name), multiples(name, title(name), &panels), in_time),
            ]
        };
        let names = self.names().map(|series| &*series.observable);
        names.enumerate().flat_map(of).collect()
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
        let more = all.len().saturating_sub(MOST_WARNINGS);
        all.truncate(MOST_WARNINGS);
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
            self.all,
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
        let more =
            if more > 0 { format!("{more} more lines in the report\n") } else { String::new() };
        format!(
            "{}{}\n{}{more}report: {}\n",
            warnings.collect::<String>(),
            self.computed(),
            aligned(&table),
            folder.join("index.html").display()
        )
    }

    /// The parameters of a combination with their values.
    fn parameters(&self, one: &Combination) -> Value {
        let both = zip(self.varied, &one.places);
        both.map(|(varied, &place)| (varied.name.clone(), json!(varied.values[place]))).collect()
    }

    /// The results for programs.
    pub fn summary(&self, folder: &Path) -> serde_json::Result<Value> {
        let run = |Run { one, results, .. }: &Run<'_>| {
            let mut summary = summary(&one.scene, results, folder)?;
            summary["parameters"] = self.parameters(one);
            Ok(summary)
        };
        let varied = self.varied.iter().map(|varied| (varied.name.clone(), json!(varied.values)));
        Ok(json!({
            "title": self.scene.title,
            "sweep": varied.collect::<Value>(),
            "runs": self.runs.iter().map(run).collect::<serde_json::Result<Vec<_>>>()?,
        }))
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
                Format::Csv => files::write(&folder.join("sweep.csv"), self.csv())?,
                Format::Json => {
                    let run = |Run { one, results, .. }: &Run<'_>| {
                        let (study, paths) = (&results.study, &results.tables);
                        json!({ "parameters": self.parameters(one), "study": study, "paths": paths })
                    };
                    let runs: Vec<Value> = self.runs.iter().map(run).collect();
                    files::write(&folder.join("sweep.json"), serde_json::to_string(&runs)? + "\n")?;
                }
                Format::Npz => npz::write(&folder.join("sweep.npz"), self.arrays())?,
            }
        }
        let mut page = Document::new("casimir run", &self.scene.title);
        page.section("What was computed");
        let varied = self.varied.iter().map(|Varied { name, values }| {
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

    /// A line for each combination, observable and time.
    fn csv(&self) -> String {
        let known = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
        let names = self.varied.iter().map(|varied| field(&varied.name) + ",");
        let mut text = names.collect::<String>() + "observable,t,count";
        STATISTICS.iter().for_each(|(name, _)| text += &format!(",{name}"));
        for Run { one, series, .. } in &self.runs {
            let values = zip(self.varied, &one.places);
            let values: String =
                values.map(|(of, &place)| format!("{},", of.values[place])).collect();
            for Series { observable, points } in series.iter() {
                for point @ Summary { time, count, .. } in points {
                    text += &format!("\n{values}{},{time},{count}", field(observable));
                    STATISTICS.iter().for_each(|(_, of)| text += &format!(",{}", known(of(point))));
                }
            }
        }
        text + "\n"
    }

    /// The values of each parameter, the times, and statistics as arrays over the parameters and
    /// times. What is not known is NaN.
    fn arrays(&self) -> Vec<(String, Vec<usize>, Vec<f64>)> {
        let axes: Vec<usize> = self.varied.iter().map(|varied| varied.values.len()).collect();
        let axis = |one: &Varied| (one.name.clone(), vec![one.values.len()], one.values.clone());
        let mut arrays: Vec<_> = self.varied.iter().map(axis).collect();
        let (times, until) = (self.scene.settings.times as usize, self.scene.settings.until);
        let time = |k: usize| until * k as f64 / times as f64;
        arrays.push(("t".into(), vec![times + 1], (0..=times).map(time).collect()));
        for (k, Series { observable, .. }) in self.names().enumerate() {
            for (what, of) in STATISTICS {
                let mut values = vec![f64::NAN; self.all * (times + 1)];
                for Run { one, series, .. } in &self.runs {
                    let place =
                        zip(&axes, &one.places).fold(0, |place, (axis, k)| place * axis + k);
                    let row = values[place * (times + 1)..].iter_mut();
                    let known = series[k].points.iter().map(|point| of(point).unwrap_or(f64::NAN));
                    row.zip(known).for_each(|(value, known)| *value = known);
                }
                let shape = [&axes[..], &[times + 1]].concat();
                arrays.push((format!("{observable} {what}"), shape, values));
            }
        }
        arrays
    }
}

/// A statistic of a summary, if it is known.
type Statistic = fn(&Summary) -> Option<f64>;

/// What files have of each observable.
const STATISTICS: [(&str, Statistic); 5] = [
    ("mean", |point| point.mean),
    ("lo", |point| Some(point.mean_interval?.0)),
    ("hi", |point| Some(point.mean_interval?.1)),
    ("deviation", |point| point.deviation),
    ("median", median),
];
