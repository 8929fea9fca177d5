//! Invariants along paths, beside their conformal law exp(−p∫γ)F(y₀).

use mc::{ConformalLaw, Problem};

use crate::*;

/// Largest relative defect of `sexp` that counts as round-off on the paper's paths of at most 500
/// steps. A step leaves a residual of at most two ulp and a handful of roundings, say 16 ε in all;
/// if none cancelled, 500 steps would give 1.8e-12, as a random walk √500·16 ε = 8e-14. 2e-13 lies
/// between, below the worst case.
pub const ROUND_OFF: f64 = 2e-13;

/// Triples (t, F(y(t)), exp(−p∫γ)F(y₀)) along a path, for invariant number `index` of the system.
pub fn along(
    problem: &Problem<'_>,
    index: usize,
    path: &Path,
) -> impl Iterator<Item = (f64, f64, f64)> {
    let ConformalLaw { degree, value, .. } = &problem.laws[index];
    let initial = value(&problem.y0);
    path.iter().map(move |(t, y)| {
        let exact = elementary::exp(-degree * problem.damping.integral(0.0, *t)) * initial;
        (*t, value(y), exact)
    })
}

/// Largest relative defect |F(yₙ)/(e^{−p∫γ}F(y₀)) − 1| along a path; NaN if any defect is NaN.
pub fn largest_defect(problem: &Problem<'_>, index: usize, path: &Path) -> f64 {
    let defects = along(problem, index, path).map(|(_, value, exact)| (value / exact - 1.0).abs());
    defects.fold(0.0, worse)
}

/// Number of paths at each of the two steps. A single path proves nothing: the largest defect along
/// a path has a heavy tail.
const PATHS: u64 = 32;
/// Ratio of the first step to the second.
const REFINEMENT: u64 = 64;
/// Part number of the experiment's noise for the first of the two step sizes.
const PART: u64 = 8;

/// Measures whether a scheme with the defect `largest` along one path returns to the law as τ → 0:
/// the order (mean ln d(τ) − mean ln d(τ/64))/ln 64 of the largest relative defect d along a path.
/// It must exceed ¼, between the order 0 of a scheme that solves another equation and the order ½
/// that every scheme here has at least.
pub fn approach(
    conditions: &Conditions,
    setup: &Setup<'_>,
    index: usize,
    steps: u64,
    largest: f64,
) -> Evidence {
    // ln of the largest relative defect along a path, over the paths.
    let [coarse, fine] = [(PART, steps), (PART + 1, REFINEMENT * steps)].map(|(part, steps)| {
        let mut logarithms = CrossMoments::new(1);
        for path in 0..PATHS {
            let path = conditions.path(part, setup, steps, path);
            let failed = path.len() as u64 <= steps;
            let defect = largest_defect(&setup.problem, index, &path);
            logarithms.add(&[if failed { f64::NAN } else { elementary::ln(defect) }]);
        }
        logarithms
    });
    let scale = elementary::ln(REFINEMENT as f64);
    let order = (coarse.mean(0) - fine.mean(0)) / scale;
    if !order.is_finite() {
        let reason = "a path failed, or obeys the law without any defect".into();
        return Evidence::Undecided { reason };
    }
    Evidence::Approach {
        invariant: setup.problem.laws[index].name.clone(),
        largest,
        paths: PATHS,
        refinement: REFINEMENT,
        coarse: elementary::exp(coarse.mean(0)),
        fine: elementary::exp(fine.mean(0)),
        order,
        half_width: DEVIATIONS
            * elementary::hypot(coarse.standard_error(0), fine.standard_error(0))
            / scale,
        least: 0.25,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Compiled;
    use schemes::BuiltIn;

    #[test]
    fn the_order_of_approach_has_the_errors_of_both_step_sizes() {
        let problem = systems::paper::rigid_body_three_noises(1.0);
        let compiled = Compiled::of(&problem);
        let midpoint = &compiled.curves(&[BuiltIn::Midpoint])[0].setup;
        let conditions = Conditions { seed: 1, quick: true, experiment: 1, id: "midpoint" };
        // Mean and squared standard error of ln d over the 32 paths.
        let [coarse, fine] = [(PART, 8), (PART + 1, 8 * REFINEMENT)].map(|(part, steps)| {
            let path = |path| conditions.path(part, midpoint, steps, path);
            let logarithms: Vec<f64> =
                (0..32).map(|p| largest_defect(&midpoint.problem, 0, &path(p)).ln()).collect();
            let mean = logarithms.iter().sum::<f64>() / 32.0;
            let square = logarithms.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            (mean, square / (31.0 * 32.0))
        });
        let found = approach(&conditions, midpoint, 0, 8, 0.1);
        let Evidence::Approach { order, half_width, .. } = found else { panic!("{found:?}") };
        assert!((order * 64f64.ln() - (coarse.0 - fine.0)).abs() < 1e-9, "{order}");
        let exact = DEVIATIONS * (coarse.1 + fine.1).sqrt() / 64f64.ln();
        assert!((half_width / exact - 1.0).abs() < 1e-9, "{half_width} {exact}");
    }
}
