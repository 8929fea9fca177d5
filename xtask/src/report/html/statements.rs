//! The statements and their verdicts: one row each, which opens to the claims behind it.

use verify::results::{Claim, Panel};

use super::describe;
use super::digest::digest;
use super::group::Group;
use super::outcome::Outcome;
use super::prose::prose;
use crate::report::escape::escape;

/// The section of the statements: first what the paper proves, then what it only reports.
pub fn statements(claims: &[Claim], panels: &[Panel]) -> String {
    let (proven, reported): (Vec<Group>, Vec<Group>) =
        Group::all(claims).into_iter().partition(|g| g.first().proven);
    let mut section = String::new();
    if !proven.is_empty() {
        section.push_str(&table("What the paper proves", &proven, panels));
    }
    if !reported.is_empty() {
        section.push_str(&format!(
            "<h3 class=\"part\">What is observed without a proof</h3>\n<p class=\"lead\">About the other schemes and \
             where the theorems do not apply, as the figures of the paper report it; and against exact solutions, which \
             the paper does not use.</p>\n{}",
            table("What is observed", &reported, panels)
        ));
    }
    if section.is_empty() { "<p>None was checked.</p>".to_owned() } else { section }
}

fn table(title: &str, groups: &[Group], panels: &[Panel]) -> String {
    let bodies: String = groups.iter().map(|group| body(group, panels)).collect();
    format!(
        "<table class=\"statements\"><thead><tr><th>Verdict</th><th>{title}</th><th>What was measured</th></tr>\
         </thead>\n{bodies}</table>\n"
    )
}

fn body(group: &Group, panels: &[Panel]) -> String {
    let claim = group.first();
    let misprint = match (group.verdict(), group.tally(Outcome::Misprint)) {
        (Outcome::Misprint, _) | (_, 0) => "",
        _ => " <span class=\"badge misprint\"><span aria-hidden=\"true\">✎</span> misprint</span>",
    };
    let scheme = if claim.proven { String::new() } else { scheme(" · ", claim) };
    let checks: String = group.claims.iter().map(|claim| check(claim, panels)).collect();
    let (open, title) = (
        if group.is_clear() { "" } else { " open" },
        match group.claims.len() {
            1 => "The check in full".to_owned(),
            n => format!("The {n} checks one by one"),
        },
    );
    format!(
        "<tbody id=\"{anchor}\"><tr class=\"statement\"><td>{badge}{misprint}<p class=\"quiet\">{counts}</p></td>\
         <td><p>{words}</p><p class=\"quiet\"><code>{id}</code>{scheme}</p></td><td>{digest}</td></tr>\n\
         <tr class=\"checks\"><td></td><td colspan=\"2\"><details{open}><summary>{title}</summary>\n\
         <ul>{checks}</ul></details></td></tr></tbody>\n",
        anchor = group.anchor(),
        badge = group.verdict().badge(),
        counts = group.counts(),
        words = prose(describe::statement(claim)),
        id = escape(&claim.id),
        digest = digest(group),
    )
}

/// One claim of a group: verdict and place, statement, evidence.
fn check(claim: &Claim, panels: &[Panel]) -> String {
    let place = match panels.iter().find(|panel| panel.id == claim.panel) {
        Some(panel) => format!("<a href=\"#panel-{0}\"><code>{0}</code></a>", escape(&panel.id)),
        None if claim.panel.is_empty() => {
            "<span class=\"quiet\">measured on its own</span>".to_owned()
        }
        None => format!("<code>{}</code>", escape(&claim.panel)),
    };
    let erratum = match claim.erratum.as_str() {
        "" => String::new(),
        text => format!("<p class=\"erratum\">{}</p>", prose(text)),
    };
    format!(
        "<li><p class=\"where\">{} {place}{}</p><p>{}</p>{erratum}<p class=\"evidence\">{}</p></li>\n",
        Outcome::of(claim).badge(),
        scheme(" · ", claim),
        prose(&claim.statement),
        prose(&claim.evidence),
    )
}

fn scheme(between: &str, claim: &Claim) -> String {
    match claim.scheme.as_str() {
        "" => String::new(),
        scheme => format!("{between}<code>{}</code>", escape(scheme)),
    }
}

/// The verdicts on one panel, each linked to its statement.
pub fn badges(claims: &[Claim], panel: &str) -> String {
    let here = claims.iter().filter(|claim| claim.panel == panel && !panel.is_empty());
    let items: String = Group::all(here)
        .iter()
        .map(|group| {
            let claim = group.first();
            let counts = match group.claims.len() {
                1 => String::new(),
                _ => format!(" <span class=\"quiet\">{}</span>", group.counts()),
            };
            format!(
                "<li>{} <a href=\"#{}\"><code>{}</code></a>{}{counts}</li>",
                group.verdict().badge(),
                group.anchor(),
                escape(&claim.id),
                scheme(" · ", claim)
            )
        })
        .collect();
    if items.is_empty() { String::new() } else { format!("<ul class=\"badges\">{items}</ul>") }
}

#[cfg(test)]
mod tests {
    use verify::results::Verdict;

    use super::super::group::tests::claim;
    use super::*;

    #[test]
    fn only_groups_without_a_blemish_are_closed() {
        let page = |verdict, erratum| {
            let claims =
                [claim("a", "", true, Verdict::Holds, ""), claim("a", "", true, verdict, erratum)];
            statements(&claims, &[])
        };
        assert!(page(Verdict::Holds, "").contains("<details><summary>The 2 checks"));
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
