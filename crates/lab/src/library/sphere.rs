//! so(3): time changes, rotations about one axis, and Brownian motion on the sphere.
//!
//! Linear noises Hₘ = σ_m·y without a drift have the generator ½Σ L_m² with the rotations L_m
//! about σ_m: E y = exp(½T Σ(σ_mσ_mᵀ − |σ_m|²I)) y₀. Three of size σ along the axes have the
//! Laplacian of the sphere, and E of a harmonic polynomial of degree l decays by
//! e^{−l(l+1)σ²T/2}; a linear H₀ turns it.

use schemes::{Heun, Sexp, SexpLevy};

use super::{
    Entry, How, expected,
    law::Normal,
    system::{Body, Rate, UNDAMPED, problem},
};

/// A point of the unit sphere.
const START: [f64; 3] = [0.48, 0.6, 0.64];

/// E y₁ where (y₁, y₂) = r(cos, sin)(φ − θ): y₁ cos θ + y₂ sin θ.
fn turned(theta: Normal) -> f64 {
    START[0] * theta.cos(1.0) + START[1] * theta.sin(1.0)
}

pub fn entries() -> Vec<Entry> {
    let sexp = Sexp::default();
    // A symmetric top with H₁ = cH₀: θ = (a₃ − a₁)y₃(T + cW).
    let top = Body { a: [1.0, 1.0, 3.0], b: [1.4], ..Body::linear([[0.0; 3]]) };
    let rate = 2.0 * START[2];
    // About one axis: θ = (c₃ + a₃y₃)T + (σ₃ + b y₃)W.
    let axis = Body {
        a: [0.0, 0.0, 1.0],
        c: [0.0, 0.0, 0.5],
        b: [0.5],
        ..Body::linear([[0.0, 0.0, 0.8]])
    };
    let about = Normal::new(0.5 + START[2], (0.8 + 0.5 * START[2]).powi(2));
    let isotropic =
        |sigma: f64| Body::linear([[sigma, 0.0, 0.0], [0.0, sigma, 0.0], [0.0, 0.0, sigma]]);
    let plane = Body::linear([[0.8, 0.0, 0.0], [0.0, 0.8, 0.0]]);
    let turning = Body { c: [0.0, 0.0, 2.0], ..isotropic(0.5) };
    let damping = Rate::Jump { at: 0.6, before: 1.0, after: 0.0 };
    let unit = |system| problem(system, UNDAMPED, START, 1.0);
    vec![
        expected(
            ("time change", "y₁ of a symmetric top, H₁ = 0.7 H₀"),
            sexp,
            problem(top, UNDAMPED, START, 1.0),
            |y| y[0],
            How::to(0.005),
            turned(Normal::new(rate, (0.7 * rate).powi(2))),
        ),
        expected(
            ("time change", "y₁ of a damped top, c = 0.7"),
            sexp,
            // y₃ decays, and so does the rate of θ: with y₃(t) = y₃e^{−∫γ} and γ = 1 on [0, 0.6],
            // ∫e^{−Γ} = 1 − e^{−0.6} + 0.4e^{−0.6} and ∫e^{−2Γ} = ½(1 − e^{−1.2}) + 0.4e^{−1.2}.
            problem(top, damping, START, 1.0),
            |y| y[0],
            How::to(0.005),
            {
                let (e, e2) = ((-0.6f64).exp(), (-1.2f64).exp());
                let (mean, square) = (1.0 - e + 0.4 * e, 0.5 * (1.0 - e2) + 0.4 * e2);
                e * turned(Normal::new(rate * mean, (0.7 * rate).powi(2) * square))
            },
        ),
        expected(
            ("one axis", "y₁"),
            sexp,
            problem(axis, UNDAMPED, START, 1.0),
            |y| y[0],
            How::to(0.005),
            turned(about),
        ),
        // y₁ > 0: φ − θ within π/2 of 2πk, with φ = atan2(y₂, y₁).
        expected(
            ("indicators", "y₁ > 0, one axis"),
            sexp,
            problem(axis, UNDAMPED, START, 1.0),
            |y| f64::from(u8::from(y[0] > 0.0)),
            How::to(0.02),
            Normal { mean: START[1].atan2(START[0]) - about.mean, ..about }.cos_above(0.0),
        ),
        // Σσσᵀ − |σ|²I = −σ² diag(1, 1, 2).
        expected(
            ("sphere", "y₁, two noises"),
            sexp,
            problem(plane, UNDAMPED, START, 1.0),
            |y| y[0],
            How::to(0.005).antithetic(),
            START[0] * (-0.32f64).exp(),
        ),
        expected(
            ("sphere", "y₃, two noises, areas"),
            SexpLevy::new(&plane, START),
            problem(plane, UNDAMPED, START, 1.0),
            |y| y[2],
            How::to(0.01),
            START[2] * (-0.64f64).exp(),
        ),
        expected(
            ("sphere", "y₃, three noises"),
            sexp,
            unit(isotropic(0.7)),
            |y| y[2],
            How::to(0.005).antithetic(),
            START[2] * (-0.49f64).exp(),
        ),
        // y₃² − ⅓ has degree two.
        expected(
            ("sphere", "y₃², three noises, Heun"),
            Heun,
            unit(isotropic(0.7)),
            |y| y[2] * y[2],
            How::to(0.005).antithetic(),
            1.0 / 3.0 + (START[2] * START[2] - 1.0 / 3.0) * (-3.0 * 0.49f64).exp(),
        ),
        // y₁y₂ has degree two.
        expected(
            ("sphere", "y₁y₂, three noises"),
            sexp,
            unit(isotropic(0.7)),
            |y| y[0] * y[1],
            How::to(0.005).antithetic(),
            START[0] * START[1] * (-3.0 * 0.49f64).exp(),
        ),
        // y₃³ − ⅗y₃ has degree three.
        expected(
            ("sphere", "y₃³, three noises"),
            sexp,
            unit(isotropic(0.5)),
            |y| y[2].powi(3),
            How::to(0.005).antithetic(),
            (START[2].powi(3) - 0.6 * START[2]) * (-6.0 * 0.25f64).exp()
                + 0.6 * START[2] * (-0.25f64).exp(),
        ),
        // Turned by 2T about the third axis, clockwise.
        expected(
            ("sphere", "y₁, three noises on a rotation"),
            sexp,
            unit(turning),
            |y| y[0],
            How::to(0.01).antithetic(),
            (-0.25f64).exp() * turned(Normal::new(2.0, 0.0)),
        ),
    ]
}
