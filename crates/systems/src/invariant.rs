//! Functions that obey the conformal law.

/// The reason why a function obeys the conformal law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InvariantKind {
    /// A Casimir: ∇F(y)ᵀB(y) = 0.
    Casimir,
    /// The Hamiltonian F = H of a system with H₀ = H and a single noise H₁ = cH.
    Energy,
}

/// The form of an invariant. It decides which schemes preserve the conformal law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// βᵀy.
    Linear,
    /// ½yᵀDy.
    Quadratic,
    /// Homogeneous, neither linear nor quadratic.
    Homogeneous,
}

/// A homogeneous function F of degree p that obeys the conformal law F(y(t)) = e^{−p∫γ} F(y₀), with
/// ∫γ over [0, t].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invariant {
    /// Symbol in reports, for example `C` or `H`.
    pub name: &'static str,
    /// Formula in reports.
    pub formula: &'static str,
    /// The reason why the law holds.
    pub kind: InvariantKind,
    /// The form of the function.
    pub form: Form,
    /// The degree p of homogeneity: F(λy) = λᵖF(y).
    pub degree: f64,
}

impl Invariant {
    /// A linear Casimir, of degree 1.
    pub const fn linear_casimir(name: &'static str, formula: &'static str) -> Self {
        Self { name, formula, kind: InvariantKind::Casimir, form: Form::Linear, degree: 1.0 }
    }

    /// A quadratic Casimir, of degree 2.
    pub const fn quadratic_casimir(name: &'static str, formula: &'static str) -> Self {
        let form = Form::Quadratic;
        Self { form, degree: 2.0, ..Self::linear_casimir(name, formula) }
    }
}
