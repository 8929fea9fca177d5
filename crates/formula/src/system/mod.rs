//! Poisson systems from texts.

mod average;
mod cayley;
mod definition;
mod elimination;
mod expressions;
mod program;
mod skew;

use std::ops::Range;

use dgrad::{Rule, nodes_for_degree};
use real::{Real, Row, WIDTH, dispatch};
use systems::{
    Linearity, SystemError,
    run_time::{Node, Program, System, Weights},
    shown_solvable,
};

pub use definition::{Definition, DefinitionError, Which};

use crate::{Formula, Names, Tape};
use definition::Formulas;
use elimination::Eliminate;
use expressions::Expressions;
use program::Programs;

/// Nodes of the averaged gradient of what is no polynomial, and the most for a polynomial. The
/// error of n nodes is of order |b − a|²ⁿ.
const NODES: usize = 8;
const MOST_NODES: usize = 16;

/// A [`System`] from texts: B, H₀ and Hₘ as formulas in named components and parameters.
///
/// B may be given in full, and is then checked to be skew, or above the diagonal; only the entries
/// above the diagonal are used. Gradients, Hessians, derivatives of B, the Itô correction and the
/// linearly implicit step are derived as expressions, and each is a [`Tape`].
///
/// ```
/// use formula::{Definition, FormulaSystem};
/// use real::Rows;
/// use systems::run_time::{System, Weights};
///
/// let words = |texts: &[&str]| texts.iter().map(|text| text.to_string()).collect::<Vec<_>>();
/// let definition = Definition {
///     name: "rigid body".into(),
///     state: words(&["y1", "y2", "y3"]),
///     parameters: vec![("c".into(), 0.5)],
///     structure: vec![words(&["-y3", "y2"]), words(&["-y1"])],
///     energy: "(y1^2/2 + y2^2 + 2*y3^2)/2".into(),
///     noises: words(&["c*y1^2/2"]),
///     observables: vec![],
/// };
/// let body = FormulaSystem::new(&definition, &[0.6, 0.0, 0.8])?;
/// assert!(body.is_quadratic() && body.always_solvable());
///
/// let (y, dw) = (Rows::splat(&[0.6, 0.0, 0.8])?, Rows::splat(&[0.3])?);
/// let (mut gradient, mut scratch) = (Rows::zero(3)?, Rows::zero(body.scratch_rows())?);
/// let h = Weights { dt: 0.01, dw: &dw };
/// body.gradient(0..3, &y, h, &mut gradient, &mut scratch);
/// assert!((gradient[0][5] - 0.6 * (0.005 + 0.5 * 0.3)).abs() < 1e-16);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct FormulaSystem {
    definition: Definition,
    names: Names,
    checked: Vec<Formula>,
    structure: Tape,
    structure_along: Tape,
    energy: Tape,
    gradient: Tape,
    hessian: Tape,
    averaged_gradient: Tape,
    ito_correction: Tape,
    observables: Tape,
    guard: Option<Tape>,
    cayley: Cayley,
    expressions: Expressions,
    rule: Rule,
    programs: Programs,
    linearity: Linearity,
    solvable: bool,
    scratch: usize,
}

/// How z = y + B((y+z)/2)v is solved.
enum Cayley {
    /// By a tape that has the whole elimination.
    Tape(Tape),
    /// By elimination on rows.
    Rows { matrix: Tape, right: Tape },
    /// Not at all, since B is not affine.
    None,
}

impl Cayley {
    /// For an affine B.
    fn new(expressions: &mut Expressions) -> Self {
        match expressions.cayley_tape() {
            Some(tape) => Self::Tape(tape),
            None => Self::Rows {
                matrix: expressions.cayley_matrix_tape(),
                right: expressions.right_side_tape(),
            },
        }
    }
}

impl FormulaSystem {
    /// The system of these texts, all of which must have values and derivatives at `y0`.
    ///
    /// # Errors
    /// [`DefinitionError`] with the formula and the place in it.
    pub fn new(definition: &Definition, y0: &[f64]) -> Result<Self, DefinitionError> {
        let formulas = Formulas::new(definition, y0)?;
        let mut expressions = Expressions::new(&formulas);
        let linearity = match expressions.structure_degree() {
            Some(0) => Linearity::Constant,
            Some(1) => Linearity::Affine,
            _ => Linearity::Other,
        };
        let nodes = match expressions.energy_degree() {
            Some(degree) => {
                nodes_for_degree(degree.saturating_sub(1) as usize).clamp(1, MOST_NODES)
            }
            None => NODES,
        };
        let (cayley, solvable) = match linearity {
            Linearity::Other => (Cayley::None, false),
            Linearity::Constant => (Cayley::new(&mut expressions), true),
            Linearity::Affine => {
                let matrix = expressions.cayley_matrix_tape();
                let solvable = shown_solvable(y0.len(), |v| {
                    let mut entries = vec![0.0; v.len() * v.len()];
                    matrix.evaluate_one(&[v], &mut entries);
                    entries.chunks(v.len()).map(Vec::from).collect()
                });
                (Cayley::new(&mut expressions), solvable)
            }
        };
        let mut system = Self {
            definition: definition.clone(),
            structure: expressions.structure_tape(),
            structure_along: expressions.structure_along_tape(),
            energy: expressions.energy_tape(),
            gradient: expressions.gradient_tape(),
            hessian: expressions.hessian_tape(),
            averaged_gradient: expressions.averaged_gradient_tape(),
            ito_correction: expressions.ito_correction_tape(),
            observables: expressions.observables_tape(),
            guard: expressions.have_domain().then(|| expressions.guard_tape()),
            cayley,
            expressions,
            rule: Rule::new(nodes).unwrap_or_else(|error| unreachable!("{error}")),
            programs: Programs::default(),
            linearity,
            solvable,
            scratch: 0,
            names: formulas.names,
            checked: std::iter::once(formulas.energy)
                .chain(formulas.noises)
                .chain(formulas.structure.into_iter().flatten())
                .collect(),
        };
        system.scratch = system.largest_scratch();
        Ok(system)
    }

    fn largest_scratch(&self) -> usize {
        let weighted = [&self.energy, &self.gradient, &self.hessian, &self.averaged_gradient];
        let plain =
            [&self.structure, &self.structure_along, &self.ito_correction, &self.observables];
        let plain = plain.into_iter().chain(&self.guard);
        let cayley = match &self.cayley {
            Cayley::Tape(tape) => tape.scratch_rows(),
            Cayley::Rows { matrix, right } => {
                matrix.outputs() + matrix.scratch_rows().max(right.scratch_rows())
            }
            Cayley::None => 0,
        };
        // One more row has dt.
        let weighted = weighted.iter().map(|tape| tape.scratch_rows() + 1);
        let plain = plain.map(|tape| tape.scratch_rows());
        weighted.chain(plain).chain([cayley]).max().unwrap_or(0)
    }

    /// The texts.
    #[must_use]
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// The names of components and parameters, for more formulas.
    #[must_use]
    pub fn names(&self) -> &Names {
        &self.names
    }

    /// B(y)v on numbers of any type, see [`evaluate`](crate::Graph::evaluate).
    #[must_use]
    pub fn structure_of<R: Real>(&self, y: &[R], v: &[R]) -> Vec<R> {
        self.expressions.field_on(y, v)
    }

    /// h(y) with the weights dt, dw₁, … on numbers of any type, see
    /// [`evaluate`](crate::Graph::evaluate).
    #[must_use]
    pub fn energy_of<R: Real>(&self, y: &[R], weights: &[f64]) -> R {
        self.expressions.energy_on(y, weights)
    }

    /// The observables at y, in their order, one row each. `scratch` has at least
    /// [`scratch_rows`](System::scratch_rows) rows.
    pub fn observe(&self, y: &[Row], out: &mut [Row], scratch: &mut [Row]) {
        self.observables.evaluate(&[y], out, scratch);
    }

    /// The equation dy = (B∇H₀ − γy)dt + Σ B∇Hₘ ∘ dWₘ as it was understood, a line for each
    /// component, with the values of the parameters: `dp = -q dt + 0.5 ∘ dW1`.
    #[must_use]
    pub fn equations(&self, damped: bool) -> Vec<String> {
        self.expressions.clone().equations(&self.definition.state, damped)
    }

    /// The number of instructions for B(y)v, h, ∇h, ∇²h·u, in this order.
    #[must_use]
    pub fn instructions(&self) -> [usize; 4] {
        [&self.structure, &self.energy, &self.gradient, &self.hessian].map(Tape::instructions)
    }
}

/// dt as a row in front of the scratch.
fn with_dt(dt: f64, scratch: &mut [Row]) -> (&[Row], &mut [Row]) {
    let (first, rest) = scratch.split_at_mut(1);
    first[0] = [dt; WIDTH];
    (first, rest)
}

impl System for FormulaSystem {
    fn name(&self) -> &str {
        &self.definition.name
    }

    fn parameters(&self) -> String {
        let each = self.definition.parameters.iter();
        each.map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ")
    }

    fn dimension(&self) -> usize {
        self.definition.state.len()
    }

    fn noises(&self) -> usize {
        self.definition.noises.len()
    }

    fn own_scratch_rows(&self) -> usize {
        self.scratch
    }

    fn structure(&self, _: Range<usize>, y: &[Row], v: &[Row], out: &mut [Row], s: &mut [Row]) {
        self.structure.evaluate(&[y, v], out, s);
    }

    fn structure_along(
        &self,
        _: Range<usize>,
        y: &[Row],
        u: &[Row],
        v: &[Row],
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        self.structure_along.evaluate(&[y, u, v], out, scratch);
    }

    fn energy(&self, y: &[Row], h: Weights<'_>, out: &mut Row, scratch: &mut [Row]) {
        let (dt, scratch) = with_dt(h.dt, scratch);
        self.energy.evaluate(&[y, dt, h.dw], std::slice::from_mut(out), scratch);
    }

    fn gradient(
        &self,
        _: Range<usize>,
        y: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        let (dt, scratch) = with_dt(h.dt, scratch);
        self.gradient.evaluate(&[y, dt, h.dw], out, scratch);
    }

    fn hessian(
        &self,
        _: Range<usize>,
        y: &[Row],
        u: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        let (dt, scratch) = with_dt(h.dt, scratch);
        self.hessian.evaluate(&[y, u, dt, h.dw], out, scratch);
    }

    fn rule(&self) -> &Rule {
        &self.rule
    }

    fn averaged_gradient(
        &self,
        a: &[Row],
        b: &[Row],
        h: Weights<'_>,
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        let (dt, scratch) = with_dt(h.dt, scratch);
        self.averaged_gradient.evaluate(&[a, b, dt, h.dw], out, scratch);
    }

    fn linearity(&self) -> Linearity {
        self.linearity
    }

    fn always_solvable(&self) -> bool {
        self.solvable
    }

    fn cayley(&self, _: Range<usize>, y: &[Row], v: &[Row], out: &mut [Row], s: &mut [Row]) {
        match &self.cayley {
            Cayley::Tape(tape) => tape.evaluate(&[y, v], out, s),
            Cayley::Rows { matrix, right } => {
                let (entries, s) = s.split_at_mut(matrix.outputs());
                matrix.evaluate(&[v], entries, s);
                right.evaluate(&[y, v], out, s);
                dispatch(Eliminate { matrix: entries, x: out });
            }
            Cayley::None => unreachable!("B of {} is not affine", self.name()),
        }
    }

    fn ito_correction(&self, _: Range<usize>, y: &[Row], out: &mut [Row], scratch: &mut [Row]) {
        self.ito_correction.evaluate(&[y], out, scratch);
    }

    /// The whole formula of a scheme is one tape.
    fn compile(
        &self,
        nodes: &[Node],
        inputs: usize,
        results: &[usize],
    ) -> Option<Box<dyn Program>> {
        let (system, rule) = (&self.expressions, &self.rule);
        let program = self.programs.program(system, rule, nodes, inputs, results)?;
        Some(Box::new(program))
    }

    /// Where B, H₀ or Hₘ has a logarithm, a root or a quotient.
    fn has_guard(&self) -> bool {
        self.guard.is_some()
    }

    /// H₀ + H₁ + … and the entries of B.
    fn guard(&self, y: &[Row], out: &mut Row, scratch: &mut [Row]) {
        match &self.guard {
            Some(guard) => guard.evaluate(&[y], std::slice::from_mut(out), scratch),
            None => out.fill(0.0),
        }
    }

    /// The formulas of B, H₀ and Hₘ must be finite. The error names the first component that the
    /// formula uses which is not.
    fn check_domain(&self, y: &[f64]) -> Result<(), SystemError> {
        match self.checked.iter().find(|formula| !formula.value(y).is_finite()) {
            None => Ok(()),
            Some(formula) => {
                let i = (0..y.len()).find(|&i| formula.depends_on(i)).unwrap_or(0);
                let domain = "that all formulas are finite";
                Err(SystemError::OutsideDomain { component: i + 1, value: y[i], domain })
            }
        }
    }
}
