//! Linear and quadratic forms, and sums of terms as text.

use std::sync::Arc;

use mc::ConformalLaw;
use real::elementary::ln;
use serde::Serialize;

use super::{Matrix, dot, largest};

/// Form Σβᵢ ln|yᵢ|, βᵀy or ½yᵀQy, by degree.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Form {
    /// Degree: 0 for logarithms, 1 for a linear form, 2 for a quadratic form.
    pub degree: u32,
    /// Coefficients: β, or the rows of Q one after the other.
    pub coefficients: Vec<f64>,
}

impl Form {
    /// The rows of Q.
    pub(crate) fn matrix(&self) -> Matrix {
        let d = self.coefficients.len().isqrt();
        self.coefficients.chunks(d).map(<[f64]>::to_vec).collect()
    }

    /// The formula in y1, y2, … such as `2 y1 − y2`, coefficients to six decimals.
    pub fn formula(&self) -> String {
        let c = &self.coefficients;
        let d = if self.degree < 2 { c.len() } else { c.len().isqrt() };
        let mut terms: Vec<_> = (0..d)
            .map(|i| match (self.degree, i + 1) {
                (0, n) => (c[i], format!("ln|y{n}|")),
                (1, n) => (c[i], format!("y{n}")),
                (_, n) => (0.5 * c[i * d + i], format!("y{n}²")),
            })
            .collect();
        if self.degree == 2 {
            let products = places(d).filter(|(i, j)| i != j);
            let term = |(i, j)| (c[i * d + j], format!("y{} y{}", i + 1, j + 1));
            terms.extend(products.map(term));
        }
        let mut formula = String::new();
        for (coefficient, symbol) in terms {
            let sign = match (formula.is_empty(), coefficient < 0.0) {
                _ if coefficient == 0.0 => continue,
                (true, false) => "",
                (true, true) => "−",
                (false, false) => " + ",
                (false, true) => " − ",
            };
            let size = (coefficient.abs() * 1e6).round() / 1e6;
            let size = if size == 1.0 { String::new() } else { format!("{size} ") };
            formula += &format!("{sign}{size}{symbol}");
        }
        formula
    }

    /// Gradient at y; for logarithms, multiplied by the product of the components that occur.
    pub(crate) fn gradient(&self, y: &[f64]) -> Vec<f64> {
        match self.degree {
            0 => without_own(&self.coefficients, y),
            1 => self.coefficients.clone(),
            _ => self.coefficients.chunks(y.len()).map(|row| dot(row, y)).collect(),
        }
    }

    /// Law of a problem with this form as Casimir.
    pub fn law(&self, name: String) -> ConformalLaw<'_> {
        let value = Arc::new(|y: &[f64]| self.value(y));
        ConformalLaw { name, degree: self.degree.into(), casimir: true, value, decay: None }
    }

    /// The value at y.
    pub fn value(&self, y: &[f64]) -> f64 {
        match self.degree {
            0 => self.coefficients.iter().zip(y).map(|(c, y)| c * ln(y.abs())).sum(),
            degree => dot(&self.gradient(y), y) / f64::from(degree),
        }
    }
}

/// Vector of the cᵢ/yᵢ times the product of all yⱼ whose coefficients are not zero.
pub fn without_own(c: &[f64], y: &[f64]) -> Vec<f64> {
    let others = |i: usize| (0..c.len()).filter(move |&j| j != i && c[j] != 0.0).map(|j| y[j]);
    let entry = |i: usize| c[i] * others(i).product::<f64>();
    (0..c.len()).map(|i| if c[i] == 0.0 { 0.0 } else { entry(i) }).collect()
}

/// Index pairs (i, j), i ≤ j, of the entries of a symmetric matrix.
pub fn places(d: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..d).flat_map(move |i| (i..d).map(move |j| (i, j)))
}

/// The multiple of x whose smallest coefficient is ±1 and whose first one is positive. Coefficients
/// within `error` of zero or, relatively, of an integer are made exact.
pub fn readable(mut x: Vec<f64>, error: f64) -> Vec<f64> {
    let size = largest(&x);
    x.iter_mut().filter(|c| c.abs() <= error * size).for_each(|c| *c = 0.0);
    let smallest = x.iter().filter(|c| **c != 0.0).fold(f64::INFINITY, |m, c| m.min(c.abs()));
    let sign = x.iter().find(|c| **c != 0.0).map_or(1.0, |c| c.signum());
    let error = error * size / smallest;
    for c in &mut x {
        *c *= sign / smallest;
        if (*c - c.round()).abs() <= error {
            *c = c.round();
        }
    }
    x
}
