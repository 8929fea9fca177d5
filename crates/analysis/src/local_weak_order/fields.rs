//! The vector fields of a system as polynomials, found from values.

use std::collections::BTreeMap;

use mc::Formulas;

use super::{
    LocalWeakOrderError,
    polynomial::{Exponents, Polynomial, degree, exponents_up_to},
};

/// f₀ = B∇H₀ − γy and fₘ = B∇Hₘ, each as a polynomial for every component, in x = y − y₀.
#[derive(Clone)]
pub struct Fields {
    pub drift: Vec<Polynomial>,
    pub noises: Vec<Vec<Polynomial>>,
}

/// The largest degree that is tried.
pub const MOST_DEGREE: usize = 6;
/// The nodes of interpolation in every variable, in units of the scale. Small integers, so that
/// differences of them are exact.
const NODES: [f64; MOST_DEGREE + 1] = [0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0];
/// Number of points at which a polynomial is compared with the field, and how far away they are, in
/// units of the scale.
const CHECKS: usize = 8;
const REACH: f64 = 4.0;
/// How far a polynomial may be from the field there, relative to the largest component. Rounding
/// errors of the coefficients grow by up to `REACH` to the power of the degree, 4096.
const AGREEMENT: f64 = 1e-10;
/// Coefficients c_α with |c_α|·scale^|α| below this fraction of the largest value of the field are
/// rounding errors of the interpolation, and dropped. A divided difference at integers has twice
/// the error of the values at most, and the products of (x − node) have coefficients up to 49.
const DROPPED: f64 = 256.0 * f64::EPSILON;

impl Fields {
    /// The fields about y₀, on the scale of states, a power of two. Where components of y₀ have few
    /// digits, points of interpolation are exact.
    ///
    /// # Errors
    /// [`LocalWeakOrderError::NotPolynomial`] if no polynomial of degree up to [`MOST_DEGREE`]
    /// agrees with a field.
    pub fn new(
        formulas: &dyn Formulas,
        noises: usize,
        gamma: f64,
        y0: &[f64],
        scale: f64,
    ) -> Result<Self, LocalWeakOrderError> {
        let dimension = y0.len();
        let field = |m: usize| {
            let (dt, mut dw) = (f64::from(u8::from(m == 0)), vec![0.0; noises]);
            if m > 0 {
                dw[m - 1] = 1.0;
            }
            let value = |x: &[f64]| {
                let y: Vec<f64> = y0.iter().zip(x).map(|(y, x)| y + scale * x).collect();
                formulas.field(&y, dt, &dw)
            };
            let found = polynomials(&value, dimension, scale);
            found.ok_or(LocalWeakOrderError::NotPolynomial { hamiltonian: m, most: MOST_DEGREE })
        };
        let mut drift = field(0)?;
        for (i, component) in drift.iter_mut().enumerate() {
            let mut unit = vec![0; dimension];
            component.add_term(unit.clone(), -gamma * y0[i]);
            unit[i] = 1;
            component.add_term(unit, -gamma);
        }
        Ok(Self { drift, noises: (1..=noises).map(field).collect::<Result<_, _>>()? })
    }

    /// The power of two by which noises are multiplied for ½Σ|fₘ|² to be about s|f|, with the size
    /// s of states; one if either is zero.
    pub fn balance(&self, scale: f64) -> f64 {
        let square = |field: &[Polynomial]| -> f64 {
            let origin = vec![0.0; field.len()];
            field.iter().map(|component| component.value(&origin).powi(2)).sum()
        };
        let noise: f64 = self.noises.iter().map(|field| 0.5 * square(field)).sum();
        let ratio = scale * square(&self.drift).sqrt() / noise;
        if ratio > 0.0 && ratio.is_finite() { (0.5 * ratio.log2()).round().exp2() } else { 1.0 }
    }

    /// The fields with noises multiplied by a number.
    pub fn amplified(&self, factor: f64) -> Self {
        let mut amplified = self.clone();
        amplified.noises.iter_mut().flatten().for_each(|component| component.multiply(factor));
        amplified
    }

    /// The largest degree of a field.
    pub fn degree(&self) -> usize {
        let all = self.noises.iter().flatten().chain(&self.drift);
        all.map(Polynomial::degree).max().unwrap_or(0)
    }
}

/// Components of a field at a point.
type Field<'a> = dyn Fn(&[f64]) -> Vec<f64> + 'a;

/// The polynomials of least degree that agree with a field; `value` is that field at scale·x.
fn polynomials(value: &Field<'_>, dimension: usize, scale: f64) -> Option<Vec<Polynomial>> {
    // Multiples of the golden ratio, modulo one, differ in every component.
    let golden = |number: usize| 2.0 * (number as f64 * 0.618_033_988_749_894_8).fract() - 1.0;
    let checks = (0..CHECKS).map(|n| {
        let x: Vec<f64> = (0..dimension).map(|i| REACH * golden(n * dimension + i + 1)).collect();
        let y = value(&x);
        (x, y)
    });
    let checks: Vec<(Vec<f64>, Vec<f64>)> = checks.collect();
    (0..=MOST_DEGREE).find_map(|degree| {
        let found = interpolated(value, dimension, degree);
        let agrees = checks.iter().all(|(x, y)| {
            let size = y.iter().fold(0.0, |size: f64, y| size.max(y.abs()));
            let close = |(p, y): (&Polynomial, &f64)| (p.value(x) - y).abs() <= AGREEMENT * size;
            found.iter().zip(y).all(close)
        });
        agrees.then(|| found.iter().map(|p| at_scale(p, scale)).collect())
    })
}

/// p(x/scale); the scale is a power of two.
fn at_scale(polynomial: &Polynomial, scale: f64) -> Polynomial {
    let mut scaled = Polynomial::default();
    for (exponents, c) in polynomial.terms() {
        scaled.add_term(exponents.to_vec(), c / scale.powi(degree(exponents) as i32));
    }
    scaled
}

/// The polynomials of this degree with the values of the field at the nodes (ν_{α₁}, …, ν_{α_D}),
/// |α| ≤ degree: there is one (Chung and Yao, *SIAM J. Numer. Anal.* 14, 1977). Newton's
/// differences along each variable give it.
fn interpolated(value: &Field<'_>, dimension: usize, most: usize) -> Vec<Polynomial> {
    let points = exponents_up_to(dimension, most);
    let numbers: BTreeMap<&Exponents, usize> =
        points.iter().enumerate().map(|(number, exponents)| (exponents, number)).collect();
    let node = |exponents: &Exponents| -> Vec<f64> {
        exponents.iter().map(|&n| NODES[usize::from(n)]).collect()
    };
    let mut values: Vec<Vec<f64>> = points.iter().map(|point| value(&node(point))).collect();
    let size = values.iter().flatten().fold(0.0, |size: f64, y| size.max(y.abs()));
    // Differences need lower points only and powers higher ones only, so that all differences come
    // before all powers.
    for change in [differences, powers] {
        for i in 0..dimension {
            // Lines along variable i, each from its point on the hyperplane 0 outwards.
            for start in points.iter().filter(|exponents| exponents[i] == 0) {
                let mut point = start.clone();
                let mut number = |n: usize| {
                    point[i] = n as u8;
                    numbers[&point]
                };
                let line: Vec<usize> = (0..=most - degree(start)).map(&mut number).collect();
                for component in 0..dimension {
                    change(&line, &mut values, component);
                }
            }
        }
    }
    let mut found = vec![Polynomial::default(); dimension];
    for (exponents, coefficients) in points.iter().zip(&values) {
        for (polynomial, &c) in found.iter_mut().zip(coefficients) {
            // A coefficient that is not a number stays, and agrees with nothing.
            if c.abs() <= DROPPED * size {
                continue;
            }
            polynomial.add_term(exponents.clone(), c);
        }
    }
    found
}

/// Replaces values at the nodes by Newton's divided differences.
fn differences(line: &[usize], values: &mut [Vec<f64>], i: usize) {
    for order in 1..line.len() {
        for n in (order..line.len()).rev() {
            let difference = values[line[n]][i] - values[line[n - 1]][i];
            values[line[n]][i] = difference / (NODES[n] - NODES[n - order]);
        }
    }
}

/// Replaces the coefficients of Π(x − ν_k), k < n, by those of xⁿ.
fn powers(line: &[usize], values: &mut [Vec<f64>], i: usize) {
    for k in (0..line.len() - 1).rev() {
        for n in k..line.len() - 1 {
            let above = values[line[n + 1]][i];
            values[line[n]][i] -= NODES[k] * above;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_found_from_values_with_no_term_more() {
        // 3 − 2x₁x₂² + x₃⁶/8 and 0.3x₂ on the scale ½.
        let value = |x: &[f64]| {
            let x: Vec<f64> = x.iter().map(|x| 0.5 * x).collect();
            vec![3.0 - 2.0 * x[0] * x[1] * x[1] + x[2].powi(6) / 8.0, 0.3 * x[1], 0.0]
        };
        let found = polynomials(&value, 3, 0.5).unwrap();
        let terms: Vec<Vec<(Vec<u8>, f64)>> =
            found.iter().map(|p| p.terms().map(|(e, c)| (e.to_vec(), c)).collect()).collect();
        let by_hand: [&[([u8; 3], f64)]; 3] =
            [&[([0, 0, 0], 3.0), ([0, 0, 6], 0.125), ([1, 2, 0], -2.0)], &[([0, 1, 0], 0.3)], &[]];
        for (terms, by_hand) in terms.iter().zip(by_hand) {
            assert_eq!(terms.len(), by_hand.len(), "{terms:?}");
            for ((exponents, c), (same, exact)) in terms.iter().zip(by_hand) {
                assert!(exponents == same && (c / exact - 1.0).abs() < 1e-13, "{terms:?}");
            }
        }
    }

    #[test]
    fn the_balance_makes_noise_as_strong_as_drift() {
        let constant = |c: f64| {
            let mut component = Polynomial::default();
            component.add_term(vec![0, 0], c);
            vec![component, Polynomial::default()]
        };
        let fields = Fields { drift: constant(3.0), noises: vec![constant(0.05), constant(0.05)] };
        // a²(0.05)² = 2·3 at a = 49, nearest to 2⁶ = 64 in a ratio.
        let balance = fields.balance(2.0);
        assert_eq!(balance, 64.0);
        assert_eq!(fields.amplified(balance).noises[1][0].value(&[0.0; 2]), 3.2);
        assert_eq!(Fields { noises: vec![], ..fields.clone() }.balance(2.0), 1.0);
        assert_eq!(Fields { drift: constant(0.0), ..fields }.balance(2.0), 1.0);
    }

    #[test]
    fn the_least_degree_is_taken() {
        let at = |degree: i32| {
            let value = move |x: &[f64]| vec![(1.3 * x[0] - x[1]).powi(degree) + 1.0, x[0]];
            polynomials(&value, 2, 1.0).map(|found| found[0].degree())
        };
        assert_eq!(
            [0, 1, 2, 3, 6, 7].map(at),
            [0, 1, 2, 3, 6, 7].map(|n| { (n <= 6).then_some(n as usize) })
        );
    }

    #[test]
    fn what_is_not_a_polynomial_has_none() {
        let fields: [fn(f64) -> f64; 4] = [f64::sin, f64::sqrt, |x| 1.0 / (3.3 + x), f64::abs];
        for field in fields {
            let value = |x: &[f64]| vec![x[1], field(x[0])];
            assert!(polynomials(&value, 2, 1.0).is_none());
        }
    }
}
