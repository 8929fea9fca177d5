//! How often the answers of this workspace are true: problems with exactly known answers, asked
//! with many seeds; the statements of the paper for several seeds; the coverage of intervals.
//!
//! The tests take minutes and are ignored: `cargo xtask verify` runs them and prints the tables.

mod coverage;
mod kolmogorov;
mod library;

use verify::reproduce;

use library::{
    Entry,
    Question::{self, Chosen, Expectation, StrongOrder, WeakOrder},
    Total, above, ask, entries,
};

/// Probability of a failure of a test if everything is as it should be.
const CHANCE: f64 = 1e-3;

/// No problem is answered falsely more often than it may be, nor is a question over all problems.
#[test]
#[ignore = "statistical: minutes"]
fn stated_answers_are_true() {
    const SEEDS: u64 = 10;
    let (entries, mut wrong) = (entries(), Vec::new());
    let totals = ask(&entries, SEEDS, 100_000_000);
    println!("question, kind, problem: stated, false, undecided, cost, undecided because");
    for (Entry { question, kind, name, .. }, total) in entries.iter().zip(&totals) {
        let (undecided, cost) =
            (total.asked - total.stated, total.cost as f64 / total.asked as f64);
        let line = format!(
            "{question:?}, {kind}, {name}: {}, {}, {undecided}, {cost:.1e}, {}",
            total.stated, total.missed, total.reason
        );
        println!("{line}");
        if total.refuted(question.tolerated(), CHANCE / entries.len() as f64) {
            wrong.push(line);
        }
    }
    for question in [StrongOrder, WeakOrder, Expectation, Chosen] {
        let sum = |count: fn(&Total) -> u64| -> u64 {
            let both = entries.iter().zip(&totals);
            both.filter(|(entry, _)| entry.question == question).map(|(_, t)| count(t)).sum()
        };
        let (missed, stated) = (sum(|total| total.missed), sum(|total| total.stated));
        println!("{question:?}: {missed} of {stated} false");
        if above(question.tolerated(), CHANCE / 4.0, missed, stated) {
            wrong.push(format!("{question:?}: {missed} of {stated}"));
        }
    }
    assert!(wrong.is_empty(), "answered falsely too often: {wrong:#?}");
    // Most answers are of use.
    let sum = |count: fn(&Total) -> u64| totals.iter().map(count).sum::<u64>();
    assert!(2 * sum(|total| total.stated) > sum(|total| total.asked));
}

/// Smooth functions, kinks, jumps and unbounded functions, with and without damping. Not those of
/// W(1), which `sexp-li` has without an error: fine and coarse paths agree to the bit, and the part
/// of an interval for events that were missed makes it up to four times as wide.
fn covered(entry: &Entry) -> bool {
    let names = [
        "p, ω = 2, σ = ½, midpoint",
        "p < −0.3, Kubo, ω = σ = 1, T = 2",
        "|p − ½|, Ornstein–Uhlenbeck",
        "(∫W)²",
        "|∫W|^½",
        "p²",
        "y₁ of a damped top, c = 0.7",
    ];
    entry.question == Question::Chosen && names.contains(&&*entry.name)
}

/// The share of misses of an entry is below 7 %, that of undecided answers below 3 %, and the
/// intervals are at most twice as wide as errors of this size need: each to an error of 1e-3 over
/// all. A width has its own standard error, since few errors make the root mean square of those of
/// an indicator; with 1000 seeds widths of 1.07 to 1.85 and up to 0.6 % undecided were measured.
#[test]
#[ignore = "statistical: a minute"]
fn chosen_intervals_cover_and_are_not_too_wide() {
    const SEEDS: u64 = 200;
    let entries: Vec<Entry> = entries().into_iter().filter(covered).collect();
    assert_eq!(entries.len(), 7);
    let totals = ask(&entries, SEEDS, u64::MAX);
    let chance = CHANCE / totals.len() as f64;
    for (Entry { name, .. }, total) in entries.iter().zip(&totals) {
        let (width, error) = total.relative_width();
        let row = format!("{name}: {total:?}, width {width:.2} (1 ± {error:.2})");
        println!("{row}");
        assert!(!total.refuted(0.07, chance), "{row}");
        let undecided = total.asked - total.stated;
        assert!(!above(0.03, chance, undecided, total.asked), "{row}");
        let fits = |width: f64| {
            width * (1.0 + MARGIN * error) > 0.8 && width * (1.0 - MARGIN * error) < 2.0
        };
        assert!(fits(width), "{row}");
        // The margin does not hide intervals that are wrong by a factor of four.
        assert!(!fits(4.0 * width) && !fits(0.25 * width), "{row}");
    }
}

/// A normal number exceeds so many standard errors with a probability of 7.1e-5 = 1e-3/14: of
/// seven widths on both sides.
const MARGIN: f64 = 3.8;

/// An order is refuted by chance with a probability of at most 0.05 % (a 99.9 % interval misses on
/// one side), any other check of at most 1e-5. Of so many verdicts more than three are refuted with
/// a probability below 1e-3 (Poisson of mean 0.375).
#[test]
#[ignore = "statistical: minutes"]
fn statements_hold_for_other_seeds() {
    let mut alarms = Vec::new();
    for seed in 2..=6 {
        let claims = reproduce(seed, true, &[]).claims;
        println!("seed {seed}: {}", verify::page::counts(claims.iter()));
        alarms.extend(claims.into_iter().filter(|claim| claim.outcome() == "refuted"));
    }
    for claim in &alarms {
        println!("{} on {}: {}", claim.id, claim.panel, claim.evidence);
    }
    assert!(alarms.len() <= 3, "{} false alarms", alarms.len());
}
