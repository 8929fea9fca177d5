//! Random systems, the noise they get, and how often they are drawn.

use std::cell::Cell;
use std::fmt::Debug;

use dgrad::averaged;
use noise::Truncation;
use proptest::array::uniform;
use proptest::prelude::*;
use proptest::test_runner::{RngSeed, TestCaseResult, TestRunner};
use real::{Real, ScalarFunction};
use systems::{HamiltonianIncrement, PoissonSystem};

use crate::hamiltonian::{Hamiltonian, hamiltonian, polynomial};
use crate::structure::{Structure, vector};

/// dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ with any Hamiltonians.
#[derive(Clone, Copy, Debug)]
pub struct Several<const D: usize, const M: usize> {
    pub structure: Structure<D>,
    pub drift: Hamiltonian<D>,
    pub noise: [Hamiltonian<D>; M],
}

impl<const D: usize, const M: usize> PoissonSystem<D, M> for Several<D, M> {
    fn name(&self) -> &'static str {
        "several noises"
    }
    fn structure<R: Real>(&self, y: [R; D], v: [R; D]) -> [R; D] {
        self.structure.apply(y, v)
    }
    fn energy<R: Real>(&self, y: [R; D], dt: f64, dw: [f64; M]) -> R {
        let mut sum = self.drift.value(y) * R::constant(dt);
        for m in 0..M {
            sum = sum + self.noise[m].value(y) * R::constant(dw[m]);
        }
        sum
    }
    /// Two nodes, exact for polynomials of degree four, and not for sines and exponentials: a
    /// Casimir must not notice.
    fn averaged_gradient<R: Real>(&self, a: [R; D], b: [R; D], dt: f64, dw: [f64; M]) -> [R; D] {
        averaged::<2, R, _, D>(&HamiltonianIncrement { system: self, dt, dw }, a, b)
    }
}

pub fn several<const D: usize, const M: usize>(
    structure: impl Strategy<Value = Structure<D>>,
) -> impl Strategy<Value = Several<D, M>> {
    (structure, hamiltonian(), uniform(hamiltonian()))
        .prop_map(|(structure, drift, noise)| Several { structure, drift, noise })
}

/// dy = B∇H(dt + c∘dW) − γy dt with a homogeneous polynomial H.
pub fn one_noise<const D: usize>(
    structure: impl Strategy<Value = Structure<D>>,
    degrees: std::ops::RangeInclusive<usize>,
) -> impl Strategy<Value = Several<D, 1>> {
    (structure, polynomial(degrees), -1.0..1.0f64).prop_map(|(structure, h, size)| Several {
        structure,
        drift: Hamiltonian::Polynomial(h),
        noise: [Hamiltonian::Polynomial(h.times(size))],
    })
}

/// States.
pub fn state<const D: usize>() -> impl Strategy<Value = [f64; D]> + Clone {
    vector(1.5)
}

/// τ and the increments of K steps.
#[derive(Clone, Copy, Debug)]
pub struct Increments<const M: usize, const K: usize> {
    pub tau: f64,
    pub dw: [[f64; M]; K],
}

/// Steps between 10^low and 10^high, evenly on a logarithmic scale; increments spread over all that
/// truncation with a k of 1 to 4 lets through, the bounds included.
fn noise_between<const M: usize, const K: usize>(
    low: f64,
    high: f64,
) -> impl Strategy<Value = Increments<M, K>> {
    (low..high, 1..5u32, uniform(uniform(-1.25..1.25f64))).prop_map(
        |(exponent, k, shares): (f64, u32, [[f64; M]; K])| {
            let tau = 10f64.powf(exponent);
            let bound = Truncation::new(k).unwrap().bound(tau).unwrap();
            Increments { tau, dw: shares.map(|share| share.map(|x| bound * x.clamp(-1.0, 1.0))) }
        },
    )
}

/// τ from 10⁻⁶ to 0.9.
pub fn any_noise<const M: usize, const K: usize>() -> impl Strategy<Value = Increments<M, K>> {
    noise_between(-6.0, 0.9f64.log10())
}

/// τ from 0.01 to 0.1: large enough for a wrong method to be visibly wrong, small enough to be
/// solvable.
pub fn visible_noise<const M: usize, const K: usize>() -> impl Strategy<Value = Increments<M, K>> {
    noise_between(-2.0, -1.0)
}

/// Every run draws the same.
fn runner(cases: u32) -> TestRunner {
    TestRunner::new(ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(2025),
        failure_persistence: None,
        ..ProptestConfig::default()
    })
}

/// Checks `cases` draws; a failure is shrunk and shown.
pub fn for_all<S: Strategy<Value: Debug>>(
    cases: u32,
    strategy: S,
    check: impl Fn(S::Value) -> TestCaseResult,
) {
    if let Err(error) = runner(cases).run(&strategy, check) {
        panic!("{error}");
    }
}

/// The share of `cases` draws for which `holds`.
pub fn share<S: Strategy<Value: Debug>>(
    cases: u32,
    strategy: S,
    holds: impl Fn(S::Value) -> bool,
) -> f64 {
    let count = Cell::new(0);
    for_all(cases, strategy, |value| {
        count.set(count.get() + u32::from(holds(value)));
        Ok(())
    });
    f64::from(count.get()) / f64::from(cases)
}

/// How much of a tolerance is used at most.
#[derive(Default)]
pub struct Largest(Cell<f64>);

impl Largest {
    /// Fails where `defect` exceeds `allowed`, or is no number.
    pub fn check(&self, defect: f64, allowed: f64) -> TestCaseResult {
        let used = if defect == 0.0 { 0.0 } else { defect / allowed };
        prop_assert!(used <= 1.0, "defect {defect:e}, allowed {allowed:e}");
        self.0.set(self.0.get().max(used));
        Ok(())
    }

    /// Fails where the tolerance was generous: a bound that is nowhere near attained might not
    /// notice a small mistake.
    pub fn report(&self, what: &str, at_least: f64) {
        println!("{what}: largest defect {:.3} of the tolerance", self.0.get());
        assert!(self.0.get() >= at_least, "{what}: {}", self.0.get());
    }
}
