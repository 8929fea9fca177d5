//! The operations of a system, and those of a scheme's formula.

use std::any::Any;

use real::Row;

use super::Weights;

/// Most states that a formula has as inputs: ẑ, z and a direction.
pub const MAX_INPUTS: usize = 3;

/// An operation of a system, with arguments of type P: rows of a state, or whatever stands for a
/// state, such as the number of an operation or a place in memory. h is H₀dt + Σ Hₘdwₘ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Op<P> {
    /// B(y)v.
    Structure { y: P, v: P },
    /// (∂B(y)/∂y·u)v, the derivative of B(y)v along u for a fixed v.
    StructureAlong { y: P, u: P, v: P },
    /// ∇h(y), and whatever else turns the state, such as transverse damping: the v of B(y)v.
    Gradient { y: P },
    /// ∇²h(y)u, the derivative of [`Gradient`](Self::Gradient) along u.
    Hessian { y: P, u: P },
    /// ∇̄h(a, b) = ∫₀¹ ∇h((1−η)a + ηb) dη.
    AveragedGradient { a: P, b: P },
    /// ∂∇̄h(a, b)/∂b·u.
    AveragedHessian { a: P, b: P, u: P },
    /// B((a+b)/2)∇̄h(a, b).
    AveragedField { a: P, b: P },
    /// The solution of z = y + B((y+z)/2)v for B that is affine in y; not finite where there is
    /// none.
    Cayley { y: P, v: P },
    /// ½Σₘ fₘ′(y)fₘ(y) with fₘ = B∇Hₘ.
    ItoCorrection { y: P },
    /// Σ_{m<l} A_ml ∇{Hₘ, H_l}(y) with the Lévy areas A of the step and {F, G} = ∇FᵀB∇G.
    AreaGradient { y: P },
    /// The derivative of [`AreaGradient`](Self::AreaGradient) along u.
    AreaHessian { y: P, u: P },
}

impl<P> Op<P> {
    /// Operation with other arguments: `f` of each.
    #[inline(always)]
    pub fn map<Q>(self, mut f: impl FnMut(P) -> Q) -> Op<Q> {
        match self {
            Self::Structure { y, v } => Op::Structure { y: f(y), v: f(v) },
            Self::StructureAlong { y, u, v } => Op::StructureAlong { y: f(y), u: f(u), v: f(v) },
            Self::Gradient { y } => Op::Gradient { y: f(y) },
            Self::Hessian { y, u } => Op::Hessian { y: f(y), u: f(u) },
            Self::AveragedGradient { a, b } => Op::AveragedGradient { a: f(a), b: f(b) },
            Self::AveragedHessian { a, b, u } => Op::AveragedHessian { a: f(a), b: f(b), u: f(u) },
            Self::AveragedField { a, b } => Op::AveragedField { a: f(a), b: f(b) },
            Self::Cayley { y, v } => Op::Cayley { y: f(y), v: f(v) },
            Self::ItoCorrection { y } => Op::ItoCorrection { y: f(y) },
            Self::AreaGradient { y } => Op::AreaGradient { y: f(y) },
            Self::AreaHessian { y, u } => Op::AreaHessian { y: f(y), u: f(u) },
        }
    }

    /// The arguments in their order.
    pub fn arguments(self) -> impl Iterator<Item = P> {
        let (mut arguments, mut count) = ([None, None, None], 0);
        self.map(|argument| {
            arguments[count] = Some(argument);
            count += 1;
        });
        arguments.into_iter().flatten()
    }

    /// Whether the arguments are read on the tile of the result alone. Otherwise they are whole
    /// states.
    #[inline(always)]
    pub fn is_local(&self) -> bool {
        matches!(self, Self::Structure { .. } | Self::StructureAlong { .. } | Self::Cayley { .. })
    }

    /// Whether ∇h is averaged along a segment, which is for systems with one tile.
    pub fn is_average(&self) -> bool {
        matches!(
            self,
            Self::AveragedGradient { .. }
                | Self::AveragedHessian { .. }
                | Self::AveragedField { .. }
        )
    }

    /// Whether the result depends on the weights of h.
    #[inline(always)]
    pub fn reads_weights(&self) -> bool {
        !self.is_local() && !self.reads_areas() && !matches!(self, Self::ItoCorrection { .. })
    }

    /// Whether the result depends on the Lévy areas.
    #[inline(always)]
    pub fn reads_areas(&self) -> bool {
        matches!(self, Self::AreaGradient { .. } | Self::AreaHessian { .. })
    }
}

/// An operation of a recorded formula. Arguments are numbers of earlier operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recorded {
    /// An argument of the formula.
    Input(usize),
    /// a + b.
    Sum(usize, usize),
    /// a − b.
    Difference(usize, usize),
    /// A multiple of a; the factor is kept apart.
    Multiple(usize),
    /// An operation of the system.
    Of(Op<usize>),
}

impl Recorded {
    /// The arguments in their order.
    pub fn arguments(self) -> impl Iterator<Item = usize> {
        let (linear, op) = match self {
            Self::Input(_) => ([None, None], None),
            Self::Sum(a, b) | Self::Difference(a, b) => ([Some(a), Some(b)], None),
            Self::Multiple(a) => ([Some(a), None], None),
            Self::Of(op) => ([None, None], Some(op)),
        };
        linear.into_iter().flatten().chain(op.into_iter().flat_map(Op::arguments))
    }

    /// Whether the arguments are read on the tile of the result alone, see [`Op::is_local`].
    pub fn is_local(&self) -> bool {
        !matches!(self, Self::Of(op) if !op.is_local())
    }
}

/// The operations of a formula on one system, compiled into something faster than one operation
/// after the other, see [`System::compile`](super::System::compile).
pub trait Program: Any + Send {
    /// Writes the results, one state after the other. `inputs` are the states of the
    /// [`Recorded::Input`]s, `factors` has a number for every operation, used by each
    /// [`Recorded::Multiple`].
    fn run(&mut self, inputs: &[&[Row]], factors: &[f64], h: Weights<'_>, out: &mut [Row]);
}
