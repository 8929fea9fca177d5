//! Twins: wrong methods that a measurement must refute.

/// A statement about a method with one deliberate mistake, measured as the statement itself is.
///
/// A measurement that cannot fail says nothing. F is a function that returns the claim, whose
/// verdict must be *refuted*.
#[derive(Clone, Copy, Debug)]
pub struct Twin<F> {
    /// The statement that it is a twin of.
    pub claim: &'static str,
    /// The mistake in words.
    pub mistake: &'static str,
    /// Measures.
    pub measure: F,
}
