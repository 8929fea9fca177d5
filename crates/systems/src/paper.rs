//! The problems of the paper (Bréhier, Cohen and Komori 2025, §5), each as a function.
//!
//! | problem | system | γ(t) | y(0) |
//! |---|---|---|---|
//! | [`pendulum`] | pendulum, c = 1 | 2 | (0.2, 1) |
//! | [`rigid_body_three_noises`] | rigid body, Î = (1, 2, 3) | ½ cos 2t | (cos 1.1, 0, sin 1.1) |
//! | [`rigid_body_one_noise`] | the same with W₁ alone | ½ cos 2t | the same |
//! | [`rigid_body_energy`] | the same with the noise H₀ | sin t | the same |
//! | [`lotka_volterra_1_1`] | a = −1, b = −1, c = 1 | sin t | (0.2, 0.4, 0.6) |
//! | [`lotka_volterra_2_2`] | a = −1, b = −2, c = 1 | sin t | the same |
//! | [`maxwell_bloch`] | Maxwell–Bloch | ½ cos 2t | (1, 2, 3) |
//! | [`poisson3_strong`], [`poisson3_casimir`] | c = 1 | ½ cos 2t, t | (1, 2, 3) |
//!
//! The rigid body has I = (2, 1, 2/3). The final time is an argument where the paper uses several.

use std::fmt::Display;

use crate::{
    Constant, Cosine, Linear, LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, Problem, RigidBody,
    RigidBodyEnergy, Sine,
};

/// Moments of inertia of the body, (2, 1, 2/3).
pub const INERTIA: [f64; 3] = [2.0, 1.0, 2.0 / 3.0];
/// Moments of inertia of the noises, (1, 2, 3).
pub const NOISE_INERTIA: [f64; 3] = [1.0, 2.0, 3.0];
/// Initial value of the Lotka–Volterra system, (0.2, 0.4, 0.6).
pub const LOTKA_VOLTERRA_START: [f64; 3] = [0.2, 0.4, 0.6];
/// Initial value of the Maxwell–Bloch and the three-dimensional Poisson system, (1, 2, 3).
pub const POISSON_START: [f64; 3] = [1.0, 2.0, 3.0];

/// Initial value of the rigid body, (cos 1.1, 0, sin 1.1).
pub fn rigid_body_start() -> [f64; 3] {
    [real::elementary::cos(1.1), 0.0, real::elementary::sin(1.1)]
}

/// Takes a value out of its `Result` where its parameters are constants known to be valid.
///
/// # Panics
/// With the error: that is a mistake in the caller.
#[track_caller]
pub fn valid<T, E: Display>(constructed: Result<T, E>) -> T {
    constructed.unwrap_or_else(|error| panic!("a constant set-up is not valid: {error}"))
}

/// ½ cos 2t.
pub fn half_cosine() -> Cosine {
    valid(Cosine::new(0.5, 2.0))
}

/// sin t.
pub fn sine() -> Sine {
    valid(Sine::new(1.0, 1.0))
}

/// The damped stochastic pendulum on [0, 1].
pub fn pendulum() -> Problem<Pendulum, Constant, 2> {
    valid(Problem::new(valid(Pendulum::new(1.0)), valid(Constant::new(2.0)), [0.2, 1.0], 1.0))
}

/// The rigid body with a noise about each axis.
pub fn rigid_body_three_noises(t_end: f64) -> Problem<RigidBody<3>, Cosine, 3> {
    let body = valid(RigidBody::three_noises(INERTIA, NOISE_INERTIA));
    valid(Problem::new(body, half_cosine(), rigid_body_start(), t_end))
}

/// The rigid body with W₁ alone on [0, 1].
pub fn rigid_body_one_noise() -> Problem<RigidBody<1>, Cosine, 3> {
    let body = valid(RigidBody::one_noise(INERTIA, NOISE_INERTIA[0]));
    valid(Problem::new(body, half_cosine(), rigid_body_start(), 1.0))
}

/// The rigid body with one noise, whose Hamiltonian is H₀ itself.
pub fn rigid_body_energy(t_end: f64) -> Problem<RigidBodyEnergy, Sine, 3> {
    valid(Problem::new(
        valid(RigidBodyEnergy::new(INERTIA, 1.0)),
        sine(),
        rigid_body_start(),
        t_end,
    ))
}

/// The Lotka–Volterra system of the strong errors, H = y₁y₂y₃, on [0, 1].
pub fn lotka_volterra_1_1() -> Problem<LotkaVolterra<1, 1>, Sine, 3> {
    valid(Problem::new(valid(LotkaVolterra::new(1.0)), sine(), LOTKA_VOLTERRA_START, 1.0))
}

/// The Lotka–Volterra system of the energy's evolution, H = y₁²y₂²y₃.
pub fn lotka_volterra_2_2(t_end: f64) -> Problem<LotkaVolterra<2, 2>, Sine, 3> {
    valid(Problem::new(valid(LotkaVolterra::new(1.0)), sine(), LOTKA_VOLTERRA_START, t_end))
}

/// The Maxwell–Bloch system.
pub fn maxwell_bloch(t_end: f64) -> Problem<MaxwellBloch, Cosine, 3> {
    valid(Problem::new(MaxwellBloch, half_cosine(), POISSON_START, t_end))
}

/// The three-dimensional Poisson system of the strong errors, on [0, ½].
pub fn poisson3_strong() -> Problem<Poisson3, Cosine, 3> {
    valid(Problem::new(valid(Poisson3::new(1.0)), half_cosine(), POISSON_START, 0.5))
}

/// The three-dimensional Poisson system of the Casimir's evolution.
pub fn poisson3_casimir(t_end: f64) -> Problem<Poisson3, Linear, 3> {
    valid(Problem::new(valid(Poisson3::new(1.0)), valid(Linear::new(1.0)), POISSON_START, t_end))
}
