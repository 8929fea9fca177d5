//! Derivatives of functions of the state by differences.

use super::{Batch, Probe, Term, dot, largest, moved};

/// A function of the state at many points.
pub type Values<'f> = &'f dyn Fn(&mut Probe<'_>, &[Vec<f64>]) -> Vec<f64>;

/// Lengths at which differences along vectors begin: a tenth of a state.
pub fn lengths(y: &[Vec<f64>], along: &Batch) -> Vec<f64> {
    let length = |(y, along): (&Vec<f64>, &Vec<f64>)| {
        0.1 * largest(y).max(f64::MIN_POSITIVE) / largest(along).max(1e-300)
    };
    y.iter().zip(along).map(length).collect()
}

/// Weights of the differences F(y + kh) − F(y − kh) in the derivative, of orders eight and six.
const WEIGHTS: [[f64; 4]; 2] =
    [[4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0], [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0]];
/// Lengths h, each half of the one before, of which the best is taken.
const LENGTHS: i32 = 8;
/// Below this part of the terms the error of a derivative is taken for round-off.
const ROUNDING: f64 = 1e-14;
/// A derivative with an error above this part of its terms is not resolved.
const RESOLVED: f64 = 1e-9;

/// The derivative of F along vectors at each state, from these lengths on, and a size whose
/// round-off is its error: infinite where the domain is too narrow or no length resolves F.
pub fn slopes(
    probe: &mut Probe<'_>,
    y: &[Vec<f64>],
    along: &Batch,
    lengths: &[f64],
    f: Values<'_>,
) -> Vec<Term> {
    let mut best = vec![(0.0, f64::INFINITY); y.len()];
    for halvings in 0..LENGTHS {
        let length = |n: usize| lengths[n] * f64::powi(0.5, halvings);
        let mut side = |k: i32| {
            let at = |n: usize| moved(&y[n], f64::from(k) * length(n), &along[n]);
            let states: Batch = (0..y.len()).map(at).collect();
            let values = f(probe, &states);
            (states, values)
        };
        let sides = [1, 2, 3, 4].map(|k| [k, -k].map(&mut side));
        for n in 0..y.len() {
            let mut inside = sides.iter().flatten().map(|(states, _)| &states[n]);
            if !inside.all(|y| probe.in_domain(y)) {
                continue;
            }
            let differences: Vec<f64> =
                sides.iter().map(|[up, down]| up.1[n] - down.1[n]).collect();
            let [fine, coarse] = WEIGHTS.map(|weights| dot(&weights, &differences) / length(n));
            let size = largest(sides.iter().flatten().map(|(_, values)| &values[n])) / length(n);
            let apart = (fine - coarse).abs();
            let error = apart / ROUNDING + 0.1 * size;
            if error < best[n].1 && apart <= RESOLVED * size {
                best[n] = (fine, error);
            }
        }
    }
    best.into_iter().map(|(slope, error)| (slope, slope.abs() + error)).collect()
}
