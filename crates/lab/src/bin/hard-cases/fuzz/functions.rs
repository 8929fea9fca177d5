//! Elementary functions and discrete gradients.

use anyhow::ensure;
use dgrad::{MAX_NODES, Rule, mean_cosine, mean_sine};
use real::elementary;

use super::{Bits, Fed, Target};

pub const TARGETS: [Target; 3] = [
    Target {
        name: "elementary functions",
        checks: "sin, cos in [−1, 1]; eˣ in [0, ∞]; ln and sinc of a finite argument are NaN only \
                 where they are not defined",
        cost: 1,
        feed: elementary_functions,
    },
    Target {
        name: "discrete gradients of sines",
        checks: "a mean of sines or cosines of finite arguments is in [−1, 1]",
        cost: 1,
        feed: means,
    },
    Target {
        name: "quadrature rules",
        checks: "a rule is refused or has positive weights that add up to one",
        cost: 2000,
        feed: rules,
    },
];

fn elementary_functions(bits: &mut Bits) -> Fed {
    let x = bits.number();
    let (sin, cos) = elementary::sin_cos(x);
    let (exp, ln, sinc) = (elementary::exp(x), elementary::ln(x), elementary::sinc(x));
    if !x.is_finite() {
        ensure!(sin.is_nan() && cos.is_nan() && sinc.is_nan(), "sin, cos, sinc {x} are numbers");
        ensure!(exp.is_nan() == x.is_nan(), "exp {x} = {exp}");
        return Ok(None);
    }
    // Rounding may leave the interval by nothing: the polynomials are bounded by one.
    ensure!(sin.abs() <= 1.0 && cos.abs() <= 1.0, "sin, cos {x:e} = {sin:e}, {cos:e}");
    ensure!(sinc.abs() <= 1.0, "sinc {x:e} = {sinc:e}");
    ensure!(exp >= 0.0, "exp {x:e} = {exp:e}");
    ensure!(ln.is_nan() == (x < 0.0), "ln {x:e} = {ln:e}");
    ensure!(!x.powi(3).is_nan(), "{x:e}³");
    Ok(Some(0))
}

fn means(bits: &mut Bits) -> Fed {
    let (a, b) = (bits.number(), bits.number());
    let (sine, cosine) = (mean_sine(a, b), mean_cosine(a, b));
    // a + b and b − a may overflow for the largest arguments, which have no sine worth the name.
    if !(a.abs() + b.abs()).is_finite() {
        return Ok(None);
    }
    ensure!(sine.abs() <= 1.0 && cosine.abs() <= 1.0, "over [{a:e}, {b:e}]: {sine:e}, {cosine:e}");
    Ok(Some(0))
}

fn rules(bits: &mut Bits) -> Fed {
    let nodes = if bits.one_in(8) { bits.word() } else { bits.below(600) } as usize;
    let Ok(rule) = Rule::new(nodes) else {
        ensure!(nodes == 0 || nodes > MAX_NODES, "{nodes} nodes are refused");
        return Ok(None);
    };
    let sum: f64 = rule.weights().iter().sum();
    ensure!(rule.weights().iter().all(|weight| *weight > 0.0), "{nodes} nodes: weights");
    // n roundings of a sum of positive numbers that is one.
    ensure!((sum - 1.0).abs() <= nodes as f64 * f64::EPSILON, "{nodes} nodes: sum {sum}");
    Ok(Some(0))
}
