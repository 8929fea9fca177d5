//! `spin-pair-levy`: `sexp-levy` beyond three dimensions and over long paths.

use crate::{two_spins::spin_pair, *};

/// Largest relative defect of a Casimir that counts as round-off on a path of 1024 steps of 2⁻¹⁰:
/// sixteen ε a step, of random sign, are √1024·16 ε = 1.1e-13.
const ROUND_OFF: f64 = 1e-13;
const STEPS: u64 = 1024;
const PATHS: u64 = 32;

/// Strong errors on two spins, and the Casimirs of two systems, at every step of many paths.
pub fn measure(conditions: &Conditions) -> Findings {
    let words = [
        "Two spins in a fluctuating field: strong convergence with and without Lévy areas",
        "Heisenberg pair, J = 1, K = 0.5, σ = 0.8, D = 6, three noises",
        "Not in the paper, whose scheme has strong order 1/2 for noises that do not commute.",
    ];
    let (spins, body) = (spin_pair(paper::half_cosine()), rigid_body_three_noises(1.0));
    let curves = Compiled::of(&spins).curves(&[BuiltIn::Sexp, BuiltIn::SexpLevy]);
    let panel = StrongPanel::new(words, conditions.choose((11, 500), (9, 256)));
    let mut findings = panel.measure(conditions, &curves);
    let of_body = &Compiled::of(&body).curves(&[BuiltIn::SexpLevy])[0];
    for (panel, Curve { name, setup, .. }) in
        [(conditions.id, &curves[1]), ("rigid-body-strong-3", of_body)]
    {
        let mut largest = 0.0;
        for path in 0..PATHS {
            let path = conditions.path(3, setup, STEPS, path);
            let laws = 0..setup.problem.laws.len();
            let defects = laws.map(|law| largest_defect(&setup.problem, law, &path));
            largest = defects.fold(largest, worse);
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
        let claim = Claim::new("conformal-casimir", statement, measured);
        findings.claims.push(claim.about(panel, name).proven(false));
    }
    findings
}
