//! The 14 panels of the paper as data (Bréhier, Cohen and Komori 2025, §5).

mod invariant;
pub mod strong;
pub mod weak;

use real::elementary::{cos, sin};

use crate::*;
use invariant::follow;
use strong::compare;
use weak::WEAK_IDS;

/// Experiments that make the panels, in the order of the paper.
pub static EXPERIMENTS: &[Experiment] = &[
    (&["pendulum-strong"], |conditions| {
        compare(
            conditions,
            [
                "Pendulum: strong convergence",
                "pendulum, c = 1",
                "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
            ],
            (12, 500),
            true,
            &paper::pendulum(),
        )
    }),
    (&["rigid-body-casimir"], |conditions| {
        follow(
            conditions,
            [
                "Rigid body: the Casimir ½|y|² along one path",
                BODY_3,
                "sexp follows the conformal law of the Casimir; Euler–Maruyama does not.",
            ],
            100,
            &[0],
            &paper::rigid_body_three_noises(10.0),
        )
    }),
    (&["rigid-body-strong-3"], |conditions| {
        compare(
            conditions,
            [
                "Rigid body, three noises: strong convergence",
                BODY_3,
                "With several noises all three schemes have strong order 1/2.",
            ],
            (14, 1000),
            true,
            &paper::rigid_body_three_noises(1.0),
        )
    }),
    (&["rigid-body-strong-1"], |conditions| {
        compare(
            conditions,
            [
                "Rigid body, only W₁: strong convergence",
                BODY_1,
                "With one noise sexp and midpoint have strong order 1, Euler–Maruyama 1/2.",
            ],
            (14, 1000),
            true,
            &paper::rigid_body_one_noise(),
        )
    }),
    (WEAK_IDS, weak::measure),
    (&["rigid-body-energy"], |conditions| {
        follow(
            conditions,
            [
                "Rigid body, noise H₀: the energy along one path",
                BODY_ENERGY,
                "sexp follows the conformal law of the energy.",
            ],
            100,
            &[1, 0],
            &paper::rigid_body_energy(10.0),
        )
    }),
    (&["lotka-volterra-energy"], |conditions| {
        follow(
            conditions,
            [
                "Lotka–Volterra: the energy along one path",
                "Lotka–Volterra, a = −1, b = −2, c = 1",
                "sexp follows the conformal law of the energy, a Hamiltonian that is not quadratic.",
            ],
            100,
            &[0, 1],
            &paper::lotka_volterra_2_2(10.0),
        )
    }),
    (&["lotka-volterra-strong"], |conditions| {
        compare(
            conditions,
            [
                "Lotka–Volterra: strong convergence",
                VOLTERRA,
                "sexp has strong order 1; m(H) = 0, so the theorems do not apply. (The paper's \
             reference has the finest step of the figure, where the error is then zero by \
             construction; here it is finer.)",
            ],
            (12, 500),
            false,
            &paper::lotka_volterra_1_1(),
        )
    }),
    (&["maxwell-bloch-casimir"], |conditions| {
        follow(
            conditions,
            [
                "Maxwell–Bloch: the Casimir ½(y₂² + y₃²) along one path",
                "Maxwell–Bloch",
                "sexp follows the conformal law of the Casimir.",
            ],
            500,
            &[0],
            &paper::maxwell_bloch(5.0),
        )
    }),
    (&["poisson3-casimir"], |conditions| {
        follow(
            conditions,
            [
                "Three-dimensional Poisson system: the Casimir ½(y₁+y₂+y₃)² along one path",
                POISSON,
                "sexp follows the conformal law of the Casimir; Euler–Maruyama slightly less well, \
             midpoint well.",
            ],
            100,
            &[0, 1],
            &paper::poisson3_casimir(2.0),
        )
    }),
    (&["poisson3-strong"], |conditions| {
        compare(
            conditions,
            [
                "Three-dimensional Poisson system: strong convergence",
                POISSON,
                "sexp and midpoint have strong order 1, Euler–Maruyama has 1/2.",
            ],
            (12, 400),
            true,
            &paper::poisson3_strong(),
        )
    }),
];

/// A test function with its name.
pub const fn phi<const D: usize>(
    name: &'static str,
    function: fn([f64; D]) -> f64,
) -> Observable<D> {
    Observable { name, function }
}

/// Test functions of the weak panels: twelve, three for each panel.
pub fn weak_observables() -> [Observable<3>; 12] {
    [
        phi("y1", |y| y[0]),
        phi("y2", |y| y[1]),
        phi("y3", |y| y[2]),
        phi("y1^2", |y| y[0] * y[0]),
        phi("y2^2", |y| y[1] * y[1]),
        phi("y3^2", |y| y[2] * y[2]),
        phi("cos y1", |y| cos(y[0])),
        phi("cos y2", |y| cos(y[1])),
        phi("cos y3", |y| cos(y[2])),
        phi("sin y1", |y| sin(y[0])),
        phi("sin y2", |y| sin(y[1])),
        phi("sin y3", |y| sin(y[2])),
    ]
}
