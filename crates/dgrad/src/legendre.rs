//! Gauss–Legendre rules on [0, 1]. The functions are `const`, so kernels contain nodes as literals.

use std::fmt;

/// The largest number of nodes of a [`Rule`].
pub const MAX_NODES: usize = 512;

/// A number of quadrature nodes that is zero or exceeds [`MAX_NODES`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct QuadratureError {
    /// The requested number.
    pub nodes: usize,
}

impl fmt::Display for QuadratureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a Gauss-Legendre rule has 1 to {MAX_NODES} nodes, got {}", self.nodes)
    }
}

impl std::error::Error for QuadratureError {}

/// The smallest number of nodes that integrates polynomials of the given degree exactly:
/// ⌈(degree + 1)/2⌉.
pub const fn nodes_for_degree(degree: usize) -> usize {
    (degree + 2) / 2
}

/// The nodes and weights of the N-point rule on [0, 1], at compile time.
pub const fn fixed_rule<const N: usize>() -> ([f64; N], [f64; N]) {
    let (mut nodes, mut weights) = ([0.0; N], [0.0; N]);
    let mut i = 0;
    while i < N {
        let (node, weight) = node(N, i);
        nodes[i] = node;
        weights[i] = weight;
        i += 1;
    }
    (nodes, weights)
}

/// A Gauss–Legendre rule on [0, 1] with n nodes, chosen at run time: Σ wᵢ f(ηᵢ) = ∫₀¹ f for
/// polynomials f of degree at most 2n − 1.
///
/// Newton's method on the Legendre polynomial computes the nodes, accurate to round-off.
#[derive(Clone, Debug)]
pub struct Rule {
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl Rule {
    /// The rule with n nodes.
    ///
    /// # Errors
    /// [`QuadratureError`] unless 1 ≤ n ≤ [`MAX_NODES`].
    pub fn new(n: usize) -> Result<Self, QuadratureError> {
        if n == 0 || n > MAX_NODES {
            return Err(QuadratureError { nodes: n });
        }
        let (nodes, weights) = (0..n).map(|i| node(n, i)).unzip();
        Ok(Self { nodes, weights })
    }

    /// The nodes in (0, 1), increasing.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// The weights, which sum to 1.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// (b − a) Σ wᵢ f(a + (b − a)ηᵢ) ≈ ∫ₐᵇ f.
    pub fn integrate(&self, a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
        let length = b - a;
        let sum: f64 = self
            .nodes
            .iter()
            .zip(&self.weights)
            .map(|(&eta, &weight)| weight * f(a + length * eta))
            .sum();
        sum * length
    }
}

/// Newton's method starts within 1e-3 of the root and converges quadratically: four steps suffice,
/// and two more are cheap.
const NEWTON_STEPS: usize = 6;

/// The i-th of n nodes, and its weight.
const fn node(n: usize, i: usize) -> (f64, f64) {
    // By symmetry the root number i from the left is minus the root number i from the right.
    let from_right = if 2 * i < n { i } else { n - 1 - i };
    let mut x = if 2 * i + 1 == n { 0.0 } else { root_guess(n, from_right) };
    let mut step = 0;
    while step < NEWTON_STEPS {
        let (value, slope) = legendre(n, x);
        if 2 * i + 1 != n {
            x -= value / slope;
        }
        step += 1;
    }
    let (_, slope) = legendre(n, x);
    let weight = 1.0 / ((1.0 - x * x) * slope * slope);
    let node = if 2 * i < n { 0.5 - 0.5 * x } else { 0.5 + 0.5 * x };
    (node, weight)
}

/// cos(π(i + ¾)/(n + ½)), an approximation of the i-th root of Pₙ from the right.
const fn root_guess(n: usize, i: usize) -> f64 {
    let angle = std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5);
    // The Taylor series of the cosine; angles are at most π/2.
    let (mut sum, mut term, mut k) = (1.0, 1.0, 0.0);
    while k < 20.0 {
        term *= -angle * angle / ((2.0 * k + 1.0) * (2.0 * k + 2.0));
        sum += term;
        k += 1.0;
    }
    sum
}

/// Pₙ(x) and Pₙ′(x) for |x| < 1, by the three-term recurrence.
const fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut before, mut value) = (1.0, x);
    let mut k = 1;
    while k < n {
        let next = ((2 * k + 1) as f64 * x * value - k as f64 * before) / (k + 1) as f64;
        before = value;
        value = next;
        k += 1;
    }
    (value, n as f64 * (before - x * value) / (1.0 - x * x))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_integrates_its_degree_exactly_and_no_more() {
        for n in [1, 2, 3, 5, 8, 16, 33, 64] {
            let rule = Rule::new(n).unwrap();
            assert!(rule.nodes().windows(2).all(|pair| pair[0] < pair[1]));
            for degree in 0..2 * n {
                let integral = rule.integrate(0.0, 1.0, |x| x.powi(degree as i32));
                let exact = 1.0 / (degree as f64 + 1.0);
                // n terms with a few roundings each.
                assert!(
                    (integral - exact).abs() < (8.0 + n as f64) * f64::EPSILON,
                    "{n} {degree}: {integral}"
                );
            }
            if n <= 8 {
                // Error of x^{2n}: (n!)⁴/((2n+1) ((2n)!)²), far above round-off for these n.
                let mut error = 1.0;
                for k in 1..=n {
                    error *= (k * k) as f64 / ((n + k) as f64 * (n + k) as f64);
                }
                error /= (2 * n + 1) as f64;
                let integral = rule.integrate(0.0, 1.0, |x| x.powi(2 * n as i32));
                let measured = 1.0 / (2.0 * n as f64 + 1.0) - integral;
                assert!((measured / error - 1.0).abs() < 1e-4, "{n}: {measured} {error}");
            }
        }
    }

    #[test]
    fn the_largest_rule_is_still_accurate() {
        let rule = Rule::new(MAX_NODES).unwrap();
        assert!((rule.weights().iter().sum::<f64>() - 1.0).abs() < 1e-13);
        // ∫₀¹ cos(300 x) dx = sin(300)/300.
        let integral = rule.integrate(0.0, 1.0, |x| (300.0 * x).cos());
        assert!((integral - 300f64.sin() / 300.0).abs() < 1e-14);
    }

    #[test]
    fn impossible_rules_are_refused() {
        assert_eq!(Rule::new(0).unwrap_err(), QuadratureError { nodes: 0 });
        assert!(Rule::new(513).unwrap_err().to_string().contains("got 513"));
    }
}
