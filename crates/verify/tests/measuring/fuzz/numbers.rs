//! What is constructed from numbers.

use anyhow::{Result, ensure};
use noise::{MOST_AREA_TERMS, Truncation, area_error, area_terms};
use schemes::Step;
use systems::{Constant, Cosine, Damping, DampingFunction, Linear, Sine};

use super::{Bits, Fed, accepted, answer};

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
    Ok(())
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
    Ok(())
}
