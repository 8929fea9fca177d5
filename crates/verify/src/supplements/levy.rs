//! `spin-pair-levy`: `sexp-levy` beyond three dimensions and over long paths.

use analysis::worse;
use schemes::BuiltIn;
use systems::paper::{half_cosine, rigid_body_three_noises};

use crate::{
    Compiled, Conditions, Curve, Findings, Words,
    conformal_law::largest_defect,
    panels::strong::{Grid, StrongPanel},
    results::{Claim, Evidence},
    two_spins::spin_pair,
};

/// Strong errors on two spins, and the Casimirs of two systems.
pub fn measure(conditions: &Conditions) -> Findings {
    let words = Words {
        title: "Two spins in a fluctuating field: strong convergence with and without Lévy areas",
        system: "Heisenberg pair, J = 1, K = 0.5, σ = 0.8, D = 6, three noises",
        paper: "Not in the paper, whose scheme has strong order 1/2 for noises that do not commute.",
    };
    let (spins, body) = (spin_pair(half_cosine()), rigid_body_three_noises(1.0));
    let curves = Compiled::of(&spins).curves(&[BuiltIn::Sexp, BuiltIn::SexpLevy]);
    let grid = conditions.choose(Grid { last: 11, samples: 500 }, Grid { last: 9, samples: 256 });
    let mut findings = StrongPanel::new(words, grid).measure(conditions, &curves);
    let of_body = &Compiled::of(&body).curves(&[BuiltIn::SexpLevy])[0];
    findings.claims.push(obeys_law(conditions, conditions.id(), &curves[1]));
    findings.claims.push(obeys_law(conditions, "rigid-body-strong-3", of_body));
    findings
}

/// Largest relative defect of a Casimir that counts as round-off on a path of 1024 steps of 2⁻¹⁰:
/// sixteen ε a step, of random sign, are √1024·16 ε = 1.1e-13.
const ROUND_OFF: f64 = 1e-13;
const STEPS: u64 = 1024;
const PATHS: u64 = 32;

/// Every Casimir on its conformal law, at every step of many paths.
fn obeys_law(conditions: &Conditions, panel: &str, curve: &Curve<'_>) -> Claim {
    let problem = &curve.setup.problem;
    let mut largest = 0.0;
    for path in 0..PATHS {
        let path = conditions.path(3, &curve.setup, STEPS, path);
        for index in 0..problem.laws.len() {
            largest = worse(largest, largest_defect(problem, index, &path));
        }
        if path.len() as u64 <= STEPS {
            largest = f64::NAN;
        }
    }
    let measured = Evidence::Defect {
        invariant: "every Casimir".into(),
        paths: PATHS,
        steps: STEPS,
        largest,
        tolerance: ROUND_OFF,
        obeys: true,
    };
    let statement = "every Casimir obeys the conformal law at every step, Lévy areas included";
    Claim::new("conformal-casimir", statement, measured).about(panel, curve.name).proven(false)
}
