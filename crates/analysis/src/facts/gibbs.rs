//! Densities e^{−βH₀}, and volume.

use real::elementary;
use systems::run_time::System;

use super::{
    algebra::{axis, largest, null_space},
    probe::Batch,
    search::ZERO,
    seen,
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
    let (mut probe, states) = seen(system, y0);
    let weights = probe.weights(0);
    for b in probe.matrix(&states) {
        let zero = ZERO * largest(b.iter().flatten());
        if !null_space(b, y0.len(), zero).0.is_empty() {
            return None;
        }
    }
    let along = |state: &Vec<f64>| {
        let at = |x: &f64| {
            let mut state = state.clone();
            state[place] = *x;
            state
        };
        probe.energy(&x.iter().map(at).collect::<Batch>(), &weights)
    };
    let energies: Batch = states.iter().map(along).collect();
    let (first, zero) = (&energies[0], ZERO * largest(energies.iter().flatten()));
    let alike = energies.iter().all(|energy| {
        let same = |(a, b): (&f64, &f64)| (a - b - (energy[0] - first[0])).abs() <= zero;
        energy.iter().zip(first).all(same)
    });
    let least = first.iter().copied().fold(f64::INFINITY, f64::min);
    let density: Vec<f64> =
        first.iter().map(|energy| elementary::exp(-beta * (energy - least))).collect();
    let sum: f64 = density.iter().sum();
    alike.then(|| density.iter().map(|x| x / sum).collect())
}

/// Whether Σᵢ∂ᵢBᵢⱼ vanishes for every j, at 32 points: fields B∇H have no divergence then.
pub fn is_divergence_free(system: &dyn System, y0: &[f64]) -> bool {
    let (mut probe, states) = seen(system, y0);
    let d = y0.len();
    let size = largest(probe.matrix(&states).iter().flatten().flatten());
    (0..d).all(|j| {
        let column = |i: usize| probe.structure_along(&states, &[axis(d, i)], &[axis(d, j)]);
        trace(d, column).iter().all(|sum| sum.abs() <= ZERO * size)
    })
}

/// Σᵢ of component i of column i at each state.
pub fn trace(d: usize, mut column: impl FnMut(usize) -> Batch) -> Vec<f64> {
    let mut sums = Vec::new();
    for i in 0..d {
        let column = column(i);
        sums.resize(column.len(), 0.0);
        sums.iter_mut().zip(column).for_each(|(sum, column)| *sum += column[i]);
    }
    sums
}
