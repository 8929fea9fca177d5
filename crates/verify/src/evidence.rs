//! Measurements about a statement, as data: the verdict and the sentence follow from them.

use analysis::{Limit, Order};
use serde::Serialize;

use crate::*;

/// Standard errors beyond which a measured mean contradicts its known value: the two-sided normal
/// quantile of a false alarm once in 1e5 runs.
pub const DEVIATIONS: f64 = 4.42;

/// Measurement with the limit that it is compared with.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
// A run has some hundred of them; most are fitted orders, the largest.
#[allow(clippy::large_enum_variant)]
pub enum Evidence {
    /// A fitted order of convergence.
    Order {
        /// Order that the statement names.
        order: f64,
        /// Whether the statement is a bound Cτ^order, which a higher order obeys, too.
        one_sided: bool,
        /// Fitted order; `None` when no order can be named.
        rate: Option<Rate>,
        /// Distance of the limit from the right one; present where the scheme converges to
        /// something else, whatever the order of its differences.
        #[serde(skip_serializing_if = "Option::is_none")]
        wrong_limit: Option<f64>,
    },
    /// The largest relative defect |F(yₙ)/(e^{−p∫γ}F(y₀)) − 1| of a conformal law.
    Defect {
        /// The invariant F by its symbol, or several in words.
        invariant: String,
        /// Number of paths.
        paths: u64,
        /// Number of steps of each path.
        steps: u64,
        /// Largest defect.
        largest: f64,
        /// Tolerance of the defect.
        tolerance: f64,
        /// Whether the statement is that the law holds; otherwise that it does not.
        obeys: bool,
    },
    /// A scheme that leaves a conformal law and returns to it as the step shrinks: the order in τ
    /// of the largest relative defect along a path, from two step sizes.
    Approach {
        /// The invariant by its symbol.
        invariant: String,
        /// The largest relative defect on the path of the panel.
        largest: f64,
        /// Number of paths at each step size.
        paths: u64,
        /// Ratio of the first step size to the second.
        refinement: u64,
        /// Geometric mean over the paths of the largest defect at the first step size.
        coarse: f64,
        /// Geometric mean over the paths of the largest defect at the second step size.
        fine: f64,
        /// Order ln(coarse/fine)/ln(refinement).
        order: f64,
        /// Half-width of the interval of `order`: [`DEVIATIONS`] standard errors.
        half_width: f64,
        /// Bound that the order must exceed.
        least: f64,
    },
    /// A sampled mean against its known value.
    Deviation {
        /// Name of the mean, for example `E[cos y3]`.
        quantity: String,
        /// Sampled mean.
        value: f64,
        /// Standard error of the mean.
        standard_error: f64,
        /// Bound of the bias of the mean, 0 for an unbiased estimate.
        bias: f64,
        /// Known value of the mean.
        expected: f64,
        /// Cost in path-steps, where it was counted.
        path_steps: Option<u64>,
        /// Reasons why the standard error or the bound of the bias may be too small.
        warnings: Vec<String>,
    },
    /// Extremes that must respect bounds.
    Bounds {
        /// Measured quantities; all must be within their bounds.
        quantities: Vec<Bounded>,
        /// Number of failed paths, which say nothing about the others.
        failed: u64,
    },
    /// Undecided: there is nothing to compare.
    Undecided {
        /// Reason in words.
        reason: String,
    },
}

/// Number with the bounds that it must respect; without bounds it is only reported.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bounded {
    /// Name of the quantity, in words.
    pub quantity: String,
    /// Value of the quantity.
    pub value: f64,
    /// Lower bound.
    pub at_least: Option<f64>,
    /// Upper bound.
    pub at_most: Option<f64>,
}

impl Bounded {
    /// Creates a quantity whose value must be at most `at_most`.
    pub fn at_most(quantity: impl Into<String>, value: f64, at_most: f64) -> Self {
        Self { at_most: Some(at_most), ..Self::reported(quantity, value) }
    }

    /// Creates a quantity whose value must be at least `at_least`.
    pub fn at_least(quantity: impl Into<String>, value: f64, at_least: f64) -> Self {
        Self { at_least: Some(at_least), ..Self::reported(quantity, value) }
    }

    /// Creates a quantity that is reported and compared with nothing.
    pub fn reported(quantity: impl Into<String>, value: f64) -> Self {
        Self { quantity: quantity.into(), value, at_least: None, at_most: None }
    }

    /// Whether the value respects its bounds. A comparison with NaN is false.
    fn holds(&self) -> bool {
        self.at_least.is_none_or(|least| self.value >= least)
            && self.at_most.is_none_or(|most| self.value <= most)
    }
}

impl Evidence {
    /// Creates evidence for `order` from a measured order; a wrong limit refutes it.
    pub fn of_order(measured: Order, order: f64) -> Self {
        let wrong_limit = match measured.limit {
            Limit::Differs { distance } => Some(distance),
            Limit::Inconsistent { defect } => Some(defect),
            _ => None,
        };
        Self::Order { order, one_sided: false, rate: measured.rate, wrong_limit }
    }

    /// Creates evidence from a fitted order that must be at least `order`, of a scheme whose limit
    /// is right.
    pub fn order_bound(order: f64, rate: Option<Rate>) -> Self {
        Self::Order { order, one_sided: true, rate, wrong_limit: None }
    }

    /// Creates evidence from an unbiased sampled mean and its known value.
    pub fn mean(quantity: String, value: f64, standard_error: f64, expected: f64) -> Self {
        let (bias, path_steps, warnings) = (0.0, None, Vec::new());
        Self::Deviation { quantity, value, standard_error, bias, expected, path_steps, warnings }
    }

    /// Creates evidence from extremes of paths none of which failed.
    pub fn bounds(quantities: impl IntoIterator<Item = Bounded>) -> Self {
        Self::Bounds { quantities: quantities.into_iter().collect(), failed: 0 }
    }

    /// Verdict that follows from the measurement. A NaN refutes, except where a path failed.
    ///
    /// Orders: [`order_verdict`]; a wrong limit refutes. A deviation refutes beyond [`DEVIATIONS`]
    /// standard errors and the bias. Bounds that hold on some paths while others failed are
    /// undecided.
    pub fn verdict(&self) -> Verdict {
        // Whether the statement holds, where the measurement can decide.
        let holds = match self {
            Self::Order { wrong_limit: Some(_), .. } => Some(false),
            Self::Order { order, one_sided, rate, .. } => {
                return order_verdict(rate.as_ref(), *order, *one_sided);
            }
            Self::Defect { largest, tolerance, obeys: true, .. } => Some(largest <= tolerance),
            Self::Defect { largest, tolerance, .. } => Some(largest > tolerance),
            // Not decided for NaN.
            Self::Approach { order, half_width, least, .. } => {
                ((order - least).abs() > *half_width).then_some(order > least)
            }
            Self::Deviation { value, standard_error, bias, expected, .. } => {
                Some((value - expected).abs() <= DEVIATIONS * standard_error + bias)
            }
            Self::Bounds { quantities, failed } => {
                let hold = quantities.iter().all(Bounded::holds);
                (!hold || *failed == 0).then_some(hold)
            }
            Self::Undecided { .. } => None,
        };
        match holds {
            Some(true) => Verdict::Holds,
            Some(false) => Verdict::Refuted,
            None => Verdict::Undecided,
        }
    }

    /// The measurement as a sentence: the only place that words one.
    pub fn sentence(&self) -> String {
        let warned = |warnings: &[String]| -> String {
            warnings.iter().map(|warning| format!("; warning: {warning}")).collect()
        };
        match self {
            Self::Order { wrong_limit: Some(distance), rate, .. } => {
                let slope =
                    |rate: &Rate| format!("; its differences fall with {:.2}", rate.estimate);
                let slope = rate.as_ref().map(slope).unwrap_or_default();
                format!("the scheme converges to something else, {distance:.1e} away{slope}")
            }
            Self::Order { rate: None, .. } => {
                "no order can be named: the errors are within their noise, or there are too few \
                 paths"
                    .into()
            }
            Self::Order { rate: Some(rate), .. } => {
                let Rate { estimate, lo, hi, confidence, method, warning, .. } = rate;
                format!(
                    "order {estimate:.3}, {:.0} % interval [{lo:.3}, {hi:.3}]; {method}{}",
                    100.0 * confidence,
                    warned(warning.as_slice())
                )
            }
            Self::Defect { invariant, paths, steps, largest, tolerance, obeys } => {
                let path = if *paths == 1 { "path" } else { "paths" };
                let limit = if *obeys { "at most" } else { "expected above" };
                format!(
                    "largest relative defect of {invariant} over {paths} {path} of {steps} steps: \
                     {largest:.1e}, {limit} {tolerance:.1e}"
                )
            }
            Self::Approach {
                invariant,
                largest,
                paths,
                refinement,
                coarse,
                fine,
                order,
                half_width,
                ..
            } => format!(
                "largest relative defect of {invariant} on the path: {largest:.1e}; geometric mean \
                 over {paths} paths {coarse:.1e} at τ and {fine:.1e} at τ/{refinement}, order \
                 {order:.2} ± {half_width:.2}"
            ),
            Self::Deviation {
                quantity,
                value,
                standard_error,
                bias,
                expected,
                path_steps,
                warnings,
            } => {
                // Two more digits than the standard error has zeros.
                let digits =
                    (2.0 - elementary::log10(*standard_error).floor()).clamp(2.0, 15.0) as usize;
                let bias = (*bias > 0.0).then(|| format!(", bias at most {bias:.1e}"));
                let cost = path_steps.map(|n| format!("; {n} path-steps"));
                format!(
                    "{quantity} = {value:.digits$} ± {standard_error:.1e} (standard error{}) \
                     against {expected:.digits$}: {:+.1} standard errors{}{}",
                    bias.unwrap_or_default(),
                    (value - expected) / standard_error,
                    cost.unwrap_or_default(),
                    warned(warnings)
                )
            }
            Self::Bounds { quantities, failed } => {
                let bounded = |Bounded { quantity, value, at_least, at_most }: &Bounded| {
                    let limits = [("least", at_least), ("most", at_most)].map(|(word, bound)| {
                        bound.map_or(String::new(), |x| format!(", at {word} {}", short(x)))
                    });
                    format!("{quantity}: {}{}", short(*value), limits.concat())
                };
                let failed = (*failed > 0).then(|| format!("{failed} paths failed"));
                quantities.iter().map(bounded).chain(failed).collect::<Vec<_>>().join("; ")
            }
            Self::Undecided { reason } => reason.clone(),
        }
    }
}

/// Formats a number with four decimals where they show it, else with an exponent.
fn short(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        0.01..1e4 => format!("{x:.4}"),
        _ => format!("{x:.1e}"),
    }
}

#[cfg(test)]
mod tests {
    use Verdict::{Holds, Refuted, Undecided};

    use super::*;

    fn defect(largest: f64, obeys: bool) -> Evidence {
        let (invariant, paths) = ("C".to_owned(), 1 + u64::from(!obeys));
        Evidence::Defect { invariant, paths, steps: 100, largest, tolerance: 1e-13, obeys }
    }

    fn bounds(value: f64, failed: u64) -> Evidence {
        let quantities = vec![
            Bounded::at_most("norm", value, 1.0),
            Bounded::reported("exponent", 2.5),
            Bounded::at_least("gain", 3.0 - value, 2.0),
        ];
        Evidence::Bounds { quantities, failed }
    }

    fn order(range: Option<[f64; 3]>, order: f64, wrong_limit: Option<f64>) -> [Evidence; 2] {
        let rate = range.map(|[estimate, lo, hi]| {
            let (method, warning) = ("a fit".to_owned(), Some("few".to_owned()));
            Rate { estimate, lo, hi, confidence: 0.999, method, warning, ..Rate::default() }
        });
        [false, true].map(|one_sided| {
            let rate = rate.clone();
            Evidence::Order { order, one_sided, rate, wrong_limit }
        })
    }

    fn approach(order: f64) -> Evidence {
        Evidence::Approach {
            invariant: "H".into(),
            largest: 0.25,
            paths: 100,
            refinement: 16,
            coarse: 0.01,
            fine: 0.001,
            order,
            half_width: 0.25,
            least: 1.0,
        }
    }

    fn deviation(value: f64) -> Evidence {
        let (quantity, standard_error, bias, expected) = ("E[y1]".to_owned(), 1e-3, 1e-3, 0.5);
        let (path_steps, warnings) = (Some(100), vec!["few".to_owned()]);
        Evidence::Deviation {
            quantity,
            value,
            standard_error,
            bias,
            expected,
            path_steps,
            warnings,
        }
    }

    #[test]
    fn verdicts_follow_from_numbers_and_nan_refutes() {
        let range = Some([1.0, 0.9, 1.1]);
        let verdicts = [
            // The tolerance itself is allowed, and is not above it.
            (
                [1e-14, 1e-13, 1e-12, f64::NAN].map(|d| defect(d, true)),
                [Holds, Holds, Refuted, Refuted],
            ),
            (
                [1e-14, 1e-13, 1e-12, f64::NAN].map(|d| defect(d, false)),
                [Refuted, Refuted, Holds, Refuted],
            ),
            ([0.9, 1.0, 1.1, f64::NAN].map(|v| bounds(v, 0)), [Holds, Holds, Refuted, Refuted]),
            (
                [0.9, 1.0, 1.1, f64::NAN].map(|v| bounds(v, 2)),
                [Undecided, Undecided, Refuted, Refuted],
            ),
            ([0.505, 0.506, 0.494, f64::NAN].map(deviation), [Holds, Refuted, Refuted, Refuted]),
            (
                [4.41, 4.43, -4.41, -4.43].map(|k| Evidence::mean("E".into(), k, 1.0, 0.0)),
                [Holds, Refuted, Holds, Refuted],
            ),
            ([1.26, 1.25, 0.75, 0.74].map(approach), [Holds, Undecided, Undecided, Refuted]),
        ];
        for (evidence, verdicts) in verdicts {
            assert_eq!(evidence.each_ref().map(Evidence::verdict), verdicts, "{evidence:?}");
        }
        assert_eq!(approach(f64::NAN).verdict(), Undecided);
        // Orders are held to both sides or one, and a wrong limit refutes.
        for (wrong_limit, verdicts) in [(None, [Refuted, Holds]), (Some(0.25), [Refuted; 2])] {
            let evidence = order(range, 0.5, wrong_limit);
            assert_eq!(evidence.each_ref().map(Evidence::verdict), verdicts, "{evidence:?}");
        }
    }

    #[test]
    fn sentences_hold_the_numbers_and_json_the_same() {
        let range = Some([1.0, 0.9, 1.1]);
        let away = "the scheme converges to something else, 2.5e-1 away";
        let [wrong, wrong_slope] = [None, range].map(|range| order(range, 1.0, Some(0.25)));
        let sentences = [
            (
                defect(2.7e-15, true),
                "largest relative defect of C over 1 path of 100 steps: 2.7e-15, at most 1.0e-13",
            ),
            (
                defect(1.0, false),
                "largest relative defect of C over 2 paths of 100 steps: 1.0e0, expected above 1.0e-13",
            ),
            (
                bounds(0.9, 2),
                "norm: 0.9000, at most 1.0000; exponent: 2.5000; gain: 2.1000, at least 2.0000; 2 paths failed",
            ),
            (
                deviation(0.505),
                "E[y1] = 0.50500 ± 1.0e-3 (standard error, bias at most 1.0e-3) against 0.50000: +5.0 standard errors; 100 path-steps; warning: few",
            ),
            (
                Evidence::mean("E[y1]".into(), 0.47, 0.02, 0.5),
                "E[y1] = 0.4700 ± 2.0e-2 (standard error) against 0.5000: -1.5 standard errors",
            ),
            (
                approach(1.5),
                "largest relative defect of H on the path: 2.5e-1; geometric mean over 100 paths 1.0e-2 at τ and 1.0e-3 at τ/16, order 1.50 ± 0.25",
            ),
            (wrong[0].clone(), away),
            (wrong_slope[0].clone(), &format!("{away}; its differences fall with 1.00")),
            (
                order(range, 1.0, None)[0].clone(),
                "order 1.000, 100 % interval [0.900, 1.100]; a fit; warning: few",
            ),
            (Evidence::Undecided { reason: "no time".into() }, "no time"),
        ];
        for (evidence, sentence) in sentences {
            assert_eq!(evidence.sentence(), sentence);
        }
        assert!(order(None, 1.0, None)[0].sentence().starts_with("no order can be named"));
        assert!(serde_json::to_string(&defect(1.0, true)).unwrap().contains(r#""kind":"defect""#));
        // Numbers of four digits in sight are written out.
        let sizes = [0.0, 0.01, 0.0099, 9999.0, 1e4, -0.5, -1e-5].map(short);
        let words = ["0", "0.0100", "9.9e-3", "9999.0000", "1.0e4", "-0.5000", "-1.0e-5"];
        assert_eq!(sizes, words);
    }
}
