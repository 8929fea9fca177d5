//! Twins of the one-step remainders.

use schemes::Sexp;
use verify::results::Claim;
use verify::{
    Conditions,
    statements::local::{self, PIECES, Vector, difference, remainder_claims},
};

/// The increment over the whole step.
fn whole(pieces: &[Vector; PIECES]) -> Vector {
    std::array::from_fn(|m| pieces.iter().map(|dw| dw[m]).sum())
}

/// The expansion of the exact flow with ½ΔWΔWᵀ for the iterated integrals: the remainder is then of
/// order τ.
pub fn without_areas(conditions: &Conditions) -> Claim {
    let remainder = |tau: f64, pieces: &[Vector; PIECES]| {
        let straight = whole(pieces).map(|w| w / PIECES as f64);
        // On one straight line the iterated integrals are ½ΔWΔWᵀ and the areas vanish.
        difference(local::exact_end(tau, pieces), local::expansion(tau, &[straight; PIECES]))
    };
    remainder_claims(conditions, "local-exact", "the exact flow", remainder).swap_remove(0)
}

/// The expansion of the scheme without ½Σ fₘ′f_l ΔŴ_lΔŴₘ.
pub fn without_second_order(conditions: &Conditions) -> Claim {
    let remainder = |tau: f64, pieces: &[Vector; PIECES]| {
        difference(local::scheme_end(&Sexp, tau, pieces)[0], local::first_order(tau, whole(pieces)))
    };
    remainder_claims(conditions, "local-sexp", "sexp", remainder).swap_remove(0)
}
