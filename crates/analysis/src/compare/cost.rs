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
    fn a_point_without_a_cost_is_not_used() {
        // Of two points with one error the later is taken, and none that costs nothing.
        assert_eq!(cost_at(&[(0.1, 1.0), (0.1, 3.0)], 0.1), Some(3.0));
        assert_eq!(cost_at(&[(0.1, 0.0), (0.01, 3.0)], 0.05), None);
        assert_eq!(cost_at(&[(0.0, 1.0), (0.01, 3.0)], 0.005), None);
    }
}
