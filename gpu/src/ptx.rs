//! Instructions of PTX as they are written: numbers and words in registers, and operators that
//! write a line each.
//!
//! Every operation on numbers rounds to nearest and none is fused with another, as on the
//! processor. What constants alone give is computed here.

use std::{
    cell::RefCell,
    fmt::{self, Display, Formatter},
    ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Shl, Shr, Sub},
};

/// A number in double precision: a register or a constant, by its bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Register `%f`.
    Register(u32),
    /// A constant.
    Constant(u64),
}

/// A word of 64 bits: a register or a constant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Word {
    /// Register `%w`.
    Register(u32),
    /// A constant.
    Constant(u64),
}

/// A condition in a register `%p`.
#[derive(Clone, Copy, Debug)]
pub struct Condition(u32);

/// A place to jump to.
#[derive(Clone, Copy, Debug)]
pub struct Label(u32);

/// Lines that are being written, and the numbers of registers and labels in use.
#[derive(Default)]
struct Text {
    lines: String,
    numbers: u32,
    words: u32,
    conditions: u32,
    labels: u32,
    /// Whether functions are called, and not written where they are needed.
    calls: bool,
    functions: Vec<(&'static str, String)>,
}

thread_local! {
    /// Operators have no place for it.
    static TEXT: RefCell<Text> = RefCell::default();
}

fn with<R>(f: impl FnOnce(&mut Text) -> R) -> R {
    TEXT.with_borrow_mut(f)
}

/// Writes one line.
pub fn line(text: impl Display) {
    with(|to| {
        to.lines += &format!("\t{text}\n");
    });
}

/// The kernel `name` with 64-bit parameters, whose lines `body` writes. Functions are written where
/// they are needed; in a kernel of many lines, which takes seconds to compile, they are called.
pub fn kernel(name: &str, parameters: &[&str], body: impl Fn()) -> String {
    const MANY: usize = 3000;
    let written = |calls| {
        with(|text| *text = Text { calls, ..Text::default() });
        body();
        with(std::mem::take)
    };
    let mut text = written(false);
    if text.lines.lines().count() > MANY {
        text = written(true);
    }
    let functions = text.functions.iter().map(|(_, function)| function.as_str());
    let functions: String = functions.collect();
    let parameters: Vec<String> =
        parameters.iter().map(|parameter| format!("\t.param .u64 {parameter}")).collect();
    format!(
        ".version 7.0\n.target sm_60\n.address_size 64\n\n{functions}.visible .entry {name}(\n{}\n\
         )\n{{\n{}\t.reg .b32 %r<5>;\n{}}}\n",
        parameters.join(",\n"),
        text.registers(),
        text.lines,
    )
}

impl Text {
    /// The declarations of registers.
    fn registers(&self) -> String {
        let Self { numbers, words, conditions, .. } = self;
        format!(
            "\t.reg .f64 %f<{}>;\n\t.reg .b64 %w<{}>;\n\t.reg .pred %p<{}>;\n",
            numbers + 1,
            words + 1,
            conditions + 1,
        )
    }
}

impl Display for Number {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Register(number) => write!(f, "%f{number}"),
            Self::Constant(bits) => write!(f, "0d{bits:016X}"),
        }
    }
}

impl Display for Word {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Register(number) => write!(f, "%w{number}"),
            Self::Constant(bits) => write!(f, "0x{bits:X}U"),
        }
    }
}

impl Display for Condition {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "%p{}", self.0)
    }
}

impl Display for Label {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "L{}", self.0)
    }
}

impl From<f64> for Number {
    fn from(x: f64) -> Self {
        Self::Constant(x.to_bits())
    }
}

impl From<u64> for Word {
    fn from(x: u64) -> Self {
        Self::Constant(x)
    }
}

impl Number {
    /// A register of its own.
    pub fn new() -> Self {
        with(|text| {
            text.numbers += 1;
            Self::Register(text.numbers)
        })
    }

    /// The value, if it is a constant.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::Register(_) => None,
            Self::Constant(bits) => Some(f64::from_bits(bits)),
        }
    }

    /// The number in a register of its own, which may be set.
    pub fn copied(self) -> Self {
        let to = Self::new();
        to.set(self);
        to
    }

    /// Replaces the content of this register.
    pub fn set(self, value: Self) {
        if self != value {
            line(format_args!("mov.f64 {self}, {value};"));
        }
    }

    fn by(operation: &str, operands: impl Display) -> Self {
        let to = Self::new();
        line(format_args!("{operation} {to}, {operands};"));
        to
    }

    /// The results of a function of numbers, whose lines `body` writes: here, or once.
    pub fn through<const K: usize, const N: usize>(
        of: [Self; K],
        name: &'static str,
        body: fn([Self; K]) -> [Self; N],
    ) -> [Self; N] {
        if of.iter().all(|x| x.value().is_some()) || with(|text| !text.calls) {
            return body(of);
        }
        let list = |of: &[String]| of.join(", ");
        if with(|text| text.functions.iter().all(|(other, _)| *other != name)) {
            let outside = with(std::mem::take);
            let inputs: [String; K] = std::array::from_fn(|k| format!("%x{k}"));
            let arguments = inputs.each_ref().map(|input| Self::by("mov.f64", input));
            let outputs: [String; N] = std::array::from_fn(|k| format!("%y{k}"));
            let results = body(arguments);
            outputs
                .iter()
                .zip(results)
                .for_each(|(to, y)| line(format_args!("mov.f64 {to}, {y};")));
            line("ret;");
            let inside = with(|text| std::mem::replace(text, outside));
            let declared = |names: &[String]| {
                list(&names.iter().map(|of| format!(".reg .f64 {of}")).collect::<Vec<_>>())
            };
            let function = format!(
                ".func ({}) {name} ({})\n{{\n{}{}}}\n\n",
                declared(&outputs),
                declared(&inputs),
                inside.registers(),
                inside.lines,
            );
            with(|text| text.functions.push((name, function)));
        }
        let results = [(); N].map(|()| Self::new());
        let names = results.map(|result| result.to_string());
        let of = of.map(|x| if x.value().is_some() { x.copied() } else { x }.to_string());
        line(format_args!("call ({}), {name}, ({});", list(&names), list(&of)));
        results
    }

    fn one(self, operation: &str, of: fn(f64) -> f64) -> Self {
        match self.value() {
            Some(x) => of(x).into(),
            None => Self::by(operation, self),
        }
    }

    fn two(self, other: Self, operation: &str, of: fn(f64, f64) -> f64) -> Self {
        match (self.value(), other.value()) {
            (Some(a), Some(b)) => of(a, b).into(),
            _ => Self::by(operation, format_args!("{self}, {other}")),
        }
    }

    /// √x.
    pub fn root(self) -> Self {
        self.one("sqrt.rn.f64", f64::sqrt)
    }

    /// |x|, without its sign bit.
    pub fn size(self) -> Self {
        self.one("abs.f64", f64::abs)
    }

    /// The bits.
    pub fn bits(self) -> Word {
        match self {
            Self::Constant(bits) => Word::Constant(bits),
            Self::Register(_) => Word::by("mov.b64", self),
        }
    }

    /// Whether the comparison `how` (lt, le, gt, eq) holds; never for NaN.
    pub fn is(self, how: &str, other: impl Into<Self>) -> Condition {
        Condition::by(&format!("setp.{how}.f64"), format_args!("{self}, {}", other.into()))
    }

    /// One of two numbers.
    pub fn select(condition: Condition, yes: impl Into<Self>, no: impl Into<Self>) -> Self {
        Self::by("selp.f64", format_args!("{}, {}, {condition}", yes.into(), no.into()))
    }

    /// The number at an address and an offset in bytes.
    pub fn load(address: Word, offset: usize) -> Self {
        Self::by("ld.global.f64", format_args!("[{address}+{offset}]"))
    }

    /// The number at an address and an offset in bytes that no thread writes.
    pub fn read(address: Word, offset: usize) -> Self {
        Self::by("ld.global.nc.f64", format_args!("[{address}+{offset}]"))
    }

    /// Writes the number to an address.
    pub fn store(self, address: Word) {
        line(format_args!("st.global.f64 [{address}], {self};"));
    }
}

impl Add for Number {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.two(other, "add.rn.f64", |a, b| a + b)
    }
}

impl Sub for Number {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.two(other, "sub.rn.f64", |a, b| a - b)
    }
}

impl Mul for Number {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        match (self.value(), other.value()) {
            // Exact, and so not needed.
            (Some(1.0), None) => other,
            (None, Some(1.0)) => self,
            (Some(-1.0), None) => -other,
            (None, Some(-1.0)) => -self,
            _ => self.two(other, "mul.rn.f64", |a, b| a * b),
        }
    }
}

impl Div for Number {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let divide = |[a, b]: [Self; 2]| [a.two(b, "div.rn.f64", |a, b| a / b)];
        let [quotient] = Self::through([self, other], "divide", divide);
        quotient
    }
}

impl Neg for Number {
    type Output = Self;
    fn neg(self) -> Self {
        self.one("neg.f64", |x| -x)
    }
}

macro_rules! with_constants {
    ($($operation:ident $method:ident)*) => {
        $(impl $operation<f64> for Number {
            type Output = Self;
            fn $method(self, other: f64) -> Self {
                $operation::$method(self, Self::from(other))
            }
        })*
    };
}

with_constants!(Add add Sub sub Mul mul Div div);

impl Word {
    /// A register of its own.
    pub fn new() -> Self {
        with(|text| {
            text.words += 1;
            Self::Register(text.words)
        })
    }

    /// A word by an operation.
    pub fn by(operation: &str, operands: impl Display) -> Self {
        let to = Self::new();
        line(format_args!("{operation} {to}, {operands};"));
        to
    }

    /// Replaces the content of this register.
    pub fn set(self, value: impl Into<Self>) {
        line(format_args!("mov.b64 {self}, {};", value.into()));
    }

    /// The number with these bits.
    pub fn number(self) -> Number {
        match self {
            Self::Constant(bits) => Number::Constant(bits),
            Self::Register(_) => Number::by("mov.b64", self),
        }
    }

    /// The low 64 bits of the product.
    pub fn times(self, other: impl Into<Self>) -> Self {
        Self::by("mul.lo.u64", format_args!("{self}, {}", other.into()))
    }

    /// The sum, without a carry.
    pub fn plus(self, other: impl Into<Self>) -> Self {
        Self::by("add.u64", format_args!("{self}, {}", other.into()))
    }

    /// The difference, without a borrow.
    pub fn minus(self, other: impl Into<Self>) -> Self {
        Self::by("sub.u64", format_args!("{self}, {}", other.into()))
    }

    /// The bits turned to the left.
    pub fn rotated(self, by: u32) -> Self {
        (self << by) | (self >> (64 - by))
    }

    /// Whether the comparison `how` (lt, ge, eq, ne) holds.
    pub fn is(self, how: &str, other: impl Into<Self>) -> Condition {
        Condition::by(&format!("setp.{how}.u64"), format_args!("{self}, {}", other.into()))
    }

    /// The word at an address and an offset in bytes.
    pub fn load(address: Self, offset: usize) -> Self {
        Self::by("ld.global.u64", format_args!("[{address}+{offset}]"))
    }

    /// Writes the word to an address.
    pub fn store(self, address: Self) {
        line(format_args!("st.global.u64 [{address}], {self};"));
    }
}

macro_rules! on_bits {
    ($($operation:ident $method:ident $name:literal)*) => {
        $(impl<T: Into<Word>> $operation<T> for Word {
            type Output = Self;
            fn $method(self, other: T) -> Self {
                Self::by($name, format_args!("{self}, {}", other.into()))
            }
        })*
    };
}

on_bits!(BitAnd bitand "and.b64" BitOr bitor "or.b64" BitXor bitxor "xor.b64");

impl Shl<u32> for Word {
    type Output = Self;
    fn shl(self, by: u32) -> Self {
        Self::by("shl.b64", format_args!("{self}, {by}"))
    }
}

impl Shr<u32> for Word {
    type Output = Self;
    fn shr(self, by: u32) -> Self {
        Self::by("shr.u64", format_args!("{self}, {by}"))
    }
}

impl Condition {
    fn by(operation: &str, operands: impl Display) -> Self {
        let to = with(|text| {
            text.conditions += 1;
            Self(text.conditions)
        });
        line(format_args!("{operation} {to}, {operands};"));
        to
    }

    /// Goes on at a label if it holds.
    pub fn jump(self, to: Label) {
        line(format_args!("@{self} bra {to};"));
    }

    /// Goes on at a label if it does not hold.
    pub fn jump_unless(self, to: Label) {
        line(format_args!("@!{self} bra {to};"));
    }
}

impl Label {
    /// A label of its own.
    pub fn new() -> Self {
        with(|text| {
            text.labels += 1;
            Self(text.labels)
        })
    }

    /// Puts the label here.
    pub fn here(self) {
        with(|text| text.lines += &format!("{self}:\n"));
    }

    /// Goes on at the label.
    pub fn jump(self) {
        line(format_args!("bra {self};"));
    }
}
