//! Parts, checkpoints and merging: the same bits, and no error without its name.

use std::{
    fs,
    path::Path,
    sync::atomic::{AtomicU64, Ordering},
    time::Duration,
};

use mc::{
    Kept, Ladder, Measured, Run, Statistic, View, bind,
    parts::{Job, JobError, Program, Share, Stop, merged_paths, remove},
};
use noise::{StreamKey, Truncation};
use schemes::{EulerMaruyama, Heun, Scheme};
use serde::{Deserialize, Serialize};
use systems::{Constant, Damping, Pendulum, Problem};

use crate::ladder::on_threads;

type Pendulums = Problem<Pendulum, Constant, 2>;

fn pendulum(c: f64) -> Pendulums {
    Problem::new(Pendulum::new(c).unwrap(), Constant::new(0.5).unwrap(), [0.2, 1.0], 1.0).unwrap()
}

/// A scheme on its problem in so many steps.
fn ladder<'a, G: Damping>(
    problem: &'a Problem<Pendulum, G, 2>,
    scheme: &'a dyn Scheme<Pendulum, 2, 1>,
    steps: u64,
    seed: u64,
) -> Ladder<'a> {
    let (truncation, key) = (Truncation::new(4).unwrap(), StreamKey { seed, experiment: 5 });
    let runs = vec![Run::new(bind(problem, scheme), 0)];
    Ladder::new(&mc::Problem::of(problem), steps, 3, truncation, key, runs).unwrap()
}

/// Σ cos(ωy₁) + y₂³: a sum whose rounding depends on the order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Sums {
    sum: f64,
    least: f64,
    blocks: Vec<u64>,
}

struct Sum {
    frequency: f64,
    sums: Sums,
}

impl Sum {
    fn new(frequency: f64) -> Self {
        Self { frequency, sums: Sums { sum: 0.0, least: f64::INFINITY, blocks: Vec::new() } }
    }
}

impl Statistic for Sum {
    fn observe(&mut self, view: &View<'_>) {
        for p in view.live.paths() {
            let [q, p] = view.path(0, p);
            self.sums.sum += real::elementary::cos(self.frequency * q) + p * p * p;
            self.sums.least = self.sums.least.min(p);
        }
        self.sums.blocks.push(view.first_path);
    }

    fn merge(&mut self, later: Self) {
        self.sums.sum += later.sums.sum;
        self.sums.least = self.sums.least.min(later.sums.least);
        self.sums.blocks.extend(later.sums.blocks);
    }
}

impl Kept for Sum {
    type Sums = Sums;
    fn sums(&self) -> &Sums {
        &self.sums
    }
    fn sums_mut(&mut self) -> &mut Sums {
        &mut self.sums
    }
}

/// What makes a study.
#[derive(Clone, Copy)]
struct Study {
    c: f64,
    frequency: f64,
    seed: u64,
    paths: u64,
    heun: bool,
    version: &'static str,
}

const STUDY: Study =
    Study { c: 1.0, frequency: 3.0, seed: 1, paths: 128 * 150 + 17, heun: true, version: "1" };

impl Study {
    fn program(self) -> Program {
        Program { name: "test".into(), version: self.version.into(), input: String::new() }
    }

    fn part(self, folder: &Path, number: u64, of: u64) -> Result<Job, JobError> {
        Job::part(folder, Share::new(number, of)?, self.program())
    }

    fn run(self, job: Job) -> Result<Option<Sums>, JobError> {
        self.run_with(job, &|_| ())
    }

    fn run_with(self, job: Job, progress: &(dyn Fn(u64) + Sync)) -> Result<Option<Sums>, JobError> {
        let sums = self.run_as(&job, "sum", progress);
        job.finish().map(|()| sums)
    }

    fn run_as(self, job: &Job, name: &str, progress: &(dyn Fn(u64) + Sync)) -> Option<Sums> {
        let problem = pendulum(self.c);
        let scheme: &dyn Scheme<Pendulum, 2, 1> = if self.heun { &Heun } else { &EulerMaruyama };
        let ladder = ladder(&problem, scheme, 8, self.seed).telling(progress);
        let new = || Sum::new(self.frequency);
        let found = ladder.run_in(job, name, self.paths, new);
        found.map(|measured: Measured<Sum>| measured.statistic.sums)
    }

    fn here(self) -> Sums {
        self.run(Job::here()).unwrap().unwrap()
    }

    fn merged(self, folder: &Path) -> Result<Sums, JobError> {
        Ok(self.run(Job::merge(folder, self.program())?)?.unwrap())
    }

    /// And what progress was told of.
    fn counted(self, job: Job) -> (Option<Sums>, u64) {
        let computed = AtomicU64::new(0);
        let count = |work| _ = computed.fetch_add(work, Ordering::Relaxed);
        (self.run_with(job, &count).unwrap(), computed.into_inner())
    }

    /// The path-steps of all groups.
    fn work(self) -> u64 {
        self.paths.div_ceil(128) * 128 * 8
    }

    /// Runs parts, in this order.
    fn run_parts(self, folder: &Path, numbers: impl IntoIterator<Item = u64>, of: u64) {
        for number in numbers {
            assert_eq!(self.run(self.part(folder, number, of).unwrap()).unwrap(), None);
        }
    }
}

fn message<T>(result: Result<T, JobError>) -> String {
    result.err().expect("an error").to_string()
}

#[test]
#[ignore = "long: run by the gate"]
fn any_number_of_parts_in_any_order_on_any_threads_gives_the_same_bits() {
    let whole = STUDY.here();
    assert_eq!(whole.blocks.len() as u64, STUDY.paths.div_ceil(32));
    for of in [1, 2, 7, 64, 200] {
        let folder = tempfile::tempdir().unwrap();
        for n in 1..=of {
            // Another order: multiples of a number without a common factor.
            let number = n * 11 % of + 1;
            let part = STUDY.part(folder.path(), number, of).unwrap();
            let sums = on_threads(1 + n as usize % 2, || STUDY.run(part)).unwrap();
            assert_eq!(sums.is_some(), of == 1);
        }
        assert_eq!(STUDY.merged(folder.path()).unwrap(), whole, "{of}");
        // Again, now from what was merged.
        assert_eq!(STUDY.merged(folder.path()).unwrap(), whole, "{of}");
    }
}

#[test]
fn a_part_that_was_stopped_goes_on_where_it_was() {
    let whole = STUDY.here();
    let folder = tempfile::tempdir().unwrap();
    let (mut stops, mut steps) = (0, 0);
    for number in [1, 2] {
        loop {
            let (stop, done) = (Stop::default(), AtomicU64::new(0));
            let job = STUDY.part(folder.path(), number, 2).unwrap().stopped_by(&stop);
            let computed = AtomicU64::new(0);
            let result = STUDY.run_with(job, &|work| {
                // The first report is of what was done before.
                if done.fetch_add(work, Ordering::Relaxed) > 0 || work == 1024 {
                    computed.fetch_add(work, Ordering::Relaxed);
                }
                if computed.load(Ordering::Relaxed) > 40 * 1024 {
                    stop.now();
                }
            });
            steps += done.load(Ordering::Relaxed);
            match result {
                Ok(sums) => break assert_eq!(sums, None),
                Err(error) => assert!(matches!(error, JobError::Stopped), "{error}"),
            }
            let missing = message(STUDY.merged(folder.path()));
            assert!(missing.ends_with(["=1-2", "=2"][number as usize - 1]), "{missing}");
            stops += 1;
        }
    }
    assert!(stops >= 2 && steps > 0);
    assert_eq!(STUDY.merged(folder.path()).unwrap(), whole);
}

#[test]
fn a_run_with_checkpoints_gives_its_result_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let whole = || STUDY.part(folder.path(), 1, 1).unwrap();
    let job = whole().with_checkpoints_every(Duration::ZERO);
    assert_eq!(STUDY.run(job).unwrap(), Some(STUDY.here()));
    // And again without computing: one report, of what was done before.
    assert_eq!(STUDY.counted(whole()), (Some(STUDY.here()), STUDY.work()));
}

#[test]
fn a_checkpoint_that_cannot_be_written_is_an_error_of_the_job() {
    let folder = tempfile::tempdir().unwrap();
    let job = STUDY.part(folder.path(), 1, 1).unwrap().with_checkpoints_every(Duration::ZERO);
    fs::remove_dir_all(folder.path()).unwrap();
    fs::write(folder.path(), "").unwrap();
    // All paths were computed: a checkpoint in between that fails does not end the job.
    assert!(matches!(STUDY.run(job), Err(JobError::File { action: "write", .. })));
    fs::remove_file(folder.path()).unwrap();
}

#[test]
fn missing_parts_are_listed_and_can_be_added() {
    let folder = tempfile::tempdir().unwrap();
    STUDY.run_parts(folder.path(), [1, 3, 4, 5, 9, 12], 12);
    let stop = Stop::default();
    stop.now();
    let incomplete = STUDY.part(folder.path(), 10, 12).unwrap().stopped_by(&stop);
    assert!(matches!(STUDY.run(incomplete), Err(JobError::Stopped)));
    let missing = message(STUDY.merged(folder.path()));
    assert!(missing.ends_with("--array=2,6-8,10-11"), "{missing}");
    STUDY.run_parts(folder.path(), [2, 6, 7, 8, 10, 11], 12);
    assert_eq!(STUDY.merged(folder.path()).unwrap(), STUDY.here());
}

#[test]
fn an_extended_study_has_the_bits_of_one_planned_so() {
    let folder = tempfile::tempdir().unwrap();
    // Its last group is not full.
    let small = Study { paths: 128 * 50 - 3, ..STUDY };
    small.run_parts(folder.path(), 1..=3, 3);
    assert_eq!(small.merged(folder.path()).unwrap(), small.here());
    // Before the parts ran again, the extension is not there.
    let early = message(STUDY.merged(folder.path()));
    assert!(early.ends_with("--array=1-3"), "{early}");
    STUDY.run_parts(folder.path(), 1..=5, 5);
    assert_eq!(STUDY.merged(folder.path()).unwrap(), STUDY.here());
    // A part that comes late has nothing to do: one report, of what was done before.
    let late = STUDY.part(folder.path(), 2, 3).unwrap();
    assert_eq!(STUDY.counted(late), (Some(STUDY.here()), STUDY.work()));
    // The small one is no longer there.
    let again = small.part(folder.path(), 2, 3).and_then(|job| small.run(job));
    for refused in [message(small.merged(folder.path())), message(again)] {
        let words = "a number of paths 19217 of sum\nand here is\n  a number of paths 6397";
        assert!(refused.contains(words), "{refused}");
    }
}

/// From any number of paths to any larger one, within the last group too, and again. Only groups
/// that were not full are computed again. Parts that are stopped go on.
#[test]
#[ignore = "long: run by the gate"]
fn any_number_of_paths_can_be_extended() {
    let series: [&[u64]; 4] =
        [&[1, 2, 127, 128, 129], &[1, 3000], &[127, 3000, 3050, 5000], &[3000, 3072]];
    for (numbers, of) in series.into_iter().flat_map(|numbers| [(numbers, 3), (numbers, 7)]) {
        let (folder, stops) = (tempfile::tempdir().unwrap(), of == 7);
        let mut known = 0;
        for &paths in numbers {
            let study = Study { paths, ..STUDY };
            let computed = AtomicU64::new(0);
            let part = |number, stops: bool| {
                let (stop, reports) = (Stop::default(), AtomicU64::new(0));
                let job = study.part(folder.path(), number, of).unwrap().stopped_by(&stop);
                study.run_with(job, &|work| {
                    // The first report is of what was done before.
                    if reports.fetch_add(1, Ordering::Relaxed) > 0 {
                        computed.fetch_add(work, Ordering::Relaxed);
                        if stops {
                            stop.now();
                        }
                    }
                })
            };
            for number in 1..=of {
                if stops {
                    let stopped = (part(number, true), part(number, true));
                    let is_fine = |found: &Result<_, JobError>| {
                        found.as_ref().err().is_none_or(|e| matches!(e, JobError::Stopped))
                    };
                    assert!(is_fine(&stopped.0) && is_fine(&stopped.1), "{stopped:?}");
                }
                part(number, false).unwrap();
            }
            assert_eq!(study.merged(folder.path()).unwrap(), study.here(), "{paths} in {of}");
            assert_eq!(merged_paths(folder.path(), &study.program()).unwrap()["sum"], paths);
            let new = (paths - known / 128 * 128) * 8;
            let computed = computed.into_inner();
            assert!(computed == new || (stops && computed > new), "{computed} {new}");
            known = paths;
        }
        // Missing parts are named, though the files of smaller studies are there.
        let more = Study { paths: 9000, ..STUDY };
        more.run_parts(folder.path(), [2], of);
        let missing = message(more.merged(folder.path()));
        assert!(missing.ends_with(if of == 3 { "=1,3" } else { "=1,3-7" }), "{missing}");
    }
}

#[test]
fn parts_of_another_study_are_refused_by_name() {
    let fingerprint = "it has\n  the fingerprint";
    let changes: [(Study, &str); 6] = [
        (Study { seed: 2, ..STUDY }, fingerprint),
        (Study { c: 1.0 + 1e-15, ..STUDY }, fingerprint),
        (Study { heun: false, ..STUDY }, fingerprint),
        (Study { frequency: 3.0 + 1e-13, ..STUDY }, fingerprint),
        (
            Study { paths: 999, ..STUDY },
            "a number of paths 999 of sum\nand here is\n  a number of paths 19217",
        ),
        (Study { version: "0.9", ..STUDY }, "it has\n  test 0.9\nand here is\n  test 1\n"),
    ];
    for (other, why) in changes {
        let folder = tempfile::tempdir().unwrap();
        STUDY.run_parts(folder.path(), [1], 2);
        other.run_parts(folder.path(), [2], 2);
        let refused = message(STUDY.merged(folder.path()));
        assert!(refused.contains(why) && refused.contains("part-2-of-2.bin"), "{refused}");
        // Nor does a part go on from it, or write over it.
        let before = fs::read(folder.path().join("part-2-of-2.bin")).unwrap();
        let refused = message(STUDY.part(folder.path(), 2, 2).and_then(|job| STUDY.run(job)));
        assert!(refused.contains(why), "{refused}");
        assert_eq!(fs::read(folder.path().join("part-2-of-2.bin")).unwrap(), before);
    }
}

#[test]
fn parts_of_two_numbers_of_parts_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    STUDY.run_parts(folder.path(), 1..=2, 2);
    STUDY.run_parts(folder.path(), [1], 3);
    let refused = message(STUDY.merged(folder.path()));
    assert!(refused.contains("a number of parts"), "{refused}");
    let folder = tempfile::tempdir().unwrap();
    STUDY.run_parts(folder.path(), 1..=2, 2);
    let copy = folder.path().join("part-2-of-2-copy.bin");
    fs::copy(folder.path().join("part-2-of-2.bin"), copy).unwrap();
    let refused = message(STUDY.merged(folder.path()));
    assert!(refused.contains("both have paths") && refused.contains("copy"), "{refused}");
}

/// Files of a larger array that never began do not count, and temporary ones of a killed process
/// are removed.
#[test]
fn what_others_left_in_the_folder_does_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    drop(STUDY.part(folder.path(), 9, 64).unwrap());
    let left = folder.path().join(".part-1-of-3.bin.x1Yz.casimir");
    fs::write(&left, "half of a checkp").unwrap();
    let swap = folder.path().join(".part-1-of-3.bin.swp");
    fs::write(&swap, "an editor's").unwrap();
    STUDY.run_parts(folder.path(), [1, 3], 3);
    assert!(!left.exists() && swap.exists());
    let missing = message(STUDY.merged(folder.path()));
    assert!(missing.ends_with("--array=2"), "{missing}");
    STUDY.run_parts(folder.path(), [2], 3);
    assert_eq!(STUDY.merged(folder.path()).unwrap(), STUDY.here());
}

#[test]
#[should_panic(expected = "inner was begun inside another")]
fn work_inside_other_work_is_an_error_and_not_a_deadlock() {
    let job = Job::here();
    let problem = pendulum(1.0);
    let ladder = ladder(&problem, &Heun, 8, 1);
    let inner = |_| drop(ladder.run_in(&job, "inner", 1, || Sum::new(1.0)));
    let outer = self::ladder(&problem, &Heun, 8, 1).telling(inner);
    outer.run_in(&job, "outer", 1, || Sum::new(1.0)).unwrap();
}

#[test]
fn damaged_files_are_named() {
    let folder = tempfile::tempdir().unwrap();
    STUDY.run_parts(folder.path(), 1..=2, 2);
    let file = folder.path().join("part-2-of-2.bin");
    let good = fs::read(&file).unwrap();
    let middle = good.len() / 2;
    let mut flipped = good.clone();
    flipped[middle] = if flipped[middle] == b'A' { b'B' } else { b'A' };
    let cut = good[..middle].to_vec();
    for bad in [flipped, cut, Vec::new(), b"{}".to_vec()] {
        fs::write(&file, &bad).unwrap();
        let refused = message(STUDY.merged(folder.path()));
        assert!(refused.contains("part-2-of-2.bin is damaged"), "{refused}");
        assert!(message(STUDY.part(folder.path(), 2, 2)).contains("damaged"));
        assert_eq!(fs::read(&file).unwrap(), bad);
    }
    fs::remove_file(&file).unwrap();
    STUDY.run_parts(folder.path(), [2], 2);
    assert_eq!(STUDY.merged(folder.path()).unwrap(), STUDY.here());
    assert_eq!(fs::read(&file).unwrap(), good);
}

#[test]
fn folders_that_are_none_and_parts_that_run_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "text").unwrap();
    assert!(message(STUDY.part(&file, 1, 2)).contains("cannot create the folder"));
    assert!(message(STUDY.merged(folder.path())).contains("there are no parts in"));
    assert!(message(STUDY.merged(&folder.path().join("nowhere"))).contains("cannot read"));
    assert!(message(STUDY.part(folder.path(), 3, 2)).contains("no part 3 of 2"));
    let first = STUDY.part(folder.path(), 1, 2).unwrap();
    let refused = message(STUDY.part(folder.path(), 1, 2));
    assert!(refused.contains("part 1 of 2") && refused.contains("process"), "{refused}");
    assert!(STUDY.part(folder.path(), 2, 2).is_ok());
    drop(first);
    assert!(STUDY.part(folder.path(), 1, 2).is_ok());
}

/// A statistic with a field that does not come back.
#[derive(Default, Serialize, Deserialize)]
struct Forgetful {
    #[serde(skip)]
    sum: f64,
    count: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    most: Option<f64>,
}

impl Statistic for Forgetful {
    fn observe(&mut self, _: &View<'_>) {
        self.sum += 1.0;
        self.count = Some(self.sum as u64);
    }
    fn merge(&mut self, later: Self) {
        self.sum += later.sum;
    }
}

impl Kept for Forgetful {
    type Sums = Self;
    fn sums(&self) -> &Self {
        self
    }
    fn sums_mut(&mut self) -> &mut Self {
        self
    }
}

#[test]
fn sums_that_do_not_come_back_and_names_given_twice_are_errors() {
    let problem = pendulum(1.0);
    let ladder = ladder(&problem, &Heun, 8, 1);
    let folder = tempfile::tempdir().unwrap();
    let job = STUDY.part(folder.path(), 1, 1).unwrap();
    assert!(ladder.run_in(&job, "none", 500, Forgetful::default).is_none());
    let error = message(job.finish());
    assert!(error.contains("cannot be written and read back"), "{error}");

    let job = Job::here();
    let sum = || Sum::new(1.0);
    assert!(ladder.run_in(&job, "sum", 500, sum).is_some());
    assert!(ladder.run_in(&job, "sum", 500, sum).is_none());
    assert!(message(job.finish()).contains("two pieces of work have the name \"sum\""));
}

#[test]
fn a_run_that_is_stopped_between_two_works_keeps_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let whole = || STUDY.part(folder.path(), 1, 1).unwrap();
    let stop = Stop::default();
    let job = whole().stopped_by(&stop);
    assert!(!job.resumes() && STUDY.run_as(&job, "first", &|_| ()).is_some());
    stop.now();
    assert_eq!(STUDY.run_as(&job, "second", &|_| ()), None);
    assert!(matches!(job.finish(), Err(JobError::Stopped)));
    let job = whole();
    assert!(job.resumes());
    let reports = AtomicU64::new(0);
    let count = |_| _ = reports.fetch_add(1, Ordering::Relaxed);
    assert_eq!(STUDY.run_as(&job, "first", &count), Some(STUDY.here()));
    assert_eq!(reports.into_inner(), 1);
    drop(job);
    remove(folder.path(), Share::WHOLE).unwrap();
    remove(folder.path(), Share::WHOLE).unwrap();
    assert!(!whole().resumes());
}

#[test]
fn a_plan_says_how_long_parts_take() {
    let job = Job::pilot(Duration::from_millis(10));
    assert_eq!(STUDY.run_as(&job, "sum", &|_| ()), None);
    let plan = job.plan().unwrap();
    let [sum] = &plan[..] else { panic!("{plan:?}") };
    assert_eq!((sum.paths, sum.steps, sum.groups), (STUDY.paths, 8, STUDY.paths.div_ceil(128)));
    assert!(sum.seconds > 0.0);
    for of in [1, 7, 64] {
        let [one, two] = [1, 2].map(|threads| sum.seconds(of, threads) / sum.seconds);
        let groups = sum.groups.div_ceil(of);
        assert_eq!([one.round() as u64, two.round() as u64], [groups, groups.div_ceil(2)]);
    }
}

/// Counts the steps that ask for it.
struct Counting(AtomicU64);

impl Damping for Counting {
    fn rate(&self, _: f64) -> f64 {
        0.0
    }
    fn integral(&self, _: f64, _: f64) -> f64 {
        self.0.fetch_add(1, Ordering::Relaxed);
        0.0
    }
    fn describe(&self) -> String {
        "none".into()
    }
}

#[test]
fn a_long_path_is_not_computed_twice_to_tell_it_from_others() {
    let folder = tempfile::tempdir().unwrap();
    // More steps than are kept in a table.
    let steps = 1 << 15;
    let asked = |job: Job| {
        let damping = Counting(AtomicU64::new(0));
        let problem = Problem::new(Pendulum::new(1.0).unwrap(), &damping, [0.2, 1.0], 1.0).unwrap();
        ladder(&problem, &Heun, steps, 1).run_in(&job, "sum", 32, || Sum::new(3.0)).unwrap();
        job.finish().unwrap();
        damping.0.load(Ordering::Relaxed) as f64
    };
    let kept = asked(STUDY.part(folder.path(), 1, 1).unwrap());
    assert!(kept < 1.1 * asked(Job::here()), "{kept} integrals for {steps} steps");
}
