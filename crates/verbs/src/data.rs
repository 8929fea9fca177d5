//! Tables of measured moments, or of samples.

use std::ops::Range;

use ::fit::{Data, Moment, Statistic};
use csv::{ReaderBuilder, StringRecord, Trim};

use crate::failure::{Done, Failure};
use scenes::Source;

/// Columns of a table of moments.
const MOMENTS: [&str; 5] = ["time", "observable", "statistic", "value", "error"];

/// Reads data: a line for each moment, with the columns time, observable, statistic (mean,
/// variance or a quantile as q0.05), value and error; or one for each sample, with t or time and a
/// column for each observable. Gives the names of the observables, some of those `known`.
pub fn read(source: &Source, known: &[&str]) -> Done<(Vec<String>, Data)> {
    let mut reader = ReaderBuilder::new()
        .trim(Trim::All)
        .comment(Some(b'#'))
        .from_reader(source.text.as_bytes());
    let unread = |error: csv::Error| Failure::Usage(format!("{}: {error}", source.name));
    let wrong =
        |place: Range<usize>, words: String| Failure::Usage(source.error(place, words).to_string());
    let header = reader.headers().map_err(unread)?.clone();
    let column = |names: &[&str]| header.iter().position(|name| names.contains(&name));
    let Some(time) = column(&["t", "time"]) else {
        let words = format!(
            "no column `t` or `time`: moments have the columns {}, samples have t and a column for \
             each observable",
            MOMENTS.join(", ")
        );
        return Err(wrong(place(&source.text, &header, 0), words));
    };
    let know = |name: &str, at: Range<usize>| match known.contains(&name) {
        true => Ok(()),
        false => {
            let known = known.join(", ");
            Err(wrong(at, format!("no observable `{name}`; there are {known}")))
        }
    };
    let records = reader.records().collect::<Result<Vec<_>, _>>().map_err(unread)?;
    let number = |record: &StringRecord, k: usize| {
        let text = &record[k];
        text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
            let words = format!("`{text}` in the column `{}` is not a number", &header[k]);
            wrong(place(&source.text, record, k), words)
        })
    };
    let refused = |error| Failure::Usage(format!("{}: {error}", source.name));
    let columns = [1, 2, 3, 4].map(|k| column(&[MOMENTS[k]]));
    let [Some(observable), Some(statistic), Some(value), Some(error)] = columns else {
        let of: Vec<usize> = (0..header.len()).filter(|&k| k != time).collect();
        of.iter().try_for_each(|&k| know(&header[k], place(&source.text, &header, k)))?;
        let sample = |record: &StringRecord| {
            let values = of.iter().map(|&k| number(record, k)).collect::<Done<_>>();
            Ok((number(record, time)?, values?))
        };
        let samples = records.iter().map(sample).collect::<Done<_>>()?;
        let names = of.iter().map(|&k| header[k].to_owned()).collect();
        return Ok((names, Data::of_samples(samples).map_err(refused)?));
    };
    let (mut names, mut moments, mut errors) = (Vec::<String>::new(), Vec::new(), Vec::new());
    for record in &records {
        let (name, text) = (&record[observable], &record[statistic]);
        know(name, place(&source.text, record, observable))?;
        let level = || text.strip_prefix('q')?.parse().ok().filter(|p| 0.0 < *p && *p < 1.0);
        let statistic = match text {
            "mean" => Statistic::Mean,
            "variance" => Statistic::Variance,
            _ => Statistic::Quantile(level().ok_or_else(|| {
                let words = format!("`{text}` is neither mean, variance nor a quantile as q0.05");
                wrong(place(&source.text, record, statistic), words)
            })?),
        };
        let of = names.iter().position(|known| known == name).unwrap_or_else(|| {
            names.push(name.to_owned());
            names.len() - 1
        });
        let (time, value) = (number(record, time)?, number(record, value)?);
        moments.push(Moment { time, of, statistic, value });
        let size = number(record, error)?;
        if size <= 0.0 {
            let words = format!("an error must be positive, got {size}");
            return Err(wrong(place(&source.text, record, error), words));
        }
        errors.push(size);
    }
    Ok((names, Data::with_errors(moments, &errors).map_err(refused)?))
}

/// Place of a field in the text, whose fields before it have no comma.
fn place(text: &str, record: &StringRecord, field: usize) -> Range<usize> {
    let start = record.position().map_or(0, |at| at.byte() as usize).min(text.len());
    let line = text[start..].trim_start_matches(['\r', '\n']);
    let before = line.split(',').take(field).map(|part| part.len() + 1).sum::<usize>();
    let first = text.len() - line.len() + before;
    first..first + record[field].len()
}
