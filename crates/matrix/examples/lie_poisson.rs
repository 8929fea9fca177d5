//! Strong orders and Casimirs on stochastic Lie–Poisson systems as those of Ephrati, Jansson, Luesink
//! and Modin (arXiv 2408.16701): a rigid body on su(2), Manakov's body on so(4), point vortices on
//! the sphere, and Zeitlin's model, each with one noise and with two that do not commute.

use std::{error::Error, sync::Arc};

use analysis::{StepSizes, strong_order};
use matrix::{
    InCoordinates, MatrixSystem, Scheme, Sphere, Stirring, c64, coordinates, inner, matrices,
    setup, traces,
};
use mc::{Setup, Simulation};
use noise::{StreamKey, Truncation};
use schemes::Heun;
use systems::{Constant, run_time::Problem};

type Gradient = dyn Fn(&[c64], &mut [c64]) + Send + Sync;

/// A system of a gradient and operators of noises, with H₀ left out.
struct Case {
    name: &'static str,
    n: usize,
    sites: usize,
    gradient: Box<Gradient>,
    noises: Vec<Vec<c64>>,
}

impl MatrixSystem for Case {
    fn name(&self) -> &str {
        self.name
    }
    fn size(&self) -> usize {
        self.n
    }
    fn sites(&self) -> usize {
        self.sites
    }
    fn noises(&self) -> usize {
        self.noises.len()
    }
    fn generator(&self, w: &[c64], dt: f64, dw: &[f64], v: &mut [c64]) {
        (self.gradient)(w, v);
        v.iter_mut().for_each(|v| *v *= dt);
        for (noise, dw) in self.noises.iter().zip(dw) {
            v.iter_mut().zip(noise).for_each(|(v, l)| *v += *l * *dw);
        }
    }
    fn energy(&self, _: &[c64]) -> f64 {
        0.0
    }
}

/// s·σ for a vector s, times a weight.
fn spin([x, y, z]: [f64; 3], weight: f64) -> [c64; 4] {
    [c64::new(z, 0.0), c64::new(x, y), c64::new(x, -y), c64::new(-z, 0.0)].map(|w| w * weight)
}

/// The vector of a matrix of size 2.
fn vector(w: &[c64]) -> [f64; 3] {
    [w[1].re, w[1].im, 0.5 * (w[0].re - w[3].re)]
}

fn rigid_body(noises: usize) -> (Case, Vec<c64>) {
    let gradient = |w: &[c64], v: &mut [c64]| {
        let [x, y, z] = vector(w);
        v.copy_from_slice(&spin([0.5 * x, y, 1.5 * z], 1.0));
    };
    let noises = [[0.2, 0.0, 0.4], [0.0, 0.5, 0.1]][..noises].iter().map(|s| spin(*s, 1.0).into());
    let case = Case {
        name: "rigid body, su(2)",
        n: 2,
        sites: 1,
        gradient: Box::new(gradient),
        noises: noises.collect(),
    };
    (case, spin([0.6, 0.3, 0.74], 1.0).into())
}

/// i(e_jk − e_kj).
fn plane(n: usize, j: usize, k: usize, x: f64, w: &mut [c64]) {
    (w[k * n + j], w[j * n + k]) = (c64::new(0.0, x), c64::new(0.0, -x));
}

fn manakov(noises: usize) -> (Case, Vec<c64>) {
    let n = 4;
    let inertia = [1.0, 1.6, 2.3, 3.1];
    let gradient = move |w: &[c64], v: &mut [c64]| {
        for k in 0..n {
            for j in 0..n {
                v[k * n + j] = w[k * n + j] / (inertia[j] + inertia[k]);
            }
        }
    };
    let matrix = |entries: &[(usize, usize, f64)]| {
        let mut w = vec![c64::default(); n * n];
        entries.iter().for_each(|&(j, k, x)| plane(n, j, k, x, &mut w));
        w
    };
    let all = [matrix(&[(0, 1, 0.4), (2, 3, 0.2)]), matrix(&[(1, 2, 0.4), (0, 3, -0.3)])];
    let start =
        matrix(&[(0, 1, 0.5), (0, 2, -0.3), (0, 3, 0.4), (1, 2, 0.7), (1, 3, -0.2), (2, 3, 0.6)]);
    let gradient = Box::new(gradient);
    let noises = all[..noises].to_vec();
    (Case { name: "Manakov, so(4)", n, sites: 1, gradient, noises }, start)
}

fn vortices(noises: usize) -> (Case, Vec<c64>) {
    let strengths = [1.0, -0.7, 0.8, 1.2];
    let places = [[0.6, 0.0, 0.8], [0.0, 0.8, 0.6], [-0.8, 0.0, 0.6], [0.0, -0.6, -0.8]];
    // W = ½Γn·σ at each vortex, and H₀ = −ΣΓᵢΓⱼ ln(1 − nᵢ·nⱼ)/4π.
    let gradient = move |w: &[c64], v: &mut [c64]| {
        let n: [[f64; 3]; 4] =
            std::array::from_fn(|i| vector(&w[4 * i..4 * i + 4]).map(|x| 2.0 * x / strengths[i]));
        for i in 0..4 {
            let mut sum = [0.0; 3];
            for j in (0..4).filter(|j| *j != i) {
                let cosine: f64 = n[i].iter().zip(&n[j]).map(|(a, b)| a * b).sum();
                let factor = strengths[j] / (4.0 * std::f64::consts::PI * (1.0 - cosine));
                (0..3).for_each(|a| sum[a] += factor * n[j][a]);
            }
            v[4 * i..4 * i + 4].copy_from_slice(&spin(sum, 0.5));
        }
    };
    let turn = |s: [f64; 3]| (0..4).flat_map(|_| spin(s, 0.5)).collect::<Vec<_>>();
    // Flows that turn vortices differently.
    let mut all = [turn([0.3, 0.0, 0.1]), turn([0.0, 0.4, 0.0])];
    all.iter_mut().for_each(|w| w[4..8].iter_mut().for_each(|w| *w *= 0.5));
    let start = (0..4).flat_map(|i| spin(places[i], 0.5 * strengths[i])).collect();
    let gradient = Box::new(gradient);
    let noises = all[..noises].to_vec();
    (Case { name: "point vortices", n: 2, sites: 4, gradient, noises }, start)
}

fn judge(name: &str, system: Arc<dyn MatrixSystem>, w: &[c64]) -> Result<(), Box<dyn Error>> {
    let n = system.size();
    let mut y0 = vec![0.0; w.len()];
    coordinates(n, w, |i, y| y0[i] = y);
    let in_coordinates = InCoordinates::new(Arc::clone(&system));
    let zero = Arc::new(Constant::new(0.0)?);
    let problem = Problem::new(Arc::new(in_coordinates), zero, y0, 1.0)?;
    let heun = Setup::at_run_time(&problem, &Heun)?;
    let mut all = vec![("heun", heun)];
    for scheme in [Scheme::Explicit, Scheme::Midpoint] {
        let setup = setup(&problem, Arc::clone(&system), scheme);
        let id = setup.scheme.about().id;
        all.push((id, setup));
    }
    let key = StreamKey { seed: 1, experiment: 64 };
    for (id, setup) in all {
        let sizes = StepSizes::new(16, Truncation::none(), key).within(1_000_000);
        let order = strong_order(&setup, &sizes)?;
        let mut simulation = Simulation::new(setup, Truncation::none());
        simulation.components = (0..w.len()).map(|i| format!("y{}", i + 1)).collect();
        let path = simulation.paths(64, key, 0..1)?.remove(0);
        let mut end = vec![c64::default(); w.len()];
        let last = |i: usize| path.column(&format!("y{}", i + 1)).and_then(|y| y.last().copied());
        matrices(n, |i| last(i).unwrap_or(f64::NAN), &mut end);
        let both = traces(n, w, 4).into_iter().zip(traces(n, &end, 4));
        let size = inner(w, w);
        let lost = both.skip(1).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs() / size));
        println!("{name}, {} noises, {id}: {order}; tr W^k lost {lost:.0e}", system.noises());
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    for noises in [1, 2] {
        for (case, w) in [rigid_body(noises), manakov(noises), vortices(noises)] {
            judge(case.name, Arc::new(case), &w)?;
        }
        let degrees = [
            Stirring { degree: 2, order: 1, strength: 0.3 },
            Stirring { degree: 1, order: 0, strength: 0.3 },
        ];
        let fluid = Sphere::new(6, 0.0, 1.0, degrees[..noises].to_vec())?;
        let mut w = vec![c64::default(); 36];
        for (l, m, x) in [(1, 0, 0.8), (2, 1, 0.7), (3, -2, 0.9), (2, 0, 0.4)] {
            fluid.harmonics().add(&mut w, l, m, x);
        }
        judge("Zeitlin-Euler", Arc::new(fluid), &w)?;
    }
    Ok(())
}
