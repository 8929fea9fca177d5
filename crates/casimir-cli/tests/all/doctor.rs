//! `casimir doctor`, and its twins: each wrong expectation is found out, and no other.

use verbs::doctor::{EXPECTED, Expected, self_test};

use crate::common::succeeds;

#[test]
fn the_self_test_holds_here() {
    let folder = tempfile::tempdir().unwrap();
    let said = succeeds(folder.path(), &["doctor"]);
    let version = format!("casimir       {}, commit", env!("CARGO_PKG_VERSION"));
    assert!(said.starts_with(&version) && said.contains("path-steps of it per second"), "{said}");
    assert!(said.lines().filter(|line| line.starts_with("ok ")).count() >= 3, "{said}");
    assert!(!said.contains("FAILS") && said.contains("To report a fault, attach"), "{said}");
}

#[test]
fn what_is_wrong_fails() {
    let wrong = [
        Expected { bits: EXPECTED.bits ^ 1, ..EXPECTED },
        // Ten times the tolerance.
        Expected { square: EXPECTED.square + 1e-11, ..EXPECTED },
        // Twice the half-width.
        Expected { mean: EXPECTED.mean + 1e-3, ..EXPECTED },
    ];
    for (expected, name) in wrong.into_iter().zip(["bits of", "|y|² of", "E[q] of"]) {
        let (text, holds) = self_test(expected).unwrap();
        let fail = text.lines().filter_map(|line| line.strip_prefix("FAILS "));
        assert!(fail.clone().all(|what| what.starts_with(name)), "{text}");
        assert!(!holds && fail.count() > 0, "{text}");
    }
}
