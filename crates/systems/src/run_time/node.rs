//! The operations of a scheme's formula.

use real::Row;

use super::Weights;

/// Most states that a formula has as inputs: ẑ, z and a direction.
pub const MOST_INPUTS: usize = 3;

/// An operation on states. Arguments are numbers of earlier nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// An argument of the formula.
    Input(usize),
    /// a + b.
    Sum(usize, usize),
    /// a − b.
    Difference(usize, usize),
    /// A multiple of a; the factor is kept apart.
    Multiple(usize),
    /// B(y)v.
    Structure {
        /// y.
        y: usize,
        /// v.
        v: usize,
    },
    /// (∂B(y)·u)v.
    StructureAlong {
        /// y.
        y: usize,
        /// u.
        u: usize,
        /// v.
        v: usize,
    },
    /// ∇h(y).
    Gradient {
        /// y.
        y: usize,
    },
    /// ∇²h(y)u.
    Hessian {
        /// y.
        y: usize,
        /// u.
        u: usize,
    },
    /// ∇̄h(a, b).
    AveragedGradient {
        /// a.
        a: usize,
        /// b.
        b: usize,
    },
    /// ∂∇̄h(a, b)/∂b·u.
    AveragedHessian {
        /// a.
        a: usize,
        /// b.
        b: usize,
        /// u.
        u: usize,
    },
    /// B((a+b)/2)∇̄h(a, b).
    AveragedField {
        /// a.
        a: usize,
        /// b.
        b: usize,
    },
    /// The solution of z = y + B((y+z)/2)v.
    Cayley {
        /// y.
        y: usize,
        /// v.
        v: usize,
    },
    /// ½Σ fₘ′fₘ at y.
    ItoCorrection {
        /// y.
        y: usize,
    },
}

/// The operations of a formula on one system, compiled into something faster than one operation
/// after the other, see [`System::compile`](super::System::compile).
pub trait Program: Send {
    /// Writes the results, one state after the other. `inputs` are the states of the
    /// [`Node::Input`]s, `factors` has a number for every node, used by each [`Node::Multiple`].
    fn run(&mut self, inputs: &[&[Row]], factors: &[f64], h: Weights<'_>, out: &mut [Row]);
}
