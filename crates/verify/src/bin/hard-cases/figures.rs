//! The figures of the page.

use report::figure::{Curve, Figure, Line, Measured, Plot, Spacing, Style};

use crate::results::{CaseResult, Growth};

/// The cases that are plotted, by id: the title of the x-axis, and the range of the figures. What
/// is outside of it is drawn at its border.
const PLOTTED: [(&str, &str, (f64, f64)); 2] = [
    ("stiff-damping", "damping in a step, γτ", (1e-12, 1e12)),
    ("stiff-hamiltonian", "frequency ω (τ = 1/64)", (1e-16, 1e8)),
];

/// What every scheme does in the cases that are plotted.
pub fn cases(cases: &[CaseResult]) -> Option<String> {
    let plots: Vec<Plot> = cases.iter().filter_map(plot).collect();
    let figure = Figure {
        title: "Stiff damping and a stiff Hamiltonian".into(),
        y_title: "factor of a step; distance from the law".into(),
        size: (268.0, 214.0),
        style: Style::Schemes,
        plots,
    };
    (!figure.plots.is_empty()).then(|| figure.svg())
}

/// One curve for each scheme.
fn plot(case: &CaseResult) -> Option<Plot> {
    let (_, x_title, (lo, hi)) = PLOTTED.into_iter().find(|(id, ..)| *id == case.case.id)?;
    let mut curves: Vec<Curve> = Vec::new();
    // `sexp` with Newton is `sexp` to the eye.
    for row in case.rows.iter().filter(|row| !row.newton) {
        // What is not finite, or overflows in the end, is at the top.
        let point = Measured::new(row.x?, row.measured.unwrap_or(hi).clamp(lo, hi));
        match curves.iter_mut().find(|curve| curve.name == row.scheme) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve::new(row.scheme, [point])),
        }
    }
    let (x_title, spacing) = (x_title.into(), Spacing::Decades);
    Some(Plot { x_title, spacing, lines: Vec::new(), curves })
}

/// The distance from the law over the number of steps, beside a random walk and a drift.
pub fn growth(growth: &[Growth]) -> String {
    let curves = growth.iter().filter(|run| run.drawn).map(|run| {
        let points = run.points.iter().map(|point| Measured::new(point.steps as f64, point.rms));
        Curve::new(run.id, points)
    });
    let (x_title, spacing, constant) = ("steps n".into(), Spacing::Decades, f64::EPSILON);
    let line = |name: &str, power, covered| Line { name: name.into(), constant, power, covered };
    let lines = vec![line("ε √n", 0.5, true), line("ε n", 1.0, false)];
    let plot = Plot { x_title, spacing, lines, curves: curves.collect() };
    Figure {
        title: "Distance from the conformal law over ten million steps".into(),
        y_title: "root mean square distance".into(),
        size: (430.0, 260.0),
        style: Style::Quantities,
        plots: vec![plot],
    }
    .svg()
}
