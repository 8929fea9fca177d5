//! The formula of a scheme on a system from texts, as one tape.

use std::ops::Range;

use real::{Row, Rows, WIDTH};
use systems::run_time::{Node, Program, Weights};

use crate::{Graph, Id, Tape};

/// Most instructions of a program: beyond them an operation takes longer than it costs to begin it,
/// and the program takes long to compile.
const MOST_INSTRUCTIONS: usize = 4000;

/// What the operations of a scheme need, in the inputs y, u, v, dt and dw of a graph.
pub struct Templates {
    pub graph: Graph,
    pub dimension: usize,
    pub noises: usize,
    /// B(y)v.
    pub structure: Vec<Id>,
    /// (∂B(y)·u)v.
    pub structure_along: Vec<Id>,
    /// ∇h(y).
    pub gradient: Vec<Id>,
    /// ∇²h(y)u.
    pub hessian: Vec<Id>,
    /// ½Σ fₘ′fₘ.
    pub ito_correction: Vec<Id>,
    /// z with z = y + B((y+z)/2)v.
    pub cayley: Option<Vec<Id>>,
    /// Places in [0, 1] and weights of the averaged gradient.
    pub rule: (Vec<f64>, Vec<f64>),
}

impl Templates {
    /// The program of these operations on so many inputs; none if it is too long.
    pub fn compile(
        &self,
        nodes: &[Node],
        inputs: usize,
        results: &[usize],
    ) -> Option<Box<dyn Program>> {
        let (d, m) = (self.dimension, self.noises);
        let mut writer = Writer { templates: self, graph: Graph::new(), weights: Vec::new() };
        let mut end = 0;
        let mut group = |length: usize| {
            end += length;
            end - length..end
        };
        let mut groups: Vec<Range<usize>> = (0..inputs).map(|_| group(d)).collect();
        groups.extend([group(1), group(m), group(nodes.len())]);
        let states: Vec<Vec<Id>> =
            groups[..inputs].iter().map(|group| writer.inputs(group.clone())).collect();
        writer.weights = writer.inputs(groups[inputs].start..groups[inputs + 1].end);
        let factors = writer.inputs(groups[inputs + 2].clone());
        let mut values: Vec<Vec<Id>> = Vec::new();
        for (&node, &factor) in nodes.iter().zip(&factors) {
            let value = writer.operation(node, factor, &states, &values)?;
            if writer.graph.len() > MOST_INSTRUCTIONS {
                return None;
            }
            values.push(value);
        }
        let results: Vec<Id> = results.iter().flat_map(|&result| values[result].clone()).collect();
        let tape = Tape::new(&writer.graph, &results, &groups);
        let scratch = Rows::zero(tape.scratch_rows()).ok()?;
        let [dt, factors] = [Rows::zero(1).ok()?, Rows::zero(nodes.len()).ok()?];
        let is_multiple = nodes.iter().map(|node| matches!(node, Node::Multiple(_))).collect();
        Some(Box::new(FormulaProgram { tape, scratch, dt, factors, is_multiple }))
    }
}

/// A graph that is being written.
struct Writer<'a> {
    templates: &'a Templates,
    graph: Graph,
    /// dt, dw₁, …
    weights: Vec<Id>,
}

impl Writer<'_> {
    fn inputs(&mut self, range: Range<usize>) -> Vec<Id> {
        range.map(|k| self.graph.input(k)).collect()
    }

    fn operation(
        &mut self,
        node: Node,
        factor: Id,
        states: &[Vec<Id>],
        values: &[Vec<Id>],
    ) -> Option<Vec<Id>> {
        let templates = self.templates;
        Some(match node {
            Node::Input(k) => states[k].clone(),
            Node::Sum(a, b) => self.each(&values[a], &values[b], Graph::add),
            Node::Difference(a, b) => self.each(&values[a], &values[b], Graph::sub),
            Node::Multiple(a) => values[a].iter().map(|&x| self.graph.mul(x, factor)).collect(),
            Node::Structure { y, v } => self.structure(&values[y], &values[v]),
            Node::StructureAlong { y, u, v } => {
                self.at(&templates.structure_along, &values[y], &values[u], &values[v])
            }
            Node::Gradient { y } => self.gradient(&values[y]),
            Node::Hessian { y, u } => self.hessian(&values[y], &values[u]),
            Node::AveragedGradient { a, b } => self.averaged_gradient(&values[a], &values[b]),
            Node::AveragedHessian { a, b, u } => {
                self.averaged_hessian(&values[a], &values[b], &values[u])
            }
            Node::AveragedField { a, b } => {
                let gradient = self.averaged_gradient(&values[a], &values[b]);
                let middle = self.point(&values[a], &values[b], 0.0);
                self.structure(&middle, &gradient)
            }
            Node::Cayley { y, v } => {
                let cayley = templates.cayley.as_ref()?;
                self.at(cayley, &values[y], &values[y], &values[v])
            }
            Node::ItoCorrection { y } => {
                self.at(&templates.ito_correction, &values[y], &values[y], &values[y])
            }
        })
    }

    fn each(&mut self, a: &[Id], b: &[Id], function: fn(&mut Graph, Id, Id) -> Id) -> Vec<Id> {
        a.iter().zip(b).map(|(&a, &b)| function(&mut self.graph, a, b)).collect()
    }

    /// Expressions of the templates at these y, u and v.
    fn at(&mut self, roots: &[Id], y: &[Id], u: &[Id], v: &[Id]) -> Vec<Id> {
        let inputs = [y, u, v, &self.weights].concat();
        self.graph.import(&self.templates.graph, roots, &inputs)
    }

    fn structure(&mut self, y: &[Id], v: &[Id]) -> Vec<Id> {
        self.at(&self.templates.structure, y, y, v)
    }

    fn gradient(&mut self, y: &[Id]) -> Vec<Id> {
        self.at(&self.templates.gradient, y, y, y)
    }

    fn hessian(&mut self, y: &[Id], u: &[Id]) -> Vec<Id> {
        self.at(&self.templates.hessian, y, u, y)
    }

    /// (a+b)/2 + distance·(b − a), as in [`systems::run_time::averaged_gradient`].
    fn point(&mut self, a: &[Id], b: &[Id], distance: f64) -> Vec<Id> {
        let graph = &mut self.graph;
        let point = |(&a, &b): (&Id, &Id)| {
            let sum = graph.add(a, b);
            let middle = graph.scale(sum, 0.5);
            if distance == 0.0 {
                return middle;
            }
            let difference = graph.sub(b, a);
            let shift = graph.scale(difference, distance);
            graph.add(middle, shift)
        };
        a.iter().zip(b).map(point).collect()
    }

    /// sum + weight·value; the first value begins the sum.
    fn add(&mut self, sum: Option<Vec<Id>>, value: &[Id], weight: f64) -> Vec<Id> {
        let weighted: Vec<Id> = value.iter().map(|&x| self.graph.scale(x, weight)).collect();
        match sum {
            Some(sum) => self.each(&sum, &weighted, Graph::add),
            None => weighted,
        }
    }

    /// ∇̄h(a, b), pair by pair as in [`systems::run_time::averaged_gradient`].
    fn averaged_gradient(&mut self, a: &[Id], b: &[Id]) -> Vec<Id> {
        let (nodes, weights) = &self.templates.rule;
        let mut sum = None;
        for k in 0..nodes.len() / 2 {
            let distance = 0.5 - nodes[k];
            let [lower, upper] = [-distance, distance].map(|distance| {
                let point = self.point(a, b, distance);
                self.gradient(&point)
            });
            let pair = self.each(&lower, &upper, Graph::add);
            sum = Some(self.add(sum, &pair, weights[k]));
        }
        if nodes.len() % 2 == 1 {
            let middle = self.point(a, b, 0.0);
            let gradient = self.gradient(&middle);
            if nodes.len() == 1 {
                return gradient;
            }
            sum = Some(self.add(sum, &gradient, weights[nodes.len() / 2]));
        }
        sum.unwrap_or_default()
    }

    /// ∂∇̄h(a, b)/∂b·u.
    fn averaged_hessian(&mut self, a: &[Id], b: &[Id], u: &[Id]) -> Vec<Id> {
        let (nodes, weights) = &self.templates.rule;
        let mut sum = None;
        for (&node, &weight) in nodes.iter().zip(weights) {
            let point = self.point(a, b, node - 0.5);
            let value = self.hessian(&point, u);
            sum = Some(self.add(sum, &value, weight * node));
        }
        sum.unwrap_or_default()
    }
}

struct FormulaProgram {
    tape: Tape,
    scratch: Rows,
    dt: Rows,
    /// A row for each operation; those of multiples are set.
    factors: Rows,
    is_multiple: Vec<bool>,
}

impl Program for FormulaProgram {
    fn run(&mut self, inputs: &[&[Row]], factors: &[f64], h: Weights<'_>, out: &mut [Row]) {
        self.dt[0] = [h.dt; WIDTH];
        for ((row, &factor), is_multiple) in
            self.factors.iter_mut().zip(factors).zip(&self.is_multiple)
        {
            if *is_multiple {
                *row = [factor; WIDTH];
            }
        }
        let rest = [&self.dt[..], h.dw, &self.factors];
        match *inputs {
            [y] => self.tape.evaluate(&[y, rest[0], rest[1], rest[2]], out, &mut self.scratch),
            [y, z] => {
                self.tape.evaluate(&[y, z, rest[0], rest[1], rest[2]], out, &mut self.scratch);
            }
            [y, z, u] => {
                self.tape.evaluate(&[y, z, u, rest[0], rest[1], rest[2]], out, &mut self.scratch);
            }
            _ => unreachable!("formulas have one to three inputs"),
        }
    }
}
