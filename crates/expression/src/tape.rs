//! Expressions as a list of instructions on rows.

use std::ops::Range;

use real::{Kernel, Row, WIDTH, dispatch};

use crate::{
    Id,
    compile::compile,
    graph::Graph,
    instruction::{Instruction, Place, run},
    uniform::Numbers,
};

/// Most groups of inputs.
const MAX_GROUPS: usize = 8;
/// Rows of scratch that a single point has on the stack.
const FEW: usize = 32;

/// Some expressions of a graph, ready to be evaluated on 32 points at a time.
///
/// The inputs of the graph are divided into groups, for example y and v: a group is a slice of
/// rows. An instruction is a plain loop over 32 numbers, compiled for every instruction set. All
/// run in one [`dispatch`], but for functions such as sin, which have one each. Products and sums
/// are joined where one feeds another alone, each of them rounded. All levels give the same bits, a
/// number does not depend on its neighbours in a row, and
/// [`evaluate_one`](Self::evaluate_one) gives the same bits.
///
/// ```
/// use expression::{Graph, Tape, Unary};
///
/// // x² sin y.
/// let mut graph = Graph::new();
/// let (x, y) = (graph.input(0), graph.input(1));
/// let (square, sin) = (graph.power(x, 2), graph.unary(Unary::Sin, y));
/// let (f, one) = (graph.mul(square, sin), graph.constant(1.0));
/// let gradient = graph.reverse(&[(f, one)], &[0, 1]);
/// let tape = Tape::new(&graph, &gradient, &[0..2]);
///
/// let point = [[3.0; 32], [0.5; 32]];
/// let (mut out, mut scratch) = ([[0.0; 32]; 2], vec![[0.0; 32]; tape.scratch_rows()]);
/// tape.evaluate(&[&point], &mut out, &mut scratch);
/// assert!((out[1][31] - 9.0 * 0.5f64.cos()).abs() < 1e-14);
/// ```
#[derive(Clone, Debug)]
pub struct Tape {
    code: Vec<Instruction>,
    /// [`Numbers::set`] sets those inputs that are the same at all points.
    pub numbers: Numbers,
    inputs: Vec<usize>,
    outputs: usize,
    scratch: usize,
}

impl Tape {
    /// The tape of `outputs`. Each group of inputs is a range of inputs of the graph.
    ///
    /// # Panics
    /// If an input that is used is in no group, or if there are more than eight groups.
    #[must_use]
    pub fn new(graph: &Graph, outputs: &[Id], groups: &[Range<usize>]) -> Self {
        Self::with_numbers(graph, outputs, groups, 0..0)
    }

    /// Tape like that of [`new`](Self::new), with inputs that are the same at all points.
    /// [`evaluate_with`](Self::evaluate_with) takes their numbers.
    pub fn with_numbers(
        graph: &Graph,
        outputs: &[Id],
        groups: &[Range<usize>],
        numbers: Range<usize>,
    ) -> Self {
        let place = |k: usize| {
            let bank = groups.iter().rposition(|group| group.contains(&k))?;
            Some(Place { bank: bank as u32, row: (k - groups[bank].start) as u32 })
        };
        let (code, numbers, scratch) = compile(graph, outputs, place, &numbers);
        assert!(groups.len() <= MAX_GROUPS, "a tape has up to {MAX_GROUPS} groups of inputs");
        let inputs = groups.iter().map(ExactSizeIterator::len).collect();
        Self { code, numbers, inputs, outputs: outputs.len(), scratch }
    }

    /// The rows of scratch that an evaluation needs.
    #[must_use]
    pub fn scratch_rows(&self) -> usize {
        self.scratch
    }

    /// The instructions.
    #[must_use]
    pub fn instructions(&self) -> &[Instruction] {
        &self.code
    }

    /// The number of results.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// The results at 32 points. Nothing is allocated. `scratch` may have any content.
    ///
    /// # Panics
    /// Unless `inputs` has the groups and rows of the tape, `out` has a row for each result, and
    /// `scratch` has at least [`scratch_rows`](Self::scratch_rows) rows.
    pub fn evaluate(&self, inputs: &[&[Row]], out: &mut [Row], scratch: &mut [Row]) {
        self.evaluate_with(&self.numbers, inputs, out, scratch);
    }

    /// The results at 32 points, for what is evaluated now and then: memory is allocated.
    ///
    /// # Panics
    /// Unless `inputs` has the groups and rows of the tape.
    #[must_use]
    pub fn rows(&self, inputs: &[&[Row]]) -> Vec<Row> {
        let [mut out, mut scratch] = [self.outputs, self.scratch].map(|n| vec![[0.0; WIDTH]; n]);
        self.evaluate(inputs, &mut out, &mut scratch);
        out
    }

    /// [`evaluate`](Self::evaluate) with the numbers that are the same at all points.
    pub fn evaluate_with(
        &self,
        numbers: &Numbers,
        inputs: &[&[Row]],
        out: &mut [Row],
        scratch: &mut [Row],
    ) {
        self.check(inputs, out.len(), scratch.len());
        let (code, numbers) = (&self.code, numbers.values());
        dispatch(&mut Evaluation { code, numbers, inputs, out, scratch });
    }

    /// The results at one point, with the bits of [`evaluate`](Self::evaluate).
    ///
    /// # Panics
    /// Unless `inputs` and `out` have a number for each input and result of the tape.
    pub fn evaluate_one(&self, inputs: &[&[f64]], out: &mut [f64]) {
        assert_eq!(inputs.len(), self.inputs.len(), "groups of inputs of a tape");
        // On the stack where that is enough: rates of damping are evaluated a million times.
        let (mut groups, mut few, mut many) = ([&[][..]; MAX_GROUPS], [[0.0]; FEW], Vec::new());
        for (group, input) in groups.iter_mut().zip(inputs) {
            *group = input.as_chunks().0;
        }
        let scratch = if self.scratch <= FEW {
            &mut few[..]
        } else {
            many.resize(self.scratch, [0.0]);
            &mut many
        };
        let groups = &groups[..inputs.len()];
        self.check(groups, out.len(), scratch.len());
        run(&self.code, self.numbers.values(), groups, out.as_chunks_mut().0, scratch);
    }

    fn check<R>(&self, inputs: &[&[R]], out: usize, scratch: usize) {
        assert_eq!(inputs.len(), self.inputs.len(), "groups of inputs of a tape");
        for (group, &rows) in inputs.iter().zip(&self.inputs) {
            assert_eq!(group.len(), rows, "rows of a group of inputs of a tape");
        }
        assert_eq!(out, self.outputs, "results of a tape");
        assert!(scratch >= self.scratch, "a tape needs {} rows of scratch", self.scratch);
    }
}

/// A kernel by reference: one that is a value is copied into its function.
struct Evaluation<'a> {
    code: &'a [Instruction],
    numbers: &'a [f64],
    inputs: &'a [&'a [Row]],
    out: &'a mut [Row],
    scratch: &'a mut [Row],
}

impl Kernel for &mut Evaluation<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        run(self.code, self.numbers, self.inputs, self.out, self.scratch);
    }
}
