//! The twins are refuted, the right methods are not, and every statement has a twin. Many seeds:
//! `cargo xtask verify`.

use analysis::{Mode, Settings, Silent, results::Verdict};
use battery::twins::{TWINS, measure_twins};
use mc::parts::Job;
use report::Outcome;
use verify::{STATEMENTS, ids, reproduce};

const QUICK: Settings = Settings { seed: 1, mode: Mode::Quick, samples_times: None };

#[test]
fn every_twin_is_refuted() {
    for ((id, mistake, _), claim) in TWINS.iter().zip(measure_twins(QUICK, &Silent)) {
        let evidence = &claim.evidence;
        assert_eq!(claim.verdict, Verdict::Refuted, "{id}, {mistake}: {evidence}");
    }
}

#[test]
fn the_right_methods_are_not_refuted() {
    for claim in reproduce(QUICK, &ids(STATEMENTS), &[], &Job::here(), &Silent).unwrap().claims {
        let refuted = Outcome::of(&claim) == Outcome::Refuted;
        assert!(!refuted, "{}: {}", claim.id, claim.evidence);
    }
}

#[test]
fn every_statement_has_a_twin() {
    let of_panels =
        ["conformal-casimir", "energy-balance", "strong-half", "strong-one", "weak-one"];
    for id in ids(STATEMENTS).into_iter().chain(of_panels.map(String::from)) {
        assert!(TWINS.iter().any(|twin| twin.0 == id), "{id} has no twin");
    }
}
