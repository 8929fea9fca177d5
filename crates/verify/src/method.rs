//! What is known of each scheme.

use systems::InvariantKind;

/// A scheme with what theory says of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The conformal exponential integrator, of which the paper proves its statements.
    Sexp,
    /// Euler–Maruyama.
    EulerMaruyama,
    /// The stochastic midpoint rule.
    Midpoint,
    /// The conformal exponential integrator with Lévy areas, which is not in the paper.
    SexpLevy,
    /// The linearly implicit conformal integrator, which is not in the paper.
    SexpLi,
    /// The same with Lévy areas.
    SexpLiLevy,
    /// Exact flows in turn, which is not in the paper.
    Split,
    /// Flows of the Hamiltonians in turn, of weak order two, which is not in the paper.
    Nv,
}

impl Method {
    /// The schemes that are not in the paper and can be further series of its panels.
    pub const FURTHER: [Self; 4] = [Self::SexpLevy, Self::SexpLi, Self::SexpLiLevy, Self::Split];

    /// Identifier in results, that of the scheme itself.
    pub fn id(self) -> &'static str {
        match self {
            Self::Sexp => "sexp",
            Self::EulerMaruyama => "em",
            Self::Midpoint => "midpoint",
            Self::SexpLevy => "sexp-levy",
            Self::SexpLi => "sexp-li",
            Self::SexpLiLevy => "sexp-li-levy",
            Self::Split => "split",
            Self::Nv => "nv",
        }
    }

    /// Strong order where noises commute, as a single one does, or do not.
    pub fn strong_order(self, commuting: bool) -> f64 {
        match self {
            Self::SexpLevy | Self::SexpLiLevy => 1.0,
            Self::EulerMaruyama => 0.5,
            Self::Sexp | Self::Midpoint | Self::SexpLi | Self::Split | Self::Nv => {
                if commuting {
                    1.0
                } else {
                    0.5
                }
            }
        }
    }

    /// Whether it obeys the conformal law of linear and quadratic Casimirs, or of a homogeneous
    /// energy with one noise, at every step.
    pub fn obeys_law(self, of: InvariantKind) -> bool {
        match self {
            Self::Sexp | Self::SexpLevy => true,
            Self::SexpLi | Self::SexpLiLevy | Self::Split | Self::Nv => {
                of == InvariantKind::Casimir
            }
            Self::EulerMaruyama | Self::Midpoint => false,
        }
    }
}
