//! Functions that obey the conformal law F(y(t)) = exp(−p ∫₀ᵗ γ) F(y₀).

/// Why a function obeys the conformal law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvariantKind {
    /// A Casimir: ∇F(y)ᵀB(y) = 0.
    Casimir,
    /// The Hamiltonian of a one-noise system, ∇FᵀB∇F = 0.
    Energy,
}

/// The shape of the function, which decides what a scheme keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// βᵀy.
    Linear,
    /// ½yᵀDy.
    Quadratic,
    /// Homogeneous, but neither of these.
    Homogeneous,
}

/// A homogeneous function that the exact solution damps by its degree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invariant {
    /// Its symbol: `C`, `H`, or `S` for a linear Casimir beside a quadratic one.
    pub name: &'static str,
    /// The formula.
    pub formula: &'static str,
    /// Why the law holds.
    pub kind: InvariantKind,
    /// The shape of the function.
    pub form: Form,
    /// Degree p of homogeneity: F(λy) = λᵖF(y).
    pub degree: f64,
}
