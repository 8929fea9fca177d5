//! Whether a matrix of formulas is skew-symmetric.

use super::{DefinitionError, Which};
use crate::{Formula, Graph, Id};

/// The relative difference that counts as rounding: some hundred operations of 2⁻⁵³, and a loss of
/// five digits by cancellation.
const ROUNDING: f64 = 1e-9;

/// Checks bᵢⱼ = −bⱼᵢ: by the identities of [`Graph`], else at the initial value and points near it
/// at which both are finite.
pub fn check(entries: &[Vec<Formula>], y0: &[f64]) -> Result<(), DefinitionError> {
    let mut graph = Graph::new();
    let inputs: Vec<Id> = (0..y0.len()).map(|k| graph.input(k)).collect();
    for i in 0..entries.len() {
        for j in 0..=i {
            let (lower, upper) = (&entries[i][j], &entries[j][i]);
            let [a, b] = [lower, upper]
                .map(|entry| graph.copy(Some(&entry.graph), &[entry.root], &inputs)[0]);
            if graph.neg(a) == b {
                continue;
            }
            for point in systems::around(y0, |_| true) {
                let (value, mirror) = (upper.value(&point), lower.value(&point));
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
