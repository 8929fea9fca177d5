//! The page: verdicts, panels, provenance, in one file that needs no network and no script.

mod card;
mod claims;
mod measured;
mod number;

use verify::results::{Panel, Provenance, Results};

use super::csv::{ERROR_COLUMNS, VALUE_COLUMNS};
use super::escape::escape;

const STYLE: &str = include_str!("style.css");

const TITLE: &str = "Structure-preserving simulation of damped stochastic Poisson systems";

/// Ids of the schemes and what they stand for.
const SCHEMES: [(&str, &str); 3] = [
    ("sexp", "stochastic conformal exponential integrator, the method of the paper"),
    ("em", "Euler–Maruyama on the Itô form"),
    ("midpoint", "stochastic midpoint, damping included"),
];

/// The page for `results`; `figures` are the drawings of its panels and then of its supplements, in the same order.
pub fn page(results: &Results, figures: &[String]) -> String {
    let (of_panels, of_supplements) = figures.split_at(results.panels.len());
    let cards = |panels: &[Panel], figures: &[String]| -> String {
        panels.iter().zip(figures).map(|(panel, figure)| card::card(panel, figure, &results.claims)).collect()
    };
    let supplements = if results.supplements.is_empty() {
        String::new()
    } else {
        format!(
            "<section id=\"supplements\"><h2>Not in the paper</h2>\n<div class=\"grid\">{}</div></section>\n",
            cards(&results.supplements, of_supplements)
        )
    };
    let schemes: String =
        SCHEMES.iter().map(|(id, name)| format!("<dt><code>{id}</code></dt><dd>{name}</dd>")).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n<title>Casimir: reproduction report</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<header class=\"top\"><p class=\"kicker\">Casimir · reproduction report</p>\n\
         <h1>{TITLE}</h1>\n<p class=\"summary\">{summary}</p>\n<dl class=\"schemes\">{schemes}</dl>\n\
         <nav><a href=\"#verdicts\">Verdicts</a> <a href=\"#panels\">Panels</a> <a href=\"#provenance\">Provenance</a></nav>\
         </header>\n<main>\n<section id=\"verdicts\"><h2>Verdicts</h2>\n{claims}</section>\n\
         <section id=\"panels\"><h2>Panels</h2>\n<div class=\"grid\">{cards}</div></section>\n\
         {supplements}<section id=\"provenance\"><h2>Provenance</h2>\n{provenance}</section>\n</main>\n</body>\n</html>\n",
        cards = cards(&results.panels, of_panels),
        summary = claims::summary(results),
        claims = claims::table(&results.claims, &results.panels),
        provenance = provenance(&results.provenance),
    )
}

fn provenance(provenance: &Provenance) -> String {
    let threads = provenance.threads.to_string();
    let seed = provenance.seed.to_string();
    let wall = number::duration(provenance.wall_s);
    let facts = [
        ("Commit", &provenance.git),
        ("Compiler", &provenance.rustc),
        ("Processor", &provenance.cpu),
        ("Instruction set", &provenance.simd),
        ("Threads", &threads),
        ("Seed", &seed),
        ("Mode", &provenance.mode),
        ("Command", &provenance.command),
        ("Wall time", &wall),
    ];
    let facts: String =
        facts.iter().map(|(name, value)| format!("<dt>{name}</dt><dd><code>{}</code></dd>", escape(value))).collect();
    let times: String = provenance
        .wall_s_by_id
        .iter()
        .map(|(id, s)| format!("<tr><th><code>{}</code></th><td>{}</td></tr>", escape(id), number::duration(*s)))
        .collect();
    let times = if times.is_empty() {
        String::new()
    } else {
        format!(
            "<table class=\"numbers\"><thead><tr><th>panel or statement</th><th>wall time</th></tr></thead>\
             <tbody>{times}</tbody></table>"
        )
    };
    format!(
        "<div class=\"two\"><div><dl class=\"facts\">{facts}</dl>\n<p class=\"quiet\">The results are the same, bit for bit, for the same seed on any number of threads \
         and any instruction set.</p>\n\
         <p class=\"quiet\">Columns of the CSV files: <code>{ERROR_COLUMNS}</code> for errors, where <code>value</code> is \
         the root-mean-square or the signed weak error and <code>se</code> its standard error; \
         <code>{VALUE_COLUMNS}</code> for invariants, where <code>exact</code> is the conformal law and \
         <code>relative_defect</code> is |value − exact| / |exact|. The whole run is in \
         <a href=\"results.json\">results.json</a>.</p></div>\n<div>{times}</div></div>"
    )
}
