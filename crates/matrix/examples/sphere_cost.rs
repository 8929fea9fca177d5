//! Seconds of the processor, errors and drifts of Euler's equations on the sphere up to T.
//!
//! `cargo run --release -p casimir-matrix --features measuring --example sphere_cost --` takes
//! `FOLDER T N…`, writes the initial and the last matrices there, for `examples/isospectral.py`,
//! and prints a table; or `drift STEPS N…`, for the changes of tr Wᵏ after STEPS steps with noise
//! and τ‖V‖ = 1, from k = 2 to 8, relative to those of |W|; or `threads TURNS N…`, for the least
//! time of a step on one thread and on two, by turns.

use std::{
    error::Error,
    fs,
    path::Path,
    sync::Arc,
    time::{Duration, Instant},
};

use matrix::{
    InCoordinates, MatrixSystem, Scheme, Sphere, c64, coordinates, matrices, setup, traces,
};
use noise::StepNoise;
use nonlin::BlockStatus;
use real::PathMask;
use schemes::Step;
use systems::{Constant, run_time::Problem};

/// Harmonics of degrees up to 10 with a mean square of one on the sphere.
fn vorticity(fluid: &Sphere) -> Vec<c64> {
    let n = fluid.size();
    let mut w = vec![c64::default(); n * n];
    for l in 1..=10usize {
        for m in -(l as isize)..=l as isize {
            let key = (100 * l) as isize + m;
            let x = (noise::mix(key as u64) >> 11) as f64 * f64::EPSILON - 1.0;
            fluid.harmonics().add(&mut w, l, m, x / l as f64);
        }
    }
    let size = (4.0 * std::f64::consts::PI / matrix::inner(&w, &w)).sqrt();
    w.iter_mut().for_each(|w| *w *= size);
    w
}

/// The last matrix, and the seconds of the fastest step; of none if a step fails.
fn run(
    fluid: &Arc<Sphere>,
    w: &[c64],
    scheme: Scheme,
    (t_end, steps): (f64, u64),
) -> Result<(Vec<c64>, f64), Box<dyn Error>> {
    let n = fluid.size();
    let mut y0 = vec![0.0; n * n];
    coordinates(n, w, |i, y| y0[i] = y);
    let system = InCoordinates::new(Arc::clone(fluid));
    let problem = Problem::new(Arc::new(system), Arc::new(Constant::new(0.0)?), y0, t_end)?;
    let setup = setup(&problem, Arc::clone(fluid) as _, scheme);
    let mut path = setup.scheme.start(&setup.start());
    path.rests(PathMask::first(1));
    let (noise, mut status) = (StepNoise::zero(0), BlockStatus::explicit());
    let mut seconds = f64::INFINITY;
    for k in 0..steps {
        let start = Instant::now();
        path.step(&Step::new(problem.damping(), k, t_end / steps as f64)?, &noise, &mut status);
        seconds = start.elapsed().as_secs_f64().min(seconds);
        if !status.failed.is_empty() {
            return Ok((w.to_vec(), f64::NAN));
        }
    }
    let mut end = vec![c64::default(); n * n];
    matrices(n, |i| path.state()[i][0], &mut end);
    Ok((end, seconds))
}

/// Seconds of the processor so far, in hundredths, of all threads: other work on the machine does
/// not count.
fn processor() -> Result<f64, Box<dyn Error>> {
    let stat = fs::read_to_string("/proc/self/stat")?;
    let fields: Vec<&str> = stat.rsplit(") ").next().unwrap_or_default().split(' ').collect();
    Ok(0.01 * (fields[11].parse::<f64>()? + fields[12].parse::<f64>()?))
}

fn distance(a: &[c64], b: &[c64]) -> f64 {
    let square: f64 = a.iter().zip(b).map(|(a, b)| (a - b).norm_sqr()).sum();
    (square / matrix::inner(b, b)).sqrt()
}

fn write(folder: &str, name: &str, w: &[c64]) -> Result<(), Box<dyn Error>> {
    let bytes: Vec<u8> = w.iter().flat_map(|w| [w.re, w.im]).flat_map(f64::to_le_bytes).collect();
    Ok(fs::write(Path::new(folder).join(name), bytes)?)
}

fn drift(n: usize, steps: u64) -> Result<(), Box<dyn Error>> {
    // Of a norm such that τ times the largest eigenvalue of V is about one.
    let scale = matrix::bracket_scale(n);
    let noise = [1, 2].into_iter().flat_map(|l| matrix::Stirring::isotropic(l, 0.5 / scale));
    let fluid = Arc::new(Sphere::new(n, 0.0, 1.0, noise)?);
    let mut w = vec![c64::default(); n * n];
    matrices(n, |i| (noise::mix(i as u64) >> 11) as f64 * f64::EPSILON - 1.0, &mut w);
    let mut v = w.clone();
    fluid.generator(&w, 1.0, &[0.0; 8], &mut v);
    let largest = |v: &[c64]| -> Result<f64, Box<dyn Error>> {
        let view = faer::MatRef::from_column_major_slice(v, n, n);
        let all = view.self_adjoint_eigenvalues(faer::Side::Lower).map_err(|e| format!("{e:?}"))?;
        Ok(all.iter().fold(0.0, |most: f64, x| most.max(x.abs())))
    };
    let tau = 1.0 / largest(&v)?;
    let mut y0 = vec![0.0; n * n];
    coordinates(n, &w, |i, y| y0[i] = y);
    let system = InCoordinates::new(Arc::clone(&fluid));
    let problem = Problem::new(Arc::new(system), Arc::new(Constant::new(0.0)?), y0, 1.0)?;
    let setup = setup(&problem, Arc::clone(&fluid) as _, Scheme::Explicit);
    let mut path = setup.scheme.start(&setup.start());
    path.rests(PathMask::first(1));
    let (mut noise, mut status) = (StepNoise::zero(8), BlockStatus::explicit());
    let key = noise::StreamKey { seed: 1, experiment: 0 };
    let mut wiener = noise::WienerRows::new(key, 0);
    let start = Instant::now();
    for k in 0..steps {
        wiener.increments(1.0, &mut noise.increments);
        path.step(&Step::new(problem.damping(), k, tau)?, &noise, &mut status);
    }
    let seconds = start.elapsed().as_secs_f64();
    let mut end = vec![c64::default(); n * n];
    matrices(n, |i| path.state()[i][0], &mut end);
    let of = |w: &[c64]| -> Result<Vec<f64>, Box<dyn Error>> {
        let view = faer::MatRef::from_column_major_slice(w, n, n);
        view.self_adjoint_eigenvalues(faer::Side::Lower).map_err(|e| format!("{e:?}").into())
    };
    let (a, b) = (of(&w)?, of(&end)?);
    let apart = a.iter().zip(&b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    let [ta, tb] = [&w, &end].map(|w| traces(n, w, 8));
    let words: Vec<String> = (2..=8)
        .map(|k| {
            let size: f64 = a.iter().map(|x| x.abs().powi(k as i32)).sum();
            format!("{:.1e}", (tb[k - 1] - ta[k - 1]).abs() / size)
        })
        .collect();
    let relative = apart / largest(&w)?;
    println!(
        "{n} {steps} steps, {seconds:.0} s: {}; eigenvalues to {relative:.1e}",
        words.join(" ")
    );
    Ok(())
}

fn threads(n: usize, turns: usize) -> Result<(), Box<dyn Error>> {
    let fluid = Arc::new(Sphere::new(n, 0.0, 1.0, [])?);
    let w = vorticity(&fluid);
    let mut seconds = [f64::INFINITY; 2];
    for k in 0..turns {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1 + k % 2).build()?;
        let one = || run(&fluid, &w, Scheme::Explicit, (0.01, 4)).map(|found| found.1);
        let of = pool.install(|| one().map_err(|error| error.to_string()))?;
        seconds[k % 2] = of.min(seconds[k % 2]);
        std::thread::sleep(Duration::from_millis(50));
    }
    let [one, two] = seconds.map(|seconds| 1e3 * seconds);
    println!("{n}: {one:.2} ms a step on one thread, {two:.2} on two: {:.2}", one / two);
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments[1] == "drift" {
        return arguments[3..].iter().try_for_each(|n| drift(n.parse()?, arguments[2].parse()?));
    }
    if arguments[1] == "threads" {
        return arguments[3..].iter().try_for_each(|n| threads(n.parse()?, arguments[2].parse()?));
    }
    let t_end: f64 = arguments[2].parse()?;
    let of = |steps: f64| (t_end, (steps * t_end / 10.0).ceil() as u64);
    for size in &arguments[3..] {
        let n: usize = size.parse()?;
        let fluid = Arc::new(Sphere::new(n, 0.0, 1.0, [])?);
        let w = vorticity(&fluid);
        // Extrapolated: errors are of order two.
        let (a, b) = (
            run(&fluid, &w, Scheme::Explicit, of(1600.0))?.0,
            run(&fluid, &w, Scheme::Explicit, of(3200.0))?.0,
        );
        let exact: Vec<c64> = a.iter().zip(&b).map(|(a, b)| (b * 4.0 - a) / 3.0).collect();
        write(&arguments[1], &format!("start{n}"), &w)?;
        write(&arguments[1], &format!("end{n}"), &exact)?;
        for scheme in [Scheme::Explicit, Scheme::Midpoint] {
            for steps in [25.0, 50.0, 100.0, 200.0, 400.0, 800.0].map(of) {
                let start = processor()?;
                let (end, step) = run(&fluid, &w, scheme, steps)?;
                let (seconds, steps) = (processor()? - start, steps.1);
                if step.is_nan() {
                    println!("{n} {scheme:?} {steps}: the iteration does not converge");
                    continue;
                }
                let both = traces(n, &w, 4).into_iter().zip(traces(n, &end, 4));
                let drift =
                    both.skip(1).step_by(2).map(|(a, b)| (b / a - 1.0).abs()).fold(0.0, f64::max);
                let error = distance(&end, &exact);
                println!(
                    "{n} {scheme:?} {steps}: error {error:.2e}, {seconds:.3} s, tr W^2, W^4 to {drift:.1e}"
                );
            }
        }
    }
    Ok(())
}
