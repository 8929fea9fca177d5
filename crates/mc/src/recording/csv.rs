//! A recording as comma-separated values: plain numbers under a header, without quoting.

use std::{fmt, str::FromStr};

use super::{Recording, RecordingError, TIME_AGREEMENT, area_name, pairs, step_size, wrong};

/// `tau`, `dW1` … `dWM`, and with areas `A12`, `A13` … in the order of rows.
fn header(noises: usize, with_areas: bool) -> Vec<String> {
    let areas = pairs(noises).filter(|_| with_areas).map(|pair| area_name(pair, noises));
    ["tau".into()].into_iter().chain((1..=noises).map(|m| format!("dW{m}"))).chain(areas).collect()
}

impl<const M: usize> FromStr for Recording<M> {
    type Err = RecordingError;

    /// Reads the table that [`Recording`] describes. Ignores blanks around numbers, a `#` before
    /// the header, a byte-order mark and empty lines at the end.
    fn from_str(text: &str) -> Result<Self, RecordingError> {
        let text = text.trim_start_matches(['\u{feff}', ' ', '#']).trim_end();
        if text.is_empty() {
            return Self::new(f64::NAN, Vec::new());
        }
        let mut lines = text.lines().map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
        let found = lines.next().unwrap_or_default();
        let with_areas = found.len() > M + 1;
        let names = header(M, with_areas);
        if let Some(column) = (0..found.len().min(names.len())).find(|&k| found[k] != names[k]) {
            let what = format!("the header must say {}, got {:?}", names[column], found[column]);
            return Err(wrong(1, column + 1, what));
        }
        let (mut first, mut increments, mut areas) = (None, Vec::new(), Vec::new());
        for (line, entries) in (1..).zip([found].into_iter().chain(lines)) {
            if entries.len() != names.len() {
                let (expected, found) = (names.len(), entries.len());
                let text = format!("line {line}: expected {expected} columns, got {found}");
                return Err(RecordingError(text));
            }
            if line == 1 {
                continue;
            }
            let number = |(text, name): (&&str, &String)| {
                text.parse()
                    .map_err(|_| wrong(line, name, format!("expected a number, got {text:?}")))
            };
            let numbers: Vec<f64> =
                entries.iter().zip(&names).map(number).collect::<Result<_, _>>()?;
            let tau = step_size(line, numbers[0])?;
            let first = *first.get_or_insert(tau);
            if (tau - first).abs() > TIME_AGREEMENT * first {
                let what = format!("all steps must have the size of the first, {first}, got {tau}");
                return Err(wrong(line, "tau", what));
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
