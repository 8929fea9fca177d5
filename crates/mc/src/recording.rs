//! The noise of one path as data: to drive a scheme by increments from another program, or another
//! program by ours.

use noise::{StepNoise, StreamKey};
use real::WIDTH;

use crate::{
    LadderError,
    noise_source::{Drawn, NextNoise, NoiseSource},
};

/// The noise of one path: for each step of one size τ the M increments ΔW and, if known, the Lévy
/// areas A_ml = ½∫(W_m dW_l − W_l dW_m) with m < l. Increments are as they were drawn: a scheme's
/// truncation is applied when they are used, by
/// [`Simulation::recorded`](crate::Simulation::recorded) or
/// [`Ladder::with_noise`](crate::Ladder::with_noise).
///
/// ```
/// use mc::{Recording, Setup, Simulation};
/// use noise::{StreamKey, Truncation};
/// use schemes::Sexp;
/// use systems::{Constant, Pendulum, Problem};
///
/// let problem = Problem::new(Pendulum::new(1.0)?, Constant::new(2.0)?, [0.2, 1.0], 0.5)?;
/// let simulation = Simulation::new(Setup::of(&problem, &Sexp), Truncation::new(4)?);
/// let recording = Recording { tau: 0.25, noises: 1, rows: vec![vec![0.1], vec![-0.3]] };
/// assert_eq!(simulation.recorded(&recording)?.times(), [0.0, 0.25, 0.5]);
///
/// // Ours: τ, and a row for each step.
/// let key = StreamKey { seed: 1, experiment: 0 };
/// let drawn = Recording::draw(key, 7, 64, 0.5, 1, false)?;
/// assert_eq!(simulation.recorded(&drawn)?.columns, simulation.path(64, key, 7)?.columns);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// The step size τ.
    pub tau: f64,
    /// The number M of noises.
    pub noises: usize,
    /// For each step in the order of time the increments, and then the areas A₁₂, A₁₃ …, A₂₃ …, if
    /// they are known.
    pub rows: Vec<Vec<f64>>,
}

/// Relative tolerance for times, which may be written with ten digits.
const TIME_AGREEMENT: f64 = 1e-9;

/// The (m, l) with m < l, row by row.
fn pairs(noises: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..noises).flat_map(move |m| (m + 1..noises).map(move |l| (m, l)))
}

impl Recording {
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
                for ((m, l), &area) in pairs(self.noises).zip(areas) {
                    noise.areas[m * self.noises + l] = [area; WIDTH];
                }
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
        let Recording { tau, noises: of, rows } = self;
        let end = tau * steps as f64;
        let areas = area_reader.map_or(0, |_| pairs(noises).count());
        let length = noises + areas;
        let (scheme, recorded) = (area_reader.unwrap_or_default(), rows.len());
        let wrong = if *of != noises {
            format!("have the {noises} noises of the problem, got {of}")
        } else if recorded as u64 != steps {
            format!("have as many steps as the finest level, {steps}, got {recorded}")
        } else if (end - t_end).abs() > TIME_AGREEMENT * t_end || !end.is_finite() {
            format!("end at the final time T = {t_end} of the problem, got {end}")
        } else if let Some(row) = rows.iter().find(|row| row.len() < length) {
            let got = row.len();
            format!(
                "have {noises} increments and {areas} areas for {scheme} in each row, got {got}"
            )
        } else if let Some(number) = rows.iter().flatten().find(|number| !number.is_finite()) {
            format!("have finite numbers, got {number}")
        } else {
            return Ok(());
        };
        Err(LadderError::Recording(format!("the recording must {wrong}")))
    }
}
