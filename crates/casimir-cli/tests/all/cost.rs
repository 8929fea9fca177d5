//! What the program costs beside the calls of the library that it makes:
//!
//! ```text
//! cargo test --release -p casimir-cli --test all -- --ignored --nocapture cost
//! ```

use std::time::Instant;

use casimir::{
    mc::{Expect, Observable, Setup, StudySettings, study},
    noise::{StreamKey, Truncation},
    schemes::SexpLi,
    systems::{Cosine, Problem, RigidBody},
};

use crate::common::{BODY, succeeds, with_scene};

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

/// The smallest times of a few turns of both, and their ratio.
fn compare(what: &str, turns: usize, mut program: impl FnMut(), mut library: impl FnMut()) {
    let mut least = [f64::INFINITY; 2];
    for _ in 0..turns {
        least[0] = least[0].min(seconds(&mut program));
        least[1] = least[1].min(seconds(&mut library));
    }
    let [program, library] = least;
    println!("{what}: program {program:.2} s, library {library:.2} s, {:.3}", program / library);
    assert!(program <= 1.2 * library);
}

#[test]
#[ignore = "measures times: run it in a release build, alone"]
fn the_program_costs_what_the_library_costs() {
    let scene = format!("{BODY}times = 32\n[expect]\nof = [\"y3\"]\naccuracy = 1e-5\n");
    let folder = with_scene(&scene);
    let path = folder.path();
    let body = RigidBody::three_noises([2.0, 1.0, 2.0 / 3.0], [1.0, 2.0, 3.0]).unwrap();
    let y0 = [1.1f64.cos(), 0.0, 1.1f64.sin()];
    let problem = Problem::new(body, Cosine::new(0.5, 2.0).unwrap(), y0, 1.0).unwrap();
    let scheme = SexpLi::new(&body, y0).unwrap();
    let key = StreamKey { seed: 1, experiment: 0 };
    let truncation = Truncation::new(4).unwrap();
    let components = [
        Observable { name: "y1", function: |y: [f64; 3]| y[0] },
        Observable { name: "y2", function: |y: [f64; 3]| y[1] },
        Observable { name: "y3", function: |y: [f64; 3]| y[2] },
    ];
    let settings = StudySettings::new(64, 32, 1_000_000, truncation, key);
    compare(
        "a million paths",
        5,
        || drop(succeeds(path, &["run", "scene.toml", "--paths", "1e6"])),
        || drop(study(&Setup::of(&problem, &scheme), &components, &settings, &|_| ()).unwrap()),
    );
    compare(
        "an expectation to 1e-5",
        5,
        || drop(succeeds(path, &["expect", "scene.toml"])),
        || drop(Expect::by_parts(&problem).run(&[&components[2]], 1e-5, &|_| ()).unwrap()),
    );
}
