//! A run of a program: whole, one part of it, or the merging of parts.

use std::{
    collections::BTreeSet,
    error::Error,
    fs,
    ops::Range,
    path::Path,
    sync::{Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use noise::StreamKey;
use serde::{Serialize, de::DeserializeOwned};

use super::{
    Fingerprint, Hash, JobError, Program, Share, Stop,
    compute::Computing,
    file::{Header, file_error, foreign},
    merging::Merging,
    plan::{Pilot, Plan},
};
use crate::{
    driver::GROUP_PATHS,
    parallel::{grow, in_parallel},
    tree::{MergeTree, Node},
};

/// How often a checkpoint is written, unless said otherwise.
const INTERVAL: Duration = Duration::from_secs(60);

/// Rounds of samples of at most so many path-steps, about a second, are drawn by every part.
const ALONE: u64 = 1 << 27;

/// What a program does with its Monte Carlo work: compute it here, compute one part, or merge.
///
/// A job that met an error computes nothing more; [`finish`](Self::finish) says what it was.
#[must_use = "a job is written and its errors are told by `finish`"]
pub struct Job {
    stop: Stop,
    interval: Duration,
    alone: u64,
    /// Whether work that was stopped gives the result of what is done.
    incomplete: bool,
    state: Mutex<State>,
    /// Work that was begun inside another.
    nested: Mutex<Option<String>>,
}

/// How a job ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Every piece of work gave its result.
    Complete,
    /// This part is complete; results come when all parts are merged.
    Part(Share),
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
    Part(Computing),
    Merge(Merging),
    /// A little of everything is computed, and forgotten.
    Plan(Pilot),
}

/// What becomes of sums on their way to bytes and back.
pub(crate) type Packing<T> = Result<T, Box<dyn Error>>;

/// A piece of work: groups of paths of a ladder, and how their sums become bytes and come back.
pub(crate) struct Work<'a, T> {
    pub name: &'a str,
    /// Path-steps, if later work follows from its result: then it is computed here, whatever the
    /// job is, unless it is worth a round of parts.
    pub round: Option<u64>,
    /// Is not asked for where nothing is written or read.
    pub fingerprint: &'a (dyn Fn() -> Fingerprint + Sync),
    pub key: StreamKey,
    /// Paths of the whole.
    pub paths: u64,
    pub groups: Range<u64>,
    /// Steps of a path; 0 where work is not counted in steps.
    pub steps: u64,
    pub pack: &'a (dyn Fn(&T) -> Packing<Vec<u8>> + Sync),
    pub unpack: &'a (dyn Fn(&[u8]) -> Packing<T> + Sync),
    pub merge: &'a (dyn Fn(&mut T, T) + Sync),
    /// The sums of no group.
    pub empty: &'a (dyn Fn() -> T + Sync),
    /// The sums of a group, or `None` if it was stopped.
    pub compute: &'a (dyn Fn(u64) -> Option<T> + Sync),
    /// Is told how many groups need not be computed.
    pub skipped: &'a (dyn Fn(u64) + Sync),
}

impl<T: Send> Work<'_, T> {
    /// The nodes of all groups, computed here; of those that are done if it is stopped and
    /// `incomplete`.
    fn here(&self, incomplete: bool) -> Result<Option<Vec<Node<T>>>, JobError> {
        let mut tree = MergeTree::new(self.merge);
        let end = grow(&mut tree, self.groups.clone(), self.compute, &mut |_, _| true);
        if end == self.groups.end || incomplete {
            Ok(Some(tree.into_nodes()))
        } else {
            Err(JobError::Stopped)
        }
    }
}

impl<T> Work<'_, T> {
    /// An empty tree for its nodes. The last group stays apart if it is not full, since it is
    /// computed again when there are more paths.
    pub(super) fn tree(&self) -> MergeTree<T, impl Fn(&mut T, T) + Sync> {
        MergeTree::of_whole(self.merge, self.paths / GROUP_PATHS)
    }

    /// What a file says of these groups, of which it has none yet.
    pub(super) fn header(&self, groups: Range<u64>) -> Header {
        Header {
            fingerprint: (self.fingerprint)(),
            seed: self.key.seed,
            experiment: self.key.experiment,
            paths: self.paths,
            done: groups.start,
            groups,
        }
    }

    /// Whether a file has the same study, of any size.
    pub(super) fn check(&self, path: &Path, found: &Header) -> Result<(), JobError> {
        let Fingerprint { system, schemes, observed } = (self.fingerprint)();
        let pairs = [
            ("the seed", found.seed.to_string(), self.key.seed.to_string()),
            ("the experiment", found.experiment.to_string(), self.key.experiment.to_string()),
            ("the system with hash", found.fingerprint.system.clone(), system),
            ("schemes with hash", found.fingerprint.schemes.clone(), schemes),
            ("observables with hash", found.fingerprint.observed.clone(), observed),
        ];
        match pairs.into_iter().find(|(_, found, here)| found != here) {
            None => Ok(()),
            Some((what, found, here)) => Err(foreign(path, self.name, what, found, here)),
        }
    }
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
        Ok(Self::new(Mode::Part(Computing::open(folder, share, &program)?)))
    }

    /// Results come from the parts in `folder`.
    ///
    /// # Errors
    /// [`JobError`] if there are none, or a file cannot be read, is damaged, or is of another
    /// program.
    pub fn merge(folder: &Path, program: Program) -> Result<Self, JobError> {
        Ok(Self::new(Mode::Merge(Merging::open(folder, &program)?)))
    }

    /// Measures how long works take, on a few groups of each that take at least this long; with
    /// zero works are listed only. [`plan`](Self::plan) has the result.
    pub fn pilot(each: Duration) -> Self {
        Self::new(Mode::Plan(Pilot::new(each)))
    }

    fn new(mode: Mode) -> Self {
        let state = State { mode, error: None, names: BTreeSet::new() };
        let state = Mutex::new(state);
        let nested = Mutex::new(None);
        let (stop, incomplete) = (Stop::default(), false);
        Self { stop, interval: INTERVAL, alone: ALONE, incomplete, state, nested }
    }

    /// Divides the works of a plan so that all parts have about as many path-steps. Without it each
    /// work is divided into equal numbers of groups, which is as good where every work has many.
    ///
    /// All parts and the merge are given the plan of the same program with the same arguments,
    /// which needs no times: that of a [`pilot`](Self::pilot) of no duration.
    pub fn balanced(self, plan: &Plan) -> Self {
        match &mut self.state().mode {
            Mode::Here | Mode::Plan(_) => {}
            Mode::Part(computing) => computing.balance(plan),
            Mode::Merge(merging) => merging.balance(plan),
        }
        self
    }

    /// Ends early when `stop` asks for it, with a checkpoint.
    pub fn stopped_by(mut self, stop: &Stop) -> Self {
        self.stop = stop.clone();
        self
    }

    /// A study or ladder that is stopped gives the result of the paths that are done, not of part of
    /// several; an expectation the estimates of the rounds before. [`finish`](Self::finish) says [`JobError::Stopped`] all the same.
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
        matches!(&self.state().mode, Mode::Part(computing) if computing.resumes())
    }

    /// Whether results come from this job. They do not from one part of several or from a pilot,
    /// nor once it was stopped or has met an error: what is not a piece of work for parts need not
    /// be computed then.
    pub fn gives_results(&self) -> bool {
        let mut state = self.state();
        if state.error.is_none() && self.stop.is_asked() {
            state.error = Some(JobError::Stopped);
        }
        let whole = match &state.mode {
            Mode::Here | Mode::Merge(_) => true,
            Mode::Part(computing) => computing.is_whole(),
            Mode::Plan(_) => false,
        };
        whole && state.error.is_none()
    }

    /// Ends a [`pilot`](Self::pilot): what there is to compute, and how long it takes.
    ///
    /// # Errors
    /// The first error of the job.
    pub fn plan(self) -> Result<Plan, JobError> {
        match self.into_state() {
            State { error: Some(error), .. } => Err(error),
            State { mode: Mode::Plan(pilot), .. } => Ok(pilot.finish()),
            _ => Ok(Plan::default()),
        }
    }

    /// Ends the job: writes what is not written yet.
    ///
    /// # Errors
    /// [`JobError`]: the first error of the job, or [`JobError::Missing`], or
    /// [`JobError::NextRound`].
    pub fn finish(self) -> Result<Outcome, JobError> {
        let nested = self.nested.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(work) = nested {
            return Err(JobError::Nested(work));
        }
        let State { mode, error, .. } = self.into_state();
        match (error, mode) {
            (Some(JobError::Stopped), Mode::Part(computing)) => {
                computing.finish()?;
                Err(JobError::Stopped)
            }
            (Some(error), _) => Err(error),
            (None, Mode::Here | Mode::Plan(_)) => Ok(Outcome::Complete),
            (None, Mode::Part(computing)) => computing.finish(),
            (None, Mode::Merge(merging)) => merging.finish(),
        }
    }

    /// What ends this job early.
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn into_state(self) -> State {
        self.state.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Results that are numbered and have nothing to do with each other, such as answers for many
    /// seeds, as a piece of work: whole, in parts or merged. `None` as of
    /// [`Ladder::run_in`](crate::Ladder::run_in).
    ///
    /// `name` is unique in the program. `of` says in words or numbers what the tasks are given:
    /// results for another text are refused. `task` gives `None` if [`stop`](Self::stop) ended it.
    /// A checkpoint has whole tasks only, so they should take seconds. Results are kept as JSON,
    /// which has no word for NaN and infinity.
    pub fn tasks<T: Serialize + DeserializeOwned + Send>(
        &self,
        name: &str,
        of: &str,
        count: u64,
        task: impl Fn(u64) -> Option<T> + Sync,
    ) -> Option<Vec<T>> {
        let compute = |number| {
            if self.stop.is_asked() { None } else { task(number).map(|result| vec![result]) }
        };
        let nodes = self.collect(&Work {
            name,
            round: None,
            fingerprint: &|| Fingerprint {
                system: String::new(),
                schemes: String::new(),
                observed: Hash::default().with(of.as_bytes()).finish(),
            },
            key: StreamKey { seed: 0, experiment: 0 },
            // So that every number of tasks can be extended.
            paths: count * GROUP_PATHS,
            groups: 0..count,
            steps: 0,
            pack: &|results: &Vec<T>| Ok(serde_json::to_vec(results)?),
            unpack: &|bytes: &[u8]| Ok(serde_json::from_slice(bytes)?),
            merge: &Vec::extend,
            empty: &Vec::new,
            compute: &compute,
            skipped: &|_| (),
        })?;
        Some(nodes.into_iter().flat_map(|node| node.sum).collect())
    }

    /// The nodes of all groups of a piece of work, if they are known here: computed, or merged.
    pub(crate) fn collect<T: Send>(&self, work: &Work<'_, T>) -> Option<Vec<Node<T>>> {
        self.collect_all(std::slice::from_ref(work))?.pop()
    }

    /// The same of several pieces, none of which depends on another. They are all rounds or none.
    pub(crate) fn collect_all<T: Send>(&self, works: &[Work<'_, T>]) -> Option<Vec<Vec<Node<T>>>> {
        let Ok(mut state) = self.state.try_lock() else {
            // Waiting would be for ever: this thread may be at work on the other one.
            *self.nested.lock().unwrap_or_else(PoisonError::into_inner) =
                works.first().map(|work| work.name.into());
            return None;
        };
        let State { mode, error, names } = &mut *state;
        if error.is_some() {
            return None;
        }
        let is_small = |work: &Work<'_, T>| work.round.is_some_and(|cost| cost <= self.alone);
        // Later rounds follow from whole ones only.
        let incomplete = self.incomplete && works.iter().all(|work| work.round.is_none());
        let again = works.iter().find(|work| !names.insert(work.name.to_owned()));
        let found: Result<Vec<_>, _> = match mode {
            _ if let Some(work) = again => Err(JobError::SameName(work.name.to_owned())),
            Mode::Here => here(works, incomplete),
            Mode::Plan(pilot) if pilot.only_lists() => {
                Ok(works.iter().map(|work| pilot.list(work)).collect())
            }
            _ if works.iter().all(is_small) => here(works, false),
            Mode::Part(computing) => {
                let collect = |work| computing.collect(work, self.interval, incomplete);
                works.iter().map(collect).collect()
            }
            Mode::Merge(merging) => works.iter().map(|work| merging.collect(work)).collect(),
            Mode::Plan(pilot) => works.iter().map(|work| pilot.measure(work)).collect(),
        };
        let found = match found {
            Ok(found) => found.into_iter().collect(),
            Err(met) => {
                *error = Some(met);
                None
            }
        };
        if incomplete && self.stop.is_asked() {
            error.get_or_insert(JobError::Stopped);
        }
        found
    }
}

/// What becomes of each of these pieces where all are computed here.
fn here<T: Send>(
    works: &[Work<'_, T>],
    incomplete: bool,
) -> Result<Vec<Option<Vec<Node<T>>>>, JobError> {
    match works {
        [work] => Ok(vec![work.here(incomplete)?]),
        _ => {
            let one = |number: u64| works[number as usize].here(incomplete);
            in_parallel(0..works.len() as u64, &one).into_iter().collect()
        }
    }
}
