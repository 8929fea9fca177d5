//! Iterated integrals of one path from its increment and its Lévy areas.

/// The iterated Stratonovich integrals J_ij = ∫₀ʰ∫₀ˢ ∘dW_i(r) ∘dW_j(s): J = ½WWᵀ + A.
///
/// ```
/// // W₁ moves before W₂, so J₁₂ is large and J₂₁ is zero.
/// let j = noise::stratonovich([1.0, 1.0], [[0.0, 0.5], [-0.5, 0.0]]);
/// assert_eq!(j, [[0.5, 1.0], [0.0, 0.5]]);
/// ```
#[inline(always)]
pub fn stratonovich<const M: usize>(dw: [f64; M], areas: [[f64; M]; M]) -> [[f64; M]; M] {
    let mut integrals = areas;
    for i in 0..M {
        for j in 0..M {
            integrals[i][j] += 0.5 * (dw[i] * dw[j]);
        }
    }
    integrals
}

/// The iterated Itô integrals I_ij = ∫₀ʰ∫₀ˢ dW_i(r) dW_j(s) over a step h: I = J − ½h·Id.
#[inline(always)]
pub fn ito<const M: usize>(dw: [f64; M], areas: [[f64; M]; M], step: f64) -> [[f64; M]; M] {
    let mut integrals = stratonovich(dw, areas);
    for i in 0..M {
        integrals[i][i] -= 0.5 * step;
    }
    integrals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integration_by_parts() {
        let (dw, step) = ([0.5, -2.0, 0.25], 0.125);
        let areas = [[0.0, 0.375, -1.0], [-0.375, 0.0, 2.0], [1.0, -2.0, 0.0]];
        let (j, i) = (stratonovich(dw, areas), ito(dw, areas, step));
        for a in 0..3 {
            for b in 0..3 {
                // J_ab + J_ba = W_a W_b, ½(J_ab − J_ba) = A_ab, and Itô's formula; all exact in
                // floating point.
                assert_eq!(j[a][b] + j[b][a], dw[a] * dw[b]);
                assert_eq!(0.5 * (j[a][b] - j[b][a]), areas[a][b]);
                assert_eq!(i[a][b] + i[b][a], dw[a] * dw[b] - if a == b { step } else { 0.0 });
            }
        }
    }
}
