//! The Hamiltonians, and whether the methods of a system agree with its energy.

use serde::Serialize;

use super::{Sight, shape::Shape};
use crate::facts::{
    Batch, Finding, Purpose, Random, Status, moved, norm, product, scaled, share, sum,
};

/// The Hamiltonians H₀, …, H_M and the methods that follow from them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Hamiltonians {
    /// Shapes of H₀, H₁, …, H_M; of H₀ alone if there are more than eight noises.
    pub shapes: Vec<Shape>,
    /// Whether there is no noise.
    pub silent: bool,
    /// Whether a Hamiltonian depends on time.
    pub depend_on_time: bool,
    /// Finding on ∇Hₘ = cₘ∇H₀ for every m: such a system has an energy law.
    /// It fails where a Hamiltonian depends on time.
    pub proportional: Finding,
    /// Finding on ∇̄h(a, b)·(b − a) = h(b) − h(a), for points a tenth of the region apart.
    pub discrete_gradient: Finding,
    /// Largest defect of `discrete_gradient` relative to ‖∇̄h‖‖b − a‖: the relative error of the
    /// quadrature.
    pub quadrature_error: f64,
    /// Identities that the methods of the system must satisfy: the message of a mistake, and the
    /// finding.
    pub methods: Vec<(&'static str, Finding)>,
}

/// Relative difference from which two averages are not the same.
const SAME: f64 = 1e-9;
/// Least relative error of an `averaged_gradient` that is a mistake and not that of a quadrature:
/// the points of the check are further apart than a step is long.
const POOR_QUADRATURE: f64 = 1e-3;
/// Largest number of noises that are checked one by one; of more, two random combinations are.
const SINGLY: usize = 8;

impl Hamiltonians {
    pub(super) fn of(sight: &mut Sight<'_>) -> Self {
        let description = sight.probe.description;
        let mut random = Random::new(Purpose::Weights);
        let weights = sight.weights(&mut random);
        let (proportional, silent) = proportional(sight, &mut random);
        let depend_on_time = description.depends_on_time;
        let mut found = Self { proportional, silent, depend_on_time, ..Self::default() };
        for m in 0..=if description.noises <= SINGLY { description.noises } else { 0 } {
            let unit = sight.probe.weights(m);
            found.shapes.push(Shape::of(sight, &|probe, y| probe.energy(y, &unit)));
        }
        let other = sight.weights(&mut random);
        let both = moved(&weights, 1.0, &other);
        let [a, b, both] =
            [&weights, &other, &both].map(|weights| sight.probe.energy(&sight.states, weights));
        let linear = sight.found(|n| vec![sum([both[n], -a[n], -b[n]])]);
        found.methods.push(("energy(y, dt, dw) is not linear in (dt, dw)", linear));
        // With a bath it is more than ∇h, and so are averages.
        if !description.has_bath {
            let gradient = sight.gradient(&weights);
            let sound = !gradient.fails();
            found.methods.push(("gradient is not the gradient of energy", gradient));
            if sight.probe.is_one_tile() {
                let singly = (0..found.shapes.len()).map(|m| sight.probe.weights(m));
                let all: Vec<_> = singly.chain([weights]).collect();
                found.check_averages(sight, &all, sound);
            }
        }
        found
    }

    /// Checks averaged gradients and fields. `sound` says that the gradient is right: consequences
    /// of a wrong gradient are not listed as further mistakes.
    fn check_averages(&mut self, sight: &mut Sight<'_>, all: &[Vec<f64>], sound: bool) {
        let steps = sight.segments();
        let ends = sight.moved(1.0, &steps);
        let middle = |(a, b): (&Vec<f64>, &Vec<f64>)| scaled(0.5, &moved(a, 1.0, b));
        let middles: Batch = sight.states.iter().zip(&ends).map(middle).collect();
        let (mut at_points, mut fields) = (Finding::default(), Finding::default());
        // Whether `averaged_gradient` is written out, and not the quadrature of the interface.
        let mut own = false;
        for weights in all {
            let Sight { probe, states, .. } = sight;
            let [alone, _, _] = probe.averages(states, states, weights);
            let slope = probe.gradient(states, weights);
            let [mean, field, quadrature] = probe.averages(states, &ends, weights);
            let far = |(a, b): (&Vec<f64>, &Vec<f64>)| norm(&moved(a, -1.0, b)) > SAME * norm(b);
            own |= mean.iter().zip(&quadrature).any(far);
            let expected = probe.structure(&middles, &mean);
            let [start, end] = [states, &ends].map(|y| probe.energy(y, weights));
            let change = |n: usize| {
                let (defect, size) = product(&mean[n], &steps[n]);
                (defect - (end[n] - start[n]), size + end[n].abs() + start[n].abs())
            };
            let relative = |n: usize| change(n).0.abs() / (norm(&mean[n]) * norm(&steps[n]));
            let errors = (0..mean.len()).map(relative);
            self.quadrature_error = errors.fold(self.quadrature_error, f64::max);
            sight.compare(&mut at_points, &alone, &slope);
            sight.compare(&mut fields, &field, &expected);
            sight.record(&mut self.discrete_gradient, |n| vec![change(n)], 0.0);
        }
        let what = "averaged_field(a, b) is not structure((a+b)/2, averaged_gradient(a, b))";
        self.methods.push((what, fields));
        if sound {
            self.methods.push(("averaged_gradient(y, y) is not the gradient at y", at_points));
        }
        // The error of a quadrature is no mistake.
        let poor = own && self.quadrature_error > POOR_QUADRATURE;
        if sound && (poor || !self.discrete_gradient.fails()) {
            let what = "averaged_gradient(a, b)·(b − a) is not the change of energy";
            self.methods.push((what, self.discrete_gradient.clone()));
        }
    }
}

/// Whether Hₘ = cₘH₀ for every m, up to constants, and whether every cₘ is zero: two random
/// combinations tell.
fn proportional(sight: &mut Sight<'_>, random: &mut Random) -> (Finding, bool) {
    let description = sight.probe.description;
    let drift = sight.probe.gradient(&sight.states, &sight.probe.weights(0));
    let (mut proportional, mut silent) = (Finding::fitted(), true);
    for _ in 0..if description.noises > 0 { 2 } else { 0 } {
        let weights = sight.weights_of_noises(random);
        let noise = sight.probe.gradient(&sight.states, &weights);
        // Of H₀ = 0 the multiple is zero.
        let c = share(&drift[0], &noise[0]);
        let multiple = drift.iter().map(|drift| scaled(c, drift)).collect();
        sight.compare(&mut proportional, &multiple, &noise);
        silent &= c == 0.0;
    }
    silent &= proportional.holds();
    if description.depends_on_time {
        proportional.status = Status::Fails;
    }
    (proportional, silent)
}
