//! Arrays for NumPy.

use std::{
    io::{self, Cursor, Write},
    mem,
};

use casimir::{
    mc::{Role, TimeSeries},
    study::{Histogram, Joint, STATISTICS, Series, StudyResult, Summary},
};
use scenes::Scene;
use zip::{CompressionMethod, DateTime, ZipWriter, write::SimpleFileOptions};

/// Name, shape, and numbers in row-major order.
pub type Array = (String, Vec<usize>, Vec<f64>);

/// An array of one axis.
pub fn list(name: impl Into<String>, values: Vec<f64>) -> Array {
    (name.into(), vec![values.len()], values)
}

/// The bytes of a file of arrays.
pub fn bytes(arrays: impl IntoIterator<Item = Array>) -> io::Result<Vec<u8>> {
    let mut out = ZipWriter::new(Cursor::new(Vec::new()));
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
    Ok(out.finish()?.into_inner())
}

/// Header before the numbers of an array, by version 1.0 of NumPy's format: a dictionary, with
/// blanks up to a multiple of 64 bytes. The libraries for it bring a parser of Python's literals,
/// which needs a compiler of C.
fn header(shape: &[usize]) -> Vec<u8> {
    let end = if shape.len() == 1 { ",)" } else { ")" };
    let shape = format!("{shape:?}").replace('[', "(").replace(']', end);
    let words = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let length = (10 + words.len() + 1).next_multiple_of(64) - 10;
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((length as u16).to_le_bytes());
    header.extend(format!("{words:<0$}\n", length - 1).bytes());
    header
}

/// The tables of paths, which are used up: `t`, and for each column an array [path, time]; spins on
/// a lattice are one array [path, time, spin, 3]. A path that ended early has NaN from there on.
pub fn paths(scene: &Scene, mut tables: Vec<TimeSeries>) -> impl Iterator<Item = Array> {
    let longest = tables.iter().max_by_key(|table| table.times().len());
    let columns = longest.map_or(&[][..], |table| &table.columns);
    let names: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let times = longest.map_or(&[][..], |table| table.times()).to_vec();
    let components = scene.components.len();
    let is = |role: Role| columns.iter().enumerate().filter(move |(_, column)| column.role == role);
    let time = is(Role::Time).next().map(|(k, _)| k);
    // All components are there, or some by name.
    let are_spins = !scene.sizes.is_empty() && is(Role::Component).count() == components;
    let first = is(Role::Component).next().map_or(0, |(k, _)| k);
    let spins = if are_spins { first..first + components } else { 0..0 };
    let vectors = are_spins.then(|| {
        let shape = vec![tables.len(), times.len(), components / 3, 3];
        let mut values = Vec::with_capacity(shape.iter().product());
        for table in &tables {
            for k in 0..times.len() {
                let columns = table.columns[spins.clone()].iter();
                values.extend(columns.map(|c| c.values.get(k).copied().unwrap_or(f64::NAN)));
            }
        }
        ("spins".to_owned(), shape, values)
    });
    let alone = names.into_iter().enumerate();
    let alone = alone.filter(move |(k, _)| !spins.contains(k) && time != Some(*k));
    let t = longest.map(|_| list("t", times.clone()));
    let array = move |(k, name): (usize, String)| {
        let mut values = Vec::with_capacity(tables.len() * times.len());
        for table in &mut tables {
            let mut column = mem::take(&mut table.columns[k].values);
            column.resize(times.len(), f64::NAN);
            values.extend(column);
        }
        (name, vec![tables.len(), times.len()], values)
    };
    t.into_iter().chain(alone.map(array)).chain(vectors)
}

/// Joint laws as arrays.
pub fn joint(result: &StudyResult) -> impl Iterator<Item = Array> {
    result.joint.iter().flat_map(|Joint { names: [a, b], grids, counts, .. }| {
        let name = format!("joint({a}, {b})");
        let [x, y] = grids.map(|grid| (0..=grid.bins).map(|k| grid.edge(k)).collect::<Vec<_>>());
        let values = counts.iter().map(|&count| count as f64).collect();
        let shape = vec![x.len() - 1, y.len() - 1];
        let sides = [list(format!("{name} x"), x), list(format!("{name} y"), y)];
        [(name, shape, values)].into_iter().chain(sides)
    })
}

/// Statistics of runs at places along axes, as arrays over the axes, times, and levels of
/// quantiles.
pub fn statistics(axes: &[usize], runs: &[(usize, &[Series])]) -> Vec<Array> {
    let [(_, first), ..] = runs else { return Vec::new() };
    let levels: Vec<f64> = first
        .iter()
        .map(|of| &of.last().quantiles)
        .find(|all| !all.is_empty())
        .into_iter()
        .flatten()
        .map(|one| one.level)
        .collect();
    let mut arrays = Vec::new();
    for (k, of) in first.iter().enumerate() {
        let times = runs.iter().map(|(_, series)| series[k].points.len()).max().unwrap_or(0);
        let mut add =
            |what: &str, width: &[usize], value: &dyn Fn(&Summary, usize) -> Option<f64>| {
                let (shape, each) = ([axes, &[times], width].concat(), width.iter().product());
                let mut values = vec![f64::NAN; shape.iter().product()];
                for (place, series) in runs {
                    let points = series[k].points.iter();
                    let known = points.flat_map(|point| (0..each).map(move |n| value(point, n)));
                    let row = values[place * times * each..].iter_mut().zip(known);
                    row.for_each(|(value, known)| *value = known.unwrap_or(f64::NAN));
                }
                arrays.push((format!("{} {what}", of.observable), shape, values));
            };
        for statistic in STATISTICS {
            add(statistic.key, &[], &|point, _| (statistic.of)(point));
            if let Some(interval) = statistic.interval {
                // Those of the mean have no other name.
                let of = if statistic.key == "mean" { "" } else { "variance " };
                add(&format!("{of}lo"), &[], &|point, _| Some(interval(point)?.0));
                add(&format!("{of}hi"), &[], &|point, _| Some(interval(point)?.1));
            }
        }
        add("median", &[], &|point, _| point.quantile(0.5)?.value);
        if !of.last().quantiles.is_empty() {
            add("quantiles", &[levels.len()], &|point, level| point.quantiles.get(level)?.value);
        }
        let at_end = runs.iter().map(|(place, of)| (place, of[k].last().histogram.as_ref()));
        let at_end: Vec<_> = at_end.filter_map(|(place, of)| Some((place, of?))).collect();
        let Some(bins) = at_end.iter().map(|(_, of)| of.counts.len()).max() else { continue };
        let mut add = |what, width: usize, value: &dyn Fn(&Histogram, usize) -> f64| {
            let shape = [axes, &[width]].concat();
            let mut values = vec![f64::NAN; shape.iter().product()];
            for (place, of) in &at_end {
                let row = values[*place * width..].iter_mut().take(width + of.counts.len() - bins);
                row.enumerate().for_each(|(n, number)| *number = value(of, n));
            }
            arrays.push((format!("{} {what}", first[k].observable), shape, values));
        };
        add("histogram", bins, &|of, n| of.counts[n] as f64);
        add("edges", bins + 1, &|of, n| of.grid.edge(n as u32));
    }
    if !levels.is_empty() {
        arrays.push(list("quantile levels", levels));
    }
    arrays
}

#[cfg(test)]
mod tests {
    use super::header;

    /// Headers are as NumPy 2.4 writes them.
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
