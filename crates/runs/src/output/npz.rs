//! Arrays for NumPy.

use std::{
    io::{self, Cursor, Write},
    mem,
};

use casimir::{
    mc::{Column, Role, TimeSeries},
    study::{Grid, Histogram, Joint, STATISTICS, Series, StudyResult, Summary},
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
    let shape = format!("{shape:?}")
        .replace('[', "(")
        .replace(']', if shape.len() == 1 { ",)" } else { ")" });
    let words = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}");
    let length = (10 + words.len() + 1).next_multiple_of(64) - 10;
    let mut header = b"\x93NUMPY\x01\x00".to_vec();
    header.extend((length as u16).to_le_bytes());
    header.extend(format!("{words:<0$}\n", length - 1).bytes());
    header
}

/// The tables of paths, which are used up: `t`, and for each column an array [path, time]; spins on
/// a lattice are one array [path, time, spin, 3]. A path that ended early has NaN from there on.
pub fn paths(scene: &Scene, mut tables: Vec<TimeSeries>) -> Vec<Array> {
    let Some(times) =
        tables.iter().map(TimeSeries::times).max_by_key(|times| times.len()).map(<[f64]>::to_vec)
    else {
        return Vec::new();
    };
    let (paths, length) = (tables.len(), times.len());
    let mut arrays = vec![list("t", times)];
    let components: Vec<usize> = tables[0]
        .columns
        .iter()
        .enumerate()
        .filter(|(_, column)| column.role == Role::Component)
        .map(|(k, _)| k)
        .collect();
    // All components are there, or some by name.
    let are_spins = !scene.sizes.is_empty() && components.len() == scene.components.len();
    let spins = are_spins.then(|| {
        let shape = vec![paths, length, components.len() / 3, 3];
        let mut values = Vec::with_capacity(shape.iter().product());
        for (table, k) in tables.iter().flat_map(|table| (0..length).map(move |k| (table, k))) {
            let of = |&component: &usize| table.columns[component].values.get(k).copied();
            values.extend(components.iter().map(|component| of(component).unwrap_or(f64::NAN)));
        }
        ("spins".to_owned(), shape, values)
    });
    for k in 0..tables[0].columns.len() {
        let Column { name, role, .. } = &tables[0].columns[k];
        if *role == Role::Time || are_spins && *role == Role::Component {
            continue;
        }
        let (name, mut values) = (name.clone(), Vec::with_capacity(paths * length));
        for table in &mut tables {
            let mut column = mem::take(&mut table.columns[k].values);
            column.resize(length, f64::NAN);
            values.extend(column);
        }
        arrays.push((name, vec![paths, length], values));
    }
    arrays.extend(spins);
    arrays
}

/// The edges of the bins of a grid.
fn edges(grid: &Grid) -> Vec<f64> {
    (0..=grid.bins).map(|k| grid.edge(k)).collect()
}

/// Joint laws as arrays.
pub fn joint(result: &StudyResult) -> impl Iterator<Item = Array> {
    result.joint.iter().flat_map(|Joint { names: [a, b], grids, counts, .. }| {
        let name = format!("joint({a}, {b})");
        let [x, y] = grids.map(|grid| edges(&grid));
        let shape = vec![x.len() - 1, y.len() - 1];
        let sides = [list(format!("{name} x"), x), list(format!("{name} y"), y)];
        [(name, shape, counts.iter().map(|&count| count as f64).collect())].into_iter().chain(sides)
    })
}

/// Statistics of runs at places along axes, as arrays over the axes, times, and levels of
/// quantiles.
pub fn statistics(axes: &[usize], runs: &[(usize, &[Series])]) -> Vec<Array> {
    let [(_, first), ..] = runs else { return Vec::new() };
    let quantiles = first.iter().map(|of| &of.last().quantiles).find(|all| !all.is_empty());
    let levels: Vec<f64> = quantiles.into_iter().flatten().map(|one| one.level).collect();
    let mut arrays = Vec::new();
    for (k, Series { observable, .. }) in first.iter().enumerate() {
        let mut add = |what: &str, width: &[usize], of: &dyn Fn(&Series) -> Vec<f64>| {
            let (shape, each) = ([axes, width].concat(), width.iter().product::<usize>());
            let mut values = vec![f64::NAN; shape.iter().product()];
            for (place, series) in runs {
                let known = of(&series[k]);
                values[place * each..][..known.len()].copy_from_slice(&known);
            }
            arrays.push((format!("{observable} {what}"), shape, values));
        };
        let times = runs.iter().map(|(_, series)| series[k].points.len()).max().unwrap_or(0);
        let mut in_time = |what: &str, of: &dyn Fn(&Summary) -> Option<f64>| {
            add(what, &[times], &|series| {
                series.points.iter().map(|point| of(point).unwrap_or(f64::NAN)).collect()
            });
        };
        for statistic in STATISTICS {
            in_time(statistic.key, &statistic.of);
            if let Some(interval) = statistic.interval {
                // Those of the mean have no other name.
                let of = if statistic.key == "mean" { "" } else { "variance " };
                in_time(&format!("{of}lo"), &|point| Some(interval(point)?.0));
                in_time(&format!("{of}hi"), &|point| Some(interval(point)?.1));
            }
        }
        in_time("median", &|point| point.quantile(0.5)?.value);
        if !first[k].last().quantiles.is_empty() {
            add("quantiles", &[times, levels.len()], &|series| {
                let value = |point: &Summary, level: usize| point.quantiles.get(level)?.value;
                series
                    .points
                    .iter()
                    .flat_map(|point| (0..levels.len()).map(move |level| value(point, level)))
                    .map(|known| known.unwrap_or(f64::NAN))
                    .collect()
            });
        }
        let Some(bins) = runs
            .iter()
            .filter_map(|(_, all)| all[k].last().histogram.as_ref())
            .map(|of| of.counts.len())
            .max()
        else {
            continue;
        };
        let mut add = |what, width: usize, of: fn(&Histogram) -> Vec<f64>| {
            add(what, &[width], &|series| series.last().histogram.as_ref().map_or(Vec::new(), of));
        };
        add("histogram", bins, |of| of.counts.iter().map(|&count| count as f64).collect());
        add("edges", bins + 1, |of| edges(&of.grid));
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
