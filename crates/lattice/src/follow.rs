//! A path with what is measured of it.

use std::io;

use mc::{
    Checkpoint, PathFailure,
    parts::{JobError, Stop},
};
use real::Row;
use serde::{Deserialize, Serialize};
use systems::lattice::SpinLattice;

use crate::{LargePath, Means, Spectra, Work};

/// Steps between two looks at the request to end, and at the time of the last checkpoint.
const STEPS: u64 = 8;

/// Measurements of a path so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// Times with means, from 0.
    pub times: Vec<f64>,
    /// Means at these times.
    pub means: Vec<Means>,
    /// Times of spectra.
    pub at: Vec<f64>,
    /// Spectra at these times.
    pub spectra: Vec<Spectra>,
    /// Failure of the path, or a note that it was stopped, if it ends early.
    pub halted: Option<String>,
}

impl Record {
    /// Correlations and structure factors along each axis, by path, time, and distance or wave
    /// number; NaN after a path ended early.
    #[must_use]
    pub fn spectra_of(records: &[Self]) -> Vec<(String, Vec<usize>, Vec<f64>)> {
        let Some(longest) = records.iter().max_by_key(|record| record.at.len()) else {
            return Vec::new();
        };
        let times = longest.at.len();
        let mut arrays = vec![("t of spectra".to_owned(), vec![times], longest.at.clone())];
        let Some(first) = longest.spectra.first() else { return arrays };
        type OfAxes = fn(&Spectra) -> &[Vec<f64>];
        let kinds: [(&str, OfAxes); 2] =
            [("correlation", |one| &one.correlations), ("structure", |one| &one.structures)];
        for axis in 0..first.correlations.len() {
            for (kind, of) in kinds {
                let each = of(first)[axis].len();
                let row = |record: &Self| {
                    let known = record.spectra.iter().flat_map(|one| &of(one)[axis]);
                    let mut all: Vec<f64> = known.copied().collect();
                    all.resize(times * each, f64::NAN);
                    all
                };
                let values = records.iter().flat_map(row).collect();
                let shape = vec![records.len(), times, each];
                arrays.push((format!("{kind} {}", axis + 1), shape, values));
            }
        }
        arrays
    }
}

/// A path that is advanced to its end while means and spectra are measured.
pub struct Follow<'a> {
    /// The lattice of the path.
    pub lattice: &'a SpinLattice,
    /// Number of steps.
    pub steps: u64,
    /// Steps between means.
    pub every: u64,
    /// Steps between spectra, a multiple of that.
    pub spectra_every: u64,
}

impl Follow<'_> {
    /// Advances a path to its end, or until `stop` asks for an earlier one. With a checkpoint it
    /// goes on from there with the same bits, and writes it now and then, and at a stop. `told`
    /// hears the steps done since its last call, `keep` gets the number of the step and the state
    /// wherever spectra are measured.
    ///
    /// # Errors
    /// [`JobError`] if the checkpoint is of another path, or what `keep` does fails.
    pub fn path(
        &self,
        mut path: LargePath<'_>,
        checkpoint: Option<&Checkpoint>,
        stop: &Stop,
        told: &dyn Fn(u64),
        keep: &mut dyn FnMut(u64, &[Row]) -> io::Result<()>,
    ) -> Result<Record, JobError> {
        let mut record = Record::default();
        let stored = checkpoint.map(Checkpoint::read::<(Work, Record)>).transpose()?.flatten();
        match stored {
            Some((work, before)) => {
                path.resume(work).map_err(JobError::Refused)?;
                record = before;
                told(path.steps_done());
            }
            None => self.measure(&path, &mut record, keep)?,
        }
        let store = |path: &LargePath<'_>, record: &Record| {
            if let Some(checkpoint) = checkpoint {
                // `failure` of the checkpoint says why it cannot be written.
                _ = checkpoint.write(&(path.work(), record));
            }
        };
        while path.steps_done() < self.steps {
            if stop.is_asked() {
                store(&path, &record);
                record.halted = Some(format!("stopped after t = {}", path.time()));
                return Ok(record);
            }
            let steps = (self.every - path.steps_done() % self.every).min(STEPS);
            if let Err(failure) = path.advance(steps) {
                let PathFailure { step, cause, tau, .. } = failure;
                let t = step as f64 * tau;
                record.halted = Some(format!("step {step} of size {tau}, at t = {t}: {cause}"));
                return Ok(record);
            }
            told(steps);
            if path.steps_done().is_multiple_of(self.every) {
                self.measure(&path, &mut record, keep)?;
            }
            if checkpoint.is_some_and(Checkpoint::is_due) {
                store(&path, &record);
            }
        }
        store(&path, &record);
        Ok(record)
    }

    fn measure(
        &self,
        path: &LargePath<'_>,
        record: &mut Record,
        keep: &mut dyn FnMut(u64, &[Row]) -> io::Result<()>,
    ) -> Result<(), JobError> {
        let (done, state, t) = (path.steps_done(), path.state(), path.time());
        record.times.push(t);
        record.means.push(Means::of(self.lattice, state, t));
        if done.is_multiple_of(self.spectra_every) {
            record.at.push(t);
            record.spectra.push(Spectra::of(self.lattice, state));
            let wrong = |error: io::Error| JobError::Refused(format!("the spins: {error}"));
            keep(done, state).map_err(wrong)?;
        }
        Ok(())
    }
}
