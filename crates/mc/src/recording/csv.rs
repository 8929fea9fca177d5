//! A recording as comma-separated values: plain numbers under a header, without quoting.

use std::{fmt, str::FromStr};

use super::{Recording, TIME_AGREEMENT, area_name, error::RecordingError, pairs};

/// `tau`, `dW1` … `dWM`, and with areas `A12`, `A13` … in the order of rows.
fn header(noises: usize, with_areas: bool) -> Vec<String> {
    let areas = pairs(noises).filter(|_| with_areas);
    let increments = (1..=noises).map(|m| format!("dW{m}"));
    let areas = areas.map(|pair| area_name(pair, noises));
    ["tau".into()].into_iter().chain(increments).chain(areas).collect()
}

fn entries(line: &str) -> Vec<&str> {
    line.split(',').map(str::trim).collect()
}

fn check_columns(line: usize, found: usize, expected: usize) -> Result<(), RecordingError> {
    if found == expected { Ok(()) } else { Err(RecordingError::Columns { line, found, expected }) }
}

impl<const M: usize> FromStr for Recording<M> {
    type Err = RecordingError;

    /// Reads the table that [`Recording`] describes. Ignores blanks around numbers, a `#` before
    /// the header, a byte-order mark and empty lines at the end.
    fn from_str(text: &str) -> Result<Self, RecordingError> {
        let text = text.trim_start_matches('\u{feff}').trim_end();
        let mut lines = text.lines();
        let first = lines.next().unwrap_or_default().trim().trim_start_matches('#');
        if first.is_empty() {
            return Err(RecordingError::Empty);
        }
        let found = entries(first);
        let with_areas = found.len() > M + 1;
        let names = header(M, with_areas);
        for (column, (found, expected)) in (1..).zip(found.iter().zip(&names)) {
            if found != expected {
                let (found, expected) = (found.to_string(), expected.clone());
                return Err(RecordingError::Header { column, found, expected });
            }
        }
        check_columns(1, found.len(), names.len())?;

        let mut first = None;
        let (mut increments, mut areas) = (Vec::new(), Vec::new());
        for (line, text) in (2..).zip(lines) {
            let entries = entries(text);
            check_columns(line, entries.len(), names.len())?;
            let mut numbers: Vec<f64> = Vec::new();
            for (text, column) in entries.iter().zip(&names) {
                let wrong = |_| RecordingError::NotANumber {
                    line,
                    column: column.clone(),
                    text: text.to_string(),
                };
                numbers.push(text.parse().map_err(wrong)?);
            }
            let tau = numbers[0];
            let first = *first.get_or_insert(tau);
            if !(tau > 0.0 && tau.is_finite()) {
                return Err(RecordingError::StepSize { line, tau });
            }
            if (tau - first).abs() > TIME_AGREEMENT * first {
                return Err(RecordingError::UnequalSteps { line, tau, first });
            }
            increments.push(std::array::from_fn(|m| numbers[1 + m]));
            let mut area = [[0.0; M]; M];
            for ((m, l), value) in pairs(M).zip(&numbers[M + 1..]) {
                area[m][l] = *value;
            }
            areas.push(area);
        }
        let recording = Self::new(first.unwrap_or(f64::NAN), increments)?;
        if with_areas { recording.with_areas(areas) } else { Ok(recording) }
    }
}

impl<const M: usize> fmt::Display for Recording<M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", header(M, self.areas.is_some()).join(","))?;
        for (n, dw) in self.increments.iter().enumerate() {
            // The debug form of a float is the shortest text that reads back to the same bits.
            write!(f, "{:?}", self.tau)?;
            dw.iter().try_for_each(|w| write!(f, ",{w:?}"))?;
            if let Some(areas) = &self.areas {
                pairs(M).try_for_each(|(m, l)| write!(f, ",{:?}", areas[n][m][l]))?;
            }
            writeln!(f)?;
        }
        Ok(())
    }
}
