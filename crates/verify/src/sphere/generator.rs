//! The generator of the direction u = y/|y| in spherical harmonics.

use systems::{PoissonSystem, RigidBody};

use super::harmonics::{index, raising};

/// A skew-symmetric matrix: the entries c at (upper, lower) and −c at (lower, upper).
struct Skew(Vec<(usize, usize, f64)>);

impl Skew {
    fn apply(&self, q: &[f64]) -> Vec<f64> {
        let mut result = vec![0.0; q.len()];
        for &(lower, upper, c) in &self.0 {
            result[upper] += c * q[lower];
            result[lower] -= c * q[upper];
        }
        result
    }
}

/// The transposed generator L_tᵀ of u, cut off at some degree.
///
/// With the rotations R_j f = (e_j × u)·∇f about the axes, the field B∇H of H = ½Σ k_j u_j² is
/// −Σ k_j u_j R_j; u_j and R_j commute. Hence
///
/// L_t = −r Σ κ_j X_j + ½r² Σ k_j² X_j²,  X_j = u_j R_j,  κ_j = 1/I_j,  k_j = 1/Î_j.
///
/// From the textbook actions of u₃, u₁ ± iu₂ and of the ladder operators on Y_lm,
///
/// X₁ = −½Z + V,  X₂ = −½Z − V,  X₃ = Z,  all skew-symmetric, where
///
/// - Z takes h_lm to m √(((l+1)² − m²)/(4(l+1)² − 1)) h_{l+1,m}, minus the transpose of that,
/// - V takes h_lm to −β(l, m) h_{l+1,m+2} + β(l, −m) h_{l+1,m−2}, minus the transpose of that, with
///   β(l, m) = ¼ √((l+m+1)(l+m+2)(l+m+3)(l−m)/((2l+1)(2l+3))).
///
/// Cut off at degree N, they are still skew-symmetric, so the cut-off L_t is the sum of a
/// skew-symmetric and a negative semidefinite matrix: |q| cannot grow, whatever N. The noise
/// vanishes on the three axes, so L_t is degenerate there, and convergence in N is observed (the
/// tests pin it), not proved. For the weak problem of the paper an error falls by a factor of 10 or
/// more from N to N + 8, and more slowly for a start on an axis, where the law is a point mass.
pub struct Generator {
    z: Skew,
    v: Skew,
    /// Σ κ_j X_j = d₀Z + d₁V.
    drift: [f64; 2],
    /// Σ k_j² X_j² = s₀Z² + s₁(ZV + VZ) + s₂V².
    squares: [f64; 3],
}

/// (κ_j) and (k_j²): ∇H₀ and the squares of Σ∇Hₘ at (1, 1, 1).
fn coefficients<const M: usize>(body: &RigidBody<M>) -> [[f64; 3]; 2] {
    let noise = body.gradient([1.0; 3], 0.0, [1.0; M]);
    [body.gradient([1.0; 3], 1.0, [0.0; M]), noise.map(|k| k * k)]
}

/// A bound of ‖L_t‖ at the radius r for degree N: ‖X_j‖ ≤ (N + 1)/2 by Gershgorin's theorem for X₃
/// and by symmetry for the others.
pub fn norm_bound<const M: usize>(body: &RigidBody<M>, degree: usize, r: f64) -> f64 {
    let size = 0.5 * (degree + 1) as f64;
    let [drift, squares] = coefficients(body);
    let drift: f64 = drift.iter().map(|k| k.abs()).sum();
    let squares: f64 = squares.iter().sum();
    r * size * drift + 0.5 * r * r * size * size * squares
}

impl Generator {
    pub fn new<const M: usize>(body: &RigidBody<M>, degree: usize) -> Self {
        let (mut z, mut v) = (Vec::new(), Vec::new());
        for l in 0..degree {
            let n = l as i64;
            let beta = |m: i64| {
                let product = ((n + m + 1) * (n + m + 2) * (n + m + 3) * (n - m)) as f64;
                0.25 * (product / ((2 * n + 1) * (2 * n + 3)) as f64).sqrt()
            };
            for m in -n..=n {
                z.push((index(l, m), index(l + 1, m), m as f64 * raising(l + 1, m)));
                if m < n {
                    v.push((index(l, m), index(l + 1, m + 2), -beta(m)));
                }
                if m > -n {
                    v.push((index(l, m), index(l + 1, m - 2), beta(-m)));
                }
            }
        }
        let [drift, squares] = coefficients(body);
        Self {
            z: Skew(z),
            v: Skew(v),
            drift: [drift[2] - 0.5 * (drift[0] + drift[1]), drift[0] - drift[1]],
            squares: [
                squares[2] + 0.25 * (squares[0] + squares[1]),
                0.5 * (squares[1] - squares[0]),
                squares[0] + squares[1],
            ],
        }
    }

    /// L_tᵀq at the radius r.
    pub fn transposed(&self, r: f64, q: &[f64]) -> Vec<f64> {
        let (zq, vq) = (self.z.apply(q), self.v.apply(q));
        let [d0, d1] = self.drift.map(|d| d * r);
        let [s0, s1, s2] = self.squares.map(|s| 0.5 * r * r * s);
        let combine = |d: f64, a: f64, b: f64| -> Vec<f64> {
            (0..q.len()).map(|i| d * q[i] + a * zq[i] + b * vq[i]).collect()
        };
        let along = self.z.apply(&combine(d0, s0, s1));
        let across = self.v.apply(&combine(d1, s1, s2));
        along.iter().zip(across).map(|(a, b)| a + b).collect()
    }
}
