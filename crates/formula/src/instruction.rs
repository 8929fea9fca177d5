//! The instructions of a tape, and the loop that runs them.

use crate::functions;

/// What an instruction computes from rows a, b, c, d and numbers k, l. Every product and every sum
/// is rounded: there is no fused multiply-add.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    Copy,
    Fill,
    Neg,
    Abs,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Tan,
    Sinh,
    Cosh,
    Tanh,
    Add,
    AddNumber,
    Sub,
    NumberSub,
    Mul,
    Scale,
    Div,
    NumberDiv,
    DivNumber,
    Min,
    Max,
    Where,
    NegMul,
    MulMul,
    ScaleMul,
    AddMul,
    DifferenceMul,
    MulAdd,
    MulSub,
    SubMul,
    MulAddNumber,
    NumberSubMul,
    ScaleAdd,
    ScaleSub,
    ScaleAddNumber,
    ScaleAddScale,
    MulAddMul,
    MulSubMul,
}

/// The rows that an instruction finds, by number. The inputs come first.
pub const MAX_INPUTS: usize = 4;
pub const SCRATCH_BEFORE: u32 = 4;
pub const SCRATCH_AFTER: u32 = 5;
pub const OUT_BEFORE: u32 = 6;
pub const OUT_AFTER: u32 = 7;
const BANKS: usize = 8;

/// Where an operand is: a row of an input, or of the rows of scratch or of results before or after
/// the row that is written.
#[derive(Clone, Copy, Debug, Default)]
pub struct Source {
    pub bank: u32,
    pub row: u32,
}

/// Where a result goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    Scratch(u32),
    Out(u32),
}

/// An operation with its rows and numbers. No operand is the row that is written.
#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    pub operation: Operation,
    pub to: Target,
    pub from: [Source; 4],
    pub numbers: [f64; 2],
}

/// A function for each operation: a plain loop over lanes. The arguments of a function do not
/// overlap, and so the compiler vectorises it without tests.
macro_rules! on_lanes {
    ($($name:ident($($row:ident),*; $($number:ident),*) = $value:expr;)*) => {$(
        #[inline(always)]
        pub fn $name<const W: usize>(
            to: &mut [f64; W],
            $($row: &[f64; W],)*
            $($number: f64,)*
        ) {
            for p in 0..W {
                $(let $row = $row[p];)*
                to[p] = $value;
            }
        }
    )*};
}

mod lanes {
    use super::functions;
    use real::elementary;

    on_lanes! {
        copy(a; ) = a;
        fill(; k) = k;
        neg(a; ) = -a;
        abs(a; ) = a.abs();
        sqrt(a; ) = a.sqrt();
        exp(a; ) = elementary::exp(a);
        ln(a; ) = elementary::ln(a);
        sin(a; ) = elementary::sin(a);
        cos(a; ) = elementary::cos(a);
        tan(a; ) = functions::tan(a);
        sinh(a; ) = functions::sinh(a);
        cosh(a; ) = functions::cosh(a);
        tanh(a; ) = functions::tanh(a);
        add(a, b; ) = a + b;
        add_number(a; k) = a + k;
        sub(a, b; ) = a - b;
        number_sub(a; k) = k - a;
        mul(a, b; ) = a * b;
        scale(a; k) = a * k;
        div(a, b; ) = a / b;
        number_div(a; k) = k / a;
        div_number(a; k) = a / k;
        min(a, b; ) = functions::min(a, b);
        max(a, b; ) = functions::max(a, b);
        where_less(a, b, c, d; ) = functions::where_less(a, b, c, d);
        neg_mul(a, b; ) = -(a * b);
        mul_mul(a, b, c; ) = (a * b) * c;
        scale_mul(a, b; k) = (a * k) * b;
        add_mul(a, b, c; ) = (a + b) * c;
        difference_mul(a, b, c; ) = (a - b) * c;
        mul_add(a, b, c; ) = a * b + c;
        mul_sub(a, b, c; ) = a * b - c;
        sub_mul(a, b, c; ) = c - a * b;
        mul_add_number(a, b; k) = a * b + k;
        number_sub_mul(a, b; k) = k - a * b;
        scale_add(a, b; k) = a * k + b;
        scale_sub(a, b; k) = a * k - b;
        scale_add_number(a; k, l) = a * k + l;
        scale_add_scale(a, b; k, l) = a * k + b * l;
        mul_add_mul(a, b, c, d; ) = a * b + c * d;
        mul_sub_mul(a, b, c, d; ) = a * b - c * d;
    }
}

/// Runs the instructions on rows of W numbers.
#[inline(always)]
pub fn run<const W: usize>(
    code: &[Instruction],
    inputs: [&[[f64; W]]; MAX_INPUTS],
    out: &mut [[f64; W]],
    scratch: &mut [[f64; W]],
) {
    let [first, second, third, fourth] = inputs;
    for instruction in code {
        let (to, scratch_before, scratch_after, out_before, out_after);
        match instruction.to {
            Target::Scratch(row) => {
                let (before, rest) = scratch.split_at_mut(row as usize);
                let (written, after) = rest.split_at_mut(1);
                (to, scratch_before, scratch_after) = (&mut written[0], &*before, &*after);
                (out_before, out_after) = (&*out, &[][..]);
            }
            Target::Out(row) => {
                let (before, rest) = out.split_at_mut(row as usize);
                let (written, after) = rest.split_at_mut(1);
                (to, out_before, out_after) = (&mut written[0], &*before, &*after);
                (scratch_before, scratch_after) = (&*scratch, &[][..]);
            }
        }
        let banks: [&[[f64; W]]; BANKS] =
            [first, second, third, fourth, scratch_before, scratch_after, out_before, out_after];
        let row = |operand: usize| {
            let Source { bank, row } = instruction.from[operand];
            &banks[bank as usize % BANKS][row as usize]
        };
        let [k, l] = instruction.numbers;
        match instruction.operation {
            Operation::Copy => lanes::copy(to, row(0)),
            Operation::Fill => lanes::fill(to, k),
            Operation::Neg => lanes::neg(to, row(0)),
            Operation::Abs => lanes::abs(to, row(0)),
            Operation::Sqrt => lanes::sqrt(to, row(0)),
            Operation::Exp => lanes::exp(to, row(0)),
            Operation::Ln => lanes::ln(to, row(0)),
            Operation::Sin => lanes::sin(to, row(0)),
            Operation::Cos => lanes::cos(to, row(0)),
            Operation::Tan => lanes::tan(to, row(0)),
            Operation::Sinh => lanes::sinh(to, row(0)),
            Operation::Cosh => lanes::cosh(to, row(0)),
            Operation::Tanh => lanes::tanh(to, row(0)),
            Operation::Add => lanes::add(to, row(0), row(1)),
            Operation::AddNumber => lanes::add_number(to, row(0), k),
            Operation::Sub => lanes::sub(to, row(0), row(1)),
            Operation::NumberSub => lanes::number_sub(to, row(0), k),
            Operation::Mul => lanes::mul(to, row(0), row(1)),
            Operation::Scale => lanes::scale(to, row(0), k),
            Operation::Div => lanes::div(to, row(0), row(1)),
            Operation::NumberDiv => lanes::number_div(to, row(0), k),
            Operation::DivNumber => lanes::div_number(to, row(0), k),
            Operation::Min => lanes::min(to, row(0), row(1)),
            Operation::Max => lanes::max(to, row(0), row(1)),
            Operation::Where => lanes::where_less(to, row(0), row(1), row(2), row(3)),
            Operation::NegMul => lanes::neg_mul(to, row(0), row(1)),
            Operation::MulMul => lanes::mul_mul(to, row(0), row(1), row(2)),
            Operation::ScaleMul => lanes::scale_mul(to, row(0), row(1), k),
            Operation::AddMul => lanes::add_mul(to, row(0), row(1), row(2)),
            Operation::DifferenceMul => lanes::difference_mul(to, row(0), row(1), row(2)),
            Operation::MulAdd => lanes::mul_add(to, row(0), row(1), row(2)),
            Operation::MulSub => lanes::mul_sub(to, row(0), row(1), row(2)),
            Operation::SubMul => lanes::sub_mul(to, row(0), row(1), row(2)),
            Operation::MulAddNumber => lanes::mul_add_number(to, row(0), row(1), k),
            Operation::NumberSubMul => lanes::number_sub_mul(to, row(0), row(1), k),
            Operation::ScaleAdd => lanes::scale_add(to, row(0), row(1), k),
            Operation::ScaleSub => lanes::scale_sub(to, row(0), row(1), k),
            Operation::ScaleAddNumber => lanes::scale_add_number(to, row(0), k, l),
            Operation::ScaleAddScale => lanes::scale_add_scale(to, row(0), row(1), k, l),
            Operation::MulAddMul => lanes::mul_add_mul(to, row(0), row(1), row(2), row(3)),
            Operation::MulSubMul => lanes::mul_sub_mul(to, row(0), row(1), row(2), row(3)),
        }
    }
}
