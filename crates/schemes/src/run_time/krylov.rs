//! Newton's method with continuation, without a matrix, on all paths at once.
//!
//! The homotopy z = z₀ + s(ψ(z) − z₀) connects the start z₀ with the equation, as in [`nonlin`] for
//! few unknowns. Each linear equation (I − sψ′(z))δ = defect is solved by GMRES as in Walker and
//! Zhou (1994), with products ψ′(z)p. A step in s is accepted if Newton's method contracts from its
//! first iteration on, otherwise it is halved. Every path has numbers of its own, 32 in a [`Row`];
//! if a row belongs to one path they are equal.

use std::array::from_fn;

use nonlin::{
    Outcome,
    criteria::{CONTRACTION, MAX_ITERATIONS, MIN_STEP, ROUND_OFF, TOLERANCE},
};
use real::{PathMask, Row, Rows, WIDTH};
use systems::run_time::{System, Weights};

use super::{
    SchemeError,
    derivative::derivative,
    machine::Machine,
    norm::{changes, products, sums},
};
use crate::{Implicit, Step};

/// The most directions of a linear equation. If the eigenvalues of sψ′ are between −iλ and iλ, the
/// residual contracts by λ/(1 + √(1 + λ²)) with each: by [`CONTRACTION`] with all if λ = 28.
const DIRECTIONS: usize = 20;

/// Memory of the method.
pub struct Krylov<'a> {
    system: &'a dyn System,
    /// The machines of ψ and of its derivative. The first input of both is z₀.
    psi: Machine<'a>,
    slope: Machine<'a>,
    pub z: Rows,
    before: Rows,
    defect: Rows,
    /// The solution δ of a linear equation, and what it leaves of the defect.
    change: Rows,
    rest: Rows,
    /// Directions p and the images q = (I − sψ′(z))p, which are orthonormal.
    basis: Vec<[Rows; 2]>,
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
            rest: rows(),
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
                    if step[p] < MIN_STEP {
                        failed.insert(p);
                        going.remove(p);
                    }
                }
            }
        }
        self.s = [1.0; WIDTH];
        self.find_defect(h);
        let residuals = self.norm(&self.defect);
        Ok(from_fn(|p| {
            let (residual, iterations) = (residuals[p], iterations[p]);
            if failed.contains(p) {
                Outcome::Failed { residual }
            } else {
                Outcome::Robust { iterations, residual }
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
        for _ in 0..MAX_ITERATIONS {
            self.find_defect(h);
            let is_solved = self.solve_linear(h, going);
            subtract(&mut self.z, &self.change, &weights(going));
            let (lengths, sizes) = (self.norm(&self.change), self.norm(&self.z));
            for p in going.paths() {
                iterations[p] += 1;
                let length = if is_solved[p] { lengths[p] } else { f64::NAN };
                let size = sizes[p] + starts[p];
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

    /// Computes defect = z − z₀ − s(ψ(z) − z₀).
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

    /// Computes change = (I − sψ′(z))⁻¹ defect. Returns on which paths it is known well enough for
    /// Newton's method to contract.
    fn solve_linear(&mut self, h: Weights<'_>, paths: PathMask) -> [bool; WIDTH] {
        let Self { system, slope, z, defect, change, rest, basis, s, .. } = self;
        let product = |x: &[Row], y: &[Row]| sums(*system, products, [x, y, y])[0];
        let length = |x: &[Row]| product(x, x).map(f64::sqrt);
        change.fill([0.0; WIDTH]);
        rest.copy_from_slice(defect);
        slope.buffers[1].copy_from_slice(z);
        let whole = length(defect);
        let mut left = whole;
        // More directions than components are dependent.
        for k in 0..DIRECTIONS.min(system.description().dimension) {
            // Nothing is gained with a NaN.
            let is_open = |l: usize| left[l] > TOLERANCE * whole[l];
            if !paths.paths().any(is_open) {
                break;
            }
            if basis.len() == k {
                basis.push([(); 2].map(|()| Rows::zero(z.len())));
            }
            let (known, next) = basis.split_at_mut(k);
            let [p, q] = &mut next[0];
            p.copy_from_slice(known.last().map_or(&defect[..], |[_, q]| q));
            q.copy_from_slice(p);
            slope.buffers[2].copy_from_slice(p);
            slope.execute(h);
            subtract(q, slope.result(0), s);
            for [direction, image] in known {
                let part = product(q, image);
                subtract(p, direction, &part);
                subtract(q, image, &part);
            }
            let unit = length(q).map(|length| if length == 0.0 { 0.0 } else { 1.0 / length });
            for x in p.iter_mut().chain(q.iter_mut()) {
                (0..WIDTH).for_each(|l| x[l] *= unit[l]);
            }
            let part = product(q, rest);
            let part = from_fn(|l| if is_open(l) { part[l] } else { 0.0 });
            subtract(rest, q, &part);
            subtract(change, p, &part.map(|part| -part));
            left = length(rest);
        }
        from_fn(|l| left[l] <= CONTRACTION * whole[l])
    }

    /// The sum of the absolute values of a state.
    fn norm(&self, x: &[Row]) -> Row {
        sums(self.system, changes, [x; 3])[2]
    }
}

/// 1 on the paths, else 0.
fn weights(paths: PathMask) -> Row {
    from_fn(|p| if paths.contains(p) { 1.0 } else { 0.0 })
}

/// x − weight·y. Where the weight is zero y may be NaN.
fn subtract(x: &mut [Row], y: &[Row], weights: &Row) {
    for (x, y) in x.iter_mut().zip(y) {
        for p in 0..WIDTH {
            x[p] -= if weights[p] == 0.0 { 0.0 } else { y[p] * weights[p] };
        }
    }
}
