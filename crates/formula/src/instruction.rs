//! The instructions of a tape, and the loop that runs them.

use crate::functions;

/// What an instruction computes from rows a, …, f and numbers k, l. Every product and every sum is
/// rounded: there is no fused multiply-add. Sums have one more factor, which is one where nothing
/// else is wanted: it costs no time beside the rows that are read and written.
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
    Sinc,
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
    MulAddMulAdd,
    MulSubMulAdd,
    MulAddAddMul,
    Dot,
}

/// The rows that an instruction finds, by number: groups of inputs are counted from zero.
pub const SCRATCH: u32 = u32::MAX - 1;
pub const OUT: u32 = u32::MAX;

/// The most rows that an operation reads.
pub const MOST_ROWS: usize = 6;

/// A row of a bank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    pub bank: u32,
    pub row: u32,
}

/// An operation with its rows and numbers. The row that is written, of scratch or of the results,
/// may be an operand.
#[derive(Clone, Copy, Debug)]
pub struct Instruction {
    pub operation: Operation,
    pub to: Place,
    pub from: [Place; MOST_ROWS],
    /// Places in the numbers of the tape.
    pub numbers: [u32; 2],
}

/// A function for each operation: a plain loop over lanes. The result is a value that overlaps with
/// no operand, and so the compiler vectorises the loop and keeps the result in registers.
macro_rules! on_lanes {
    ($($name:ident($($row:ident),*; $($number:ident),*) = $value:expr;)*) => {$(
        #[inline(always)]
        pub fn $name<const W: usize>(
            $($row: &[f64; W],)*
            $($number: f64,)*
        ) -> [f64; W] {
            let mut value = [0.0; W];
            for p in 0..W {
                $(let $row = $row[p];)*
                value[p] = $value;
            }
            value
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
        sinc(a; ) = elementary::sinc(a);
        add(a, b; k) = (a + b) * k;
        add_number(a; k, l) = (a + k) * l;
        sub(a, b; k) = (a - b) * k;
        number_sub(a; k) = k - a;
        mul(a, b; k) = (a * b) * k;
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
        mul_add(a, b, c; k) = (a * b + c) * k;
        mul_sub(a, b, c; k) = (a * b - c) * k;
        sub_mul(a, b, c; k) = (c - a * b) * k;
        mul_add_number(a, b; k) = a * b + k;
        number_sub_mul(a, b; k) = k - a * b;
        scale_add(a, b; k, l) = (a * k + b) * l;
        scale_sub(a, b; k, l) = (a * k - b) * l;
        scale_add_number(a; k, l) = a * k + l;
        scale_add_scale(a, b; k, l) = a * k + b * l;
        mul_add_mul(a, b, c, d; k) = (a * b + c * d) * k;
        mul_sub_mul(a, b, c, d; k) = (a * b - c * d) * k;
        mul_add_mul_add(a, b, c, d, e; k) = ((a * b + c * d) + e) * k;
        mul_sub_mul_add(a, b, c, d, e; k) = ((a * b - c * d) + e) * k;
        mul_add_add_mul(a, b, c, d, e; k) = ((a * b + c) + d * e) * k;
        dot(a, b, c, d, e, f; k) = ((a * b + c * d) + e * f) * k;
    }
}

#[inline(always)]
fn find<'a, const W: usize>(
    place: Place,
    inputs: &[&'a [[f64; W]]],
    scratch: &'a [[f64; W]],
    out: &'a [[f64; W]],
) -> &'a [f64; W] {
    let bank = match place.bank {
        SCRATCH => scratch,
        OUT => out,
        bank => inputs[bank as usize],
    };
    &bank[place.row as usize]
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
    for instruction in code {
        let Instruction { operation, to, from, numbers: at } = instruction;
        // A macro, since the rows are borrowed until the result is there.
        macro_rules! set {
            ($name:ident($($operand:literal),*; $($number:literal),*)) => {{
                let value = lanes::$name(
                    $(find(from[$operand], inputs, scratch, out),)*
                    $(numbers[at[$number] as usize],)*
                );
                let to_bank = if to.bank == OUT { &mut *out } else { &mut *scratch };
                to_bank[to.row as usize] = value;
            }};
        }
        match operation {
            Operation::Copy => set!(copy(0; )),
            Operation::Fill => set!(fill(; 0)),
            Operation::Neg => set!(neg(0; )),
            Operation::Abs => set!(abs(0; )),
            Operation::Sqrt => set!(sqrt(0; )),
            Operation::Exp => set!(exp(0; )),
            Operation::Ln => set!(ln(0; )),
            Operation::Sin => set!(sin(0; )),
            Operation::Cos => set!(cos(0; )),
            Operation::Tan => set!(tan(0; )),
            Operation::Sinh => set!(sinh(0; )),
            Operation::Cosh => set!(cosh(0; )),
            Operation::Tanh => set!(tanh(0; )),
            Operation::Sinc => set!(sinc(0; )),
            Operation::Add => set!(add(0, 1; 0)),
            Operation::AddNumber => set!(add_number(0; 0, 1)),
            Operation::Sub => set!(sub(0, 1; 0)),
            Operation::NumberSub => set!(number_sub(0; 0)),
            Operation::Mul => set!(mul(0, 1; 0)),
            Operation::Scale => set!(scale(0; 0)),
            Operation::Div => set!(div(0, 1; )),
            Operation::NumberDiv => set!(number_div(0; 0)),
            Operation::DivNumber => set!(div_number(0; 0)),
            Operation::Min => set!(min(0, 1; )),
            Operation::Max => set!(max(0, 1; )),
            Operation::Where => set!(where_less(0, 1, 2, 3; )),
            Operation::NegMul => set!(neg_mul(0, 1; )),
            Operation::MulMul => set!(mul_mul(0, 1, 2; )),
            Operation::ScaleMul => set!(scale_mul(0, 1; 0)),
            Operation::AddMul => set!(add_mul(0, 1, 2; )),
            Operation::DifferenceMul => set!(difference_mul(0, 1, 2; )),
            Operation::MulAdd => set!(mul_add(0, 1, 2; 0)),
            Operation::MulSub => set!(mul_sub(0, 1, 2; 0)),
            Operation::SubMul => set!(sub_mul(0, 1, 2; 0)),
            Operation::MulAddNumber => set!(mul_add_number(0, 1; 0)),
            Operation::NumberSubMul => set!(number_sub_mul(0, 1; 0)),
            Operation::ScaleAdd => set!(scale_add(0, 1; 0, 1)),
            Operation::ScaleSub => set!(scale_sub(0, 1; 0, 1)),
            Operation::ScaleAddNumber => set!(scale_add_number(0; 0, 1)),
            Operation::ScaleAddScale => set!(scale_add_scale(0, 1; 0, 1)),
            Operation::MulAddMul => set!(mul_add_mul(0, 1, 2, 3; 0)),
            Operation::MulSubMul => set!(mul_sub_mul(0, 1, 2, 3; 0)),
            Operation::MulAddMulAdd => set!(mul_add_mul_add(0, 1, 2, 3, 4; 0)),
            Operation::MulSubMulAdd => set!(mul_sub_mul_add(0, 1, 2, 3, 4; 0)),
            Operation::MulAddAddMul => set!(mul_add_add_mul(0, 1, 2, 3, 4; 0)),
            Operation::Dot => set!(dot(0, 1, 2, 3, 4, 5; 0)),
        }
    }
}
