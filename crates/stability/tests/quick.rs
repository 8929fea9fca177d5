//! The quick version of everything: no guarantee is refuted, nothing panics, and the same seed
//! gives the same bits.

use stability::results::Verdict;
use stability::{Effort, Settings, case_ids, fuzz, run_cases, run_growth};

const QUICK: Settings = Settings { seed: 1, effort: Effort::Quick };

#[test]
fn no_guarantee_is_refuted() {
    let cases = run_cases(QUICK, &[], &|_| ());
    assert_eq!(cases.iter().map(|case| case.id.as_str()).collect::<Vec<_>>(), case_ids());
    for case in &cases {
        for row in &case.rows {
            assert_ne!(row.verdict, Verdict::Refuted, "{}: {row:?}", case.id);
        }
    }
    // The twin of the whole suite: where theory says that a scheme fails, it does.
    let fails = |id: &str, scheme: &str| {
        let case = cases.iter().find(|case| case.id == id).expect("the case is there");
        case.rows.iter().any(|row| row.scheme == scheme && row.verdict == Verdict::FailsAsItMust)
    };
    for (id, scheme) in [
        ("stiff-damping", "em"),
        ("stiff-damping", "heun"),
        ("stiff-damping", "midpoint"),
        ("rough-damping", "em"),
        ("rough-damping", "midpoint"),
        ("stiff-hamiltonian", "heun"),
        ("anti-damping", "midpoint"),
    ] {
        assert!(fails(id, scheme), "{id} {scheme}");
    }
    assert!(!fails("stiff-damping", "sexp"));
}

#[test]
fn long_runs_walk_and_the_default_solver_drifts() {
    let growth = run_growth(QUICK, &|_| ());
    for run in &growth {
        let settled = run.scheme.ends_with("settled");
        assert_eq!(
            run.verdict,
            if settled { Verdict::Holds } else { Verdict::FailsAsItMust },
            "{run:?}"
        );
    }
    assert!(growth.iter().any(|run| !run.scheme.ends_with("settled") && run.lo > 0.5));
}

#[test]
fn arbitrary_inputs_break_nothing() {
    for fuzzed in fuzz::run(QUICK, None, &[], &|_| ()) {
        assert_eq!(fuzzed.failures, 0, "{}: {:?}", fuzzed.target, fuzzed.examples);
        assert!(fuzzed.accepted > 0 && fuzzed.refused > 0, "{fuzzed:?}");
    }
}

#[test]
fn a_target_that_breaks_is_caught() {
    fn breaks(bits: &mut fuzz::Bits) -> Result<fuzz::Report, String> {
        match bits.below(3) {
            0 => panic!("on purpose"),
            1 => Err("a NaN".to_owned()),
            _ => Ok(fuzz::Report::accepted()),
        }
    }
    let target = fuzz::Target { name: "broken", checks: "", cost: 1, run: breaks };
    let fuzzed = fuzz::run(QUICK, Some(30), &[target], &|_| ());
    let broken = fuzzed.last().expect("the target was fed");
    assert!(broken.failures > 0 && broken.accepted > 0 && !broken.examples.is_empty());
}

#[test]
fn the_same_seed_gives_the_same_bits() {
    let run = |seed| {
        let only = ["big-steps".to_owned()];
        serde_json::to_string(&run_cases(Settings { seed, ..QUICK }, &only, &|_| ()))
            .expect("plain data")
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}
