//! Skewness, Casimirs and discrete gradients of random systems, before any scheme.
//!
//! Each check evaluates a quantity that is zero in exact arithmetic with [`Bounded`] numbers: the
//! value must be within its own rounding error.

use dgrad::{GradientField, averaged, mean_cosine, mean_sine, midpoint};
use proptest::prelude::*;
use proptest::test_runner::TestCaseResult;
use real::{Real, ScalarFunction};

use crate::hamiltonian::{Hamiltonian, MAX_DEGREE, polynomial, transcendental};
use crate::law::Conserved;
use crate::random::{Largest, for_all, state};
use crate::rounding::{Bounded, dot};
use crate::structure::{Structure, any_structure, with_casimir};

const CASES: u32 = 1000;
/// Bounds are worst cases: of a sum of many roundings of random sign a hundredth is reached in a
/// thousand draws.
const SHARP: f64 = 0.01;

/// `value` is zero up to its rounding.
fn zero(largest: &Largest, value: Bounded) -> TestCaseResult {
    largest.check(value.value.abs(), value.error)
}

fn structures_are_skew<const D: usize>() {
    let (square, cross) = (Largest::default(), Largest::default());
    let draws = (any_structure::<D>(), state(), state(), state());
    for_all(CASES, draws, |(structure, y, u, v): (Structure<D>, _, _, _)| {
        let [y, u, v] = [y, u, v].map(|x: [f64; D]| x.map(Bounded::exact));
        let (bu, bv) = (structure.apply(y, u), structure.apply(y, v));
        zero(&square, dot(v, bv))?;
        zero(&cross, dot(u, bv) + dot(v, bu))
    });
    square.report(&format!("v'Bv, D = {D}"), SHARP);
    cross.report(&format!("u'Bv + v'Bu, D = {D}"), SHARP);
}

#[test]
fn every_structure_is_skew() {
    structures_are_skew::<2>();
    structures_are_skew::<3>();
    structures_are_skew::<4>();
    structures_are_skew::<5>();
}

fn casimirs_are_casimirs<const D: usize>() {
    let largest = Largest::default();
    for_all(CASES, (with_casimir::<D>(), state(), state()), |(structure, y, v)| {
        let [y, v] = [y, v].map(|x: [f64; D]| x.map(Bounded::exact));
        let casimir = structure.base.casimir().unwrap();
        zero(&largest, dot(casimir.normal(y), structure.apply(y, v)))
    });
    largest.report(&format!("grad C'Bv, D = {D}"), SHARP);
}

#[test]
fn every_casimir_is_a_casimir() {
    casimirs_are_casimirs::<3>();
    casimirs_are_casimirs::<4>();
    casimirs_are_casimirs::<5>();
}

fn polynomial_gradients<const D: usize>() {
    let (identity, closed, nodes) = (Largest::default(), Largest::default(), Largest::default());
    for_all(CASES, (polynomial::<D>(1..=MAX_DEGREE), state(), state()), |(h, a, b)| {
        let [a, b] = [a, b].map(|x: [f64; D]| x.map(Bounded::exact));
        let mean = h.slope(a, b);
        let step = std::array::from_fn(|i| b[i] - a[i]);
        zero(&identity, dot(mean, step) - (Conserved::value(&h, b) - Conserved::value(&h, a)))?;
        let back = h.slope(b, a);
        // More nodes integrate the same polynomial; their smaller nodes are good to 8ε only, twice
        // what `Bounded` takes for a constant.
        let finer: [Bounded; D] = averaged::<5, _, _, D>(&h, a, b);
        let middle = h.gradient(midpoint(a, b));
        for i in 0..D {
            // Nodes are summed in pairs about the middle: ∇̄H(a, b) and ∇̄H(b, a) are the same
            // bits.
            prop_assert_eq!(mean[i].value.to_bits(), back[i].value.to_bits());
            let difference = mean[i] - finer[i];
            nodes.check(difference.value.abs(), 2.0 * difference.error)?;
            if h.degree <= 2 {
                zero(&closed, mean[i] - middle[i])?;
            }
        }
        Ok(())
    });
    identity.report(&format!("polynomials, identity, D = {D}"), SHARP);
    closed.report(&format!("quadratics, closed form, D = {D}"), SHARP);
    nodes.report(&format!("polynomials, 2 and 5 nodes, D = {D}"), SHARP);
}

#[test]
fn discrete_gradients_of_polynomials_are_exact() {
    polynomial_gradients::<2>();
    polynomial_gradients::<3>();
    polynomial_gradients::<4>();
    polynomial_gradients::<5>();
}

/// Enough for a phase that moves by θ = |wᵀ(b − a)| ≤ 1.5·3·5 = 22.5: the error of n nodes is below
/// θ²ⁿ(n!)⁴/((2n+1)(2n)!³), which is 10⁻²³ for n = 32, and less than that for exponentials.
const MANY: usize = 32;

/// By how much each |wᵢ| may be off in a mean of ∇H = H′w: a rule with n nodes is good to (8 + n)ε,
/// and each node to an ε of the way, along which H′ changes by θ times itself.
fn node_error(size: f64, theta: f64) -> f64 {
    (8 + MANY) as f64 * f64::EPSILON * size * (1.0 + theta)
}

fn transcendental_gradients<const D: usize>() {
    let identity = Largest::default();
    for_all(CASES / 4, (transcendental::<D>(), state(), state()), |(h, a, b)| {
        let (size, w) = match h {
            Hamiltonian::Polynomial(_) => unreachable!("polynomials have a test of their own"),
            Hamiltonian::Sine(amplitude, w, _) => (amplitude.abs(), w),
            Hamiltonian::Exponential(amplitude, w) => {
                (amplitude.abs() * f64::max(dot(w, a), dot(w, b)).exp(), w)
            }
        };
        let theta: f64 = (0..D).map(|i| (w[i] * (b[i] - a[i])).abs()).sum();
        let nodes = node_error(size, theta);
        let [a, b] = [a, b].map(|x: [f64; D]| x.map(Bounded::exact));
        let mean: [Bounded; D] = averaged::<MANY, _, _, D>(&h, a, b);
        let back: [Bounded; D] = averaged::<MANY, _, _, D>(&h, b, a);
        let step: [Bounded; D] = std::array::from_fn(|i| b[i] - a[i]);
        let defect = dot(mean, step) - (h.value(b) - h.value(a));
        identity.check(defect.value.abs(), defect.error + nodes * theta)?;
        for i in 0..D {
            prop_assert_eq!(mean[i].value.to_bits(), back[i].value.to_bits());
        }
        Ok(())
    });
    identity.report(&format!("sines and exponentials, identity, D = {D}"), SHARP);
}

#[test]
fn discrete_gradients_by_many_nodes() {
    transcendental_gradients::<2>();
    transcendental_gradients::<3>();
    transcendental_gradients::<5>();
}

#[test]
fn closed_forms_of_sines_are_their_quadrature() {
    /// H = sin y or −cos y.
    struct Wave(bool);
    impl GradientField<1> for Wave {
        fn gradient<R: Real>(&self, [y]: [R; 1]) -> [R; 1] {
            [if self.0 { y.cos() } else { y.sin() }]
        }
    }
    let largest = Largest::default();
    for_all(CASES, (-10.0..10.0f64, -10.0..10.0f64, any::<bool>()), |(a, b, sine)| {
        let [x, y] = [a, b].map(Bounded::exact);
        let closed = if sine { mean_cosine(x, y) } else { mean_sine(x, y) };
        let [mean]: [Bounded; 1] = averaged::<MANY, _, _, 1>(&Wave(sine), [x], [y]);
        let difference = closed - mean;
        largest.check(difference.value.abs(), difference.error + node_error(1.0, (b - a).abs()))
    });
    largest.report("mean sine and cosine, closed form", SHARP);
}
