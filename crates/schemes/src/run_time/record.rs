//! A formula as a list of operations.

use std::{
    cell::RefCell,
    ops::{Add, Mul, Sub},
};

use systems::run_time::{Op, Recorded, System};

use crate::{Increment, Step};

/// The operations of a formula in their order. A formula is recorded anew in every step, since its
/// factors change; the operations do not, and how they are executed is planned once.
#[derive(Debug, Default)]
pub struct Recorder(RefCell<Operations>);

#[derive(Debug, Default)]
struct Operations {
    nodes: Vec<Recorded>,
    /// The factor of every [`Recorded::Multiple`], 1 elsewhere.
    factors: Vec<f64>,
    /// The number of operations since the start; those that follow are of an earlier record.
    count: usize,
    /// Whether they differ from those of the record before.
    changed: bool,
}

impl Operations {
    #[inline(always)]
    fn push(&mut self, node: Recorded, factor: f64) -> usize {
        let number = self.count;
        self.count += 1;
        match (self.nodes.get(number), self.factors.get_mut(number)) {
            (Some(known), Some(place)) if *known == node => *place = factor,
            _ => self.change(number, node, factor),
        }
        number
    }

    #[cold]
    #[inline(never)]
    fn change(&mut self, number: usize, node: Recorded, factor: f64) {
        self.nodes.truncate(number);
        self.factors.truncate(number);
        self.nodes.push(node);
        self.factors.push(factor);
        self.changed = true;
    }
}

impl Recorder {
    /// Begins a record with the inputs.
    pub fn restart<const N: usize>(&self) -> [Symbol<'_>; N] {
        let mut operations = self.0.borrow_mut();
        (operations.count, operations.changed) = (0, false);
        drop(operations);
        std::array::from_fn(|input| self.push(Recorded::Input(input), 1.0))
    }

    #[inline(always)]
    fn push(&self, node: Recorded, factor: f64) -> Symbol<'_> {
        Symbol { recorder: self, number: self.0.borrow_mut().push(node, factor) }
    }

    /// Ends with this result, which is the last operation then, and no input. Whether the
    /// operations differ from those of the record before.
    pub fn finish(&mut self, result: usize) -> bool {
        let operations = self.0.get_mut();
        let before = operations.nodes.len();
        operations.count = result + 1;
        if let Recorded::Input(_) = operations.nodes[result] {
            operations.push(Recorded::Multiple(result), 1.0);
        }
        operations.changed || operations.count != before
    }

    /// The operations and the factor of each.
    pub fn operations(&mut self) -> (&[Recorded], &[f64]) {
        let operations = self.0.get_mut();
        (&operations.nodes[..operations.count], &operations.factors[..operations.count])
    }
}

/// The result of an operation.
#[derive(Clone, Copy, Debug)]
pub struct Symbol<'a> {
    recorder: &'a Recorder,
    /// The number of the operation.
    pub number: usize,
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
pub struct Recording<'a> {
    pub system: &'a dyn System,
    pub step: &'a Step,
    pub recorder: &'a Recorder,
}

impl<'a> Recording<'a> {
    /// Whether ∇̄h(a, b) is ∇h at the midpoint, which is computed tile by tile.
    fn averages_by_tiles(&self) -> bool {
        let description = self.system.description();
        description.layout.is_tiled() && description.is_quadratic()
    }

    fn record(self, op: Op<Symbol<'a>>) -> Symbol<'a> {
        self.recorder.push(Recorded::Of(op.map(|symbol| symbol.number)), 1.0)
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
        self.record(Op::Structure { y, v })
    }

    #[inline]
    fn gradient(self, y: Symbol<'a>) -> Symbol<'a> {
        self.record(Op::Gradient { y })
    }

    #[inline]
    fn averaged_gradient(self, a: Symbol<'a>, b: Symbol<'a>) -> Symbol<'a> {
        if self.averages_by_tiles() {
            return self.gradient((a + b) * 0.5);
        }
        self.record(Op::AveragedGradient { a, b })
    }

    #[inline]
    fn averaged_field(self, a: Symbol<'a>, b: Symbol<'a>) -> Symbol<'a> {
        if self.averages_by_tiles() {
            return self.field((a + b) * 0.5);
        }
        self.record(Op::AveragedField { a, b })
    }

    #[inline]
    fn cayley(self, y: Symbol<'a>, v: Symbol<'a>) -> Symbol<'a> {
        self.record(Op::Cayley { y, v })
    }

    #[inline]
    fn ito_correction(self, y: Symbol<'a>) -> Symbol<'a> {
        self.record(Op::ItoCorrection { y })
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
            _ => self.record(Op::AreaGradient { y }),
        }
    }
}
