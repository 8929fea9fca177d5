//! Systems and functions whose answers are given one by one: what a check makes of them, with
//! which scale and which bound of the error, can then be computed by hand.

use std::cell::RefCell;

use real::Bounded;
use systems::{Invariant, Linearity};

use crate::inspect::{
    Override, WithoutIteration,
    algebra::Matrix,
    erased::{Function, System},
    points::{Points, Region},
};

/// Numbers without errors.
pub fn exact(row: &[f64]) -> Vec<Bounded> {
    row.iter().map(|&x| Bounded::exact(x)).collect()
}

/// A number with a bound of its error.
pub fn within(value: f64, error: f64) -> Bounded {
    Bounded { error, ..Bounded::variable(value) }
}

/// Whether two numbers agree up to some roundings.
pub fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b.abs()
}

/// These points, everywhere in the domain, for identities and for suprema.
pub fn at(points: &[&[f64]]) -> Points {
    let points: Vec<_> = points.iter().map(|y| y.to_vec()).collect();
    Points {
        region: Region::Box(1.0),
        random: points.len(),
        for_identities: points.clone(),
        for_suprema: points,
        everywhere: true,
        pilot: None,
    }
}

pub type Slope = fn(&[f64]) -> Vec<Bounded>;

/// A function whose value, gradient and Hessian are given.
#[derive(Clone, Copy)]
pub struct Given {
    pub value: fn(&[f64]) -> Bounded,
    pub gradient: Slope,
    pub hessian: fn(&[f64]) -> Matrix<Bounded>,
}

impl Function for Given {
    fn value(&self, y: &[f64]) -> Bounded {
        (self.value)(y)
    }
    fn gradient(&self, y: &[f64]) -> Vec<Bounded> {
        (self.gradient)(y)
    }
    fn hessian(&self, y: &[f64]) -> Matrix<Bounded> {
        (self.hessian)(y)
    }
}

/// Σ wₘHₘ, none of which is said to bend.
struct Sum<'a>(Vec<f64>, &'a [Given]);

impl Sum<'_> {
    fn terms(&self) -> impl Iterator<Item = (Bounded, &Given)> {
        self.0.iter().map(|&w| Bounded::exact(w)).zip(self.1)
    }
}

impl Function for Sum<'_> {
    fn value(&self, y: &[f64]) -> Bounded {
        self.terms().fold(Bounded::exact(0.0), |sum, (w, h)| sum + h.value(y) * w)
    }
    fn gradient(&self, y: &[f64]) -> Vec<Bounded> {
        let add = |sum: Vec<Bounded>, (w, h): (Bounded, &Given)| {
            sum.iter().zip(h.gradient(y)).map(|(&x, g)| x + g * w).collect()
        };
        self.terms().fold(exact(&vec![0.0; y.len()]), add)
    }
    fn hessian(&self, y: &[f64]) -> Matrix<Bounded> {
        vec![exact(&vec![0.0; y.len()]); y.len()]
    }
}

type Averages = [Vec<Bounded>; 2];
type Field = (Vec<Bounded>, Matrix<Bounded>);

/// A system whose answers are given; what is not given must not be asked.
pub struct ByHand {
    pub dimension: usize,
    pub hamiltonians: Vec<Given>,
    pub inside: fn(&[f64]) -> bool,
    pub structure: fn(&[f64], &[Bounded]) -> Vec<Bounded>,
    pub slopes: fn(&[f64]) -> Vec<Matrix<Bounded>>,
    pub averages: fn(&[f64], &[f64], &[f64]) -> Averages,
    pub predict: fn(&[f64]) -> (Vec<f64>, f64),
    pub field: fn(&[f64]) -> Field,
    pub commutators: fn(&Matrix) -> Vec<Bounded>,
    /// The points and weights of the averages, then those of the predictions.
    pub averaged: RefCell<Vec<[Vec<f64>; 3]>>,
    pub predicted: RefCell<Vec<[Vec<f64>; 2]>>,
}

impl Default for ByHand {
    fn default() -> Self {
        Self {
            dimension: 2,
            hamiltonians: Vec::new(),
            inside: |_| true,
            structure: |_, _| unreachable!("B"),
            slopes: |_| unreachable!("B′"),
            averages: |_, _, _| unreachable!("averages"),
            predict: |_| unreachable!("predict"),
            field: |_| unreachable!("field"),
            commutators: |_| unreachable!("commutators"),
            averaged: RefCell::default(),
            predicted: RefCell::default(),
        }
    }
}

impl System for ByHand {
    fn name(&self) -> &'static str {
        "by hand"
    }
    fn dimension(&self) -> usize {
        self.dimension
    }
    fn noises(&self) -> usize {
        self.hamiltonians.len().max(1) - 1
    }
    fn in_domain(&self, y: &[f64]) -> bool {
        (self.inside)(y)
    }
    fn piecewise(&self, _y: &[f64]) -> bool {
        false
    }
    fn structure(&self, y: &[f64], v: &[Bounded]) -> Vec<Bounded> {
        (self.structure)(y, v)
    }
    fn matrix_derivatives(&self, y: &[f64]) -> Vec<Matrix<Bounded>> {
        (self.slopes)(y)
    }
    fn energy(&self, weights: &[f64]) -> Box<dyn Function + '_> {
        Box::new(Sum(weights.to_vec(), &self.hamiltonians))
    }
    fn gradient(&self, y: &[f64], weights: &[f64]) -> Vec<Bounded> {
        self.energy(weights).gradient(y)
    }
    fn averages(&self, a: &[f64], b: &[f64], weights: &[f64]) -> Averages {
        self.averaged.borrow_mut().push([a, b, weights].map(<[f64]>::to_vec));
        (self.averages)(a, b, weights)
    }
    fn predict(&self, a: &[f64], weights: &[f64]) -> (Vec<f64>, f64) {
        self.predicted.borrow_mut().push([a, weights].map(<[f64]>::to_vec));
        (self.predict)(a)
    }
    fn field(&self, _y: &[f64], weights: &[f64]) -> Field {
        (self.field)(weights)
    }
    fn commutators(&self, _y: &[f64], areas: &Matrix) -> Vec<Bounded> {
        (self.commutators)(areas)
    }
    fn without_iteration(&self, _y: &[f64]) -> WithoutIteration {
        WithoutIteration {
            structure: Linearity::Affine,
            refused: None,
            truncates: false,
            areas_refused: None,
            draws_areas: true,
            nv_refused: None,
        }
    }
    fn overrides(&self, _points: &[Vec<f64>]) -> Vec<Override> {
        Vec::new()
    }
    fn invariants(&self) -> Vec<(Invariant, Box<dyn Function + '_>)> {
        Vec::new()
    }
}
