//! Everything that can be constructed from numbers.

use std::fmt::Display;

use mc::multilevel::{Coupling, ExpectationSettings, expectation};
use mc::{Ladder, Observable, Run, trajectory};
use noise::{AreaMethod, StreamKey, Truncation};
use schemes::{EulerMaruyama, Step};
use systems::{
    Constant, Cosine, Damping, DampingFunction, IntegerExponents, Linear, LotkaVolterra, Pendulum,
    Poisson3, PoissonSystem, Problem, RigidBody, RigidBodyEnergy, Sine, SpinChain,
};

use super::{Bits, Report, Target, check};

pub(super) const TARGETS: [Target; 4] = [
    Target {
        name: "systems, dampings, problems",
        checks: "refused in words, or all parameters are finite and the start is in the domain",
        cost: 1,
        run: problems,
    },
    Target {
        name: "steps and truncation",
        checks: "refused in words, or no factor is negative, and NaN only where ∫γ is; bounds are positive and finite",
        cost: 1,
        run: steps,
    },
    Target {
        name: "Lévy areas: error bounds and terms",
        checks: "refused in words, or a number of terms whose bound is the error asked for",
        cost: 1,
        run: areas,
    },
    Target {
        name: "ladders, trajectories, multilevel settings",
        checks: "refused in words, or every state of the result is finite",
        cost: 40,
        run: drivers,
    },
];

/// Whether something was accepted; a refusal must have words.
fn accepted<T, E: Display>(result: Result<T, E>) -> Result<Option<T>, String> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(error) => {
            let words = error.to_string();
            check(words.len() > 8, || format!("a refusal without words: {words:?}"))?;
            Ok(None)
        }
    }
}

fn report<T>(accepted: &Option<T>) -> Report {
    if accepted.is_some() { Report::accepted() } else { Report::refused() }
}

/// Whether a system is one: finite at ordinary points.
fn usable<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    system: Option<&S>,
    parameters: &[f64],
) -> Result<(), String> {
    check(system.is_none() || parameters.iter().all(|p| p.is_finite()), || {
        format!("accepted {parameters:?}")
    })
}

fn problems(bits: &mut Bits) -> Result<Report, String> {
    let p: [f64; 6] =
        [(); 6].map(|()| if bits.below(2) == 0 { bits.number() } else { bits.plausible() });
    let t_end = if bits.below(2) == 0 { bits.number() } else { bits.plausible() };
    match bits.below(8) {
        0 => {
            let system = accepted(Pendulum::new(p[0]))?;
            usable::<_, 2, 1>(system.as_ref(), &p[..1])?;
            with_system(bits, system, t_end)
        }
        1 => {
            let system = accepted(RigidBody::three_noises([p[0], p[1], p[2]], [p[3], p[4], p[5]]))?;
            usable::<_, 3, 3>(system.as_ref(), &p)?;
            with_system::<_, 3, 3>(bits, system, t_end)
        }
        2 => {
            let system = accepted(RigidBody::one_noise([p[0], p[1], p[2]], p[3]))?;
            usable::<_, 3, 1>(system.as_ref(), &p[..4])?;
            with_system::<_, 3, 1>(bits, system, t_end)
        }
        3 => {
            let system = accepted(RigidBodyEnergy::new([p[0], p[1], p[2]], p[3]))?;
            usable::<_, 3, 1>(system.as_ref(), &p[..4])?;
            with_system(bits, system, t_end)
        }
        4 => {
            let system = accepted(LotkaVolterra::new(p[0], p[1], p[2]))?;
            usable::<_, 3, 1>(system.as_ref(), &p[..3])?;
            with_system(bits, system, t_end)
        }
        5 => {
            let system = accepted(LotkaVolterra::<IntegerExponents<2, 1>>::integer(p[0]))?;
            usable::<_, 3, 1>(system.as_ref(), &p[..1])?;
            with_system(bits, system, t_end)
        }
        6 => {
            let system = accepted(Poisson3::new(p[0]))?;
            usable::<_, 3, 1>(system.as_ref(), &p[..1])?;
            with_system(bits, system, t_end)
        }
        _ => {
            let system = accepted(SpinChain::<6>::new(p[0], p[1], p[2]))?;
            usable::<_, 6, 3>(system.as_ref(), &p[..3])?;
            with_system::<_, 6, 3>(bits, system, t_end)
        }
    }
}

fn with_system<S: PoissonSystem<D, M>, const D: usize, const M: usize>(
    bits: &mut Bits,
    system: Option<S>,
    t_end: f64,
) -> Result<Report, String> {
    let Some(system) = system else { return Ok(Report::refused()) };
    let y0 = bits.state::<D>();
    let Some(damping) = accepted(Constant::new(bits.number()))? else {
        return Ok(Report::refused());
    };
    let problem = accepted(Problem::new::<M>(system, damping, y0, t_end))?;
    if let Some(problem) = &problem {
        let sound = problem.y0.iter().all(|y| y.is_finite())
            && problem.t_end > 0.0
            && problem.t_end.is_finite();
        check(sound && problem.system.check_domain(problem.y0).is_ok(), || {
            format!("accepted {y0:?}, T = {t_end:e}")
        })?;
    }
    Ok(report(&problem))
}

fn damping(bits: &mut Bits) -> Result<Option<Box<dyn Damping>>, String> {
    let (a, b) = (bits.number(), bits.number());
    Ok(match bits.below(5) {
        0 => accepted(Constant::new(a))?.map(|d| Box::new(d) as Box<dyn Damping>),
        1 => accepted(Linear::new(a))?.map(|d| Box::new(d) as Box<dyn Damping>),
        2 => accepted(Sine::new(a, b))?.map(|d| Box::new(d) as Box<dyn Damping>),
        3 => accepted(Cosine::new(a, b))?.map(|d| Box::new(d) as Box<dyn Damping>),
        // A rate that a user got wrong: it may be anything at all.
        _ => accepted(DampingFunction::new(move |t: f64| a + b * t, bits.below(9) as usize))?
            .map(|d| Box::new(d) as Box<dyn Damping>),
    })
}

fn steps(bits: &mut Bits) -> Result<Report, String> {
    let Some(damping) = damping(bits)? else { return Ok(Report::refused()) };
    check(!damping.describe().is_empty(), || "a damping without words".to_owned())?;
    let tau = if bits.below(2) == 0 { bits.number() } else { bits.plausible() };
    let n = if bits.below(2) == 0 { bits.word() } else { bits.below(1000) };
    let truncation =
        accepted(Truncation::new(bits.below(1 << 32) as u32 * (bits.below(4) != 0) as u32))?;
    if let Some(truncation) = truncation {
        if let Some(bound) = accepted(truncation.bound(tau))? {
            check(bound > 0.0 && bound.is_finite(), || format!("bound({tau:e}) = {bound:e}"))?;
        }
        if let Some(bound) = accepted(truncation.area_bound(tau))? {
            check(bound >= 0.0 && bound.is_finite(), || {
                format!("area bound({tau:e}) = {bound:e}")
            })?;
        }
    }
    let step = accepted(Step::new(damping.as_ref(), n, tau))?;
    if let Some(step) = &step {
        let sound = [step.first_decay, step.second_decay].iter().all(|decay| *decay >= 0.0);
        check(sound || step.damping_integral().is_nan(), || format!("{step:?}"))?;
    }
    Ok(report(&step))
}

fn areas(bits: &mut Bits) -> Result<Report, String> {
    let method = AreaMethod::ALL[bits.below(4) as usize];
    let (error, step) = if bits.below(2) == 0 {
        (bits.number(), bits.number())
    } else {
        (bits.plausible(), bits.plausible())
    };
    let noises = bits.below(9) as usize;
    accepted(AreaMethod::cheapest(error, step, noises))?;
    let terms = accepted(method.terms_for(error, step, noises))?;
    if let Some(terms) = terms {
        let bound = method.rms_error(step, terms, noises);
        check(terms <= AreaMethod::MAX_TERMS && bound <= error * (1.0 + 1e-9), || {
            format!(
                "{method:?} {noises} noises, step {step:e}: {terms} terms for {error:e}, bound {bound:e}"
            )
        })?;
    }
    Ok(report(&terms))
}

fn drivers(bits: &mut Bits) -> Result<Report, String> {
    let t_end = bits.plausible();
    let Some(problem) = accepted(Pendulum::new(bits.plausible()).and_then(|system| {
        Problem::new::<1>(system, Constant::new(bits.number())?, bits.state::<2>(), t_end)
    }))?
    else {
        return Ok(Report::refused());
    };
    let truncation = match bits.below(3) {
        0 => Truncation::none(),
        _ => match accepted(Truncation::new(bits.below(5) as u32))? {
            Some(truncation) => truncation,
            None => return Ok(Report::refused()),
        },
    };
    let key = StreamKey { seed: bits.word(), experiment: bits.word() };
    match bits.below(3) {
        0 => {
            let path = accepted(trajectory(
                &problem,
                &EulerMaruyama,
                bits.below(20),
                truncation,
                key,
                bits.word(),
            ))?;
            if let Some(path) = &path {
                check(path.states.iter().flatten().all(|y| y.is_finite()), || format!("{path:?}"))?;
                check(path.failure.is_none_or(|failure| !failure.to_string().is_empty()), || {
                    "no words".to_owned()
                })?;
            }
            Ok(report(&path))
        }
        1 => {
            let levels =
                if bits.below(8) == 0 { bits.below(200) as usize } else { bits.below(4) as usize };
            let steps = if bits.below(8) == 0 { bits.word() } else { bits.below(33) };
            let run = Run::new(
                &EulerMaruyama,
                if bits.below(8) == 0 { bits.below(300) as usize } else { bits.below(4) as usize },
            );
            let ladder =
                accepted(Ladder::new(&problem, steps, levels, truncation, key, vec![run]))?;
            Ok(report(&ladder))
        }
        _ => {
            let mut settings =
                ExpectationSettings::new(key, truncation, bits.below(8), Coupling::Plain);
            settings.weak_order = if bits.below(2) == 0 { 1.0 } else { bits.number() };
            settings.pilot = if bits.below(2) == 0 { 128 } else { bits.word() };
            settings.max_level = bits.below(30) as usize;
            settings.key.experiment >>= bits.below(40);
            settings.max_cost = bits.below(20_000);
            let observables = [Observable { name: "y1", function: |y: [f64; 2]| y[0] }];
            let estimate = accepted(expectation(
                &EulerMaruyama,
                &problem,
                &observables,
                bits.plausible(),
                &settings,
                &|_| (),
            ))?;
            if let Some(estimate) = &estimate {
                let (lower, upper) = estimate.estimates[0].interval();
                check(!lower.is_nan() && !upper.is_nan(), || {
                    format!("interval [{lower}, {upper}]")
                })?;
            }
            Ok(report(&estimate))
        }
    }
}
