//! The scheme of weak order two, `nv`: flows of order four, two orders of
//! the noises in turn. The weak order itself is tested in `analysis`, without sampling.

use crate::common::{Numbers, any_increments, body};
use crate::without_iteration::MOMENTUM;
use noise::Noise;
use schemes::{Nv, Scheme, Step, Sweep};
use systems::{Constant, Pendulum, Poisson3, PoissonSystem, RigidBodyEnergy};

/// The exponent of s in the distance between one step of noise s and two steps of noise s/2,
/// almost without drift.
fn order_of_flows<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    scheme: &impl Scheme<S, D, M>,
    system: &S,
    y0: [f64; D],
    m: usize,
) -> f64 {
    let step = Step::new(&Constant::new(0.0).unwrap(), 0, 1e-200).unwrap();
    let distance = |s: f64| {
        let noise = |s: f64| {
            let mut dw = [0.0; M];
            dw[m] = s;
            Noise::increments(dw)
        };
        let once = scheme.step(system, &step, &noise(s), y0).z;
        let half = scheme.step(system, &step, &noise(0.5 * s), y0).z;
        let twice = scheme.step(system, &step, &noise(0.5 * s), half).z;
        (0..D).map(|i| (once[i] - twice[i]).powi(2)).sum::<f64>().sqrt()
    };
    (distance(0.04) / distance(0.02)).log2()
}

#[test]
fn flows_of_noises_have_order_four_or_more() {
    let along = RigidBodyEnergy::new([2.0, 1.0, 2.0 / 3.0], 1.0).unwrap();
    let pendulum = Pendulum::new(1.0).unwrap();
    let poisson = Poisson3::new(1.0).unwrap();
    let start = [1.0, 2.0, 3.0];
    for order in [
        order_of_flows(&Nv::default(), &along, MOMENTUM, 0),
        order_of_flows(&Nv::default(), &pendulum, [0.2, 1.0], 0),
        order_of_flows(&Nv::default(), &poisson, start, 0),
    ] {
        assert!((order - 5.0).abs() < 0.1, "{order}");
    }
    // A rotation is exact to the ninth order: nothing is left at this size.
    let step = Step::new(&Constant::new(0.0).unwrap(), 0, 1e-200).unwrap();
    let noise = Noise::increments([0.3, 0.0, 0.0]);
    let z = Nv::default().step(&body(), &step, &noise, MOMENTUM).z;
    let (sin, cos) = (0.3 * MOMENTUM[0]).sin_cos();
    assert!((z[1] - sin * MOMENTUM[2]).abs() < 1e-15 && (z[2] - cos * MOMENTUM[2]).abs() < 1e-15);
}

#[test]
fn noises_go_forward_and_backward_in_turn() {
    let (body, gamma) = (body(), Constant::new(0.2).unwrap());
    let mut numbers = Numbers(4);
    for n in 0..20 {
        let step = Step::new(&gamma, n, 0.1).unwrap();
        assert_eq!(step.number(), n);
        let noise = Noise::increments(any_increments(&mut numbers, 0.1));
        let advance = |sweep| Nv { sweep }.step(&body, &step, &noise, MOMENTUM).z;
        let (forward, backward) = (advance(Sweep::Forward), advance(Sweep::Backward));
        assert_ne!(forward, backward);
        assert_eq!(advance(Sweep::Alternating), if n % 2 == 0 { forward } else { backward });
    }
}
