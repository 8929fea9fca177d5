//! What is known of each scheme.

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
}

impl Method {
    /// Identifier in results, that of the scheme itself.
    pub fn id(self) -> &'static str {
        match self {
            Self::Sexp => "sexp",
            Self::EulerMaruyama => "em",
            Self::Midpoint => "midpoint",
            Self::SexpLevy => "sexp-levy",
        }
    }

    /// Strong order where noises commute, as a single one does, or do not.
    pub fn strong_order(self, commuting: bool) -> f64 {
        match self {
            Self::SexpLevy => 1.0,
            Self::Sexp | Self::Midpoint if commuting => 1.0,
            Self::Sexp | Self::Midpoint | Self::EulerMaruyama => 0.5,
        }
    }
}
