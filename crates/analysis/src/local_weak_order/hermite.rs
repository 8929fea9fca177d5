//! Gauss–Hermite rules for normal variables.

/// Nodes and weights with Σ wᵢ f(xᵢ) = E[f(X)], X ~ N(0, 1), for polynomials f of degree at most
/// 2n − 1. Nodes increase, and lie symmetric about zero to the bit.
pub struct Rule {
    pub nodes: Vec<f64>,
    pub weights: Vec<f64>,
}

/// Halvings of an interval between roots, far more than there are digits.
const HALVINGS: usize = 80;

impl Rule {
    /// The rule with n ≥ 1 nodes: the roots of the Hermite polynomial hₙ, each between two roots of
    /// hₙ₋₁ and found by bisection. The weights are 1/(n hₙ₋₁(xᵢ)²), for orthonormal polynomials
    /// (Gautschi, *Orthogonal Polynomials*, 2004, §1.4).
    pub fn new(n: usize) -> Self {
        let mut nodes = vec![0.0];
        for degree in 2..=n {
            // All roots are within 2√n (Szegő, *Orthogonal Polynomials*, 1939, §6.31).
            let bound = 2.0 * (degree as f64).sqrt();
            let between: Vec<f64> = [-bound].into_iter().chain(nodes).chain([bound]).collect();
            let root = |i: usize| {
                let mirrored = between.len() - 2 - i;
                match i.cmp(&mirrored) {
                    std::cmp::Ordering::Less => root(degree, between[i], between[i + 1]),
                    std::cmp::Ordering::Equal => 0.0,
                    std::cmp::Ordering::Greater => {
                        -root(degree, between[mirrored], between[mirrored + 1])
                    }
                }
            };
            nodes = (0..degree).map(root).collect();
        }
        let weight = |&x: &f64| 1.0 / (n as f64 * hermite(n - 1, x).powi(2));
        Self { weights: nodes.iter().map(weight).collect(), nodes }
    }

    /// The tensor grid for `count` independent variables: a weight and a point each.
    pub fn grid(&self, count: usize) -> Vec<(f64, Vec<f64>)> {
        let mut grid = vec![(1.0, Vec::new())];
        for _ in 0..count {
            let extended = |(weight, point): &(f64, Vec<f64>)| {
                let (weight, point) = (*weight, point.clone());
                self.nodes.iter().zip(&self.weights).map(move |(&x, w)| {
                    let mut point = point.clone();
                    point.push(x);
                    (weight * w, point)
                })
            };
            grid = grid.iter().flat_map(extended).collect();
        }
        grid
    }
}

/// The root of the polynomial between two numbers.
fn root(degree: usize, mut lower: f64, mut upper: f64) -> f64 {
    let negative = hermite(degree, lower) < 0.0;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (lower + upper);
        match (hermite(degree, middle) < 0.0) == negative {
            true => lower = middle,
            false => upper = middle,
        }
    }
    0.5 * (lower + upper)
}

/// The orthonormal Hermite polynomial: √(k+1) h_{k+1} = x h_k − √k h_{k−1}.
fn hermite(degree: usize, x: f64) -> f64 {
    let (mut before, mut value) = (0.0, 1.0);
    for k in 0..degree {
        let next = (x * value - (k as f64).sqrt() * before) / (k as f64 + 1.0).sqrt();
        before = value;
        value = next;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_has_the_moments_of_a_normal_variable_up_to_its_degree_and_no_more() {
        for n in 1..=12 {
            let rule = Rule::new(n);
            assert!(rule.nodes.windows(2).all(|pair| pair[0] < pair[1]));
            let mut exact = 1.0;
            for k in 0..n {
                let moment = |degree: usize| -> f64 {
                    let nodes = rule.nodes.iter().zip(&rule.weights);
                    nodes.map(|(x, weight)| weight * x.powi(degree as i32)).sum()
                };
                assert!((moment(2 * k) / exact - 1.0).abs() < 1e-13, "{n} {k}: {exact}");
                assert!(moment(2 * k + 1).abs() < 1e-13 * exact, "{n} {k}");
                exact *= 2.0 * k as f64 + 1.0;
            }
            // The moment of degree 2n is too small by n!.
            let nodes = rule.nodes.iter().zip(&rule.weights);
            let moment: f64 = nodes.map(|(x, weight)| weight * x.powi(2 * n as i32)).sum();
            let factorial: f64 = (1..=n).map(|k| k as f64).product();
            assert!(((exact - moment) / factorial - 1.0).abs() < 1e-8, "{n}: {moment}");
        }
    }

    #[test]
    fn small_rules_are_the_textbook_ones_and_symmetric() {
        let rule = Rule::new(3);
        assert!((rule.nodes[2] - 3f64.sqrt()).abs() < 1e-15);
        assert!((rule.weights[0] - 1.0 / 6.0).abs() < 1e-15);
        for n in [4, 7, 10] {
            let rule = Rule::new(n);
            let mirrored: Vec<f64> = rule.nodes.iter().rev().map(|x| -x).collect();
            assert_eq!(rule.nodes, mirrored);
        }
    }

    #[test]
    fn a_grid_has_the_moments_of_independent_variables() {
        let grid = Rule::new(3).grid(3);
        assert_eq!(grid.len(), 27);
        let mean = |f: fn(&[f64]) -> f64| grid.iter().map(|(w, x)| w * f(x)).sum::<f64>();
        assert!((mean(|x| x[0].powi(4) * x[1].powi(2) * x[2].powi(4)) - 9.0).abs() < 1e-13);
        assert!(mean(|x| x[0].powi(3) * x[2]).abs() < 1e-14);
        assert_eq!(Rule::new(5).grid(0), [(1.0, Vec::new())]);
    }
}
