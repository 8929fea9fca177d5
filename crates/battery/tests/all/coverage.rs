//! Nominal 95 % intervals cover 93 to 97 %, and their twins do not; warnings are raised where they
//! have to be, and only there.
//!
//! With 2000 data sets the share covered by a calibrated interval has the standard error 0.49 %; 2
//! % are 4.1 of them, which a calibrated interval misses with probability 4·10⁻⁵, and two dozen of
//! them together with less than 10⁻³. A warning has to be raised on at least 98 % of the data sets,
//! or on at most 2 %: one that fails in 1 % of them misses that with probability 4·10⁻⁵, too.

use battery::coverage;
use mc::parts::Job;
use stats::{Coverage, Expected};

/// The largest deviation from the nominal share.
const TOLERANCE: f64 = 0.02;

fn as_expected(row: &Coverage) -> bool {
    let above = row.share() - row.expected.nominal();
    match row.expected {
        Expected::Calibrated | Expected::Raised | Expected::Silent => above.abs() <= TOLERANCE,
        Expected::Covers => above >= -TOLERANCE,
        Expected::Miscovers => above.abs() > TOLERANCE,
        Expected::Stated => true,
    }
}

#[test]
fn intervals_cover_as_often_as_they_say() {
    let rows = coverage(2000, 1, &Job::here()).unwrap();
    for row in &rows {
        println!("{:70} {:60} {:.4} {:?}", row.case, row.interval, row.share(), row.expected);
    }
    let wrong: Vec<_> = rows.iter().filter(|row| !as_expected(row)).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
    for kind in [
        Expected::Calibrated,
        Expected::Covers,
        Expected::Miscovers,
        Expected::Raised,
        Expected::Silent,
    ] {
        assert!(rows.iter().any(|row| row.expected == kind), "nothing is {kind:?}");
    }
}
