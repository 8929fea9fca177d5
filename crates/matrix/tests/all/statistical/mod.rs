//! Judgements of random samples. Probabilities of false alarms are for other seeds.

use std::sync::Arc;

use analysis::{StepSizes, strong_order};
use expectation::{Expect, ExpectSettings};
use matrix::{
    Function, MatrixSystem, Quantum, Scheme, Sphere, SpinCouplings, Stirring, SuSpins, c64,
};
use noise::{StreamKey, Truncation};
use stationary::{Equilibrium, EquilibriumSettings};
use systems::lattice::Shape;

use crate::{generic, problem, setup};

fn key(seed: u64) -> StreamKey {
    StreamKey { seed, experiment: 64 }
}

/// Strong order ½ with noises that do not commute, one with those that do, for both schemes. The
/// interval of 95 % decides between multiples of ½: a false alarm has a probability below 1e-3.
#[test]
fn orders_are_those_of_the_noises() {
    let [h, a, b] = [0, 10, 20].map(|seed| generic(2, seed));
    let both = Quantum::new(2, h.clone(), vec![a.clone(), b]).unwrap();
    let one = Quantum::new(2, h, vec![a]).unwrap();
    for (system, known) in [(both, 0.5), (one, 1.0)] {
        let system = Arc::new(system);
        let problem = problem(&system, &generic(2, 30), 0.2, 1.0);
        for scheme in [Scheme::Explicit, Scheme::Midpoint] {
            let sizes = StepSizes::new(16, Truncation::none(), key(1)).within(700_000);
            let order = strong_order(&setup(&problem, &system, scheme), &sizes).unwrap();
            assert_eq!(order.order(), Some(known), "{scheme:?} {order}");
        }
    }
}

/// Known energies of fluids under noise: intervals of 95 % times 2.5, so that a false alarm has a
/// probability below 1e-6. The twin has noise of strength 1.1.
#[test]
fn energies_decay_by_known_rates() {
    for (n, known) in [(5, 0.1459460860), (8, 0.2147262165)] {
        let mut w = vec![c64::default(); n * n];
        let mean = |strength: f64, accuracy: f64| {
            let noise = Stirring::isotropic(2, strength / matrix::bracket_scale(n));
            let fluid = Arc::new(Sphere::new(n, 0.0, 0.0, noise).unwrap());
            w.fill(c64::default());
            fluid.harmonics().add(&mut w, 1, 0, 1.0);
            let problem = problem(&fluid, &w, 0.0, 1.0);
            let settings = ExpectSettings { key: key(2), ..ExpectSettings::default() };
            let expect = Expect::with_scheme(setup(&problem, &fluid, Scheme::Explicit));
            let found = expect.with(settings).run(&[&fluid.functions(1)[0]], accuracy).unwrap();
            let (lo, hi) = found.estimates[0].interval();
            (0.5 * (lo + hi), 0.5 * (hi - lo))
        };
        let mut mean = mean;
        let (value, half) = mean(1.0, 1e-3);
        assert!((value - known).abs() < 2.5 * half && half <= 1.1e-3, "{n}: {value} ± {half}");
        let (value, half) = mean(1.1, 1.4e-3);
        assert!((value - known).abs() > 2.5 * half, "{n}: {value} ± {half}");
    }
}

/// Mean energies of coherent states in a bath, bounds as above. The twin has a temperature of 0.55.
#[test]
fn spins_come_to_their_temperature() {
    let mean = |levels: usize, [quadratic, quartic]: [f64; 2], kt: f64, accuracy: f64| {
        let couplings =
            SpinCouplings { quadratic, quartic, bath: Some([0.5, kt]), ..Default::default() };
        let shape = Shape::open(&[1]).unwrap();
        let spins = Arc::new(SuSpins::new(levels, shape, couplings).unwrap());
        let mut w = vec![c64::default(); levels * levels];
        (0..levels * levels).for_each(|at| w[at] = c64::new(1.0 / levels as f64, 0.0));
        let problem = problem(&spins, &w, 0.0, 4.0);
        let settings = EquilibriumSettings { key: key(3), ..EquilibriumSettings::new(40) };
        let equilibrium = Equilibrium::new(setup(&problem, &spins, Scheme::Explicit), settings);
        let energy = Function::new("energy", &spins, SuSpins::energy);
        let found = equilibrium.run(&[&energy], accuracy).unwrap();
        let (lo, hi) = found.means[0].interval();
        (0.5 * (lo + hi), 0.5 * (hi - lo))
    };
    for (levels, couplings, kt, known) in
        [(3, [1.0, 0.0], 0.125, 0.2473081719), (3, [1.0, 0.0], 0.5, 0.5443211582)]
    {
        let (value, half) = mean(levels, couplings, kt, 0.01);
        assert!((value - known).abs() < 2.5 * half && half < 0.02, "{kt}: {value} ± {half}");
    }
    let (value, half) = mean(3, [1.0, 0.0], 0.25, 0.02);
    assert!((value - 0.5443211582).abs() > 2.5 * half, "{value} ± {half}");
}
