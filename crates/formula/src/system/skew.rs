//! Whether a matrix of formulas is skew-symmetric.

use super::{DefinitionError, Which};
use crate::Formula;

/// The relative difference that counts as rounding: some hundred operations of 2⁻⁵³, and a loss of
/// five digits by cancellation.
const ROUNDING: f64 = 1e-9;

/// Checks bᵢⱼ = −bⱼᵢ at the initial value and points near it at which both are finite.
pub fn check(entries: &[Vec<Formula>], y0: &[f64]) -> Result<(), DefinitionError> {
    let points = systems::around(y0, |_| true);
    for i in 0..entries.len() {
        for j in 0..=i {
            let (lower, upper) = (&entries[i][j], &entries[j][i]);
            for point in &points {
                let (value, mirror) = (upper.value(point), lower.value(point));
                if (value + mirror).abs() > ROUNDING * (value.abs() + mirror.abs()) {
                    let (row, column) = (j + 1, i + 1);
                    let message = format!(
                        "B is not skew: row {row}, column {column} is {value}, and row {column}, \
                         column {row} is {mirror}, at y = {point:?}"
                    );
                    return Err(DefinitionError::new(Which::Structure(row, column), message));
                }
            }
        }
    }
    Ok(())
}
