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
    let wrong = |record: &StringRecord, field: usize, words: String| {
        Failure::Usage(source.error(place(&source.text, record, field), words).to_string())
    };
    let unread = |error: csv::Error| Failure::Usage(format!("{}: {error}", source.name));
    let header = reader.headers().map_err(unread)?.clone();
    let column = |names: &[&str]| header.iter().position(|name| names.contains(&name));
    let Some(time) = column(&["t", "time"]) else {
        let words = format!(
            "no column `t` or `time`: moments have the columns {}, samples have t and a column for \
             each observable",
            MOMENTS.join(", ")
        );
        return Err(wrong(&header, 0, words));
    };
    let know = |record: &StringRecord, field: usize| {
        let name = &record[field];
        if known.contains(&name) {
            return Ok(());
        }
        Err(wrong(record, field, format!("no observable `{name}`; there are {}", known.join(", "))))
    };
    let records = reader.records().collect::<Result<Vec<_>, _>>().map_err(unread)?;
    let number = |record: &StringRecord, field: usize| {
        let text = &record[field];
        text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
            let column = &header[field];
            wrong(record, field, format!("`{text}` in the column `{column}` is not a number"))
        })
    };
    let refused = |error| Failure::Usage(format!("{}: {error}", source.name));
    let [Some(observable), Some(statistic), Some(value), Some(error)] =
        [1, 2, 3, 4].map(|k| column(&[MOMENTS[k]]))
    else {
        let of: Vec<usize> = (0..header.len()).filter(|&k| k != time).collect();
        of.iter().try_for_each(|&k| know(&header, k))?;
        let data = Data::of_samples(
            records
                .iter()
                .map(|record| {
                    Ok((
                        number(record, time)?,
                        of.iter().map(|&k| number(record, k)).collect::<Done<_>>()?,
                    ))
                })
                .collect::<Done<_>>()?,
        )
        .map_err(refused)?;
        return Ok((of.iter().map(|&k| header[k].to_owned()).collect(), data));
    };
    let (mut names, mut moments, mut errors) = (Vec::<String>::new(), Vec::new(), Vec::new());
    for record in &records {
        let (name, text) = (&record[observable], &record[statistic]);
        know(record, observable)?;
        let level = || text.strip_prefix('q')?.parse().ok().filter(|p| 0.0 < *p && *p < 1.0);
        let statistic = match text {
            "mean" => Statistic::Mean,
            "variance" => Statistic::Variance,
            _ => Statistic::Quantile(level().ok_or_else(|| {
                wrong(
                    record,
                    statistic,
                    format!("`{text}` is neither mean, variance nor a quantile as q0.05"),
                )
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
            return Err(wrong(record, error, format!("an error must be positive, got {size}")));
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
