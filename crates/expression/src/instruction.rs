//! The instructions of a tape, and the loop that runs them.

use real::Real;

use crate::graph::Unary;

/// An operation on rows a, …, d and numbers k, l, m, see [`run`]. Every product and every sum is
/// rounded: there is no fused multiply-add. A factor that is not wanted is one, and a difference is
/// a sum with the factor −1, both exact: they cost no time beside the rows that are read and
/// written.
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
    ScaleAdd,
    AddNumber,
    MulAdd,
    MulAddNumber,
    MulAddMul,
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
            of Neg Abs Sqrt Exp Ln Sin Cos Tan Sinh Cosh Tanh Sinc;
            SinBesideCos, [a], [] => Real::sin(a);
            Copy, [a], [] => a;
            Fill, [], [k] => k;
            Mul, [a b], [k] => (a * b) * k;
            Scale, [a], [k] => a * k;
            Div, [a b], [] => a / b;
            NumberDiv, [a], [k] => k / a;
            DivNumber, [a], [k] => a / k;
            Min, [a b], [] => Real::min(a, b);
            Max, [a b], [] => Real::max(a, b);
            Where, [a b c d], [] => Real::where_less(a, b, c, d);
            Add, [a b], [k _l m] => (a + b * m) * k;
            ScaleAdd, [a b], [k l m] => (a * l + b * m) * k;
            AddNumber, [a], [k l m] => (a * l + m) * k;
            MulAdd, [a b c], [k l m] => (a * b * l + c * m) * k;
            MulAddNumber, [a b], [k l m] => (a * b * l + m) * k;
            MulAddMul, [a b c d], [k l m] => (a * b * l + c * d * m) * k;
        }
    };
}

impl Instruction {
    /// The value from those of rows and numbers, for any numbers: of `f64` the bits of the tape.
    pub fn value<R: Real>(&self, row: impl Fn(Place) -> R, number: impl Fn(u32) -> R) -> R {
        use {Operation::*, Unary::*};
        let Self { operation, from, numbers, .. } = self;
        macro_rules! of_one {
            (of $($function:ident)*; $($rest:tt)*) => {
                of_one! { $(Of($function), [a], [] => $function.value(a);)* $($rest)* }
            };
            ($($operation:pat, [$($row:ident)*], [$($number:ident)*] => $value:expr;)*) => {
                match operation {
                    $($operation => {
                        let (mut _from, mut _at) = (from.iter(), numbers.iter());
                        $(let $row = row(_from.next().copied().unwrap_or_default());)*
                        $(let $number = number(_at.next().copied().unwrap_or_default());)*
                        $value
                    })*
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
        if let (SinBesideCos, Some(next)) = (operation, rest.as_slice().first()) {
            let a = find(from.first(), inputs, scratch, out);
            let (mut sine, mut cosine) = ([0.0; W], [0.0; W]);
            for p in 0..W {
                (sine[p], cosine[p]) = Real::sin_cos(a[p]);
            }
            store(sine, *to, scratch, out);
            store(cosine, next.to, scratch, out);
            rest.next();
            continue;
        }
        // A plain loop over lanes for each operation. The result is a value that overlaps with no
        // operand, and so the compiler vectorises the loop and keeps the result in registers.
        macro_rules! on_lanes {
            (of $($function:ident)*; $($rest:tt)*) => {
                on_lanes! { $(Of($function), [a], [] => $function.value(a);)* $($rest)* }
            };
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
                }
            };
        }
        operations!(on_lanes);
    }
}
