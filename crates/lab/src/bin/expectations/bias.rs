//! The bias of schemes at few steps, by scrambled Sobol points.

use anyhow::Result;
use lab::streams;
use mc::{Observable, Run, View};
use noise::StreamKey;
use schemes::{EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLi, Split, Sweep};
use systems::{Cosine, Problem, RigidBody, paper::rigid_body_three_noises};
use verify::{FinalMoments, rigid_body_expectations};

use crate::{
    cost::degree,
    results::{Bias, BiasPoint, FunctionBias, SchemeBias},
    scrambles::{Scrambles, means},
};

/// Numbers of steps.
pub const STEPS: [u64; 4] = [1, 2, 4, 8];

type Body = RigidBody<3>;

/// A scheme, or two over which φ is averaged on the same increments.
struct Entry {
    name: &'static str,
    schemes: Vec<Box<dyn Scheme<Body, 3, 3>>>,
}

fn entries(problem: &Problem<Body, Cosine, 3>) -> Result<Vec<Entry>> {
    let one = |name, scheme| Entry { name, schemes: vec![scheme] };
    let sweep = |sweep| Box::new(Nv::of_parts().with_sweep(sweep)) as Box<dyn Scheme<Body, 3, 3>>;
    let both = vec![sweep(Sweep::Forward), sweep(Sweep::Backward)];
    Ok(vec![
        one("em", lab::compiled(EulerMaruyama)),
        one("heun", Box::new(Heun)),
        one("midpoint", lab::compiled(Midpoint)),
        one("sexp", lab::compiled(Sexp)),
        one("sexp-li", lab::compiled(SexpLi::new(problem.system(), problem.y0())?)),
        one("split", Box::new(Split)),
        one("nv", sweep(Sweep::Alternating)),
        Entry { name: "nv, both orders", schemes: both },
    ])
}

fn observables() -> Vec<Observable<3>> {
    vec![
        Observable { name: "y3", function: |y| y[2] },
        Observable { name: "y2^2", function: |y| y[1] * y[1] },
        Observable { name: "cos y3", function: |y| real::elementary::cos(y[2]) },
    ]
}

/// The bias of every scheme.
pub fn measure(seed: u64, quick: bool) -> Result<Bias> {
    let problem = rigid_body_three_noises(1.0);
    let observables = observables();
    let exact = rigid_body_expectations(&problem, degree(quick), &observables);
    let (scrambles, points) = if quick { (16, 1 << 8) } else { (32, 1 << 16) };
    let values = |view: &View<'_>, p: usize, numbers: &mut [f64]| {
        for (number, observable) in numbers.iter_mut().zip(&observables) {
            let phi = |run: usize| (observable.function)(view.path(run, p));
            *number = (0..view.runs()).map(phi).sum::<f64>() / view.runs() as f64;
        }
    };
    let mut schemes = Vec::new();
    for entry in entries(&problem)? {
        let clips = entry.schemes.iter().any(|scheme| scheme.clips_increments());
        // Truncation is for steps below one.
        let all = STEPS.into_iter().filter(|&steps| steps > 1 || !clips);
        let mut functions: Vec<FunctionBias> = observables.iter().map(none).collect();
        for steps in all {
            // The same scrambles for all schemes, and others for each number of steps.
            let experiment = streams::EXPECTATION_BIAS + u64::from(steps.ilog2());
            let key = StreamKey { seed, experiment };
            let settings = Scrambles { key, count: scrambles, points };
            let runs = || entry.schemes.iter().map(|one| Run::new(one.as_ref(), 0)).collect();
            let new = || FinalMoments::new(steps, observables.len(), &values);
            let measured = settings.each(&problem, (steps, 0), runs, new)?;
            let (means, failed) = means(&measured, |last| &last.moments);
            for ((function, (mean, half_width)), exact) in
                functions.iter_mut().zip(means).zip(&exact)
            {
                let bias = mean - exact;
                function.points.push(BiasPoint { steps, points, bias, half_width, failed });
            }
        }
        schemes.push(SchemeBias { scheme: entry.name, functions });
    }
    Ok(Bias { scrambles, schemes })
}

fn none(observable: &Observable<3>) -> FunctionBias {
    let name = observable.name.into();
    FunctionBias { name, points: Vec::new() }
}
