//! `exact-conformal`: the exact flow obeys the conformal law (Bréhier, Cohen and Komori 2025, §2).
//!
//! Along a path with piecewise linear noise the equation is an ordinary differential equation with
//! the same chain rule as the Stratonovich equation, and the law holds exactly. It is integrated by
//! the classical Runge–Kutta method, which knows nothing of the structure: its defect must vanish
//! with the fourth power of its step.
//!
//! What is measured is the variation of the relative defect dₙ = F(yₙ)e^{p∫γ}/F(y₀) − 1 along the
//! path, Σ|dₙ₊₁ − dₙ|. The defect at the end would be a sum of contributions of both signs, and its
//! leading term may cancel; the variation is Σ|cₙ|·h⁴(1 + O(h)), whose leading term cannot.

use systems::Invariant;

use crate::*;

pub(super) fn measure(conditions: &Conditions) -> Findings {
    let claims = [
        law(conditions, 0, &rigid_body_three_noises(1.0)),
        law(conditions, 1, &paper::rigid_body_energy(1.0)),
        law(conditions, 2, &paper::lotka_volterra_2_2(1.0)),
        law(conditions, 3, &paper::maxwell_bloch(1.0)),
        law(conditions, 4, &paper::poisson3_casimir(1.0)),
    ];
    Findings::of(claims.concat())
}

/// Linear pieces of the noise on [0, 1].
const PIECES: u64 = 64;
/// Runge–Kutta steps on each piece.
const SUBSTEPS: [u32; 2] = [4, 32];
/// Eight times more steps reduce a fourth-order defect by 4096; this leaves room for higher orders
/// of the error.
const REDUCTION: f64 = 1000.0;
/// Round-off: a piece of 32 Runge–Kutta steps rounds each some four times, which adds up like a
/// random walk to √32·4 ε, and the invariant at its ends as often; 64 pieces of 30 ε are 4e-13. A
/// variation below this has nothing left to be reduced.
const ROUND_OFF: f64 = 1e-12;

/// Makes a claim for each invariant of the system.
pub fn law<S: PoissonSystem<D, M>, G: Damping, const D: usize, const M: usize>(
    conditions: &Conditions,
    part: u64,
    problem: &Problem<S, G, D>,
) -> Vec<Claim> {
    let (system, erased) = (problem.system(), mc::Problem::of(problem));
    let tau = problem.t_end() / PIECES as f64;
    // The states at the ends of the pieces.
    let paths = SUBSTEPS.map(|substeps| {
        let mut noise = WienerPath::<M>::new(conditions.key(part), 0);
        let mut y = problem.y0();
        let mut path = vec![(0.0, y.to_vec())];
        for n in 0..PIECES {
            let (t, dw) = (n as f64 * tau, noise.increments(tau.sqrt()));
            y = runge_kutta(system, problem.damping(), t, tau, dw, substeps, y);
            path.push(((n + 1) as f64 * tau, y.to_vec()));
        }
        path
    });
    let claim = |(index, invariant): (usize, &Invariant)| {
        let variation = |path: &Path| {
            let defects: Vec<f64> =
                along(&erased, index, path).map(|(_, value, exact)| value / exact - 1.0).collect();
            defects.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum::<f64>()
        };
        let [before, after] = paths.each_ref().map(variation);
        let [coarse, fine] = SUBSTEPS.map(|n| {
            format!("variation of the relative defect of Runge–Kutta with {n} steps a piece")
        });
        let quantities = [
            Bounded::reported(coarse, before),
            Bounded::at_most(fine, after, f64::max(before / REDUCTION, ROUND_OFF)),
        ];
        let Invariant { name, formula, degree, .. } = invariant;
        let statement = format!(
            "{}: {name} = {formula} obeys the conformal law of degree {degree} on the exact flow",
            system.name()
        );
        Claim::new("exact-conformal", statement, Evidence::bounds(quantities))
    };
    system.invariants().iter().enumerate().map(claim).collect()
}
