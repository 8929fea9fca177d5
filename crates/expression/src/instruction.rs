//! The instructions of a tape, and the loop that runs them.

use real::{Kernel, Real, dispatch};

use crate::graph::Unary;

/// An operation on rows a, …, d and numbers k, l, m, see [`run`]. Every product and every sum is
/// rounded: there is no fused multiply-add. A factor that is not wanted is one, which is exact. The
/// first factor costs no time beside the rows that are read and written; the others cost up to a
/// third of a sum of products, so that sums and differences without them are operations too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    Copy,
    Fill,
    Of(Unary),
    /// The sine, where the next instruction is the cosine of the same row: [`run`] computes both.
    SinBesideCos,
    Mul,
    Scale,
    Div,
    NumberDiv,
    DivNumber,
    Min,
    Max,
    Where,
    Add,
    Sub,
    ScaledAdd,
    AddNumber,
    MulAdd,
    MulSub,
    SubMul,
    ScaledMulAdd,
    MulAddNumber,
    MulAddMul,
    MulSubMul,
    ScaledMulAddMul,
}

/// The bank of scratch rows.
pub const SCRATCH: u32 = u32::MAX - 1;
/// The bank of results.
pub const OUT: u32 = u32::MAX;

/// The most rows that an operation reads.
pub const MAX_ROWS: usize = 4;

/// A row of a bank: of a group of inputs, counted from zero, of scratch, or of the results.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Number of the bank.
    pub bank: u32,
    /// Number of the row.
    pub row: u32,
}

/// An operation with its rows and numbers. The row that is written, of scratch or of the results,
/// may be an operand.
#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    pub(crate) operation: Operation,
    /// The row that is written.
    pub to: Place,
    pub(crate) from: [Place; MAX_ROWS],
    /// Places in the numbers of the tape.
    pub(crate) numbers: [u32; 3],
}

#[inline(always)]
fn find<'a, const W: usize>(
    place: Option<&Place>,
    inputs: &[&'a [[f64; W]]],
    scratch: &'a [[f64; W]],
    out: &'a [[f64; W]],
) -> &'a [f64; W] {
    let place = place.copied().unwrap_or_default();
    let bank = match place.bank {
        SCRATCH => scratch,
        OUT => out,
        bank => inputs[bank as usize],
    };
    &bank[place.row as usize]
}

#[inline(always)]
fn store<const W: usize>(
    value: [f64; W],
    to: Place,
    scratch: &mut [[f64; W]],
    out: &mut [[f64; W]],
) {
    let bank = if to.bank == OUT { out } else { scratch };
    bank[to.row as usize] = value;
}

/// Calls `$then!` with every operation: its rows, its numbers, and the value of them.
macro_rules! operations {
    ($then:ident) => {
        $then! {
            Copy, [a], [] => a;
            Of(Neg), [a], [] => Neg.value(a);
            Of(Abs), [a], [] => Abs.value(a);
            Of(Sqrt), [a], [] => Sqrt.value(a);
            Fill, [], [k] => k;
            Mul, [a b], [k] => (a * b) * k;
            Scale, [a], [k] => a * k;
            Div, [a b], [] => a / b;
            NumberDiv, [a], [k] => k / a;
            DivNumber, [a], [k] => a / k;
            Min, [a b], [] => Real::min(a, b);
            Max, [a b], [] => Real::max(a, b);
            Where, [a b c d], [] => Real::where_less(a, b, c, d);
            Add, [a b], [k] => (a + b) * k;
            Sub, [a b], [k] => (a - b) * k;
            ScaledAdd, [a b], [k l m] => (a * l + b * m) * k;
            AddNumber, [a], [k l m] => (a * l + m) * k;
            MulAdd, [a b c], [k] => (a * b + c) * k;
            MulSub, [a b c], [k] => (a * b - c) * k;
            SubMul, [a b c], [k] => (c - a * b) * k;
            ScaledMulAdd, [a b c], [k l m] => (a * b * l + c * m) * k;
            MulAddNumber, [a b], [k l m] => (a * b * l + m) * k;
            MulAddMul, [a b c d], [k] => (a * b + c * d) * k;
            MulSubMul, [a b c d], [k] => (a * b - c * d) * k;
            ScaledMulAddMul, [a b c d], [k l m] => (a * b * l + c * d * m) * k;
        }
    };
}

impl Instruction {
    /// The value from those of rows and numbers, for any numbers: of `f64` the bits of the tape.
    pub fn value<R: Real>(&self, row: impl Fn(Place) -> R, number: impl Fn(u32) -> R) -> R {
        use {Operation::*, Unary::*};
        let Self { operation, from, numbers, .. } = self;
        macro_rules! of_one {
            ($($operation:pat, [$($row:ident)*], [$($number:ident)*] => $value:expr;)*) => {
                match operation {
                    $($operation => {
                        let (mut _from, mut _at) = (from.iter(), numbers.iter());
                        $(let $row = row(_from.next().copied().unwrap_or_default());)*
                        $(let $number = number(_at.next().copied().unwrap_or_default());)*
                        $value
                    })*
                    Of(function) => function.value(row(from[0])),
                    SinBesideCos => Sin.value(row(from[0])),
                }
            };
        }
        operations!(of_one)
    }
}

/// Runs the instructions on rows of W numbers.
#[inline(always)]
pub fn run<const W: usize>(
    code: &[Instruction],
    numbers: &[f64],
    inputs: &[&[[f64; W]]],
    out: &mut [[f64; W]],
    scratch: &mut [[f64; W]],
) {
    use {Operation::*, Unary::*};
    let mut rest = code.iter();
    while let Some(instruction) = rest.next() {
        let Instruction { operation, to, from, numbers: at } = instruction;
        // A plain loop over lanes for each operation. The result is a value that overlaps with no
        // operand, and so the compiler vectorises the loop and keeps the result in registers.
        macro_rules! on_lanes {
            ($($operation:pat, [$($row:ident)*], [$($number:ident)*] => $value:expr;)*) => {
                match operation {
                    $($operation => {
                        // One after the other: a function that makes arrays is not always inlined.
                        let (mut _from, mut _at) = (from.iter(), at.iter());
                        $(let $row = find(_from.next(), inputs, scratch, out);)*
                        $(let $number = _at.next().map_or(1.0, |&at| numbers[at as usize]);)*
                        let mut value = [0.0; W];
                        for p in 0..W {
                            $(let $row = $row[p];)*
                            value[p] = $value;
                        }
                        store(value, *to, scratch, out);
                    })*
                    Of(function) => {
                        let a = find(from.first(), inputs, scratch, out);
                        store(dispatch(Function { function: *function, a }), *to, scratch, out);
                    }
                    SinBesideCos => {
                        let a = find(from.first(), inputs, scratch, out);
                        let (sine, cosine) = dispatch(SinCos(a));
                        store(sine, *to, scratch, out);
                        if let Some(next) = rest.next() {
                            store(cosine, next.to, scratch, out);
                        }
                    }
                }
            };
        }
        operations!(on_lanes);
    }
}

/// The values of a function on a row. A kernel of its own: in the loop over instructions the
/// compiler loads the constants of all functions into registers, for every sum and product too.
struct Function<'a, const W: usize> {
    function: Unary,
    a: &'a [f64; W],
}

impl<const W: usize> Kernel for Function<'_, W> {
    type Output = [f64; W];

    #[inline(always)]
    fn run(self) -> [f64; W] {
        use Unary::*;
        let mut values = [0.0; W];
        macro_rules! on_lanes {
            ($($function:ident)*) => {
                match self.function {
                    $($function => {
                        for p in 0..W {
                            values[p] = $function.value(self.a[p]);
                        }
                    })*
                }
            };
        }
        on_lanes!(Neg Abs Sqrt Exp Ln Sin Cos Tan Sinh Cosh Tanh Sinc);
        values
    }
}

/// The sines and cosines of a row.
struct SinCos<'a, const W: usize>(&'a [f64; W]);

impl<const W: usize> Kernel for SinCos<'_, W> {
    type Output = ([f64; W], [f64; W]);

    #[inline(always)]
    fn run(self) -> Self::Output {
        let (mut sines, mut cosines) = ([0.0; W], [0.0; W]);
        for p in 0..W {
            (sines[p], cosines[p]) = Real::sin_cos(self.0[p]);
        }
        (sines, cosines)
    }
}
