//! Counts the floating-point arithmetic in the kernels of the running test binary.

use std::fs;

use iced_x86::{Decoder, DecoderOptions, Instruction, Register};
use object::{Object, ObjectSection, ObjectSymbol, SymbolKind};

/// Additions, subtractions, multiplications and divisions of doubles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arithmetic {
    /// On one number.
    pub scalar: usize,
    /// On vectors of 128, 256 and 512 bits.
    pub packed: [usize; 3],
}

impl Arithmetic {
    fn all(&self) -> usize {
        self.scalar + self.packed.iter().sum::<usize>()
    }

    /// Share of the instructions on vectors of 128·2ⁿ bits.
    pub fn share(&self, n: usize) -> f64 {
        self.packed[n] as f64 / self.all() as f64
    }
}

/// One compiled version of a kernel.
#[derive(Debug, Default)]
pub struct Version {
    pub whole: Arithmetic,
    /// The innermost loop with the most arithmetic on vectors of 128·2ⁿ bits, for n = 0, 1, 2.
    pub heaviest_loops: [Arithmetic; 3],
}

/// The versions of all kernels of this binary whose symbol contains `name`, and that do arithmetic;
/// `None` where the binary has no symbols to look at.
///
/// Only `real::dispatch` compiles a function under such a name, one for each kernel and instruction
/// set.
pub fn versions(name: &str) -> Option<Vec<Version>> {
    let data = fs::read(std::env::current_exe().ok()?).ok()?;
    let file = object::File::parse(&*data).ok()?;
    let mut symbols = file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text).peekable();
    symbols.peek()?;
    let found = symbols
        .filter(|symbol| symbol.name().is_ok_and(|symbol| symbol.contains(name)))
        .filter_map(|symbol| {
            let section = file.section_by_index(symbol.section_index()?).ok()?;
            let code = section.data_range(symbol.address(), symbol.size()).ok()??;
            Some(read(code, symbol.address()))
        });
    Some(found.filter(|version| version.whole.all() > 0).collect())
}

fn read(code: &[u8], address: u64) -> Version {
    let instructions: Vec<Instruction> =
        Decoder::with_ip(64, code, address, DecoderOptions::NONE).into_iter().collect();
    // A jump backwards closes a loop.
    let mut loops: Vec<(u64, u64)> = Vec::new();
    for instruction in &instructions {
        let (from, to) = (instruction.ip(), instruction.near_branch_target());
        if name_of(instruction).starts_with('j') && (address..from).contains(&to) {
            loops.push((to, from));
        }
    }
    let innermost = |&(start, end): &(u64, u64)| {
        !loops
            .iter()
            .any(|&(other, last)| (other, last) != (start, end) && start <= other && last <= end)
    };
    let mut version = Version { whole: count(&instructions), ..Version::default() };
    for (start, end) in loops.iter().copied().filter(innermost) {
        let from = instructions.partition_point(|instruction| instruction.ip() < start);
        let to = instructions.partition_point(|instruction| instruction.ip() <= end);
        let arithmetic = count(&instructions[from..to]);
        for (n, heaviest) in version.heaviest_loops.iter_mut().enumerate() {
            if arithmetic.packed[n] > heaviest.packed[n] {
                *heaviest = arithmetic;
            }
        }
    }
    version
}

fn name_of(instruction: &Instruction) -> String {
    format!("{:?}", instruction.mnemonic()).to_lowercase()
}

fn count(instructions: &[Instruction]) -> Arithmetic {
    let mut arithmetic = Arithmetic::default();
    for instruction in instructions {
        let name = name_of(instruction);
        match name.strip_prefix('v').unwrap_or(&name) {
            "addsd" | "subsd" | "mulsd" | "divsd" => arithmetic.scalar += 1,
            "addpd" | "subpd" | "mulpd" | "divpd" => {
                arithmetic.packed[width(instruction.op0_register())] += 1
            }
            _ => {}
        }
    }
    arithmetic
}

/// n of a vector register of 128·2ⁿ bits.
fn width(register: Register) -> usize {
    let name = format!("{register:?}");
    if name.starts_with("ZMM") {
        2
    } else if name.starts_with("YMM") {
        1
    } else {
        0
    }
}
