//! The figures of the page.

use anyhow::Result;
use stability::results::{Case, Growth, Stability};

use crate::report::{GrowthCurve, WorkPlot, WorkPoint, growth_figure, work_figure};

/// The long runs that the figure shows.
const SHOWN: [&str; 5] = [
    "default solver, undamped",
    "undamped",
    "constant γ",
    "γ = ½cos 2t",
    "Lotka–Volterra, H, undamped",
];

/// Names and contents of the figures, as far as their data are there.
pub fn figures(results: &Stability) -> Result<Vec<(String, String)>> {
    let mut figures = Vec::new();
    let case = |id: &str| results.cases.iter().find(|case| case.id == id);
    let plots: Vec<WorkPlot> = [
        ("stiff-damping", "damping in a step, γτ", Some((1e-12, 1e12))),
        ("stiff-hamiltonian", "frequency ω (τ = 1/64)", Some((1e-16, 1e8))),
    ]
    .into_iter()
    .filter_map(|(id, title, range)| Some(plot(case(id)?, title, range)))
    .collect();
    if plots.len() == 2 {
        figures.push((
            "stability-stiff.svg".to_owned(),
            work_figure(
                "What every scheme does under stiff damping and with a stiff Hamiltonian",
                "factor of a step; distance from the law",
                &plots,
            )?,
        ));
    }
    if !results.growth.is_empty() {
        // As many as can be told apart; the table has them all.
        let shown = |id: &&Growth| SHOWN.contains(&id.id.as_str());
        let curves: Vec<GrowthCurve> = results.growth.iter().filter(shown).map(curve).collect();
        figures.push((
            "stability-growth.svg".to_owned(),
            growth_figure("Distance from the conformal law over ten million steps", &curves)?,
        ));
    }
    Ok(figures)
}

/// One curve for each scheme; figures outside of the range are drawn at its border.
fn plot(case: &Case, title: &str, range: Option<(f64, f64)>) -> WorkPlot {
    let mut curves: Vec<(String, Vec<WorkPoint>)> = Vec::new();
    for row in &case.rows {
        let Some(x) = row.x else { continue };
        let (lo, hi) = range.unwrap_or((0.0, f64::INFINITY));
        // A path that overflowed is at the top whatever it was before.
        let overflowed = row.error.as_ref().is_some_and(|error| error.starts_with("overflow"));
        let value = if overflowed { hi } else { row.measured.unwrap_or(hi).clamp(lo, hi) };
        let point = WorkPoint { cost: x, cost_hi: x, error: value, interval: (value, value) };
        match curves.iter_mut().find(|(scheme, _)| *scheme == row.scheme) {
            Some((_, points)) => points.push(point),
            None => curves.push((row.scheme.clone(), vec![point])),
        }
    }
    // `sexp` with Newton is `sexp` to the eye.
    curves.retain(|(scheme, _)| scheme != "sexp-newton");
    WorkPlot { cost: title.to_owned(), steps: false, curves }
}

fn curve(growth: &Growth) -> GrowthCurve {
    GrowthCurve {
        name: growth.id.clone(),
        points: growth.points.iter().map(|point| (point.steps as f64, point.rms)).collect(),
    }
}
