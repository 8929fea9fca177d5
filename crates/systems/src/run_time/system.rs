//! The trait of systems known at run time.

use std::ops::Range;

use dgrad::Rule;
use real::{Row, WIDTH};

use super::{Node, Program, derived};
use crate::{Invariant, Linearity};

/// The weights of the Hamiltonian increment h = H₀·dt + Σₘ Hₘ·dwₘ.
#[derive(Clone, Copy, Debug)]
pub struct Weights<'a> {
    /// The weight of H₀.
    pub dt: f64,
    /// The weights of H₁, …: as many rows as [`System::noise_rows`].
    pub dw: &'a [Row],
}

impl Weights<'_> {
    /// No time and no noise, for functions that do not read them.
    pub(super) const NONE: Self = Self { dt: 0.0, dw: &[[0.0; WIDTH]; 3] };
}

/// What the 32 numbers of a row belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lanes {
    /// To 32 paths: row i is component i.
    Paths,
    /// To one path. Numbers beyond its last component are zero and stay so.
    Components,
}

/// A Poisson system dy = B∇H₀ dt + Σₘ B∇Hₘ ∘ dWₘ whose dimension and number of noises are known at
/// run time.
///
/// B is block diagonal: rows are grouped in tiles, and B(y)v on a tile depends on y and v there. A
/// tile is the whole state unless [`tile_rows`](Self::tile_rows) says otherwise, so that B is any
/// matrix. ∇h may read all of y. Every method writes the rows `tile` of its result into `out`, of
/// length `tile.len()`. Arguments that are read on the tile alone have this length too, others are
/// whole states. `scratch` has at least [`scratch_rows`](Self::scratch_rows) rows with any content.
pub trait System: Send + Sync {
    /// The name of the system in reports.
    fn name(&self) -> &str;

    /// The parameters of the system in reports, for example `c = 0.5`; empty unless overridden.
    fn parameters(&self) -> String {
        String::new()
    }

    /// The number of components of a path.
    fn dimension(&self) -> usize;

    /// The number of noises.
    fn noises(&self) -> usize;

    /// What the numbers of a row belong to.
    fn lanes(&self) -> Lanes {
        Lanes::Paths
    }

    /// The number of rows of a state.
    fn rows(&self) -> usize {
        self.dimension()
    }

    /// The number of rows of the increments of all noises.
    fn noise_rows(&self) -> usize {
        self.noises()
    }

    /// Whether every component has a noise of its own, in the row and place of the component.
    /// Otherwise noise m is in row m.
    fn local_noise(&self) -> bool {
        false
    }

    /// The number of rows of a tile; the last tile may have fewer.
    fn tile_rows(&self) -> usize {
        self.rows()
    }

    /// How many tiles away from a tile [`gradient`](Self::gradient) and
    /// [`hessian`](Self::hessian) read their arguments at most, counted around from the last tile
    /// to the first. All unless overridden.
    fn reach(&self) -> usize {
        self.rows().div_ceil(self.tile_rows().max(1))
    }

    /// Rows of scratch for a method that is not derived from others.
    fn own_scratch_rows(&self) -> usize {
        0
    }

    /// Rows of scratch for any method. Every thread has them; methods that are derived from others
    /// are for systems with one tile, so that one large path has none for them.
    fn scratch_rows(&self) -> usize {
        let derived = match self.tile_rows() < self.rows() {
            true => 0,
            false => derived::scratch_rows(self.rows(), self.noise_rows()),
        };
        derived + self.own_scratch_rows()
    }

    /// Row and place in it of a component, on path 0. If rows belong to one path, it is its only
    /// place; otherwise path p is p places further.
    fn place(&self, component: usize) -> (usize, usize) {
        match self.lanes() {
            Lanes::Paths => (component, 0),
            Lanes::Components => (component / WIDTH, component % WIDTH),
        }
    }

    /// B(y)·v. All arguments are on the tile.
    fn structure(
        &self,
        tile: Range<usize>,
        y: &[Row],
        v: &[Row],
        out: &mut [Row],
        scratch: &mut [Row],
    );

    /// (∂B(y)/∂y · u)·v, the derivative of B(y)v along u for a fixed v. All arguments are on the
    /// tile.
    fn structure_along(
        &self,
        tile: Range<usize>,
        y: &[Row],
        u: &[Row],
        v: &[Row],
        out: &mut [Row],
        scratch: &mut [Row],
    );

    /// h(y) of each path. For [`Lanes::Components`] h is the sum over the row.
    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, scratch: &mut [Row]);

    /// ∇h(y), and whatever else turns the state, such as transverse damping: the v of B(y)v. y is
    /// whole.
    fn gradient(
        &self,
        tile: Range<usize>,
        y: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    );

    /// Whether [`gradient`](Self::gradient) is more than ∇h.
    fn is_transverse(&self) -> bool {
        false
    }

    /// ∇²h(y)·u, the derivative of [`gradient`](Self::gradient) along u; y and u are whole.
    fn hessian(
        &self,
        tile: Range<usize>,
        y: &[Row],
        u: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    );

    /// Whether h is a polynomial of degree at most two, so that ∇̄h(a, b) = ∇h((a+b)/2). What
    /// [`gradient`](Self::gradient) adds is then taken at (a+b)/2 too.
    fn is_quadratic(&self) -> bool {
        self.rule().nodes().len() == 1
    }

    /// The Gauss–Legendre rule for [`averaged_gradient`](Self::averaged_gradient): n nodes are
    /// exact if ∇h is a polynomial of degree at most 2n − 1.
    fn rule(&self) -> &Rule;

    /// ∇̄h(a, b) = ∫₀¹ ∇h((1−η)a + ηb) dη; by the [`rule`](Self::rule) unless overridden. Only for
    /// systems with one tile.
    fn averaged_gradient(
        &self,
        a: &[Row],
        b: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        derived::averaged_gradient(self, a, b, h, out, scratch);
    }

    /// B((a+b)/2)·∇̄h(a, b). Only for systems with one tile.
    fn averaged_field(
        &self,
        a: &[Row],
        b: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        derived::averaged_field(self, a, b, h, out, scratch);
    }

    /// How B depends on y.
    fn linearity(&self) -> Linearity;

    /// Whether z = y + B((y+z)/2)·v has a solution for every v, see
    /// [`always_solvable`](crate::always_solvable).
    fn always_solvable(&self) -> bool;

    /// The solution of z = y + B((y+z)/2)·v for B that is affine in y; not finite where there is
    /// none. All arguments are on the tile. Called only if [`linearity`](Self::linearity) is
    /// [`Affine`](Linearity::Affine).
    fn cayley(
        &self,
        tile: Range<usize>,
        y: &[Row],
        v: &[Row],
        out: &mut [Row],
        scratch: &mut [Row],
    );

    /// ½Σₘ fₘ′(y)fₘ(y) with fₘ = B∇Hₘ; by derivatives of B and of ∇Hₘ unless overridden, which is
    /// for systems with one tile. y is whole.
    fn ito_correction(&self, tile: Range<usize>, y: &[Row], out: &mut [Row], scratch: &mut [Row]) {
        debug_assert_eq!(tile, 0..self.rows());
        derived::ito_correction(self, y, out, scratch);
    }

    /// The operations of a formula with as many inputs in one piece, if the system can do better
    /// than one operation after the other. The bits have to be the same. `results` are the numbers
    /// of the operations whose results are wanted.
    fn compile(
        &self,
        nodes: &[Node],
        inputs: usize,
        results: &[usize],
    ) -> Option<Box<dyn Program>> {
        let _ = (nodes, inputs, results);
        None
    }

    /// The number of parts with exact flows, see [`Flows`](crate::Flows), or why there are none.
    ///
    /// # Errors
    /// The reason in words.
    fn parts(&self) -> Result<usize, String> {
        Err("it names no parts".into())
    }

    /// The flow of a part from y, in place; y is whole.
    fn flow(&self, part: usize, y: &mut [Row], h: Weights<'_>, scratch: &mut [Row]) {
        let _ = (y, h, scratch);
        unreachable!("{} has no part {part}", self.name())
    }

    /// The functions that obey the conformal law. Empty unless overridden.
    fn invariants(&self) -> Vec<Invariant> {
        Vec::new()
    }

    /// The value of `invariants()[index]` of each path. For [`Lanes::Components`] it is the sum
    /// over the row.
    fn invariant(&self, index: usize, y: &[Row], out: &mut Row, scratch: &mut [Row]) {
        let _ = (y, out, scratch);
        crate::system::no_invariant(self.name(), index)
    }

    /// Whether paths may leave the domain of the system where their steps are still finite, as
    /// behind the pole of a logarithm. Then [`guard`](Self::guard) is asked after every step.
    fn has_guard(&self) -> bool {
        false
    }

    /// Writes numbers that are finite on the paths that are in the domain. Only asked for if
    /// [`has_guard`](Self::has_guard).
    fn guard(&self, y: &[Row], out: &mut Row, scratch: &mut [Row]) {
        let _ = (y, scratch);
        out.fill(0.0);
    }

    /// The defects of methods of a compiled system that this interface does not have, for an
    /// inspection: what a method is not if it has one, and for each component the defect at y and
    /// the size of the terms of which it is the sum. None unless overridden.
    fn own_methods(&self, y: &[f64], dt: f64, dw: &[f64]) -> Vec<(&'static str, Vec<(f64, f64)>)> {
        let _ = (y, dt, dw);
        Vec::new()
    }

    /// Checks that the components y are in the domain of the system: ℝᴰ unless overridden.
    ///
    /// # Errors
    /// [`SystemError::OutsideDomain`](crate::SystemError::OutsideDomain).
    fn check_domain(&self, y: &[f64]) -> Result<(), crate::SystemError> {
        let _ = y;
        Ok(())
    }
}
