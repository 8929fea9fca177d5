//! Arrays for NumPy.

use std::{
    fs::File,
    io::{self, BufWriter, Write},
    path::Path,
};

use crate::scene::Scene;
use casimir::mc::{
    Column, TimeSeries,
    study::{Joint, Series, StudyResult, Summary},
};
use zip::{CompressionMethod, DateTime, ZipWriter, write::SimpleFileOptions};

type Statistic = fn(&Summary) -> Option<f64>;

/// What files have of each observable.
const STATISTICS: [(&str, Statistic); 5] = [
    ("mean", |point| point.mean),
    ("lo", |point| Some(point.mean_interval?.0)),
    ("hi", |point| Some(point.mean_interval?.1)),
    ("deviation", |point| point.deviation),
    ("median", |point| point.quantiles.iter().find(|quantile| quantile.level == 0.5)?.value),
];

/// Name, shape, and numbers in row-major order.
pub type Array = (String, Vec<usize>, Vec<f64>);

/// Writes arrays.
pub fn write(file: &Path, arrays: impl IntoIterator<Item = Array>) -> io::Result<()> {
    let mut out = ZipWriter::new(BufWriter::new(File::create(file)?));
    // Without the time of day: the same results are the same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default());
    for (name, shape, values) in arrays {
        out.start_file(format!("{name}.npy"), options)?;
        out.write_all(&header(&shape))?;
        for value in values {
            out.write_all(&value.to_le_bytes())?;
        }
    }
    out.finish()?;
    Ok(())
}

/// What stands before the numbers of an array, by version 1.0 of NumPy's format: a dictionary, with
/// blanks up to a multiple of 64 bytes. The libraries for it bring a parser of Python's literals,
/// which needs a compiler of C.
fn header(shape: &[usize]) -> Vec<u8> {
    let comma = if shape.len() == 1 { "," } else { "" };
    let shape = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ") + comma;
    let words = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({shape}), }}");
    let length = (10 + words.len() + 1).next_multiple_of(64) - 10;
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((length as u16).to_le_bytes());
    header.extend(format!("{words:<0$}\n", length - 1).bytes());
    header
}

/// The tables of paths: `t`, and for each column an array [path, time]; spins on a lattice are one
/// array [path, time, spin, 3]. A path that ended early has NaN from there on.
pub fn paths(file: &Path, scene: &Scene, tables: &[TimeSeries]) -> io::Result<()> {
    let longest = tables.iter().max_by_key(|table| table.times().len());
    let Some(longest) = longest else { return Ok(()) };
    let times = longest.times();
    let padded = |values: &[f64]| {
        let mut values = values.to_vec();
        values.resize(times.len(), f64::NAN);
        values
    };
    let array = |(k, column): (usize, &Column)| match &*column.name {
        "t" => ("t".into(), vec![times.len()], times.to_vec()),
        name => {
            let values = tables.iter().flat_map(|table| padded(&table.columns[k].values));
            (name.into(), vec![tables.len(), times.len()], values.collect())
        }
    };
    let components = &scene.components;
    let is_first = |column: &Column| column.name == components[0];
    let first = longest.columns.iter().position(is_first);
    // All components are there, or some by name.
    let are_spins = |first: &usize| {
        let columns = longest.columns[*first..].iter().map(|column| &column.name);
        !scene.sizes.is_empty() && columns.take(components.len()).eq(components)
    };
    let spins = first.filter(are_spins).map(|first| first..first + components.len());
    let vectors = spins.clone().map(|spins| {
        let of_path = |table: &TimeSeries| {
            let columns = &table.columns[spins.clone()];
            let time = |k: usize| {
                columns.iter().map(move |c| c.values.get(k).copied().unwrap_or(f64::NAN))
            };
            (0..times.len()).flat_map(time).collect::<Vec<_>>()
        };
        let values = tables.iter().flat_map(of_path).collect();
        ("spins".to_owned(), vec![tables.len(), times.len(), components.len() / 3, 3], values)
    });
    let columns = longest.columns.iter().enumerate();
    let alone = columns.filter(|(k, _)| !spins.as_ref().is_some_and(|spins| spins.contains(k)));
    write(file, alone.map(array).chain(vectors))
}

/// Statistics: `t`, `quantile levels`, and for each observable `<name> mean`, `<name> lo` and
/// `<name> hi` (the 95 % interval of the mean), `<name> deviation` and `<name> quantiles`, an array
/// [time, level]; autocorrelations and spectra likewise, with `lag` and `omega`; joint laws as
/// counts with the edges of their bins. What is not known is NaN.
pub fn study(file: &Path, result: &StudyResult) -> io::Result<()> {
    let Some(first) = result.series.first() else { return Ok(()) };
    let times: Vec<f64> = first.points.iter().map(|point| point.time).collect();
    let (count, levels) = (times.len(), &result.record.quantiles);
    let quantiles = result.series.iter().filter_map(|Series { observable, points }| {
        let quantiles = points.iter().flat_map(|point| &point.quantiles);
        let quantiles: Vec<f64> = quantiles.map(|one| one.value.unwrap_or(f64::NAN)).collect();
        let shape = vec![count, levels.len()];
        (quantiles.len() == count * levels.len())
            .then(|| (format!("{observable} quantiles"), shape, quantiles))
    });
    let level = ("quantile levels".into(), vec![levels.len()], levels.clone());
    let axes = ["lag", "omega"].into_iter().zip(&result.lagged).map(|(name, series)| {
        let places: Vec<f64> = series.points.iter().map(|point| point.time).collect();
        (name.into(), vec![places.len()], places)
    });
    let joint = result.joint.iter().flat_map(|Joint { names: [a, b], grids, counts, .. }| {
        let name = format!("joint({a}, {b})");
        let [x, y] = grids.map(|grid| (0..=grid.bins).map(|k| grid.edge(k)).collect::<Vec<_>>());
        let values = counts.iter().map(|&count| count as f64).collect();
        let sides = [("x", &x), ("y", &y)]
            .map(|(side, edges)| (format!("{name} {side}"), vec![edges.len()], edges.clone()));
        [(name, vec![x.len() - 1, y.len() - 1], values)].into_iter().chain(sides)
    });
    let all = [("t".into(), vec![count], times), level].into_iter().chain(axes);
    let series = [&result.series, &result.lagged].map(|series| statistics(&[], &[(0, series)]));
    write(file, all.chain(series.concat()).chain(quantiles).chain(joint))
}

/// Statistics of runs at places along axes, as arrays over the axes and times.
pub fn statistics(axes: &[usize], runs: &[(usize, &[Series])]) -> Vec<Array> {
    let names = runs.first().into_iter().flat_map(|(_, series)| series.iter().enumerate());
    let array = |(k, of): (usize, &Series)| {
        let times = runs.iter().map(|(_, series)| series[k].points.len()).max().unwrap_or(0);
        STATISTICS.map(|(what, value)| {
            let mut values = vec![f64::NAN; axes.iter().product::<usize>() * times];
            for (place, series) in runs {
                let known = series[k].points.iter().map(|point| value(point).unwrap_or(f64::NAN));
                let row = values[place * times..].iter_mut();
                row.zip(known).for_each(|(value, known)| *value = known);
            }
            (format!("{} {what}", of.observable), [axes, &[times]].concat(), values)
        })
    };
    names.flat_map(array).collect()
}

#[cfg(test)]
mod tests {
    use super::header;

    /// As NumPy 2.4 writes them.
    #[test]
    fn headers_are_those_of_numpy() {
        for (shape, words) in [
            (&[3, 4][..], "{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }"),
            (&[41], "{'descr': '<f8', 'fortran_order': False, 'shape': (41,), }"),
        ] {
            let expected = format!("{words:<117}\n");
            assert_eq!(header(shape), [b"\x93NUMPY\x01\x00v\x00", expected.as_bytes()].concat());
        }
    }
}
