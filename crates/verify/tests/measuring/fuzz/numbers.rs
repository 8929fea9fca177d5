//! Functions of numbers, and what is constructed from numbers.

use anyhow::{Result, bail, ensure};
use dgrad::{MAX_NODES, Rule, mean_cosine, mean_sine};
use noise::{MOST_AREA_TERMS, Truncation, area_error, area_terms};
use real::elementary;
use schemes::Step;
use systems::{Constant, Cosine, Damping, DampingFunction, Linear, Sine};

use super::{Bits, Fed, Refused, accepted, answer};

pub fn elementary_functions(bits: &mut Bits) -> Fed {
    let x = bits.number();
    let (sin, cos) = elementary::sin_cos(x);
    let (exp, ln, sinc) = (elementary::exp(x), elementary::ln(x), elementary::sinc(x));
    // Rounding may leave the interval by nothing: the polynomials are bounded by one.
    let sound = if x.is_finite() {
        let bounded = [sin, cos, sinc].iter().all(|value| value.abs() <= 1.0);
        bounded && exp >= 0.0 && ln.is_nan() == (x < 0.0) && !x.powi(3).is_nan()
    } else {
        [sin, cos, sinc].iter().all(|value| value.is_nan()) && exp.is_nan() == x.is_nan()
    };
    ensure!(sound, "{x:e}: sin {sin:e}, cos {cos:e}, sinc {sinc:e}, exp {exp:e}, ln {ln:e}");
    ensure!(x.is_finite(), Refused);
    Ok(0)
}

pub fn means(bits: &mut Bits) -> Fed {
    let (a, b) = (bits.number(), bits.number());
    let (sine, cosine) = (mean_sine(a, b), mean_cosine(a, b));
    // a + b and b − a may overflow for the largest arguments, which have no sine worth the name.
    ensure!((a.abs() + b.abs()).is_finite(), Refused);
    ensure!(sine.abs() <= 1.0 && cosine.abs() <= 1.0, "over [{a:e}, {b:e}]: {sine:e}, {cosine:e}");
    Ok(0)
}

pub fn rules(bits: &mut Bits) -> Fed {
    let nodes = if bits.one_in(8) { bits.word() } else { bits.below(600) } as usize;
    let Ok(rule) = Rule::new(nodes) else {
        ensure!(nodes == 0 || nodes > MAX_NODES, "{nodes} nodes are refused");
        bail!(Refused);
    };
    let sum: f64 = rule.weights().iter().sum();
    let positive = rule.weights().iter().all(|weight| *weight > 0.0);
    // n roundings of a sum of positive numbers that is one.
    let one = (sum - 1.0).abs() <= nodes as f64 * f64::EPSILON;
    ensure!(positive && one, "{nodes} nodes: sum {sum}, {:?}", rule.weights());
    Ok(0)
}

fn damping(bits: &mut Bits) -> Result<Box<dyn Damping>> {
    fn boxed(damping: impl Damping + 'static) -> Box<dyn Damping> {
        Box::new(damping)
    }
    let (a, b) = (bits.number(), bits.number());
    accepted(match bits.below(5) {
        0 => Constant::new(a).map(boxed),
        1 => Linear::new(a).map(boxed),
        2 => Sine::new(a, b).map(boxed),
        3 => Cosine::new(a, b).map(boxed),
        // A rate that a user got wrong: it may be anything at all.
        _ => DampingFunction::new(move |t: f64| a + b * t, bits.below(9) as usize).map(boxed),
    })
}

pub fn steps(bits: &mut Bits) -> Fed {
    let damping = damping(bits)?;
    ensure!(!damping.describe().is_empty(), "a damping without words");
    let tau = bits.positive(2);
    let n = if bits.one_in(2) { bits.word() } else { bits.below(1000) };
    let order = if bits.one_in(4) { 0 } else { bits.below(1 << 32) as u32 };
    if let Some(truncation) = answer(Truncation::new(order))? {
        for bound in [truncation.bound(tau), truncation.area_bound(tau)] {
            let sound = answer(bound)?.is_none_or(|bound| bound >= 0.0 && bound.is_finite());
            ensure!(sound, "{truncation:?}: bounds at {tau:e}");
        }
    }
    let step = accepted(Step::new(damping.as_ref(), n, tau))?;
    let sound = [step.first_decay, step.second_decay].iter().all(|decay| *decay >= 0.0);
    ensure!(sound || step.damping_integral().is_nan(), "{step:?}");
    Ok(0)
}

pub fn areas(bits: &mut Bits) -> Fed {
    let wild = if bits.one_in(2) { 1 } else { 8 };
    let (error, step, noises) = (bits.positive(wild), bits.positive(wild), bits.below(9) as usize);
    let terms = accepted(area_terms(error, step, noises))?;
    let bound = area_error(step, terms, noises);
    ensure!(
        terms <= MOST_AREA_TERMS && bound <= error * (1.0 + 1e-9),
        "{noises} noises, step {step:e}: {terms} terms for {error:e}: {bound:e}"
    );
    Ok(0)
}
