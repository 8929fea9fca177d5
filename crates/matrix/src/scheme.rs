//! Schemes that keep the spectrum.

use std::sync::Arc;

use faer::c64;
use noise::StepNoise;
use nonlin::{BlockStatus, Outcome};
use rayon::prelude::*;
use real::{PathMask, Row, WIDTH};
use schemes::{About, Method, Step, Stepper};

use crate::{
    MatrixSystem,
    dense::{Equations, columns, product},
    system::{bracket, coordinates, dimension, inner, matrices},
};

/// Schemes W⁺ = CWC* between two halves of exact damping, with a map C = D⁻¹D* of a Hermitian
/// matrix V. C is unitary for every V, so that the spectrum obeys e^{−∫γ} to round-off for every
/// step and every outcome of the noise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// `sexp-li` for matrices: V = τ∇H₀(M) + ΣLₘΔWₘ at M = W − ½i\[V₀, W\], where V₀ is V at W,
    /// and D = 1 + i(V/2 − V³/120) − V²/10 of Padé's approximation of e^{−iV}, whose phases are
    /// right to ‖V‖⁷/100800. (Those of Cayley's map, to ‖V‖³/12, limit steps of fluids, where ‖V‖
    /// grows with N.)
    /// Strong order ½, one for commuting noises, weak order one; order two without noise.
    Explicit,
    /// `midpoint`, the isospectral one (Modin and Viviani 2020; Ephrati, Jansson, Luesink and Modin
    /// 2024): Cayley's map, D = 1 + ½iV, of V at the M that solves M = ¼(1 + C)W(1 + C)*. Orders as
    /// above; symplectic on orbits. A path fails where the fixed-point iteration does not converge.
    Midpoint,
}

/// A scheme on a system of matrices, for every driver.
///
/// Paths are advanced one after the other; threads share those of a block of large matrices, and
/// the columns of matrices larger than 64. The bits are those of the processor, whatever the
/// threads: faer's kernels depend on the instruction set.
pub struct OnMatrices<'a> {
    /// The system.
    pub system: Arc<dyn MatrixSystem + 'a>,
    /// The scheme.
    pub scheme: Scheme,
}

/// Size of matrices from which on threads share the paths of a block.
const SHARED: usize = 32;
/// Most iterations, and the relative change at which they end.
const ITERATIONS: u32 = 100;
const CONVERGED: f64 = 4.0 * f64::EPSILON;
/// Relative change below which one that grows is round-off.
const ROUND_OFF: f64 = 1e-12;

impl Method for OnMatrices<'_> {
    fn about(&self) -> About {
        About::new(match self.scheme {
            Scheme::Explicit => "sexp-li",
            Scheme::Midpoint => "midpoint",
        })
    }

    fn start(&self, y: &[Row]) -> Box<dyn Stepper + '_> {
        let threads = rayon::current_num_threads().min(WIDTH);
        let workers = if self.system.size() < SHARED { 1 } else { threads };
        let worker = |first| Worker::new(&*self.system, self.scheme, first, workers);
        let workers = (0..workers).map(worker).collect();
        Box::new(Paths { rows: y.to_vec(), workers, live: PathMask::ALL })
    }
}

/// The paths of a block.
struct Paths<'a> {
    rows: Vec<Row>,
    workers: Vec<Worker<'a>>,
    /// Paths that go on; others stay.
    live: PathMask,
}

impl Stepper for Paths<'_> {
    fn state(&self) -> &[Row] {
        &self.rows
    }

    fn state_mut(&mut self) -> &mut [Row] {
        &mut self.rows
    }

    fn step(&mut self, step: &Step, noise: &StepNoise, status: &mut BlockStatus) {
        let Self { rows, workers, live } = self;
        let advance = |worker: &mut Worker<'_>| worker.advance(*live, rows, step, noise);
        match &mut workers[..] {
            [only] => advance(only),
            all => all.par_iter_mut().for_each(advance),
        }
        *status = BlockStatus::explicit();
        let n = workers[0].system.size();
        for Worker { outcomes, results, .. } in workers {
            let states = results.chunks_exact(rows.len());
            for (&(p, outcome), y) in outcomes.iter().zip(states) {
                status.set(p, outcome);
                columns(n, rows, |first, rows| {
                    rows.iter_mut().zip(&y[first * n..]).for_each(|(row, y)| row[p] = *y);
                });
            }
        }
    }

    /// Takes the paths that go on from here.
    fn rests(&mut self, live: PathMask) -> bool {
        self.live = live;
        false
    }
}

/// Memory for the steps of some paths of a block: every so many, from the first on.
struct Worker<'a> {
    system: &'a dyn MatrixSystem,
    scheme: Scheme,
    first: usize,
    every: usize,
    /// Results of a step, path by path.
    outcomes: Vec<(usize, Outcome)>,
    results: Vec<f64>,
    dw: Vec<f64>,
    /// W, M, V and the last M or −i\[V, W\] at all sites; C and a product at one.
    matrices: [Vec<c64>; 4],
    one: [Vec<c64>; 3],
    equations: Equations,
}

impl<'a> Worker<'a> {
    fn new(system: &'a dyn MatrixSystem, scheme: Scheme, first: usize, every: usize) -> Self {
        let (n, dimension) = (system.size(), dimension(system));
        let of = |length: usize| vec![c64::ZERO; length];
        Self {
            system,
            scheme,
            first,
            every,
            outcomes: Vec::with_capacity(WIDTH),
            results: vec![0.0; dimension * (first..WIDTH).step_by(every).len()],
            dw: vec![0.0; system.noises()],
            matrices: [(); 4].map(|()| of(dimension)),
            one: [(); 3].map(|()| of(n * n)),
            equations: Equations::new(n),
        }
    }

    fn advance(&mut self, live: PathMask, rows: &[Row], step: &Step, noise: &StepNoise) {
        self.outcomes.clear();
        let (n, dimension) = (self.system.size(), rows.len());
        for p in (self.first..WIDTH).step_by(self.every).filter(|p| live.contains(*p)) {
            self.dw.iter_mut().zip(&*noise.increments).for_each(|(dw, row)| *dw = row[p]);
            let place = self.outcomes.len() * dimension;
            let out = &mut self.results[place..place + dimension];
            columns(n, out, |first, out| {
                out.iter_mut().zip(&rows[first * n..]).for_each(|(y, row)| *y = row[p]);
            });
            matrices(n, |i| out[i] * step.first_decay, &mut self.matrices[0]);
            let outcome = self.step(step.tau);
            let out = &mut self.results[place..place + dimension];
            let last = &self.matrices[1];
            coordinates(n, last, |i, y| out[i] = y * step.second_decay);
            let finite = out.iter().all(|y| y.is_finite());
            let failed = Outcome::Failed { residual: f64::INFINITY };
            self.outcomes.push((p, if finite { outcome } else { failed }));
        }
    }

    /// Makes M from W: CWC* in the end.
    fn step(&mut self, tau: f64) -> Outcome {
        let n = self.system.size();
        let [w, m, v, other] = &mut self.matrices;
        let generator = |m: &[c64], v: &mut [c64]| self.system.generator(m, tau, &self.dw, v);
        generator(w, v);
        bracket(n, v, w, &mut self.one[0], m);
        columns(n, m, |first, m| {
            m.iter_mut().zip(&w[first * n..]).for_each(|(m, w)| *m = *w + *m * 0.5);
        });
        let mut outcome = Outcome::Fast { iterations: 1 };
        if self.scheme == Scheme::Midpoint {
            let (size, mut before) = (inner(w, w).sqrt(), f64::INFINITY);
            outcome = 'solved: {
                for iterations in 1..=ITERATIONS {
                    generator(m, v);
                    turn(n, (v, w), Map::Half, other, &mut self.one, &mut self.equations);
                    let pairs = m.iter().zip(&*other);
                    let change = pairs.map(|(a, b)| (a - b).norm_sqr()).sum::<f64>().sqrt();
                    std::mem::swap(m, other);
                    let round_off = change >= before && change <= ROUND_OFF * size;
                    if change <= CONVERGED * size || round_off {
                        break 'solved Outcome::Fast { iterations };
                    }
                    before = change;
                }
                Outcome::Failed { residual: before }
            };
        }
        generator(m, v);
        let map = if self.scheme == Scheme::Explicit { Map::Pade } else { Map::Cayley };
        turn(n, (v, w), map, m, &mut self.one, &mut self.equations);
        outcome
    }
}

/// Maps of V: Padé's and Cayley's, and ½(1 + C) of Cayley's.
#[derive(Clone, Copy, PartialEq)]
enum Map {
    Pade,
    Cayley,
    Half,
}

/// CWC* of each site with a map C of V.
fn turn(
    n: usize,
    (v, w): (&[c64], &[c64]),
    map: Map,
    out: &mut [c64],
    [d, c, memory]: &mut [Vec<c64>; 3],
    equations: &mut Equations,
) {
    let sites = v.chunks_exact(n * n).zip(w.chunks_exact(n * n));
    for ((v, w), out) in sites.zip(out.chunks_exact_mut(n * n)) {
        if map == Map::Pade {
            product(n, v, v, false, memory);
            product(n, v, memory, false, out);
        }
        let one = |k: usize| c64::new(f64::from(u8::from(k.is_multiple_of(n + 1))), 0.0);
        // Entries of D = A + iB with Hermitian A and B.
        let parts = |k: usize| {
            let (even, half) = match map {
                Map::Pade => (one(k) - memory[k] / 10.0, v[k] * 0.5 - out[k] / 120.0),
                _ => (one(k), v[k] * 0.5),
            };
            (even, c64::new(-half.im, half.re))
        };
        columns(n, d, |first, d| {
            for (d, (even, odd)) in d.iter_mut().zip((first * n..).map(parts)) {
                *d = even + odd;
            }
        });
        columns(n, c, |first, c| {
            for (k, c) in (first * n..).zip(c) {
                let (even, odd) = parts(k);
                *c = if map == Map::Half { one(k) } else { even - odd };
            }
        });
        equations.solve(d, c);
        product(n, c, w, false, memory);
        product(n, memory, c, true, out);
    }
}
