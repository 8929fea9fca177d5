//! Casimirs of B that are sums of logarithms of coordinates.

use real::Bounded;
use serde::Serialize;

use super::{
    algebra::{backward_error, dot, echelon, singular_vectors, size},
    casimirs::{Coefficients, Equations, UNKNOWNS, coefficient, readable, sum_of_terms},
    erased::System,
    finding::Finding,
    points::Points,
};

/// A Casimir Σ cᵢ ln|yᵢ|, as B of Lotka–Volterra systems has, with bᵢⱼyᵢyⱼ in row i and column j.
///
/// Exact flows keep it, see `schemes::Split`; schemes that keep quadratic Casimirs do not.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogarithmicCasimir {
    /// The formula with the coefficients of this system, to six digits: `ln y1` where y₁ > 0 at
    /// every point, else `ln|y1|`.
    pub formula: String,
    /// c.
    pub coefficients: Vec<f64>,
    /// A bound of the error of each coefficient.
    pub coefficient_error: f64,
    /// B∇C = 0, with these coefficients, times the product of the coordinates that occur.
    pub casimir: Finding,
}

impl LogarithmicCasimir {
    /// A basis of those that hold at all points. Coordinates that are Casimirs by themselves are
    /// left out: their logarithms are nothing new.
    pub(super) fn all(system: &dyn System, points: &Points) -> Vec<Self> {
        let d = system.dimension();
        let matrices = points.for_identities.iter().map(|y| (y, system.matrix(y)));
        let matrices: Vec<_> = matrices.collect();
        let moves = |j: &usize| {
            let mut column = matrices.iter().flat_map(|(_, b)| b).map(|row| row[*j]);
            column.any(|entry| entry.value.abs() > entry.error)
        };
        let moving: Vec<usize> = (0..d).filter(moves).collect();
        if moving.is_empty() || d > UNKNOWNS {
            return Vec::new();
        }
        let mut equations = Equations::default();
        for (y, b) in &matrices {
            let slopes = slopes(y, &moving);
            for row in b {
                let row = moving.iter().zip(&slopes).map(|(&j, &slope)| row[j] * slope);
                equations.push(&row.collect::<Vec<_>>());
            }
        }
        let (sigma, vectors) = singular_vectors(&equations.rows, moving.len());
        let entries = (equations.rows.len() * moving.len()) as f64;
        let error = equations.error + backward_error(1, 1) * entries.sqrt() * sigma[0];
        let zero = sigma.iter().filter(|s| **s <= error).count();
        let gap = sigma.iter().copied().filter(|s| *s > error).fold(f64::INFINITY, f64::min);
        let angle = (error / gap).max(f64::EPSILON) * (zero + 1) as f64;
        let solutions = echelon(vectors[moving.len() - zero..].to_vec());
        let candidates =
            solutions.into_iter().map(|x| Self::new(readable(x, angle), &moving, system, points));
        candidates.filter(|candidate| candidate.casimir.holds()).collect()
    }

    /// The sum with these coefficients of the coordinates `moving`.
    fn new(x: Coefficients, moving: &[usize], system: &dyn System, points: &Points) -> Self {
        let bounded: Vec<_> = x.values.iter().map(|&c| coefficient(c, x.error)).collect();
        let mut casimir = Finding::default();
        // The coefficients were fitted to the points for identities.
        let others = &points.for_suprema[points.random.min(points.for_suprema.len())..];
        for y in points.for_identities.iter().chain(others) {
            let gradient = bounded.iter().zip(slopes(y, moving)).map(|(&c, slope)| c * slope);
            let gradient: Vec<_> = gradient.collect();
            for row in system.matrix(y) {
                let row: Vec<_> = moving.iter().map(|&j| row[j]).collect();
                casimir.record(dot(&row, &gradient), size(&row, &gradient), y);
            }
        }
        let positive = |j: usize| points.for_identities.iter().all(|y| y[j] > 0.0);
        let symbol = |j: usize| match positive(j) {
            true => format!("ln y{}", j + 1),
            false => format!("ln|y{}|", j + 1),
        };
        let terms = moving.iter().zip(&x.values).map(|(&j, &c)| (c, symbol(j)));
        let formula = sum_of_terms(terms);
        let mut coefficients = vec![0.0; system.dimension()];
        moving.iter().zip(&x.values).for_each(|(&j, &c)| coefficients[j] = c);
        Self { formula, coefficients, coefficient_error: x.error, casimir }
    }
}

/// ∂ ln|y_j|/∂y_j = 1/y_j for each j of `moving`, times the product of these coordinates: so that a
/// polynomial remains one.
fn slopes(y: &[f64], moving: &[usize]) -> Vec<Bounded> {
    let product = |j: usize| {
        let others = moving.iter().filter(|&&k| k != j).map(|&k| Bounded::variable(y[k]));
        others.fold(Bounded::exact(1.0), |product, factor| product * factor)
    };
    moving.iter().map(|&j| product(j)).collect()
}

#[cfg(test)]
mod tests {
    use real::Real;
    use systems::{PoissonSystem, SystemError};

    use super::super::finding::Status;
    use crate::inspect;

    /// Two prey and a predator, b₁₂ = 1, b₁₃ = −2, b₂₃ = 1: bᵢⱼyᵢyⱼ has the Casimir Σ cᵢ ln yᵢ for
    /// bc = 0, which is c = (1, 2, 1). `twist` is a term of B that destroys it.
    struct ThreeSpecies {
        twist: f64,
        positive: bool,
    }

    impl PoissonSystem<3, 1> for ThreeSpecies {
        fn name(&self) -> &'static str {
            "three-species"
        }
        fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
            let a = y[0] * y[1] + y[2] * self.twist;
            let b = y[0] * y[2] * -2.0;
            let c = y[1] * y[2];
            [a * v[1] + b * v[2], c * v[2] - a * v[0], -(b * v[0]) - c * v[1]]
        }
        fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
            (y[0] + y[1] + y[2]) * dt + y[0] * dw[0]
        }
        fn check_domain(&self, y: [f64; 3]) -> Result<(), SystemError> {
            match (0..3).find(|&i| self.positive && y[i] <= 0.0) {
                None => Ok(()),
                Some(i) => {
                    let (component, value, domain) = (i + 1, y[i], "y > 0");
                    Err(SystemError::OutsideDomain { component, value, domain })
                }
            }
        }
    }

    #[test]
    fn sums_of_logarithms_are_found_and_wrong_ones_are_not() {
        for (positive, formula) in
            [(true, "ln y1 + 2 ln y2 + ln y3"), (false, "ln|y1| + 2 ln|y2| + ln|y3|")]
        {
            let report = inspect(&ThreeSpecies { twist: 0.0, positive }).unwrap();
            let [casimir] = &report.casimirs.logarithmic[..] else { panic!("{report}") };
            assert_eq!(
                (casimir.formula.as_str(), casimir.casimir.status),
                (formula, Status::Shown)
            );
            assert_eq!(casimir.coefficients, [1.0, 2.0, 1.0]);
            let text = report.to_string();
            for words in [
                format!("  and with logarithms: {formula}; B∇C = 0 shown"),
                "split alone keeps the Casimir with logarithms".into(),
                "split keeps every Casimir".into(),
            ] {
                assert!(text.contains(&words), "{words}: {text}");
            }
        }
        for twist in [1.0, 1e-9] {
            let report = inspect(&ThreeSpecies { twist, positive: true }).unwrap();
            assert!(report.casimirs.logarithmic.is_empty(), "{report}");
            assert!(!report.to_string().contains("split keeps"), "{report}");
        }
    }

    /// B = y₃J: y₃ is a Casimir, and its logarithm is nothing new.
    struct Clock;

    impl PoissonSystem<3, 1> for Clock {
        fn name(&self) -> &'static str {
            "clock"
        }
        fn structure<R: Real>(&self, y: [R; 3], v: [R; 3]) -> [R; 3] {
            [-(y[2] * v[1]), y[2] * v[0], R::zero()]
        }
        fn energy<R: Real>(&self, y: [R; 3], dt: f64, dw: [f64; 1]) -> R {
            (y[0] * y[0] + y[1] * y[1]) * (dt + dw[0])
        }
    }

    #[test]
    fn logarithms_of_linear_casimirs_are_left_out() {
        let report = inspect(&Clock).unwrap();
        assert_eq!(report.casimirs.found[0].formula, "y3");
        assert!(report.casimirs.logarithmic.is_empty(), "{report}");
    }
}
