//! A formula as a list of operations.

use std::{
    cell::RefCell,
    ops::{Add, Mul, Sub},
};

use systems::run_time::{Op, Recorded, System};

use crate::{Implicit, Increment, Step};

/// The operations of a formula in their order. A formula is recorded anew in every step, since its
/// factors change; the operations do not, and how they are executed is planned once.
#[derive(Default)]
pub struct Recorder(RefCell<Operations>);

/// The operations of a [`Recorder`].
#[derive(Default)]
pub struct Operations {
    /// Recorded operations, inputs first.
    pub nodes: Vec<Recorded>,
    /// The factor of every [`Recorded::Multiple`], 1 elsewhere.
    pub factors: Vec<f64>,
    /// The operations whose results are wanted; none is an input.
    pub results: Vec<usize>,
    /// The operations of the record before.
    before: Vec<Recorded>,
}

impl Operations {
    #[inline(always)]
    fn push(&mut self, node: Recorded, factor: f64) -> usize {
        self.nodes.push(node);
        self.factors.push(factor);
        self.nodes.len() - 1
    }
}

impl Recorder {
    /// Records ψ(ẑ, z), ψ(ẑ, ψ(ẑ, z)) and so on, with a result for each. Returns whether the
    /// operations differ from those of the record before.
    pub fn evaluations<F: Implicit>(
        &mut self,
        formula: &F,
        system: &dyn System,
        step: &Step,
        count: usize,
    ) -> bool {
        let operations = self.0.get_mut();
        std::mem::swap(&mut operations.nodes, &mut operations.before);
        operations.nodes.clear();
        operations.factors.clear();
        operations.results.clear();
        let start = self.push(Recorded::Input(0), 1.0);
        let mut z = if F::EXPLICIT { start } else { self.push(Recorded::Input(1), 1.0) };
        for _ in 0..count {
            z = formula.psi(Recording { system, step, recorder: self }, start, z);
            z = self.result(z);
        }
        let operations = self.0.get_mut();
        operations.nodes != operations.before
    }

    #[inline(always)]
    pub fn push(&self, node: Recorded, factor: f64) -> Symbol<'_> {
        Symbol { recorder: self, number: self.0.borrow_mut().push(node, factor) }
    }

    pub fn of<'a>(&'a self, op: Op<Symbol<'a>>) -> Symbol<'a> {
        self.push(Recorded::Of(op.map(|symbol| symbol.number)), 1.0)
    }

    /// Marks the result of an operation, or a copy of an input, as wanted.
    pub fn result<'a>(&'a self, x: Symbol<'a>) -> Symbol<'a> {
        let is_input = matches!(self.0.borrow().nodes[x.number], Recorded::Input(_));
        let x = if is_input { x * 1.0 } else { x };
        self.0.borrow_mut().results.push(x.number);
        x
    }

    /// The recorded operations.
    pub fn operations(&mut self) -> &Operations {
        self.0.get_mut()
    }
}

/// The result of an operation.
#[derive(Clone, Copy)]
pub struct Symbol<'a> {
    recorder: &'a Recorder,
    /// The number of the operation.
    number: usize,
}

impl Add for Symbol<'_> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        self.recorder.push(Recorded::Sum(self.number, b.number), 1.0)
    }
}

impl Sub for Symbol<'_> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        self.recorder.push(Recorded::Difference(self.number, b.number), 1.0)
    }
}

impl Mul<f64> for Symbol<'_> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: f64) -> Self {
        self.recorder.push(Recorded::Multiple(self.number), factor)
    }
}

/// One step of a system known at run time, which records what a formula asks for.
#[derive(Clone, Copy)]
struct Recording<'a> {
    system: &'a dyn System,
    step: &'a Step,
    recorder: &'a Recorder,
}

impl Recording<'_> {
    /// Whether ∇̄h(a, b) is ∇h at the midpoint, which is computed tile by tile.
    fn averages_by_tiles(&self) -> bool {
        self.system.description().layout.is_tiled() && self.is_quadratic()
    }
}

impl<'a> Increment for Recording<'a> {
    type Vector = Symbol<'a>;

    #[inline]
    fn step(&self) -> &Step {
        self.step
    }

    #[inline]
    fn is_quadratic(self) -> bool {
        self.system.description().is_quadratic()
    }

    #[inline]
    fn structure(self, y: Symbol<'a>, v: Symbol<'a>) -> Symbol<'a> {
        self.recorder.of(Op::Structure { y, v })
    }

    #[inline]
    fn gradient(self, y: Symbol<'a>) -> Symbol<'a> {
        self.recorder.of(Op::Gradient { y })
    }

    #[inline]
    fn averaged_gradient(self, a: Symbol<'a>, b: Symbol<'a>) -> Symbol<'a> {
        if self.averages_by_tiles() {
            return self.gradient((a + b) * 0.5);
        }
        self.recorder.of(Op::AveragedGradient { a, b })
    }

    #[inline]
    fn averaged_field(self, a: Symbol<'a>, b: Symbol<'a>) -> Symbol<'a> {
        if self.averages_by_tiles() {
            return self.field((a + b) * 0.5);
        }
        self.recorder.of(Op::AveragedField { a, b })
    }

    #[inline]
    fn cayley(self, y: Symbol<'a>, v: Symbol<'a>) -> Symbol<'a> {
        self.recorder.of(Op::Cayley { y, v })
    }

    #[inline]
    fn ito_correction(self, y: Symbol<'a>) -> Symbol<'a> {
        self.recorder.of(Op::ItoCorrection { y })
    }

    /// −B(y) times the [`area_gradient`](Self::area_gradient), by Jacobi's identity.
    #[inline]
    fn commutators(self, y: Symbol<'a>) -> Symbol<'a> {
        match self.system.description().noises {
            ..2 => y * 0.0,
            _ => self.structure(y, self.area_gradient(y)) * -1.0,
        }
    }

    #[inline]
    fn area_gradient(self, y: Symbol<'a>) -> Symbol<'a> {
        match self.system.description().noises {
            ..2 => y * 0.0,
            _ => self.recorder.of(Op::AreaGradient { y }),
        }
    }
}
