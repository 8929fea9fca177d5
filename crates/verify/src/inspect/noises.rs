//! Whether the noises commute, and what strong order asks of a scheme.

use serde::Serialize;

use super::algebra::norm;
use super::finding::Finding;
use super::points::{Numbers, Points};
use super::probe::{Matrix, Probe, axis, pick};

/// What the noise fields fₘ = B∇Hₘ are to one another.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Noises {
    /// [fₘ, f_l] = 0: no Lévy areas are needed for strong order one. One noise commutes with
    /// itself.
    pub commute: Finding,
    /// fₘ′f_l = 0: the Itô correction vanishes and Euler–Maruyama has strong order one.
    pub no_correction: Finding,
    /// `commutators` is Σ A_ml [fₘ, f_l].
    pub commutators: Finding,
}

impl Noises {
    pub(super) fn of(system: &dyn Probe, points: &Points) -> Self {
        let (noises, d) = (system.noises(), system.dimension());
        let (mut commute, mut no_correction) = (Finding::new(), Finding::new());
        let mut overridden = Finding::new();
        let mut numbers = Numbers::new();
        for y in &points.few {
            let fields: Matrix = (1..=noises).map(|m| system.field(y, &pick(system, m))).collect();
            let along = |of: usize, v: &[f64]| system.field_derivative(y, &pick(system, of + 1), v);
            // ‖f_l′‖ by columns, so that cancellation within f_l′fₘ does not pass for a commutator.
            let slopes: Vec<f64> = (0..noises)
                .map(|l| {
                    (0..d)
                        .map(|i| norm(&along(l, &axis(d, i))))
                        .fold(0.0, |sum: f64, x| sum.hypot(x))
                })
                .collect();
            let sizes: Vec<f64> = fields.iter().map(|f| norm(f)).collect();
            let mut areas = vec![vec![0.0; noises]; noises];
            let (mut sum, mut total) = (vec![0.0; d], 0.0);
            for l in 0..noises {
                for m in 0..noises {
                    let one = along(l, &fields[m]);
                    for x in &one {
                        no_correction.see(*x, slopes[l] * sizes[m], y);
                    }
                    if m >= l {
                        continue;
                    }
                    let other = along(m, &fields[l]);
                    let scale = slopes[l] * sizes[m] + slopes[m] * sizes[l];
                    areas[m][l] = numbers.uniform();
                    areas[l][m] = -areas[m][l];
                    total += scale;
                    for i in 0..d {
                        commute.see(one[i] - other[i], scale, y);
                        sum[i] += areas[m][l] * (one[i] - other[i]);
                    }
                }
            }
            if noises > 1 {
                for (given, exact) in system.commutators(y, &areas).iter().zip(&sum) {
                    overridden.see(given - exact, total, y);
                }
            }
        }
        Self { commute, no_correction, commutators: overridden }
    }
}
