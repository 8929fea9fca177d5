//! One large path at run time: its bits depend neither on tiles nor on threads.

use std::ops::Range;

use dgrad::Rule;
use nonlin::{BlockStatus, Method, Solver};
use real::{Row, Rows, WIDTH};
use schemes::{EulerMaruyama, Heun, Midpoint, Sexp, SexpLi, Step, WithSolver, run_time::Scheme};
use systems::{
    Constant, Linearity,
    run_time::{Lanes, System, Weights},
};

const SIGMA: f64 = 0.8;

/// A chain of spins with B(y)v = (sᵢ × vᵢ), H₀ = −Σ sᵢ·sᵢ₊₁ and Hₘ = −σ Σ sᵢᵐ. Rows 3b to 3b + 2
/// hold the components of 32 spins.
struct Chain {
    spins: usize,
    tile: usize,
    rule: Rule,
}

impl Chain {
    fn new(spins: usize, tile: usize) -> Self {
        Self { spins, tile, rule: Rule::new(1).unwrap() }
    }

    fn neighbours(&self, y: &[Row], row: usize, lane: usize) -> f64 {
        let site = row / 3 * WIDTH + lane;
        let at = |site: usize| y[site / WIDTH * 3 + row % 3][site % WIDTH];
        let left = if site > 0 { at(site - 1) } else { 0.0 };
        let right = if site + 1 < self.spins { at(site + 1) } else { 0.0 };
        left + right
    }

    /// Calls `value` for every number of a tile that is a component.
    fn each(&self, tile: Range<usize>, out: &mut [Row], value: impl Fn(usize, usize) -> f64) {
        for (row, out) in tile.zip(out) {
            for lane in 0..WIDTH {
                let inside = row / 3 * WIDTH + lane < self.spins;
                out[lane] = if inside { value(row, lane) } else { 0.0 };
            }
        }
    }
}

fn cross(y: &[Row], v: &[Row], out: &mut [Row]) {
    for triple in (0..y.len()).step_by(3) {
        for c in 0..3 {
            let (a, b) = (triple + (c + 1) % 3, triple + (c + 2) % 3);
            for p in 0..WIDTH {
                out[triple + c][p] = y[a][p] * v[b][p] - y[b][p] * v[a][p];
            }
        }
    }
}

impl System for Chain {
    fn name(&self) -> &str {
        "chain"
    }
    fn dimension(&self) -> usize {
        3 * self.spins
    }
    fn noises(&self) -> usize {
        3
    }
    fn lanes(&self) -> Lanes {
        Lanes::Components
    }
    fn rows(&self) -> usize {
        3 * self.spins.div_ceil(WIDTH)
    }
    fn tile_rows(&self) -> usize {
        self.tile
    }
    fn reach(&self) -> usize {
        1
    }
    fn structure(&self, _: Range<usize>, y: &[Row], v: &[Row], out: &mut [Row], _: &mut [Row]) {
        cross(y, v, out);
    }
    fn structure_along(
        &self,
        _: Range<usize>,
        _: &[Row],
        u: &[Row],
        v: &[Row],
        out: &mut [Row],
        _: &mut [Row],
    ) {
        cross(u, v, out);
    }
    fn energy(&self, _: &[Row], _: Weights<'_>, _: &mut Row, _: &mut [Row]) {
        unreachable!("no scheme asks for it")
    }
    fn gradient(
        &self,
        tile: Range<usize>,
        y: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        _: &mut [Row],
    ) {
        self.each(tile, out, |row, lane| {
            -h.dt * self.neighbours(y, row, lane) - SIGMA * h.dw[row % 3][0]
        });
    }
    fn hessian(
        &self,
        tile: Range<usize>,
        _: &[Row],
        u: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        _: &mut [Row],
    ) {
        self.each(tile, out, |row, lane| -h.dt * self.neighbours(u, row, lane));
    }
    fn rule(&self) -> &Rule {
        &self.rule
    }
    fn linearity(&self) -> Linearity {
        Linearity::Affine
    }
    fn always_solvable(&self) -> bool {
        true
    }
    fn cayley(&self, _: Range<usize>, y: &[Row], v: &[Row], out: &mut [Row], _: &mut [Row]) {
        for triple in (0..y.len()).step_by(3) {
            for p in 0..WIDTH {
                let at = |x: &[Row]| [0, 1, 2].map(|c| x[triple + c][p]);
                let (y, s) = (at(y), at(v).map(|v| 0.5 * v));
                let cross = |a: [f64; 3], b: [f64; 3]| {
                    [0, 1, 2]
                        .map(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
                };
                let once = cross(y, s);
                let twice = cross(once, s);
                let factor = 2.0 / (1.0 + s.iter().map(|s| s * s).sum::<f64>());
                (0..3).for_each(|c| out[triple + c][p] = y[c] + factor * (once[c] + twice[c]));
            }
        }
    }
    /// ½σ² Σ (s × eₘ) × eₘ = −σ²s.
    fn ito_correction(&self, tile: Range<usize>, y: &[Row], out: &mut [Row], _: &mut [Row]) {
        self.each(tile, out, |row, lane| -SIGMA * SIGMA * y[row][lane]);
    }
}

/// Unit vectors in many directions.
fn start(system: &Chain) -> Rows {
    let mut rows = Rows::zero(system.rows()).unwrap();
    for site in 0..system.spins {
        let (angle, height) = (site as f64 * 2.4, (site as f64 * 0.618).fract() * 2.0 - 1.0);
        let radius = (1.0 - height * height).sqrt();
        let spin = [radius * angle.cos(), radius * angle.sin(), height];
        (0..3).for_each(|c| rows[site / WIDTH * 3 + c][site % WIDTH] = spin[c]);
    }
    rows
}

/// The state after some steps, and on how many of them Newton's method was needed.
fn run(scheme: &dyn Scheme, system: &Chain, threads: usize, tau: f64) -> (Vec<Row>, usize) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| {
        let mut path = scheme.stepper(system).unwrap();
        path.state_mut().copy_from_slice(&start(system));
        let (mut status, mut robust) = (BlockStatus::explicit(), 0);
        for n in 0..8 {
            let step = Step::new(&Constant::new(0.1).unwrap(), n, tau).unwrap();
            let angle = n as f64;
            let dw = Rows::splat(&[0.1 * angle.sin(), 0.1 * angle.cos(), 0.05]).unwrap();
            path.step(&step, &dw, &mut status);
            assert!(status.failed.is_empty());
            robust += usize::from(status.robust.contains(0));
        }
        (path.state().to_vec(), robust)
    })
}

#[test]
fn bits_depend_neither_on_tiles_nor_on_threads() {
    const SPINS: usize = 2000;
    let one_tile = Chain::new(SPINS, 3 * SPINS.div_ceil(WIDTH));
    let sexp_li = SexpLi::at_run_time(&one_tile).unwrap();
    let forced = Solver { max_sweeps: 1, ..Solver::new(Method::FixedPoint) };
    let krylov = WithSolver { formula: Sexp, solver: forced };
    let schemes: [(&dyn Scheme, usize); 6] =
        [(&EulerMaruyama, 0), (&Heun, 0), (&sexp_li, 0), (&Midpoint, 0), (&Sexp, 0), (&krylov, 8)];
    for (scheme, robust) in schemes {
        let expected = run(scheme, &one_tile, 1, 0.05);
        assert_eq!(expected.1, robust, "{}", scheme.id());
        // The last tile is shorter.
        for (tile, threads) in [(3, 1), (3, 2), (12, 3), (33, 2)] {
            let found = run(scheme, &Chain::new(SPINS, tile), threads, 0.05);
            assert!(found == expected, "{} with tiles of {tile} rows", scheme.id());
        }
    }
}

/// Every length stays on its law, with Newton's method too, and where its equation is hard.
#[test]
fn lengths_of_spins_are_on_their_law() {
    let system = Chain::new(100, 6);
    let sexp_li = SexpLi::at_run_time(&system).unwrap();
    let steps = 8.0;
    for (scheme, tau) in
        [(&sexp_li as &dyn Scheme, 0.05), (&sexp_li, 0.9), (&Sexp, 0.05), (&Sexp, 0.7)]
    {
        let (state, _) = run(scheme, &system, 2, tau);
        let law = (-2.0 * 0.1 * tau * steps).exp();
        for site in 0..system.spins {
            let square: f64 =
                (0..3).map(|c| state[site / WIDTH * 3 + c][site % WIDTH].powi(2)).sum();
            // Residuals of 2ε of all spins together may fall on one.
            let allowed = 100.0 * 2.0 * steps * f64::EPSILON;
            assert!((square / law - 1.0).abs() < allowed, "{} {site}: {square}", scheme.id());
        }
    }
}
