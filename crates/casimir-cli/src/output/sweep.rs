//! What a sweep found: against its parameters, in time, and as arrays over both.

use std::{iter::zip, path::Path};

use casimir::{
    mc::study::{Series, Summary},
    plot::{
        Document,
        csv::field,
        figure::{Sampled, Trace, against, lines, multiples},
        files,
    },
};
use serde_json::{Value, json};

use super::{AT_END, aligned, digits, figures::file, npz, rows_at_end, summary};
use crate::{
    arguments::Format,
    commands::{Outcomes, Results},
    failure::Done,
    scene::{Combination, Varied},
};

/// Curves in one figure, and small multiples.
const MOST_CURVES: usize = 5;
const MOST_PANELS: usize = 24;
/// Lines of a table on a terminal, and warnings.
const MOST_LINES: usize = 48;
const MOST_WARNINGS: usize = 8;

/// What was found at one combination.
type Found<'a> = (&'a Combination, &'a Results);

/// The mean of an observable at the final time with its interval; of a few paths the value of the
/// first.
fn at_end(results: &Results, name: &str) -> Option<(f64, Option<(f64, f64)>)> {
    let Some(study) = &results.study else {
        return Some((*results.tables.first()?.column(name)?.last()?, None));
    };
    let series = study.series.iter().find(|series| series.observable == name)?;
    Some((series.last().mean?, series.last().mean_interval))
}

fn series<'a>(results: &'a Results, name: &str) -> Option<&'a Series> {
    results.study.as_ref()?.series.iter().find(|series| series.observable == name)
}

/// The names of the observables.
fn names(outcomes: &Outcomes<'_>) -> Vec<String> {
    let scene = &outcomes.sweep.combinations[0].scene;
    scene.observables.iter().map(|observable| observable.name.clone()).collect()
}

/// The values of what is varied but for one, in words.
fn others(varied: &[Varied], places: &[usize], but: usize) -> String {
    let words = zip(varied, places).enumerate().filter(|(k, _)| *k != but).map(
        |(_, (Varied { name, values }, &place))| {
            format!("{name} = {}", digits(Some(values[place])))
        },
    );
    words.collect::<Vec<_>>().join(", ")
}

/// `number` of many, evenly spaced.
fn spread<T>(mut all: Vec<T>, number: usize) -> Vec<T> {
    let many = all.len();
    let kept = |k: usize| (k * number) / many != ((k + 1) * number) / many;
    if many > number {
        let mut k = 0;
        all.retain(|_| (kept(k), k += 1).0);
    }
    all
}

/// Figures with their files and captions: one against the parameter that has most values, and one
/// in time, for each observable.
fn figures(outcomes: &Outcomes<'_>) -> Vec<(String, String, String)> {
    let varied = &outcomes.sweep.varied;
    let Some(x) = (0..varied.len()).rev().max_by_key(|&k| varied[k].values.len()) else {
        return Vec::new();
    };
    let parameter = &varied[x].name;
    let of = |name: &String| {
        let mut curves: Vec<(String, Vec<Sampled>)> = Vec::new();
        for (Combination { places, .. }, results) in outcomes.found() {
            let Some((value, interval)) = at_end(results, name) else { continue };
            let (words, point) =
                (others(varied, places, x), (varied[x].values[places[x]], value, interval));
            match curves.iter_mut().find(|(of, _)| *of == words) {
                Some((_, points)) => points.push(point),
                None => curves.push((words, vec![point])),
            }
        }
        curves.iter_mut().for_each(|(_, points)| points.sort_by(|a, b| a.0.total_cmp(&b.0)));
        let all = curves.len();
        let curves = spread(curves, MOST_CURVES);
        let of_all = if all > curves.len() {
            format!(" {} of {all} curves.", curves.len())
        } else {
            String::new()
        };
        let is_study = outcomes.found().any(|(_, results)| results.study.is_some());
        let what = match is_study {
            true => format!("The mean of {name} at the end, with 95 % intervals"),
            false => format!("{name} at the end of path 0"),
        };
        let caption = format!("{what}, against {parameter}.{of_all}");
        let svg = against(&format!("{name} against {parameter}"), parameter, name, &curves);
        let first = (file("against", name), svg, caption);
        let found: Vec<Found<'_>> = spread(outcomes.found().collect(), MOST_PANELS);
        let shown = found.len();
        let panels = found
            .iter()
            .filter_map(|(one, results)| Some((one.label.clone(), series(results, name)?)));
        let panels: Vec<_> = panels.collect();
        let number = outcomes.found().count();
        let (svg, how) = match is_study {
            true => {
                (multiples(name, &panels), "bands between quantiles, median, and mean in dashes")
            }
            false => {
                let trace = |(one, results): &Found<'_>| {
                    let table = results.tables.first()?;
                    let values = table.column(name)?.iter().copied();
                    Some(Trace {
                        name: one.label.clone(),
                        points: zip(table.times().iter().copied(), values).collect(),
                    })
                };
                let traces: Vec<Trace> =
                    spread(found, MOST_CURVES).iter().filter_map(trace).collect();
                (lines(name, "time t", name, &traces), "path 0")
            }
        };
        let caption = format!("{name} in time, {shown} of {number} combinations: {how}.");
        [first, (file("time", name), svg, caption)]
    };
    names(outcomes).iter().flat_map(of).collect()
}

/// The table at the end: the combination, and the columns of a run.
fn rows(outcomes: &Outcomes<'_>) -> Vec<Vec<String>> {
    let of = |(one, results): Found<'_>| -> Vec<Vec<String>> {
        let with = |cells: Vec<String>| [vec![one.label.clone()], cells].concat();
        match &results.study {
            Some(study) => {
                let rows = rows_at_end(study, results.check.as_ref());
                rows.into_iter().map(|row| with(row.to_vec())).collect()
            }
            None => one
                .scene
                .observables
                .iter()
                .filter_map(|observable| {
                    let (value, _) = at_end(results, &observable.name)?;
                    Some(with(vec![observable.name.clone(), digits(Some(value))]))
                })
                .collect(),
        }
    };
    outcomes.found().flat_map(of).collect()
}

fn header(outcomes: &Outcomes<'_>) -> Vec<String> {
    let is_study = outcomes.found().any(|(_, results)| results.study.is_some());
    let columns = if is_study { AT_END.to_vec() } else { vec![AT_END[0], "path 0"] };
    [vec![""], columns].concat().into_iter().map(String::from).collect()
}

/// Warnings with the combinations that they are about.
fn warnings(outcomes: &Outcomes<'_>) -> Vec<String> {
    let of = |(one, results): Found<'_>| {
        let warnings = results.warnings(&one.scene).into_iter();
        warnings.map(|warning| format!("{}: {warning}", one.label)).collect::<Vec<_>>()
    };
    let mut all: Vec<String> = outcomes.found().flat_map(of).collect();
    let more = all.len().saturating_sub(MOST_WARNINGS);
    all.truncate(MOST_WARNINGS);
    all.extend((more > 0).then(|| format!("{more} more of the kind")));
    all
}

/// What was computed, in a line.
fn computed(outcomes: &Outcomes<'_>) -> String {
    let number = outcomes.found().count();
    let all = outcomes.sweep.combinations.len();
    let of_all = if number < all { format!(" of {all}") } else { String::new() };
    let settings = &outcomes.sweep.combinations[0].scene.settings;
    let mut schemes: Vec<&str> = outcomes.found().map(|(_, results)| &*results.scheme).collect();
    schemes.dedup();
    let seconds: f64 = outcomes.found().map(|(_, results)| results.seconds).sum();
    format!(
        "{number}{of_all} combinations of {} paths, {} steps of {}, {seconds:.2} s",
        settings.paths,
        settings.steps,
        schemes.join(", ")
    )
}

/// The results in words.
pub fn sweep_text(outcomes: &Outcomes<'_>, folder: &Path) -> String {
    let warnings = warnings(outcomes).into_iter().map(|warning| format!("warning: {warning}\n"));
    let mut table = rows(outcomes);
    let more = table.len().saturating_sub(MOST_LINES);
    table.truncate(MOST_LINES);
    table.insert(0, header(outcomes));
    let more = if more > 0 { format!("{more} more lines in the report\n") } else { String::new() };
    format!(
        "{}{}\n{}{more}report: {}\n",
        warnings.collect::<String>(),
        computed(outcomes),
        aligned(&table),
        folder.join("index.html").display()
    )
}

/// The parameters of a combination with their values.
fn parameters(outcomes: &Outcomes<'_>, one: &Combination) -> Value {
    let both = zip(&outcomes.sweep.varied, &one.places);
    both.map(|(varied, &place)| (varied.name.clone(), json!(varied.values[place]))).collect()
}

/// The results for programs.
pub fn sweep_summary(outcomes: &Outcomes<'_>, folder: &Path) -> serde_json::Result<Value> {
    let run = |(one, results): Found<'_>| {
        let mut summary = summary(&one.scene, results, folder)?;
        summary["parameters"] = parameters(outcomes, one);
        Ok(summary)
    };
    let varied =
        outcomes.sweep.varied.iter().map(|varied| (varied.name.clone(), json!(varied.values)));
    Ok(json!({
        "title": outcomes.sweep.combinations[0].scene.title,
        "sweep": varied.collect::<Value>(),
        "runs": outcomes.found().map(run).collect::<serde_json::Result<Vec<_>>>()?,
    }))
}

/// Writes the report with its figures, and what else is asked for.
pub fn write_sweep(outcomes: &Outcomes<'_>, folder: &Path, formats: &[Format]) -> Done {
    let (figures, drawings) = (figures(outcomes), folder.join("figures"));
    files::prepare(&drawings)?;
    for (file, svg, _) in &figures {
        files::write(&drawings.join(format!("{file}.svg")), svg)?;
    }
    for format in formats {
        match format {
            Format::Csv => files::write(&folder.join("sweep.csv"), csv(outcomes))?,
            Format::Json => {
                let run = |(one, results): Found<'_>| {
                    json!({
                        "parameters": parameters(outcomes, one),
                        "study": results.study,
                        "paths": results.tables,
                    })
                };
                let runs: Vec<Value> = outcomes.found().map(run).collect();
                files::write(&folder.join("sweep.json"), serde_json::to_string(&runs)? + "\n")?;
            }
            Format::Npz => npz::write(&folder.join("sweep.npz"), arrays(outcomes))?,
        }
    }
    let scene = &outcomes.sweep.combinations[0].scene;
    let mut page = Document::new("casimir run", &scene.title);
    page.section("What was computed");
    let varied = outcomes.sweep.varied.iter();
    let varied = varied.map(|Varied { name, values }| {
        let values = values.iter().map(|value| digits(Some(*value))).collect::<Vec<_>>();
        (name.clone(), values.join(", "))
    });
    let noise = match outcomes.sweep.combinations[1].scene.settings.key == scene.settings.key {
        true => "the same for all combinations",
        false => "independent for each combination",
    };
    let facts = [
        ("runs".to_owned(), computed(outcomes)),
        ("random numbers".into(), format!("seed {}, {noise}", scene.settings.key.seed)),
        ("program".into(), format!("casimir {}", env!("CARGO_PKG_VERSION"))),
    ];
    page.facts(varied.chain(facts));
    warnings(outcomes).iter().for_each(|warning| page.warning(warning));
    page.section("Against the parameters, and in time");
    page.figures(figures.into_iter().map(|(_, svg, caption)| (svg, caption)));
    page.section("At the end");
    page.table(header(outcomes), rows(outcomes));
    page.section("The scene");
    page.verbatim(&scene.source.name, &scene.source.text);
    Ok(files::write(&folder.join("index.html"), page.html())?)
}

/// A line for each combination, observable and time; of a few paths for each path.
fn csv(outcomes: &Outcomes<'_>) -> String {
    let columns = outcomes.sweep.varied.iter().map(|varied| field(&varied.name));
    let is_study = outcomes.found().any(|(_, results)| results.study.is_some());
    let known = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    let (last, mut text) = match is_study {
        true => ("observable,t,count,mean,lo,hi,deviation,median", String::new()),
        false => ("observable,path,t,value", String::new()),
    };
    text += &columns.chain([last.into()]).collect::<Vec<_>>().join(",");
    text += "\n";
    for (one, results) in outcomes.found() {
        let values = zip(&outcomes.sweep.varied, &one.places);
        let values: String = values.map(|(varied, &k)| format!("{},", varied.values[k])).collect();
        for Series { observable, points } in results.study.iter().flat_map(|study| &study.series) {
            for point in points {
                let (lo, hi) = point.mean_interval.unzip();
                let median = point.quantiles.iter().find(|quantile| quantile.level == 0.5);
                let numbers = [point.mean, lo, hi, point.deviation, median.and_then(|m| m.value)];
                let numbers = numbers.map(known).join(",");
                let (name, Summary { time, count, .. }) = (field(observable), point);
                text += &format!("{values}{name},{time},{count},{numbers}\n");
            }
        }
        let tables = results.tables.iter().enumerate().filter(|_| !is_study);
        for (path, table) in tables {
            for column in table.columns.iter().filter(|column| column.name != "t") {
                for (t, value) in zip(table.times(), &column.values) {
                    text += &format!("{values}{},{path},{t},{value}\n", field(&column.name));
                }
            }
        }
    }
    text
}

/// An array with its name and shape.
type Array = (String, Vec<usize>, Vec<f64>);

/// The values of each parameter; and arrays over the parameters: for studies means, their
/// intervals, deviations and medians at each time, else the columns of each path. What is not known
/// is NaN.
fn arrays(outcomes: &Outcomes<'_>) -> Vec<Array> {
    let varied = &outcomes.sweep.varied;
    let axes: Vec<usize> = varied.iter().map(|varied| varied.values.len()).collect();
    let mut arrays: Vec<Array> = varied
        .iter()
        .map(|one| (one.name.clone(), vec![one.values.len()], one.values.clone()))
        .collect();
    let scene = &outcomes.sweep.combinations[0].scene;
    let saved = scene.settings.times as usize + 1;
    let times = |k: usize| scene.settings.until * k as f64 / scene.settings.times as f64;
    arrays.push(("t".into(), vec![saved], (0..saved).map(times).collect()));
    // The numbers of all combinations, one after the other.
    let mut add = |name: String, inner: &[usize], of: &dyn Fn(&Results) -> Option<Vec<f64>>| {
        let length = inner.iter().product();
        let mut values = Vec::new();
        for results in &outcomes.results {
            let mut numbers = results.as_ref().and_then(of).unwrap_or_default();
            numbers.resize(length, f64::NAN);
            values.append(&mut numbers);
        }
        arrays.push((name, [&axes, inner].concat(), values));
    };
    type Statistic = fn(&Summary) -> Option<f64>;
    let statistics: [(&str, Statistic); 5] = [
        ("mean", |point| point.mean),
        ("lo", |point| Some(point.mean_interval?.0)),
        ("hi", |point| Some(point.mean_interval?.1)),
        ("deviation", |point| point.deviation),
        ("median", |point| point.quantiles.iter().find(|found| found.level == 0.5)?.value),
    ];
    let is_study = scene.settings.is_study();
    for name in names(outcomes) {
        if is_study {
            for (what, of) in statistics {
                let numbers = |point: &Summary| of(point).unwrap_or(f64::NAN);
                let of = |results: &Results| {
                    Some(series(results, &name)?.points.iter().map(numbers).collect())
                };
                add(format!("{name} {what}"), &[saved], &of);
            }
        } else {
            let of = |results: &Results| {
                let padded = |table: &casimir::mc::TimeSeries| {
                    let mut values = table.column(&name).unwrap_or_default().to_vec();
                    values.resize(saved, f64::NAN);
                    values
                };
                Some(results.tables.iter().flat_map(padded).collect())
            };
            add(name.clone(), &[scene.settings.paths as usize, saved], &of);
        }
    }
    arrays
}
