//! What a sweep found: against its parameters, in time, and as arrays over both.

use std::{collections::BTreeMap, io, iter::zip};

use casimir::{
    figures::law,
    mc::quoted,
    plot::figure::{Sampled, against, multiples},
    study::{COLUMNS, Series, write_rows},
};
use serde_json::{Value, json};

use super::{
    Figure, Run, Section,
    npz::{self, list},
    page::TABLE,
};
use crate::{Outcomes, Results};
use scenes::{Combination, Settings, Varied};

/// Series of a run.
type OfRun = fn(&Results) -> &[Series];

/// Curves in one figure, and small multiples.
const MAX_CURVES: usize = 5;
const MAX_PANELS: usize = 24;

/// `number` of many, evenly spaced.
fn spread<T>(all: Vec<T>, number: usize) -> Vec<T> {
    let many = all.len();
    let kept = |k: usize| many <= number || k * number / many != (k + 1) * number / many;
    all.into_iter().enumerate().filter(|(k, _)| kept(*k)).map(|(_, one)| one).collect()
}

impl Outcomes<'_> {
    /// Figures with their files and captions: for each observable one against the parameter that
    /// has most values, and one in time.
    pub(super) fn of_sweep(&self) -> Vec<Section> {
        let varied = self.sweep.varied.iter().enumerate().rev();
        let most = varied.max_by_key(|(_, varied)| varied.values.len());
        let Some((x, Varied { name: parameter, values, .. })) = most else { return Vec::new() };
        let others = self.sweep.varied.iter().enumerate().filter(|(k, _)| *k != x);
        let others: Vec<&Varied> = others.map(|(_, varied)| varied).collect();
        let drawn = &self.sweep.scene().drawn;
        let of = |(k, Series { observable: name, .. }): (usize, &Series)| {
            // By the places of the other parameters.
            let mut curves = BTreeMap::<Vec<usize>, Vec<Sampled>>::new();
            for (one, results) in self.found() {
                let (mut places, last) = (one.places.clone(), results.series()[k].last());
                let (value, mean) = (values[places.remove(x)], last.mean.unwrap_or(f64::NAN));
                curves.entry(places).or_default().push((value, mean, last.mean_interval));
            }
            let curve = |(places, mut points): (Vec<usize>, Vec<Sampled>)| {
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                let words = zip(&others, places).map(|(varied, place)| varied.words(place));
                (words.collect::<Vec<_>>().join(", "), points)
            };
            let curves = spread(curves.into_iter().map(curve).collect(), MAX_CURVES);
            let words = format!("{name} against {parameter}");
            let svg = against(&words, drawn.title(parameter), drawn.title(name), &curves);
            let caption = format!("{name} at the end against {parameter}: mean, 95 % intervals.");
            let against = Figure::of("against", name, svg, caption);
            let panels = self
                .found()
                .map(|(one, found)| (one.label.clone(), law(&found.series()[k].points)));
            let panels = spread(panels.collect(), MAX_PANELS);
            let caption = format!(
                "{name} in time: bands between quantiles, line: median, dashes: mean. {} of {} \
                 combinations.",
                panels.len(),
                self.found().count()
            );
            let svg = multiples(name, drawn.title(name), &panels);
            [against, Figure::of("time", name, svg, caption)]
        };
        let first = self.found().next().into_iter().flat_map(|(_, found)| found.series());
        let is_shown = |name| drawn.show.as_ref().is_none_or(|show| show.contains(name));
        let shown = first.enumerate().filter(|(_, series)| is_shown(&series.observable));
        vec![("Against the parameters, and in time", shown.flat_map(of).collect()), (TABLE, vec![])]
    }

    /// The results for programs: `of` each combination.
    pub(super) fn of_each(&self, of: impl Fn(Run<'_>) -> Value) -> Value {
        let run = |run: Run<'_>| {
            let both = zip(&self.sweep.varied, &run.0.places);
            let both = both.map(|(varied, &k)| (varied.name.clone(), json!(varied.values[k])));
            let mut found = of(run);
            found["parameters"] = both.collect();
            found
        };
        let varied = self.sweep.varied.iter();
        let varied = varied.map(|varied| (varied.name.clone(), json!(varied.values)));
        json!({
            "title": self.sweep.scene().title,
            "sweep": varied.collect::<Value>(),
            "runs": self.found().map(run).collect::<Value>(),
        })
    }

    /// The rows of each combination after the values of its parameters.
    pub(super) fn csv(&self, of: OfRun) -> io::Result<Vec<u8>> {
        let names = self.sweep.varied.iter().map(|varied| quoted(&varied.name) + ",");
        let mut csv = (names.collect::<String>() + COLUMNS + "\n").into_bytes();
        for (one, found) in self.found() {
            let values = zip(&self.sweep.varied, &one.places);
            let values: String = values.map(|(of, &k)| format!("{},", of.values[k])).collect();
            write_rows(of(found), &values, &mut csv)?;
        }
        Ok(csv)
    }

    /// Statistics as arrays: the values of each parameter; `t`; `quantile levels`; and for each
    /// observable `<name> mean`, `<name> lo` and `<name> hi` (the 95 % interval of the mean), the
    /// other [`STATISTICS`](casimir::study::STATISTICS), `<name> median` and `<name> quantiles`,
    /// over the parameters, times and levels.
    /// Autocorrelations and spectra likewise, with `lag` and `omega`; joint laws of a run alone as
    /// counts with the edges of their bins. What is not known is NaN; none of a few paths alone.
    pub(super) fn arrays(&self) -> Vec<npz::Array> {
        let single = self.single().map(|(_, found)| found.study.as_ref());
        if let Some(None) = single {
            return Vec::new();
        }
        let varied = &self.sweep.varied;
        let axes: Vec<usize> = varied.iter().map(|varied| varied.values.len()).collect();
        let mut arrays: Vec<_> =
            varied.iter().map(|one| list(&*one.name, one.values.clone())).collect();
        let Settings { times, steps, until, .. } = self.sweep.scene().settings;
        // To the bit those of a run.
        let time = |k| (k * (steps / times)) as f64 * (until / steps as f64);
        arrays.push(list("t", (0..=times).map(time).collect()));
        let place = |one: &Combination| zip(&axes, &one.places).fold(0, |at, (n, k)| at * n + k);
        let of = |of: OfRun| -> Vec<_> {
            self.found().map(|(one, found)| (place(one), of(found))).collect()
        };
        // None where a part has not come so far.
        let lagged = of(Results::lagged);
        let lagged = if lagged.iter().all(|(_, all)| !all.is_empty()) { lagged } else { vec![] };
        // All autocorrelations have the same lags, all spectra the same frequencies.
        for series in lagged.iter().flat_map(|(_, all)| *all).take(2) {
            let at = series.points.iter().map(|point| point.time).collect();
            arrays.push(list(series.kind.axis(), at));
        }
        arrays.extend(npz::statistics(&axes, &of(Results::series)));
        arrays.extend(npz::statistics(&axes, &lagged));
        arrays.extend(single.flatten().into_iter().flat_map(npz::joint));
        arrays
    }
}
