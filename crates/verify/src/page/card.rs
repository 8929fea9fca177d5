//! One panel of the page: its figure, what the paper says, what was measured, and where the numbers
//! are.

use plot::{escape, series::main_quantity};

use super::file_stem;
use super::{
    markup::{code, entry, list},
    measured::{interval_name, measured},
    number::{count, step},
    prose::prose,
    statements::badges,
};
use crate::results::{Claim, Clipped, Kind, Panel};

/// The card of a panel with its figure inside; `comment` is the heading of what [`Panel::paper`]
/// says.
pub fn card(panel: &Panel, figure: &str, claims: &[Claim], comment: &str) -> String {
    let samples = match panel.samples {
        1 => "one path".into(),
        n => count(n) + " paths",
    };
    let facts = [
        ("Set-up", prose(&panel.setup)),
        (comment, prose(&panel.paper)),
        ("What was measured", measured(panel)),
        ("Samples", samples),
        ("Reference", prose(&panel.reference)),
        ("Clipped increments", list("", panel.clipped.iter().map(clipped))),
        ("Paths left out", failures(&panel.failures)),
    ];
    format!(
        r#"<article class="card" id="panel-{id}">
<header><h3>{title}</h3>{code}</header>
<figure><div class="paper">{figure}</div><figcaption>{caption}</figcaption></figure>
{badges}<dl>{facts}</dl>
<p class="files"><a href="data/{stem}.csv">Numbers (CSV)</a>
<a href="figures/{stem}.svg">Figure (SVG)</a></p>
</article>
"#,
        id = escape(&panel.id),
        title = prose(&panel.title),
        code = code(&panel.id),
        caption = caption(panel),
        badges = badges(claims, &panel.id),
        facts = facts.iter().map(|(term, what)| entry(term, what)).collect::<String>(),
        stem = file_stem(&panel.id),
    )
}

/// How to read the figure: what is drawn, and what is only in the table.
fn caption(panel: &Panel) -> String {
    let main = main_quantity(&panel.series);
    let further = match panel.series.iter().all(|series| series.quantity == main) {
        true => "",
        false => " Further quantities are in the table.",
    };
    let main = prose(main);
    let rate = panel.series.iter().find_map(|series| series.rate.as_ref());
    let orders = rate.map_or(String::new(), |rate| {
        let interval = interval_name(rate.confidence);
        format!(" In the legend: fitted order ± half the width of its {interval}.")
    });
    match panel.kind {
        Kind::Strong => format!(
            "Root-mean-square error of {main} with 95\u{202f}% error bars; dashed, in grey: \
             reference slopes.{orders}{further}"
        ),
        Kind::Weak => format!(
            "Size of the weak error, filled where it is positive and hollow where negative, with \
             95\u{202f}% error bars; a bar without a lower cap reaches zero. Markers at one step \
             stand side by side. In grey: reference slope.{orders}"
        ),
        Kind::Cost => {
            "Path-steps, pilots included, for an interval of the given half-width.".into()
        }
        Kind::Invariant => format!(
            "Above: {main} along the path and, thin and black, its conformal law. Below: relative \
             defect of the law; a defect of zero is drawn at the mark 0.{further}"
        ),
    }
}

/// Where clipped increments matter.
fn clipped(clipped: &Clipped) -> String {
    format!(
        "{}, τ = {}: {} clipped, {:.0}\u{202f}% of the mean-square error",
        escape(&clipped.scheme),
        step(clipped.tau),
        count(clipped.increments),
        100.0 * clipped.share
    )
}

fn failures(failures: &[String]) -> String {
    const SHOWN: usize = 8;
    let (shown, rest) = failures.split_at(failures.len().min(SHOWN));
    let rest = (!rest.is_empty()).then(|| format!("and {} more", rest.len()));
    list("", shown.iter().map(|failure| prose(failure)).chain(rest))
}
