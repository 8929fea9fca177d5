//! The expressions of a system in one graph.

use std::{ops::Range, slice::from_ref};

use super::{MOST_EXPRESSIONS, average, cayley, definition::Formulas, skew::points};
use real::Bounded;
use systems::run_time::Op;

use crate::{
    Formula, Graph, Id, Tape,
    graph::{Binary, Node, Unary},
    words::{self, Binding},
};

/// What a system is asked for, in the inputs y, u, v, dt, dw and areas, in this order.
#[derive(Clone)]
pub struct Expressions {
    pub graph: Graph,
    dimension: usize,
    noises: usize,
    /// H₀, H₁, …
    hamiltonians: Vec<Id>,
    /// B(y)v.
    field: Vec<Id>,
    /// h.
    energy: Id,
    /// The operations that have expressions, with the groups of inputs (y, u, v) that are their
    /// arguments. ∇̄h(a, b) is that of a = y and b = u. None is the linearly implicit step if B is
    /// not affine, or elimination too long, and those of areas for more than [`MOST_NOISES`].
    operations: Vec<(Op<usize>, Vec<Id>)>,
}

/// The most noises whose Lévy areas are used.
const MOST_NOISES: usize = 16;

/// The least number of points that show an identity.
const LEAST_POINTS: usize = 3;

impl Expressions {
    pub fn new(formulas: &Formulas) -> Self {
        let (dimension, noises) = (formulas.structure.len(), formulas.hamiltonians.len() - 1);
        let mut graph = Graph::new();
        let y: Vec<Id> = (0..dimension).map(|k| graph.input(k)).collect();
        let mut import =
            |formula: &Formula| graph.import(formula.graph(), &[formula.root()], &y)[0];
        let hamiltonians: Vec<Id> = formulas.hamiltonians.iter().map(&mut import).collect();
        let entries: Vec<Vec<Id>> =
            formulas.structure.iter().map(|row| row.iter().map(&mut import).collect()).collect();
        let energy = graph.constant(0.0);
        let (field, operations) = (Vec::new(), Vec::new());
        let mut new = Self { graph, dimension, noises, hamiltonians, field, energy, operations };
        let (y, u, v, a, b) = (0, 1, 2, 0, 1);
        let vector = new.inputs(new.v());
        new.field = new.times(&entries, &vector);
        let field = new.field.clone();
        let field_along = new.along(&field);
        let weights = new.inputs(new.dt().start..new.dw().end);
        new.energy = new.graph.dot(&new.hamiltonians, &weights);
        let gradient = new.gradient_of(&weights);
        let hessian = new.along(&gradient);
        let (from, to) = (new.inputs(new.y()), new.inputs(new.u()));
        let weighted = new.with_weights(&weights);
        let averaged = average::averaged_gradient(&mut new.graph, &weighted, &from, &to);
        new.operations = vec![
            (Op::Structure { y, v }, field),
            (Op::StructureAlong { y, u, v }, field_along),
            (Op::Gradient { y }, gradient),
            (Op::Hessian { y, u }, hessian),
            (Op::AveragedGradient { a, b }, averaged),
            (Op::ItoCorrection { y }, new.corrected()),
        ];
        if noises <= MOST_NOISES {
            let gradient = new.bracketed();
            if noises > 1 {
                let hessian = new.along(&gradient);
                new.operations.push((Op::AreaHessian { y, u }, hessian));
            }
            new.operations.push((Op::AreaGradient { y }, gradient));
        }
        if let Some(0 | 1) = new.structure_degree()
            && let Some(solution) = new.solved()
        {
            new.operations.push((Op::Cayley { y, v }, solution));
        }
        new
    }

    pub fn dimension(&self) -> usize {
        self.dimension
    }

    pub fn noises(&self) -> usize {
        self.noises
    }

    fn y(&self) -> Range<usize> {
        0..self.dimension
    }

    fn u(&self) -> Range<usize> {
        self.dimension..2 * self.dimension
    }

    fn v(&self) -> Range<usize> {
        2 * self.dimension..3 * self.dimension
    }

    fn dt(&self) -> Range<usize> {
        3 * self.dimension..3 * self.dimension + 1
    }

    fn dw(&self) -> Range<usize> {
        self.dt().end..self.dt().end + self.noises
    }

    /// The matrix of Lévy areas, of which the part above the diagonal is read.
    fn areas(&self) -> Range<usize> {
        self.dw().end..self.dw().end + self.noises * self.noises
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

    /// Whether B or a Hamiltonian has a logarithm, a root or a quotient.
    pub fn have_domain(&self) -> bool {
        self.graph.uses(&[&self.hamiltonians[..], &self.field].concat(), |node| {
            matches!(node, Node::Unary(Unary::Ln | Unary::Sqrt, _) | Node::Binary(Binary::Div, ..))
        })
    }

    /// H₀ + H₁ + … and the components of B(y)(1, 2, …), a sum that is finite where all are.
    pub fn guard_tape(&mut self) -> Tape {
        let ones = vec![self.graph.constant(1.0); self.hamiltonians.len()];
        let mut sum = self.graph.dot(&self.hamiltonians, &ones);
        // No two entries cancel, as they would if all numbers were one.
        let v: Vec<Id> = self.y().map(|k| self.graph.constant(1.0 + k as f64)).collect();
        for component in self.field_at(self.v(), &v) {
            sum = self.graph.add(sum, component);
        }
        Tape::new(&self.graph, &[sum], &[self.y()])
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
        let degrees = self.graph.degrees(roots, &y);
        roots.iter().map(|root| degrees[root.index()]).try_fold(0, |most, d| Some(d?.max(most)))
    }

    /// The derivatives along u.
    fn along(&mut self, roots: &[Id]) -> Vec<Id> {
        let u = self.inputs(self.u());
        let direction: Vec<(usize, Id)> = self.y().zip(u).collect();
        self.graph.forward(roots, &direction)
    }

    /// H₀ with its weight, H₁, ….
    fn with_weights(&self, weights: &[Id]) -> Vec<(Id, Id)> {
        self.hamiltonians.iter().copied().zip(weights.iter().copied()).collect()
    }

    /// ∇(H₀w₀ + H₁w₁ + …).
    fn gradient_of(&mut self, weights: &[Id]) -> Vec<Id> {
        self.graph.reverse(&self.with_weights(weights), &self.y().collect::<Vec<_>>())
    }

    /// ½Σₘ fₘ′fₘ.
    fn corrected(&mut self) -> Vec<Id> {
        let mut correction = vec![self.graph.constant(0.0); self.dimension];
        for m in 1..self.hamiltonians.len() {
            let (_, field) = self.field_of(m);
            let direction: Vec<(usize, Id)> = self.y().zip(field.iter().copied()).collect();
            let derivative = self.graph.forward(&field, &direction);
            average::add(&mut self.graph, &mut correction, &derivative, 0.5);
        }
        correction
    }

    /// Σ_{m<l} A_ml ∇{Hₘ, H_l}.
    fn bracketed(&mut self) -> Vec<Id> {
        let fields: Vec<(Vec<Id>, Vec<Id>)> = (1..=self.noises).map(|m| self.field_of(m)).collect();
        let mut brackets = Vec::new();
        for (m, (slope, _)) in fields.iter().enumerate() {
            for (l, (_, field)) in fields.iter().enumerate().skip(m + 1) {
                let area = self.graph.input(self.areas().start + m * self.noises + l);
                brackets.push((self.graph.dot(slope, field), area));
            }
        }
        let y: Vec<usize> = self.y().collect();
        self.graph.reverse(&brackets, &y)
    }

    /// Whether \[fₘ, f_l\] = 0 for all noises, and whether it is −B∇{Hₘ, H_l}: each component is
    /// zero within its own rounding error at points around `y0`, and the formulas are not made of
    /// pieces, as in [`systems::jacobi_holds`]. False if there are too many noises or expressions.
    pub fn commutators(mut self, y0: &[f64]) -> [bool; 2] {
        if !(2..=MOST_NOISES).contains(&self.noises) {
            return [self.noises < 2; 2];
        }
        let fields: Vec<(Vec<Id>, Vec<Id>)> = (1..=self.noises).map(|m| self.field_of(m)).collect();
        let (y, one) = (self.y().collect::<Vec<_>>(), self.graph.constant(1.0));
        let (mut commutators, mut defects) = (Vec::new(), Vec::new());
        for (m, (slope, f)) in fields.iter().enumerate() {
            for (_, g) in &fields[m + 1..] {
                let bracket = self.graph.dot(slope, g);
                let v = self.graph.reverse(&[(bracket, one)], &y);
                let turned = self.field_at(self.v(), &v);
                let [moved, other] = [(g, f), (f, g)].map(|(of, along)| {
                    let direction: Vec<_> = y.iter().copied().zip(along.iter().copied()).collect();
                    self.graph.forward(of, &direction)
                });
                for i in 0..self.dimension {
                    let commutator = self.graph.sub(moved[i], other[i]);
                    commutators.push(commutator);
                    defects.push(self.graph.add(commutator, turned[i]));
                }
                if self.graph.len() > MOST_EXPRESSIONS {
                    return [false; 2];
                }
            }
        }
        [commutators, defects].map(|expressions| self.vanish(&expressions, y0))
    }

    /// Whether expressions of y are zero within their rounding errors around `y0`.
    fn vanish(&self, expressions: &[Id], y0: &[f64]) -> bool {
        let mut shown = 0;
        for point in points(y0) {
            let mut inputs = vec![Bounded::exact(0.0); self.areas().end];
            inputs.iter_mut().zip(&point).for_each(|(y, &x)| *y = Bounded::variable(x));
            let (values, is_piecewise) =
                Bounded::piecewise(|| self.graph.values(expressions, &inputs));
            // Outside of the domain there is no number.
            let defects: Vec<_> = expressions.iter().map(|id| values[id.index()]).collect();
            if defects.iter().all(|defect| defect.value.is_finite() && defect.error.is_finite()) {
                if is_piecewise || defects.iter().any(|d| d.value.abs() > d.error) {
                    return false;
                }
                shown += 1;
            }
        }
        shown >= LEAST_POINTS
    }

    /// ∇Hₘ and B∇Hₘ.
    fn field_of(&mut self, m: usize) -> (Vec<Id>, Vec<Id>) {
        let mut unit = vec![self.graph.constant(0.0); self.hamiltonians.len()];
        unit[m] = self.graph.constant(1.0);
        let gradient = self.gradient_of(&unit);
        let field = self.field_at(self.v(), &gradient);
        (gradient, field)
    }

    /// The equation with damping or without, a text for each component: `dp = -q dt + 0.5 ∘ dW1`.
    pub fn equations(mut self, state: &[String], damped: bool) -> Vec<String> {
        let fields: Vec<Vec<Id>> =
            (0..self.hamiltonians.len()).map(|m| self.field_of(m).1).collect();
        let equation = |(i, name): (usize, &String)| {
            let mut terms = String::new();
            for (m, field) in fields.iter().enumerate() {
                if self.graph.is_zero(field[i]) {
                    continue;
                }
                let minus = words::negated(&mut self.graph, field[i]);
                let sign = [" + ", " - "][usize::from(minus.is_some())];
                let sign =
                    if terms.is_empty() { sign.trim().trim_start_matches('+') } else { sign };
                let factor = minus.unwrap_or(field[i]);
                let text = match self.graph.as_constant(factor) == Some(1.0) {
                    true => String::new(),
                    false => words::text(&self.graph, factor, state, Binding::Product) + " ",
                };
                let of = if m == 0 { "dt".into() } else { format!("∘ dW{m}") };
                terms += &format!("{sign}{text}{of}");
            }
            if damped {
                terms += &format!(" - γ {name} dt");
            }
            let terms = terms.trim_start();
            format!("d{name} = {}", if terms.is_empty() { "0" } else { terms })
        };
        state.iter().enumerate().map(equation).collect()
    }

    /// B(y)v for other expressions y or v, the inputs `at`.
    fn field_at(&mut self, at: Range<usize>, state: &[Id]) -> Vec<Id> {
        let mut inputs = self.inputs(0..self.v().end);
        inputs[at].copy_from_slice(state);
        self.graph.substitute(&self.field, &inputs)
    }

    /// The solution z of z = y + B((y+z)/2)v; none if it takes too many expressions.
    fn solved(&mut self) -> Option<Vec<Id>> {
        let zero = vec![self.graph.constant(0.0); self.dimension];
        let constant = self.field_at(self.y(), &zero);
        let y = self.inputs(self.y());
        let right = cayley::right_side(&mut self.graph, &y, &self.field, &constant);
        let matrix = cayley::matrix(&mut self.graph, &self.field);
        cayley::solve(&mut self.graph, matrix, right)
    }

    /// The expressions of an operation, and the groups of inputs (y, u, v) that its arguments are;
    /// none if it follows from others, or has no expression.
    pub fn of<P: Clone>(&self, op: &Op<P>) -> Option<&(Op<usize>, Vec<Id>)> {
        let op = op.clone().map(|_| ());
        self.operations.iter().find(|(known, _)| known.map(|_| ()) == op)
    }

    /// The operations that have expressions, each with a tape from its arguments, and from dt and
    /// dw or the areas if it reads them.
    pub fn op_tapes(&self) -> Vec<(Op<()>, Tape)> {
        let tape = |(op, roots): &(Op<usize>, Vec<Id>)| {
            let weights = op.reads_weights().then(|| [self.dt(), self.dw()]);
            let areas = op.reads_areas().then(|| self.areas());
            let states = op.arguments().map(|k| k * self.dimension..(k + 1) * self.dimension);
            let inputs: Vec<_> = states.chain(weights.into_iter().flatten()).chain(areas).collect();
            (op.map(|_| ()), Tape::new(&self.graph, roots, &inputs))
        };
        self.operations.iter().map(tape).collect()
    }

    /// h from y, dt and dw.
    pub fn energy_tape(&self) -> Tape {
        Tape::new(&self.graph, &[self.energy], &[self.y(), self.dt(), self.dw()])
    }

    /// The entries of I − ½A(v) from v, row by row.
    pub fn cayley_matrix_tape(&mut self) -> Tape {
        let matrix = cayley::matrix(&mut self.graph, &self.field).concat();
        Tape::new(&self.graph, &matrix, from_ref(&self.v()))
    }
}
