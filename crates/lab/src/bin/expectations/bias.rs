//! The bias of schemes at few steps, by scrambled Sobol points.

use anyhow::Result;
use lab::{streams, truncation};
use mc::{Ladder, NextNoise, NoiseSource, Observable, Run, View};
use noise::{BlockNoise, QuasiWiener, StepNoise, StreamKey};
use real::WIDTH;
use schemes::{EulerMaruyama, Heun, Midpoint, Nv, Scheme, Sexp, SexpLi, Split, Sweep};
use stats::{CONFIDENCE, Moments, two_sided};
use systems::{Cosine, Problem, RigidBody, paper::rigid_body_three_noises};
use verify::{FinalMoments, rigid_body_expectations};

use crate::{
    cost::degree,
    line::slope,
    results::{Bias, BiasPoint, FunctionBias, SchemeBias, Slope},
};

/// Numbers of steps of all schemes, and the one that schemes of weak order two have besides.
const STEPS: [u64; 4] = [1, 2, 4, 8];
const FURTHER: u64 = 16;

type Body = RigidBody<3>;

/// A scheme, or two over which φ is averaged on the same increments.
struct Entry {
    name: &'static str,
    second_order: bool,
    schemes: Vec<Box<dyn Scheme<Body, 3, 3>>>,
}

fn entries(problem: &Problem<Body, Cosine, 3>) -> Result<Vec<Entry>> {
    let one = |name, scheme| Entry { name, second_order: false, schemes: vec![scheme] };
    let sweep = |sweep| Box::new(Nv::of_parts().with_sweep(sweep)) as Box<dyn Scheme<Body, 3, 3>>;
    let both = vec![sweep(Sweep::Forward), sweep(Sweep::Backward)];
    Ok(vec![
        one("em", lab::compiled(EulerMaruyama)),
        one("heun", Box::new(Heun)),
        one("midpoint", lab::compiled(Midpoint)),
        one("sexp", lab::compiled(Sexp)),
        one("sexp-li", lab::compiled(SexpLi::new(problem.system(), problem.y0())?)),
        one("split", Box::new(Split)),
        Entry { second_order: true, ..one("nv", sweep(Sweep::Alternating)) },
        Entry { name: "nv, both orders", second_order: true, schemes: both },
    ])
}

/// The points of a scramble.
struct Points(QuasiWiener);

impl NoiseSource<BlockNoise<3>> for Points {
    fn block(&self, first_path: u64) -> NextNoise<'_, BlockNoise<3>> {
        let mut increments = vec![[0.0; WIDTH]; self.0.dimensions()];
        let drawn = self.0.block(first_path, &mut increments);
        // There are far fewer points than a scramble has.
        drawn.unwrap_or_else(|error| unreachable!("{error}"));
        let mut next = 0;
        Box::new(move |noise| {
            noise.increments_mut().copy_from_slice(&increments[next..next + 3]);
            next += 3;
        })
    }
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
    let mut schemes = Vec::new();
    for entry in entries(&problem)? {
        let clips = entry.schemes.iter().any(|scheme| scheme.clips_increments());
        let all = STEPS.into_iter().chain(entry.second_order.then_some(FURTHER));
        // Truncation is for steps below one.
        let all = all.filter(|&steps| steps > 1 || !clips);
        let mut functions: Vec<FunctionBias> = observables.iter().map(none).collect();
        for steps in all {
            // Biases of weak order two are small where steps are many.
            let points = if entry.second_order && !quick { points * steps } else { points };
            let (means, failed) =
                means(&problem, &entry, &observables, steps, (seed, scrambles, points))?;
            for ((function, mean), exact) in functions.iter_mut().zip(means).zip(&exact) {
                let quantile = two_sided(CONFIDENCE, Some((scrambles - 1) as f64));
                let half_width = quantile * mean.standard_error();
                let bias = mean.mean() - exact;
                function.points.push(BiasPoint { steps, points, bias, half_width, failed });
            }
        }
        if entry.second_order {
            for function in &mut functions {
                let points: Vec<BiasPoint> =
                    function.points.iter().copied().filter(|point| point.steps > 1).collect();
                (function.order, function.orders) = (order(&points), orders(&points));
            }
        }
        schemes.push(SchemeBias { scheme: entry.name, functions });
    }
    Ok(Bias { scrambles, schemes })
}

fn none(observable: &Observable<3>) -> FunctionBias {
    let name = observable.name.into();
    FunctionBias { name, points: Vec::new(), order: None, orders: Vec::new() }
}

/// The means of each test function over scrambles, and the number of failed paths.
fn means(
    problem: &Problem<Body, Cosine, 3>,
    entry: &Entry,
    observables: &[Observable<3>],
    steps: u64,
    (seed, scrambles, points): (u64, u64, u64),
) -> Result<(Vec<Moments>, u64)> {
    // The same scrambles for all schemes, and others for each number of steps.
    let experiment = streams::EXPECTATION_BIAS + u64::from(steps.ilog2());
    let key = StreamKey { seed, experiment };
    let values = |view: &View<'_>, p: usize, numbers: &mut [f64]| {
        for (number, observable) in numbers.iter_mut().zip(observables) {
            let phi = |run: usize| (observable.function)(view.path(run, p));
            *number = (0..view.runs()).map(phi).sum::<f64>() / view.runs() as f64;
        }
    };
    let (mut means, mut failed) = (vec![Moments::default(); observables.len()], 0);
    for scramble in 0..scrambles {
        let runs = entry.schemes.iter().map(|scheme| Run::new(scheme.as_ref(), 0)).collect();
        let wiener = QuasiWiener::new(key, scramble, steps, 3, problem.t_end())?;
        let ladder = Ladder::new(problem, steps, 0, truncation(), key, runs)?;
        let ladder = ladder.with_noise(Points(wiener))?;
        let new = || FinalMoments::new(ladder.coarse_steps(), observables.len(), &values);
        let measured = ladder.run(points, new, &|_| ());
        failed += measured.failed;
        for (index, mean) in means.iter_mut().enumerate() {
            mean.add(measured.statistic.moments.mean(index));
        }
    }
    Ok((means, failed))
}

/// The slope of ln |bias| over ln τ. The half-width of a logarithm is that of the number, relative.
fn order(points: &[BiasPoint]) -> Option<Slope> {
    let point = |point: &BiasPoint| {
        let size = point.bias.abs();
        (-(point.steps as f64).ln(), size.ln(), point.half_width / size)
    };
    slope(&points.iter().map(point).collect::<Vec<_>>())
}

/// Orders between neighbouring numbers of steps.
fn orders(points: &[BiasPoint]) -> Vec<Slope> {
    let between = |pair: &[BiasPoint]| {
        let relative = |point: &BiasPoint| point.half_width / point.bias.abs();
        let value = (pair[0].bias / pair[1].bias).abs().log2();
        let half = relative(&pair[0]).hypot(relative(&pair[1])) / std::f64::consts::LN_2;
        Slope { value, lo: value - half, hi: value + half }
    };
    points.windows(2).map(between).collect()
}
