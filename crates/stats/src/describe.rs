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
        Model::Powers { against, terms } => {
            let errors = match against {
                Against::Exact => "error",
                Against::HalfStep => "differences e(τ) − e(τ/2) of an error",
            };
            let third = if terms == 3 { " + Cτ^(p+2)" } else { "" };
            format!("profile of generalised least squares, {errors} = Aτ^p + Bτ^(p+1){third}")
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
