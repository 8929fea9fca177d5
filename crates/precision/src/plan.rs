//! How many steps, paths and repetitions.

use verify::Mode;

/// What a case is measured with. Numbers of steps are powers of two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// 2^first … 2^last steps for strong errors, 2^reference for their reference.
    pub strong: Ladder,
    /// The same for weak errors.
    pub weak: Ladder,
    /// Repetitions of every time.
    pub repetitions: usize,
    /// Path-steps that a repetition has at least.
    pub path_steps: u64,
}

/// Exponents of the numbers of steps, and paths.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ladder {
    pub first: u32,
    pub last: u32,
    pub reference: u32,
    pub samples: u64,
}

impl Ladder {
    /// The numbers of steps, coarsest first.
    pub(crate) fn steps(self) -> impl Iterator<Item = u64> {
        (self.first..=self.last).map(|exponent| 1 << exponent)
    }

    /// Level of the steps 2^exponent above those of the reference.
    pub(crate) fn level(self, exponent: u32) -> usize {
        (self.reference - exponent) as usize
    }
}

impl Plan {
    /// The plan of a mode. A reference with Lévy areas draws them at its own step, which is most of
    /// the work, so it is less fine.
    pub(crate) fn new(mode: Mode, areas: bool) -> Self {
        match mode {
            Mode::Paper => Self {
                strong: Ladder {
                    first: 4,
                    last: 12,
                    reference: if areas { 15 } else { 16 },
                    samples: 1024,
                },
                weak: Ladder { first: 3, last: 8, reference: 11, samples: 1 << 15 },
                repetitions: 15,
                path_steps: 1 << 18,
            },
            Mode::Quick => Self {
                strong: Ladder { first: 4, last: 7, reference: 9, samples: 256 },
                weak: Ladder { first: 3, last: 5, reference: 7, samples: 2048 },
                repetitions: 3,
                path_steps: 1 << 12,
            },
        }
    }

    /// Every number of steps whose time is wanted, in increasing order.
    pub(crate) fn timed_steps(&self) -> Vec<u64> {
        let mut steps: Vec<u64> = self.strong.steps().chain(self.weak.steps()).collect();
        steps.sort_unstable();
        steps.dedup();
        steps
    }
}
