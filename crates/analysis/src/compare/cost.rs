//! What a given error costs, between the measured points.

/// Errors of a scheme against their costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// The scheme.
    pub scheme: String,
    /// (error, cost) by increasing cost.
    pub points: Vec<(f64, f64)>,
}

/// The cost of an error of `target` on a curve of (error, cost) by increasing cost: linear in the
/// logarithms between the two neighbouring points, the more expensive ones if the curve passes
/// `target` more than once. `None` where no neighbours enclose it: nothing is extrapolated.
pub fn cost_at(curve: &[(f64, f64)], target: f64) -> Option<f64> {
    let usable: Vec<(f64, f64)> = curve
        .iter()
        .copied()
        .filter(|(error, cost)| error.is_finite() && *error > 0.0 && *cost > 0.0)
        .collect();
    usable.windows(2).rev().find(|pair| pair[1].0 <= target && target <= pair[0].0).map(|pair| {
        let [(coarse, cheap), (fine, dear)] = [pair[0], pair[1]];
        let share =
            if coarse == fine { 1.0 } else { (target / coarse).ln() / (fine / coarse).ln() };
        cheap * (dear / cheap).powf(share)
    })
}

/// How two curves compare over the errors that both reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing {
    /// (error, cost of the first curve over cost of the second) at every error that was measured on
    /// one of them, from the largest to the smallest. Between these the ratio is a power law.
    pub ratios: Vec<(f64, f64)>,
    /// The errors at which the cheaper of the two changes.
    pub at: Vec<f64>,
}

/// Compares two curves of (error, cost) by increasing cost; `None` when they reach no error in
/// common.
pub fn crossing(first: &[(f64, f64)], second: &[(f64, f64)]) -> Option<Crossing> {
    let mut errors: Vec<f64> = first.iter().chain(second).map(|(error, _)| *error).collect();
    errors.sort_by(|a, b| b.total_cmp(a));
    let ratio = |error| Some((error, cost_at(first, error)? / cost_at(second, error)?));
    let ratios: Vec<(f64, f64)> = errors.into_iter().filter_map(ratio).collect();
    let changes = ratios.windows(2).filter(|pair| (pair[0].1 < 1.0) != (pair[1].1 < 1.0));
    let equal = changes.map(|pair| {
        let [(coarse, before), (fine, after)] = [pair[0], pair[1]];
        coarse * (fine / coarse).powf(before.ln() / (before / after).ln())
    });
    let at = equal.collect();
    (!ratios.is_empty()).then_some(Crossing { ratios, at })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// cost = scale·error^{−1/order}.
    fn curve(order: f64, scale: f64) -> Vec<(f64, f64)> {
        (3..10)
            .map(|k| 2f64.powi(-k))
            .map(|error| (error, scale * error.powf(-1.0 / order)))
            .collect()
    }

    #[test]
    fn power_laws_are_interpolated_exactly() {
        for (order, scale) in [(0.5, 3.0), (1.0, 0.2)] {
            let curve = curve(order, scale);
            for error in [2f64.powi(-3), 0.07, 0.011, 2f64.powi(-9)] {
                let cost = cost_at(&curve, error).expect("inside");
                assert!(
                    (cost / (scale * error.powf(-1.0 / order)) - 1.0).abs() < 1e-12,
                    "{order} {error}"
                );
            }
            assert_eq!((cost_at(&curve, 0.2), cost_at(&curve, 1e-3)), (None, None));
        }
    }

    #[test]
    fn a_curve_that_turns_is_read_on_its_dear_side() {
        // The coarsest step happens to be accurate; the error has to stay below the target from
        // there on.
        assert_eq!(cost_at(&[(0.01, 1.0), (0.1, 2.0), (0.01, 4.0)], 0.01), Some(4.0));
        assert_eq!(cost_at(&[(f64::INFINITY, 1.0), (0.1, 2.0), (0.01, 4.0)], 0.1), Some(2.0));
    }

    #[test]
    fn crossings_are_found_where_the_cheaper_changes() {
        // ε⁻² against 16 ε⁻¹: equal at ε = 1/16.
        let found = crossing(&curve(0.5, 1.0), &curve(1.0, 16.0)).expect("common errors");
        assert_eq!(found.at.len(), 1);
        assert!((found.at[0] * 16.0 - 1.0).abs() < 1e-12, "{found:?}");
        assert!(found.ratios[0].1 < 1.0 && found.ratios[found.ratios.len() - 1].1 > 1.0);
        assert!(crossing(&curve(1.0, 1.0), &curve(1.0, 2.0)).expect("common errors").at.is_empty());
        assert_eq!(crossing(&[(1.0, 1.0), (0.5, 2.0)], &[(0.1, 1.0), (0.05, 2.0)]), None);
    }

    #[test]
    fn a_crossing_between_the_points_is_interpolated() {
        // ε⁻² against 10 ε⁻¹: equal at ε = 1/10, which is no point of either; the ratio is 1/(10ε).
        let found = crossing(&curve(0.5, 1.0), &curve(1.0, 10.0)).expect("common errors");
        assert!(found.at.len() == 1 && (found.at[0] * 10.0 - 1.0).abs() < 1e-12, "{found:?}");
        for (error, ratio) in found.ratios {
            assert!((ratio * 10.0 * error - 1.0).abs() < 1e-12, "{error}");
        }
        // Of two points with one error the later is taken, and none that costs nothing.
        assert_eq!(cost_at(&[(0.1, 1.0), (0.1, 3.0)], 0.1), Some(3.0));
        assert_eq!(cost_at(&[(0.1, 0.0), (0.01, 3.0)], 0.05), None);
        assert_eq!(cost_at(&[(0.0, 1.0), (0.01, 3.0)], 0.005), None);
    }
}
