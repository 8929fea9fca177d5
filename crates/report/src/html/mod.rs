//! The page: summary, statements, panels, supplements and provenance, in one file that needs no
//! network and no script.

mod card;
mod document;
mod group;
mod markup;
mod measured;
mod number;
mod prose;
mod provenance;
mod statements;
mod summary;

use analysis::results::{Claim, Panel, Results};

use crate::escape::escape;

pub use document::Document;

const STYLE: &str = include_str!("style.css");

/// What the page says beside the results.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wording<'a> {
    /// Title of the page.
    pub title: &'a str,
    /// A line above the title.
    pub kicker: &'a str,
    /// Ids of schemes and what they stand for.
    pub schemes: &'a [(&'a str, &'a str)],
    /// Proven statements by id. Claims about any other statement are headed by the words of the
    /// first of them.
    pub statements: &'a [(&'a str, &'a str)],
}

impl<'a> Wording<'a> {
    /// The statement that `claim` is a case of.
    fn statement(&self, claim: &'a Claim) -> &'a str {
        let found = self.statements.iter().find(|(id, _)| claim.proven && *id == claim.id);
        found.map_or(&claim.statement, |(_, words)| words)
    }
}

/// The page for `results`; `figures` are the drawings of its panels and then of its supplements, in
/// the same order.
pub fn page(results: &Results, wording: &Wording, figures: &[String]) -> String {
    let mut figures = figures.iter();
    let mut cards = |panels: &[Panel], comment: &str| {
        let card =
            |(panel, figure): (&_, &String)| card::card(panel, figure, &results.claims, comment);
        let cards: String = panels.iter().zip(figures.by_ref()).map(card).collect();
        if cards.is_empty() { cards } else { format!("<div class=\"grid\">{cards}</div>") }
    };
    let statements = statements::statements(&results.claims, &results.panels, wording);
    let panels = cards(&results.panels, "What the paper says");
    let supplements = cards(&results.supplements, "What it adds to the paper");
    let provenance = provenance::provenance(&results.provenance);
    let lead = "<p class=\"lead\">Figures on questions that the paper leaves open.</p>\n";
    let (mut nav, mut main) = (String::new(), String::new());
    for (id, title, lead, content) in [
        ("statements", "Statements", "", statements),
        ("panels", "Panels", "", panels),
        ("supplements", "Not in the paper", lead, supplements),
        ("provenance", "Provenance", "", provenance),
    ] {
        if !content.is_empty() {
            nav += &format!("<a href=\"#{id}\">{title}</a> ");
            main += &format!("<section id=\"{id}\"><h2>{title}</h2>\n{lead}{content}</section>\n");
        }
    }
    let schemes = wording.schemes.iter().map(|(id, name)| markup::entry(&markup::code(id), name));
    format!(
        r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{kicker}</title>
<style>
{STYLE}</style>
</head>
<body>
<header class="top"><p class="kicker">{kicker}</p>
<h1>{title}</h1>
{summary}<dl class="schemes">{schemes}</dl>
<nav>{nav}</nav></header>
<main>
{main}</main>
</body>
</html>
"#,
        kicker = escape(wording.kicker),
        title = escape(wording.title),
        summary = summary::summary(results),
        schemes = schemes.collect::<String>(),
    )
}

#[cfg(test)]
mod tests {
    use analysis::results::{Evidence, Verdict};

    use super::*;

    /// A claim for tests.
    pub fn claim(id: &str, scheme: &str, proven: bool, verdict: Verdict, erratum: &str) -> Claim {
        let evidence = Evidence::Undecided { reason: "as it should be".into() };
        Claim {
            scheme: scheme.into(),
            verdict,
            proven,
            erratum: erratum.into(),
            ..Claim::new(id, format!("{scheme} has {id}"), evidence)
        }
    }

    #[test]
    fn an_unknown_statement_speaks_for_itself() {
        let wording = Wording { statements: &[("a", "A is proven.")], ..Wording::default() };
        for (id, scheme, proven, words) in [
            ("a", "sexp", true, "A is proven."),
            ("a", "em", false, "em has a"),
            ("new", "sexp", true, "sexp has new"),
        ] {
            let claim = claim(id, scheme, proven, Verdict::Holds, "");
            assert_eq!(wording.statement(&claim), words);
        }
    }
}
