//! Every scheme on every scene of the gallery: the states of the processor, to the bit.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use gpu::Gpu;
use mc::{Device, Ladder, Problem, Run, Statistic, Task, Trajectories, View};
use scenes::{Changes, Scene, Source, gallery::GALLERY};
use schemes::BuiltIn;

use crate::interpreter::Interpreter;

/// Paths of a comparison.
const PATHS: u64 = 256;

/// All that a statistic is shown.
#[derive(Default, PartialEq)]
struct Seen(Vec<(u64, u64, u64, u32, Vec<u64>)>);

impl Statistic for Seen {
    fn observe(&mut self, view: &View<'_>) {
        for run in 0..view.runs() {
            let state = view.state(run).iter();
            let live = view.live.paths();
            let bits = live.flat_map(|p| state.clone().map(move |row| row[p].to_bits()));
            let clipped = view.clipped[run].and(view.live);
            self.0.push((view.time, view.first_path, run as u64, clipped.0, bits.collect()));
        }
    }

    fn reads(&self, time: u64) -> bool {
        time % 3 == 0 || time < 5
    }

    fn merge(&mut self, later: Self) {
        self.0.extend(later.0);
    }
}

/// What is seen of the first times, and the counts of failed paths and clipped increments.
fn seen(
    problem: &Problem<'_>,
    scene: &Scene,
    scheme: BuiltIn,
    steps: u64,
) -> Option<(Seen, u64, Vec<u64>)> {
    let method = scene.model.scheme(scheme).ok()?;
    let runs = vec![Run::new(method, 0)];
    let truncation = scene.settings.truncation;
    let ladder = Ladder::new(problem, steps, 0, truncation, scene.settings.key, runs).ok()?;
    let measured = ladder.run(PATHS, Seen::default);
    let mut all = measured.statistic;
    all.0.retain(|seen| all_reads(seen.0));
    Some((all, measured.failed, measured.clipped))
}

fn all_reads(time: u64) -> bool {
    Seen::default().reads(time)
}

/// Counts the groups that a device computes, and those that it leaves to the processor.
struct Counted<'a> {
    gpu: &'a Gpu<Interpreter>,
    solved: AtomicU64,
    left: AtomicU64,
}

impl Device for Counted<'_> {
    fn advance(&self, task: &Task<'_>) -> Option<Trajectories> {
        if let Ok(folder) = std::env::var("PTX") {
            let name = format!("{folder}/{}.ptx", task.key.seed);
            std::fs::write(name, Gpu::<Interpreter>::ptx(task).unwrap_or_default()).unwrap();
        }
        let found = self.gpu.advance(task)?;
        for group in found.solved.chunks(128) {
            let all = group.iter().all(|&solved| solved);
            let count = if all { &self.solved } else { &self.left };
            count.fetch_add(1, Relaxed);
        }
        Some(found)
    }

    fn refuse(&self, why: &str) {
        self.gpu.refuse(why);
    }
}

#[test]
fn every_scheme_on_the_gallery_has_the_bits_of_the_processor() {
    let mut report = String::new();
    for (name, text) in GALLERY {
        let source = Source { name: (*name).into(), text: (*text).into(), states: None };
        let scene = Scene::new(source, &Changes::default()).unwrap();
        for scheme in BuiltIn::ALL {
            let gpu = Gpu::new(Interpreter { change: str::to_string });
            let counted =
                Counted { gpu: &gpu, solved: AtomicU64::new(0), left: AtomicU64::new(0) };
            let problem = Problem { t_end: scene.settings.until.min(1.0), ..scene.problem() };
            let steps = 8;
            let Some(wanted) = seen(&problem, &scene, scheme, steps) else { continue };
            let on = Problem { device: Some(&counted), ..problem };
            let start = std::time::Instant::now();
            let found = seen(&on, &scene, scheme, steps).unwrap();
            let Counted { solved, left, .. } = &counted;
            report += &format!(
                "{name} {} {:.2} {} {} {:?} clipped {:?}\n",
                scheme.id(),
                start.elapsed().as_secs_f64(),
                solved.load(Relaxed),
                left.load(Relaxed),
                gpu.reasons().iter().map(|why| &why[..30]).collect::<Vec<_>>(),
                found.2,
            );
            assert!(found == wanted, "{report}");
            if let Ok(folder) = std::env::var("PTX") {
                let from = format!("{folder}/{}.ptx", scene.settings.key.seed);
                let _ = std::fs::rename(from, format!("{folder}/{name}-{}.ptx", scheme.id()));
            }
        }
    }
    println!("{report}");
}
