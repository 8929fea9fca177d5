//! One panel of the page: its figure, what the paper says, what was measured, and where the numbers
//! are.

use plot::{escape, series::relative_defect};

use super::{code, group::Group, outcome::badge, prose::prose, table};
use crate::results::{Claim, Clipped, Kind, Panel, Point, Series};

/// Failures that are shown.
const SHOWN: usize = 8;

/// The card of a panel with its figure inside.
pub fn card(panel: &Panel, figure: &str, claims: &[Claim]) -> String {
    let list = |lines: &mut dyn Iterator<Item = String>| lines.collect::<Vec<_>>().join("<br>");
    let facts = [
        ("Set-up", prose(&panel.setup)),
        ("What the paper says", prose(&panel.paper)),
        ("What was measured", measured(panel)),
        ("Sample paths", panel.samples.to_string()),
        ("Reference", prose(&panel.reference)),
        ("Clipped increments", list(&mut panel.clipped.iter().map(clipped))),
        (
            "Paths left out",
            list(&mut panel.failures.iter().take(SHOWN).map(|failure| escape(failure))),
        ),
    ];
    let facts = facts.iter().filter(|(_, what)| !what.is_empty());
    let facts: String =
        facts.map(|(term, what)| format!("<dt>{term}</dt><dd>{what}</dd>")).collect();
    let verdicts = Group::all(claims.iter().filter(|claim| claim.panel == panel.id));
    let verdict = |group: &Group| {
        let claim = group.first();
        format!("{} {} {} ", badge(group.verdict()), code(&claim.id), code(&claim.scheme))
    };
    format!(
        r#"<article class="card" id="panel-{id}">
<header><h3>{title}</h3><code>{id}</code></header>
<figure><div class="paper">{figure}</div><figcaption>{caption}</figcaption></figure>
<p>{verdicts}</p><dl>{facts}</dl>
<p class="files"><a href="data/{id}.csv">Numbers (CSV)</a>
<a href="figures/{id}.svg">Figure (SVG)</a></p>
</article>
"#,
        id = escape(&panel.id),
        title = prose(&panel.title),
        caption = caption(panel.kind),
        verdicts = verdicts.iter().map(verdict).collect::<String>(),
    )
}

/// How to read the figure.
fn caption(kind: Kind) -> &'static str {
    match kind {
        Kind::Strong => {
            "Root-mean-square error with 95 % error bars; dashed, in grey: reference slopes. In the \
             legend: fitted order ± half the width of its 95 % interval."
        }
        Kind::Weak => {
            "Size of the weak error, filled where it is positive and hollow where negative, with 95 % \
             error bars; a bar without a lower cap reaches zero. Markers at one step stand side by \
             side. In grey: reference slope."
        }
        Kind::Cost => "Path-steps, pilots included, for an interval of the given half-width.",
        Kind::Invariant => {
            "Above: the invariant along the path and, thin and black, its conformal law. Below: \
             relative defect of the law; a defect of zero is drawn at the mark 0."
        }
    }
}

/// Fitted orders and the errors at the finest step, largest defects, or costs.
fn measured(panel: &Panel) -> String {
    let (head, row): (&[&str], fn(&Series) -> Vec<String>) = match panel.kind {
        Kind::Strong | Kind::Weak => {
            (&["order", "95 % interval", "error at the finest step"], order)
        }
        Kind::Invariant => (&["largest relative defect"], defect),
        Kind::Cost => (&["smallest half-width", "path-steps"], cost),
    };
    let named = |series: &Series| {
        [vec![code(&series.scheme), prose(&series.quantity)], row(series)].concat()
    };
    let head = ["scheme", "quantity"].iter().chain(head).copied();
    table(head, panel.series.iter().map(named))
}

fn order(series: &Series) -> Vec<String> {
    let (order, interval) = series.rate.as_ref().map_or(("—".into(), String::new()), |rate| {
        (format!("{:.2}", rate.estimate), format!("[{:.2}, {:.2}]", rate.lo, rate.hi))
    });
    let finest = series.points.iter().rev().find_map(|point| match point {
        Point::Error { tau, value, se, .. } => {
            Some(prose(&format!("{value:.1e} ± {se:.0e} at 2^{}", tau.log2())))
        }
        _ => None,
    });
    vec![order, interval, finest.unwrap_or_default()]
}

fn defect(series: &Series) -> Vec<String> {
    let defects = series.points.iter().filter_map(|point| match *point {
        Point::Value { value, exact, .. } => Some(relative_defect(value, exact)),
        _ => None,
    });
    // A defect that is not a number must not hide behind smaller ones, as it would with `f64::max`.
    let largest = series.max_relative_defect.or_else(|| defects.max_by(f64::total_cmp));
    vec![largest.map_or("—".into(), |defect| prose(&format!("{defect:.1e}")))]
}

fn cost(series: &Series) -> Vec<String> {
    let last = series.points.iter().rev().find_map(|point| match point {
        Point::Cost { accuracy, path_steps } => {
            Some([format!("{accuracy:e}"), path_steps.to_string()])
        }
        _ => None,
    });
    last.unwrap_or_default().map(|cell| prose(&cell)).into()
}

/// Where clipped increments matter.
fn clipped(Clipped { scheme, tau, increments, share }: &Clipped) -> String {
    let words = format!(
        "{scheme}, τ = 2^{}: {increments} clipped, {:.0} % of the mean-square error",
        tau.log2(),
        100.0 * share
    );
    prose(&words)
}
