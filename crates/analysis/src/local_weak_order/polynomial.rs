//! Polynomials in several variables, as their terms.

use std::collections::BTreeMap;

/// The exponents α of a monomial x^α, one for each variable.
pub type Exponents = Vec<u8>;

/// |α|.
pub fn degree(exponents: &[u8]) -> usize {
    exponents.iter().map(|&n| usize::from(n)).sum()
}

/// All exponents with |α| ≤ `most`, those of lower degree first.
pub fn exponents_up_to(variables: usize, most: usize) -> Vec<Exponents> {
    let mut all = vec![vec![0; variables]];
    let mut last = all.clone();
    for _ in 0..most {
        let mut next = Vec::new();
        for exponents in &last {
            // One more of the last variable that is there, or of one after it: each set once.
            let first = exponents.iter().rposition(|&n| n > 0).unwrap_or(0);
            for i in first..variables {
                let mut more = exponents.clone();
                more[i] += 1;
                next.push(more);
            }
        }
        all.extend(next.iter().cloned());
        last = next;
    }
    all
}

/// Σ c_α x^α.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    terms: BTreeMap<Exponents, f64>,
}

impl Polynomial {
    /// The terms.
    pub fn terms(&self) -> impl Iterator<Item = (&[u8], f64)> {
        self.terms.iter().map(|(exponents, &coefficient)| (&exponents[..], coefficient))
    }

    /// The largest degree of a term.
    pub fn degree(&self) -> usize {
        self.terms().map(|(exponents, _)| degree(exponents)).max().unwrap_or(0)
    }

    /// Adds c x^α.
    pub fn add_term(&mut self, exponents: Exponents, coefficient: f64) {
        if coefficient != 0.0 {
            *self.terms.entry(exponents).or_insert(0.0) += coefficient;
        }
    }

    /// Adds c x^α times another polynomial, without the terms of a degree above `most`.
    pub fn add_multiple(&mut self, exponents: &[u8], c: f64, other: &Self, most: usize) {
        let own = degree(exponents);
        for (of_other, other) in other.terms() {
            if own + degree(of_other) <= most {
                let sum = exponents.iter().zip(of_other).map(|(a, b)| a + b).collect();
                self.add_term(sum, c * other);
            }
        }
    }

    /// Adds a multiple of the product of two polynomials.
    pub fn add_product(&mut self, factor: f64, one: &Self, other: &Self) {
        for (exponents, coefficient) in one.terms() {
            self.add_multiple(exponents, factor * coefficient, other, usize::MAX);
        }
    }

    /// Multiplies by a number.
    pub fn multiply(&mut self, factor: f64) {
        self.terms.values_mut().for_each(|c| *c *= factor);
    }

    /// The derivative in the variable number `i`.
    pub fn derivative(&self, i: usize) -> Self {
        let mut derivative = Self::default();
        for (exponents, coefficient) in self.terms().filter(|(exponents, _)| exponents[i] > 0) {
            let mut lower = exponents.to_vec();
            lower[i] -= 1;
            derivative.add_term(lower, coefficient * f64::from(exponents[i]));
        }
        derivative
    }

    /// The value at x.
    pub fn value(&self, x: &[f64]) -> f64 {
        let power = |(x, &n): (&f64, &u8)| x.powi(i32::from(n));
        let term =
            |(exponents, c): (&[u8], f64)| c * x.iter().zip(exponents).map(power).product::<f64>();
        self.terms().map(term).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial(terms: &[(f64, [u8; 2])]) -> Polynomial {
        let mut polynomial = Polynomial::default();
        terms.iter().for_each(|(c, exponents)| polynomial.add_term(exponents.to_vec(), *c));
        polynomial
    }

    #[test]
    fn exponents_are_all_of_them_once_by_degree() {
        let all = exponents_up_to(3, 4);
        assert_eq!(all.len(), 35);
        assert!(all.windows(2).all(|pair| degree(&pair[0]) <= degree(&pair[1])));
        let mut sorted = all.clone();
        sorted.sort();
        sorted.dedup();
        assert_eq!(sorted.len(), 35);
        assert_eq!(exponents_up_to(2, 1), [[0, 0], [1, 0], [0, 1]]);
        assert_eq!(exponents_up_to(5, 0), [[0; 5]]);
    }

    #[test]
    fn products_derivatives_and_values_are_those_by_hand() {
        // (2 + 3x)(x − y²) = 2x − 2y² + 3x² − 3xy².
        let one = polynomial(&[(2.0, [0, 0]), (3.0, [1, 0])]);
        let other = polynomial(&[(1.0, [1, 0]), (-1.0, [0, 2])]);
        let mut product = Polynomial::default();
        product.add_product(1.0, &one, &other);
        let by_hand = polynomial(&[(2.0, [1, 0]), (-2.0, [0, 2]), (3.0, [2, 0]), (-3.0, [1, 2])]);
        assert_eq!(product, by_hand);
        assert_eq!((product.degree(), Polynomial::default().degree()), (3, 0));
        assert_eq!(product.value(&[2.0, 3.0]), one.value(&[2.0, 3.0]) * (2.0 - 9.0));
        let slope = polynomial(&[(-4.0, [0, 1]), (-6.0, [1, 1])]);
        assert_eq!(product.derivative(1), slope);
        // −2xy²(x − y²) added.
        let mut sum = product.clone();
        sum.add_multiple(&[1, 2], -2.0, &other, 9);
        assert_eq!(sum.value(&[2.0, 3.0]), product.value(&[2.0, 3.0]) + 36.0 * 7.0);
        product.multiply(0.5);
        assert_eq!(product.value(&[2.0, 3.0]), 4.0 * (2.0 - 9.0));
        // Up to degree four that is −2x²y².
        let mut sum = Polynomial::default();
        sum.add_multiple(&[1, 2], -2.0, &other, 4);
        assert_eq!(sum, polynomial(&[(-2.0, [2, 2])]));
    }
}
