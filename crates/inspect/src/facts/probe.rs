//! A system known at run time, evaluated at many states; and derivatives by differences.

use real::{Row, WIDTH};
use systems::run_time::{Description, Lanes, Op, System, Weights, derived};

use super::{Matrix, Term, axis, dot, largest, moved, transposed};

/// Time at which time-dependent Hamiltonians are evaluated.
pub const TIME: f64 = 0.618;

/// Times at which fields that depend on time are looked at.
const TIMES: [f64; 3] = [TIME, 0.0, 2.236];

/// Halvings of distances and segments until they are in the domain.
pub const HALVINGS: i32 = 40;

/// States or vectors, one for each point.
pub type Batch = Vec<Vec<f64>>;

/// The methods of a system on states instead of rows. The only place that calls them.
///
/// Arguments have one state for each point, or one for all. `weights` are (dt, dw₁, …, dw_M).
pub struct Probe<'a> {
    system: &'a dyn System,
    /// The description of the system.
    pub description: &'a Description,
    /// The time of Hamiltonians that depend on it.
    t: f64,
    /// Row and place of each component.
    places: Vec<(usize, usize)>,
    scratch: Vec<Row>,
}

impl<'a> Probe<'a> {
    pub fn new(system: &'a dyn System) -> Self {
        let description = system.description();
        let places = (0..description.dimension).map(|i| description.layout.place(i)).collect();
        let scratch = vec![[0.0; WIDTH]; description.scratch_rows()];
        Self { system, description, t: TIME, places, scratch }
    }

    pub fn dimension(&self) -> usize {
        self.description.dimension
    }

    pub fn noises(&self) -> usize {
        self.description.noises
    }

    /// Whether a state is one tile.
    pub fn is_one_tile(&self) -> bool {
        let layout = self.description.layout;
        layout.tile_rows >= layout.rows
    }

    pub fn in_domain(&self, y: &[f64]) -> bool {
        self.system.check_domain(y).is_ok()
    }

    /// The first of y + length·direction/2ᵏ in the domain, for k below [`HALVINGS`].
    pub fn halved_into_domain(
        &self,
        y: &[f64],
        length: f64,
        direction: &[f64],
    ) -> Option<Vec<f64>> {
        let at = |halvings: i32| moved(y, length * f64::powi(0.5, halvings), direction);
        (0..HALVINGS).map(at).find(|y| self.in_domain(y))
    }

    /// Weights for which h = Hₘ; h = H₀ for `m` = 0.
    pub fn weights(&self, m: usize) -> Vec<f64> {
        axis(self.noises() + 1, m)
    }

    /// Number of states that share rows.
    fn together(&self) -> usize {
        match self.description.layout.lanes {
            Lanes::Paths => WIDTH,
            Lanes::Components => 1,
        }
    }

    /// Packs the states from number `first` on into rows; the last state fills lanes that are left.
    fn rows(&self, states: &[Vec<f64>], first: usize) -> Vec<Row> {
        let mut rows = vec![[0.0; WIDTH]; self.description.layout.rows];
        for lane in 0..self.together() {
            let state = &states[(first + lane).min(states.len() - 1)];
            for (&(row, place), &x) in self.places.iter().zip(state) {
                rows[row][place + lane] = x;
            }
        }
        rows
    }

    fn noise(&self, dw: &[f64]) -> Vec<Row> {
        match self.description.layout.local_noise {
            true => self.rows(&[dw.to_vec()], 0),
            false => dw.iter().map(|&dw| [dw; WIDTH]).collect(),
        }
    }

    /// Calls `f` with the rows of the arguments and the number of their states, one group of states
    /// that share rows at a time.
    fn chunks(
        &mut self,
        arguments: &[&[Vec<f64>]],
        mut f: impl FnMut(&mut Self, &[Vec<Row>], usize),
    ) {
        let points = arguments.iter().map(|states| states.len()).max().unwrap_or(0);
        for first in (0..points).step_by(self.together()) {
            let rows: Vec<_> = arguments.iter().map(|states| self.rows(states, first)).collect();
            f(self, &rows, self.together().min(points - first));
        }
    }

    /// Evaluates an operation at each point, tile by tile, or by the quadrature of the system.
    fn evaluate(&mut self, op: Op<&[Vec<f64>]>, weights: &[f64], by_quadrature: bool) -> Batch {
        let (dt, dw) =
            weights.split_first().map_or((0.0, Vec::new()), |(dt, dw)| (*dt, self.noise(dw)));
        let h = Weights { t: self.t, dt, dw: &dw, areas: &[] };
        let (mut all, layout) = (Batch::new(), self.description.layout);
        let mut out = vec![[0.0; WIDTH]; layout.rows];
        self.chunks(&op.arguments().collect::<Vec<_>>(), |this, rows, count| {
            for first in (0..layout.rows).step_by(layout.tile_rows.max(1)) {
                let tile = first..(first + layout.tile_rows).min(layout.rows);
                let read = if op.is_local() { tile.clone() } else { 0..layout.rows };
                let mut rows = rows.iter().map(|rows| &rows[read.clone()]);
                let op = op.map(|_| rows.next().unwrap_or_default());
                let (out, scratch) = (&mut out[tile.clone()], &mut this.scratch);
                match by_quadrature {
                    true => derived(this.system, op, h, out, scratch),
                    false => this.system.apply(op, tile, h, out, scratch),
                }
            }
            for lane in 0..count {
                all.push(this.places.iter().map(|(row, place)| out[*row][place + lane]).collect());
            }
        });
        all
    }

    /// Computes one number at each point.
    fn numbers(
        &mut self,
        y: &[Vec<f64>],
        compute: impl Fn(&dyn System, &[Row], &mut Row, &mut [Row]),
    ) -> Vec<f64> {
        let mut all = Vec::new();
        self.chunks(&[y], |this, rows, count| {
            let mut out = [0.0; WIDTH];
            compute(this.system, &rows[0], &mut out, &mut this.scratch);
            match this.description.layout.lanes {
                Lanes::Paths => all.extend(&out[..count]),
                Lanes::Components => all.push(out.iter().sum()),
            }
        });
        all
    }

    /// Computes B(y)v.
    pub fn structure(&mut self, y: &[Vec<f64>], v: &[Vec<f64>]) -> Batch {
        self.evaluate(Op::Structure { y, v }, &[], false)
    }

    /// Computes (∂B(y)·u)v.
    pub fn structure_along(&mut self, y: &[Vec<f64>], u: &[Vec<f64>], v: &[Vec<f64>]) -> Batch {
        self.evaluate(Op::StructureAlong { y, u, v }, &[], false)
    }

    /// Gradient ∇h(y).
    pub fn gradient(&mut self, y: &[Vec<f64>], weights: &[f64]) -> Batch {
        self.evaluate(Op::Gradient { y }, weights, false)
    }

    /// Field f = B∇h.
    pub fn field(&mut self, y: &[Vec<f64>], weights: &[f64]) -> Batch {
        let slope = self.gradient(y, weights);
        self.structure(y, &slope)
    }

    /// Derivative f′u = (∂B·u)∇h + B∇²hu of the field, from `slope` = ∇h.
    pub fn field_along(
        &mut self,
        y: &[Vec<f64>],
        u: &[Vec<f64>],
        slope: &[Vec<f64>],
        weights: &[f64],
    ) -> Batch {
        let turned = self.structure_along(y, u, slope);
        let curved = self.evaluate(Op::Hessian { y, u }, weights, false);
        let curved = self.structure(y, &curved);
        turned.iter().zip(curved).map(|(a, b)| moved(a, 1.0, &b)).collect()
    }

    /// The columns of the derivative f′ of the field at each point, from `slope` = ∇h.
    pub fn field_columns(&mut self, y: &[Vec<f64>], slope: &Batch, weights: &[f64]) -> Vec<Batch> {
        let d = self.dimension();
        (0..d).map(|i| self.field_along(y, &[axis(d, i)], slope, weights)).collect()
    }

    /// Averages ∇̄h(a, b), B((a+b)/2)∇̄h(a, b), and ∇̄h by quadrature, for a system with one tile.
    pub fn averages(&mut self, a: &[Vec<f64>], b: &[Vec<f64>], weights: &[f64]) -> [Batch; 3] {
        let gradient = Op::AveragedGradient { a, b };
        let all = [(gradient, false), (Op::AveragedField { a, b }, false), (gradient, true)];
        all.map(|(op, by_quadrature)| self.evaluate(op, weights, by_quadrature))
    }

    /// Energy h(y).
    pub fn energy(&mut self, y: &[Vec<f64>], weights: &[f64]) -> Vec<f64> {
        let dw = self.noise(&weights[1..]);
        let h = Weights { t: self.t, dt: weights[0], dw: &dw, areas: &[] };
        self.numbers(y, |system, y, out, scratch| system.energy(y, h, out, scratch))
    }

    /// Values of invariant number `index` that the system claims.
    pub fn invariant(&mut self, index: usize, y: &[Vec<f64>]) -> Vec<f64> {
        self.numbers(y, |system, y, out, scratch| system.invariant(index, y, out, scratch))
    }

    /// B at each point, by rows. For an equation without B the drift and the fields of noises at
    /// several times: functions that all of them keep have gradients that these rows are
    /// orthogonal to, as Casimirs have to those of B.
    pub fn matrix(&mut self, y: &[Vec<f64>]) -> Vec<Matrix> {
        if self.description.plain {
            let mut rows = vec![Matrix::new(); y.len()];
            let times = if self.description.depends_on_time { &TIMES[..] } else { &TIMES[..1] };
            for &t in times {
                self.t = t;
                for m in 0..=self.noises() {
                    let field = self.gradient(y, &self.weights(m));
                    rows.iter_mut().zip(field).for_each(|(rows, row)| rows.push(row));
                }
            }
            self.t = TIME;
            return rows;
        }
        let d = self.dimension();
        let columns: Vec<Batch> = (0..d).map(|j| self.structure(y, &[axis(d, j)])).collect();
        let at = |n: usize| transposed(&columns.iter().map(|column| column[n].clone()).collect());
        (0..y.len()).map(at).collect()
    }
}

/// Function of the state, evaluated at many points.
pub type Values<'f> = &'f dyn Fn(&mut Probe<'_>, &[Vec<f64>]) -> Vec<f64>;

/// Initial lengths of the differences along vectors: a tenth of a state.
pub fn lengths(y: &[Vec<f64>], along: &Batch) -> Vec<f64> {
    let sizes = y.iter().zip(along).map(|(y, along)| (largest(y), largest(along)));
    sizes.map(|(y, along)| 0.1 * y.max(f64::MIN_POSITIVE) / along.max(1e-300)).collect()
}

/// Coefficients of F(y + kh) − F(y − kh) in the central difference stencils of orders 8 and 6.
const WEIGHTS: [[f64; 4]; 2] =
    [[4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0], [3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0, 0.0]];
/// Number of lengths h that are tried, each half of the one before; the best is taken.
const LENGTHS: i32 = 8;
/// Part of the terms below which the error of a derivative counts as round-off.
const ROUNDING: f64 = 1e-14;
/// Part of its terms above which the error of a derivative leaves it unresolved.
const RESOLVED: f64 = 1e-9;

/// The derivative of F along vectors at each state, from these lengths on, and a size whose
/// round-off is its error: infinite where the domain is too narrow or no length resolves F.
pub fn slopes(
    probe: &mut Probe<'_>,
    y: &[Vec<f64>],
    along: &Batch,
    lengths: &[f64],
    f: Values<'_>,
) -> Vec<Term> {
    let mut best = vec![(0.0, f64::INFINITY); y.len()];
    for halvings in 0..LENGTHS {
        let length = |n: usize| lengths[n] * f64::powi(0.5, halvings);
        let mut side = |k: f64| {
            let at = |n: usize| moved(&y[n], k * length(n), &along[n]);
            let states: Batch = (0..y.len()).map(at).collect();
            let values = f(probe, &states);
            (states, values)
        };
        let sides = [1.0, 2.0, 3.0, 4.0].map(|k| [k, -k].map(&mut side));
        for n in 0..y.len() {
            let differences = sides.each_ref().map(|[up, down]| up.1[n] - down.1[n]);
            let [fine, coarse] = WEIGHTS.map(|weights| dot(&weights, &differences) / length(n));
            let mut sides = sides.iter().flatten();
            let size = largest(sides.clone().map(|(_, values)| &values[n])) / length(n);
            let apart = (fine - coarse).abs();
            let error = apart / ROUNDING + 0.1 * size;
            let better = error < best[n].1 && apart <= RESOLVED * size;
            if better && sides.all(|(states, _)| probe.in_domain(&states[n])) {
                best[n] = (fine, error);
            }
        }
    }
    best.into_iter().map(|(slope, error)| (slope, slope.abs() + error)).collect()
}
