//! A run of a program: whole, one part of it, or the merging of parts.

use std::{
    collections::BTreeSet,
    fs,
    path::Path,
    sync::{Mutex, PoisonError},
    time::Duration,
};

use super::{
    JobError, Program, Share, Stop,
    file::file_error,
    merging::Merging,
    part::Part,
    plan::{Pilot, Plan},
    work::Work,
};
use crate::{Kept, ladder::Nodes, parallel::in_parallel};

/// How often a checkpoint is written, unless said otherwise.
const INTERVAL: Duration = Duration::from_secs(60);

/// Rounds of samples of at most so many path-steps, about a second, are drawn by every part.
const ALONE: u64 = 1 << 27;

/// What a program does with its Monte Carlo work: compute it here, compute one part, or merge.
///
/// A job that met an error computes nothing more; [`finish`](Self::finish) says what it was.
///
/// # Panics
/// When a piece of work is begun inside another: a job has one at a time.
#[must_use = "a job is written and its errors are told by `finish`"]
pub struct Job {
    stop: Stop,
    interval: Duration,
    alone: u64,
    /// Whether work that was stopped gives the result of what is done.
    incomplete: bool,
    state: Mutex<State>,
}

struct State {
    mode: Mode,
    error: Option<JobError>,
    /// Names of works so far.
    names: BTreeSet<String>,
}

enum Mode {
    /// Nothing is written.
    Here,
    Part(Part),
    Merge(Merging),
    /// A little of everything is computed, and forgotten.
    Plan(Pilot),
}

impl Job {
    /// All work is done here, and nothing is written.
    pub fn here() -> Self {
        Self::new(Mode::Here)
    }

    /// Part `share` of all work, in `folder`, which is created. If the folder has a checkpoint of
    /// this part, the job goes on from it. [`Share::WHOLE`] gives results at once: a run with
    /// checkpoints.
    ///
    /// # Errors
    /// [`JobError`] if the folder cannot be written, another process has this part, or the file of
    /// the part is damaged or of another program.
    pub fn part(folder: &Path, share: Share, program: Program) -> Result<Self, JobError> {
        fs::create_dir_all(folder).map_err(file_error("create the folder", folder))?;
        Ok(Self::new(Mode::Part(Part::open(folder, share, &program)?)))
    }

    /// Results come from the parts in `folder`.
    ///
    /// # Errors
    /// [`JobError`] if there are none, or a file cannot be read, is damaged, or is of another
    /// program.
    pub fn merge(folder: &Path, program: Program) -> Result<Self, JobError> {
        Ok(Self::new(Mode::Merge(Merging::open(folder, &program)?)))
    }

    /// Measures how long works take, on a few groups of each that take at least this long.
    /// [`plan`](Self::plan) has the result.
    pub fn pilot(each: Duration) -> Self {
        Self::new(Mode::Plan(Pilot { each, plan: Plan::default() }))
    }

    fn new(mode: Mode) -> Self {
        let state = Mutex::new(State { mode, error: None, names: BTreeSet::new() });
        let stop = Stop::default();
        Self { stop, interval: INTERVAL, alone: ALONE, incomplete: false, state }
    }

    /// Ends early when `stop` asks for it, with a checkpoint.
    pub fn stopped_by(mut self, stop: &Stop) -> Self {
        self.stop = stop.clone();
        self
    }

    /// A study or ladder that is stopped gives the result of the paths that are done, not of part
    /// of several; an expectation the estimates of the rounds before. [`finish`](Self::finish) says
    /// [`JobError::Stopped`] all the same.
    pub fn giving_what_is_done(mut self) -> Self {
        self.incomplete = true;
        self
    }

    /// Writes a checkpoint as often as this; a minute by default.
    pub fn with_checkpoints_every(mut self, interval: Duration) -> Self {
        self.interval = interval;
        self
    }

    /// Splits a round of samples of an [expectation](crate::Expect::run_in) into parts
    /// if it takes more than so many path-steps; 2²⁷, about a second, by default. Smaller rounds
    /// are drawn by every part, since later ones follow from them. All parts and whoever merges
    /// them must have the same number.
    pub fn splitting_rounds_above(mut self, path_steps: u64) -> Self {
        self.alone = path_steps;
        self
    }

    /// Whether it was stopped and gives what is done.
    pub(crate) fn gives_what_is_done(&self) -> bool {
        self.incomplete && self.stop.is_asked()
    }

    /// Whether this job goes on from a checkpoint.
    pub fn resumes(&self) -> bool {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        matches!(&state.mode, Mode::Part(part) if part.resumes)
    }

    /// Ends a [`pilot`](Self::pilot): what there is to compute, and how long it takes.
    ///
    /// # Errors
    /// The first error of the job.
    pub fn plan(self) -> Result<Plan, JobError> {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        match (state.error, state.mode) {
            (Some(error), _) => Err(error),
            (None, Mode::Plan(pilot)) => Ok(pilot.plan),
            _ => Ok(Plan::default()),
        }
    }

    /// Ends the job: writes what is not written yet.
    ///
    /// # Errors
    /// [`JobError`]: the first error of the job, or [`JobError::Missing`], or
    /// [`JobError::NextRound`].
    pub fn finish(self) -> Result<(), JobError> {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        match (state.error, state.mode) {
            (Some(JobError::Stopped), Mode::Part(part)) => {
                part.finish().and(Err(JobError::Stopped))
            }
            (Some(error), _) => Err(error),
            (None, Mode::Here | Mode::Plan(_)) => Ok(()),
            (None, Mode::Part(part)) => part.finish(),
            (None, Mode::Merge(merging)) => merging.finish(),
        }
    }

    /// What ends this job early.
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    /// The nodes of all groups of some pieces of work, none of which depends on another, if they
    /// are known here: computed, or merged. They are all rounds or none.
    pub(crate) fn collect<T: Kept>(&self, works: &[Work<'_, T>]) -> Option<Vec<Nodes<T>>> {
        // Waiting would be for ever: this thread may be at work on the other one.
        let state = self.state.try_lock();
        let mut state = state
            .unwrap_or_else(|_| panic!("{} was begun inside another piece of work", works[0].name));
        let State { mode, error, names } = &mut *state;
        if error.is_some() {
            return None;
        }
        // Later rounds follow from whole ones only.
        let incomplete = self.incomplete && works.iter().all(|work| work.round.is_none());
        let again = works.iter().find(|work| !names.insert(work.name.clone()));
        let small = works.iter().all(|work| work.round.is_some_and(|cost| cost <= self.alone));
        let found: Result<Vec<_>, _> = match mode {
            _ if let Some(Work { name, .. }) = again => Err(JobError::Refused(format!(
                "the name {name:?} is given to two pieces of work; names tell them apart in files"
            ))),
            Mode::Here => here(works, incomplete),
            _ if small => here(works, false),
            Mode::Part(part) => {
                let collect = |work| part.collect(work, self.interval, incomplete);
                works.iter().map(collect).collect()
            }
            Mode::Merge(merging) => works.iter().map(|work| merging.collect(work)).collect(),
            Mode::Plan(pilot) => {
                works.iter().map(|work| pilot.measure(work).map(|()| None)).collect()
            }
        };
        let found = found.map_err(|met| *error = Some(met)).ok()?;
        if incomplete && self.stop.is_asked() {
            *error = Some(JobError::Stopped);
        }
        found.into_iter().collect()
    }
}

/// All works, computed here at the same time.
fn here<T: Kept>(
    works: &[Work<'_, T>],
    incomplete: bool,
) -> Result<Vec<Option<Nodes<T>>>, JobError> {
    let one = |number: u64| works[number as usize].here(incomplete).map(Some);
    match works.len() as u64 {
        1 => Ok(vec![one(0)?]),
        several => in_parallel(0..several, &one).into_iter().collect(),
    }
}
