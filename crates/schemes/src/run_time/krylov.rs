//! Newton's method with continuation, without a matrix, on all paths at once.
//!
//! The homotopy z = z₀ + s(ψ(z) − z₀) connects the start z₀ with the equation, as in [`nonlin`] for
//! few unknowns. Each linear equation (I − sψ′(z))δ = defect is solved by GMRES (Saad and Schultz
//! 1986) with products ψ′(z)u. A step in s is accepted if Newton's method contracts from its first
//! iteration on, otherwise it is halved. Every path has numbers of its own, 32 in a [`Row`]; if a
//! row belongs to one path they are equal.

use nonlin::{
    Outcome,
    criteria::{CONTRACTION, LEAST_STEP, MOST_ITERATIONS, ROUND_OFF, TOLERANCE},
};
use real::{PathMask, Row, Rows, WIDTH};
use systems::run_time::{System, Weights};

use super::{
    SchemeError,
    derivative::derivative,
    machine::Machine,
    norm::{Changes, Product, sums},
};
use crate::{Implicit, Step};

/// Dimension of the Krylov space at most; then it is begun anew.
const DIRECTIONS: usize = 40;
/// Times that it is begun.
const STARTS: usize = 10;
/// The residual of a linear equation relative to its right-hand side.
const LINEAR_TOLERANCE: f64 = 1e-8;

/// Memory of the method.
pub struct Krylov<'a> {
    system: &'a dyn System,
    /// The machines of ψ and of its derivative. The first input of both is z₀.
    psi: Machine<'a>,
    slope: Machine<'a>,
    pub z: Rows,
    before: Rows,
    defect: Rows,
    change: Rows,
    basis: Vec<Rows>,
    /// s of every path.
    s: Row,
}

impl<'a> Krylov<'a> {
    /// Memory for a system.
    pub fn new(system: &'a dyn System) -> Self {
        let rows = || Rows::zero(system.description().layout.rows);
        Self {
            system,
            psi: Machine::new(system),
            slope: Machine::new(system),
            z: rows(),
            before: rows(),
            defect: rows(),
            change: rows(),
            basis: Vec::new(),
            s: [0.0; WIDTH],
        }
    }

    /// Solves the equations z = ψ(ẑ, z) of some paths on the branch that begins at `start` = ẑ; the
    /// solutions are in `z`. Returns how each ended.
    ///
    /// # Errors
    /// [`SchemeError`] if the derivative of the formula cannot be computed.
    pub fn solve<F: Implicit>(
        &mut self,
        formula: &F,
        step: &Step,
        h: Weights<'_>,
        start: &[Row],
        paths: PathMask,
    ) -> Result<[Outcome; WIDTH], SchemeError> {
        self.psi.record(formula, step, 1)?;
        self.slope.load(derivative(self.psi.operations())?)?;
        for place in [&mut self.psi.buffers[0], &mut self.slope.buffers[0], &mut self.z] {
            place.copy_from_slice(start);
        }
        // How far each path is, and its next step.
        let (mut reached, mut step) = ([0.0; WIDTH], [1.0f64; WIDTH]);
        let (mut going, mut failed, mut iterations) = (paths, PathMask::NONE, [0; WIDTH]);
        while !going.is_empty() {
            for p in going.paths() {
                self.s[p] = f64::min(reached[p] + step[p], 1.0);
            }
            self.before.copy_from_slice(&self.z);
            let converged = self.newton(h, going, &mut iterations);
            let back = going.without(converged);
            for (z, before) in self.z.iter_mut().zip(self.before.iter()) {
                back.paths().for_each(|p| z[p] = before[p]);
            }
            for p in going.paths() {
                if converged.contains(p) {
                    (reached[p], step[p]) = (self.s[p], 2.0 * step[p]);
                    if reached[p] == 1.0 {
                        going.remove(p);
                    }
                } else {
                    step[p] *= 0.5;
                    if step[p] < LEAST_STEP {
                        failed.insert(p);
                        going.remove(p);
                    }
                }
            }
        }
        self.s = [1.0; WIDTH];
        self.find_defect(h);
        let residuals = self.norm(&self.defect);
        Ok(std::array::from_fn(|p| {
            let (residual, iterations) = (residuals[p], iterations[p]);
            match failed.contains(p) {
                true => Outcome::Failed { residual },
                false => Outcome::Robust { iterations, residual },
            }
        }))
    }

    /// Newton's method for z = z₀ + s(ψ(z) − z₀): the paths on which it converged. Iterations are
    /// added to `iterations`.
    fn newton(
        &mut self,
        h: Weights<'_>,
        paths: PathMask,
        iterations: &mut [u32; WIDTH],
    ) -> PathMask {
        let mut before = [f64::INFINITY; WIDTH];
        let (mut going, mut converged) = (paths, PathMask::NONE);
        let starts = self.norm(&self.psi.buffers[0]);
        for _ in 0..MOST_ITERATIONS {
            self.find_defect(h);
            self.solve_linear(h, going);
            subtract(&mut self.z, &self.change, &weights(going));
            let (lengths, sizes) = (self.norm(&self.change), self.norm(&self.z));
            for p in going.paths() {
                iterations[p] += 1;
                let (length, size) = (lengths[p], sizes[p] + starts[p]);
                let solved = length <= TOLERANCE * size;
                // With a NaN both are false.
                let contracts = length <= CONTRACTION * before[p];
                if solved || !contracts {
                    going.remove(p);
                    let stagnates = !contracts && length <= ROUND_OFF * size;
                    if size.is_finite() && (solved || stagnates) {
                        converged.insert(p);
                    }
                }
                before[p] = length;
            }
            if going.is_empty() {
                break;
            }
        }
        converged
    }

    /// defect = z − z₀ − s(ψ(z) − z₀).
    fn find_defect(&mut self, h: Weights<'_>) {
        self.psi.buffers[1].copy_from_slice(&self.z);
        self.psi.execute(h);
        let (s, psi) = (&self.s, self.psi.result(0));
        let known = self.z.iter().zip(self.psi.buffers[0].iter()).zip(psi);
        for (defect, ((z, start), psi)) in self.defect.iter_mut().zip(known) {
            for p in 0..WIDTH {
                defect[p] = (1.0 - s[p]) * (z[p] - start[p]) + s[p] * (z[p] - psi[p]);
            }
        }
    }

    /// change = (I − sψ′(z))⁻¹ defect, by GMRES.
    fn solve_linear(&mut self, h: Weights<'_>, paths: PathMask) {
        self.change.fill([0.0; WIDTH]);
        self.slope.buffers[1].copy_from_slice(&self.z);
        self.reserve(2);
        let aim = self.length(&self.defect).map(|length| LINEAR_TOLERANCE * length);
        for start in 0..STARTS {
            // The residual begins the basis.
            self.basis[0].copy_from_slice(&self.defect);
            if let ([residual, product, ..], true) = (&mut self.basis[..], start > 0) {
                multiply(&mut self.slope, &self.s, h, &self.change, product);
                subtract(residual, product, &[1.0; WIDTH]);
            }
            let length = self.length(&self.basis[0]);
            if paths.paths().all(|p| length[p] <= aim[p] || !length[p].is_finite()) {
                return;
            }
            scale(&mut self.basis[0], length.map(inverse));
            let weights = self.arnoldi(h, paths, length, aim);
            for (direction, weight) in self.basis.iter().zip(&weights) {
                subtract(&mut self.change, direction, &weight.map(|weight| -weight));
            }
        }
    }

    /// Builds the Krylov space, and gives the weights of its directions in the solution.
    fn arnoldi(&mut self, h: Weights<'_>, paths: PathMask, length: Row, aim: Row) -> Vec<Row> {
        // The upper triangular matrix after rotations, column by column, and the right-hand side.
        let mut columns: Vec<Vec<Row>> = Vec::new();
        let mut rotations: Vec<(Row, Row)> = Vec::new();
        let mut right = vec![length];
        for k in 0..DIRECTIONS {
            self.reserve(k + 2);
            let (known, next) = self.basis.split_at_mut(k + 1);
            let next = &mut next[0];
            multiply(&mut self.slope, &self.s, h, &known[k], next);
            let mut column = vec![[0.0; WIDTH]; k + 1];
            // Twice is enough to be orthogonal (Giraud, Langou and Rozloznik 2005).
            for _ in 0..2 {
                for (direction, entry) in known.iter().zip(&mut column) {
                    let [part] = sums(self.system, Product, [next, direction, direction]);
                    subtract(next, direction, &part);
                    (0..WIDTH).for_each(|p| entry[p] += part[p]);
                }
            }
            let rest = self.length(&self.basis[k + 1]);
            scale(&mut self.basis[k + 1], rest.map(inverse));
            let (mut cosine, mut sine) = ([1.0; WIDTH], [0.0; WIDTH]);
            let mut after = [0.0; WIDTH];
            for p in 0..WIDTH {
                for (j, (c, d)) in rotations.iter().enumerate() {
                    let (a, b) = (column[j][p], column[j + 1][p]);
                    (column[j][p], column[j + 1][p]) = (c[p] * a + d[p] * b, c[p] * b - d[p] * a);
                }
                let radius = (column[k][p] * column[k][p] + rest[p] * rest[p]).sqrt();
                if radius > 0.0 {
                    (cosine[p], sine[p]) = (column[k][p] / radius, rest[p] / radius);
                }
                column[k][p] = radius;
                after[p] = -sine[p] * right[k][p];
                right[k][p] *= cosine[p];
            }
            columns.push(column);
            rotations.push((cosine, sine));
            right.push(after);
            // With a NaN there is nothing to be gained.
            if paths.paths().all(|p| after[p].abs() <= aim[p] || after[p].is_nan()) {
                break;
            }
        }
        let mut weights = vec![[0.0; WIDTH]; columns.len()];
        for k in (0..columns.len()).rev() {
            for p in 0..WIDTH {
                let known: f64 =
                    (k + 1..columns.len()).map(|j| columns[j][k][p] * weights[j][p]).sum();
                weights[k][p] = (right[k][p] - known) * inverse(columns[k][k][p]);
            }
        }
        weights
    }

    /// Memory for so many directions of the basis.
    fn reserve(&mut self, directions: usize) {
        let (missing, rows) = (directions.saturating_sub(self.basis.len()), self.z.len());
        self.basis.extend((0..missing).map(|_| Rows::zero(rows)));
    }

    /// The Euclidean length of a state.
    fn length(&self, x: &[Row]) -> Row {
        sums(self.system, Product, [x; 3])[0].map(f64::sqrt)
    }

    /// The sum of the absolute values of a state.
    fn norm(&self, x: &[Row]) -> Row {
        sums(self.system, Changes, [x; 3])[2]
    }
}

/// out = (I − sψ′(z))u, where the machine has z.
fn multiply(slope: &mut Machine<'_>, s: &Row, h: Weights<'_>, u: &[Row], out: &mut [Row]) {
    slope.buffers[2].copy_from_slice(u);
    slope.execute(h);
    out.copy_from_slice(u);
    subtract(out, slope.result(0), s);
}

/// 1 on the paths, else 0.
fn weights(paths: PathMask) -> Row {
    std::array::from_fn(|p| if paths.contains(p) { 1.0 } else { 0.0 })
}

/// 1/x, and 0 for 0.
fn inverse(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 1.0 / x }
}

/// x − weight·y. Where the weight is zero y may be NaN.
fn subtract(x: &mut [Row], y: &[Row], weights: &Row) {
    for (x, y) in x.iter_mut().zip(y) {
        for p in 0..WIDTH {
            x[p] -= if weights[p] == 0.0 { 0.0 } else { y[p] * weights[p] };
        }
    }
}

/// weight·x.
fn scale(x: &mut [Row], weights: Row) {
    x.iter_mut().for_each(|row| (0..WIDTH).for_each(|p| row[p] *= weights[p]));
}
