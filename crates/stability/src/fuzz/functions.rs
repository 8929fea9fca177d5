//! Elementary functions and discrete gradients.

use real::elementary;

use super::{Bits, Report, Target, check};

pub(super) const TARGETS: [Target; 3] = [
    Target {
        name: "elementary functions",
        checks: "sin, cos in [−1, 1]; eˣ in [0, ∞]; ln and sinc of a finite argument are NaN only where they are not defined",
        cost: 1,
        run: elementary_functions,
    },
    Target {
        name: "discrete gradients of sines",
        checks: "a mean of sines or cosines of finite arguments is in [−1, 1]",
        cost: 1,
        run: means,
    },
    Target {
        name: "quadrature rules",
        checks: "a rule is refused or has positive weights that add up to one",
        cost: 2000,
        run: rules,
    },
];

fn elementary_functions(bits: &mut Bits) -> Result<Report, String> {
    let x = bits.number();
    let (sin, cos) = elementary::sin_cos(x);
    let (exp, ln, sinc) = (elementary::exp(x), elementary::ln(x), elementary::sinc(x));
    if x.is_finite() {
        // Rounding may leave the interval by nothing: the polynomials are bounded by one.
        check(sin.abs() <= 1.0 && cos.abs() <= 1.0, || {
            format!("sin, cos {x:e} = {sin:e}, {cos:e}")
        })?;
        check(sinc.abs() <= 1.0, || format!("sinc {x:e} = {sinc:e}"))?;
        check(exp >= 0.0, || format!("exp {x:e} = {exp:e}"))?;
        check(ln.is_nan() == (x < 0.0), || format!("ln {x:e} = {ln:e}"))?;
        check(x.powi(3).is_nan() == x.is_nan(), || format!("{x:e}³"))?;
        Ok(Report::accepted())
    } else {
        check(sin.is_nan() && cos.is_nan() && sinc.is_nan(), || {
            format!("sin, cos, sinc {x} are numbers")
        })?;
        check(exp.is_nan() == x.is_nan(), || format!("exp {x} = {exp}"))?;
        Ok(Report::refused())
    }
}

fn means(bits: &mut Bits) -> Result<Report, String> {
    let (a, b) = (bits.number(), bits.number());
    let (sine, cosine) = (dgrad::mean_sine(a, b), dgrad::mean_cosine(a, b));
    // a + b and b − a may overflow for the largest arguments, which have no sine worth the name.
    if (a.abs() + b.abs()).is_finite() {
        check(sine.abs() <= 1.0 && cosine.abs() <= 1.0, || {
            format!("means over [{a:e}, {b:e}]: {sine:e}, {cosine:e}")
        })?;
        Ok(Report::accepted())
    } else {
        Ok(Report::refused())
    }
}

fn rules(bits: &mut Bits) -> Result<Report, String> {
    let nodes = match bits.below(8) {
        0 => bits.word() as usize,
        _ => bits.below(600) as usize,
    };
    match dgrad::Rule::new(nodes) {
        Err(_) => {
            check(nodes == 0 || nodes > dgrad::MAX_NODES, || format!("{nodes} nodes are refused"))?;
            Ok(Report::refused())
        }
        Ok(rule) => {
            let sum: f64 = rule.weights().iter().sum();
            check(rule.weights().iter().all(|weight| *weight > 0.0), || {
                format!("{nodes} nodes: weights")
            })?;
            // n roundings of a sum of positive numbers that is one.
            check((sum - 1.0).abs() <= nodes as f64 * f64::EPSILON, || {
                format!("{nodes} nodes: sum {sum}")
            })?;
            Ok(Report::accepted())
        }
    }
}
