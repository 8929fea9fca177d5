use std::fs;

use plot::Series;

use super::*;
use crate::results::{Evidence, Point, Provenance, SCHEMA, Verdict};

fn claim(id: &str, scheme: &str, proven: bool, verdict: Verdict, erratum: &str) -> Claim {
    let evidence = Evidence::Undecided { reason: "as it should be".into() };
    Claim {
        verdict,
        erratum: erratum.into(),
        ..Claim::new(id, format!("{scheme} has {id}"), evidence).about("", scheme).proven(proven)
    }
}

fn results(panels: Vec<Panel>, claims: Vec<Claim>) -> Results {
    let provenance = Provenance { git: "abc".into(), ..Provenance::default() };
    Results { schema: SCHEMA, provenance, panels, supplements: Vec::new(), claims }
}

fn panel(id: &str, kind: Kind, points: Vec<Point>) -> Panel {
    let series = |scheme: &str| Series {
        scheme: scheme.into(),
        quantity: "a<b".into(),
        points: points.clone(),
        ..Series::default()
    };
    let series = vec![series("sexp"), series("other")];
    Panel { id: id.into(), kind, title: "A & B".into(), samples: 1, series, ..Panel::default() }
}

/// Data no figure likes: none, a single point, zeros, what is not finite, and the ends of the
/// range of `f64`.
fn awkward() -> Vec<Panel> {
    let error = Point::normal;
    let value = |t, value, exact| Point::Value { t, value, exact };
    let (lo, hi, warning) = (Some(-1.0), Some(f64::NAN), Some("<w>".into()));
    let errors = [
        vec![],
        vec![error(0.1, 1e-3, 0.0)],
        vec![error(0.1, 0.0, 0.0), error(0.05, 0.0, 0.0)],
        vec![error(0.1, f64::MAX, f64::MAX), error(0.05, -5e-324, f64::NAN)],
        vec![Point::Error { tau: 0.1, value: 1.0, se: 0.1, lo, hi, warning }],
        vec![error(0.1, f64::NAN, 1.0), error(0.0, 1.0, 0.0), error(-1.0, 1.0, f64::INFINITY)],
        vec![value(0.0, 1.0, 1.0), error(0.1, 5e3, 1e4)],
    ];
    let values = [
        vec![],
        vec![value(0.0, 1.0, 1.0)],
        vec![value(0.0, 0.0, 0.0), value(2.0, 1.0, 0.0), value(1.0, 0.0, 0.0)],
        vec![value(0.0, f64::MAX, -f64::MAX), value(1.0, f64::NAN, 1.0)],
        vec![value(f64::NAN, 1.0, 1.0), value(1.0, f64::INFINITY, f64::NEG_INFINITY)],
    ];
    let mut panels = Vec::new();
    for (n, points) in errors.into_iter().enumerate() {
        panels.push(panel(&format!("strong-{n}"), Kind::Strong, points.clone()));
        panels.push(panel(&format!("weak-{n}"), Kind::Weak, points));
    }
    for (n, points) in values.into_iter().enumerate() {
        panels.push(panel(&format!("invariant-{n}"), Kind::Invariant, points));
    }
    panels
}

#[test]
fn awkward_data_still_make_a_report() -> Result<()> {
    let dir = tempfile::tempdir()?;
    let results = results(awkward(), Vec::new());
    write_report(&results, dir.path())?;
    // A second run replaces the first.
    write_report(&results, dir.path())?;
    let page = fs::read_to_string(dir.path().join("index.html"))?;
    for panel in &results.panels {
        let figure = fs::read_to_string(dir.path().join(format!("figures/{}.svg", panel.id)))?;
        assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
        assert!(page.contains(&figure), "{} is not on the page", panel.id);
        assert!(dir.path().join(format!("data/{}.csv", panel.id)).is_file());
    }
    assert!(!page.contains("a<b") && page.contains("a&lt;b"));
    assert!(!page.contains("<script") && !page.contains("src="));
    Ok(())
}

#[test]
fn the_largest_defect_of_a_nan_is_a_nan() {
    let value = |value| Point::Value { t: 0.0, value, exact: 1.0 };
    let panel = panel("p", Kind::Invariant, vec![value(f64::NAN), value(2.0)]);
    assert_eq!(defect(&panel.series[0]), ["NaN"]);
}

#[test]
fn verdicts_are_counted_by_statement_and_the_worst_counts() {
    use Verdict::{Holds, Refuted, Undecided};
    let claims = vec![
        claim("one", "sexp", true, Holds, ""),
        claim("two", "sexp", true, Holds, ""),
        claim("two", "sexp", true, Refuted, "a sign"),
        claim("three", "em", false, Undecided, ""),
        claim("three", "midpoint", false, Holds, ""),
        claim("three", "midpoint", false, Refuted, ""),
    ];
    // A misprint counts only where nothing else is left.
    let text = page(&results(Vec::new(), claims.clone()));
    for words in [
        "What the paper proves: 2 of 2 statements hold.",
        "0 of 2 statements hold; undecided: three em; refuted: three midpoint.",
        "Misprint in the paper (two): a sign",
        "<dt>Commit</dt><dd>abc</dd>",
        "<td>holds</td><td>1 of 2</td><td>sexp has two</td>",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
    let words = "3 statements hold, 1 refuted, 1 misprinted, 1 undecided";
    assert_eq!(counts(&claims), words);
}
