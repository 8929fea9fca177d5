//! Whether the noises commute, which decides the strong orders.

use real::Bounded;
use serde::Serialize;

use super::{
    algebra::{matrix_values, norm, size, times, values},
    erased::System,
    finding::Finding,
    points::{Points, Purpose, Random},
};

/// Commutators and products of the noise fields fₘ = B∇Hₘ.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Noises {
    /// [fₘ, f_l] = 0: strong order one needs no Lévy areas. Holds for one noise.
    pub commute: Finding,
    /// fₘ′f_l = 0: the Itô correction vanishes and Euler–Maruyama has strong order one.
    pub no_correction: Finding,
    /// `commutators` is Σ A_ml [fₘ, f_l].
    pub commutators: Finding,
    /// fₘ = 0 for every m: there is no noise.
    pub silent: Finding,
    /// Whether B or the energy may be made of pieces, with a root or a condition: orders are those
    /// of smooth formulas.
    pub pieces: bool,
    /// `commute` and `no_correction` at y₀ and on pilot paths, which may stay where they hold.
    #[serde(skip)]
    pub(super) on_paths: [Finding; 2],
}

impl Noises {
    pub(super) fn of(system: &dyn System, points: &Points) -> Self {
        let (noises, d) = (system.noises(), system.dimension());
        let zero = Bounded::exact(0.0);
        let mut found = Self::default();
        let mut random = Random::new(Purpose::Areas);
        let extent = points.extent();
        for (n, y) in points.for_identities.iter().enumerate() {
            let on_path = points.on_path(n);
            found.pieces |= system.piecewise(y);
            let (fields, derivatives): (Vec<_>, Vec<_>) =
                (1..=noises).map(|m| system.field(y, &system.weights(m))).unzip();
            // ‖B‖‖∇Hₘ‖: a field may vanish to round-off.
            let b = norm(&matrix_values(&system.matrix(y)).concat());
            let length = |m| b * norm(&values(&system.hamiltonian(m).gradient(y)));
            let lengths: Vec<f64> = (1..=noises).map(length).collect();
            let mut areas = vec![vec![0.0; noises]; noises];
            let (mut sum, mut sizes) = (vec![zero; d], vec![0.0; d]);
            for l in 0..noises {
                for &component in &fields[l] {
                    found.silent.record(component, lengths[l], y);
                }
                for m in 0..noises {
                    let product = times(&derivatives[l], &fields[m]);
                    // The size of a derivative of fields that are not nearly constant.
                    let typical = lengths[l] * lengths[m] / extent;
                    for i in 0..d {
                        let terms = size(&derivatives[l][i], &fields[m]);
                        found.no_correction.record(product[i], terms + typical, y);
                        if on_path {
                            found.on_paths[1].record(product[i], terms + typical, y);
                        }
                    }
                    if m < l {
                        let exchanged = times(&derivatives[m], &fields[l]);
                        areas[m][l] = random.uniform();
                        areas[l][m] = -areas[m][l];
                        for i in 0..d {
                            let commutator = product[i] - exchanged[i];
                            let terms = size(&derivatives[l][i], &fields[m])
                                + size(&derivatives[m][i], &fields[l]);
                            found.commute.record(commutator, terms + typical, y);
                            if on_path {
                                found.on_paths[0].record(commutator, terms + typical, y);
                            }
                            sizes[i] += terms + typical;
                            sum[i] = sum[i] + commutator * Bounded::exact(areas[m][l]);
                        }
                    }
                }
            }
            if noises > 1 {
                let given = system.commutators(y, &areas);
                for i in 0..d {
                    found.commutators.record(given[i] - sum[i], sizes[i], y);
                }
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::tests::by_hand::{ByHand, Given, Slope, at, close, exact},
        *,
    };

    #[test]
    fn commutators_are_compared_with_the_size_of_their_terms() {
        // f₁ = (1, 0) with f₁′ = (0 1; 0 0) and f₂ = (0, 1), constant: [f₁, f₂] = −f₁′f₂.
        let slope: [Slope; 3] =
            [|_| exact(&[0.0; 2]), |_| exact(&[3.0, 4.0]), |_| exact(&[0.0, 2.0])];
        let given = |m: usize| Given {
            value: |_| Bounded::exact(0.0),
            gradient: slope[m],
            hessian: |_| unreachable!(),
        };
        let system = ByHand {
            hamiltonians: vec![given(0), given(1), given(2)],
            structure: |_, v| vec![v[1], -v[0]],
            field: |weights| {
                let (zero, moves) = (exact(&[0.0; 2]), exact(&[0.0, 1.0]));
                match weights[1] {
                    1.0 => (exact(&[1.0, 0.0]), vec![moves, zero]),
                    _ => (exact(&[0.0, 1.0]), vec![zero.clone(), zero]),
                }
            },
            commutators: |areas| exact(&[-areas[0][1], 0.0]),
            ..ByHand::default()
        };
        let found = Noises::of(&system, &at(&[&[3.0, 4.0]]));
        // ‖B‖‖∇H‖ = 5√2 and 2√2; their product over the extent five is 4, and with itself 10.
        assert!(close(found.silent.scale, 50f64.sqrt()) && found.silent.defect == 1.0);
        assert!(close(found.no_correction.scale, 10.0) && found.no_correction.defect == 1.0);
        assert!(close(found.commute.scale, 5.0) && found.commute.defect == 1.0, "{found:?}");
        assert!(found.commutators.holds() && close(found.commutators.scale, 5.0), "{found:?}");
        assert!(found.on_paths.iter().all(|finding| finding.points == 0));
        let wrong = ByHand { commutators: |areas| exact(&[areas[0][1], 0.0]), ..system };
        assert!(Noises::of(&wrong, &at(&[&[3.0, 4.0]])).commutators.refuted());
    }
}
