//! One panel of the page: its figure, what the paper says, what was measured, and where the numbers
//! are.

use verify::results::{Claim, Clipped, Kind, Panel, Series};

use super::measured;
use super::number::{count, quantity};
use super::prose::prose;
use super::statements;
use crate::report::escape::escape;
use crate::report::{file_stem, main_quantity};

/// The card of a panel with its figure inside; `comment` is the heading of what [`Panel::paper`]
/// says.
pub fn card(panel: &Panel, figure: &str, all_claims: &[Claim], comment: &str) -> String {
    let (id, stem) = (escape(&panel.id), file_stem(&panel.id));
    let reference = match panel.reference.as_str() {
        "" => String::new(),
        text => format!("<dt>Reference</dt><dd>{}</dd>", prose(text)),
    };
    format!(
        "<article class=\"card\" id=\"panel-{id}\">\n<header><h3>{title}</h3><code>{id}</code></header>\n\
         <figure><div class=\"paper\">{figure}</div><figcaption>{caption}</figcaption></figure>\n{badges}\
         <dl><dt>Set-up</dt><dd>{setup}</dd><dt>{comment}</dt><dd>{paper}</dd>\
         <dt>What was measured</dt><dd>{measured}</dd><dt>Samples</dt><dd>{samples}</dd>{reference}\
         {clipped}{failures}</dl>\n<p class=\"files\"><a href=\"data/{stem}.csv\">Numbers (CSV)</a> \
         <a href=\"figures/{stem}.svg\">Figure (SVG)</a></p>\n</article>\n",
        title = prose(&panel.title),
        caption = caption(panel),
        badges = statements::badges(all_claims, &panel.id),
        setup = prose(&panel.setup),
        paper = prose(&panel.paper),
        measured = measured::measured(panel),
        samples = samples(panel.samples),
        clipped = clipped(&panel.clipped),
        failures = failures(&panel.failures),
    )
}

/// How to read the figure: what is drawn, and what is only in the table.
fn caption(panel: &Panel) -> String {
    let main = main_quantity(panel);
    let others: Vec<&Series> = panel.series.iter().filter(|s| s.quantity != main).collect();
    let elsewhere = match others.first() {
        Some(_) if panel.kind != Kind::Weak => " Further quantities are in the table.",
        _ => "",
    };
    let orders = match panel.series.iter().find_map(|s| s.rate.as_ref()) {
        Some(rate) => format!(
            " In the legend: fitted order ± half the width of its {}\u{202f}% interval.",
            (1e4 * rate.confidence).round() / 1e2
        ),
        None => String::new(),
    };
    match panel.kind {
        Kind::Strong => format!(
            "Root-mean-square error of {} with 95\u{202f}% error bars; dashed, in grey: reference slopes.{orders}{elsewhere}",
            quantity(main)
        ),
        Kind::Weak => format!(
            "Size of the weak error, filled where it is positive and hollow where it is negative, with \
             95\u{202f}% error bars; a bar without a lower cap reaches zero. Markers at one step are set side by \
             side. Dashed: reference slope.{orders}"
        ),
        Kind::Cost => {
            "Path-steps, pilots included, that an interval of the given half-width took.".to_owned()
        }
        Kind::Invariant => format!(
            "Above: {} along the path and, thin and black, its conformal law. Below: relative defect of the law; \
             a defect of zero is drawn at the mark 0.{elsewhere}",
            quantity(main)
        ),
    }
}

fn samples(n: u64) -> String {
    match n {
        1 => "one path".to_owned(),
        n => format!("{} paths", count(n)),
    }
}

/// Where clipped increments matter: one line a curve and step size.
fn clipped(clipped: &[Clipped]) -> String {
    if clipped.is_empty() {
        return String::new();
    }
    let items: String = clipped
        .iter()
        .map(|c| {
            format!(
                "<li>{}, τ = 2<sup>{:.0}</sup>: {} clipped, {:.0}\u{202f}% of the mean-square error</li>",
                escape(&c.scheme),
                c.tau.log2(),
                count(c.increments),
                100.0 * c.share
            )
        })
        .collect();
    format!("<dt>Clipped increments</dt><dd><ul>{items}</ul></dd>")
}

fn failures(failures: &[String]) -> String {
    const SHOWN: usize = 8;
    if failures.is_empty() {
        return String::new();
    }
    let items: String =
        failures.iter().take(SHOWN).map(|f| format!("<li>{}</li>", prose(f))).collect();
    let rest = match failures.len().saturating_sub(SHOWN) {
        0 => String::new(),
        n => format!("<li>and {n} more</li>"),
    };
    format!("<dt>Paths left out</dt><dd><ul>{items}{rest}</ul></dd>")
}
