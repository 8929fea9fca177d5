//! The trait of systems known at run time.

use std::ops::Range;

use real::{Bounded, Row};

use super::{Description, Move, Op, Program, Recorded};
use crate::SystemError;

/// The weights of the Hamiltonian increment h = H₀·dt + Σₘ Hₘ·dwₘ.
#[derive(Clone, Copy, Debug)]
pub struct Weights<'a> {
    /// The time of Hamiltonians that [depend on it](Description::depends_on_time): the middle of
    /// the step.
    pub t: f64,
    /// The weight of H₀.
    pub dt: f64,
    /// The weights of H₁, …, in [`Layout::noise_rows`](super::Layout::noise_rows) rows.
    pub dw: &'a [Row],
    /// The Lévy areas of M noises, read where [`Op::reads_areas`]: A_ml for m < l in row mM + l of
    /// M² rows. Empty where no operation reads them.
    pub areas: &'a [Row],
}

impl Weights<'_> {
    /// No time and no noise, for operations that do not read them.
    pub const NONE: Self = Self { t: 0.0, dt: 0.0, dw: &[], areas: &[] };
}

/// A Poisson system dy = B∇H₀ dt + Σₘ B∇Hₘ ∘ dWₘ whose dimension and number of noises are known at
/// run time.
///
/// B is block diagonal: rows are grouped in tiles, and B(y)v on a tile depends on y and v there. A
/// tile is the whole state unless the [layout](super::Layout) says otherwise, so that B is any
/// matrix. ∇h may read all of y. `scratch` has at least
/// [`scratch_rows`](Description::scratch_rows) rows with any content.
pub trait System: Send + Sync {
    /// Properties of the system.
    fn description(&self) -> &Description;

    /// Writes the rows `tile` of the result of an operation into `out`, of length `tile.len()`.
    /// Arguments that are read on the tile alone ([`Op::is_local`]) have this length too, others
    /// are whole states. Averages are asked for on one tile only, and [`Op::Cayley`] only if B is
    /// affine. [`derived`](super::derived) has operations that follow from others.
    fn apply(
        &self,
        op: Op<&[Row]>,
        tile: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    );

    /// Compiles the operations of a formula with `inputs` inputs into one piece, if the system can
    /// do better than one operation after the other. The bits have to be the same. `results` are
    /// the numbers of the operations whose results are wanted.
    fn compile(
        &self,
        operations: &[Recorded],
        inputs: usize,
        results: &[usize],
    ) -> Option<Box<dyn Program>> {
        let _ = (operations, inputs, results);
        None
    }

    /// Compiles the moves of a composition into one piece with one state as input, if the system
    /// can do better than one flow after the other. Where a move reads space-time areas, their rows
    /// come after those of the increments.
    fn compose(&self, moves: &[Move]) -> Option<Box<dyn Program>> {
        let _ = moves;
        None
    }

    /// The last of the [parts](Description::parts), if its flow is not known: an energy-preserving
    /// step stands for it.
    fn rest(&self) -> Option<&dyn System> {
        None
    }

    /// h(y) of each path. If rows belong to one path, h is the sum over the row.
    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, scratch: &mut [Row]);

    /// Functions of the states of 32 paths that are zero where a Hamiltonian has a pole or the
    /// logarithm of zero.
    fn walls(&self, y: &[Row]) -> Vec<Row> {
        let _ = y;
        Vec::new()
    }

    /// The components of B∇H₀, B∇H₁, … at a state that change with time; `None` if they are known
    /// at single times only.
    fn in_time(&self, y: &[f64]) -> Option<Box<dyn InTime>> {
        let _ = y;
        None
    }

    /// The flow of one of the [parts](Description::parts) from y, in place; y is whole.
    fn flow(&self, part: usize, y: &mut [Row], h: Weights<'_>, scratch: &mut [Row]) {
        let _ = (y, h, scratch);
        unreachable!("{} has no part {part}", self.description().name)
    }

    /// The value of one of the [invariants](Description::invariants) of each path. If rows belong
    /// to one path, it is the sum over the row.
    fn invariant(&self, index: usize, y: &[Row], out: &mut Row, scratch: &mut [Row]) {
        let _ = (y, out, scratch);
        crate::system::no_invariant(&self.description().name, index)
    }

    /// A function of the state and the time that is finite in the domain; none if that is ℝᴰ, see
    /// [`Description::has_guard`].
    fn guard(&self) -> Option<Box<dyn Program>> {
        None
    }

    /// Checks that the components y are in the domain of the system: ℝᴰ unless overridden.
    ///
    /// # Errors
    /// [`SystemError`].
    fn check_domain(&self, y: &[f64]) -> Result<(), SystemError> {
        let _ = y;
        Ok(())
    }
}

/// Functions of time.
pub trait InTime: Send + Sync {
    /// Values of the functions at 32 times.
    fn values(&self, times: &Row) -> Vec<Row>;

    /// Bounds of the functions at a time that is known to an error: each value to ± an error,
    /// infinite or NaN if there is no bound. None unless overridden.
    fn bounds(&self, time: Bounded) -> Vec<Bounded> {
        let _ = time;
        Vec::new()
    }
}
