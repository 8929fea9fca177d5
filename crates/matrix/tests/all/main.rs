//! Matrices against closed forms: harmonics, waves, decay by noise, stationary means, orders.

mod fluids;
mod keeping;
mod parts;
mod statistical;

use std::sync::Arc;

use matrix::{InCoordinates, MatrixSystem, Scheme, c64, coordinates, matrices};
use mc::Setup;
use noise::StepNoise;
use nonlin::BlockStatus;
use real::{PathMask, Row};
use schemes::Step;
use systems::{Constant, run_time::Problem};

/// The state of a matrix.
fn state(n: usize, w: &[c64]) -> Vec<f64> {
    let mut y = vec![0.0; w.len()];
    coordinates(n, w, |i, value| y[i] = value);
    y
}

fn matrix(n: usize, rows: &[Row], p: usize) -> Vec<c64> {
    let mut w = vec![c64::default(); rows.len()];
    matrices(n, |i| rows[i][p], &mut w);
    w
}

/// A problem of a system from a matrix on, with a damping rate.
fn problem<S: MatrixSystem + 'static>(
    system: &Arc<S>,
    w: &[c64],
    rate: f64,
    t_end: f64,
) -> Problem {
    let y0 = state(system.size(), w);
    let damping = Arc::new(Constant::new(rate).unwrap());
    Problem::new(Arc::new(InCoordinates::new(Arc::clone(system))), damping, y0, t_end).unwrap()
}

fn setup<'a, S: MatrixSystem + 'static>(
    problem: &'a Problem,
    system: &Arc<S>,
    scheme: Scheme,
) -> Setup<'a> {
    matrix::setup(problem, Arc::clone(system) as _, scheme)
}

/// Hermitian matrices with entries of size one that look random.
fn generic(n: usize, seed: u64) -> Vec<c64> {
    let y: Vec<f64> = (0..n * n).map(|i| numbers(seed + i as u64)).collect();
    let mut w = vec![c64::default(); n * n];
    matrices(n, |i| y[i], &mut w);
    w
}

/// A number in [−1, 1).
fn numbers(k: u64) -> f64 {
    let z = noise::mix((k + 1).wrapping_mul(noise::GOLDEN));
    (z >> 11) as f64 * f64::EPSILON - 1.0
}

/// State of the first `live` paths after steps of size tau with increments from `numbers`.
fn after(setup: &Setup<'_>, steps: u64, tau: f64, live: usize) -> Vec<Row> {
    let (problem, noises) = (&setup.problem, setup.problem.noises);
    let mut paths = setup.scheme.start(&setup.start());
    paths.rests(PathMask::first(live));
    let (mut noise, mut status) = (StepNoise::zero(noises), BlockStatus::explicit());
    for n in 0..steps {
        for (m, row) in noise.increments.iter_mut().enumerate() {
            for (p, dw) in row.iter_mut().enumerate() {
                let key = (n * noises as u64 + m as u64) * 32 + p as u64;
                *dw = numbers(key) * (3.0 * tau).sqrt();
            }
        }
        paths.step(&Step::new(problem.damping, n, tau).unwrap(), &noise, &mut status);
        assert!(status.failed.is_empty(), "step {n}");
    }
    paths.state().to_vec()
}
