//! Studies on a device and on the processor, whole and in parts.

use gpu::Gpu;
use mc::{
    Problem, Setup,
    parts::{Job, Program, Share},
};
use schemes::{BuiltIn, Device};
use study::{Study, StudySettings};

use crate::{bits::scene, interpreter::Interpreter};

/// The table of a study of Kubo's oscillator as a part of a job, if it is there.
fn table(job: &Job, device: Option<&dyn Device>) -> Option<String> {
    let scene = scene(scenes::gallery::scene("kubo").unwrap());
    let problem = Problem { t_end: 1.0, device, ..scene.problem() };
    let setup = Setup { problem, scheme: scene.model.scheme(BuiltIn::Sexp).unwrap() };
    // The last group is not full.
    let settings = StudySettings::new(16, 4, 1100, scene.settings.truncation, scene.settings.key);
    let study = Study::new(&setup, &scene.observables, &settings).unwrap();
    let result = study.run_in(job, "study")?;
    let mut csv = Vec::new();
    result.write_csv(&mut csv).unwrap();
    Some(String::from_utf8(csv).unwrap())
}

#[test]
fn tables_of_studies_and_merged_parts_are_those_of_the_processor() {
    // The pilot has fewer paths, of which nothing is said.
    let of = |fewest| Gpu::new(Interpreter { change: str::to_string, fewest });
    let (gpu, large) = (of(1100), of(1101));
    let wanted = table(&Job::here(), None).unwrap();
    assert_eq!(table(&Job::here(), Some(&gpu)).unwrap(), wanted);
    assert!(gpu.refused().is_empty(), "{:?}", gpu.refused());
    assert_eq!(table(&Job::here(), Some(&large)).unwrap(), wanted);
    assert_eq!(large.refused(), ["few paths are sooner done there"]);
    let gpu = of(0);

    let (folder, program) = (tempfile::tempdir().unwrap(), || Program::default());
    for part in 1..=3 {
        let job = Job::part(folder.path(), Share::new(part, 3).unwrap(), program()).unwrap();
        let device: Option<&dyn Device> = if part == 2 { None } else { Some(&gpu) };
        assert!(table(&job, device).is_none());
        job.finish().unwrap();
    }
    let job = Job::merge(folder.path(), program()).unwrap();
    assert_eq!(table(&job, None).unwrap(), wanted);
    job.finish().unwrap();
}
