//! The figures of the page.

use report::distinct;
use report::figure::{Curve, Figure, Line, Measured, Plot, Spacing, Style};
use stability::results::{Case, Growth, Row, Stability};

/// The long runs that the figure shows: as many as can be told apart.
const SHOWN: [&str; 5] = [
    "default solver, undamped",
    "undamped",
    "constant γ",
    "γ = ½cos 2t",
    "Lotka–Volterra, H, undamped",
];

/// Stiff damping beside the stiff Hamiltonian; none unless both were run.
pub fn stiff(results: &Stability) -> Option<Figure> {
    let case = |id: &str| results.cases.iter().find(|case| case.id == id);
    Some(Figure {
        title: "Schemes under stiff damping and with a stiff Hamiltonian".to_owned(),
        y_title: "factor of a step; distance from the law".to_owned(),
        size: (268.0, 214.0),
        style: Style::Schemes,
        plots: vec![
            plot(case("stiff-damping")?, "damping in a step, γτ", (1e-12, 1e12)),
            plot(case("stiff-hamiltonian")?, "frequency ω (τ = 1/64)", (1e-16, 1e8)),
        ],
    })
}

/// One curve for each scheme; values outside of the range are drawn at its border, and those that
/// are not finite at the top.
fn plot(case: &Case, x_title: &str, (lo, hi): (f64, f64)) -> Plot {
    let schemes = distinct(case.rows.iter().map(|row| row.scheme.as_str()));
    let curve = |scheme: &str| {
        let rows = case.rows.iter().filter(|row| row.scheme == scheme);
        let value = |row: &Row| row.measured.unwrap_or(hi).clamp(lo, hi);
        Curve::new(scheme, rows.filter_map(|row| Some(Measured::new(row.x?, value(row)))))
    };
    // `sexp` with Newton's method cannot be told from `sexp`.
    let curves = schemes.into_iter().filter(|scheme| *scheme != "sexp-newton").map(curve);
    Plot {
        x_title: x_title.to_owned(),
        spacing: Spacing::Decades,
        lines: Vec::new(),
        curves: curves.collect(),
    }
}

/// The root mean square of the distance over the number of steps, with a random walk and a bias.
pub fn growth(runs: &[Growth]) -> Figure {
    let curve = |run: &Growth| {
        let points = run.points.iter();
        Curve::new(&run.id, points.map(|end| Measured::new(end.steps as f64, end.rms)))
    };
    let line = |name: &str, power, covered| Line {
        name: name.to_owned(),
        constant: f64::EPSILON,
        power,
        covered,
    };
    let shown = runs.iter().filter(|run| SHOWN.contains(&run.id.as_str()));
    Figure {
        title: "Distance from the conformal law over ten million steps".to_owned(),
        y_title: "root mean square distance from the law".to_owned(),
        size: (430.0, 260.0),
        style: Style::Quantities,
        plots: vec![Plot {
            x_title: "steps n".to_owned(),
            spacing: Spacing::Decades,
            lines: vec![line("ε √n", 0.5, true), line("ε n", 1.0, false)],
            curves: shown.map(curve).collect(),
        }],
    }
}
