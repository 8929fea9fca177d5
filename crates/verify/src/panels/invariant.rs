//! Invariants along one path of each scheme, beside their conformal law.

use stats::Point;
use systems::{Damping, Invariant, InvariantKind, Problem};

use super::curves::{Curve, curves};
use crate::{
    Conditions, Findings, Method, PaperSystem, TRUNCATED, Words,
    conformal_law::{ROUND_OFF, along, approach, largest_defect},
    results::{Claim, Evidence, Kind, Panel, Series},
};

/// A relative defect above this is visible in a figure: Euler–Maruyama is expected there.
const VISIBLE: f64 = 1e-3;

/// A panel of invariants along one path.
pub struct InvariantPanel {
    pub words: Words,
    pub steps: u64,
    /// Numbers of the invariants to show, the one of the paper first.
    pub invariants: &'static [usize],
}

impl InvariantPanel {
    /// One path of each scheme on the same noise, with a claim for each curve.
    pub fn follow<S: PaperSystem<D, M>, G: Damping, const D: usize, const M: usize>(
        &self,
        conditions: &Conditions,
        problem: &Problem<S, G, D>,
    ) -> Findings {
        let curves = curves(conditions, problem);
        conditions.progress.begin(conditions.id(), self.steps * curves.len() as u64);
        let follow = |curve: &Curve<S, D, M>| {
            let path = conditions.path(0, problem, curve.scheme.as_ref(), self.steps, 0);
            conditions.progress.advance(self.steps);
            path
        };
        let paths: Vec<_> = curves.iter().map(follow).collect();
        conditions.progress.end();

        let known = problem.system().invariants();
        let mut findings = Findings::default();
        let mut all = Vec::new();
        for &index in self.invariants {
            let Invariant { name, kind, .. } = known[index];
            let (id, function) = match kind {
                InvariantKind::Energy => ("energy-balance", "H"),
                InvariantKind::Casimir => ("conformal-casimir", "the Casimir"),
            };
            for (curve, path) in curves.iter().zip(&paths) {
                let values = along(problem, index, path);
                let largest = largest_defect(&values);
                let points =
                    values.into_iter().map(|(t, value, exact)| Point::Value { t, value, exact });
                all.push(Series {
                    scheme: curve.name.into(),
                    quantity: name.into(),
                    points: points.collect(),
                    max_relative_defect: Some(largest),
                    ..Series::default()
                });
                // Of schemes that have not the law only Euler–Maruyama has to leave it visibly.
                let obeys = curve.method.obeys_law(kind);
                let visibly = curve.method == Method::EulerMaruyama;
                let (tolerance, statement) = match (obeys, visibly) {
                    (true, _) => (ROUND_OFF, "obeys the conformal law at every step"),
                    (_, true) => (VISIBLE, "visibly leaves the conformal law"),
                    _ => (ROUND_OFF, "leaves the conformal law, and returns to it as τ → 0"),
                };
                let measured = match &path.failure {
                    // A path that ended early proves nothing about the rest.
                    Some(failure) => Evidence::Undecided { reason: failure.to_string() },
                    None if !obeys && !visibly && largest > ROUND_OFF => {
                        let scheme = curve.scheme.as_ref();
                        approach(conditions, problem, scheme, index, self.steps, largest)
                    }
                    None => Evidence::Defect {
                        invariant: name.into(),
                        paths: 1,
                        steps: self.steps,
                        largest,
                        tolerance,
                        obeys,
                    },
                };
                let claim = Claim::new(id, format!("{function} {statement}"), measured)
                    .about(conditions.id(), curve.name)
                    .proven(curve.method == Method::Sexp);
                findings.claims.push(claim);
            }
        }
        let steps = format!("τ = {}, {TRUNCATED}", problem.t_end() / self.steps as f64);
        let failures = paths.iter().filter_map(|path| path.failure.as_ref());
        findings.panels.push(Panel {
            samples: 1,
            reference: "the conformal law exp(−p ∫γ) F(y₀)".into(),
            failures: failures.map(ToString::to_string).collect(),
            series: all,
            ..self.words.panel(conditions.id(), Kind::Invariant, problem, &steps)
        });
        findings
    }
}
