//! B(y): skew symmetry, constancy, the Jacobi identity.

use real::Bounded;
use serde::Serialize;

use super::{
    algebra::{Matrix, largest, matrix_values, times},
    erased::System,
    finding::{Finding, Status},
    points::{Points, Purpose, Random},
};

/// Properties of the structure matrix B(y).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Structure {
    /// `structure(y, v)` = B(y)v is linear in v.
    pub linear: Finding,
    /// Bᵢⱼ + Bⱼᵢ = 0.
    pub skew: Finding,
    /// ∂B = 0, and B is the same at all points: it may jump.
    pub constant: Finding,
    /// The Jacobi identity Σ_l Bᵢ_l ∂_l Bⱼₖ + cyclic = 0, which makes B a Poisson structure. No
    /// scheme and no theorem of the paper needs it.
    pub jacobi: Finding,
}

impl Structure {
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let mut found = Self::default();
        let d = system.dimension();
        let mut random = Random::new(Purpose::Vectors);
        let first = system.matrix(&points.for_identities[0]);
        for y in &points.for_identities {
            let (b, derivatives) = (system.matrix(y), system.matrix_derivatives(y));
            let v: Vec<_> = (0..d).map(|_| Bounded::variable(3.0 * random.uniform())).collect();
            found.linear.compare(&system.structure(y, &v), &times(&b, &v), y);
            let scale = largest(&matrix_values(&b).concat())
                * largest(&matrix_values(&derivatives.concat()).concat());
            for i in 0..d {
                for j in 0..=i {
                    let size = b[i][j].value.abs() + b[j][i].value.abs();
                    found.skew.record(b[i][j] + b[j][i], size, y);
                }
                for j in 0..d {
                    let size = b[i][j].value.abs() + first[i][j].value.abs();
                    found.constant.record(b[i][j] - first[i][j], size, y);
                    for slope in &derivatives {
                        found.constant.record(slope[i][j], b[i][j].value.abs(), y);
                    }
                }
                for (j, k) in (0..i).flat_map(|j| (0..j).map(move |k| (j, k))) {
                    found.jacobi.record(jacobiator(&b, &derivatives, [i, j, k]), scale, y);
                }
            }
        }
        found
    }

    /// How it is known that B(y)v is linear in v and B skew-symmetric.
    pub(super) fn sound(&self) -> Status {
        self.linear.status.min(self.skew.status)
    }
}

/// Σ_l Bᵢ_l ∂_l Bⱼₖ + Bⱼ_l ∂_l Bₖᵢ + Bₖ_l ∂_l Bᵢⱼ.
fn jacobiator(
    b: &Matrix<Bounded>,
    derivatives: &[Matrix<Bounded>],
    [i, j, k]: [usize; 3],
) -> Bounded {
    derivatives.iter().enumerate().fold(Bounded::exact(0.0), |sum, (l, d)| {
        sum + b[i][l] * d[j][k] + b[j][l] * d[k][i] + b[k][l] * d[i][j]
    })
}

#[cfg(test)]
mod tests {
    use super::{
        super::tests::by_hand::{ByHand, at, exact},
        *,
    };

    #[test]
    fn properties_of_b_are_compared_with_the_size_of_their_terms() {
        // b₁₂ = 2 and b₂₃ = 5, of which ∂₂b₂₃ = 3 is said; b₃₃ is y₁ − 1.
        let system = ByHand {
            dimension: 3,
            structure: |y, v| {
                let [a, b, c] = [v[0], v[1], v[2]];
                let [two, five] = [2.0, 5.0].map(Bounded::exact);
                let last = c * Bounded::exact(y[0] - 1.0);
                vec![b * two, c * five - a * two, last - b * five]
            },
            slopes: |_| {
                let none = vec![exact(&[0.0; 3]); 3];
                let some =
                    vec![exact(&[0.0; 3]), exact(&[0.0, 0.0, 3.0]), exact(&[0.0, -3.0, 0.0])];
                vec![none.clone(), some, none]
            },
            ..ByHand::default()
        };
        let found = Structure::of(&system, &at(&[&[1.0, 0.0, 0.0]]));
        assert!(found.linear.holds() && found.linear.scale > 1.0 && found.skew.defect == 0.0);
        assert_eq!((found.skew.scale, found.constant.scale), (10.0, 10.0));
        assert_eq!(found.constant.defect, 3.0);
        // Σ_l b₃_l ∂_l b₂₁ + b₂_l ∂_l b₁₃ + b₁_l ∂_l b₃₂ = 2·(−3), of terms up to 5·3.
        assert_eq!((found.jacobi.defect, found.jacobi.scale), (6.0, 15.0));
        assert_eq!(found.sound(), Status::Found);
        // The diagonal counts twice in bᵢᵢ + bᵢᵢ, and once in what changes.
        let found = Structure::of(&system, &at(&[&[1.0, 0.0, 0.0], &[8.0, 0.0, 0.0]]));
        assert_eq!((found.skew.defect, found.constant.defect), (14.0, 7.0));
        assert_eq!((found.skew.scale, found.sound()), (14.0, Status::Refuted));
    }
}
