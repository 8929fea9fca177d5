//! Poisson systems from texts.

mod average;
mod cayley;
mod definition;
mod expressions;
mod flows;
mod parts;
mod program;
mod sparse;

use std::{
    ops::Range,
    slice::{from_mut, from_ref},
    sync::Arc,
};

use dgrad::{Rule, nodes_for_degree};
use real::{Bounded, Row, WIDTH};
use systems::{
    Linearity, SystemError,
    probe::shown_solvable,
    run_time::{Description, InTime, Move, Op, Parts, Program, Recorded, System, Weights},
};

pub use definition::{Bath, Definition, DefinitionError, Equation, Structure, Which};
pub use program::FormulaProgram;

use crate::{Formula, Graph, Id, Names, Tape};
use definition::Formulas;
use expressions::Expressions;
use program::{Key, Programs};

/// Nodes of the averaged gradient of functions that are not polynomials, and the most for a
/// polynomial. The error of n nodes is of order |b − a|²ⁿ.
const NODES: usize = 8;
const MAX_NODES: usize = 16;
/// Expressions beyond which no more are written out.
const MAX_EXPRESSIONS: usize = 100_000;
/// Most components that the linearly implicit step may couple where it is shown to have a solution.
const MAX_BLOCK: usize = 200;

/// A [`System`] from texts: B, H₀ and Hₘ as formulas in named components and parameters.
///
/// B may be given in full, and is then checked to be skew, or above the diagonal; only the entries
/// above the diagonal are used. Gradients, Hessians, derivatives of B, the Itô correction and the
/// linearly implicit step are derived as expressions, and each is a [`Tape`]. Or an [`Equation`] by
/// its fields, see [`Description::plain`].
///
/// ```
/// use formula::{Definition, FormulaSystem};
/// use real::Rows;
/// use systems::run_time::{Op, System, Weights};
///
/// let words = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect::<Vec<_>>();
/// let definition = Definition {
///     name: "rigid body".into(),
///     state: words(&["y1", "y2", "y3"]),
///     vectors: Vec::new(),
///     parameters: vec![("c".into(), 0.5)],
///     structure: vec![words(&["-y3", "y2"]), words(&["-y1"])].into(),
///     energy: "(y1^2/2 + y2^2 + 2*y3^2)/2".into(),
///     noises: words(&["c*y1^2/2"]),
///     ..Definition::default()
/// };
/// let body = FormulaSystem::new(&definition, &[0.6, 0.0, 0.8])?;
/// assert!(body.description().is_quadratic() && body.description().always_solvable);
///
/// let (y, dw) = (Rows::splat(&[0.6, 0.0, 0.8]), Rows::splat(&[0.3]));
/// let mut scratch = Rows::zero(body.description().scratch_rows());
/// let (mut gradient, h) = (Rows::zero(3), Weights { dt: 0.01, dw: &dw, ..Weights::NONE });
/// body.apply(Op::Gradient { y: &y }, 0..3, h, &mut gradient, &mut scratch);
/// assert!((gradient[0][5] - 0.6 * (0.005 + 0.5 * 0.3)).abs() < 1e-16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct FormulaSystem {
    description: Description,
    formulas: Arc<Formulas>,
    /// Terms without a known flow.
    rest: Option<Box<Self>>,
    energy: Tape,
    guard: Option<FormulaProgram>,
    walls: Option<Tape>,
    expressions: Expressions,
    programs: Programs,
}

impl FormulaSystem {
    /// The system of these texts, all of which must have values and derivatives at `y0`.
    ///
    /// # Errors
    /// [`DefinitionError`] with the formula and the place in it.
    pub fn new(definition: &Definition, y0: &[f64]) -> Result<Self, DefinitionError> {
        Ok(Self::with_parts(definition, Arc::new(Formulas::new(definition, y0)?), y0))
    }

    /// The system of formulas, with the flows of its parts.
    fn with_parts(definition: &Definition, formulas: Arc<Formulas>, y0: &[f64]) -> Self {
        let mut expressions = Expressions::new(&formulas, None);
        let none = match (expressions.is_plain(), expressions.baths.is_empty()) {
            (true, _) => Some("an equation of drift and noise alone is no sum of such parts"),
            (_, false) => Some("what a heat bath does has no exact flow"),
            _ => None,
        };
        if let Some(none) = none {
            return Self::of(definition, formulas, expressions, Err(none.into()), y0);
        }
        let (parts, graph, rest) = expressions.find_parts(&definition.state);
        let rest = (parts.is_ok() && !rest.is_empty()).then(|| {
            let expressions = Expressions::new(&formulas, Some((&graph, &rest)));
            let none = Err("it is a part itself".into());
            Box::new(Self::of(definition, Arc::clone(&formulas), expressions, none, y0))
        });
        Self { rest, ..Self::of(definition, formulas, expressions, parts, y0) }
    }

    /// The system with H₀ = 0 and the noises H₀, H₁, …, whose flows follow single Hamiltonians for
    /// times that differ from path to path; without baths.
    #[must_use]
    pub fn by_flows(&self, y0: &[f64]) -> Self {
        let mut formulas = Formulas::clone(&self.formulas);
        let zero = Formula::parse("0", &formulas.names).expect("a number is a formula");
        formulas.hamiltonians.insert(0, zero);
        (formulas.temperatures, formulas.fields, formulas.ito) = (Vec::new(), Vec::new(), false);
        let state = formulas.names.variables().to_vec();
        let name = self.description.name.clone();
        let definition = Definition { name, state, ..Definition::default() };
        Self::with_parts(&definition, Arc::new(formulas), y0)
    }

    fn of(
        definition: &Definition,
        formulas: Arc<Formulas>,
        mut expressions: Expressions,
        parts: Result<Parts, String>,
        y0: &[f64],
    ) -> Self {
        let has_step = expressions.of(&Op::Cayley { y: (), v: () }).is_some();
        let [of_structure, of_energy] = expressions.degrees();
        let plain = expressions.is_plain();
        let linearity = match of_structure.filter(|_| has_step && !plain) {
            Some(0) => Linearity::Constant,
            Some(1) => Linearity::Affine,
            _ => Linearity::Other,
        };
        let nodes = of_energy.filter(|_| !plain).map_or(NODES, |degree| {
            nodes_for_degree(degree.saturating_sub(1) as usize).clamp(1, MAX_NODES)
        });
        let always_solvable = match linearity {
            Linearity::Other => false,
            Linearity::Constant => true,
            Linearity::Affine => {
                let blocks = expressions.cayley_blocks();
                let matrices = |v: &[f64]| {
                    let matrix = |(size, matrix): &(usize, Tape)| {
                        let mut entries = vec![0.0; size * size];
                        matrix.evaluate_one(&[v], &mut entries);
                        entries.chunks(*size).map(Vec::from).collect()
                    };
                    blocks.iter().map(matrix).collect()
                };
                blocks.iter().all(|(size, _)| *size <= MAX_BLOCK)
                    && shown_solvable(y0.len(), matrices)
            }
        };
        let rule = Rule::new(nodes).expect("a rule has a node or more");
        let parameters = definition.parameters.iter();
        let parameters = parameters.map(|(name, value)| format!("{name} = {value}"));
        let (dimension, noises) = (definition.state.len(), formulas.hamiltonians.len() - 1);
        let has_guard = expressions.have_domain();
        let [noises_commute, jacobi_holds] = expressions.commutators(y0);
        let description = Description {
            parameters: parameters.collect::<Vec<_>>().join(", "),
            linearity,
            joined: expressions.joined(),
            always_solvable,
            has_guard,
            depends_on_time: expressions.depend_on_time(),
            has_bath: !expressions.baths.is_empty(),
            jacobi_holds,
            noises_commute,
            additive: expressions.additive(),
            is_langevin: expressions.is_langevin(y0),
            plain,
            parts,
            ..Description::new(&definition.name, dimension, noises, rule)
        };
        let mut system = Self {
            rest: None,
            description,
            energy: expressions.energy_tape(),
            walls: expressions.walls(),
            guard: has_guard.then(|| FormulaProgram::guard(&mut expressions)),
            expressions,
            programs: Programs::default(),
            formulas,
        };
        // More rows have dt and t.
        system.description.own_scratch_rows = system.energy.scratch_rows() + 2;
        system
    }

    /// The names of components and parameters, for more formulas.
    #[must_use]
    pub fn names(&self) -> &Names {
        &self.formulas.names
    }

    /// Whether B, a Hamiltonian or a field has kinks, so that fields may jump.
    #[must_use]
    pub fn has_kinks(&self) -> bool {
        self.formulas.all().any(Formula::has_kinks)
    }

    /// The coordinates of momenta p: the q with B∇q = b·e_p and a constant b; none if there is
    /// none.
    #[must_use]
    pub fn coordinates(&self, momenta: &[usize]) -> Vec<Option<Coordinate>> {
        self.expressions.clone().coordinates(momenta)
    }

    /// The baths that are linear friction: number of the bath, component, and rate γ, where
    /// B∇Φ u = −γy on one component, with constant B∇Φ and γ.
    #[must_use]
    pub fn friction(&self) -> Vec<(usize, usize, f64)> {
        self.expressions.clone().friction()
    }

    /// The power of heat as a function of the state: the change of E\[H₀\] in time by these noises,
    /// counted from 0, with the drift that baths give them, and by friction with these rates on
    /// components. Its averages over the stationary law, for all baths, have the sum zero.
    #[must_use]
    pub fn heat(&self, noises: &[usize], friction: &[(usize, f64)]) -> Tape {
        self.expressions.clone().heat(noises, friction)
    }

    /// The equation dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ as it was understood, a line for each
    /// component, with the values of the parameters: `dp = -q dt + 0.5 ∘ dW1`. −γy stands in those
    /// that are `damped`.
    #[must_use]
    pub fn equations(&self, damped: &[bool]) -> Vec<String> {
        self.expressions.clone().equations(self.formulas.names.variables(), damped)
    }
}

/// The coordinate of a momentum p.
pub struct Coordinate {
    /// Number of the component.
    pub component: usize,
    /// m/b² with H₀ = p²/2m + …; or a component besides that ∂H₀/∂p depends on, if it has another
    /// form.
    pub mass: Result<f64, Option<usize>>,
}

impl System for FormulaSystem {
    fn description(&self) -> &Description {
        &self.description
    }

    fn apply(
        &self,
        op: Op<&[Row]>,
        _: Range<usize>,
        h: Weights<'_>,
        out: &mut [Row],
        _: &mut [Row],
    ) {
        let mut inputs = Vec::new();
        let op = op.map(|state| {
            inputs.push(state);
            inputs.len() - 1
        });
        let count = inputs.len();
        let states = (0..count).map(Recorded::Input);
        let nodes: Vec<Recorded> = states.chain([Recorded::Of(op)]).collect();
        match self.compile(&nodes, count, &[count]) {
            Some(mut program) => program.run(&inputs, &[], h, out),
            None => unreachable!("{} has no {op:?}", self.description.name),
        }
    }

    /// Compiles the whole formula of a scheme into one tape.
    fn compile(
        &self,
        operations: &[Recorded],
        inputs: usize,
        results: &[usize],
    ) -> Option<Box<dyn Program>> {
        let key = Key::Formula(operations.into(), inputs, results.into());
        self.programs.program(&self.expressions, key)
    }

    fn rest(&self) -> Option<&dyn System> {
        self.rest.as_deref().map(|rest| rest as _)
    }

    fn compose(&self, moves: &[Move]) -> Option<Box<dyn Program>> {
        self.programs.program(&self.expressions, Key::Composition(moves.into()))
    }

    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, scratch: &mut [Row]) {
        let (times, scratch) = scratch.split_at_mut(2);
        times.copy_from_slice(&[[h.dt; WIDTH], [h.t; WIDTH]]);
        let inputs = [y, &times[..1], h.dw, &times[1..]];
        self.energy.evaluate(&inputs, from_mut(out), scratch);
    }

    fn in_time(&self, y: &[f64]) -> Option<Box<dyn InTime>> {
        let (graph, roots) = self.expressions.clone().in_time(y);
        let tape = Tape::new(&graph, &roots, from_ref(&(0..1)));
        Some(Box::new(Expressed { graph, roots, tape }))
    }

    fn walls(&self, y: &[Row]) -> Vec<Row> {
        self.walls.as_ref().map_or(Vec::new(), |walls| walls.rows(&[y]))
    }

    /// H₀ + H₁ + … and the entries of B.
    fn guard(&self) -> Option<Box<dyn Program>> {
        Some(Box::new(self.guard.clone()?))
    }

    /// The formulas of B, H₀ and Hₘ, or of fields, must be finite. The error names the first
    /// component that the formula uses which is not.
    fn check_domain(&self, y: &[f64]) -> Result<(), SystemError> {
        let start = [y, &[0.0]].concat();
        let at_start = |formula: &&Formula| formula.value(&start[..formula.variables.len()]);
        let outside = self.formulas.all().find(|formula| !at_start(formula).is_finite());
        outside.map_or(Ok(()), |formula| {
            let i = formula.reads().into_iter().find(|&i| i < y.len()).unwrap_or(0);
            Err(SystemError::outside_domain(i + 1, y[i], "that all formulas are finite"))
        })
    }
}

/// Functions of time as expressions in t.
struct Expressed {
    graph: Graph,
    roots: Vec<Id>,
    tape: Tape,
}

impl InTime for Expressed {
    fn values(&self, times: &Row) -> Vec<Row> {
        self.tape.rows(&[&[*times]])
    }

    fn bounds(&self, time: Bounded) -> Vec<Bounded> {
        self.graph.values(&self.roots, |_| time)
    }
}
