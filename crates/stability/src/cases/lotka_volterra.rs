//! Next to the coordinate planes, where the structure has its poles.

use systems::{Damping, IntegerExponents, LotkaVolterra, Sine};

use super::{Claim, Context, Measured, Words, defect, grid, valid};
use crate::path::{Path, Stop, truncated_noise};
use crate::results::{Case, Row};
use crate::rounding::law_bound;

const TAUS: [f64; 3] = [1.0 / 16.0, 1.0 / 64.0, 1.0 / 256.0];
const STARTS: [(&str, [f64; 3]); 4] = [
    ("y₁ = 1e-12", [1e-12, 0.4, 0.6]),
    ("y₂ = 1e-12", [0.2, 1e-12, 0.6]),
    ("y₃ = 1e-12", [0.2, 0.4, 1e-12]),
    ("all 1e-12", [1e-12, 1e-12, 1e-12]),
];

pub(super) fn case(context: &Context) -> Case {
    let paths = context.many(64, 8);
    let settings: Vec<_> = STARTS.iter().flat_map(|start| TAUS.map(|tau| (*start, tau))).collect();
    let rows = grid(&settings, 1, |&((name, y0), tau), method| {
        let system = valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0));
        let damping = valid(Sine::new(1.0, 1.0));
        let steps = (2.0 / tau) as u64;
        let path = Path { system: &system, damping: &damping, y0, tau, steps };
        let (mut worst, mut excess) = (0.0f64, 0.0f64);
        let (mut outside, mut unsolved, mut last) = (0u64, 0u64, None);
        for number in 0..paths {
            let (mut total, mut robust) = (0.0, 0.0);
            let end = path.run(
                method,
                &mut truncated_noise::<1>(context.key(), number, tau),
                &mut |n, step, y, outcome| {
                    total += step.damping_integral().abs();
                    if let nonlin::Outcome::Robust { residual, .. } = outcome {
                        robust += 2.0 * residual / y.iter().sum::<f64>();
                    }
                    // The Casimir 2y₁ + y₂ + y₃ has positive coefficients: no cancellation in the
                    // octant.
                    let d = defect(&system, 1, 1.0, (y0, y), damping.integral(0.0, n as f64 * tau));
                    worst = worst.max(d);
                    excess = excess.max(d / (2.0 * law_bound(n, total) + robust));
                },
            );
            match end {
                Ok(_) => {}
                Err(stop) => {
                    outside += u64::from(matches!(stop, Stop::OutsideDomain { .. }));
                    unsolved += u64::from(!matches!(stop, Stop::OutsideDomain { .. }));
                    last = Some(stop);
                }
            }
        }
        let measured = Measured { figure: worst, stop: last };
        let row = Claim::Nothing.row("", None, method.id(), measured);
        let verdict = if method.conformal() {
            Claim::AtMostOrStops(1.0)
                .row("", None, "", Measured { figure: excess, stop: None })
                .verdict
        } else {
            row.verdict
        };
        let error = last.map(|_| {
            format!("of {paths} paths {outside} leave the octant, {unsolved} are not solved")
        });
        Row { setting: format!("{name}, τ = 1/{:.0}", 1.0 / tau), verdict, error, ..row }
    });
    Words {
        title: "Lotka–Volterra next to its coordinate planes",
        setup: "Lotka–Volterra with a = −1, b = −2, γ = sin t, up to t = 2, truncated increments; several paths.",
        mathematics: "The solution stays positive. The Casimir 2y₁ + y₂ + y₃ follows e^(−∫γ), which with positive components bounds them all. B has poles on the planes y₁ = 0 and y₂ = 0.",
        quantity: "largest relative distance of the Casimir from its law over all paths, as long as they last",
        guarantee: "Every state is finite, positive and on the law to rounding (`sexp`), or the path ends with a typed error: no solution, or outside of the domain. No scheme here is positive \
                    by construction.",
        varied: "start and τ",
    }
    .with(context, rows)
}

/// The law of a linear Casimir costs half of what a quadratic one costs, but its coefficients
/// differ by two.
#[cfg(test)]
mod tests {
    use super::*;
    use systems::PoissonSystem;

    #[test]
    fn the_casimir_has_positive_coefficients() {
        let system = valid(LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0));
        for i in 0..3 {
            let mut y = [0.0; 3];
            y[i] = 1.0;
            let value: f64 = system.invariant(1, y);
            assert!((1.0..=2.0).contains(&value));
        }
    }
}
