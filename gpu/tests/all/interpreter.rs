//! Interpreter of the PTX that the crate writes: one thread after the other, over 64-bit registers.

use std::collections::HashMap;

use gpu::{Failure, Machine, March, PARAMETERS};

/// An operand: a register by its place, or a constant by its bits.
#[derive(Clone, Copy, Debug)]
enum Operand {
    Register(usize),
    Constant(u64),
}

/// An instruction: opcode, condition with its sense, result, operands, and the target of a jump.
#[derive(Debug)]
struct Line {
    only: Option<(usize, bool)>,
    to: usize,
    from: [Operand; 3],
    offset: u64,
    target: usize,
}

/// A function, or the kernel.
struct Routine {
    lines: Vec<(Op, Line)>,
    registers: usize,
    /// Places of the arguments, two at most, and of the results after them.
    arguments: usize,
}

/// A kernel, after the functions that it calls.
pub struct Kernel(Vec<Routine>);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Op {
    Parameter,
    Thread,
    Blocks,
    Copy,
    Add,
    Sub,
    Mul,
    Fused,
    Div,
    Root,
    Neg,
    Abs,
    Less,
    AtMost,
    Greater,
    Equal,
    Select,
    WordAdd,
    WordSub,
    WordMul,
    And,
    Or,
    Xor,
    Left,
    Right,
    WordEqual,
    WordNot,
    WordLess,
    WordAtLeast,
    ToNumber,
    Load,
    Store,
    Jump,
    Call,
    Return,
}

fn op(code: &str) -> Op {
    use Op::*;
    match code {
        "ld.param.u64" => Parameter,
        "mov.u32" => Blocks,
        "mad.lo.u32" => Blocks,
        "cvt.u64.u32" => Thread,
        "mov.f64" | "mov.b64" => Copy,
        "add.rn.f64" => Add,
        "sub.rn.f64" => Sub,
        "mul.rn.f64" => Mul,
        "fma.rn.f64" => Fused,
        "div.rn.f64" => Div,
        "sqrt.rn.f64" => Root,
        "neg.f64" => Neg,
        "abs.f64" => Abs,
        "setp.lt.f64" => Less,
        "setp.le.f64" => AtMost,
        "setp.gt.f64" => Greater,
        "setp.eq.f64" => Equal,
        "selp.f64" => Select,
        "add.u64" => WordAdd,
        "sub.u64" => WordSub,
        "mul.lo.u64" => WordMul,
        "and.b64" => And,
        "or.b64" => Or,
        "xor.b64" => Xor,
        "shl.b64" => Left,
        "shr.u64" => Right,
        "setp.eq.u64" => WordEqual,
        "setp.ne.u64" => WordNot,
        "setp.lt.u64" => WordLess,
        "setp.ge.u64" => WordAtLeast,
        "cvt.rn.f64.u64" => ToNumber,
        "ld.global.f64" | "ld.global.nc.f64" | "ld.global.u64" => Load,
        "st.global.f64" | "st.global.u64" => Store,
        "bra" => Jump,
        "call" => Call,
        "ret" => Return,
        other => panic!("no instruction {other} is expected"),
    }
}

impl Kernel {
    pub fn new(ptx: &str) -> Self {
        let starts = ptx.match_indices(".func (").chain(ptx.match_indices(".visible"));
        let starts: Vec<usize> = starts.map(|(at, _)| at).collect();
        let ends = starts[1..].iter().copied().chain([ptx.len()]);
        let texts: Vec<&str> = starts.iter().zip(ends).map(|(&at, end)| &ptx[at..end]).collect();
        let name = |text: &&str| {
            let words = text.split_once(") ").map_or("", |(_, rest)| rest);
            words.split(' ').next().unwrap().to_string()
        };
        let names: Vec<String> = texts.iter().map(name).collect();
        Self(texts.iter().map(|text| Routine::new(text, &names)).collect())
    }

    /// Runs one thread on memory by address.
    fn run(&self, thread: u64, parameters: &[u64; 7], memory: &mut Memory<'_>) {
        self.execute(self.0.len() - 1, [0; 2], (thread, parameters), memory);
    }
}

impl Routine {
    fn new(ptx: &str, names: &[String]) -> Self {
        let count = |kind: &str| {
            let at = ptx.find(&format!("%{kind}<")).expect("registers are declared");
            ptx[at + kind.len() + 2..].split('>').next().unwrap().parse::<usize>().unwrap()
        };
        let (numbers, words, conditions) = (count("f"), count("w"), count("p"));
        let arguments = numbers + words + conditions + 5;
        let register = |name: &str| -> usize {
            let place = || name[2..].parse::<usize>().unwrap();
            match &name[..2] {
                "%x" => arguments + place(),
                "%y" => arguments + 2 + place(),
                "%f" => place(),
                "%w" => numbers + place(),
                "%p" => numbers + words + place(),
                "%r" => numbers + words + conditions + place(),
                "%c" | "%n" | "%t" => 0,
                other => panic!("no register {other}"),
            }
        };
        let operand = |text: &str| match text {
            _ if text.starts_with('%') => Operand::Register(register(text)),
            _ if text.starts_with("0d") => {
                Operand::Constant(u64::from_str_radix(&text[2..], 16).unwrap())
            }
            _ if text.starts_with("0x") => {
                let digits = text[2..].trim_end_matches('U');
                Operand::Constant(u64::from_str_radix(digits, 16).unwrap())
            }
            _ => Operand::Constant(text.parse().unwrap()),
        };
        let body = &ptx[ptx.find("{\n").unwrap()..];
        let mut labels = HashMap::new();
        let mut lines = Vec::new();
        for text in body.lines().skip(1).map(str::trim).filter(|text| !text.is_empty()) {
            if let Some(label) = text.strip_suffix(':') {
                labels.insert(label.to_string(), lines.len());
            } else if text != "}" && !text.starts_with(".reg") {
                lines.push(text.trim_end_matches(';').to_string());
            }
        }
        let line = |text: &String| {
            let (only, text) = match text.strip_prefix('@') {
                Some(rest) => {
                    let (condition, rest) = rest.split_once(' ').unwrap();
                    let holds = !condition.starts_with('!');
                    (Some((register(condition.trim_start_matches('!')), holds)), rest)
                }
                None => (None, &text[..]),
            };
            let (code, rest) = text.split_once(' ').unwrap_or((text, ""));
            let mut line =
                Line { only, to: 0, from: [Operand::Constant(0); 3], offset: 0, target: 0 };
            let parts: Vec<&str> =
                rest.split(", ").map(str::trim).filter(|part| !part.is_empty()).collect();
            let address = |text: &str| {
                let inside = text.trim_start_matches('[').trim_end_matches(']');
                let (register, offset) = inside.split_once('+').unwrap_or((inside, "0"));
                (operand(register), offset.parse().unwrap())
            };
            let kind = op(code);
            match kind {
                Op::Jump => line.target = labels[parts[0]],
                Op::Return => {}
                // call (results in a row), name, (arguments)
                Op::Call => {
                    let inside = |text: &str| text.trim_matches(['(', ')']).to_string();
                    let results = 1 + parts.iter().position(|part| part.ends_with(')')).unwrap();
                    line.to = register(&inside(parts[0]));
                    for (k, part) in parts[..results].iter().enumerate() {
                        assert_eq!(register(&inside(part)), line.to + k);
                    }
                    line.target = names.iter().position(|of| of == parts[results]).unwrap();
                    for (part, place) in parts[results + 1..].iter().zip(&mut line.from) {
                        *place = operand(&inside(part));
                    }
                    line.offset = results as u64;
                }
                Op::Parameter => {
                    line.to = register(parts[0]);
                    let name = parts[1].trim_start_matches('[').trim_end_matches(']');
                    line.target = PARAMETERS.iter().position(|of| *of == name).unwrap();
                }
                Op::Load => {
                    line.to = register(parts[0]);
                    let (base, offset) = address(parts[1]);
                    (line.from[0], line.offset) = (base, offset);
                }
                Op::Store => {
                    let (base, offset) = address(parts[0]);
                    ([line.from[0], line.from[1]], line.offset) =
                        ([base, operand(parts[1])], offset);
                }
                _ => {
                    line.to = register(parts[0]);
                    let known = parts[1..].iter().filter(|_| kind != Op::Blocks);
                    let places = known.zip(&mut line.from);
                    places.for_each(|(part, place)| *place = operand(part));
                }
            }
            (kind, line)
        };
        let lines = lines.iter().map(line).collect();
        Self { lines, registers: arguments + 4, arguments }
    }
}

impl Kernel {
    /// Runs a routine of a thread. Returns its results.
    fn execute(
        &self,
        routine: usize,
        arguments: [u64; 2],
        of_thread: (u64, &[u64; 7]),
        memory: &mut Memory<'_>,
    ) -> [u64; 2] {
        let routine = &self.0[routine];
        let (thread, parameters) = of_thread;
        let mut registers = vec![0u64; routine.registers];
        registers[routine.arguments..][..2].copy_from_slice(&arguments);
        let mut at = 0;
        while let Some((op, line)) = routine.lines.get(at) {
            at += 1;
            if line.only.is_some_and(|(condition, holds)| (registers[condition] != 0) != holds) {
                continue;
            }
            let bits = |k: usize| match line.from[k] {
                Operand::Register(place) => registers[place],
                Operand::Constant(bits) => bits,
            };
            let number = |k: usize| f64::from_bits(bits(k));
            let value = match op {
                Op::Parameter => parameters[line.target],
                Op::Thread => thread,
                Op::Blocks => 0,
                Op::Copy => bits(0),
                Op::Add => (number(0) + number(1)).to_bits(),
                Op::Sub => (number(0) - number(1)).to_bits(),
                Op::Mul => (number(0) * number(1)).to_bits(),
                Op::Fused => number(0).mul_add(number(1), number(2)).to_bits(),
                Op::Div => (number(0) / number(1)).to_bits(),
                Op::Root => number(0).sqrt().to_bits(),
                Op::Neg => (-number(0)).to_bits(),
                Op::Abs => number(0).abs().to_bits(),
                Op::Less => u64::from(number(0) < number(1)),
                Op::AtMost => u64::from(number(0) <= number(1)),
                Op::Greater => u64::from(number(0) > number(1)),
                Op::Equal => u64::from(number(0) == number(1)),
                Op::Select => bits(if bits(2) != 0 { 0 } else { 1 }),
                Op::WordAdd => bits(0).wrapping_add(bits(1)),
                Op::WordSub => bits(0).wrapping_sub(bits(1)),
                Op::WordMul => bits(0).wrapping_mul(bits(1)),
                Op::And => bits(0) & bits(1),
                Op::Or => bits(0) | bits(1),
                Op::Xor => bits(0) ^ bits(1),
                Op::Left => bits(0) << bits(1),
                Op::Right => bits(0) >> bits(1),
                Op::WordEqual => u64::from(bits(0) == bits(1)),
                Op::WordNot => u64::from(bits(0) != bits(1)),
                Op::WordLess => u64::from(bits(0) < bits(1)),
                Op::WordAtLeast => u64::from(bits(0) >= bits(1)),
                Op::ToNumber => (bits(0) as f64).to_bits(),
                Op::Load => memory.load(bits(0) + line.offset),
                Op::Store => {
                    memory.store(bits(0) + line.offset, bits(1));
                    continue;
                }
                Op::Jump => {
                    at = line.target;
                    continue;
                }
                Op::Call => {
                    let results = self.execute(line.target, [bits(0), bits(1)], of_thread, memory);
                    for (k, result) in results.iter().enumerate().take(line.offset as usize) {
                        registers[line.to + k] = *result;
                    }
                    continue;
                }
                Op::Return => {
                    return [2, 3].map(|k| registers[routine.arguments + k]);
                }
            };
            registers[line.to] = value;
        }
        panic!("a routine ends with ret")
    }
}

/// Buffers at addresses of their own.
struct Memory<'a> {
    buffers: [&'a mut [u64]; 4],
}

/// Distance of the addresses of buffers.
const APART: u64 = 1 << 40;

impl Memory<'_> {
    fn place(address: u64) -> (usize, usize) {
        assert!(address.is_multiple_of(8), "an address is that of a word: {address:x}");
        ((address / APART - 1) as usize, (address % APART / 8) as usize)
    }

    fn load(&self, address: u64) -> u64 {
        let (buffer, place) = Self::place(address);
        self.buffers[buffer][place]
    }

    fn store(&mut self, address: u64, word: u64) {
        let (buffer, place) = Self::place(address);
        assert!(buffer < 2, "numbers and slots are not written");
        self.buffers[buffer][place] = word;
    }
}

/// A machine that interprets kernels, after they were changed.
pub struct Interpreter {
    pub change: fn(&str) -> String,
    /// Number of paths of which fewer are left to the processor.
    pub fewest: u64,
}

struct Interpreted {
    kernel: Kernel,
    paths: u64,
    memory: Vec<u64>,
    states: Vec<u64>,
}

impl Machine for Interpreter {
    fn about(&self) -> String {
        "an interpreter".into()
    }

    fn fewest(&self) -> u64 {
        self.fewest
    }

    fn begin(
        &self,
        ptx: &str,
        paths: u64,
        memory: Vec<u64>,
        states: usize,
    ) -> Result<Box<dyn March + '_>, Failure> {
        let kernel = Kernel::new(&(self.change)(ptx));
        Ok(Box::new(Interpreted { kernel, paths, memory, states: vec![0; states] }))
    }
}

impl March for Interpreted {
    fn launch(
        &mut self,
        before: u64,
        steps: u64,
        numbers: &[f64],
        slots: &[u64],
    ) -> Result<(), Failure> {
        let mut numbers: Vec<u64> = numbers.iter().map(|x| x.to_bits()).collect();
        let mut slots = slots.to_vec();
        let Self { kernel, paths, memory, states } = self;
        let mut memory = Memory { buffers: [memory, states, &mut numbers, &mut slots] };
        let parameters = [APART, 2 * APART, 3 * APART, 4 * APART, *paths, before, steps];
        (0..*paths).for_each(|thread| kernel.run(thread, &parameters, &mut memory));
        Ok(())
    }

    fn end(self: Box<Self>) -> Result<(Vec<u64>, Vec<f64>), Failure> {
        Ok((self.memory, self.states.into_iter().map(f64::from_bits).collect()))
    }
}
