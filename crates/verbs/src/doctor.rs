//! Facts about this machine, and a self-test of the computation.

use std::env::consts::{ARCH, OS};

use casimir::{
    mc::Simulation,
    plot::{Provenance, provenance},
    real::{Simd, limit_to},
};
use rayon::ThreadPoolBuilder;

use crate::{Expect, prelude::*};
use scenes::{Source, gallery};

/// Expected results of the self-test on scenes of the gallery, at their ends.
#[derive(Clone, Copy, Debug)]
pub struct Expected {
    /// The bits of the states of all paths of the rigid body, mixed.
    pub bits: u64,
    /// |y|² of the rigid body, by the law of its Casimir.
    pub square: f64,
    /// The mean of q of Kubo's oscillator.
    pub mean: f64,
}

/// Expected results of the self-test, equal on every machine.
pub const EXPECTED: Expected = Expected {
    bits: 0x43d3_3f83_9129_5830,
    // exp(−2∫γ) = exp(−½ sin 2T), T = 4.
    square: 0.6097665357749628,
    // exp(−(γ + σ²/2)T) cos T, γ = 0.1, σ = ½, T = 6.
    mean: 0.24891479537568123,
};

/// Steps of the rigid body.
const STEPS: u64 = 64;

/// Version, machine and instruction sets; `commit` as for [`provenance::complete`].
pub fn facts(commit: Option<&str>) -> String {
    let Provenance { version, git, rustc, cpu, threads, simd, .. } =
        provenance::complete(Provenance::of_run(0, ""), "casimir", commit, Instant::now());
    format!(
        "casimir       {version}, commit {git}\n\
         compiler      {rustc}\n\
         system        {OS}, {ARCH}\n\
         processor     {cpu}\n\
         threads       {threads}\n\
         instructions  {simd} in use, built for {}\n",
        format!("{:?}", Simd::BUILT).to_lowercase()
    )
}

/// Computes known results; returns a report and whether all of them are as expected.
///
/// # Errors
/// If something cannot be computed.
pub fn self_test(Expected { bits, square, mean }: Expected) -> Done<(String, bool)> {
    let (mut text, mut all_hold) = (String::new(), true);
    let mut check = |holds: bool, words: String| {
        all_hold &= holds;
        text += &format!("{} {words}\n", if holds { "ok   " } else { "FAILS" });
    };
    let (body, all) = (scene("rigid-body")?, rayon::current_num_threads());
    let simulation =
        Simulation::new(body.setup("sexp-levy")?, body.settings.truncation).every(STEPS);
    let mut ends = Vec::new();
    for &level in Simd::BUILT.iter().filter(|level| **level <= Simd::available()) {
        limit_to(level);
        // One and all.
        for threads in (1..=all).step_by(all.max(2) - 1) {
            // Two blocks.
            ends = ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()?
                .install(|| simulation.paths(STEPS, body.settings.key, 0..64))?
                .iter()
                .flat_map(|path| &path.columns[1..4])
                .map(|y| y.values.last().copied().unwrap_or(f64::NAN))
                .collect();
            let mixed = ends.iter().fold(0, |mixed: u64, y| {
                (mixed.rotate_left(23) ^ y.to_bits()).wrapping_mul(0x0100_0000_01b3)
            });
            let of = format!("bits of a rigid body ({}, threads {threads})", level.name());
            check(mixed == bits, format!("{of}: expected {bits:016x}, came {mixed:016x}"));
        }
    }
    let off = ends
        .chunks(3)
        .map(|y| (y.iter().map(|y| y * y).sum::<f64>() - square).abs())
        .max_by(f64::total_cmp)
        .unwrap_or(f64::NAN);
    check(
        off <= 1e-12,
        format!("|y|² of a rigid body: expected {square:.12} ± 1e-12, came ± {off:.0e}"),
    );
    let mut kubo = scene("kubo")?;
    kubo.accuracy = Some(5e-4);
    let Found { json, unreached, .. } =
        Expect::default().compute(&kubo, &Store::Nothing, &Watch::new(()))?;
    let q = &json["estimates"][0];
    let [lo, hi, steps, seconds] = [&q["lo"], &q["hi"], &json["path_steps"], &json["seconds"]]
        .map(|number| number.as_f64().unwrap_or(f64::NAN));
    check(
        unreached.is_none() && (lo..=hi).contains(&mean),
        format!("E[q] of an oscillator: expected {mean:.5}, came [{lo:.5}, {hi:.5}]"),
    );
    text += &format!("{:.1e} path-steps of it per second\n", steps / seconds);
    Ok((text, all_hold))
}

/// A scene of the gallery.
fn scene(name: &str) -> Done<Scene> {
    Ok(Scene::new(
        Source::new(name, gallery::scene(name).map_err(Failure::Usage)?),
        &Changes::default(),
    )?)
}
