//! Why a scheme cannot be used for a system.

/// The scheme is not for the system: what it needs, and what to take instead.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct SchemeError(pub String);

impl SchemeError {
    /// Lévy areas enter by Jacobi's identity, which was not found to hold.
    pub(crate) fn jacobi(scheme: &str, system: &str) -> Self {
        Self(format!(
            "{scheme} needs Jacobi's identity [f_m, f_l] = -B grad {{H_m, H_l}}, which `{system}` \
             was not found to have: take sexp, or sexp-levy if the system has `commutators` of its \
             own"
        ))
    }

    /// The scheme is not for the system, for this reason.
    #[must_use]
    pub fn not_for(scheme: &str, system: &str, reason: &str) -> Self {
        Self(format!("{scheme} is not for `{system}`: {reason}"))
    }

    /// The system has no parts with flows.
    pub(crate) fn parts(scheme: &str, system: &str, reason: &str) -> Self {
        Self(format!(
            "{scheme} needs a sum of parts with flows, which `{system}` has not: {reason}"
        ))
    }
}
