//! A system known at run time, evaluated at many states.

use std::ops::Range;

use real::{Row, WIDTH};
use systems::run_time::{Lanes, Op, System, Weights, derived};

use super::algebra::{Matrix, axis, transposed};

/// States or vectors, one for each point.
pub type Batch = Vec<Vec<f64>>;

/// The methods of a system on states instead of rows. The only place that calls them.
///
/// Arguments have one state for each point, or one for all. `weights` are (dt, dw₁, …, dw_M).
pub struct Probe<'a> {
    pub system: &'a dyn System,
    scratch: Vec<Row>,
}

impl<'a> Probe<'a> {
    pub fn new(system: &'a dyn System) -> Self {
        Self { system, scratch: vec![[0.0; WIDTH]; system.description().scratch_rows()] }
    }

    pub fn dimension(&self) -> usize {
        self.system.description().dimension
    }

    pub fn in_domain(&self, y: &[f64]) -> bool {
        self.system.check_domain(y).is_ok()
    }

    /// The weights with h = H₀ (0) or h = Hₘ.
    pub fn weights(&self, m: usize) -> Vec<f64> {
        axis(self.system.description().noises + 1, m)
    }

    /// States that are in the same rows.
    fn together(&self) -> usize {
        match self.system.description().layout.lanes {
            Lanes::Paths => WIDTH,
            Lanes::Components => 1,
        }
    }

    /// States in rows; places that are left over have the last one.
    fn rows(&self, states: &[Vec<f64>]) -> Vec<Row> {
        let mut rows = vec![[0.0; WIDTH]; self.system.description().layout.rows];
        for lane in 0..self.together() {
            for (component, &x) in states[lane.min(states.len() - 1)].iter().enumerate() {
                let (row, place) = self.system.description().layout.place(component);
                rows[row][place + lane] = x;
            }
        }
        rows
    }

    fn noise(&self, dw: &[f64]) -> Vec<Row> {
        match self.system.description().layout.local_noise {
            true => self.rows(&[dw.to_vec()]),
            false => dw.iter().map(|&dw| [dw; WIDTH]).collect(),
        }
    }

    /// Calls `f` with the rows of arguments, for as many states at a time as rows have.
    fn chunks(
        &mut self,
        arguments: &[&[Vec<f64>]],
        mut f: impl FnMut(&mut Self, &[Vec<Row>], Range<usize>),
    ) {
        let counts = || arguments.iter().map(|states| states.len());
        let points = if counts().any(|n| n == 0) { 0 } else { counts().max().unwrap_or(0) };
        for first in (0..points).step_by(self.together()) {
            let chunk = first..(first + self.together()).min(points);
            let of = |states: &&[Vec<f64>]| match states.len() {
                1 => self.rows(states),
                _ => self.rows(&states[chunk.clone()]),
            };
            let rows: Vec<_> = arguments.iter().map(of).collect();
            f(self, &rows, chunk);
        }
    }

    /// A vector at each point, computed tile by tile.
    fn vectors(
        &mut self,
        arguments: &[&[Vec<f64>]],
        compute: impl Fn(&dyn System, Range<usize>, &[Vec<Row>], &mut [Row], &mut [Row]),
    ) -> Batch {
        let mut all = Batch::new();
        self.chunks(arguments, |this, rows, chunk| {
            let system = this.system;
            let layout = system.description().layout;
            let (count, tile_rows) = (layout.rows, layout.tile_rows);
            let mut out = vec![[0.0; WIDTH]; count];
            for first in (0..count).step_by(tile_rows.max(1)) {
                let tile = first..(first + tile_rows).min(count);
                compute(system, tile.clone(), rows, &mut out[tile], &mut this.scratch);
            }
            for lane in 0..chunk.len() {
                let at = |component| {
                    let (row, place) = layout.place(component);
                    out[row][place + lane]
                };
                all.push((0..system.description().dimension).map(at).collect());
            }
        });
        all
    }

    /// A number at each point.
    fn numbers(
        &mut self,
        y: &[Vec<f64>],
        compute: impl Fn(&dyn System, &[Row], &mut Row, &mut [Row]),
    ) -> Vec<f64> {
        let mut all = Vec::new();
        self.chunks(&[y], |this, rows, chunk| {
            let mut out = [0.0; WIDTH];
            compute(this.system, &rows[0], &mut out, &mut this.scratch);
            match this.system.description().layout.lanes {
                Lanes::Paths => all.extend(&out[..chunk.len()]),
                Lanes::Components => all.push(out.iter().sum()),
            }
        });
        all
    }

    /// B(y)v.
    pub fn structure(&mut self, y: &[Vec<f64>], v: &[Vec<f64>]) -> Batch {
        self.vectors(&[y, v], |system, tile, rows, out, scratch| {
            let [y, v] = [0, 1].map(|n| &rows[n][tile.clone()]);
            system.apply(Op::Structure { y, v }, tile, Weights::NONE, out, scratch);
        })
    }

    /// (∂B(y)·u)v.
    pub fn structure_along(&mut self, y: &[Vec<f64>], u: &[Vec<f64>], v: &[Vec<f64>]) -> Batch {
        self.vectors(&[y, u, v], |system, tile, rows, out, scratch| {
            let [y, u, v] = [0, 1, 2].map(|n| &rows[n][tile.clone()]);
            system.apply(Op::StructureAlong { y, u, v }, tile, Weights::NONE, out, scratch);
        })
    }

    /// ∇h(y).
    pub fn gradient(&mut self, y: &[Vec<f64>], weights: &[f64]) -> Batch {
        let h = Weights { dt: weights[0], dw: &self.noise(&weights[1..]), areas: &[] };
        self.vectors(&[y], |system, tile, rows, out, scratch| {
            system.apply(Op::Gradient { y: &rows[0] }, tile, h, out, scratch);
        })
    }

    /// ∇²h(y)u.
    pub fn hessian(&mut self, y: &[Vec<f64>], u: &[Vec<f64>], weights: &[f64]) -> Batch {
        let h = Weights { dt: weights[0], dw: &self.noise(&weights[1..]), areas: &[] };
        self.vectors(&[y, u], |system, tile, rows, out, scratch| {
            system.apply(Op::Hessian { y: &rows[0], u: &rows[1] }, tile, h, out, scratch);
        })
    }

    /// ∇̄h(a, b), B((a+b)/2)∇̄h(a, b), and ∇̄h by the quadrature of the system, of systems with one
    /// tile.
    pub fn averages(&mut self, a: &[Vec<f64>], b: &[Vec<f64>], weights: &[f64]) -> [Batch; 3] {
        let h = Weights { dt: weights[0], dw: &self.noise(&weights[1..]), areas: &[] };
        let gradient = self.vectors(&[a, b], |system, tile, rows, out, scratch| {
            let op = Op::AveragedGradient { a: &rows[0][..], b: &rows[1][..] };
            system.apply(op, tile, h, out, scratch);
        });
        let field = self.vectors(&[a, b], |system, tile, rows, out, scratch| {
            let op = Op::AveragedField { a: &rows[0][..], b: &rows[1][..] };
            system.apply(op, tile, h, out, scratch);
        });
        let quadrature = self.vectors(&[a, b], |system, _, rows, out, scratch| {
            let op = Op::AveragedGradient { a: &rows[0][..], b: &rows[1][..] };
            derived(system, op, h, out, scratch);
        });
        [gradient, field, quadrature]
    }

    /// h(y).
    pub fn energy(&mut self, y: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
        let h = Weights { dt: weights[0], dw: &self.noise(&weights[1..]), areas: &[] };
        self.numbers(y, |system, y, out, scratch| system.energy(y, h, out, scratch))
    }

    /// An invariant that the system claims.
    pub fn invariant(&mut self, index: usize, y: &[Vec<f64>]) -> Vec<f64> {
        self.numbers(y, |system, y, out, scratch| system.invariant(index, y, out, scratch))
    }

    /// B at each point, by rows.
    pub fn matrix(&mut self, y: &[Vec<f64>]) -> Vec<Matrix> {
        let d = self.dimension();
        by_points((0..d).map(|j| self.structure(y, &[axis(d, j)])).collect())
    }

    /// The system at each point.
    pub fn locals(&mut self, y: &[Vec<f64>]) -> Vec<Local> {
        let d = self.dimension();
        let mut slopes: Vec<_> = (0..d)
            .map(|k| {
                let column = |j| self.structure_along(y, &[axis(d, k)], &[axis(d, j)]);
                by_points((0..d).map(column).collect()).into_iter()
            })
            .collect();
        let hamiltonians = 0..=self.system.description().noises;
        let mut gradients: Vec<_> =
            hamiltonians.clone().map(|m| self.gradient(y, &self.weights(m)).into_iter()).collect();
        let mut hessians: Vec<_> = hamiltonians
            .map(|m| {
                let weights = self.weights(m);
                let column = |j| self.hessian(y, &[axis(d, j)], &weights);
                by_points((0..d).map(column).collect()).into_iter()
            })
            .collect();
        let local = |b: Matrix| Local {
            b,
            slopes: slopes.iter_mut().filter_map(Iterator::next).collect(),
            gradients: gradients.iter_mut().filter_map(Iterator::next).collect(),
            hessians: hessians.iter_mut().filter_map(Iterator::next).collect(),
        };
        self.matrix(y).into_iter().map(local).collect()
    }
}

/// The matrix at each point from its columns at all points.
fn by_points(columns: Vec<Batch>) -> Vec<Matrix> {
    let points = columns.first().map_or(0, Vec::len);
    let at = |n: usize| transposed(&columns.iter().map(|column| column[n].clone()).collect());
    (0..points).map(at).collect()
}

/// A system at a point.
pub struct Local {
    /// B(y).
    pub b: Matrix,
    /// The matrices ∂B/∂y_k.
    pub slopes: Vec<Matrix>,
    /// ∇H₀, …, ∇H_M.
    pub gradients: Batch,
    /// ∇²H₀, …, ∇²H_M.
    pub hessians: Vec<Matrix>,
}
