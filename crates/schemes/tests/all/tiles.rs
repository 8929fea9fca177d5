//! One large path at run time: its bits depend neither on tiles nor on threads.

use std::ops::Range;

use dgrad::Rule;
use nonlin::{BlockStatus, Method, Solver};
use real::{Row, Rows, WIDTH};
use schemes::{
    EulerMaruyama, Heun, Implicit, Increment, Midpoint, Sexp, SexpLi, Step, WithSolver,
    run_time::Scheme,
};
use systems::{
    Constant, Linearity,
    run_time::{Description, Layout, Op, System, Weights, derived},
};

use crate::own_schemes::Wide;

const SIGMA: f64 = 0.8;

/// A chain of spins with B(y)v = (sᵢ × vᵢ), H₀ = −Σ sᵢ·sᵢ₊₁ and Hₘ = −σ Σ sᵢᵐ. Rows 3b to 3b + 2
/// hold the components of 32 spins.
struct Chain {
    spins: usize,
    description: Description,
}

impl Chain {
    fn new(spins: usize, tile: usize) -> Self {
        Self::with_nodes(1, spins, tile)
    }

    /// With another number of nodes for ∇̄h.
    fn with_nodes(nodes: usize, spins: usize, tile_rows: usize) -> Self {
        let rule = Rule::new(nodes).unwrap();
        let mut description = Description {
            linearity: Linearity::Affine,
            always_solvable: true,
            ..Description::new("chain", 3 * spins, 3, rule)
        };
        description.layout = Layout { reach: 1, ..Layout::one_path(3 * spins, 3, 3, tile_rows) };
        Self { spins, description }
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

fn cayley(y: &[Row], v: &[Row], out: &mut [Row]) {
    for triple in (0..y.len()).step_by(3) {
        for p in 0..WIDTH {
            let at = |x: &[Row]| [0, 1, 2].map(|c| x[triple + c][p]);
            let (y, s) = (at(y), at(v).map(|v| 0.5 * v));
            let cross = |a: [f64; 3], b: [f64; 3]| {
                [0, 1, 2].map(|c| a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3])
            };
            let once = cross(y, s);
            let twice = cross(once, s);
            let factor = 2.0 / (1.0 + s.iter().map(|s| s * s).sum::<f64>());
            (0..3).for_each(|c| out[triple + c][p] = y[c] + factor * (once[c] + twice[c]));
        }
    }
}

impl System for Chain {
    fn description(&self) -> &Description {
        &self.description
    }

    fn apply(
        &self,
        op: Op<&[Row]>,
        tile: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        match op {
            Op::Structure { y: s, v } | Op::StructureAlong { u: s, v, .. } => cross(s, v, out),
            Op::Cayley { y, v } => cayley(y, v, out),
            Op::Gradient { y } => self.each(tile, out, |row, lane| {
                -h.dt * self.neighbours(y, row, lane) - SIGMA * h.dw[row % 3][0]
            }),
            Op::Hessian { u, .. } => {
                self.each(tile, out, |row, lane| -h.dt * self.neighbours(u, row, lane));
            }
            // ½σ² Σ (s × eₘ) × eₘ = −σ²s.
            Op::ItoCorrection { y } => {
                self.each(tile, out, |row, lane| -SIGMA * SIGMA * y[row][lane]);
            }
            _ => derived(self, op, h, out, scratch),
        }
    }

    fn energy(&self, _: &[Row], _: Weights<'_>, _: &mut Row, _: &mut [Row]) {
        unreachable!("no scheme asks for it")
    }
}

/// Unit vectors in many directions.
fn start(system: &Chain) -> Rows {
    let mut rows = Rows::zero(system.description.layout.rows);
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
            let dw = Rows::splat(&[0.1 * angle.sin(), 0.1 * angle.cos(), 0.05]);
            path.step(&step, &dw.into(), &mut status);
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
    let schemes: [(&dyn Scheme, usize); 7] = [
        (&EulerMaruyama, 0),
        (&Heun, 0),
        (&Wide, 0),
        (&sexp_li, 0),
        (&Midpoint, 0),
        (&Sexp, 0),
        (&krylov, 8),
    ];
    for (scheme, robust) in schemes {
        let expected = run(scheme, &one_tile, 1, 0.05);
        assert_eq!(expected.1, robust, "{}", scheme.about().id);
        // The last tile is shorter.
        for (tile, threads) in [(3, 1), (3, 2), (12, 3), (33, 2)] {
            let found = run(scheme, &Chain::new(SPINS, tile), threads, 0.05);
            assert!(found == expected, "{} with tiles of {tile} rows", scheme.about().id);
        }
    }
}

/// z = ẑ + (cayley or ½Σ fₘ′fₘ of the midpoint) − z̄.
struct WithoutDerivative<const CAYLEY: bool>;

impl<const CAYLEY: bool> Implicit for WithoutDerivative<CAYLEY> {
    const ID: &'static str = "without-derivative";
    const EXACT_DAMPING: bool = true;

    #[inline(always)]
    fn psi<H: Increment>(&self, h: H, start: H::Vector, z: H::Vector) -> H::Vector {
        let middle = (start + z) * 0.5;
        match CAYLEY {
            true => start + h.cayley(middle, h.gradient(start)) - middle,
            false => start + h.field(middle) + h.ito_correction(middle) * h.step().tau,
        }
    }
}

/// Newton's method has no derivative of these: known before the first step and not after hours.
/// An unsolved step loses lengths. The first spins are at rest, so that the end alone shows it.
#[test]
fn the_end_of_a_large_path_is_solved_as_well() {
    const SPINS: usize = 20_000;
    let system = Chain::new(SPINS, 96);
    let mut path = Scheme::stepper(&Sexp, &system).unwrap();
    let mut y = start(&system);
    for triple in 0..17_000 / WIDTH {
        y[3 * triple..3 * triple + 2].fill([0.0; WIDTH]);
        y[3 * triple + 2].fill(1.0);
    }
    path.state_mut().copy_from_slice(&y);
    let step = Step::new(&Constant::new(0.0).unwrap(), 0, 0.1).unwrap();
    let noise = Rows::splat(&[0.0, 0.0, 0.05]);
    path.step(&step, &noise.into(), &mut BlockStatus::explicit());
    let square = |site: usize| -> f64 {
        (0..3).map(|c| path.state()[site / WIDTH * 3 + c][site % WIDTH].powi(2)).sum()
    };
    // The residual of 2ε of all |sᵢ|₁ ≤ √3 may fall on one spin.
    let allowed = 2.0 * 2.0 * f64::EPSILON * 3f64.sqrt() * SPINS as f64;
    let worst = (0..SPINS).map(|site| (square(site) - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < allowed, "{worst:e}");
}

#[test]
fn formulas_whose_derivative_is_not_known_are_refused() {
    for system in [Chain::new(64, 3), Chain::new(64, 6)] {
        let refused = |scheme: &dyn Scheme| scheme.stepper(&system).err();
        for refused in [refused(&WithoutDerivative::<true>), refused(&WithoutDerivative::<false>)] {
            assert!(refused.unwrap().to_string().contains("derivatives"));
        }
        // Of ẑ they are constants.
        assert!(SexpLi::at_run_time(&system).unwrap().stepper(&system).is_ok());
    }
}

/// ∇̄h is ∇h at the midpoint for quadratic h only.
#[test]
fn averages_in_tiles_need_a_quadratic_energy() {
    let quartic = |tile| Chain::with_nodes(2, 64, tile);
    let (tiles, whole) = (quartic(3), quartic(6));
    let refused = Sexp.stepper(&tiles).err().unwrap();
    assert!(refused.to_string().contains("∇̄h of `chain`"), "{refused}");
    assert!(Sexp.stepper(&whole).is_ok() && Midpoint.stepper(&tiles).is_ok());
}
