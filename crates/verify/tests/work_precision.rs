//! The program behind `cargo xtask work-precision` as a user meets it.

use std::process::{Command, Output};

fn work_precision(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_work-precision"))
        .args(arguments)
        .output()
        .expect("the program of this crate runs")
}

#[test]
fn every_scheme_is_compared_on_the_problems_that_are_asked_for() {
    let output =
        work_precision(&["--only", "pendulum", "--only", "rigid-body-3", "--error", "0.1"]);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!text.contains("lotka-volterra"), "{text}");
    let (pendulum, body) = text.split_once("rigid-body-3\n").expect("both problems");
    let all = ["sexp", "sexp-li", "split", "nv", "midpoint", "heun", "em"];
    for (problem, schemes) in [(pendulum, &[][..]), (body, &["sexp-levy", "sexp-li-levy"])] {
        for scheme in all.iter().chain(schemes) {
            let row = |line: &str| line.split_whitespace().next() == Some(scheme);
            assert!(problem.lines().any(row), "{scheme} in\n{problem}");
        }
    }
}

#[test]
fn bad_requests_are_refused_in_words() {
    for (arguments, words) in [
        (["--only", "rigid-body"], ["'rigid-body'", "rigid-body-3", "maxwell-bloch"]),
        (["--error", "0"], ["wanted error", "positive", "0"]),
    ] {
        let output = work_precision(&arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(words.iter().all(|word| message.contains(word)), "{message}");
    }
}
