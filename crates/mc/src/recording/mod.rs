//! The noise of one path as data: to drive a scheme by increments from another program, or another
//! program by ours.

mod csv;

use std::fmt::Display;

use noise::{Noise, StepNoise, StreamKey};
use real::WIDTH;

use crate::{
    LadderError,
    noise_source::{Drawn, NextNoise, NoiseSource},
};

/// The noise of one path: for each step of one size τ the M increments ΔW and, if known, the Lévy
/// areas.
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
/// let recording: Recording<2> = "tau,dW1,dW2\n0.25,0.1,-0.3\n0.25,0.2,0.4\n".parse()?;
/// assert_eq!(recording.increments()[1], [0.2, 0.4]);
/// assert_eq!(recording.to_string().parse::<Recording<2>>()?, recording);
///
/// let error = "tau,dW1,dW2\n0.25,0.1,-0.3\n0.25,NaN,0.4\n".parse::<Recording<2>>().unwrap_err();
/// assert_eq!(error.to_string(), "line 3, column dW1: an increment must be finite, got NaN");
/// # Ok::<(), mc::RecordingError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Recording<const M: usize> {
    tau: f64,
    increments: Vec<[f64; M]>,
    areas: Option<Vec<[[f64; M]; M]>>,
}

/// Relative tolerance for equal step sizes, which may be written with ten digits or computed as
/// differences of times.
const TIME_AGREEMENT: f64 = 1e-9;

/// Why noise is not a recording, with line and column of the table, counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct RecordingError(String);

fn wrong(line: usize, column: impl Display, what: impl Display) -> RecordingError {
    RecordingError(format!("line {line}, column {column}: {what}"))
}

fn step_size(line: usize, tau: f64) -> Result<f64, RecordingError> {
    if tau > 0.0 && tau.is_finite() {
        Ok(tau)
    } else {
        Err(wrong(line, "tau", format!("a step size must be positive and finite, got {tau}")))
    }
}

fn finite(line: usize, column: String, value: f64) -> Result<(), RecordingError> {
    let what = || format!("an increment must be finite, got {value}");
    if value.is_finite() { Ok(()) } else { Err(wrong(line, column, what())) }
}

/// `A12` for (0, 1); `A3_12` where numbers may have two digits.
fn area_name((m, l): (usize, usize), noises: usize) -> String {
    let separator = if noises < 10 { "" } else { "_" };
    format!("A{}{separator}{}", m + 1, l + 1)
}

/// The (m, l) with m < l, row by row.
fn pairs(noises: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..noises).flat_map(move |m| (m + 1..noises).map(move |l| (m, l)))
}

impl<const M: usize> Recording<M> {
    /// Increments of steps of size `tau`, in the order of time.
    ///
    /// # Errors
    /// [`RecordingError`] when there is no step, when τ is not positive and finite, or when a
    /// number is not finite; steps are counted as lines of the table, of which the header is the
    /// first.
    pub fn new(tau: f64, increments: Vec<[f64; M]>) -> Result<Self, RecordingError> {
        if increments.is_empty() {
            return Err(RecordingError("a recording must have at least one step, got none".into()));
        }
        step_size(2, tau)?;
        for (line, dw) in (2..).zip(&increments) {
            dw.iter()
                .enumerate()
                .try_for_each(|(m, &w)| finite(line, format!("dW{}", m + 1), w))?;
        }
        Ok(Self { tau, increments, areas: None })
    }

    /// The same with the Lévy areas A_ml = ½∫(W_m dW_l − W_l dW_m) of each step. Entries above the
    /// diagonal are used, the others follow.
    ///
    /// # Errors
    /// [`RecordingError`] unless there is one matrix of finite numbers for each step.
    pub fn with_areas(mut self, mut areas: Vec<[[f64; M]; M]>) -> Result<Self, RecordingError> {
        let (found, expected) = (areas.len(), self.increments.len());
        if found != expected {
            let text = "there must be one matrix of areas for each of";
            return Err(RecordingError(format!("{text} {expected} steps, got {found}")));
        }
        for (line, area) in (2..).zip(&mut areas) {
            (0..M).for_each(|m| area[m][m] = 0.0);
            for (m, l) in pairs(M) {
                finite(line, area_name((m, l), M), area[m][l])?;
                area[l][m] = -area[m][l];
            }
        }
        self.areas = Some(areas);
        Ok(self)
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
        with_areas: bool,
    ) -> Result<Self, LadderError> {
        if steps == 0 {
            return Err(LadderError::Steps { steps, multiple_of: 1 });
        }
        let tau = t_end / steps as f64;
        if !(tau > 0.0 && tau.is_finite()) {
            return Err(schemes::StepError::Size { tau }.into());
        }
        let drawn = Drawn::new(key, tau, with_areas.then_some(M))?;
        let (mut next, mut block) = (drawn.block(path), StepNoise::with_areas(M));
        let step = |_| {
            next(&mut block);
            let Noise { increments, areas } = block.path(0);
            (increments, areas)
        };
        let (increments, areas): (Vec<_>, Vec<_>) = (0..steps).map(step).unzip();
        Ok(Self { tau, increments, areas: with_areas.then_some(areas) })
    }

    /// The same path in steps that are `factor` times longer: increments are added, areas joined by
    /// Chen's relation.
    ///
    /// # Errors
    /// [`LadderError::Steps`] unless `factor` is positive and divides the number of steps.
    pub fn coarsened(&self, factor: usize) -> Result<Self, LadderError> {
        let steps = self.increments.len();
        if factor == 0 || !steps.is_multiple_of(factor) {
            return Err(LadderError::Steps { steps: steps as u64, multiple_of: factor as u64 });
        }
        let (mut increments, mut joined) = (Vec::new(), Vec::new());
        for first in (0..steps).step_by(factor) {
            let (mut sum, mut area) = ([0.0; M], [[0.0; M]; M]);
            for n in first..first + factor {
                let (dw, fine) = self.step(n);
                for m in 0..M {
                    for l in 0..M {
                        area[m][l] += fine[m][l] + 0.5 * (sum[m] * dw[l] - dw[m] * sum[l]);
                    }
                }
                (0..M).for_each(|m| sum[m] += dw[m]);
            }
            increments.push(sum);
            joined.push(area);
        }
        let areas = self.areas.as_ref().map(|_| joined);
        Ok(Self { tau: self.tau * factor as f64, increments, areas })
    }

    /// Increments and areas of step number n; zero areas if they are not known.
    fn step(&self, n: usize) -> ([f64; M], [[f64; M]; M]) {
        (self.increments[n], self.areas.as_ref().map_or([[0.0; M]; M], |areas| areas[n]))
    }

    /// τ.
    pub fn tau(&self) -> f64 {
        self.tau
    }

    /// One row of increments for each step.
    pub fn increments(&self) -> &[[f64; M]] {
        &self.increments
    }

    /// One skew matrix of Lévy areas for each step, if they are known.
    pub fn areas(&self) -> Option<&[[[f64; M]; M]]> {
        self.areas.as_deref()
    }
}

/// The recording on every path.
impl<const M: usize> NoiseSource for &Recording<M> {
    fn block(&self, _first_path: u64) -> NextNoise<'_> {
        let mut steps = 0..;
        Box::new(move |noise| {
            let (increments, areas) = self.step(steps.next().unwrap_or_default());
            let recorded = Noise { increments, areas };
            (0..WIDTH).for_each(|p| noise.set_path(p, &recorded));
        })
    }

    fn check(
        &self,
        noises: usize,
        t_end: f64,
        steps: u64,
        area_reader: Option<&'static str>,
    ) -> Result<(), LadderError> {
        if M != noises {
            return Err(LadderError::RecordedNoises { recorded: M, noises });
        }
        let recorded = self.increments.len() as u64;
        if recorded != steps {
            return Err(LadderError::RecordedSteps { recorded, steps });
        }
        let recorded = self.tau * steps as f64;
        let agree = (recorded - t_end).abs() <= TIME_AGREEMENT * t_end;
        if !agree {
            return Err(LadderError::Duration { recorded, t_end });
        }
        match area_reader {
            Some(scheme) if self.areas.is_none() => Err(LadderError::NoAreas { scheme }),
            _ => Ok(()),
        }
    }
}
