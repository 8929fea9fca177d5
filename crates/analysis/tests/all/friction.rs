//! Orders with friction on momenta alone, of schemes that need flows of parts.

use std::sync::Arc;

use analysis::{StepSizes, strong_order, weak_order};
use mc::{Friction, Observable, Setup};
use noise::{StepNoise, StreamKey, Truncation};
use nonlin::BlockStatus;
use real::{Real, WIDTH};
use schemes::{Baoab, Nv, Split, Step, run_time};
use systems::{Constant, Damping, Flows, PoissonSystem, Problem};

use crate::{constant, system, texts};

/// Two pendulums with a spring, (q₁, q₂, p₁, p₂), on a clock with noise: H₁ = ½H₀.
#[derive(Clone, Copy)]
struct Chain;

fn time<R: Real>(dt: R, dw: [R; 1]) -> R {
    dt + dw[0] * 0.5
}

impl PoissonSystem<4, 1> for Chain {
    fn name(&self) -> &'static str {
        "chain"
    }
    fn structure<R: Real>(&self, _: [R; 4], v: [R; 4]) -> [R; 4] {
        [v[2], v[3], -v[0], -v[1]]
    }
    fn energy<R: Real>(&self, [a, b, p, q]: [R; 4], dt: f64, dw: [f64; 1]) -> R {
        let springs = (a - b) * (a - b) + p * p + q * q;
        (springs * 0.5 - a.cos() - b.cos()) * time(dt, dw)
    }
}

impl Flows<4, 1> for Chain {
    const PARTS: usize = 2;
    const EXACT: bool = true;

    fn flow<R: Real>(&self, part: usize, y: [R; 4], dt: R, dw: [R; 1]) -> [R; 4] {
        let ([a, b, p, q], h) = (y, time(dt, dw));
        match part {
            0 => [a + h * p, b + h * q, p, q],
            _ => [a, b, p - h * (a.sin() + a - b), q - h * (b.sin() + b - a)],
        }
    }
}

#[test]
#[ignore = "long: run by the gate"]
fn split_and_nv_have_their_orders_with_friction_on_momenta() {
    let y0 = [0.5, 0.0, 0.1, 0.4];
    let problem = |rate| Problem::new(Chain, Constant::new(rate).unwrap(), y0, 1.0).unwrap();
    let (without, damped) = (problem(0.0), problem(0.4));
    let friction =
        |rate, components| Friction { damping: Arc::new(Constant::new(rate).unwrap()), components };
    let both = [friction(0.7, vec![2]), friction(0.3, vec![3])];
    let (split, nv) = (Split, Nv::default());
    let key = StreamKey { seed: 1, experiment: 0 };
    let sizes = StepSizes::new(8, Truncation::new(4).unwrap(), key);
    // As with damping of all components.
    for (problem, friction) in [(&without, &both[..]), (&damped, &[])] {
        let [split, nv] = [Setup::of(problem, &split), Setup::of(problem, &nv)]
            .map(|setup| setup.with_friction(friction));
        for setup in [&split, &nv] {
            let order = strong_order(setup, &sizes.clone().within(30_000_000)).unwrap();
            assert_eq!(order.order(), Some(1.0), "{} {order}", setup.scheme.about().id);
        }
        let phi = Observable { name: "p₁", function: |y: [f64; 4]| y[2] };
        let sizes = StepSizes::new(4, Truncation::new(4).unwrap(), key);
        let order = weak_order(&nv, &phi, &sizes.within(300_000_000), None).unwrap();
        // A lower order may hide in a tenth of the last difference.
        let rate = order.rate.as_ref().unwrap();
        assert!(rate.covers(2.0) && rate.lo > 1.5 && rate.hi < 2.5, "{order}");
    }
}

/// One step of `baoab` on H₀ = ½p² with friction γ on p: a noise that is additive on p alone is one
/// exact step with friction; others stand in its middle.
#[test]
fn a_step_of_baoab_is_exact_for_additive_noise_on_what_is_damped() {
    let (gamma, tau, dw): (f64, f64, f64) = (1.3, 0.5, 0.4);
    let [half, whole] = [0.5, 1.0].map(|part| (-part * gamma * tau).exp());
    let exact = ((1.0 - whole * whole) / (2.0 * gamma * tau)).sqrt();
    let (q, p) = (0.7, -0.2);
    let drifted = q + 0.5 * tau * p;
    for (noise, moved) in [
        ("0.4*q", [drifted, whole * p - 0.4 * exact * dw]),
        ("0.4*q + 0.3*p", [drifted + 0.3 * dw, half * (half * p - 0.4 * dw)]),
        ("0.3*q^2", [drifted, half * (half * p - 0.6 * drifted * dw)]),
    ] {
        let system = system(&texts("q p", &["1"], "p^2/2", &[noise]), &[q, p]);
        let friction = [(Arc::new(constant(gamma)) as Arc<dyn Damping>, vec![1])];
        let baoab = Baoab::new(friction);
        let mut paths = run_time::Scheme::stepper(&baoab, &system).unwrap();
        paths.state_mut().copy_from_slice(&[[q; WIDTH], [p; WIDTH]]);
        let mut increments = StepNoise::zero(1);
        increments.increments[0] = [dw; WIDTH];
        let step = Step::new(&constant(0.0), 0, tau).unwrap();
        paths.step(&step, &increments, &mut BlockStatus::explicit());
        let expected = [moved[0] + 0.5 * tau * moved[1], moved[1]];
        for (row, exact) in paths.state().iter().zip(expected) {
            assert!((row[0] - exact).abs() < 1e-14, "{noise}: {} for {exact}", row[0]);
        }
    }
}
