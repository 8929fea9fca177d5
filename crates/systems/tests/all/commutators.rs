//! Commutators of the noise fields: against formulas, against finite differences, tangent to the
//! Casimirs; and when noises are found to commute.

use crate::common::{
    Check, INERTIA, NOISE_INERTIA, Numbers, Plain, Region, dot, every_system, invariant_gradient,
};
use real::Real;
use systems::{
    InvariantKind, PoissonSystem, RigidBody, SystemError, area_gradient, noises_commute,
    unit_noise, vector_field,
};

/// A random skew matrix.
fn skew<const M: usize>(numbers: &mut Numbers) -> [[f64; M]; M] {
    let mut areas = [[0.0; M]; M];
    for m in 0..M {
        for l in m + 1..M {
            areas[m][l] = numbers.next();
            areas[l][m] = -areas[m][l];
        }
    }
    areas
}

/// Σ A_ml (f_l′fₘ − fₘ′f_l) by central differences.
fn by_differences<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    y: [f64; D],
    areas: [[f64; M]; M],
    h: f64,
) -> [f64; D] {
    let field = |m: usize, y: [f64; D]| vector_field(system, y, 0.0, unit_noise(m));
    let along = |l: usize, v: [f64; D]| {
        let at = |s: f64| field(l, std::array::from_fn(|i| y[i] + s * v[i]));
        let (ahead, behind) = (at(h), at(-h));
        std::array::from_fn::<f64, D, _>(|i| (ahead[i] - behind[i]) / (2.0 * h))
    };
    let mut sum = [0.0; D];
    for m in 0..M {
        for l in m + 1..M {
            let (one, other) = (along(l, field(m, y)), along(m, field(l, y)));
            for i in 0..D {
                sum[i] += areas[m][l] * (one[i] - other[i]);
            }
        }
    }
    sum
}

struct Commutators;

impl Check for Commutators {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
        let mut numbers = Numbers(21);
        for _ in 0..200 {
            let y: [f64; D] = region.point(&mut numbers);
            let areas = skew::<M>(&mut numbers);
            let ours = system.commutators(y, areas);
            let provided = Plain(system).commutators(y, areas);
            let name = system.name();
            // Fields of degree two at points within [−2, 2]: three pairs of terms of at most 2·2³.
            // Differences with h = 1e-4 are exact for quadratic fields but for cancellation, ε·8/h
            // a derivative.
            let terms = 48.0;
            let differences = by_differences(system, y, areas, 1e-4);
            // By Jacobi's identity, which all these systems have.
            let slope = area_gradient(system, y, areas);
            let by_jacobi = system.structure(y, slope);
            for i in 0..D {
                let rounding = 16.0 * f64::EPSILON * terms;
                assert!((ours[i] + by_jacobi[i]).abs() <= rounding, "{name} at {y:?}");
                assert!((ours[i] - provided[i]).abs() <= rounding, "{name} at {y:?}");
                let difference = (ours[i] - differences[i]).abs();
                assert!(difference <= f64::EPSILON * terms * 1e4, "{name} at {y:?}");
            }
            for (index, invariant) in system.invariants().iter().enumerate() {
                if invariant.kind == InvariantKind::Casimir {
                    let slope = invariant_gradient(system, index, y);
                    let along = dot(slope, ours);
                    assert!(along.abs() <= 32.0 * f64::EPSILON * terms, "{name} at {y:?}: {along}");
                }
            }
        }
    }
}

#[test]
fn commutators_are_what_they_should_be() {
    every_system(&mut Commutators);
}

struct NeedsAreas(Vec<(&'static str, bool)>);

impl Check for NeedsAreas {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
        let y: [f64; D] = region.point(&mut Numbers(4));
        let commute = noises_commute(system, y);
        assert_eq!(commute, M == 1, "{}", system.name());
        self.0.push((system.name(), commute));
    }
}

#[test]
fn commuting_noises_are_recognised() {
    let mut seen = NeedsAreas(Vec::new());
    every_system(&mut seen);
    assert!(seen.0.contains(&("rigid-body", false)) && seen.0.contains(&("pendulum", true)));
    // Two of the three noises of the body alone, and a point where every field of the third
    // vanishes.
    let body = RigidBody::three_noises(INERTIA, NOISE_INERTIA).unwrap();
    assert!(!noises_commute(&body, [0.0, 0.0, 0.0]));
}

/// H₁ = p and H₂ = (q − `from`)³, where q > `edge` if there is one, on q, p > 0.
struct Plane {
    from: f64,
    edge: Option<f64>,
}

impl PoissonSystem<2, 2> for Plane {
    fn name(&self) -> &'static str {
        "plane"
    }
    fn structure<R: Real>(&self, _y: [R; 2], v: [R; 2]) -> [R; 2] {
        [v[1], -v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 2], _dt: f64, dw: [f64; 2]) -> R {
        let cube = (y[0] - self.from).powi(3);
        let second =
            self.edge.map_or(cube, |edge| R::where_less(R::constant(edge), y[0], cube, R::zero()));
        y[1] * dw[0] + second * dw[1]
    }
    fn check_domain(&self, y: [f64; 2]) -> Result<(), SystemError> {
        SystemError::unless_all(&y, |x| x > 0.0, "q, p > 0")
    }
}

#[test]
fn noises_that_do_not_commute_far_from_the_initial_value_or_beside_it() {
    // At y₀ itself [f₁, f₂] = (0, −6(q − q₀)) is zero, and the domain ends a thousandth away.
    assert!(!noises_commute(&Plane { from: 1e-3, edge: None }, [1e-3; 2]));
    // A noise that acts only beyond an edge.
    for edge in [0.5, 5.0, 1e3] {
        assert!(!noises_commute(&Plane { from: edge, edge: Some(edge) }, [0.1; 2]));
    }
}

/// H = (q₁, q₂, ½p₁²) on (q₁, q₂, p₁, p₂): the first and the third noise alone do not commute.
struct Apart;

impl PoissonSystem<4, 3> for Apart {
    fn name(&self) -> &'static str {
        "apart"
    }
    fn structure<R: Real>(&self, _y: [R; 4], v: [R; 4]) -> [R; 4] {
        [v[2], v[3], -v[0], -v[1]]
    }
    fn energy<R: Real>(&self, y: [R; 4], _dt: f64, dw: [f64; 3]) -> R {
        y[0] * dw[0] + y[1] * dw[1] + y[2] * y[2] * (0.5 * dw[2])
    }
}

#[test]
fn every_two_noises_are_compared() {
    assert!(!noises_commute(&Apart, [0.3, 0.1, 0.5, 0.2]));
}

/// so(3) with H₁ a quadratic form and H₂ a function of it and of C = ½|y|².
struct Functions(usize);

impl PoissonSystem<3, 2> for Functions {
    fn name(&self) -> &'static str {
        "functions of one energy"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            y[j] * v[k] - y[k] * v[j]
        })
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 2]) -> R {
        let square = |i: usize| y[i] * y[i] * 0.5;
        let c = square(0) + square(1) + square(2);
        let h = square(0) * 0.7 + square(1) * 1.3 + y[0] * y[2] * 0.4;
        let [one, two] = match self.0 {
            0 => [h, h * h],
            1 => [h, h + c * 10.0],
            2 => [h, c * c + c * 0.5],
            _ => [h, h + square(2) * 1e-10],
        };
        h * dt + one * dw[0] + two * dw[1]
    }
}

#[test]
fn functions_of_one_energy_and_of_casimirs_commute() {
    let mut numbers = Numbers(9);
    for _ in 0..200 {
        let y = std::array::from_fn(|_| 3.0 * numbers.next());
        for case in 0..3 {
            assert!(noises_commute(&Functions(case), y), "{case} {y:?}");
        }
        assert!(!noises_commute(&Functions(3), y), "{y:?}");
    }
}
