//! Contractions are solved to round-off by both methods, at every size of the unknowns.

use crate::common::{PrefersNewton, SineMap, difference, norm, residual};
use nonlin::{FixedPoint, Method, Outcome, Solver};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use real::Real;

const METHODS: [Method; 2] = [Method::FixedPoint, Method::Newton];

/// Numbers of a map in three dimensions: 2·9 of the matrix and the phases, 3 of the constant, 3 of
/// the start.
const NUMBERS: usize = 24;

fn numbers() -> impl Strategy<Value = Vec<f64>> {
    proptest::collection::vec(-1.0..1.0f64, NUMBERS)
}

/// ‖z − ψ(z)‖₁ of a solution, relative to ‖c‖₁ + D·r.
///
/// Newton leaves the rounding of ψ: D + 3 operations of half an ulp on each component.
const NEWTON_RESIDUAL: f64 = 4.0 * f64::EPSILON;
/// The fixed point adds its tolerance, 2ε‖z‖₁, and the error of foreseeing the last residual from
/// two changes, which is large when a mode that contracts fast hides a slow one: among 6·10⁶ random
/// maps, 1 in 10³ left more than 8ε, 1 in 10⁵ more than 64ε, none more than 175ε.
const FIXED_POINT_RESIDUAL: f64 = 256.0 * f64::EPSILON;

/// The same cases in every run.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

fn size<const D: usize>(map: &SineMap<D>) -> f64 {
    norm(map.constant) + D as f64 * map.scale
}

fn solved_by_both<const D: usize>(
    contraction: f64,
    numbers: &[f64],
    scale: f64,
) -> Result<(), TestCaseError> {
    let map = SineMap::<D>::new(contraction, numbers).scaled(scale);
    // The third begins with Newton's long first sweep.
    let [fixed, newton] = METHODS.map(|method| Solver::new(method).solve(&map));
    let preferred = Solver::default().solve(&PrefersNewton(map));
    // A residual r is an error of at most r/(1 − L) in the maximum norm, D times that in the sum
    // norm.
    let apart = (NEWTON_RESIDUAL + FIXED_POINT_RESIDUAL) * D as f64 / (1.0 - contraction);
    for (found, allowed) in
        [(fixed, FIXED_POINT_RESIDUAL), (newton, NEWTON_RESIDUAL), (preferred, NEWTON_RESIDUAL)]
    {
        prop_assert!(found.outcome.converged(), "{:?}", found.outcome);
        let left = residual(&map, found.z) / size(&map);
        prop_assert!(left <= allowed, "{left} {found:?}");
        let distance = difference(fixed.z, found.z) / size(&map);
        prop_assert!(distance <= apart, "{distance} {apart}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(cases(5000))]

    #[test]
    fn random_contractions(contraction in 0.0..0.9, numbers in numbers()) {
        solved_by_both::<1>(contraction, &numbers, 1.0)?;
        solved_by_both::<2>(contraction, &numbers, 1.0)?;
        solved_by_both::<3>(contraction, &numbers, 1.0)?;
    }

    #[test]
    fn every_size_of_the_unknowns(
        contraction in 0.0..0.9,
        numbers in numbers(),
        exponent in -150.0..150.0f64,
    ) {
        solved_by_both::<3>(contraction, &numbers, 10f64.powf(exponent))?;
    }

    #[test]
    fn the_robust_method_solves_every_contraction(contraction in 0.0..0.95, numbers in numbers()) {
        let map = SineMap::<3>::new(contraction, &numbers);
        let solver = Solver { max_sweeps: 1, ..Solver::default() };
        let found = solver.solve(&map);
        prop_assert!(found.outcome.converged());
        if let Outcome::Robust { residual: reported, iterations } = found.outcome {
            prop_assert_eq!(reported, residual(&map, found.z));
            // One Newton method at least, and 1/MIN_STEP = 2¹⁴ at most, of up to twenty iterations
            // each.
            prop_assert!((1..=20 << 14).contains(&iterations), "{}", iterations);
            prop_assert!(reported <= NEWTON_RESIDUAL * size(&map));
        }
    }

    #[test]
    fn a_weak_contraction_is_solved_by_sweeps_alone(
        contraction in 0.0..0.3,
        numbers in numbers(),
    ) {
        // 0.3^31 < ε/2, where the change is zero: 8 evaluations in the first sweep and 3 in each of
        // 8 more, and a few for the limit cycle of roundings. Close to zero the tolerance, relative
        // to ‖z‖, is finer than ψ.
        let map = SineMap::<3>::new(contraction, &numbers);
        prop_assume!(norm(Solver::default().solve(&map).z) > 0.1 * size(&map));
        for method in METHODS {
            let Outcome::Fast { iterations } = Solver::new(method).solve(&map).outcome else {
                return Err(TestCaseError::fail("not solved by the fast method"));
            };
            prop_assert!(iterations <= 14, "{}", iterations);
        }
    }
}

/// z = Az with the solution 0, which no relative tolerance of ‖z‖ helps to find.
#[derive(Clone, Copy)]
struct Linear {
    factor: f64,
    start: [f64; 2],
}

impl FixedPoint<2> for Linear {
    fn start(&self) -> [f64; 2] {
        self.start
    }
    fn map<R: Real>(&self, z: [R; 2]) -> [R; 2] {
        [z[1] * self.factor, -(z[0] * self.factor)]
    }
}

#[test]
fn the_zero_solution_is_found() {
    for (method, factor) in METHODS.into_iter().flat_map(|m| [0.0, 0.01, 0.5, 0.99].map(|f| (m, f)))
    {
        for scale in [0.0, 1e-150, 1.0, 1e150] {
            let equation = Linear { factor, start: [scale, -2.0 * scale] };
            let found = Solver::new(method).solve(&equation);
            assert!(found.outcome.converged(), "{method:?} {factor} {scale}");
            // Round-off of the start is left at most.
            assert!(norm(found.z) <= 4.0 * f64::EPSILON * scale, "{found:?}");
            assert!(scale > 0.0 || found.outcome == Outcome::Fast { iterations: 1 });
        }
    }
}

/// A settled solution is one sweep behind the one it settles, and no further from the equation: on
/// maps that contract slowly what is left has shrunk.
#[test]
fn a_settled_solution_is_one_sweep_further() {
    let mut numbers = crate::common::Numbers(3);
    let (mut left, mut settled_left) = (0.0, 0.0);
    for _ in 0..200 {
        let map = SineMap::<3>::new(0.6, &numbers.take(NUMBERS));
        let plain = Solver::new(Method::FixedPoint);
        let (found, settled) = (plain.solve(&map), plain.settled().solve(&map));
        assert_eq!(found.outcome, settled.outcome, "the sweep is not counted");
        // A sweep of the fixed point is three evaluations.
        assert_eq!(settled.z, map.map(map.map(map.map(found.z))));
        left += residual(&map, found.z);
        settled_left += residual(&map, settled.z);
    }
    assert!(settled_left < 0.8 * left, "{settled_left:e} {left:e}");
}

/// With a contraction of 10⁻³ the prediction ψ(ψ(z₀)) is right to 10⁻⁶, Newton's step to its
/// square, and the long first sweep is all that it takes: of the fixed point, too, whose eleven
/// evaluations leave 10⁻³³.
#[test]
fn a_long_first_sweep_solves_a_strong_contraction() {
    let mut numbers = crate::common::Numbers(4);
    for _ in 0..200 {
        let map = SineMap::<3>::new(1e-3, &numbers.take(NUMBERS));
        for found in [Solver::default().solve(&map), Solver::default().solve(&PrefersNewton(map))] {
            assert_eq!(found.outcome, Outcome::Fast { iterations: 1 }, "{map:?}");
            assert!(residual(&map, found.z) <= NEWTON_RESIDUAL * size(&map));
        }
    }
}

#[test]
fn the_number_of_sweeps_is_kept() {
    // Contraction 0.9 in one dimension needs some 300 evaluations: not within two sweeps, hence
    // Newton.
    let map =
        SineMap { matrix: [[-0.9]], phase: [[0.0]], constant: [0.1], start: [1.0], scale: 1.0 };
    for max_sweeps in [0, 1, 2] {
        let found = Solver { max_sweeps, ..Solver::default() }.solve(&map);
        assert!(matches!(found.outcome, Outcome::Robust { .. }), "{:?}", found.outcome);
        assert!(residual(&map, found.z) <= FIXED_POINT_RESIDUAL * size(&map));
    }
}
