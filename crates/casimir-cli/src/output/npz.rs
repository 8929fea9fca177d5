//! Arrays for NumPy.

use std::{
    fs::File,
    io::{self, BufWriter},
    path::Path,
};

use casimir::mc::{
    TimeSeries,
    study::{Series, StudyResult, Summary},
};
use npyz::{WriteOptions, WriterBuilder, npz::file_name_from_array_name};
use zip::{DateTime, ZipWriter, write::SimpleFileOptions};

type Writer = ZipWriter<BufWriter<File>>;

/// An array of this shape in row-major order.
fn array(out: &mut Writer, name: &str, shape: &[u64], values: Vec<f64>) -> io::Result<()> {
    // Without the time of day: the same results are the same bytes.
    let options = SimpleFileOptions::default().last_modified_time(DateTime::default());
    out.start_file(file_name_from_array_name(name), options)?;
    let mut writer = WriteOptions::new().default_dtype().shape(shape).writer(out).begin_nd()?;
    writer.extend(values)?;
    writer.finish()
}

fn create(file: &Path) -> io::Result<Writer> {
    Ok(ZipWriter::new(BufWriter::new(File::create(file)?)))
}

/// The tables of paths: `t`, and for each column an array [path, time]. A path that ended early has
/// NaN from there on.
pub fn paths(file: &Path, tables: &[TimeSeries]) -> io::Result<()> {
    let longest = tables.iter().max_by_key(|table| table.times().len());
    let Some(longest) = longest else { return Ok(()) };
    let times = longest.times();
    let mut out = create(file)?;
    for (k, column) in longest.columns.iter().enumerate() {
        if column.name == "t" {
            array(&mut out, "t", &[times.len() as u64], times.to_vec())?;
            continue;
        }
        let padded = |table: &TimeSeries| {
            let mut values = table.columns[k].values.clone();
            values.resize(times.len(), f64::NAN);
            values
        };
        let values = tables.iter().flat_map(padded).collect();
        array(&mut out, &column.name, &[tables.len() as u64, times.len() as u64], values)?;
    }
    out.finish()?;
    Ok(())
}

/// A statistic of a summary, if it is known.
type Statistic = fn(&Summary) -> Option<f64>;

/// Statistics: `t`, `quantile levels`, and for each observable `<name> mean`, `<name> lo` and
/// `<name> hi` (the 95 % interval of the mean), `<name> deviation` and `<name> quantiles`, an array
/// [time, level]. What is not known is NaN.
pub fn study(file: &Path, result: &StudyResult) -> io::Result<()> {
    let mut out = create(file)?;
    let Some(first) = result.series.first() else { return Ok(()) };
    let times: Vec<f64> = first.points.iter().map(|point| point.time).collect();
    let (count, levels) = (times.len() as u64, result.record.quantiles.clone());
    let shape = [count, levels.len() as u64];
    array(&mut out, "t", &[count], times)?;
    array(&mut out, "quantile levels", &[shape[1]], levels)?;
    let known = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let columns: [(&str, Statistic); 4] = [
        ("mean", |point| point.mean),
        ("lo", |point| point.mean_interval.map(|(lo, _)| lo)),
        ("hi", |point| point.mean_interval.map(|(_, hi)| hi)),
        ("deviation", |point| point.deviation),
    ];
    for Series { observable, points } in &result.series {
        for (what, of) in columns {
            let values = points.iter().map(|point| known(of(point)));
            array(&mut out, &format!("{observable} {what}"), &[count], values.collect())?;
        }
        let quantiles = points.iter().flat_map(|point| &point.quantiles);
        let quantiles = quantiles.map(|quantile| known(quantile.value));
        array(&mut out, &format!("{observable} quantiles"), &shape, quantiles.collect())?;
    }
    out.finish()?;
    Ok(())
}
