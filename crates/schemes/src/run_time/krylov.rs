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
use real::{Kernel, OutOfMemory, PathMask, Row, Rows, WIDTH, dispatch};
use systems::run_time::{Recorded, System, Weights};

use super::{
    SchemeError,
    derivative::derivative,
    machine::Machine,
    norm::{Product, Size, sum},
};

/// Dimension of the Krylov space at most; then it is begun anew.
const DIRECTIONS: usize = 40;
/// Times that it is begun.
const STARTS: usize = 10;
/// The residual of a linear equation relative to its right-hand side.
const LINEAR_TOLERANCE: f64 = 1e-8;

/// Memory of the method.
pub struct Krylov<'a> {
    system: &'a dyn System,
    /// The machines of ψ and of its derivative.
    psi: Machine<'a>,
    slope: Machine<'a>,
    pub z: Rows,
    before: Rows,
    defect: Rows,
    change: Rows,
    basis: Vec<Rows>,
}

/// The equation z = ψ(ẑ, z).
pub struct Equation<'e> {
    pub nodes: &'e [Recorded],
    pub factors: &'e [f64],
    pub h: Weights<'e>,
    /// ẑ.
    pub start: &'e [Row],
}

/// An equation, the factors of its derivative, and s of every path.
struct Homotopy<'e> {
    equation: &'e Equation<'e>,
    slope_factors: Vec<f64>,
    s: Row,
}

impl<'a> Krylov<'a> {
    /// Memory for a system.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn new(system: &'a dyn System) -> Result<Self, OutOfMemory> {
        let rows = || Rows::zero(system.description().layout.rows);
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

    /// Solves the equations of some paths on the branch that begins at the start; the solutions are
    /// in `z`. Returns how each ended.
    ///
    /// # Errors
    /// [`SchemeError`] if memory is not there.
    pub fn solve(
        &mut self,
        equation: &Equation<'_>,
        paths: PathMask,
    ) -> Result<[Outcome; WIDTH], SchemeError> {
        let (nodes, slope_factors) = derivative(equation.nodes, equation.factors)?;
        self.psi.prepare(equation.nodes, &[false; 2])?;
        self.slope.prepare(&nodes, &[false; 3])?;
        let mut homotopy = Homotopy { equation, slope_factors, s: [0.0; WIDTH] };
        self.psi.buffers[0].copy_from_slice(equation.start);
        self.slope.buffers[0].copy_from_slice(equation.start);
        self.z.copy_from_slice(equation.start);
        // How far each path is, and its next step.
        let (mut reached, mut step) = ([0.0; WIDTH], [1.0f64; WIDTH]);
        let (mut going, mut failed, mut iterations) = (paths, PathMask::NONE, [0; WIDTH]);
        while !going.is_empty() {
            for p in going.paths() {
                homotopy.s[p] = f64::min(reached[p] + step[p], 1.0);
            }
            self.before.copy_from_slice(&self.z);
            let converged = self.newton(&homotopy, going, &mut iterations)?;
            let back = going.without(converged);
            dispatch(Choose { x: &mut self.z, y: &self.before, paths: weights(back) });
            for p in going.paths() {
                if converged.contains(p) {
                    (reached[p], step[p]) = (homotopy.s[p], 2.0 * step[p]);
                    if reached[p] == 1.0 {
                        going = going.without(PathMask(1 << p));
                    }
                } else {
                    step[p] *= 0.5;
                    if step[p] < LEAST_STEP {
                        failed.insert(p);
                        going = going.without(PathMask(1 << p));
                    }
                }
            }
        }
        homotopy.s = [1.0; WIDTH];
        self.find_defect(&homotopy);
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
        homotopy: &Homotopy<'_>,
        paths: PathMask,
        iterations: &mut [u32; WIDTH],
    ) -> Result<PathMask, OutOfMemory> {
        let mut before = [f64::INFINITY; WIDTH];
        let (mut going, mut converged) = (paths, PathMask::NONE);
        let starts = self.norm(homotopy.equation.start);
        for _ in 0..MOST_ITERATIONS {
            self.find_defect(homotopy);
            self.solve_linear(homotopy, going)?;
            dispatch(AddMultiple {
                x: &mut self.z,
                y: &self.change,
                factor: weights(going),
                by: -1.0,
            });
            let (lengths, sizes) = (self.norm(&self.change), self.norm(&self.z));
            for p in going.paths() {
                iterations[p] += 1;
                let (length, size) = (lengths[p], sizes[p] + starts[p]);
                let solved = length <= TOLERANCE * size;
                // With a NaN both are false.
                let contracts = length <= CONTRACTION * before[p];
                if solved || !contracts {
                    going = going.without(PathMask(1 << p));
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
        Ok(converged)
    }

    /// defect = z − z₀ − s(ψ(z) − z₀).
    fn find_defect(&mut self, homotopy: &Homotopy<'_>) {
        let Homotopy { equation: Equation { factors, h, start, .. }, s, .. } = homotopy;
        self.psi.buffers[1].copy_from_slice(&self.z);
        self.psi.execute(factors, *h);
        let psi = &self.psi.buffers[self.psi.result()];
        for (((defect, z), start), psi) in
            self.defect.iter_mut().zip(self.z.iter()).zip(*start).zip(psi.iter())
        {
            for p in 0..WIDTH {
                defect[p] = (1.0 - s[p]) * (z[p] - start[p]) + s[p] * (z[p] - psi[p]);
            }
        }
    }

    /// change = (I − sψ′(z))⁻¹ defect, by GMRES.
    fn solve_linear(
        &mut self,
        homotopy: &Homotopy<'_>,
        paths: PathMask,
    ) -> Result<(), OutOfMemory> {
        self.change.fill([0.0; WIDTH]);
        self.slope.buffers[1].copy_from_slice(&self.z);
        let aim = self.length(&self.defect).map(|length| LINEAR_TOLERANCE * length);
        for start in 0..STARTS {
            // The residual begins the basis.
            let mut residual = self.direction(0)?;
            residual.copy_from_slice(&self.defect);
            if start > 0 {
                let mut product = self.direction(1)?;
                self.apply(homotopy, None, &mut product);
                add(&mut residual, &product, [1.0; WIDTH], -1.0);
                self.basis[1] = product;
            }
            let length = self.length(&residual);
            if paths.paths().all(|p| length[p] <= aim[p] || !length[p].is_finite()) {
                self.basis[0] = residual;
                return Ok(());
            }
            dispatch(Scale { x: &mut residual, factor: length.map(inverse) });
            self.basis[0] = residual;
            let weights = self.arnoldi(homotopy, paths, length, aim)?;
            for (k, &weight) in weights.iter().enumerate() {
                add(&mut self.change, &self.basis[k], weight, 1.0);
            }
        }
        Ok(())
    }

    /// Builds the Krylov space, and gives the weights of its directions in the solution.
    fn arnoldi(
        &mut self,
        homotopy: &Homotopy<'_>,
        paths: PathMask,
        length: Row,
        aim: Row,
    ) -> Result<Vec<Row>, OutOfMemory> {
        // The upper triangular matrix after rotations, column by column, and the right-hand side.
        let mut columns: Vec<Vec<Row>> = Vec::new();
        let mut rotations: Vec<(Row, Row)> = Vec::new();
        let mut right = vec![length];
        for k in 0..DIRECTIONS {
            let mut next = self.direction(k + 1)?;
            self.apply(homotopy, Some(k), &mut next);
            let mut column = vec![[0.0; WIDTH]; k + 1];
            // Twice is enough to be orthogonal (Giraud, Langou and Rozloznik 2005).
            for _ in 0..2 {
                for j in 0..=k {
                    let part = sum(self.system, Product, &next, &self.basis[j]);
                    add(&mut next, &self.basis[j], part, -1.0);
                    for p in 0..WIDTH {
                        column[j][p] += part[p];
                    }
                }
            }
            let rest = self.length(&next);
            dispatch(Scale { x: &mut next, factor: rest.map(inverse) });
            self.basis[k + 1] = next;
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
        Ok(weights)
    }

    /// out = (I − sψ′(z))u for direction number k of the basis, or for the change so far.
    fn apply(&mut self, homotopy: &Homotopy<'_>, direction: Option<usize>, out: &mut Rows) {
        let Homotopy { equation, slope_factors, s } = homotopy;
        let u = direction.map_or(&self.change, |k| &self.basis[k]);
        self.slope.buffers[2].copy_from_slice(u);
        self.slope.execute(slope_factors, equation.h);
        out.copy_from_slice(u);
        add(out, &self.slope.buffers[self.slope.result()], *s, -1.0);
    }

    /// Memory for a direction of the basis, taken out of it.
    fn direction(&mut self, k: usize) -> Result<Rows, OutOfMemory> {
        while self.basis.len() <= k {
            self.basis.push(Rows::zero(self.z.len())?);
        }
        Ok(std::mem::take(&mut self.basis[k]))
    }

    /// The Euclidean length of a state.
    fn length(&self, x: &[Row]) -> Row {
        sum(self.system, Product, x, x).map(f64::sqrt)
    }

    /// The sum of the absolute values of a state.
    fn norm(&self, x: &[Row]) -> Row {
        sum(self.system, Size, x, x)
    }
}

/// 1 on the paths, else 0.
fn weights(paths: PathMask) -> Row {
    std::array::from_fn(|p| if paths.contains(p) { 1.0 } else { 0.0 })
}

/// 1/x, and 0 for 0.
fn inverse(x: f64) -> f64 {
    if x == 0.0 { 0.0 } else { 1.0 / x }
}

fn add(x: &mut [Row], y: &[Row], factor: Row, by: f64) {
    dispatch(AddMultiple { x, y, factor, by });
}

/// x + by·factor·y.
struct AddMultiple<'a> {
    x: &'a mut [Row],
    y: &'a [Row],
    factor: Row,
    by: f64,
}

impl Kernel for AddMultiple<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (x, y) in self.x.iter_mut().zip(self.y) {
            let (mut row, y) = (*x, *y);
            for p in 0..WIDTH {
                // Where the factor is zero y may be NaN.
                let term = if self.factor[p] == 0.0 { 0.0 } else { y[p] * self.factor[p] };
                row[p] += term * self.by;
            }
            *x = row;
        }
    }
}

/// factor·x.
struct Scale<'a> {
    x: &'a mut [Row],
    factor: Row,
}

impl Kernel for Scale<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for x in self.x.iter_mut() {
            let mut row = *x;
            for p in 0..WIDTH {
                row[p] *= self.factor[p];
            }
            *x = row;
        }
    }
}

/// x ← y on paths with the weight one.
pub struct Choose<'a> {
    pub x: &'a mut [Row],
    pub y: &'a [Row],
    pub paths: Row,
}

impl Kernel for Choose<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (x, y) in self.x.iter_mut().zip(self.y) {
            let (mut row, y) = (*x, *y);
            for p in 0..WIDTH {
                row[p] = if self.paths[p] == 1.0 { y[p] } else { row[p] };
            }
            *x = row;
        }
    }
}
