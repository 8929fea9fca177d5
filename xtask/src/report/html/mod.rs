//! The page: summary, statements, panels, supplements and provenance, in one file that needs no
//! network and no script.

mod card;
mod describe;
mod digest;
mod group;
mod measured;
mod number;
mod outcome;
mod prose;
mod provenance;
mod statements;
mod summary;

use verify::results::{Panel, Results};

const STYLE: &str = include_str!("style.css");

const TITLE: &str = "Structure-preserving simulation of damped stochastic Poisson systems";

/// Ids of the schemes and what they stand for.
const SCHEMES: [(&str, &str); 3] = [
    ("sexp", "stochastic conformal exponential integrator, the method of the paper"),
    ("em", "Euler–Maruyama on the Itô form"),
    ("midpoint", "stochastic midpoint, damping included"),
];

/// The page for `results`; `figures` are the drawings of its panels and then of its supplements, in
/// the same order.
pub fn page(results: &Results, figures: &[String]) -> String {
    let (of_panels, of_supplements) = figures.split_at(results.panels.len());
    let cards = |panels: &[Panel], figures: &[String], comment: &str| -> String {
        panels
            .iter()
            .zip(figures)
            .map(|(panel, figure)| card::card(panel, figure, &results.claims, comment))
            .collect()
    };
    let (supplements, to_supplements) = if results.supplements.is_empty() {
        (String::new(), "")
    } else {
        let section = format!(
            "<section id=\"supplements\"><h2>Not in the paper</h2>\n<p class=\"lead\">Figures that the paper does \
             not have, on questions that it leaves open.</p>\n<div class=\"grid\">{}</div></section>\n",
            cards(&results.supplements, of_supplements, "What it adds to the paper")
        );
        (section, "<a href=\"#supplements\">Not in the paper</a> ")
    };
    let schemes: String = SCHEMES
        .iter()
        .map(|(id, name)| format!("<dt><code>{id}</code></dt><dd>{name}</dd>"))
        .collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>Casimir: reproduction report</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header class=\"top\"><p class=\"kicker\">Casimir · reproduction report</p>\n\
         <h1>{TITLE}</h1>\n{summary}<dl class=\"schemes\">{schemes}</dl>\n\
         <nav><a href=\"#statements\">Statements</a> <a href=\"#panels\">Panels</a> {to_supplements}<a href=\"#provenance\">Provenance</a></nav>\
         </header>\n<main>\n<section id=\"statements\"><h2>Statements</h2>\n{statements}</section>\n\
         <section id=\"panels\"><h2>Panels</h2>\n<div class=\"grid\">{cards}</div></section>\n\
         {supplements}<section id=\"provenance\"><h2>Provenance</h2>\n{provenance}</section>\n</main>\n</body>\n</html>\n",
        cards = cards(&results.panels, of_panels, "What the paper says"),
        summary = summary::summary(results),
        statements = statements::statements(&results.claims, &results.panels),
        provenance = provenance::provenance(&results.provenance),
    )
}
