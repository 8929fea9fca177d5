//! A fit in words: the one place that words what the fields of a [`Rate`] say.

use crate::{
    moments::FEW_SAMPLES,
    quantile::two_sided,
    rate::{Against, Model, Rate, STRAIGHT_CONFIDENCE, StraightLine},
};

/// The rate with [`Rate::method`] and [`Rate::warning`] made from its other fields.
pub fn describe(mut rate: Rate) -> Rate {
    rate.method = method(&rate);
    rate.warning = warning(&rate);
    rate
}

fn method(rate: &Rate) -> String {
    let model = match rate.model {
        Model::MeanSquares => {
            let curvature = rate.curvature_t.map_or("", |_| " + ln(1 + bτ)");
            format!("least squares, ln mean square = a + 2p ln τ{curvature}")
        }
        Model::Logarithms => "weighted least squares, ln error = a + p ln τ + bτ + cτ²".into(),
        Model::Powers { against, terms, expansion } => {
            let errors = match against {
                Against::Exact => "error",
                Against::HalfStep => "differences e(τ) − e(τ/2) of an error",
            };
            let step = expansion.step();
            let third = if terms == 3 { format!(" + Cτ^(p+{})", 2.0 * step) } else { "".into() };
            format!("profile of generalised least squares, {errors} = Aτ^p + Bτ^(p+{step}){third}")
        }
    };
    let mut text =
        format!("{model}, χ² = {:.1} with {} degrees of freedom", rate.chi_square, rate.degrees);
    if let Some((low, high)) = rate.bootstrap_lo.zip(rate.bootstrap_hi) {
        text += &format!("; bootstrap over paths [{low:.3}, {high:.3}]");
    }
    if let Some(line) = &rate.straight {
        let StraightLine { estimate, lo, hi, chi_square, degrees, .. } = line;
        text += &format!(
            "; a straight line would give {estimate:.3} [{lo:.3}, {hi:.3}], χ² = {chi_square:.1} \
             with {degrees} degrees of freedom: {}",
            bend(rate, line.refuted)
        );
    }
    let few = format!("fewer than {FEW_SAMPLES} effective paths carry the error");
    let not_asymptotic = "the model does not fit with them".to_owned();
    for (taus, reason) in [(&rate.left_out, few), (&rate.coarse, not_asymptotic)] {
        if !taus.is_empty() {
            let taus: Vec<String> = taus.iter().map(|tau| format!("{tau:.3e}")).collect();
            text += &format!("; left out, since {reason}: τ = {}", taus.join(", "));
        }
    }
    if rate.rests_on_few_paths() {
        text += &format!("; {}", wider_interval());
    }
    text
}

/// Whether the next order of the error bends the points, at the confidence with which the straight
/// line is refuted.
fn bend(rate: &Rate, refuted: bool) -> &'static str {
    if !refuted {
        "which the points do not contradict"
    } else if rate.curvature_t.unwrap_or(0.0).abs() < two_sided(STRAIGHT_CONFIDENCE, None) {
        "the points do not lie on a line"
    } else {
        "the coarse steps are not yet asymptotic"
    }
}

fn warning(rate: &Rate) -> Option<String> {
    let mut warnings = Vec::new();
    if rate.misfits() {
        warnings.push(format!(
            "the model does not fit: residuals so large have the probability {:.0e}, no order can \
             be read off",
            rate.p_value.unwrap_or(0.0)
        ));
    }
    if rate.rests_on_few_paths() {
        warnings.push(wider_interval());
    }
    (!warnings.is_empty()).then(|| warnings.join("; "))
}

fn wider_interval() -> String {
    format!(
        "fewer than {FEW_SAMPLES} effective paths carry the error: the interval is the wider of \
         both at each end"
    )
}

/// The warning at a point that few paths carry.
pub fn few_paths(effective: f64) -> Option<String> {
    (effective < FEW_SAMPLES).then(|| {
        format!(
            "only {effective:.0} effective paths carry the error; the interval may be too narrow"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rate::Expansion;

    fn words(rate: Rate) -> String {
        describe(rate).method
    }

    #[test]
    fn the_model_is_named() {
        let of =
            |model: Model| words(Rate { model, chi_square: 1.26, degrees: 3, ..Rate::default() });
        let expanded = |against, terms, expansion| of(Model::Powers { against, terms, expansion });
        let powers = |against, terms| expanded(against, terms, Expansion::EveryPower);
        let fits = "profile of generalised least squares,";
        let chi = "χ² = 1.3 with 3 degrees of freedom";
        let line = "least squares, ln mean square = a + 2p ln τ";
        assert_eq!(of(Model::MeanSquares), format!("{line}, {chi}"));
        let bent = Rate { curvature_t: Some(0.1), chi_square: 1.26, degrees: 3, ..Rate::default() };
        assert_eq!(words(bent), format!("{line} + ln(1 + bτ), {chi}"));
        let logarithms = "weighted least squares, ln error = a + p ln τ + bτ + cτ²";
        assert_eq!(of(Model::Logarithms), format!("{logarithms}, {chi}"));
        let two = format!("{fits} error = Aτ^p + Bτ^(p+1), {chi}");
        assert_eq!(powers(Against::Exact, 2), two);
        let three = "differences e(τ) − e(τ/2) of an error = Aτ^p + Bτ^(p+1) + Cτ^(p+2)";
        assert_eq!(powers(Against::HalfStep, 3), format!("{fits} {three}, {chi}"));
        let even = format!("{fits} error = Aτ^p + Bτ^(p+2) + Cτ^(p+4), {chi}");
        assert_eq!(expanded(Against::Exact, 3, Expansion::EvenPowers), even);
    }

    #[test]
    fn a_refuted_line_is_a_bend_only_where_the_bend_is_significant() {
        let of = |refuted: bool, curvature_t: Option<f64>| {
            let straight = Some(StraightLine { refuted, ..StraightLine::default() });
            words(Rate { straight, curvature_t, ..Rate::default() })
        };
        assert!(of(false, Some(9.0)).ends_with("which the points do not contradict"));
        // The quantile of 99 % is 2.576.
        for t in [None, Some(2.5), Some(-2.5)] {
            assert!(of(true, t).ends_with("the points do not lie on a line"), "{t:?}");
        }
        for t in [2.6, -2.6] {
            assert!(of(true, Some(t)).ends_with("the coarse steps are not yet asymptotic"), "{t}");
        }
    }

    #[test]
    fn what_was_left_out_is_listed_with_the_reason() {
        let plain = words(Rate::default());
        assert!(!plain.contains("left out") && !plain.contains("wider"), "{plain}");
        let few = words(Rate {
            left_out: vec![0.5, 0.25],
            effective_paths: Some(3.0),
            ..Rate::default()
        });
        let reason = "fewer than 30 effective paths carry the error";
        assert!(few.ends_with(&format!("; left out, since {reason}: τ = 5.000e-1, 2.500e-1")));
        let coarse = words(Rate { coarse: vec![0.5], ..Rate::default() });
        assert!(
            coarse.ends_with("; left out, since the model does not fit with them: τ = 5.000e-1")
        );
        let bootstrap =
            Rate { bootstrap_lo: Some(0.25), bootstrap_hi: Some(0.5), ..Rate::default() };
        assert!(words(bootstrap).ends_with("; bootstrap over paths [0.250, 0.500]"));
    }

    #[test]
    fn a_misfit_and_few_paths_are_warnings() {
        let of = |p_value, effective_paths| {
            describe(Rate { p_value, effective_paths, ..Rate::default() })
        };
        assert_eq!(of(Some(0.3), Some(30.0)).warning, None);
        let misfit = of(Some(2e-6), Some(100.0)).warning.unwrap();
        assert_eq!(
            misfit,
            "the model does not fit: residuals so large have the probability 2e-6, no order can be \
             read off"
        );
        let few = of(None, Some(29.0));
        let wider = "fewer than 30 effective paths carry the error: the interval is the wider of \
                     both at each end";
        assert_eq!(few.warning.as_deref(), Some(wider));
        assert!(few.method.ends_with(&format!("; {wider}")));
        assert_eq!(of(Some(2e-6), Some(29.0)).warning, Some(format!("{misfit}; {wider}")));
    }

    #[test]
    fn a_point_is_warned_about_below_thirty_effective_paths() {
        assert_eq!(few_paths(30.0), None);
        assert_eq!(
            few_paths(29.0).unwrap(),
            "only 29 effective paths carry the error; the interval may be too narrow"
        );
    }
}
