//! The vector fields against the right-hand sides written out by hand, with the paper's misprints
//! corrected, and the Itô corrections against formulas and against finite differences.

use crate::common::{Check, INERTIA, NOISE_INERTIA, Numbers, Region, every_system};
use systems::{
    LotkaVolterra, MaxwellBloch, Pendulum, Poisson3, PoissonSystem, RigidBody, RigidBodyEnergy,
    ito_correction, unit_noise, vector_field,
};

/// The drift f₀ and the diffusions f₁ … f_M at y.
type Fields<const D: usize, const M: usize> = ([f64; D], [[f64; D]; M]);

/// Both sides have a few products of numbers of the size of the terms, some sines, and for real
/// exponents powers of a few ulp each; `terms` is the largest term.
fn assert_close<const D: usize>(ours: [f64; D], exact: [f64; D], terms: f64, what: &str) {
    for i in 0..D {
        assert!(
            (ours[i] - exact[i]).abs() <= 32.0 * f64::EPSILON * terms,
            "{what}: {ours:?} {exact:?}"
        );
    }
}

fn compare<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: &S,
    region: Region,
    by_hand: impl Fn([f64; D]) -> Fields<D, M>,
) {
    let mut numbers = Numbers(11);
    for _ in 0..300 {
        let y = region.point(&mut numbers);
        let (drift, diffusions) = by_hand(y);
        let name = system.name();
        // Points are within [−2, 2] and coefficients within 6: no term of degree two exceeds 6·2·2.
        let field = vector_field(system, y, 1.0, [0.0; M]);
        assert_close(field, drift, 24.0, &format!("drift of {name}"));
        for m in 0..M {
            let field = vector_field(system, y, 0.0, unit_noise(m));
            assert_close(field, diffusions[m], 24.0, &format!("W{} of {name}", m + 1));
        }
    }
}

fn times<const D: usize>(c: f64, v: [f64; D]) -> [f64; D] {
    v.map(|x| c * x)
}

/// The free rigid body: Euler's equations.
fn euler([x, y, z]: [f64; 3]) -> [f64; 3] {
    let [i1, i2, i3] = INERTIA;
    [(1.0 / i3 - 1.0 / i2) * y * z, (1.0 / i1 - 1.0 / i3) * z * x, (1.0 / i2 - 1.0 / i1) * x * y]
}

/// c·(y₁(y₂ − ab y₃), −ab y₂(y₁ + a y₃), −ab y₃(b y₁ + y₂)) with p = ab: the powers have cancelled.
fn populations(a: f64, b: f64, c: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let p = a * b;
    [c * x * (y - p * z), -c * p * y * (x + a * z), -c * p * z * (b * x + y)]
}

#[test]
fn lotka_volterra() {
    fn check<const P: i32, const Q: i32>(c: f64) {
        let b = -f64::from(Q);
        compare(&LotkaVolterra::<P, Q>::new(c).unwrap(), Region::Positive, |y| {
            let f = populations(f64::from(P) / b, b, c, y);
            (f, [f])
        });
    }
    check::<2, 2>(1.3);
    check::<1, 1>(1.0);
    check::<3, 2>(0.5);
}

#[test]
fn the_discrete_gradient_of_a_polynomial_is_exact_however_far() {
    // From one corner of the region to the other.
    let system = LotkaVolterra::<3, 2>::new(1.0).unwrap();
    let (a, b) = ([0.3, 1.7, 0.5], [1.7, 0.3, 1.5]);
    let mean: [f64; 3] = system.averaged_gradient(a, b, 1.0, [0.0]);
    let work = [0, 1, 2].map(|i| mean[i] * (b[i] - a[i]));
    let energy = |y| -> f64 { system.invariant(0, y) };
    let defect = work.iter().sum::<f64>() - (energy(b) - energy(a));
    let terms: f64 = work.iter().map(|term| term.abs()).sum();
    assert!(defect.abs() <= 64.0 * f64::EPSILON * terms, "{defect:e}");
}

#[test]
fn fields_are_those_written_out() {
    compare(&Pendulum::new(0.7).unwrap(), Region::Box, |[p, q]| {
        let f = [-q.sin(), p];
        (f, [times(0.7, f)])
    });
    let [j1, j2, j3] = NOISE_INERTIA;
    compare(&RigidBody::three_noises(INERTIA, NOISE_INERTIA).unwrap(), Region::Box, |y| {
        let [a, b, c] = y;
        // The paper has the last component of the first with the wrong sign.
        let first = [0.0, a * c / j1, -a * b / j1];
        let second = [-b * c / j2, 0.0, a * b / j2];
        let third = [b * c / j3, -a * c / j3, 0.0];
        (euler(y), [first, second, third])
    });
    compare(&RigidBody::one_noise(INERTIA, 1.5).unwrap(), Region::Box, |y| {
        let [a, b, c] = y;
        (euler(y), [[0.0, a * c / 1.5, -a * b / 1.5]])
    });
    compare(&RigidBodyEnergy::new(INERTIA, 0.7).unwrap(), Region::Box, |y| {
        (euler(y), [times(0.7, euler(y))])
    });
    // The paper's first drift component is y₂y₃; B∇H₀ says y₂.
    compare(&MaxwellBloch, Region::Box, |[a, b, c]| ([b, c * a, -b * a], [[b, 0.0, 0.0]]));
    // The paper's third component is cos y₁ − cos y₃; B∇H says cos y₁ − cos y₂.
    compare(&Poisson3::new(0.7).unwrap(), Region::Box, |y| {
        let [a, b, c] = y.map(f64::cos);
        let f = [b - c, c - a, a - b];
        (f, [times(0.7, f)])
    });
}

#[test]
#[should_panic(expected = "W1 of rigid-body")]
fn the_misprint_of_the_rigid_body_is_seen() {
    compare(&RigidBody::one_noise(INERTIA, 1.0).unwrap(), Region::Box, |y| {
        (euler(y), [[0.0, y[0] * y[2], y[0] * y[1]]])
    });
}

/// Relative step of the central differences: error h²/6·|f‴| of truncation and ε/h of rounding,
/// both near 10⁻¹⁰.
const H: f64 = 1e-5;
/// Third derivatives of the fields along themselves are up to some hundreds of the field's size.
const DIFFERENCE: f64 = 1e-7;

/// ½Σ fₘ′fₘ by central differences of fₘ along fₘ.
struct Differences;

impl Check for Differences {
    fn check<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
        &mut self,
        system: &S,
        region: Region,
    ) {
        let mut numbers = Numbers(14);
        for _ in 0..100 {
            let y: [f64; D] = region.point(&mut numbers);
            let mut expected = [0.0; D];
            let mut terms = 1.0;
            for m in 0..M {
                let field = |y| vector_field(system, y, 0.0, unit_noise(m));
                let f: [f64; D] = field(y);
                let forward = field(std::array::from_fn(|i| y[i] + H * f[i]));
                let backward = field(std::array::from_fn(|i| y[i] - H * f[i]));
                for i in 0..D {
                    expected[i] += 0.5 * (forward[i] - backward[i]) / (2.0 * H);
                    terms += f[i] * f[i];
                }
            }
            let ours = ito_correction(system, y);
            for i in 0..D {
                assert!(
                    (ours[i] - expected[i]).abs() < DIFFERENCE * terms,
                    "{} at {y:?}: {ours:?} {expected:?}",
                    system.name()
                );
            }
        }
    }
}

#[test]
fn ito_correction_by_differences() {
    every_system(&mut Differences);
}

#[test]
fn invariants_have_the_values_of_their_formulas() {
    // All at y = (1, 2, 3), in numbers that are not rounded.
    let y = [1.0, 2.0, 3.0];
    let body = RigidBodyEnergy::new([2.0, 1.0, 0.5], 0.7).unwrap();
    let values: [f64; 2] = [0, 1].map(|index| body.invariant(index, y));
    assert_eq!(values, [7.0, 0.25 + 2.0 + 9.0]);
    let bloch: f64 = MaxwellBloch.invariant(0, y);
    assert_eq!(bloch, 6.5);
    let poisson = Poisson3::new(0.7).unwrap();
    let values: [f64; 2] = [0, 1].map(|index| poisson.invariant(index, y));
    assert_eq!(values, [18.0, 6.0]);
    // ab = 2, −b = 2: H = y₁²y₂²y₃ and C = 2y₁ + y₂ + y₃.
    let populations = LotkaVolterra::<2, 2>::new(1.3).unwrap();
    let values: [f64; 2] = [0, 1].map(|index| populations.invariant(index, y));
    assert_eq!(values, [12.0, 7.0]);
}
