//! Invariants along one path of each scheme, beside their conformal law.

use schemes::{BuiltIn, Energy};
use stats::Point;

use crate::{
    Compiled, Conditions, Curve, Findings, TRUNCATED, Words,
    conformal_law::{ROUND_OFF, along, approach, largest_defect},
    experiment::Path,
    results::{Claim, Evidence, Kind, Panel, Series},
};

/// A relative defect above this is visible in a figure: Euler–Maruyama is expected there.
const VISIBLE: f64 = 1e-3;

/// One path of each scheme on the same noise, with a claim for each of these invariants, the one of
/// the paper first, and each curve.
pub fn follow(
    conditions: &Conditions,
    words: Words,
    steps: u64,
    invariants: &[usize],
    compiled: &Compiled<'_>,
) -> Findings {
    let (id, problem) = (conditions.id(), &compiled.problem);
    let curves = conditions.curves(compiled);
    conditions.progress.begin(id, steps * curves.len() as u64);
    let path = |curve| {
        let path = conditions.path(0, curve, steps, 0);
        conditions.progress.advance(steps);
        path
    };
    let paths: Vec<_> = curves.iter().map(|curve| path(&curve.setup)).collect();
    conditions.progress.end();
    let failure = |curve: &Curve<'_>, path: &Path| {
        let (t, _) = path[path.len() - 1];
        let failed = path.len() as u64 <= steps;
        failed.then(|| format!("{}: the step after t = {t} failed", curve.name))
    };

    let (mut series, mut claims) = (Vec::new(), Vec::new());
    for &index in invariants {
        let law = &problem.laws[index];
        let (statement_id, function) = match law.casimir {
            true => ("conformal-casimir", "the Casimir"),
            false => ("energy-balance", "H"),
        };
        for (curve, path) in curves.iter().zip(&paths) {
            let largest = largest_defect(problem, index, path);
            let point = |(t, value, exact)| Point::Value { t, value, exact };
            series.push(Series {
                scheme: curve.name.into(),
                quantity: law.name.clone(),
                points: along(problem, index, path).into_iter().map(point).collect(),
                max_relative_defect: Some(largest),
                ..Series::default()
            });
            // Of schemes that have not the law only Euler–Maruyama has to leave it visibly.
            let kept = curve.method.properties();
            let obeys = kept.exact_damping && (law.casimir || kept.energy == Energy::Kept);
            let (tolerance, statement) = match (obeys, curve.method) {
                (true, _) => (ROUND_OFF, "obeys the conformal law at every step"),
                (_, BuiltIn::EulerMaruyama) => (VISIBLE, "visibly leaves the conformal law"),
                _ => (ROUND_OFF, "leaves the conformal law, and returns to it as τ → 0"),
            };
            let measured = match failure(curve, path) {
                // A path that ended early proves nothing about the rest.
                Some(reason) => Evidence::Undecided { reason },
                None if !obeys && tolerance == ROUND_OFF && largest > ROUND_OFF => {
                    approach(conditions, &curve.setup, index, steps, largest)
                }
                None => {
                    let (invariant, paths) = (law.name.clone(), 1);
                    Evidence::Defect { invariant, paths, steps, largest, tolerance, obeys }
                }
            };
            let claim = Claim::new(statement_id, format!("{function} {statement}"), measured);
            claims.push(claim.about(id, curve.name).proven(curve.method == BuiltIn::Sexp));
        }
    }
    let of_steps = format!("τ = {}, {TRUNCATED}", problem.t_end / steps as f64);
    let failures = curves.iter().zip(&paths).filter_map(|(curve, path)| failure(curve, path));
    let panel = Panel {
        samples: 1,
        reference: "the conformal law exp(−p ∫γ) F(y₀)".into(),
        failures: failures.collect(),
        series,
        ..words.panel(id, Kind::Invariant, problem, &of_steps)
    };
    Findings { panels: vec![panel], claims }
}
