//! Everything that is constructed from numbers.

use anyhow::{Result, ensure};
use noise::{AreaMethod, Truncation};
use schemes::Step;
use systems::{Constant, Cosine, Damping, DampingFunction, Linear, PoissonSystem, Problem, Sine};

use super::systems::{Visitor, visit};
use super::{Bits, Fed, Target, accepted, counted};

pub const TARGETS: [Target; 3] = [
    Target {
        name: "systems, dampings, problems",
        checks: "refused in words, or all parameters are finite and the start is in the domain",
        cost: 1,
        feed: visit::<MakeProblem>,
    },
    Target {
        name: "steps and truncation",
        checks: "refused in words, or no factor is negative, and NaN only where ∫γ is; bounds are \
                 positive and finite",
        cost: 1,
        feed: steps,
    },
    Target {
        name: "Lévy areas: error bounds and terms",
        checks: "refused in words, or a number of terms whose bound is the error asked for",
        cost: 1,
        feed: areas,
    },
];

struct MakeProblem;

impl Visitor for MakeProblem {
    const WILD: u64 = 2;
    fn visit<S: PoissonSystem<D, M> + 'static, const D: usize, const M: usize>(
        bits: &mut Bits,
        system: S,
    ) -> Fed {
        let (y0, t_end) = (bits.state::<D>(), bits.positive(2));
        let Some(damping) = accepted(Constant::new(bits.number()))? else { return Ok(None) };
        let problem = accepted(Problem::new::<M>(system, damping, y0, t_end))?;
        if let Some(problem) = &problem {
            let finite = y0.iter().chain([&t_end]).all(|number| number.is_finite());
            let sound = finite && t_end > 0.0 && problem.system.check_domain(y0).is_ok();
            ensure!(sound, "accepted {y0:?}, T = {t_end:e}");
        }
        counted(problem)
    }
}

fn damping(bits: &mut Bits) -> Result<Option<Box<dyn Damping>>> {
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

fn steps(bits: &mut Bits) -> Fed {
    let Some(damping) = damping(bits)? else { return Ok(None) };
    ensure!(!damping.describe().is_empty(), "a damping without words");
    let tau = bits.positive(2);
    let n = if bits.one_in(2) { bits.word() } else { bits.below(1000) };
    let order = if bits.one_in(4) { 0 } else { bits.below(1 << 32) as u32 };
    if let Some(truncation) = accepted(Truncation::new(order))? {
        for bound in [truncation.bound(tau), truncation.area_bound(tau)] {
            if let Some(bound) = accepted(bound)? {
                ensure!(bound >= 0.0 && bound.is_finite(), "bound({tau:e}) = {bound:e}");
            }
        }
    }
    let step = accepted(Step::new(damping.as_ref(), n, tau))?;
    if let Some(step) = &step {
        let sound = [step.first_decay, step.second_decay].iter().all(|decay| *decay >= 0.0);
        ensure!(sound || step.damping_integral().is_nan(), "{step:?}");
    }
    counted(step)
}

fn areas(bits: &mut Bits) -> Fed {
    let method = AreaMethod::ALL[bits.below(4) as usize];
    let wild = if bits.one_in(2) { 1 } else { 8 };
    let (error, step, noises) = (bits.positive(wild), bits.positive(wild), bits.below(9) as usize);
    accepted(AreaMethod::cheapest(error, step, noises))?;
    let terms = accepted(method.terms_for(error, step, noises))?;
    if let Some(terms) = terms {
        let bound = method.rms_error(step, terms, noises);
        ensure!(
            terms <= AreaMethod::MAX_TERMS && bound <= error * (1.0 + 1e-9),
            "{method:?} {noises} noises, step {step:e}: {terms} terms for {error:e}, bound {bound:e}"
        );
    }
    counted(terms)
}
