//! `sexp-levy` and `sexp-li-levy`: what areas add, and that they add nothing where
//! noises commute.

use crate::common::{Numbers, Visit, any_areas, any_increments, any_state, every_system};
use kernels::Tuned;
use noise::Noise;
use real::Real;
use schemes::{BuiltIn, Scheme, Sexp, SexpLevy, SexpLi, Step};
use systems::{Constant, PoissonSystem, jacobi_holds};

struct NothingToAdd(usize);

impl Visit for NothingToAdd {
    fn visit<S: Tuned<D, M>, const D: usize, const M: usize>(&mut self, system: &S, y0: [f64; D]) {
        let levy = SexpLevy::new(system, y0);
        let [sexp, stepper, li] = [BuiltIn::Sexp, BuiltIn::SexpLevy, BuiltIn::SexpLiLevy]
            .map(|scheme| S::scheme(scheme, system, y0).unwrap());
        let mut numbers = Numbers(8);
        for _ in 0..50 {
            let step = Step::new(&Constant::new(0.3).unwrap(), 0, 0.01).unwrap();
            let dw = any_increments(&mut numbers, step.tau);
            let areas = any_areas(&mut numbers, step.tau);
            let y = any_state(&mut numbers, system, y0);
            let none = Noise::increments(dw);
            let without = sexp.step(system, &step, &none, y).z;
            let with = stepper.step(system, &step, &Noise { areas, ..Noise::increments(dw) }, y).z;
            assert_eq!(stepper.step(system, &step, &none, y).z, without);
            assert_eq!(with == without, levy.commuting(), "{}", system.name());
            assert_eq!([&stepper, &li].map(|x| x.about().reads_areas), [!levy.commuting(); 2]);
            self.0 += usize::from(levy.commuting());
        }
    }
}

#[test]
fn commuting_noises_cost_nothing() {
    let mut nothing = NothingToAdd(0);
    every_system(&mut nothing);
    assert!(nothing.0 > 0);
}

/// Noise that turns about x and y, dy = y × ∇H₀ dt + Σ y × eₘ ∘ dWₘ with H₀ = ½(y₁² + 2y₂²), and
/// nothing in closed form.
pub struct Rotations;

impl PoissonSystem<3, 2> for Rotations {
    fn name(&self) -> &'static str {
        "rotations"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [y[1] * v[2] - y[2] * v[1], y[2] * v[0] - y[0] * v[2], y[0] * v[1] - y[1] * v[0]]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 2]) -> R {
        (y[0] * y[0] * 0.5 + y[1] * y[1]) * dt + y[0] * dw[0] + y[1] * dw[1]
    }
}

#[test]
fn a_small_loop_of_the_noise_turns_about_the_third_axis() {
    // Round a square of side h the increments vanish and the area is h²: exactly a product of four
    // rotations. One step of `sexp` stays where it is, one of `sexp-levy` turns by the area, and
    // the sign is that of the loop.
    let (levy, sexp) = (SexpLevy::new(&Rotations, [0.6, 0.0, 0.8]), Sexp);
    let li = SexpLi::with_areas(&Rotations, [0.6, 0.0, 0.8]).unwrap();
    // In no time the drift does nothing.
    let tau = 1e-12;
    let step = Step::new(&Constant::new(0.0).unwrap(), 0, tau).unwrap();
    for h in [0.1, 0.05] {
        let y0 = [0.6, 0.0, 0.8];
        let mut round = y0;
        for side in [[h, 0.0], [0.0, h], [-h, 0.0], [0.0, -h]] {
            round = sexp.step(&Rotations, &step, &Noise::increments(side), round).z;
        }
        let areas = [[0.0, h * h], [-h * h, 0.0]];
        let noise = Noise { areas, ..Noise::increments([0.0; 2]) };
        let at_once = levy.step(&Rotations, &step, &noise, y0).z;
        let without_iteration = li.step(&Rotations, &step, &noise, y0).z;
        // Terms of order h³ and on are left out: half of them for each of the four corners is less
        // than 4h³.
        let distance =
            |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
        assert!(distance(round, y0) > 0.5 * h * h, "the loop moves the state");
        assert!(distance(round, at_once) < 4.0 * h * h * h, "{round:?} {at_once:?}");
        assert!(distance(round, without_iteration) < 4.0 * h * h * h, "{without_iteration:?}");
        let at_rest = sexp.step(&Rotations, &step, &Noise::increments([0.0; 2]), y0).z;
        // |y × ∇H₀| ≤ 2|y|², and |y| = 1.
        assert!(distance(at_rest, y0) < 2.0 * tau, "{at_rest:?}");
    }
}

/// B(y)v = b(y) × v with b = (y₂, 0, 1): skew and affine, but b·(∇ × b) = −1.
struct NoJacobi;

impl PoissonSystem<3, 2> for NoJacobi {
    fn name(&self) -> &'static str {
        "no-jacobi"
    }
    fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
        [-v[1], v[0] - y[1] * v[2], y[1] * v[1]]
    }
    fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 2]) -> R {
        (y[0] * y[0] + y[1] * y[1]) * (0.5 * dt) + y[1] * dw[0] + y[2] * y[0] * dw[1]
    }
}

#[test]
fn areas_without_jacobis_identity_are_refused() {
    let y0 = [0.3, 0.4, 0.5];
    assert!(!jacobi_holds(&NoJacobi, y0) && jacobi_holds(&Rotations, y0));
    let refused = SexpLi::with_areas(&NoJacobi, y0).unwrap_err().to_string();
    assert!(refused.starts_with("sexp-li-levy needs Jacobi's identity"), "{refused}");
    assert!(SexpLi::new(&NoJacobi, y0).is_ok());
}
