//! The statements and their verdicts: one row each, which opens to the claims behind it.

use plot::escape;

use super::{
    Outcome,
    group::Group,
    markup::{badge, code, details, list, quiet, scheme},
    prose::prose,
    wording::statement,
};
use crate::results::{Claim, Panel};

/// The section of the statements: first what the paper proves, then what it only reports.
pub fn statements(claims: &[Claim], panels: &[Panel]) -> String {
    let (proven, reported) = Group::proven_and_reported(claims);
    let table = |lead: &str, title: &str, groups: &[Group]| {
        let bodies: String = groups.iter().map(|group| body(group, panels)).collect();
        if bodies.is_empty() {
            return bodies;
        }
        format!(
            r#"{lead}<table class="statements">
<thead><tr><th>Verdict</th><th>{title}</th><th>What was measured</th></tr></thead>
{bodies}</table>
"#
        )
    };
    const OBSERVED: &str = r#"<h3 class="part">Statements without a proof</h3>
<p class="lead">What the figures of the paper report about the other schemes and where its theorems
do not apply, and comparisons with exact solutions, which the paper does not make.</p>
"#;
    let section = table("", "What the paper proves", &proven)
        + &table(OBSERVED, "What is observed", &reported);
    if section.is_empty() { "<p>None was checked.</p>".into() } else { section }
}

fn body(group: &Group, panels: &[Panel]) -> String {
    let (claim, verdict) = (group.first(), group.verdict());
    let misprint = match group.tally(Outcome::Misprint) {
        n if n > 0 && verdict != Outcome::Misprint => badge(Outcome::Misprint, "misprint"),
        _ => String::new(),
    };
    let checks = list("", group.claims.iter().map(|claim| check(claim, panels)));
    let clear = group.tally(Outcome::Holds) == group.claims.len();
    format!(
        r#"<tbody id="{anchor}">
<tr class="statement"><td>{badge} {misprint}<p class="quiet">{counts}</p></td>
<td><p>{words}</p><p class="quiet">{id}{scheme}</p></td>
<td>{digest}</td></tr>
<tr class="checks"><td></td><td colspan="2">{details}</td></tr></tbody>
"#,
        anchor = group.anchor(),
        badge = badge(verdict, verdict.words()),
        counts = group.counts(),
        words = prose(statement(claim)),
        id = code(&claim.id),
        scheme = group.scheme(),
        digest = group.digest(),
        details = details(!clear, &format!("Checks: {}", group.claims.len()), &checks),
    )
}

/// One claim of a group: verdict and place, statement, evidence.
fn check(claim: &Claim, panels: &[Panel]) -> String {
    let place = match claim.panel.as_str() {
        "" => quiet("measured on its own"),
        id if panels.iter().any(|panel| panel.id == id) => {
            format!("<a href=\"#panel-{}\">{}</a>", escape(id), code(id))
        }
        id => code(id),
    };
    let erratum = match claim.erratum.as_str() {
        "" => String::new(),
        text => format!("<p class=\"erratum\">{}</p>", prose(text)),
    };
    let outcome = Outcome::of(claim);
    format!(
        r#"<p class="where">{} {place}{}</p><p>{}</p>{erratum}<p class="evidence">{}</p>"#,
        badge(outcome, outcome.words()),
        scheme(claim),
        prose(&claim.statement),
        prose(&claim.evidence),
    )
}

/// The verdicts on one panel, each linked to its statement.
pub fn badges(claims: &[Claim], panel: &str) -> String {
    let groups = Group::all(claims.iter().filter(|claim| claim.panel == panel));
    let item = |group: &Group| {
        let verdict = group.verdict();
        let badge = badge(verdict, verdict.words());
        let counts = match group.claims.len() {
            1 => String::new(),
            _ => format!(" {}", quiet(&group.counts())),
        };
        format!("{badge} {}{}{counts}", group.link(), scheme(group.first()))
    };
    list("badges", groups.iter().map(item))
}

#[cfg(test)]
mod tests {
    use crate::results::Verdict;

    use super::super::tests::claim;
    use super::*;

    #[test]
    fn only_groups_without_a_blemish_are_closed() {
        let page = |verdict, erratum| {
            let claims =
                [claim("a", "", true, Verdict::Holds, ""), claim("a", "", true, verdict, erratum)];
            statements(&claims, &[])
        };
        assert!(page(Verdict::Holds, "").contains("<details><summary>Checks: 2"));
        for (verdict, erratum) in
            [(Verdict::Undecided, ""), (Verdict::Refuted, ""), (Verdict::Refuted, "p ≤ 2")]
        {
            assert!(page(verdict, erratum).contains("<details open>"));
        }
    }

    #[test]
    fn a_misprint_is_told_with_its_text() {
        let page = statements(&[claim("a", "", true, Verdict::Refuted, "meant: p < 2")], &[]);
        assert!(
            page.contains("refuted: misprint in the statement") && page.contains("meant: p &lt; 2")
        );
    }

    #[test]
    fn what_is_proven_comes_first() {
        let claims = [
            claim("a", "em", false, Verdict::Holds, ""),
            claim("b", "sexp", true, Verdict::Holds, ""),
        ];
        let page = statements(&claims, &[]);
        assert!(page.find("statement-b") < page.find("reported-a-em"));
        assert!(page.contains("em has a"));
    }
}
