//! Invariants along one path of each scheme, beside their conformal law.

use schemes::Energy;

use crate::{
    conformal_law::{ROUND_OFF, approach},
    *,
};

/// Relative defect from which it is visible in a figure: Euler–Maruyama is expected there.
const VISIBLE: f64 = 1e-3;

/// Follows one path of each scheme on the same noise, with a claim for each curve and each of the
/// given invariants, the one of the paper first.
pub fn follow<S: Tuned<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    words: Words,
    steps: u64,
    invariants: &[usize],
    problem: &Problem<S, G, D>,
) -> Findings {
    let (id, compiled) = (conditions.id, Compiled::of(problem));
    let problem = &compiled.problem;
    let of_steps = format!("τ = {}, {TRUNCATED}", problem.t_end / steps as f64);
    let mut panel = Panel {
        samples: 1,
        reference: "the conformal law exp(−p ∫γ) F(y₀)".into(),
        ..panel(words, id, Kind::Invariant, problem, &of_steps)
    };
    let curves = of_paper(&compiled).into_iter().map(|curve| {
        let path = conditions.path(0, &curve.setup, steps, 0);
        let (t, _) = path[path.len() - 1];
        let failed = path.len() as u64 <= steps;
        let failure = failed.then(|| format!("{}: the step after t = {t} failed", curve.name));
        panel.failures.extend(failure.clone());
        (curve, path, failure)
    });
    let (curves, mut claims) = (curves.collect::<Vec<_>>(), Vec::new());
    for &index in invariants {
        let law = &problem.laws[index];
        let (statement_id, function) = match law.casimir {
            true => ("conformal-casimir", "the Casimir"),
            false => ("energy-balance", "H"),
        };
        for (curve, path, failure) in &curves {
            let largest = largest_defect(problem, index, path);
            let point = |(t, value, exact)| Point::Value { t, value, exact };
            panel.series.push(Series {
                scheme: curve.name.into(),
                quantity: law.name.clone(),
                points: along(problem, index, path).map(point).collect(),
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
            let measured = match failure.clone() {
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
    Findings { panels: vec![panel], claims }
}
