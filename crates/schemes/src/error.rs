//! Why a scheme cannot be used for a system.

use real::OutOfMemory;

/// A scheme that cannot be used for a system.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SchemeError {
    /// The structure matrix is neither constant nor affine, and Casimirs need not be linear.
    #[error(
        "{scheme} needs a structure matrix that is constant or affine in y, or a system whose \
         Casimirs are all linear; B of `{system}` is {found}; sexp is for any B"
    )]
    Structure {
        /// The scheme.
        scheme: &'static str,
        /// The name of the system.
        system: String,
        /// What was found.
        found: &'static str,
    },
    /// Lévy areas enter by Jacobi's identity, which was not found to hold.
    #[error(
        "{scheme} needs Jacobi's identity [f_m, f_l] = -B grad {{H_m, H_l}}, which `{system}` was \
         not found to have: take sexp, or sexp-levy if the system has `commutators` of its own"
    )]
    Jacobi {
        /// The scheme.
        scheme: &'static str,
        /// The name of the system.
        system: String,
    },
    /// No areas are drawn for one large path.
    #[error("no Lévy areas are drawn for one large path, and {scheme} reads them: take sexp-li")]
    Areas {
        /// The scheme.
        scheme: &'static str,
    },
    /// The system has no parts with flows.
    #[error("{scheme} needs a sum of parts with flows, which `{system}` has not: {reason}")]
    Parts {
        /// The scheme.
        scheme: &'static str,
        /// The system.
        system: String,
        /// Why it has none.
        reason: String,
    },
    /// Averages of ∇h are computed tile by tile for quadratic h only.
    #[error(
        "∇̄h of `{system}`, whose h is not quadratic, cannot be computed in tiles: take midpoint, \
         or one tile"
    )]
    Average {
        /// The system.
        system: String,
    },
    /// Newton's method, which solves where fixed-point iteration does not, needs a derivative that
    /// is not known.
    #[error(
        "an implicit formula cannot have `cayley` or `ito_correction` of z, whose derivatives \
         along z are not known: take them of ẑ"
    )]
    Derivative,
    /// Rows of the system hold one path.
    #[error(
        "rows of `{system}` hold one path, and not 32: take `mc::LargePath`, or the layout of the \
         system for many paths"
    )]
    OnePath {
        /// The system.
        system: String,
    },
    /// Rows of the system hold 32 paths.
    #[error("rows of `{system}` hold 32 paths: take an ensemble, or a layout for one path")]
    ManyPaths {
        /// The system.
        system: String,
    },
    /// There is no memory for the states.
    #[error(transparent)]
    Memory(#[from] OutOfMemory),
}
