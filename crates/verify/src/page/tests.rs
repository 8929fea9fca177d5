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

#[test]
fn every_panel_has_a_figure_and_its_numbers() -> Result<()> {
    let dir = tempfile::tempdir()?;
    // Figures of awkward data are tested in `plot`.
    let error = Point::normal(2f64.powi(-14), 0.1 + 0.2, 1.0 / 3.0 * 1e-300);
    let whole = Point::Error {
        tau: 0.1,
        value: f64::NAN,
        se: 0.1,
        lo: Some(0.25),
        hi: Some(0.5),
        warning: None,
    };
    let value = Point::Value { t: 0.5, value: 3.0, exact: -2.0 };
    let cost = Point::Cost { accuracy: 0.5, path_steps: 7 };
    let points = vec![error, whole, value, cost];
    let kinds = [
        (
            Kind::Strong,
            "tau,value,se,lo,hi",
            "6.103515625e-5,3.0000000000000004e-1,3.3333333333333334e-301,,",
        ),
        (Kind::Weak, "tau,value,se,lo,hi", "1e-1,NaN,1e-1,2.5e-1,5e-1"),
        (Kind::Invariant, "t,value,exact,relative_defect", "5e-1,3e0,-2e0,2.5e0"),
        (Kind::Cost, "accuracy,path_steps", "5e-1,7"),
    ];
    let panels = kinds.map(|(kind, head, _)| panel(head, kind, points.clone()));
    let results = results(panels.to_vec(), Vec::new());
    write_report(&results, dir.path())?;
    // A second run replaces the first.
    write_report(&results, dir.path())?;
    let page = fs::read_to_string(dir.path().join("index.html"))?;
    for (_, head, row) in kinds {
        let figure = fs::read_to_string(dir.path().join(format!("figures/{head}.svg")))?;
        assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
        assert!(page.contains("<svg"), "{head} is not on the page");
        // A point of another kind has no row.
        let data = fs::read_to_string(dir.path().join(format!("data/{head}.csv")))?;
        assert!(data.starts_with(&format!("scheme,quantity,{head}\n")), "{data}");
        assert!(data.contains(&format!("\nsexp,a<b,{row}\n")), "{data}");
    }
    assert!(!page.contains("a<b") && page.contains("a&lt;b"));
    assert!(!page.contains("<script") && !page.contains("src="));
    Ok(())
}

#[test]
fn verdicts_are_counted_and_what_does_not_hold_is_named() {
    use Verdict::{Holds, Refuted, Undecided};
    let claims = vec![
        claim("one", "sexp", true, Holds, ""),
        claim("two", "sexp", true, Holds, ""),
        claim("two", "sexp", true, Refuted, "a sign"),
        claim("three", "em", false, Undecided, ""),
        claim("three", "midpoint", false, Holds, ""),
        claim("three", "midpoint", false, Refuted, ""),
    ];
    let text = page(&results(Vec::new(), claims));
    for words in [
        "What the paper proves: 2 holds, 0 refuted, 1 misprint, 0 undecided.",
        "What is observed: 1 holds, 1 refuted, 0 misprint, 1 undecided.",
        "<td>undecided</td><td>three</td><td>em</td>",
        "Misprint in the paper (two): a sign",
        "<dt>Commit</dt><dd>abc</dd>",
    ] {
        assert!(text.contains(words), "{words}\n{text}");
    }
}

/// A statement has one row with its verdicts, the narrowest interval and a link to its panel; there
/// is no table without rows.
#[test]
fn the_summary_has_a_row_for_each_statement() {
    let rate = |lo: f64, hi: f64| {
        let rate = Rate { estimate: 0.5 * (lo + hi), lo, hi, ..Rate::default() };
        let (order, one_sided, wrong_limit) = (1.0, false, None);
        Evidence::Order { order, one_sided, rate: Some(rate), wrong_limit }
    };
    let mut claims = vec![claim("one", "sexp", true, Verdict::Holds, "")];
    for (lo, hi) in [(0.5, 1.5), (0.75, 1.0), (0.0, 1.0)] {
        let order = claim("order", "sexp", true, Verdict::Holds, "");
        claims.push(Claim { measured: rate(lo, hi), panel: "p".into(), ..order });
    }
    let panels = ["o", "p"].map(|id| panel(id, Kind::Strong, Vec::new()));
    let text = page(&results(panels.to_vec(), claims));
    let summary = &text[..text.find("id=\"section-2\"").unwrap()];
    for row in [
        "<td><a href=\"#section-3\">order</a></td><td>3 holds, 0 refuted, 0 misprint, \
         0 undecided</td><td>3</td><td>0.875 [0.750, 1.000]</td><td>A &amp; B</td>",
        "<td><a href=\"#section-4\">one</a></td>",
    ] {
        assert!(summary.contains(row), "{row}\n{summary}");
    }
    assert_eq!(summary.matches("<thead>").count(), 1, "{summary}");
    assert!(text.contains("<section id=\"section-4\"><h2>Checks without a figure"));
}
