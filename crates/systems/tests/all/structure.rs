//! What every system claims: B is skew, its Casimirs are Casimirs, its energies are energies,
//! degrees and forms are right. And the same checks reject systems that are wrong on purpose.

use crate::common::{Check, Numbers, Region, dot, every_system, invariant_gradient, matrix, size};
use real::Real;
use systems::{
    Form, Invariant, InvariantKind, LotkaVolterra, PoissonSystem, RigidBody, vector_field,
};

const POINTS: usize = 500;

/// Sums of at most nine products, each with a few roundings, and powers with a few more: relative
/// to the sum of the absolute values.
const ROUND_OFF: f64 = 16.0 * f64::EPSILON;

/// The largest defect at random points.
fn worst<const D: usize>(
    region: Region,
    seed: u64,
    defect: impl Fn([f64; D], &mut Numbers) -> f64,
) -> f64 {
    let mut numbers = Numbers(seed);
    (0..POINTS).map(|_| defect(region.point(&mut numbers), &mut numbers)).fold(0.0, f64::max)
}

/// Largest |vᵀBv|, relative to its terms.
fn skew_defect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    region: Region,
) -> f64 {
    worst(region, 1, |y, numbers| {
        let v = numbers.vector::<D>();
        let (b, field) = (matrix(system, y), system.structure(y, v));
        for i in 0..D {
            // It is a matrix. An infinite entry is no round-off.
            let terms: f64 = (0..D).map(|j| (b[i][j] * v[j]).abs()).sum();
            let defect = (field[i] - dot(b[i], v)).abs();
            assert!(defect <= ROUND_OFF * terms && terms.is_finite(), "{}", system.name());
        }
        dot(v, field).abs() / size(v, b, v)
    })
}

/// Largest |∇CᵀBv|, relative to its terms.
fn casimir_defect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    region: Region,
    index: usize,
) -> f64 {
    worst(region, 2, |y, numbers| {
        let (v, slope) = (numbers.vector::<D>(), invariant_gradient(system, index, y));
        dot(slope, system.structure(y, v)).abs() / size(slope, matrix(system, y), v)
    })
}

/// Largest |∇F·B∇h|, relative to its terms, for random weights of drift and noise.
fn energy_defect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    region: Region,
    index: usize,
) -> f64 {
    worst(region, 3, |y, numbers| {
        let (dt, dw) = (numbers.next(), numbers.vector());
        let slope = invariant_gradient(system, index, y);
        let terms = size(slope, matrix(system, y), system.gradient(y, dt, dw));
        dot(slope, vector_field(system, y, dt, dw)).abs() / terms
    })
}

/// Largest |∇F·y − pF|, relative to its terms: Euler's identity.
fn degree_defect<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    region: Region,
    index: usize,
    degree: f64,
) -> f64 {
    worst(region, 4, |y: [f64; D], _| {
        let slope = invariant_gradient(system, index, y);
        let value = degree * system.invariant(index, y);
        let terms: f64 = (0..D).map(|i| (slope[i] * y[i]).abs()).sum();
        (dot(slope, y) - value).abs() / terms
    })
}

struct Claims {
    invariants: usize,
}

impl Check for Claims {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
        let name = system.name();
        let skew = skew_defect(system, region);
        assert!(skew < ROUND_OFF, "{name}: {skew}");
        for (index, invariant) in system.invariants().iter().enumerate() {
            self.invariants += 1;
            // A Casimir is kept by every Hamiltonian, an energy by its own.
            let kept = match invariant.kind {
                InvariantKind::Casimir => casimir_defect(system, region, index),
                InvariantKind::Energy => energy_defect(system, region, index),
            };
            assert!(kept < ROUND_OFF, "{name} {invariant:?}: {kept}");
            let degree = degree_defect(system, region, index, invariant.degree);
            assert!(degree < ROUND_OFF, "{name} {invariant:?}: {degree}");
            form_is_as_claimed(system, region, index, invariant);
        }
    }
}

/// Linear: F(a + b) = F(a) + F(b). Quadratic: F(a + b) + F(a − b) = 2F(a) + 2F(b). And neither for
/// the rest.
fn form_is_as_claimed<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    region: Region,
    index: usize,
    invariant: &Invariant,
) {
    let mut numbers = Numbers(5);
    let f = |y| -> f64 { system.invariant(index, y) };
    let (mut linear, mut quadratic): (f64, f64) = (0.0, 0.0);
    for _ in 0..POINTS {
        let (a, b): ([f64; D], [f64; D]) = (region.point(&mut numbers), region.point(&mut numbers));
        // Half and a tenth: every point stays where the system is defined.
        let sum = std::array::from_fn(|i| a[i] + 0.1 * b[i]);
        let difference = std::array::from_fn(|i| a[i] - 0.1 * b[i]);
        let tenth = b.map(|x| 0.1 * x);
        linear = linear.max((f(sum) - f(a) - f(tenth)).abs());
        quadratic = quadratic.max((f(sum) + f(difference) - 2.0 * f(a) - 2.0 * f(tenth)).abs());
    }
    // Points have components up to 2.2, coefficients are up to 6: values up to 3·6·2.2², a few
    // roundings each.
    let exact = 3.0 * 6.0 * 2.2 * 2.2 * 4.0 * f64::EPSILON;
    let seen = if linear < exact {
        Form::Linear
    } else if quadratic < exact {
        Form::Quadratic
    } else {
        Form::Homogeneous
    };
    assert_eq!(seen, invariant.form, "{} {invariant:?}", system.name());
}

#[test]
fn every_system_is_what_it_claims() {
    let mut claims = Claims { invariants: 0 };
    every_system(&mut claims);
    // Pendulum 0, rigid body 1 + 1 + 2, Lotka–Volterra 3·2, Maxwell–Bloch 1, Poisson3 2.
    assert_eq!(claims.invariants, 13);
}

/// A rigid body with one sign of B wrong.
struct WrongSign(RigidBody<3>);

impl PoissonSystem<3, 3> for WrongSign {
    fn name(&self) -> &'static str {
        "wrong sign"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        let [a, b, _] = self.0.structure(y, v);
        [a, b, y[0] * v[1] + y[1] * v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 3]) -> R {
        self.0.energy(y, dt, dw)
    }
    fn invariant<R: Real>(&self, index: usize, y: [R; 3]) -> R {
        self.0.invariant(index, y)
    }
}

/// Lotka–Volterra with the paper's Casimir, which is ln H.
struct LogarithmOfEnergy(LotkaVolterra<2, 2>);

impl PoissonSystem<3, 1> for LogarithmOfEnergy {
    fn name(&self) -> &'static str {
        "logarithm of the energy"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        self.0.structure(y, v)
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
        self.0.energy(y, dt, dw)
    }
    fn invariant<R: Real>(&self, _index: usize, y: [R; 3]) -> R {
        self.0.invariant(0, y).ln()
    }
}

#[test]
fn wrong_systems_are_rejected() {
    let body = RigidBody::three_noises([2.0, 1.0, 0.5], [1.0, 2.0, 3.0]).unwrap();
    assert!(skew_defect(&WrongSign(body), Region::Box) > 0.1);
    assert!(casimir_defect(&WrongSign(body), Region::Box, 0) > 0.1);
    // A wrong degree, and a Casimir of three noises taken for an energy of one: it is kept, so that
    // is fine.
    assert!(degree_defect(&body, Region::Box, 0, 3.0) > 0.1);
    assert!(energy_defect(&body, Region::Box, 0) < ROUND_OFF);

    let populations = LotkaVolterra::<2, 2>::new(1.0).unwrap();
    let claimed = LogarithmOfEnergy(populations);
    assert!(casimir_defect(&claimed, Region::Positive, 0) > 0.1);
    // It is kept as an energy is, for it is a function of H.
    assert!(energy_defect(&claimed, Region::Positive, 0) < ROUND_OFF);
    // The energy is no Casimir, and the Casimir is no multiple of it.
    assert!(casimir_defect(&populations, Region::Positive, 0) > 0.1);
    assert!(casimir_defect(&populations, Region::Positive, 1) < ROUND_OFF);
}
