//! The generator of the diffusion, applied to polynomials.

use std::collections::HashMap;

use super::{
    fields::Fields,
    polynomial::{Exponents, Polynomial, degree},
};

/// Lφ = f·∇φ + ½Σₘ fₘ·∇(fₘ·∇φ) = a·∇φ + ½Σᵢⱼ Aᵢⱼ ∂ᵢ∂ⱼφ with a = f + ½Σₘ fₘ′fₘ and
/// A = Σₘ fₘfₘᵀ, in x = y − y₀.
pub struct Generator {
    drift: Vec<Polynomial>,
    diffusion: Vec<Vec<Polynomial>>,
}

impl Generator {
    pub fn new(fields: &Fields) -> Self {
        let dimension = fields.drift.len();
        let mut drift = fields.drift.clone();
        let mut diffusion = vec![vec![Polynomial::default(); dimension]; dimension];
        for field in &fields.noises {
            for i in 0..dimension {
                for j in 0..dimension {
                    drift[i].add_product(0.5, &field[i].derivative(j), &field[j]);
                    diffusion[i][j].add_product(1.0, &field[i], &field[j]);
                }
            }
        }
        Self { drift, diffusion }
    }

    /// L x^α without the terms of a degree above `most`.
    fn of_monomial(&self, exponents: &[u8], most: usize) -> Polynomial {
        let mut sum = Polynomial::default();
        let lowered = |exponents: &[u8], i: usize| {
            let mut lower = exponents.to_vec();
            lower[i] = lower[i].checked_sub(1)?;
            Some((lower, f64::from(exponents[i])))
        };
        for i in 0..exponents.len() {
            let Some((once, n)) = lowered(exponents, i) else { continue };
            sum.add_multiple(&once, n, &self.drift[i], most);
            for j in 0..exponents.len() {
                if let Some((twice, other)) = lowered(&once, j) {
                    let factor = 0.5 * n * other;
                    sum.add_multiple(&twice, factor, &self.diffusion[i][j], most);
                }
            }
        }
        sum
    }

    /// (Lᵏφ)(y₀) for k = 0 … `applications` and every monomial φ = x^α given: row k is that of Lᵏ.
    ///
    /// L lowers degrees by two at most, so a term of a degree above 2k is zero at x = 0 after k
    /// more applications, and is left out. L of a monomial is computed once and serves all φ.
    pub fn powers(&self, functions: &[Exponents], applications: usize) -> Vec<Vec<f64>> {
        let mut monomials = Monomials::default();
        for exponents in functions {
            monomials.number(exponents);
        }
        // After `depth` applications of L those from `first` on are new, and each has its image.
        let (mut images, mut first) = (Vec::new(), 0);
        for depth in 0..applications {
            let new = first..monomials.all.len();
            first = new.end;
            for number in new {
                let exponents = monomials.all[number].clone();
                let image = self.of_monomial(&exponents, 2 * (applications - depth - 1));
                let term = |(exponents, c): (&[u8], f64)| (monomials.number(exponents), c);
                images.push(image.terms().map(term).collect::<Vec<_>>());
            }
        }
        // The values of Lᵏ of all of them; those that were met last count at k = 0 only.
        let at_zero = |exponents: &Exponents| f64::from(u8::from(degree(exponents) == 0));
        let mut values: Vec<f64> = monomials.all.iter().map(at_zero).collect();
        let mut powers = Vec::new();
        for _ in 0..=applications {
            powers.push(values[..functions.len()].to_vec());
            let sum = |image: &Vec<(usize, f64)>| image.iter().map(|&(n, c)| c * values[n]).sum();
            let next: Vec<f64> = images.iter().map(sum).collect();
            values[..next.len()].copy_from_slice(&next);
        }
        powers
    }
}

/// Monomials with numbers.
#[derive(Default)]
struct Monomials {
    numbers: HashMap<Exponents, usize>,
    all: Vec<Exponents>,
}

impl Monomials {
    fn number(&mut self, exponents: &[u8]) -> usize {
        if let Some(&number) = self.numbers.get(exponents) {
            return number;
        }
        self.numbers.insert(exponents.to_vec(), self.all.len());
        self.all.push(exponents.to_vec());
        self.all.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use systems::{Constant, Problem, RigidBody, paper::valid};

    use super::{super::polynomial::exponents_up_to, *};

    fn polynomial(terms: &[(f64, [u8; 2])]) -> Polynomial {
        let mut polynomial = Polynomial::default();
        terms.iter().for_each(|(c, exponents)| polynomial.add_term(exponents.to_vec(), *c));
        polynomial
    }

    #[test]
    fn the_generator_is_that_by_hand() {
        // dx₁ = −x₁dt + 2x₂∘dW, dx₂ = x₁²dt + 3∘dW: a = (−x₁ + 3, x₁²), A = (4x₂², 6x₂; 6x₂, 9).
        let generator = Generator::new(&Fields {
            drift: vec![polynomial(&[(-1.0, [1, 0])]), polynomial(&[(1.0, [2, 0])])],
            noises: vec![vec![polynomial(&[(2.0, [0, 1])]), polynomial(&[(3.0, [0, 0])])]],
        });
        // L x₁²x₂ = 2x₁x₂(3 − x₁) + x₁²·x₁² + ½(4x₂²·2x₂ + 2·6x₂·2x₁).
        let by_hand = polynomial(&[(18.0, [1, 1]), (-2.0, [2, 1]), (1.0, [4, 0]), (4.0, [0, 3])]);
        assert_eq!(generator.of_monomial(&[2, 1], 4), by_hand);
        assert_eq!(generator.of_monomial(&[2, 1], 2), polynomial(&[(18.0, [1, 1])]));
        assert_eq!(generator.of_monomial(&[0, 0], 9), Polynomial::default());
    }

    #[test]
    fn powers_are_those_of_the_generator_applied_in_turn() {
        let generator = Generator::new(&Fields {
            drift: vec![
                polynomial(&[(0.5, [0, 0]), (-1.0, [1, 1])]),
                polynomial(&[(1.0, [2, 0]), (0.25, [0, 0])]),
            ],
            noises: vec![
                vec![polynomial(&[(2.0, [0, 1]), (1.0, [0, 0])]), polynomial(&[(0.5, [1, 0])])],
                vec![polynomial(&[(1.0, [0, 2])]), polynomial(&[(-1.0, [0, 0])])],
            ],
        });
        let functions = exponents_up_to(2, 3);
        let powers = generator.powers(&functions, 4);
        for (n, exponents) in functions.iter().enumerate() {
            let mut image = Polynomial::default();
            image.add_term(exponents.clone(), 1.0);
            for power in &powers {
                assert!((power[n] - image.value(&[0.0; 2])).abs() < 1e-12, "{exponents:?}");
                let mut next = Polynomial::default();
                for (exponents, c) in image.terms() {
                    next.add_multiple(&[0, 0], c, &generator.of_monomial(exponents, 99), 99);
                }
                image = next;
            }
        }
        assert!(powers[4].iter().any(|value| value.abs() > 1.0));
    }

    #[test]
    fn means_of_linear_systems_are_exponentials() {
        // dy = (Ay)dt + By∘dW at y = y₀ + x: Lᵏy at y₀ is (A + ½B²)ᵏy₀.
        let (a, b, y0) = ([[0.5, -1.0], [2.0, 0.25]], [[0.0, 1.0], [-0.5, 2.0]], [1.5, -0.5]);
        let linear = |a: &[[f64; 2]; 2]| -> Vec<Polynomial> {
            let row = |[p, q]: &[f64; 2]| {
                polynomial(&[(p * y0[0] + q * y0[1], [0, 0]), (*p, [1, 0]), (*q, [0, 1])])
            };
            a.iter().map(row).collect()
        };
        let generator = Generator::new(&Fields { drift: linear(&a), noises: vec![linear(&b)] });
        let apply = |a: &[[f64; 2]; 2], y: [f64; 2]| a.map(|[p, q]| p * y[0] + q * y[1]);
        let powers = generator.powers(&[vec![1, 0], vec![0, 1]], 6);
        let mut y = y0;
        for power in &powers[1..] {
            let (drift, noise) = (apply(&a, y), apply(&b, apply(&b, y)));
            y = [drift[0] + 0.5 * noise[0], drift[1] + 0.5 * noise[1]];
            assert!(power.iter().zip(y).all(|(power, y)| (power - y).abs() < 1e-12), "{power:?}");
        }
        assert_eq!(powers[0], [0.0, 0.0]);
    }

    #[test]
    fn the_generator_of_the_rigid_body_is_that_by_hand() {
        // fₘ = kₘyₘ y × eₘ turns y about eₘ, hence fₘ′fₘ = −kₘ²yₘ²(y − yₘeₘ), and
        // L yᵢ = (y × y/I)ᵢ − γyᵢ − ½Σ_{m≠i} kₘ²yₘ²yᵢ.
        let (inertia, noise) = ([2.0, 1.0, 0.5], [1.0, 2.0, 4.0]);
        let body = valid(RigidBody::three_noises(inertia, noise));
        let y = [0.75, -0.5, 1.25];
        let problem = valid(Problem::new(body, valid(Constant::new(0.2)), y, 1.0));
        let formulas = mc::Problem::of(&problem).formulas;
        let fields = Fields::new(&*formulas, 3, 0.2, &y, 1.0).unwrap();
        let powers = Generator::new(&fields).powers(&exponents_up_to(3, 1)[1..], 1);
        for i in 0..3 {
            let (j, l) = ((i + 1) % 3, (i + 2) % 3);
            let drift = y[j] * y[l] * (1.0 / inertia[l] - 1.0 / inertia[j]) - 0.2 * y[i];
            let squares = (y[j] / noise[j]).powi(2) + (y[l] / noise[l]).powi(2);
            let by_hand = drift - 0.5 * squares * y[i];
            assert!((powers[1][i] - by_hand).abs() < 1e-14, "{i}: {} {by_hand}", powers[1][i]);
        }
        assert_eq!(fields.degree(), 2);
    }
}
