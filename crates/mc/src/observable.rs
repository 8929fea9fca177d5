//! Test functions.

/// A test function φ with its name.
#[derive(Clone, Copy, Debug)]
pub struct Observable<const D: usize> {
    /// Its name in results, for example `y1` or `cos y3`.
    pub name: &'static str,
    /// φ(y).
    pub function: fn([f64; D]) -> f64,
}
