//! What a sweep found: against its parameters, in time, and as arrays over both.

use std::{collections::BTreeMap, io, iter::zip};

use super::{npz::list, page::TABLE, *};
use casimir::{
    figures::law,
    mc::quoted,
    plot::figure::{Sampled, against, multiples},
    study::{COLUMNS, write_rows},
};
use scenes::{Settings, Varied};

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
        let mut others: Vec<&Varied> = self.sweep.varied.iter().collect();
        let most = (0..others.len()).rev().max_by_key(|&k| others[k].values.len());
        let Some(x) = most else { return Vec::new() };
        let Varied { name: parameter, values, .. } = others.remove(x);
        let (drawn, mut figures) = (&self.sweep.scene().drawn, Vec::new());
        for (k, Series { observable: name, .. }) in
            self.found().next().into_iter().flat_map(|(_, found)| found.series()).enumerate()
        {
            if drawn.show.as_ref().is_some_and(|show| !show.contains(name)) {
                continue;
            }
            // By the places of the other parameters.
            let mut curves = BTreeMap::<Vec<usize>, Vec<Sampled>>::new();
            for (one, results) in self.found() {
                let (mut places, last) = (one.places.clone(), results.series()[k].last());
                let (value, mean) = (values[places.remove(x)], last.mean.unwrap_or(f64::NAN));
                curves.entry(places).or_default().push((value, mean, last.mean_interval));
            }
            let curves = curves.into_iter().map(|(places, mut points)| {
                points.sort_by(|a, b| a.0.total_cmp(&b.0));
                (
                    zip(&others, places)
                        .map(|(varied, place)| varied.words(place))
                        .collect::<Vec<_>>()
                        .join(", "),
                    points,
                )
            });
            let svg = against(
                &format!("{name} against {parameter}"),
                drawn.title(parameter),
                drawn.title(name),
                &spread(curves.collect(), MAX_CURVES),
            );
            figures.push(Figure::of(
                "against",
                name,
                svg,
                format!("{name} at the end against {parameter}: mean, 95 % intervals."),
            ));
            let laws = self
                .found()
                .map(|(one, found)| (one.label.clone(), law(&found.series()[k].points)));
            let panels = spread(laws.collect(), MAX_PANELS);
            let caption = format!(
                "{name} in time: bands between quantiles, line: median, dashes: mean. {} of {} \
                 combinations.",
                panels.len(),
                self.found().count()
            );
            figures.push(Figure::of(
                "time",
                name,
                multiples(name, drawn.title(name), &panels),
                caption,
            ));
        }
        vec![("Against the parameters, and in time", figures), (TABLE, vec![])]
    }

    /// The parameters of a combination with their values.
    fn values(&self, one: &Combination) -> impl Iterator<Item = (&Varied, f64)> {
        zip(&self.sweep.varied, &one.places).map(|(varied, &place)| (varied, varied.values[place]))
    }

    /// The results for programs: `of` each combination.
    pub(super) fn of_each(&self, of: impl Fn(Run<'_>) -> Value) -> Value {
        let varied = self.sweep.varied.iter();
        let varied = varied.map(|varied| (varied.name.clone(), json!(varied.values)));
        let runs = self.found().map(|run| {
            let mut found = of(run);
            let values = self.values(run.0);
            found["parameters"] = values.map(|(varied, x)| (varied.name.clone(), x)).collect();
            found
        });
        json!({
            "title": self.sweep.scene().title,
            "sweep": varied.collect::<Value>(),
            "runs": runs.collect::<Value>(),
        })
    }

    /// The rows of each combination after the values of its parameters.
    pub(super) fn csv(&self, of: OfRun) -> io::Result<Vec<u8>> {
        let mut csv =
            (self.sweep.varied.iter().map(|varied| quoted(&varied.name) + ",").collect::<String>()
                + COLUMNS
                + "\n")
                .into_bytes();
        for (one, found) in self.found() {
            let values: String = self.values(one).map(|(_, value)| format!("{value},")).collect();
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
        arrays.push(list(
            "t",
            (0..=times).map(|k| (k * (steps / times)) as f64 * (until / steps as f64)).collect(),
        ));
        let of = |of: OfRun| -> Vec<_> {
            self.found()
                .map(|(one, found)| {
                    (zip(&axes, &one.places).fold(0, |at, (n, k)| at * n + k), of(found))
                })
                .collect()
        };
        let mut lagged = of(Results::lagged);
        // None where a part has not come so far.
        if lagged.iter().any(|(_, all)| all.is_empty()) {
            lagged.clear();
        }
        // All autocorrelations have the same lags, all spectra the same frequencies.
        for series in lagged.iter().flat_map(|(_, all)| *all).take(2) {
            arrays.push(list(
                series.kind.axis(),
                series.points.iter().map(|point| point.time).collect(),
            ));
        }
        arrays.extend(npz::statistics(&axes, &of(Results::series)));
        arrays.extend(npz::statistics(&axes, &lagged));
        arrays.extend(single.flatten().into_iter().flat_map(npz::joint));
        arrays
    }
}
