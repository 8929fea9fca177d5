//! A recording as comma-separated values. Plain numbers under a header need no quoting, hence no
//! library.

use std::fmt;
use std::str::FromStr;

use super::{Recording, RecordingError};

/// Step sizes written with ten digits, or computed as differences of times, agree to this relative
/// distance.
pub(crate) const TIME_AGREEMENT: f64 = 1e-9;

/// `A12`; `A3_12` where numbers may have two digits.
pub(super) fn area_name(m: usize, l: usize, noises: usize) -> String {
    if noises < 10 { format!("A{m}{l}") } else { format!("A{m}_{l}") }
}

/// `tau`, `dW1` … `dWM`, and with areas `A12`, `A13` … in the order of rows.
fn header(noises: usize, with_areas: bool) -> Vec<String> {
    let mut names = vec!["tau".to_owned()];
    names.extend((1..=noises).map(|m| format!("dW{m}")));
    if with_areas {
        names.extend(
            (1..=noises).flat_map(|m| (m + 1..=noises).map(move |l| area_name(m, l, noises))),
        );
    }
    names
}

impl<const M: usize> FromStr for Recording<M> {
    type Err = RecordingError;

    /// Reads the table that [`Recording`] describes; blanks around numbers, a `#` before the
    /// header, a byte-order mark and empty lines at the end are overlooked.
    fn from_str(text: &str) -> Result<Self, RecordingError> {
        let text = text.trim_start_matches('\u{feff}').trim_end();
        let mut lines = text.lines().enumerate().map(|(n, line)| (n + 1, line));
        let Some((_, first)) = lines.next().filter(|(_, line)| !line.trim().is_empty()) else {
            return Err(RecordingError::Empty);
        };
        let found: Vec<&str> = first.trim_start_matches('#').split(',').map(str::trim).collect();
        let plain = header(M, false);
        let with_areas = found.len() > plain.len();
        let names = if with_areas { header(M, true) } else { plain };
        for (i, (found, expected)) in found.iter().zip(&names).enumerate() {
            if found != expected {
                let (found, expected) = ((*found).to_owned(), expected.clone());
                return Err(RecordingError::Header { column: i + 1, found, expected });
            }
        }
        if found.len() != names.len() {
            return Err(RecordingError::Columns {
                line: 1,
                found: found.len(),
                expected: names.len(),
            });
        }

        let mut tau = None;
        let (mut increments, mut areas) = (Vec::new(), Vec::new());
        for (line, entries) in lines {
            let numbers = numbers(line, entries, &names)?;
            let first = *tau.get_or_insert(numbers[0]);
            if !(numbers[0] > 0.0 && numbers[0].is_finite()) {
                return Err(RecordingError::StepSize { line, tau: numbers[0] });
            }
            if (numbers[0] - first).abs() > TIME_AGREEMENT * first {
                return Err(RecordingError::UnequalSteps { line, tau: numbers[0], first });
            }
            let mut dw = [0.0; M];
            dw.copy_from_slice(&numbers[1..=M]);
            increments.push(dw);
            let mut upper = numbers[M + 1..].iter();
            let mut area = [[0.0; M]; M];
            for m in 0..M {
                for l in m + 1..M {
                    area[m][l] = upper.next().copied().unwrap_or(0.0);
                }
            }
            areas.push(area);
        }
        let recording = Self::new(tau.unwrap_or(f64::NAN), increments)?;
        if with_areas { recording.with_areas(areas) } else { Ok(recording) }
    }
}

/// The entries of one line.
fn numbers(line: usize, entries: &str, names: &[String]) -> Result<Vec<f64>, RecordingError> {
    let entries: Vec<&str> = entries.split(',').map(str::trim).collect();
    if entries.len() != names.len() {
        return Err(RecordingError::Columns { line, found: entries.len(), expected: names.len() });
    }
    entries
        .iter()
        .zip(names)
        .map(|(text, name)| {
            text.parse().map_err(|_| {
                let (column, text) = (name.clone(), (*text).to_owned());
                RecordingError::NotANumber { line, column, text }
            })
        })
        .collect()
}

impl<const M: usize> fmt::Display for Recording<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", header(M, self.areas.is_some()).join(","))?;
        for (n, dw) in self.increments.iter().enumerate() {
            // The debug form of a float is the shortest text that reads back to the same bits, with
            // an exponent where short.
            write!(f, "{:?}", self.tau)?;
            for w in dw {
                write!(f, ",{w:?}")?;
            }
            if let Some(areas) = &self.areas {
                for m in 0..M {
                    for l in m + 1..M {
                        write!(f, ",{:?}", areas[n][m][l])?;
                    }
                }
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
