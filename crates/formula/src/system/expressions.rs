//! The expressions of a system in one graph.

use std::{ops::Range, slice::from_ref};

use dgrad::Rule;

use super::{cayley, definition::Formulas, program::Templates};
use crate::{Formula, Graph, Id, Tape};

/// B(y)v, H₀, Hₘ and the observables, in the inputs y, u, v, dt and dw, in this order.
pub struct Expressions {
    graph: Graph,
    dimension: usize,
    noises: usize,
    /// B(y)v.
    field: Vec<Id>,
    /// H₀, H₁, …
    hamiltonians: Vec<Id>,
    /// dt, dw₁, …
    weights: Vec<Id>,
    observables: Vec<Id>,
}

/// From this dimension on the elimination has more instructions than a program should.
const LARGEST_ELIMINATION: usize = 24;

impl Expressions {
    pub fn new(formulas: &Formulas) -> Self {
        let (dimension, noises) = (formulas.structure.len(), formulas.noises.len());
        let mut graph = Graph::new();
        let y: Vec<Id> = (0..dimension).map(|k| graph.input(k)).collect();
        let weights = (0..=noises).map(|m| graph.input(3 * dimension + m)).collect();
        let mut import =
            |formula: &Formula| graph.import(formula.graph(), &[formula.root()], &y)[0];
        let hamiltonians: Vec<Id> =
            std::iter::once(&formulas.energy).chain(&formulas.noises).map(&mut import).collect();
        let observables = formulas.observables.iter().map(|(_, f)| import(f)).collect();
        let entries: Vec<Vec<Id>> =
            formulas.structure.iter().map(|row| row.iter().map(&mut import).collect()).collect();
        let mut new = Self {
            graph,
            dimension,
            noises,
            field: Vec::new(),
            hamiltonians,
            weights,
            observables,
        };
        let v = new.inputs(new.v());
        new.field = new.times(&entries, &v);
        new
    }

    pub fn y(&self) -> Range<usize> {
        0..self.dimension
    }

    pub fn u(&self) -> Range<usize> {
        self.dimension..2 * self.dimension
    }

    pub fn v(&self) -> Range<usize> {
        2 * self.dimension..3 * self.dimension
    }

    fn dt(&self) -> Range<usize> {
        3 * self.dimension..3 * self.dimension + 1
    }

    fn dw(&self) -> Range<usize> {
        3 * self.dimension + 1..3 * self.dimension + 1 + self.noises
    }

    fn inputs(&mut self, range: Range<usize>) -> Vec<Id> {
        range.map(|k| self.graph.input(k)).collect()
    }

    /// B·v, with bⱼᵢ = −bᵢⱼ below the diagonal.
    fn times(&mut self, entries: &[Vec<Id>], v: &[Id]) -> Vec<Id> {
        let graph = &mut self.graph;
        let mut field = Vec::new();
        for i in 0..v.len() {
            let mut sum = graph.constant(0.0);
            for j in 0..i {
                let product = graph.mul(entries[j][i - j - 1], v[j]);
                sum = graph.sub(sum, product);
            }
            for j in i + 1..v.len() {
                let product = graph.mul(entries[i][j - i - 1], v[j]);
                sum = graph.add(sum, product);
            }
            field.push(sum);
        }
        field
    }

    /// The largest degree of B(y) in y.
    pub fn structure_degree(&self) -> Option<u32> {
        self.largest_degree(&self.field)
    }

    /// The largest degree of H₀, H₁, … in y.
    pub fn energy_degree(&self) -> Option<u32> {
        self.largest_degree(&self.hamiltonians)
    }

    fn largest_degree(&self, roots: &[Id]) -> Option<u32> {
        let y: Vec<usize> = self.y().collect();
        let degrees: Option<Vec<u32>> =
            roots.iter().map(|&root| self.graph.degree(root, &y)).collect();
        degrees.map(|degrees| degrees.into_iter().max().unwrap_or(0))
    }

    fn tape(&self, outputs: &[Id], groups: &[Range<usize>]) -> Tape {
        Tape::new(&self.graph, outputs, groups)
    }

    /// B(y)v from y and v.
    pub fn structure(&self) -> Tape {
        self.tape(&self.field, &[self.y(), self.v()])
    }

    /// (∂B·u)v from y, u and v.
    pub fn structure_along(&mut self) -> Tape {
        let along = self.along(&self.field.clone());
        self.tape(&along, &[self.y(), self.u(), self.v()])
    }

    /// The derivatives along u.
    fn along(&mut self, roots: &[Id]) -> Vec<Id> {
        let u = self.inputs(self.u());
        let direction: Vec<(usize, Id)> = self.y().zip(u).collect();
        self.graph.forward(roots, &direction)
    }

    /// h from y, dt and dw.
    pub fn energy(&mut self) -> Tape {
        let mut sum = self.graph.constant(0.0);
        for (&h, &weight) in self.hamiltonians.iter().zip(&self.weights) {
            let product = self.graph.mul(h, weight);
            sum = self.graph.add(sum, product);
        }
        self.tape(&[sum], &[self.y(), self.dt(), self.dw()])
    }

    fn gradient_of(&mut self, weights: &[Id]) -> Vec<Id> {
        let weighted: Vec<(Id, Id)> =
            self.hamiltonians.iter().copied().zip(weights.iter().copied()).collect();
        let y: Vec<usize> = self.y().collect();
        self.graph.reverse(&weighted, &y)
    }

    /// ∇h from y, dt and dw.
    pub fn gradient(&mut self) -> Tape {
        let gradient = self.gradient_of(&self.weights.clone());
        self.tape(&gradient, &[self.y(), self.dt(), self.dw()])
    }

    /// ∇²h·u from y, u, dt and dw.
    pub fn hessian(&mut self) -> Tape {
        let gradient = self.gradient_of(&self.weights.clone());
        let along = self.along(&gradient);
        self.tape(&along, &[self.y(), self.u(), self.dt(), self.dw()])
    }

    /// ½Σₘ fₘ′fₘ from y, with fₘ = B∇Hₘ.
    pub fn ito_correction(&mut self) -> Tape {
        let correction = self.correction();
        self.tape(&correction, from_ref(&self.y()))
    }

    fn correction(&mut self) -> Vec<Id> {
        let mut correction = vec![self.graph.constant(0.0); self.dimension];
        for m in 1..self.hamiltonians.len() {
            let mut unit = vec![self.graph.constant(0.0); self.hamiltonians.len()];
            unit[m] = self.graph.constant(1.0);
            let gradient = self.gradient_of(&unit);
            let field = self.field_at(None, Some(&gradient));
            let direction: Vec<(usize, Id)> = self.y().zip(field.iter().copied()).collect();
            let derivative = self.graph.forward(&field, &direction);
            for (sum, part) in correction.iter_mut().zip(derivative) {
                let half = self.graph.scale(part, 0.5);
                *sum = self.graph.add(*sum, half);
            }
        }
        correction
    }

    /// B(y)v for other expressions y and v.
    fn field_at(&mut self, y: Option<&[Id]>, v: Option<&[Id]>) -> Vec<Id> {
        let mut inputs = self.inputs(0..3 * self.dimension);
        if let Some(y) = y {
            inputs[..self.dimension].copy_from_slice(y);
        }
        if let Some(v) = v {
            inputs[2 * self.dimension..].copy_from_slice(v);
        }
        let source = self.graph.clone();
        self.graph.import(&source, &self.field, &inputs)
    }

    /// The expressions of all operations, for programs.
    pub fn templates(mut self, affine: bool, rule: &Rule) -> Templates {
        let gradient = self.gradient_of(&self.weights.clone());
        let hessian = self.along(&gradient);
        let structure_along = self.along(&self.field.clone());
        let ito_correction = self.correction();
        let cayley = (affine && self.dimension <= LARGEST_ELIMINATION).then(|| self.solution());
        Templates {
            dimension: self.dimension,
            noises: self.noises,
            structure: self.field,
            structure_along,
            gradient,
            hessian,
            ito_correction,
            cayley,
            rule: (rule.nodes().to_vec(), rule.weights().to_vec()),
            graph: self.graph,
        }
    }

    /// The entries of I − ½A(v) from v, row by row.
    pub fn cayley_matrix(&mut self) -> Tape {
        let matrix = cayley::matrix(&mut self.graph, &self.field).concat();
        self.tape(&matrix, from_ref(&self.v()))
    }

    /// The solution z of z = y + B((y+z)/2)v from y and v; none if the dimension is too large.
    pub fn cayley(&mut self) -> Option<Tape> {
        if self.dimension > LARGEST_ELIMINATION {
            return None;
        }
        let solution = self.solution();
        Some(self.tape(&solution, &[self.y(), self.v()]))
    }

    fn solution(&mut self) -> Vec<Id> {
        let right = self.cayley_right_side();
        let matrix = cayley::matrix(&mut self.graph, &self.field);
        cayley::solve(&mut self.graph, &matrix, &right)
    }

    /// y + ½(B(y)v + B(0)v).
    fn cayley_right_side(&mut self) -> Vec<Id> {
        let zero = vec![self.graph.constant(0.0); self.dimension];
        let constant = self.field_at(Some(&zero), None);
        let y = self.inputs(self.y());
        cayley::right_side(&mut self.graph, &y, &self.field, &constant)
    }

    /// y + ½(B(y)v + B(0)v) from y and v.
    pub fn cayley_right(&mut self) -> Tape {
        let right = self.cayley_right_side();
        self.tape(&right, &[self.y(), self.v()])
    }

    /// The observables from y.
    pub fn observables(&self) -> Tape {
        self.tape(&self.observables, from_ref(&self.y()))
    }
}
