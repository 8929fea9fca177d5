//! The noise of one path as data: to drive a scheme by increments from another program, or another
//! program by ours.

use std::{fmt, str::FromStr};

use noise::{StepNoise, StreamKey};
use real::WIDTH;

use crate::{
    LadderError,
    noise_source::{Drawn, NextNoise, NoiseSource},
};

/// The noise of one path: for each step of one size τ the M increments ΔW and, if known, the Lévy
/// areas A_ml = ½∫(W_m dW_l − W_l dW_m) with m < l.
///
/// Increments are as they were drawn: a scheme's truncation is applied when they are used. As text,
/// by [`parse`](str::parse) and by `to_string`, a recording is a table of comma-separated values
/// with one line for each step under the header `tau,dW1,…,dWM`, followed by `A12,A13,…` where
/// there are areas (`A1_2` for ten noises and more); numbers are the shortest that read back to the
/// same bits.
///
/// ```
/// use mc::Recording;
///
/// let recording: Recording = "tau,dW1,dW2\n0.25,0.1,-0.3\n0.25,0.2,0.4\n".parse()?;
/// assert_eq!(recording.rows()[1], [0.2, 0.4]);
/// assert_eq!(recording.to_string().parse::<Recording>()?, recording);
///
/// let error = "tau,dW1,dW2\n0.25,0.1,-0.3\n0.25,NaN,0.4\n".parse::<Recording>().unwrap_err();
/// assert_eq!(error.to_string(), "line 3, column dW1: an increment must be finite, got NaN");
/// # Ok::<(), mc::RecordingError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    tau: f64,
    noises: usize,
    rows: Vec<Vec<f64>>,
}

/// Relative tolerance for equal step sizes, which may be written with ten digits or computed as
/// differences of times.
const TIME_AGREEMENT: f64 = 1e-9;

/// Why noise is not a recording, with line and column of the table, counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct RecordingError(String);

fn wrong(line: usize, column: impl fmt::Display, what: impl fmt::Display) -> RecordingError {
    RecordingError(format!("line {line}, column {column}: {what}"))
}

fn columns(line: usize, names: &[String], found: usize) -> Result<(), RecordingError> {
    let expected = names.len();
    match found == expected {
        true => Ok(()),
        false => {
            Err(RecordingError(format!("line {line}: expected {expected} columns, got {found}")))
        }
    }
}

/// The (m, l) with m < l, row by row.
fn pairs(noises: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..noises).flat_map(move |m| (m + 1..noises).map(move |l| (m, l)))
}

/// `tau`, `dW1` … `dWM`, and with areas `A12`, `A13` … in the order of rows, with a separator where
/// numbers may have two digits.
fn header(noises: usize, with_areas: bool) -> Vec<String> {
    let separator = if noises < 10 { "" } else { "_" };
    let area = |(m, l)| format!("A{}{separator}{}", m + 1, l + 1);
    let areas = pairs(noises).filter(|_| with_areas).map(area);
    ["tau".into()].into_iter().chain((1..=noises).map(|m| format!("dW{m}"))).chain(areas).collect()
}

impl Recording {
    /// The steps of size `tau` in the order of time, each with as many increments as there are
    /// noises and then its areas A₁₂, A₁₃ …, if they are known: the columns of the table after the
    /// first.
    ///
    /// # Errors
    /// [`RecordingError`] when there is no step, when τ is not positive and finite, when a row has
    /// another length, or when a number is not finite; steps are counted as lines of the table, of
    /// which the header is the first.
    pub fn new(tau: f64, noises: usize, rows: Vec<Vec<f64>>) -> Result<Self, RecordingError> {
        let Some(first) = rows.first() else {
            return Err(RecordingError("a recording must have at least one step, got none".into()));
        };
        if !(tau > 0.0 && tau.is_finite()) {
            let what = format!("a step size must be positive and finite, got {tau}");
            return Err(wrong(2, "tau", what));
        }
        let names = header(noises, first.len() > noises);
        for (line, row) in (2..).zip(&rows) {
            columns(line, &names, row.len() + 1)?;
            if let Some((name, x)) = names[1..].iter().zip(row).find(|(_, x)| !x.is_finite()) {
                return Err(wrong(line, name, format!("an increment must be finite, got {x}")));
            }
        }
        Ok(Self { tau, noises, rows })
    }

    /// The noise of path number `path` on `steps` steps to the time `t_end`, with its areas if
    /// `with_areas`.
    ///
    /// # Errors
    /// [`LadderError::Steps`] for zero steps, [`LadderError::Step`] unless 0 < T < ∞,
    /// [`LadderError::Noise`] when no number of terms is large enough for the areas.
    pub fn draw(
        key: StreamKey,
        path: u64,
        steps: u64,
        t_end: f64,
        noises: usize,
        with_areas: bool,
    ) -> Result<Self, LadderError> {
        if steps == 0 {
            return Err(LadderError::Steps { steps, multiple_of: 1 });
        }
        let tau = t_end / steps as f64;
        if !(tau > 0.0 && tau.is_finite()) {
            return Err(schemes::StepError { tau }.into());
        }
        let drawn = Drawn::new(key, tau, with_areas.then_some(noises))?;
        let (mut next, mut block) = (drawn.block(path), StepNoise::with_areas(noises));
        let row = |_| {
            next(&mut block);
            let areas = pairs(noises).filter(|_| with_areas);
            let areas = areas.map(|(m, l)| block.areas[m * noises + l][0]);
            block.increments.iter().map(|row| row[0]).chain(areas).collect()
        };
        Ok(Self { tau, noises, rows: (0..steps).map(row).collect() })
    }

    /// τ.
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// The increments of each step, and its areas if they are known.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    fn has_areas(&self) -> bool {
        self.rows[0].len() > self.noises
    }
}

/// The recording on every path.
impl NoiseSource for &Recording {
    fn block(&self, _first_path: u64) -> NextNoise<'_> {
        let mut rows = self.rows.iter();
        Box::new(move |noise| {
            let Some(row) = rows.next() else { return };
            let (dw, areas) = row.split_at(self.noises);
            noise.increments.iter_mut().zip(dw).for_each(|(row, &dw)| *row = [dw; WIDTH]);
            if !noise.areas.is_empty() {
                let pairs = pairs(self.noises).zip(areas);
                pairs.for_each(|((m, l), &area)| {
                    noise.areas[m * self.noises + l] = [area; WIDTH];
                });
            }
        })
    }

    fn check(
        &self,
        noises: usize,
        t_end: f64,
        steps: u64,
        area_reader: Option<&'static str>,
    ) -> Result<(), LadderError> {
        let (of, recorded) = (self.noises, self.rows.len());
        let end = self.tau * steps as f64;
        let agrees = (end - t_end).abs() <= TIME_AGREEMENT * t_end;
        let wrong = if of != noises {
            format!("the recording must have the {noises} noises of the problem, got {of}")
        } else if recorded as u64 != steps {
            format!(
                "the recording must have as many steps as the finest level, {steps}, got {recorded}"
            )
        } else if !agrees {
            format!(
                "the recorded increments must end at the final time T = {t_end} of the problem, got \
                 {end}"
            )
        } else if let (Some(scheme), false) = (area_reader, self.has_areas()) {
            format!(
                "{scheme} reads Levy areas: the recording must have the columns A12, A13, ..., got \
                 increments only"
            )
        } else {
            return Ok(());
        };
        Err(LadderError::Recording(wrong))
    }
}

impl FromStr for Recording {
    type Err = RecordingError;

    /// Reads the table that [`Recording`] describes. Ignores blanks around numbers, a `#` before
    /// the header, a byte-order mark and empty lines at the end.
    fn from_str(text: &str) -> Result<Self, RecordingError> {
        let text = text.trim_start_matches(['\u{feff}', ' ', '#']).trim_end();
        let mut lines = text.lines().map(|line| line.split(',').map(str::trim).collect::<Vec<_>>());
        let found = lines.next().unwrap_or_default();
        let noises = found.iter().filter(|name| name.starts_with("dW")).count();
        let names = header(noises, found.len() > noises + 1);
        if let Some((k, (found, name))) =
            (1..).zip(found.iter().zip(&names)).find(|(_, (found, name))| found != name)
        {
            return Err(wrong(1, k, format!("the header must say {name}, got {found:?}")));
        }
        columns(1, &names, found.len().max(1))?;
        let (mut tau, mut rows) = (f64::NAN, Vec::new());
        for (line, entries) in (2..).zip(lines) {
            columns(line, &names, entries.len())?;
            let number = |(text, name): (&&str, &String)| {
                text.parse()
                    .map_err(|_| wrong(line, name, format!("expected a number, got {text:?}")))
            };
            let numbers = entries.iter().zip(&names).map(number);
            let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
            let (now, row) = (numbers[0], numbers[1..].to_vec());
            tau = if line == 2 { now } else { tau };
            let agrees = (now - tau).abs() <= TIME_AGREEMENT * tau;
            if tau > 0.0 && !agrees {
                let what = match now > 0.0 && now.is_finite() {
                    true => format!("all steps must have the size of the first, {tau}, got {now}"),
                    false => format!("a step size must be positive and finite, got {now}"),
                };
                return Err(wrong(line, "tau", what));
            }
            rows.push(row);
        }
        Self::new(tau, noises, rows)
    }
}

impl fmt::Display for Recording {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", header(self.noises, self.has_areas()).join(","))?;
        for row in &self.rows {
            // The debug form of a float is the shortest text that reads back to the same bits.
            write!(f, "{:?}", self.tau)?;
            row.iter().try_for_each(|x| write!(f, ",{x:?}"))?;
            writeln!(f)?;
        }
        Ok(())
    }
}
