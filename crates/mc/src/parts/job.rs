//! A run of a program: whole, one part of it, the merging of parts, or a plan of it.

use std::{
    collections::BTreeSet,
    fmt, fs,
    path::Path,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread::available_parallelism,
    time::{Duration, Instant},
};

use super::{
    JobError, Program, Share,
    merging::Merging,
    part::{Part, UNFINISHED},
    work::Work,
};
use crate::{
    Checkpoint, Kept,
    checkpoint::file_error,
    ladder::{Nodes, merge},
    parallel::locked,
    tree::MergeTree,
};

/// The Monte Carlo work of a program: computed here, computed in part, or merged from parts.
///
/// A job that met an error computes nothing more; [`finish`](Self::finish) says what it was.
///
/// # Panics
/// When a piece of work is begun inside another: a job has one at a time.
#[must_use = "a job is written and its errors are told by `finish`"]
pub struct Job {
    stop: Stop,
    /// Whether work that was stopped gives the result of the paths that are done.
    incomplete: bool,
    state: Mutex<State>,
}

impl fmt::Debug for Job {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Job").finish_non_exhaustive()
    }
}

#[derive(Default)]
struct State {
    mode: Mode,
    error: Option<JobError>,
    /// Names of the pieces of work so far.
    names: BTreeSet<String>,
    /// Prefix of the names: the section.
    section: String,
}

#[derive(Default)]
enum Mode {
    /// Computes all work and writes nothing.
    #[default]
    Here,
    Part(Part),
    Merge(Merging),
    /// Measures groups of each piece of work for a duration, and drops their results.
    Plan(Duration, Vec<Planned>),
}

impl Job {
    /// A job that does all work here and writes nothing.
    pub fn here() -> Self {
        Self::new(Mode::Here)
    }

    /// A job that computes part `share` of all work in `folder`, which is created. If the folder
    /// has a checkpoint of this part, the job goes on from it. [`Share::WHOLE`] gives results at
    /// once: a run with checkpoints.
    ///
    /// # Errors
    /// [`JobError`] if the folder cannot be written, another process has this part, or the file of
    /// the part is damaged or of another program.
    pub fn part(folder: &Path, share: Share, program: Program) -> Result<Self, JobError> {
        fs::create_dir_all(folder).map_err(file_error("create the folder", folder))?;
        Ok(Self::new(Mode::Part(Part::open(folder, share, &program)?)))
    }

    /// A job that merges the parts in `folder`.
    ///
    /// # Errors
    /// [`JobError`] if there are none, or a file cannot be read, is damaged, or is of another
    /// program.
    pub fn merge(folder: &Path, program: Program) -> Result<Self, JobError> {
        Ok(Self::new(Mode::Merge(Merging::open(folder, &program)?)))
    }

    /// A job that measures how long works take, on a few groups of each that take `each` or more.
    /// [`plan`](Self::plan) has the result.
    pub fn pilot(each: Duration) -> Self {
        Self::new(Mode::Plan(each, Vec::new()))
    }

    fn new(mode: Mode) -> Self {
        let state = Mutex::new(State { mode, ..State::default() });
        Self { stop: Stop::default(), incomplete: false, state }
    }

    /// Lets `stop` end the job early, with a checkpoint.
    pub fn stopped_by(mut self, stop: &Stop) -> Self {
        self.stop = stop.clone();
        self
    }

    /// Lets work that is stopped give the result of the paths that are done, except in one part of
    /// several. [`finish`](Self::finish) says [`JobError::Stopped`] all the same.
    pub fn giving_what_is_done(mut self) -> Self {
        self.incomplete = true;
        self
    }

    /// Writes a checkpoint every `interval`, but for a fiftieth of the time at most; every two
    /// seconds by default.
    pub fn with_checkpoints_every(self, interval: Duration) -> Self {
        if let Mode::Part(part) = &mut locked(&self.state).mode {
            part.file.kept.interval = interval;
        }
        self
    }

    /// Begins a section: the names of works begin with that of their section from now on.
    pub fn section(&self, name: &str) {
        name.clone_into(&mut locked(&self.state).section);
    }

    /// Whether this job goes on from a checkpoint.
    pub fn resumes(&self) -> bool {
        matches!(&locked(&self.state).mode, Mode::Part(part) if part.resumes)
    }

    /// Whether all work is done here, and not in parts.
    pub fn is_whole(&self) -> bool {
        match &locked(&self.state).mode {
            Mode::Here => true,
            Mode::Part(part) => part.is_whole(),
            _ => false,
        }
    }

    /// A checkpoint of work that is not of groups of paths, in the folder of this job if it has
    /// one: `name` makes it another than that of other such work. [`remove`](super::remove) takes
    /// it away.
    pub fn checkpoint(&self, name: &str) -> Option<Checkpoint> {
        let Mode::Part(part) = &locked(&self.state).mode else { return None };
        Some(part.file.kept.beside(&format!("{UNFINISHED}{name}.bin")))
    }

    /// Ends a [`pilot`](Self::pilot), and returns the pieces of work with the time that they take.
    ///
    /// # Errors
    /// The first error of the job.
    pub fn plan(self) -> Result<Vec<Planned>, JobError> {
        match self.end() {
            State { error: Some(error), .. } => Err(error),
            State { mode: Mode::Plan(_, works), .. } => Ok(works),
            _ => Ok(Vec::new()),
        }
    }

    /// Ends the job, and writes results that are not written yet.
    ///
    /// # Errors
    /// [`JobError`]: the first error of the job, or [`JobError::Missing`]. [`JobError::File`] if
    /// the checkpoint cannot be written; results of [`Share::WHOLE`] that the program has are
    /// valid.
    pub fn finish(self) -> Result<(), JobError> {
        let State { error, mode, .. } = self.end();
        let stopped = matches!(error, None | Some(JobError::Stopped));
        let written = match mode {
            Mode::Part(part) if stopped => part.file.write(),
            Mode::Merge(merging) if error.is_none() => merging.finish(),
            _ => Ok(()),
        };
        written.and(error.map_or(Ok(()), Err))
    }

    fn end(self) -> State {
        self.state.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// The flag that ends this job early.
    pub fn stop(&self) -> &Stop {
        &self.stop
    }

    /// The nodes of all groups of a piece of work, if they are known here: computed, or merged.
    pub(crate) fn collect<T: Kept>(&self, work: Work<'_, T>) -> Option<Nodes<T>> {
        // Waiting would be for ever: this thread may be at work on the other one.
        let state = self.state.try_lock();
        let mut state = state
            .unwrap_or_else(|_| panic!("{} was begun inside another piece of work", work.name));
        let State { mode, error, names, section } = &mut *state;
        if error.is_some() {
            return None;
        }
        let name = format!("{section}{}", work.name);
        let work = &Work { name: &name, ..work };
        let is_new = names.insert(name.clone());
        let found = match mode {
            _ if !is_new => {
                Err(JobError::Refused(format!("two pieces of work have the name {:?}", work.name)))
            }
            Mode::Here => {
                let mut tree = work.tree();
                let end = work.grow(&mut tree, 0..work.groups(), &mut |_, _| true);
                let done = end == work.groups() || self.incomplete;
                done.then(|| Some(tree.nodes)).ok_or(JobError::Stopped)
            }
            Mode::Part(part) => part.collect(work, self.incomplete),
            Mode::Merge(merging) => merging.collect(work),
            Mode::Plan(each, works) => measure(*each, work).map(|planned| {
                works.push(planned);
                None
            }),
        };
        if self.incomplete && self.stop.is_asked() {
            *error = Some(JobError::Stopped);
        }
        found.unwrap_or_else(|met| {
            *error = Some(met);
            None
        })
    }
}

/// Largest number of threads that may be asked for: nearly no machine has more processors.
const MAX_THREADS: u64 = 1024;
/// Largest number of threads for each processor: more only wait for each other.
const THREADS_EACH: usize = 4;

/// Limits the threads of everything that is computed from now on in this process, to four for each
/// processor in any case.
///
/// # Errors
/// [`JobError::Argument`] for no thread or more than 1024, or if work has begun already.
pub fn limit_threads(threads: u64) -> Result<(), JobError> {
    let most = THREADS_EACH * available_parallelism().map_or(1, usize::from);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(most.min(threads as usize));
    let limited = match threads {
        0 => Err("at least one is needed".into()),
        1..=MAX_THREADS => pool.build_global().map_err(|error| error.to_string()),
        _ => Err(format!("{MAX_THREADS} are the most")),
    };
    limited
        .map_err(|why| JobError::Argument(format!("cannot compute with {threads} threads: {why}")))
}

/// A piece of work before it is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// Name of the piece of work.
    pub name: String,
    /// Number of paths.
    pub paths: u64,
    /// Number of steps of a path.
    pub steps: u64,
    /// Number of groups of paths, which are divided among parts.
    pub groups: u64,
    /// Seconds of a group on one thread, while all threads are busy.
    pub seconds: f64,
}

impl Planned {
    /// Seconds that the longest of `parts` parts takes. Groups are computed by all threads at a
    /// time; the last ones leave some idle.
    pub fn seconds(&self, parts: u64, threads: u64) -> f64 {
        self.groups.div_ceil(parts).div_ceil(threads) as f64 * self.seconds
    }
}

/// Measures groups of a piece of work for the duration `each`, at least one; drops their results.
fn measure<T: Kept>(each: Duration, work: &Work<'_, T>) -> Result<Planned, JobError> {
    let (groups, threads) = (work.groups(), rayon::current_num_threads() as u64);
    let (mut tree, start) = (MergeTree::new(merge), Instant::now());
    let done = work.grow(&mut tree, 0..groups, &mut |_, _| start.elapsed() < each);
    if work.stop.is_asked() {
        return Err(JobError::Stopped);
    }
    let each_thread = threads.min(done) as f64 / done.max(1) as f64;
    Ok(Planned {
        name: work.name.to_owned(),
        paths: work.paths,
        steps: work.ladder.steps_per_path(),
        groups,
        seconds: start.elapsed().as_secs_f64() * each_thread,
    })
}

/// A flag that ends a computation at the next step. Results of complete groups of paths are
/// conserved.
///
/// Signals are the program's: a library installs no handler. With the crate `ctrlc`, and its
/// feature `termination` for SIGTERM, which Slurm sends when the time of a job is up, a program
/// ends with a checkpoint by
///
/// ```
/// # fn main() -> Result<(), ctrlc::Error> {
/// let stop = mc::parts::Stop::default();
/// let asked = stop.clone();
/// ctrlc::set_handler(move || asked.now())?;
/// // job.stopped_by(&stop)
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, Default)]
pub struct Stop {
    asked: Arc<AtomicBool>,
    end: Option<Instant>,
}

impl Stop {
    /// A copy of the flag that also sets itself `seconds` from now.
    #[must_use]
    pub fn within(&self, seconds: f64) -> Self {
        let time = Duration::try_from_secs_f64(seconds.max(0.0)).ok();
        Self { end: time.and_then(|time| Instant::now().checked_add(time)), ..self.clone() }
    }

    /// Asks for the end.
    pub fn now(&self) {
        self.asked.store(true, Ordering::Relaxed);
    }

    /// Whether the end was asked for.
    pub fn is_asked(&self) -> bool {
        self.asked.load(Ordering::Relaxed) || self.end.is_some_and(|end| end <= Instant::now())
    }
}
