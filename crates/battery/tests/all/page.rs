//! What the page says of alarms, undecided verdicts and misprints.

use analysis::results::{Claim, Evidence, Verdict};
use battery::page::{Battery, page};

fn claim(verdict: Verdict, erratum: &str) -> Claim {
    let measured = Evidence::order(1.0, None);
    Claim {
        verdict,
        erratum: erratum.to_owned(),
        ..Claim::new("strong-one", "a | b", measured).about("a-panel", "")
    }
}

/// Eleven seeds of one statement: holds, but undecided with the third and, if asked for,
/// refuted with the last.
fn battery(last: Verdict) -> Battery {
    let verdicts = (1..=11).map(|seed| match seed {
        3 => Verdict::Undecided,
        11 => last,
        _ => Verdict::Holds,
    });
    Battery {
        claims: verdicts.map(|verdict| vec![claim(verdict, "")]).collect(),
        twins: vec![vec![claim(Verdict::Refuted, "")]; 11],
        expectations: Vec::new(),
        coverage: Vec::new(),
        library: Vec::new(),
    }
}

/// The page, and the page without line breaks.
fn text(battery: &Battery) -> (String, String) {
    let text = page(battery).text().to_owned();
    let words = text.replace('\n', " ");
    (text, words)
}

#[test]
fn alarms_are_counted_and_named() {
    let (calm, words) = text(&battery(Verdict::Holds));
    assert!(words.contains("**0 false alarms**, within the budget"), "{calm}");
    assert!(words.contains("Undecided: 1 of 11 verdicts, 9.1 %"), "{calm}");
    assert!(words.contains("| holds | 10 / 1 / 0 |"), "{calm}");
    assert!(calm.contains("(mutation.md)") && !calm.contains("- Seed"));
    let (alarmed, words) = text(&battery(Verdict::Refuted));
    assert!(words.contains("**1 false alarms**"), "{alarmed}");
    assert!(words.contains("- Seed 11: `strong-one` on `a-panel`, no order"), "{alarmed}");
}

#[test]
fn misprints_are_no_alarms_and_claims_may_be_missing() {
    let mut misprint = battery(Verdict::Holds);
    misprint.claims[4] = vec![claim(Verdict::Refuted, "a sign")];
    misprint.claims[5] = Vec::new();
    let (page, words) = text(&misprint);
    assert!(words.contains("| 8 / 1 / 1 |") && words.contains("**0 false alarms**"), "{page}");
}
