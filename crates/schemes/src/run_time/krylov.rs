//! Newton's method with continuation for one path, without a matrix.
//!
//! The homotopy z = z₀ + s(ψ(z) − z₀) connects the start z₀ with the equation, as in [`nonlin`] for
//! few unknowns. Each linear equation (I − sψ′(z))δ = defect is solved by GMRES (Saad and Schultz
//! 1986) with products ψ′(z)u. Inner products are summed in a fixed order. A step in s is accepted
//! if Newton's method contracts from its first iteration on, otherwise it is halved.

use nonlin::Outcome;
use real::{OutOfMemory, Row, Rows, WIDTH};
use systems::run_time::{System, Weights};

use super::{
    derivative::derivative,
    machine::Machine,
    norm::{Product, Size, sum},
    plan::Plan,
    record::Node,
};

/// ‖z − ψ(z)‖₁ relative to ‖z‖₁ at which Newton's method ends.
const TOLERANCE: f64 = 2.0 * f64::EPSILON;
/// Most Newton iterations at one s.
const MOST_ITERATIONS: u32 = 20;
/// The largest ratio of successive changes.
const CONTRACTION: f64 = 0.5;
/// The smallest step in s.
const LEAST_STEP: f64 = 1.0 / 16384.0;
/// Changes that no longer decrease below this size are round-off.
const ROUND_OFF: f64 = 1.0 / (1u64 << 26) as f64;
/// Dimension of the Krylov space at most; then it is begun anew.
const DIRECTIONS: usize = 40;
/// Times that it is begun anew.
const RESTARTS: usize = 10;
/// The residual of a linear equation relative to its right-hand side.
const LINEAR_TOLERANCE: f64 = 1e-10;

/// Memory of the method.
pub struct Krylov<'a> {
    system: &'a dyn System,
    /// The machines of ψ and of its derivative.
    psi: Machine<'a>,
    slope: Machine<'a>,
    z: Rows,
    before: Rows,
    defect: Rows,
    change: Rows,
    basis: Vec<Rows>,
}

/// ψ with the noise of one path on all 32.
pub struct Equation<'e> {
    pub nodes: &'e [Node],
    pub factors: &'e [f64],
    pub h: Weights<'e>,
    /// ẑ of this path on all 32.
    pub start: &'e [Row],
}

/// The plans for ψ and its derivative.
struct Plans {
    psi: Plan,
    slope: Plan,
    slope_factors: Vec<f64>,
}

impl<'a> Krylov<'a> {
    /// Memory for a system.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn new(system: &'a dyn System) -> Result<Self, OutOfMemory> {
        let rows = || Rows::zero(system.rows());
        Ok(Self {
            system,
            psi: Machine::new(system)?,
            slope: Machine::new(system)?,
            z: rows()?,
            before: rows()?,
            defect: rows()?,
            change: rows()?,
            basis: Vec::new(),
        })
    }

    /// The solution of z = ψ(z) on the branch that begins at the start, and how it was found.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn solve(&mut self, equation: &Equation<'_>) -> Result<(&[Row], Outcome), OutOfMemory> {
        let (nodes, slope_factors) = derivative(equation.nodes, equation.factors);
        let plans = Plans {
            psi: Plan::new(equation.nodes, &[false; 2]),
            slope: Plan::new(&nodes, &[false; 3]),
            slope_factors,
        };
        self.psi.prepare(&plans.psi)?;
        self.slope.prepare(&plans.slope)?;
        self.psi.buffers[0].copy_from_slice(equation.start);
        self.slope.buffers[0].copy_from_slice(equation.start);
        self.z.copy_from_slice(equation.start);
        let (mut s, mut step, mut iterations) = (0.0, 1.0, 0);
        while s < 1.0 {
            let target = f64::min(s + step, 1.0);
            self.before.copy_from_slice(&self.z);
            let (converged, more) = self.newton(equation, &plans, target)?;
            iterations += more;
            if converged {
                s = target;
                step *= 2.0;
                continue;
            }
            self.z.copy_from_slice(&self.before);
            step *= 0.5;
            if step < LEAST_STEP {
                self.find_defect(equation, &plans, 1.0);
                let residual = self.norm(&self.defect);
                return Ok((&self.z, Outcome::Failed { residual }));
            }
        }
        self.find_defect(equation, &plans, 1.0);
        let residual = self.norm(&self.defect);
        Ok((&self.z, Outcome::Robust { iterations, residual }))
    }

    /// Newton's method for z = z₀ + s(ψ(z) − z₀): whether it converged, and its iterations.
    fn newton(
        &mut self,
        equation: &Equation<'_>,
        plans: &Plans,
        s: f64,
    ) -> Result<(bool, u32), OutOfMemory> {
        let mut before = f64::INFINITY;
        for iteration in 1..=MOST_ITERATIONS {
            self.find_defect(equation, plans, s);
            self.solve_linear(equation, plans, s)?;
            combine(&mut self.z, 1.0, &self.change, -1.0);
            let length = self.norm(&self.change);
            let size = self.norm(&self.z) + self.norm(equation.start);
            let solved = length <= TOLERANCE * size;
            // With a NaN both are false.
            let contracts = length <= CONTRACTION * before;
            if solved || !contracts {
                let stagnates = !contracts && length <= ROUND_OFF * size;
                return Ok((size.is_finite() && (solved || stagnates), iteration));
            }
            before = length;
        }
        Ok((false, MOST_ITERATIONS))
    }

    /// defect = z − z₀ − s(ψ(z) − z₀).
    fn find_defect(&mut self, equation: &Equation<'_>, plans: &Plans, s: f64) {
        self.psi.buffers[1].copy_from_slice(&self.z);
        self.psi.execute(&plans.psi, equation.factors, equation.h);
        let psi = &self.psi.buffers[plans.psi.result];
        for (((defect, z), start), psi) in
            self.defect.iter_mut().zip(self.z.iter()).zip(equation.start).zip(psi.iter())
        {
            for p in 0..WIDTH {
                defect[p] = (1.0 - s) * (z[p] - start[p]) + s * (z[p] - psi[p]);
            }
        }
    }

    /// change = (I − sψ′(z))⁻¹ defect, by GMRES.
    fn solve_linear(
        &mut self,
        equation: &Equation<'_>,
        plans: &Plans,
        s: f64,
    ) -> Result<(), OutOfMemory> {
        self.change.fill([0.0; WIDTH]);
        self.slope.buffers[1].copy_from_slice(&self.z);
        let aim = LINEAR_TOLERANCE * self.dot(&self.defect, &self.defect).sqrt();
        for _ in 0..RESTARTS {
            // The residual begins the basis.
            let mut residual = self.direction(0)?;
            self.apply(equation, plans, s, None, &mut residual);
            for (residual, defect) in residual.iter_mut().zip(self.defect.iter()) {
                for p in 0..WIDTH {
                    residual[p] = defect[p] - residual[p];
                }
            }
            let length = self.dot(&residual, &residual).sqrt();
            if length <= aim || !length.is_finite() {
                self.basis[0] = residual;
                return Ok(());
            }
            scale(&mut residual, 1.0 / length);
            self.basis[0] = residual;
            let columns = self.arnoldi(equation, plans, s, length, aim)?;
            for (k, weight) in columns.into_iter().enumerate() {
                combine(&mut self.change, 1.0, &self.basis[k], weight);
            }
        }
        Ok(())
    }

    /// Builds the Krylov space, and gives the weights of its directions in the solution.
    fn arnoldi(
        &mut self,
        equation: &Equation<'_>,
        plans: &Plans,
        s: f64,
        length: f64,
        aim: f64,
    ) -> Result<Vec<f64>, OutOfMemory> {
        // The upper triangular matrix after rotations, column by column, and the right-hand side.
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut rotations: Vec<(f64, f64)> = Vec::new();
        let mut right = vec![length];
        for k in 0..DIRECTIONS {
            let mut next = self.direction(k + 1)?;
            self.apply(equation, plans, s, Some(k), &mut next);
            let mut column = Vec::with_capacity(k + 2);
            // Twice is enough (Kahan; Giraud et al. 2005).
            for pass in 0..2 {
                for j in 0..=k {
                    let part = self.dot(&next, &self.basis[j]);
                    combine(&mut next, 1.0, &self.basis[j], -part);
                    if pass == 0 {
                        column.push(part);
                    } else {
                        column[j] += part;
                    }
                }
            }
            let rest = self.dot(&next, &next).sqrt();
            if rest > 0.0 {
                scale(&mut next, 1.0 / rest);
            }
            self.basis[k + 1] = next;
            for (j, &(c, d)) in rotations.iter().enumerate() {
                let (a, b) = (column[j], column[j + 1]);
                (column[j], column[j + 1]) = (c * a + d * b, c * b - d * a);
            }
            let radius = (column[k] * column[k] + rest * rest).sqrt();
            if !(radius > 0.0 && radius.is_finite()) {
                break;
            }
            let (c, d) = (column[k] / radius, rest / radius);
            column[k] = radius;
            columns.push(column);
            rotations.push((c, d));
            right.push(-d * right[k]);
            right[k] *= c;
            if right[k + 1].abs() <= aim || rest == 0.0 {
                break;
            }
        }
        let mut weights = vec![0.0; columns.len()];
        for k in (0..columns.len()).rev() {
            let known: f64 = (k + 1..columns.len()).map(|j| columns[j][k] * weights[j]).sum();
            weights[k] = (right[k] - known) / columns[k][k];
        }
        Ok(weights)
    }

    /// out = (I − sψ′(z))u for direction number k of the basis, or for the change so far.
    fn apply(
        &mut self,
        equation: &Equation<'_>,
        plans: &Plans,
        s: f64,
        direction: Option<usize>,
        out: &mut Rows,
    ) {
        let u = direction.map_or(&self.change, |k| &self.basis[k]);
        self.slope.buffers[2].copy_from_slice(u);
        self.slope.execute(&plans.slope, &plans.slope_factors, equation.h);
        out.copy_from_slice(u);
        combine(out, 1.0, &self.slope.buffers[plans.slope.result], -s);
    }

    /// Memory for a direction of the basis, taken out of it.
    fn direction(&mut self, k: usize) -> Result<Rows, OutOfMemory> {
        while self.basis.len() <= k {
            self.basis.push(Rows::zero(self.system.rows())?);
        }
        Ok(std::mem::take(&mut self.basis[k]))
    }

    fn dot(&self, x: &[Row], y: &[Row]) -> f64 {
        sum(self.system, Product, x, y)[0]
    }

    fn norm(&self, x: &[Row]) -> f64 {
        sum(self.system, Size, x, x)[0]
    }
}

/// x ← fx·x + fy·y.
fn combine(x: &mut [Row], fx: f64, y: &[Row], fy: f64) {
    for (x, y) in x.iter_mut().zip(y) {
        for p in 0..WIDTH {
            x[p] = x[p] * fx + y[p] * fy;
        }
    }
}

fn scale(x: &mut [Row], factor: f64) {
    x.iter_mut().flatten().for_each(|x| *x *= factor);
}
