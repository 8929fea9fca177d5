//! The formula of a scheme on a system as one tape.

use std::{
    iter::once,
    slice::from_ref,
    sync::{Arc, Mutex, PoisonError},
};

use real::{Row, Rows};
use systems::run_time::{MAX_INPUTS, Move, Op, Program, Recorded, Weights};

use super::{
    MAX_EXPRESSIONS,
    average::point,
    expressions::{Expressions, number_of_areas},
    sparse::consecutive,
};
use expression::{Graph, Id, Numbers, Tape};

/// Expressions for each component beyond which a formula of a large system is no tape of its own.
const MAX_PER_COMPONENT: usize = 200;

/// Formulas of schemes that were compiled, so that each is compiled once and not for every block.
#[derive(Default)]
pub struct Programs(Mutex<Vec<(Key, Option<Arc<SchemeTape>>)>>);

/// Content of a tape.
#[derive(PartialEq)]
pub enum Key {
    /// Nodes, the number of inputs, and the nodes that are results.
    Formula(Vec<Recorded>, usize, Vec<usize>),
    /// Moves of a composition.
    Composition(Vec<Move>),
}

impl Programs {
    /// The tape of a formula; none if it would be too long.
    pub fn program(&self, system: &Expressions, key: Key) -> Option<Box<dyn Program>> {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let place = known.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            let compiled = match &key {
                Key::Formula(nodes, inputs, results) => {
                    SchemeTape::formula(system, nodes, *inputs, results)
                }
                Key::Composition(moves) => Some(SchemeTape::composition(system, moves)),
            };
            known.push((key, compiled.map(Arc::new)));
            known.len() - 1
        });
        known[place].1.clone().map(|compiled| Box::new(FormulaProgram::new(compiled)) as _)
    }
}

/// The formula of a scheme on a system of formulas as one tape: of states, the increments with the
/// space-time areas after them, and areas. Beside them stand numbers, which are the same on all
/// paths.
#[derive(Clone)]
pub struct FormulaProgram {
    compiled: Arc<SchemeTape>,
    numbers: Numbers,
    scratch: Rows,
}

struct SchemeTape {
    tape: Tape,
    /// The operations that have a factor.
    multiples: Vec<usize>,
    /// Rows of increments, and of space-time areas after them, if they are read.
    noise_rows: Option<usize>,
    reads_areas: bool,
    /// Whether the last number is the time.
    reads_time: bool,
}

impl SchemeTape {
    fn composition(system: &Expressions, moves: &[Move]) -> Self {
        let (d, m, mut graph) = (system.dimension, system.noises, Graph::new());
        let factor_of = |one: &Move| match *one {
            Move::Scale(factor) | Move::ScaleOne { factor, .. } => factor + 1,
            Move::Flow { .. } => 2,
        };
        let count = moves.iter().map(factor_of).max().unwrap_or(0);
        let reads = |one: &Move| matches!(one, Move::Flow { area, .. } if *area != 0.0);
        let reads_space_time = moves.iter().any(reads);
        // y, dt, factors, t, dw and space-time areas.
        let inputs = consecutive([d, 1, count, 1, m, m]);
        let [mut y, dt, factors, t, dw, areas] = inputs.clone().map(|of| graph.inputs(of));
        for one in moves {
            match *one {
                Move::Scale(k) => y.iter_mut().for_each(|y| *y = graph.mul(*y, factors[k])),
                Move::ScaleOne { component, factor } => {
                    y[component] = graph.mul(y[component], factors[factor]);
                }
                Move::Flow { part, drift, noise, area, only } => {
                    let mut weights = vec![graph.scale(dt[0], drift)];
                    for k in 0..m {
                        let moves = only.is_none_or(|only| k == only);
                        let [noise, area] = if moves { [noise, area] } else { [0.0; 2] };
                        let mut weight = graph.scale(dw[k], noise);
                        graph.add_to(&mut weight, areas[k], area);
                        weights.push(weight);
                    }
                    y = system.flow(part, &mut graph, &y, &weights, t[0]);
                }
            }
        }
        let reads_time = system.depend_on_time();
        let [states, first, _, time, noise, areas] = inputs;
        let noise = noise.start..if reads_space_time { areas.end } else { noise.end };
        let noise_rows = (m > 0).then_some(noise.len());
        let groups: Vec<_> = once(states).chain((m > 0).then_some(noise)).collect();
        let uniform = first.start..time.start + usize::from(reads_time);
        let tape = Tape::with_numbers(&graph, &y, &groups, uniform);
        Self { tape, multiples: (0..count).collect(), noise_rows, reads_areas: false, reads_time }
    }

    fn formula(
        system: &Expressions,
        nodes: &[Recorded],
        inputs: usize,
        results: &[usize],
    ) -> Option<Self> {
        let is_multiple = |n: &usize| matches!(nodes[*n], Recorded::Multiple(_));
        let multiples: Vec<usize> = (0..nodes.len()).filter(is_multiple).collect();
        let (d, m, mut graph) = (system.dimension, system.noises, Graph::new());
        // States, dt, factors, t, dw and areas.
        let all = consecutive([inputs * d, 1, multiples.len(), 1, m, number_of_areas(m)]);
        let [_, dt, factors, t, dw, areas] = all.clone().map(|of| graph.inputs(of));
        let weights = [dt, dw, areas, t].concat();
        let most = MAX_EXPRESSIONS.max(MAX_PER_COMPONENT * d);
        let mut builder = SchemeBuilder { system, graph, weights, states: Vec::new() };
        for (n, &node) in nodes.iter().enumerate() {
            let factor = multiples.iter().position(|&multiple| multiple == n);
            let state = builder.state(node, factor.map(|k| factors[k]))?;
            builder.states.push(state);
            // One operation may be longer.
            if builder.graph.size() > most && nodes.len() > inputs + 1 {
                return None;
            }
        }
        if inputs > MAX_INPUTS {
            return None;
        }
        let states = (0..inputs).map(|k| k * d..(k + 1) * d);
        let reads = |of: fn(&Op<usize>) -> bool| {
            nodes.iter().any(|node| matches!(node, Recorded::Of(op) if of(op)))
        };
        let (reads_noise, reads_areas) = (reads(Op::reads_weights), reads(Op::reads_areas));
        let [_, first, _, time, noise, areas] = all;
        let (noise, areas) = (reads_noise.then_some(noise), reads_areas.then_some(areas));
        let groups: Vec<_> = states.chain(noise).chain(areas).collect();
        let results: Vec<Id> = results.iter().flat_map(|&n| builder.states[n].clone()).collect();
        let reads_time = system.depend_on_time();
        let uniform = first.start..time.start + usize::from(reads_time);
        let tape = Tape::with_numbers(&builder.graph, &results, &groups, uniform);
        let noise_rows = reads_noise.then_some(m);
        Some(Self { tape, multiples, noise_rows, reads_areas, reads_time })
    }
}

impl FormulaProgram {
    fn new(compiled: Arc<SchemeTape>) -> Self {
        let scratch = Rows::zero(compiled.tape.scratch_rows());
        Self { numbers: compiled.tape.numbers.clone(), compiled, scratch }
    }

    /// The guard of a system, a function of y and t; dt is not read.
    pub(super) fn guard(system: &mut Expressions) -> Self {
        let (d, guard, mut graph) = (system.dimension, system.guard(), Graph::new());
        let t = graph.input(d + 1);
        let guard = graph.copy(Some(&system.graph), &[guard], |k| (k >= d).then_some(t));
        let tape = Tape::with_numbers(&graph, &guard, from_ref(&(0..d)), d..d + 2);
        let (multiples, noise_rows) = (Vec::new(), None);
        let guard =
            SchemeTape { tape, multiples, noise_rows, reads_areas: false, reads_time: true };
        Self::new(Arc::new(guard))
    }

    /// The tape.
    #[must_use]
    pub fn tape(&self) -> &Tape {
        &self.compiled.tape
    }

    /// Number of rows of increments and space-time areas, a group of their own, if they are read;
    /// and whether areas are.
    #[must_use]
    pub fn noise(&self) -> (Option<usize>, bool) {
        (self.compiled.noise_rows, self.compiled.reads_areas)
    }

    /// The numbers of a step of size `dt` about the time `t`, with a factor for every operation.
    pub fn numbers(&mut self, factors: &[f64], dt: f64, t: f64) -> &Numbers {
        let SchemeTape { multiples, reads_time, .. } = &*self.compiled;
        let factors = multiples.iter().map(|&multiple| factors[multiple]);
        self.numbers.set(once(dt).chain(factors).chain(reads_time.then_some(t)));
        &self.numbers
    }
}

impl Program for FormulaProgram {
    fn run(&mut self, inputs: &[&[Row]], factors: &[f64], h: Weights<'_>, out: &mut [Row]) {
        self.numbers(factors, h.dt, h.t);
        let SchemeTape { tape, noise_rows, reads_areas, .. } = &*self.compiled;
        let mut groups = [&[][..]; MAX_INPUTS + 2];
        let given = inputs
            .iter()
            .copied()
            .chain(noise_rows.map(|rows| &h.dw[..rows]))
            .chain(reads_areas.then_some(h.areas));
        let count = groups.iter_mut().zip(given).map(|(group, rows)| *group = rows).count();
        tape.evaluate_with(&self.numbers, &groups[..count], out, &mut self.scratch);
    }
}

/// The states of a formula, operation by operation.
struct SchemeBuilder<'a> {
    system: &'a Expressions,
    graph: Graph,
    /// dt, dw₁, …, the areas, and t.
    weights: Vec<Id>,
    states: Vec<Vec<Id>>,
}

impl SchemeBuilder<'_> {
    /// The components of a node; none if it has no expression.
    fn state(&mut self, node: Recorded, factor: Option<Id>) -> Option<Vec<Id>> {
        let of = |n: usize| self.states[n].clone();
        Some(match node {
            Recorded::Input(k) => {
                let d = self.system.dimension;
                self.graph.inputs(k * d..(k + 1) * d)
            }
            Recorded::Sum(a, b) => self.each(&of(a), &of(b), Graph::add),
            Recorded::Difference(a, b) => self.each(&of(a), &of(b), Graph::sub),
            Recorded::Multiple(a) => {
                let (state, factor) = (of(a), factor?);
                state.into_iter().map(|x| self.graph.mul(x, factor)).collect()
            }
            Recorded::Of(op) => self.apply(op.map(of))?,
        })
    }

    fn each(&mut self, a: &[Id], b: &[Id], f: fn(&mut Graph, Id, Id) -> Id) -> Vec<Id> {
        a.iter().zip(b).map(|(&a, &b)| f(&mut self.graph, a, b)).collect()
    }

    /// An operation of the system; none if it has no expression.
    fn apply(&mut self, op: Op<Vec<Id>>) -> Option<Vec<Id>> {
        match op {
            Op::AveragedHessian { a, b, u } => {
                let mut system = self.system.clone();
                let roots = system.averaged_along()?;
                let inputs = [a, b, u, self.weights.clone()].concat();
                Some(self.graph.copy(Some(&system.graph), &roots, |k| Some(inputs[k])))
            }
            Op::AveragedField { a, b } => {
                let y = point(&mut self.graph, &a, &b, 0.0);
                let v = self.apply(Op::AveragedGradient { a, b })?;
                self.apply(Op::Structure { y, v })
            }
            op => {
                let (groups, roots) = self.system.of(&op)?;
                let arguments: Vec<Vec<Id>> = op.arguments().collect();
                // What is not read may be anything.
                let mut states = [&arguments[0]; 3];
                groups.arguments().zip(&arguments).for_each(|(group, state)| states[group] = state);
                let [y, u, v] = states;
                let inputs = [y, u, v, &self.weights[..]].concat();
                Some(self.graph.copy(Some(&self.system.graph), roots, |k| Some(inputs[k])))
            }
        }
    }
}
