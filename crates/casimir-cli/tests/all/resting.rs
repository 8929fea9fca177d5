//! Paths that an event stopped, or that failed, make no more steps.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use casimir::{
    mc::{Simulation, TimeSeries},
    noise::StepNoise,
    nonlin::BlockStatus,
    real::{Row, WIDTH},
    schemes::{About, Method, Step, Stepper},
    study::{Study, StudyResult, StudySettings},
};
use scenes::{Changes, Scene, Source};

const STEPS: u64 = 64;

/// q moves at speed one with noise, and stops beyond ¼; p is constant.
fn scene(sigma: f64, more: &str) -> Scene {
    let text = format!(
        "[system]\nstate = [\"q\", \"p\"]\nB = \"canonical\"\nH0 = \"p\"\nH = [\"{sigma}*p\"]\n\
         [run]\ninitial = [0, 0]\nuntil = 1\nsteps = {STEPS}\n[observe]\nway = \"integral(q)\"\n\
         [events]\nout = {{ when = \"q > 0.25\", stop = true }}\nfar = \"q > 0.3\"\n{more}"
    );
    let source = Source::new("test", text);
    Scene::new(source, &Changes::default()).expect("a scene")
}

/// A method that counts its steps, and fails from beyond a place.
struct Counting<'a> {
    method: Arc<dyn Method + 'a>,
    fails_beyond: f64,
    steps: &'a AtomicU64,
}

struct Counted<'a> {
    inner: Box<dyn Stepper + 'a>,
    of: &'a Counting<'a>,
}

impl Method for Counting<'_> {
    fn about(&self) -> About {
        About::new(self.method.about().id)
    }
    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        Box::new(Counted { inner: self.method.start(y), of: self })
    }
}

impl Stepper for Counted<'_> {
    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        self.of.steps.fetch_add(1, Ordering::Relaxed);
        let q = self.inner.state()[0];
        self.inner.step(step, noise, status);
        let beyond = (0..WIDTH).filter(|&p| q[p] > self.of.fails_beyond);
        beyond.for_each(|p| status.failed.insert(p));
    }
    fn state(&self) -> &[Row] {
        self.inner.state()
    }
    fn state_mut(&mut self) -> &mut [Row] {
        self.inner.state_mut()
    }
}

/// What 256 paths give, the tables of the first 32, and how many steps the study took.
fn found(scene: &Scene, fails_beyond: f64) -> (StudyResult, Vec<TimeSeries>, u64) {
    let steps = AtomicU64::new(0);
    let mut setup = scene.setup("heun").unwrap();
    setup.scheme = Arc::new(Counting { method: setup.scheme, fails_beyond, steps: &steps });
    let setup = scene.collecting(setup);
    let (truncation, key) = (scene.settings.truncation, scene.settings.key);
    let settings = StudySettings::new(STEPS, 16, 256, truncation, key);
    let study = Study::new(&setup, &scene.observables, &settings).unwrap();
    let before = steps.load(Ordering::Relaxed);
    let result = study.run();
    let taken = steps.load(Ordering::Relaxed) - before;
    let mut simulation = Simulation::new(setup, truncation);
    for observable in &scene.observables[..5] {
        simulation = simulation.observing(observable.clone());
    }
    (result, simulation.paths(STEPS, key, 0..32).unwrap(), taken)
}

#[test]
fn a_block_of_stopped_paths_makes_no_step_and_collects_on() {
    let scene = scene(0.0, "late = \"t > 0.9\"\n");
    let (result, tables, steps) = found(&scene, f64::INFINITY);
    // They stop at ¼, within step 17.
    let (blocks, stop) = (8, 0.25);
    assert_eq!(steps, 17 * blocks);
    let mean = |name: &str| result.series(name).unwrap().last().mean.unwrap();
    let truths = [
        ("q", stop),
        ("way", stop * stop / 2.0 + (1.0 - stop) * stop),
        ("out", 1.0),
        ("out time", 0.25),
        ("far", 0.0),
        // Where it has not happened, its time is t.
        ("far time", 1.0),
        ("late", 1.0),
    ];
    for (name, truth) in truths {
        assert!((mean(name) - truth).abs() < 1e-12, "{name}: {} for {truth}", mean(name));
    }
    assert_eq!(tables[0].times().len() as u64, STEPS + 1);
}

#[test]
fn a_path_that_stays_neither_passes_nor_fails() {
    let scene = scene(0.8, "");
    // The inner steps of paths that are stopped fail, and nobody looks.
    let (result, tables, steps) = found(&scene, 0.25);
    assert_eq!(result.losses.failed, 0);
    assert!(steps < 8 * STEPS, "{steps}");
    let mut stopped = 0;
    for table in &tables {
        let column = |name: &str| table.column(name).unwrap();
        let Some(at) = column("out").iter().position(|&out| out == 1.0) else { continue };
        let after = [column("y1"), column("far"), column("out time")];
        assert!(after.iter().all(|column| column[at..].iter().all(|x| *x == column[at])));
        stopped += usize::from(column("far")[at] == 0.0);
    }
    assert!(stopped > 5, "few paths stay between both places: {stopped}");
}

#[test]
fn blocks_whose_paths_have_failed_make_no_step() {
    let scene = scene(0.0, "");
    let (result, tables, steps) = found(&scene, 0.125);
    // From the state after step 9 on.
    assert_eq!((steps, result.losses.failed), (10 * 8, 256));
    assert!(tables.iter().all(|table| table.halted.is_some() && table.times().len() == 10));
    assert_eq!(result.series("q").unwrap().last().count, 0);
}
