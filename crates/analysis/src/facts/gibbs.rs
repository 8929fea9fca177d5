//! Densities e^{−βH₀}, and volume.

use real::elementary;
use systems::run_time::System;

use super::{
    algebra::{axis, largest, null_space},
    around,
    probe::Probe,
    random::{Purpose, Random},
    search::ZERO,
};

/// The density of component number `place` at the points x under e^{−βH₀}, where its sum is one:
/// if B is invertible and H₀ a function of this component plus one of the others, as kinetic
/// energies are. None otherwise: of other components it is an integral.
pub fn gibbs_marginal(
    system: &dyn System,
    y0: &[f64],
    place: usize,
    beta: f64,
    x: &[f64],
) -> Option<Vec<f64>> {
    let mut probe = Probe::new(system);
    let states = around(&probe, y0, &mut Random::new(Purpose::Points));
    let weights = probe.weights(0);
    for b in probe.matrix(&states) {
        let zero = ZERO * largest(b.iter().flatten());
        if !null_space(b, y0.len(), zero).0.is_empty() {
            return None;
        }
    }
    let mut along = |state: &Vec<f64>| {
        let at = |x: &f64| {
            let mut state = state.clone();
            state[place] = *x;
            state
        };
        probe.energy(&x.iter().map(at).collect::<Vec<_>>(), &weights)
    };
    let energies: Vec<Vec<f64>> = states.iter().map(&mut along).collect();
    let first = &energies[0];
    let size = energies.iter().flatten().fold(0.0, |size: f64, e| size.max(e.abs()));
    let alike = energies.iter().all(|energy| {
        let differences = energy.iter().zip(first).map(|(a, b)| a - b - (energy[0] - first[0]));
        differences.into_iter().all(|difference| difference.abs() <= ZERO * size)
    });
    let least = first.iter().copied().fold(f64::INFINITY, f64::min);
    let density: Vec<f64> =
        first.iter().map(|energy| elementary::exp(-beta * (energy - least))).collect();
    let sum: f64 = density.iter().sum();
    alike.then(|| density.iter().map(|x| x / sum).collect())
}

/// Whether Σᵢ∂ᵢBᵢⱼ vanishes for every j, at 32 points: fields B∇H have no divergence then.
pub fn is_divergence_free(system: &dyn System, y0: &[f64]) -> bool {
    let mut probe = Probe::new(system);
    let states = around(&probe, y0, &mut Random::new(Purpose::Points));
    let d = y0.len();
    let size = largest(probe.matrix(&states).iter().flatten().flatten());
    (0..d).all(|j| {
        let mut sums = vec![0.0; states.len()];
        for i in 0..d {
            let column = probe.structure_along(&states, &[axis(d, i)], &[axis(d, j)]);
            sums.iter_mut().zip(column).for_each(|(sum, column)| *sum += column[i]);
        }
        sums.iter().all(|sum| sum.abs() <= ZERO * size)
    })
}
