//! Next to the coordinate planes, where the structure has its poles.

use anyhow::Result;
use systems::paper::sine;
use systems::{IntegerExponents, LotkaVolterra};

use super::{Case, Context, Words, each};
use crate::paths::{CASIMIR, Experiment, Law};
use crate::results::Row;

pub const CASE: Case = Case {
    words: Words {
        id: "lotka-volterra",
        title: "Lotka–Volterra next to its coordinate planes",
        setup: "Lotka–Volterra with a = −1, b = −2, γ = sin t, up to t = 2, truncated increments; \
                several paths.",
        mathematics: "The solution stays positive. The Casimir 2y₁ + y₂ + y₃ follows e^(−∫γ), which \
                      with positive components bounds them all. B has poles on the planes y₁ = 0 \
                      and y₂ = 0.",
        quantity: "largest relative distance of the Casimir from its law over all paths, as long \
                   as they last",
        guarantee: "Every state is finite, positive and on the law to rounding (`sexp`), or the \
                    path ends with a typed error: no solution, or outside of the domain. No scheme \
                    here is positive by construction.",
        varied: "start and τ",
        plot: None,
    },
    rows,
};

const TAUS: [f64; 3] = [1.0 / 16.0, 1.0 / 64.0, 1.0 / 256.0];
const T_END: f64 = 2.0;
const STARTS: [(&str, [f64; 3]); 4] = [
    ("y₁ = 1e-12", [1e-12, 0.4, 0.6]),
    ("y₂ = 1e-12", [0.2, 1e-12, 0.6]),
    ("y₃ = 1e-12", [0.2, 0.4, 1e-12]),
    ("all 1e-12", [1e-12, 1e-12, 1e-12]),
];

/// The law of a linear Casimir costs half of what a quadratic one costs, but its coefficients
/// differ by two. They are positive: there is no cancellation in the octant.
const LAW: Law = Law { invariants: &[1], weight: 2.0, ..CASIMIR };

fn rows(context: &Context) -> Result<Vec<Row>> {
    let paths = context.arguments.many(64, 8);
    let settings = STARTS.into_iter().flat_map(|start| TAUS.map(|tau| (start, tau)));
    each(settings, |((name, y0), tau)| {
        let system = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0)?;
        let steps = ((T_END / tau) as u64, tau);
        let experiment = Experiment::new(context, (system, sine()), y0, steps)?;
        let setting = format!("{name}, τ = 1/{:.0}", 1.0 / tau);
        Experiment { paths, ..experiment }.law_rows(setting, &LAW, |_| None)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use systems::PoissonSystem;

    #[test]
    fn the_casimir_has_positive_coefficients() {
        let system = LotkaVolterra::<IntegerExponents<2, 2>>::integer(1.0).unwrap();
        for i in 0..3 {
            let mut y = [0.0; 3];
            y[i] = 1.0;
            let value: f64 = system.invariant(1, y);
            assert!((1.0..=2.0).contains(&value));
        }
    }
}
