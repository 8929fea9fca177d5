//! Pilot paths: where the paths of a problem go.

use serde::Serialize;
use systems::Damping;

use super::{
    algebra::{axis, dot, largest, matrix_values, solve, values},
    erased::System,
    points::{Purpose, Random},
};

/// Pilot paths of a problem, at whose states identities are checked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Pilot {
    /// The number of paths.
    pub paths: usize,
    /// The number of states.
    pub states: usize,
    /// The time that all paths reached: less than T if a step had no solution or left the domain.
    pub until: f64,
}

const PATHS: usize = 4;
/// Steps of a path.
const STEPS: u32 = 128;
/// Every so many steps a state is kept.
const EVERY: u32 = 16;
/// Newton's method: limit of its iterations, and the relative change that ends it.
const ITERATIONS: usize = 30;
const TOLERANCE: f64 = 1e-9;
/// Increments are clipped at this many standard deviations.
const CLIPPED: f64 = 3.0;

/// Simulates with the implicit midpoint rule and half steps of exact damping: stable where the
/// flow is, and convergent to the Stratonovich solution.
pub fn pilot_paths(
    system: &dyn System,
    damping: &dyn Damping,
    y0: &[f64],
    t_end: f64,
) -> (Pilot, Vec<Vec<f64>>) {
    let mut random = Random::new(Purpose::Paths);
    let (mut states, mut until) = (Vec::new(), t_end);
    let time = |n: u32| t_end * f64::from(n) / f64::from(STEPS);
    let root = time(1).sqrt();
    for _ in 0..PATHS {
        let mut y = y0.to_vec();
        for n in 0..STEPS {
            let mut weights = vec![time(1)];
            let increment = |_| root * random.normals.normal().clamp(-CLIPPED, CLIPPED);
            weights.extend((0..system.noises()).map(increment));
            let factor = |a, b| (-damping.integral(a, b)).exp();
            let middle = 0.5 * (time(n) + time(n + 1));
            let (before, after) = (factor(time(n), middle), factor(middle, time(n + 1)));
            let start: Vec<f64> = y.iter().map(|x| before * x).collect();
            let end = midpoint_step(system, &start, &weights)
                .map(|end| end.iter().map(|x| after * x).collect::<Vec<_>>())
                .filter(|end| end.iter().all(|x| x.is_finite()) && system.in_domain(end));
            let Some(end) = end else {
                until = until.min(time(n));
                break;
            };
            y = end;
            if (n + 1) % EVERY == 0 {
                states.push(y.clone());
            }
        }
    }
    (Pilot { paths: PATHS, states: states.len(), until }, states)
}

/// z of z = a + (B∇h)((a + z)/2), by Newton's method.
fn midpoint_step(system: &dyn System, a: &[f64], weights: &[f64]) -> Option<Vec<f64>> {
    let mut z = a.to_vec();
    for _ in 0..ITERATIONS {
        let middle: Vec<f64> = a.iter().zip(&z).map(|(a, z)| 0.5 * (a + z)).collect();
        if !system.in_domain(&middle) {
            return None;
        }
        let (field, slope) = system.field(&middle, weights);
        let (field, slope) = (values(&field), matrix_values(&slope));
        let residual: Vec<f64> = (0..a.len()).map(|i| z[i] - a[i] - field[i]).collect();
        let newton = (0..a.len()).map(|i| {
            axis(a.len(), i).iter().zip(&slope[i]).map(|(one, s)| one - 0.5 * s).collect()
        });
        let change = solve(&newton.collect(), &residual);
        if !dot(&change, &change).is_finite() {
            return None;
        }
        z.iter_mut().zip(&change).for_each(|(z, change)| *z -= change);
        if largest(&change) <= TOLERANCE * largest(&z) {
            return Some(z);
        }
    }
    None
}
