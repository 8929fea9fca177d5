//! The verdicts: a sentence that counts them, a table that lists them, and the badge they wear.

use verify::results::{Claim, Panel, Results, Verdict};

use super::number::duration;
use crate::report::escape::escape;

/// A coloured badge that also says its verdict in words.
pub fn badge(verdict: Verdict) -> String {
    let (class, sign, word) = match verdict {
        Verdict::Holds => ("holds", "✓", "holds"),
        Verdict::Refuted => ("refuted", "✗", "refuted"),
        Verdict::Undecided => ("undecided", "?", "undecided"),
    };
    format!("<span class=\"badge {class}\"><span aria-hidden=\"true\">{sign}</span> {word}</span>")
}

/// The address of a claim on the page.
pub fn anchor(number: usize) -> String {
    format!("claim-{}", number + 1)
}

/// One paragraph: how many statements hold, which run said so, and how long it took.
pub fn summary(results: &Results) -> String {
    let tally = |keep: &dyn Fn(&Claim) -> bool| results.claims.iter().filter(|c| keep(c)).count();
    let verdict = |verdict, one: &str, many: &str| {
        let n = tally(&|c: &Claim| c.verdict == verdict);
        format!("<strong>{}</strong>", counted(n, one, many))
    };
    let refuted = tally(&|c: &Claim| c.verdict == Verdict::Refuted && c.proven);
    let misprints = tally(&|c: &Claim| c.verdict == Verdict::Refuted && c.proven && !c.erratum.is_empty());
    let proven = match (refuted, misprints) {
        (0, _) => "Nothing the paper proves is refuted.".to_owned(),
        (n, 0) => format!("Refuted although the paper proves it: {n}."),
        (n, m) => format!("Refuted although the paper proves it: {n}, of which {m} by a documented misprint."),
    };
    let provenance = &results.provenance;
    format!(
        "{} checked: {}, {} and {}. {proven} An interval too wide to decide counts as undecided, never as a \
         pass. The run covers {}, in <em>{}</em> mode with seed {}, and took {}.",
        counted(results.claims.len(), "statement was", "statements were"),
        verdict(Verdict::Holds, "holds", "hold"),
        verdict(Verdict::Refuted, "is refuted", "are refuted"),
        verdict(Verdict::Undecided, "is undecided", "are undecided"),
        counted(results.panels.len(), "panel", "panels"),
        escape(&provenance.mode),
        provenance.seed,
        duration(provenance.wall_s),
    )
}

fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// All claims, in the order of the results.
pub fn table(claims: &[Claim], panels: &[Panel]) -> String {
    let rows: String = claims.iter().enumerate().map(|(n, claim)| row(n, claim, panels)).collect();
    format!(
        "<table class=\"claims\"><thead><tr><th>Verdict</th><th>Statement</th><th>Panel and scheme</th>\
         <th>Evidence</th></tr></thead><tbody>{rows}</tbody></table>"
    )
}

fn row(number: usize, claim: &Claim, panels: &[Panel]) -> String {
    let origin = if claim.proven { "proven in the paper" } else { "not proven in the paper" };
    let erratum = match claim.erratum.as_str() {
        "" => String::new(),
        text => format!("<p class=\"erratum\"><b>Misprint.</b> {}</p>", escape(text)),
    };
    let panel = match panels.iter().find(|p| p.id == claim.panel) {
        Some(panel) => format!("<a href=\"#panel-{0}\"><code>{0}</code></a>", escape(&panel.id)),
        None if claim.panel.is_empty() => "<span class=\"quiet\">on its own</span>".to_owned(),
        None => format!("<code>{}</code>", escape(&claim.panel)),
    };
    let scheme = match claim.scheme.as_str() {
        "" => String::new(),
        scheme => format!("<br><code>{}</code>", escape(scheme)),
    };
    format!(
        "<tr id=\"{}\"><td>{}</td><td><p>{}</p><p class=\"quiet\"><code>{}</code> · {origin}</p>{erratum}</td>\
         <td>{panel}{scheme}</td><td>{}</td></tr>\n",
        anchor(number),
        badge(claim.verdict),
        escape(&claim.statement),
        escape(&claim.id),
        escape(&claim.evidence),
    )
}

/// The badges of the claims measured on one panel, each linked to its row in the table.
pub fn badges(claims: &[Claim], panel: &str) -> String {
    let items: String = claims
        .iter()
        .enumerate()
        .filter(|(_, claim)| claim.panel == panel && !panel.is_empty())
        .map(|(n, claim)| {
            let scheme = match claim.scheme.as_str() {
                "" => String::new(),
                scheme => format!(" · <code>{}</code>", escape(scheme)),
            };
            format!(
                "<li>{} <a href=\"#{}\"><code>{}</code></a>{scheme}</li>",
                badge(claim.verdict),
                anchor(n),
                escape(&claim.id)
            )
        })
        .collect();
    if items.is_empty() { String::new() } else { format!("<ul class=\"badges\">{items}</ul>") }
}
