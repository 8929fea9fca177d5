//! Every wrong twin is refuted, for several seeds; the measurements that they are twins of are not.

use lab::{STATEMENTS, TWINS, measure_twins, reproduce};
use verify::results::Verdict;
use verify::{Mode, Settings, Silent};

const SEEDS: [u64; 3] = [1, 2, 3];

#[test]
fn every_twin_is_refuted() {
    for seed in SEEDS {
        let settings = Settings { seed, mode: Mode::Quick };
        for (twin, claim) in TWINS.iter().zip(measure_twins(settings, &Silent)) {
            assert_eq!(
                claim.verdict,
                Verdict::Refuted,
                "seed {seed}: {} with the mistake \"{}\": {}",
                twin.claim,
                twin.mistake,
                claim.evidence
            );
        }
    }
}

#[test]
fn the_right_methods_are_not_refuted() {
    let ids: Vec<String> = STATEMENTS.iter().map(|statement| statement.id.to_owned()).collect();
    for seed in SEEDS {
        let results = reproduce(Settings { seed, mode: Mode::Quick }, &ids, &Silent).unwrap();
        for claim in results.claims.iter().filter(|claim| claim.erratum.is_empty()) {
            assert_ne!(
                claim.verdict,
                Verdict::Refuted,
                "seed {seed}: {}: {}",
                claim.id,
                claim.evidence
            );
        }
    }
}

#[test]
fn every_statement_has_a_twin() {
    let of_panels =
        ["conformal-casimir", "energy-balance", "strong-half", "strong-one", "weak-one"];
    for id in STATEMENTS.iter().map(|statement| statement.id).chain(of_panels) {
        assert!(TWINS.iter().any(|twin| twin.claim == id), "{id} has no twin");
    }
}
