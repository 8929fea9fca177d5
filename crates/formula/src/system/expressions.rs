//! The expressions of a system in one graph.

use std::{collections::BTreeSet, ops::Range, slice::from_ref};

use super::{
    MAX_EXPRESSIONS, average, cayley,
    definition::Formulas,
    flows::{Part, Term, parts},
};
use real::Real;
use systems::{
    probe::vanish,
    run_time::{Op, Parts},
};

use expression::{Binary, Graph, Id, Node, Tape, Unary};

use crate::{
    Formula,
    words::{self, Binding},
};

/// Operations of a system as expressions, in groups of inputs: y, u, v, dt, dw, areas and t.
#[derive(Clone)]
pub struct Expressions {
    pub graph: Graph,
    pub dimension: usize,
    pub noises: usize,
    /// H₀, H₁, …
    pub hamiltonians: Vec<Id>,
    /// The entries of B above the diagonal, row by row.
    pub structure: Vec<Vec<Id>>,
    /// B(y)v.
    field: Vec<Id>,
    /// h.
    energy: Id,
    /// The operations that have expressions, with the groups of inputs (y, u, v) that are their
    /// arguments. ∇̄h(a, b) is that of a = y and b = u. None is the linearly implicit step if B is
    /// not affine, or elimination too long, and those of areas for more than [`MAX_NOISES`].
    operations: Vec<(Op<usize>, Vec<Id>)>,
    /// Flows of the parts, in a graph of their own; none if there is a term without one.
    flows: (Graph, Vec<Vec<Id>>),
}

/// The groups of inputs.
const Y: usize = 0;
const U: usize = 1;
const V: usize = 2;
const DT: usize = 3;
const DW: usize = 4;
/// The matrix of Lévy areas, of which the part above the diagonal is read.
const AREAS: usize = 5;
/// The time.
const TIME: usize = 6;

/// Times at which noises that depend on it are asked whether they commute.
const TIMES: [f64; 3] = [0.0, 0.618, 2.236];

/// The most noises whose Lévy areas are used.
const MAX_NOISES: usize = 16;

/// Terms of a part that are written out.
const MAX_TERMS: usize = 4;

/// The input of the first area.
fn first_area(dimension: usize, noises: usize) -> usize {
    3 * dimension + 1 + noises
}

/// The number of areas; none where they are not used.
pub fn number_of_areas(noises: usize) -> usize {
    if noises <= MAX_NOISES { noises * noises } else { 0 }
}

impl Expressions {
    /// The expressions of a system; or of the `rest` of it, the terms of another graph.
    pub fn new(formulas: &Formulas, rest: Option<(&Graph, &[Term])>) -> Self {
        let (dimension, noises) = (formulas.structure.len(), formulas.hamiltonians.len() - 1);
        let mut graph = Graph::new();
        let y: Vec<Id> = (0..dimension).map(|k| graph.input(k)).collect();
        let t = graph.input(first_area(dimension, noises) + number_of_areas(noises));
        let variables = [&y[..], &[t]].concat();
        let mut import =
            |formula: &Formula| graph.copy(Some(&formula.graph), &[formula.root], &variables)[0];
        let mut hamiltonians: Vec<Id> = formulas.hamiltonians.iter().map(&mut import).collect();
        let structure: Vec<Vec<Id>> =
            formulas.structure.iter().map(|row| row.iter().map(&mut import).collect()).collect();
        if let Some((other, terms)) = rest {
            hamiltonians.fill(graph.constant(0.0));
            for term in terms {
                let mut inputs = vec![t; other.inputs()];
                inputs[..dimension].copy_from_slice(&y);
                let root = graph.copy(Some(other), &[term.root], &inputs)[0];
                let scaled = graph.scale(root, term.factor);
                hamiltonians[term.of] = graph.add(hamiltonians[term.of], scaled);
            }
        }
        let energy = graph.constant(0.0);
        let (field, operations, flows) = (Vec::new(), Vec::new(), Default::default());
        let mut new = Self {
            graph,
            dimension,
            noises,
            hamiltonians,
            structure,
            field,
            energy,
            operations,
            flows,
        };
        let [u, v] = [U, V].map(|group| new.inputs(group));
        new.field = new.times(&v);
        let field = new.field.clone();
        let field_along = new.along(&field, &u);
        let weights = [new.inputs(DT), new.inputs(DW)].concat();
        new.energy = new.graph.dot(&new.hamiltonians, &weights);
        // ∇(H₀w₀ + H₁w₁ + …).
        let weighted: Vec<(Id, Id)> = new.hamiltonians.iter().copied().zip(weights).collect();
        let gradient = new.graph.reverse(&weighted, &new.y());
        let hessian = new.along(&gradient, &u);
        let averaged = average::averaged_gradient(&mut new.graph, &weighted, &y, &u);
        let correction = new.corrected();
        new.operations = vec![
            (Op::Structure { y: Y, v: V }, field),
            (Op::StructureAlong { y: Y, u: U, v: V }, field_along),
            (Op::Gradient { y: Y }, gradient),
            (Op::Hessian { y: Y, u: U }, hessian),
            (Op::AveragedGradient { a: Y, b: U }, averaged),
            (Op::ItoCorrection { y: Y }, correction),
        ];
        if noises <= MAX_NOISES {
            let gradient = new.bracketed();
            if noises > 1 {
                let hessian = new.along(&gradient, &u);
                new.operations.push((Op::AreaHessian { y: Y, u: U }, hessian));
            }
            new.operations.push((Op::AreaGradient { y: Y }, gradient));
        }
        if let Some(0 | 1) = new.structure_degree()
            && let Some(solution) = new.solved(&y)
        {
            new.operations.push((Op::Cayley { y: Y, v: V }, solution));
        }
        new
    }

    /// The inputs of a group.
    fn group(&self, group: usize) -> Range<usize> {
        let (d, m) = (self.dimension, self.noises);
        let (first, last) = (first_area(d, m), first_area(d, m) + number_of_areas(m));
        let ends = [0, d, 2 * d, 3 * d, 3 * d + 1, first, last, last + 1];
        ends[group]..ends[group + 1]
    }

    fn inputs(&mut self, group: usize) -> Vec<Id> {
        self.group(group).map(|k| self.graph.input(k)).collect()
    }

    /// Finds the parts of the Hamiltonians whose flows are known.
    /// Also gives the terms without a flow, with their graph.
    pub fn find_parts(&mut self, state: &[String]) -> (Result<Parts, String>, Graph, Vec<Term>) {
        let mut names = state.to_vec();
        names.resize(self.group(TIME).end, "t".into());
        let mut apart = self.clone();
        let found = parts(&mut apart);
        let text = |root: Id, factor: f64| {
            let mut graph = apart.graph.clone();
            let product = graph.scale(root, factor);
            words::text(&graph, product, &names, Binding::Sum)
        };
        let of_noise = |m: usize| {
            let has = |part: &Part| part.terms.iter().any(|term| term.of == m);
            let mut all = (0..found.len()).filter(|&k| has(&found[k]));
            all.next().filter(|_| all.next().is_none())
        };
        let of = |part: &Part, m: usize| {
            let terms = part.terms.iter().filter(|term| term.of == m);
            let all: Vec<String> = terms.map(|term| text(term.root, term.factor)).collect();
            let (first, others) = all.split_first()?;
            let more = all.len().saturating_sub(MAX_TERMS);
            let signed = |term: &String| match term.strip_prefix('-') {
                Some(term) => format!(" - {term}"),
                None => format!(" + {term}"),
            };
            let shown: String = others.iter().take(MAX_TERMS - 1).map(signed).collect();
            let more = if more > 0 { format!(" + {more} terms") } else { String::new() };
            Some(format!("{first}{shown}{more} of H{m}"))
        };
        let words = |part: &Part| {
            let all: Vec<String> = (0..=self.noises).filter_map(|m| of(part, m)).collect();
            format!("{} by {}", part.kind(), all.join(", "))
        };
        let rest: Vec<Term> = found
            .iter()
            .filter(|part| part.is_rest())
            .flat_map(|part| part.terms.clone())
            .collect();
        let parts = Parts {
            number: found.len(),
            of_noise: (1..=self.noises).map(of_noise).collect(),
            preferred: false,
            words: found.iter().map(words).collect(),
        };
        let mut graph = Graph::new();
        let inputs: Vec<Id> = (0..self.group(TIME).end).map(|k| graph.input(k)).collect();
        let flow = |part: &Part| graph.copy(Some(&apart.graph), &part.flow, &inputs);
        self.flows.1 = found.iter().map(flow).collect();
        self.flows.0 = graph;
        let parts = match &rest[..] {
            [term, ..] if found.len() < 2 => {
                Err(format!("no flow of {} is known", text(term.root, 1.0)))
            }
            _ if found.is_empty() => Err("it is too large to look for flows".into()),
            _ => Ok(parts),
        };
        (parts, apart.graph, rest)
    }

    /// The flow of a part from y, with the weights of the Hamiltonians, at time t.
    pub fn flow(&self, part: usize, graph: &mut Graph, y: &[Id], weights: &[Id], t: Id) -> Vec<Id> {
        let mut inputs = vec![t; self.group(TIME).end];
        inputs[self.group(Y)].copy_from_slice(y);
        inputs[self.group(DT).start..][..weights.len()].copy_from_slice(weights);
        graph.copy(Some(&self.flows.0), &self.flows.1[part], &inputs)
    }

    /// The components of y.
    pub fn states(&mut self) -> Vec<Id> {
        self.inputs(Y)
    }

    /// The components that expressions use.
    pub fn reads(&self, roots: &[Id]) -> BTreeSet<usize> {
        let needed = self.graph.needed(roots);
        let component = |id: Id| match self.graph.node(id) {
            Node::Input(k) if (k as usize) < self.dimension => Some(k as usize),
            _ => None,
        };
        self.graph.ids().filter(|id| needed[id.index()]).filter_map(component).collect()
    }

    /// Σ w·c over terms of one function, with the weights w of their Hamiltonians.
    pub fn weight(&mut self, terms: &[Term]) -> Id {
        self.weighted(&terms.iter().map(|term| (term.of, term.factor)).collect::<Vec<_>>())
    }

    /// Σ c·w for the weights w of Hamiltonians and factors c.
    pub fn weighted(&mut self, shares: &[(usize, f64)]) -> Id {
        let weights = [self.inputs(DT), self.inputs(DW)].concat();
        let mut sum = self.graph.constant(0.0);
        for &(m, factor) in shares {
            let weight = self.graph.scale(weights[m], factor);
            sum = self.graph.add(sum, weight);
        }
        sum
    }

    /// B∇F of a term with its weight.
    pub fn field_of_term(&mut self, term: &Term) -> Vec<Id> {
        let weight = self.weight(from_ref(term));
        let gradient = self.graph.reverse(&[(term.root, weight)], &self.y());
        self.field_at(V, &gradient)
    }

    /// r with x′ = rx for the change x′ of component k; none if there is no such r, or it depends
    /// on the component.
    pub fn rate(&mut self, change: Id, k: usize) -> Option<Id> {
        if self.graph.degree(change, &[k])? > 1 {
            return None;
        }
        let mut state: Vec<Id> = (0..self.group(TIME).end).map(|k| self.graph.input(k)).collect();
        state[k] = self.graph.constant(0.0);
        let at_zero = self.graph.copy(None, &[change], &state)[0];
        let one = self.graph.constant(1.0);
        let rate = self.graph.forward(&[change], &[(k, one)])[0];
        (self.graph.is_zero(at_zero) && !self.reads(&[rate]).contains(&k)).then_some(rate)
    }

    fn y(&self) -> Vec<usize> {
        self.group(Y).collect()
    }

    /// B·v, with bⱼᵢ = −bᵢⱼ below the diagonal.
    fn times(&mut self, v: &[Id]) -> Vec<Id> {
        let Self { graph, structure: entries, .. } = self;
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

    /// Whether a Hamiltonian depends on time.
    pub fn depend_on_time(&self) -> bool {
        let t = self.group(TIME).start as u32;
        self.graph.uses(&self.hamiltonians, |node| node == Node::Input(t))
    }

    /// H₀ + H₁ + … and the components of B(y)(1, 2, …), a sum that is finite where all are.
    pub fn guard_tape(&mut self) -> Tape {
        let ones = vec![self.graph.constant(1.0); self.hamiltonians.len()];
        let mut sum = self.graph.dot(&self.hamiltonians, &ones);
        // No two entries cancel, as they would if all numbers were one.
        let v: Vec<Id> = self.y().iter().map(|&k| self.graph.constant(1.0 + k as f64)).collect();
        for component in self.field_at(V, &v) {
            sum = self.graph.add(sum, component);
        }
        self.tape(&[sum], [Y, TIME])
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
        let degrees = self.graph.degrees(roots, &self.y());
        roots.iter().map(|root| degrees[root.index()]).try_fold(0, |most, d| Some(d?.max(most)))
    }

    /// The derivatives of functions of y along a direction.
    fn along(&mut self, roots: &[Id], direction: &[Id]) -> Vec<Id> {
        let direction: Vec<(usize, Id)> = direction.iter().copied().enumerate().collect();
        self.graph.forward(roots, &direction)
    }

    /// ∂∇̄h(y, u)/∂u·v; none if there is no ∇̄h.
    pub fn averaged_along(&mut self) -> Option<Vec<Id>> {
        let averaged = self.of(&Op::AveragedGradient { a: (), b: () })?.1.clone();
        let direction: Vec<(usize, Id)> = self.group(U).zip(self.inputs(V)).collect();
        Some(self.graph.forward(&averaged, &direction))
    }

    /// ½Σₘ fₘ′fₘ.
    fn corrected(&mut self) -> Vec<Id> {
        let mut correction = vec![self.graph.constant(0.0); self.dimension];
        for m in 1..self.hamiltonians.len() {
            let (_, field) = self.field_of(m);
            let derivative = self.along(&field, &field);
            average::add(&mut self.graph, &mut correction, &derivative, 0.5);
        }
        correction
    }

    /// Σ_{m<l} A_ml ∇{Hₘ, H_l}.
    fn bracketed(&mut self) -> Vec<Id> {
        let fields = self.noise_fields();
        let mut brackets = Vec::new();
        for (m, (slope, _)) in fields.iter().enumerate() {
            for (l, (_, field)) in fields.iter().enumerate().skip(m + 1) {
                let area = self.graph.input(self.group(AREAS).start + m * self.noises + l);
                brackets.push((self.graph.dot(slope, field), area));
            }
        }
        self.graph.reverse(&brackets, &self.y())
    }

    /// Whether \[fₘ, f_l\] = 0 for all noises, and whether it is −B∇{Hₘ, H_l}, as
    /// [`vanish`] finds around `y0`. False if there are too many noises or expressions.
    pub fn commutators(mut self, y0: &[f64]) -> [bool; 2] {
        if !(2..=MAX_NOISES).contains(&self.noises) {
            return [self.noises < 2; 2];
        }
        let fields = self.noise_fields();
        let (y, one) = (self.y(), self.graph.constant(1.0));
        let (mut commutators, mut defects) = (Vec::new(), Vec::new());
        for (m, (slope, f)) in fields.iter().enumerate() {
            for (_, g) in &fields[m + 1..] {
                let bracket = self.graph.dot(slope, g);
                let v = self.graph.reverse(&[(bracket, one)], &y);
                let turned = self.field_at(V, &v);
                let (moved, other) = (self.along(g, f), self.along(f, g));
                for i in 0..self.dimension {
                    let commutator = self.graph.sub(moved[i], other[i]);
                    commutators.push(commutator);
                    defects.push(self.graph.add(commutator, turned[i]));
                }
                if self.graph.size() > MAX_EXPRESSIONS {
                    return [false; 2];
                }
            }
        }
        [commutators, defects].map(|expressions| {
            let times = if self.depend_on_time() { &TIMES[..] } else { &TIMES[..1] };
            times.iter().all(|&t| {
                let finite =
                    |y: &[f64]| self.numbers(&expressions, y, t).iter().all(|x| x.is_finite());
                vanish(y0, finite, |y| self.numbers(&expressions, y, t))
            })
        })
    }

    /// Values of functions of y at a time, in numbers of any type.
    fn numbers<R: Real>(&self, roots: &[Id], y: &[R], t: f64) -> Vec<R> {
        let mut inputs = y.to_vec();
        inputs.resize(self.group(TIME).end, R::constant(t));
        let values = self.graph.values(roots, &inputs);
        roots.iter().map(|root| values[root.index()]).collect()
    }

    /// ∇Hₘ and B∇Hₘ of all noises.
    fn noise_fields(&mut self) -> Vec<(Vec<Id>, Vec<Id>)> {
        (1..=self.noises).map(|m| self.field_of(m)).collect()
    }

    /// ∇Hₘ and B∇Hₘ of one Hamiltonian.
    fn field_of(&mut self, m: usize) -> (Vec<Id>, Vec<Id>) {
        let one = self.graph.constant(1.0);
        let gradient = self.graph.reverse(&[(self.hamiltonians[m], one)], &self.y());
        let field = self.field_at(V, &gradient);
        (gradient, field)
    }

    /// The components of B∇H₀, B∇H₁, … at y that depend on t, in a graph with t as its input.
    pub fn in_time(mut self, y: &[f64]) -> (Graph, Vec<Id>) {
        let fields: Vec<Id> = (0..=self.noises).flat_map(|m| self.field_of(m).1).collect();
        let mut graph = Graph::new();
        let t = graph.input(0);
        let mut inputs: Vec<Id> = y.iter().map(|&y| graph.constant(y)).collect();
        inputs.resize(self.group(TIME).end, t);
        let mut roots = graph.copy(Some(&self.graph), &fields, &inputs);
        roots.retain(|&root| graph.uses(&[root], |node| node == Node::Input(0)));
        (graph, roots)
    }

    /// The equation, a text for each component: `dp = -q dt + 0.5 ∘ dW1`; those `damped` have −γy.
    pub fn equations(mut self, state: &[String], damped: &[bool]) -> Vec<String> {
        let fields: Vec<Vec<Id>> =
            (0..self.hamiltonians.len()).map(|m| self.field_of(m).1).collect();
        let mut names = state.to_vec();
        names.resize(self.group(TIME).end, "t".into());
        let equation = |(i, name): (usize, &String)| {
            let mut text = format!("d{name} =");
            for (m, field) in fields.iter().enumerate() {
                if self.graph.is_zero(field[i]) {
                    continue;
                }
                let minus = words::negated(&mut self.graph, field[i]);
                text += match (minus, text.ends_with('=')) {
                    (Some(_), true) => " -",
                    (Some(_), false) => " - ",
                    (None, true) => " ",
                    (None, false) => " + ",
                };
                let factor = minus.unwrap_or(field[i]);
                if self.graph.as_constant(factor) != Some(1.0) {
                    text += &(words::text(&self.graph, factor, &names, Binding::Product) + " ");
                }
                text += &if m == 0 { "dt".into() } else { format!("∘ dW{m}") };
            }
            match (damped[i], text.ends_with('=')) {
                (true, _) => text + &format!(" - γ {name} dt"),
                (false, true) => text + " 0",
                (false, false) => text,
            }
        };
        state.iter().enumerate().map(equation).collect()
    }

    /// B(y)v for other expressions in the place of a group.
    fn field_at(&mut self, group: usize, state: &[Id]) -> Vec<Id> {
        let mut inputs = [Y, U, V].map(|group| self.inputs(group));
        inputs[group] = state.to_vec();
        self.graph.copy(None, &self.field, &inputs.concat())
    }

    /// The solution z of z = y + B((y+z)/2)v; none if it takes too many expressions.
    fn solved(&mut self, y: &[Id]) -> Option<Vec<Id>> {
        let zero = vec![self.graph.constant(0.0); self.dimension];
        let constant = self.field_at(Y, &zero);
        // y + ½(B(y)v + B(0)v).
        let (mut sum, mut right) = (self.field.clone(), y.to_vec());
        average::add(&mut self.graph, &mut sum, &constant, 1.0);
        average::add(&mut self.graph, &mut right, &sum, 0.5);
        let matrix = cayley::matrix(&mut self.graph, &self.field);
        cayley::solve(&mut self.graph, matrix, right)
    }

    /// The expressions of an operation, and the groups of inputs that its arguments are; none if it
    /// follows from others, or has no expression.
    pub fn of<P: Clone>(&self, op: &Op<P>) -> Option<&(Op<usize>, Vec<Id>)> {
        let op = op.clone().map(|_| ());
        self.operations.iter().find(|(known, _)| known.map(|_| ()) == op)
    }

    /// h from y, dt, dw and t.
    pub fn energy_tape(&self) -> Tape {
        self.tape(&[self.energy], [Y, DT, DW, TIME])
    }

    /// The entries of I − ½A(v) from v, row by row.
    pub fn cayley_matrix_tape(&mut self) -> Tape {
        let matrix = cayley::matrix(&mut self.graph, &self.field).concat();
        self.tape(&matrix, [V])
    }

    fn tape(&self, roots: &[Id], groups: impl IntoIterator<Item = usize>) -> Tape {
        let groups: Vec<_> = groups.into_iter().map(|group| self.group(group)).collect();
        Tape::new(&self.graph, roots, &groups)
    }
}
