//! Awkward numbers.

/// A deterministic source of numbers that break code; SplitMix64 underneath.
#[derive(Clone, Debug)]
pub struct Bits {
    state: u64,
    last: f64,
}

/// Numbers at which something happens in floating point.
const SPECIAL: [f64; 24] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    f64::MAX,
    f64::MIN,
    f64::MIN_POSITIVE,
    -f64::MIN_POSITIVE,
    f64::EPSILON,
    5e-324,
    -5e-324,
    1e-150,
    1e150,
    -1e150,
    1e-308,
    9_007_199_254_740_992.0,
    1_073_741_824.0,
    709.79,
    -745.2,
];

impl Bits {
    /// The bits of one input of one target.
    #[must_use]
    pub fn new(seed: u64, target: u64, input: u64) -> Self {
        let mut bits =
            Self { state: seed ^ target.rotate_left(48) ^ input.rotate_left(16), last: 1.0 };
        // Neighbouring inputs start in neighbouring states of a bijection that mixes well after two
        // draws.
        bits.word();
        bits.state ^= input;
        bits
    }

    /// 64 random bits.
    pub fn word(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.state;
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        x ^ (x >> 31)
    }

    /// A number below `n`, which is not zero; the bias is below n·2⁻⁶⁴.
    pub fn below(&mut self, n: u64) -> u64 {
        ((u128::from(self.word()) * u128::from(n)) >> 64) as u64
    }

    /// A number in [0, 1).
    pub fn unit(&mut self) -> f64 {
        (self.word() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Any number at all: a special one, arbitrary bits, an ordinary one, or a neighbour of the
    /// last.
    pub fn number(&mut self) -> f64 {
        let number = match self.below(8) {
            0 => SPECIAL[self.below(SPECIAL.len() as u64) as usize],
            1 | 2 => f64::from_bits(self.word()),
            3 => self.last.next_up(),
            4 => self.last.next_down(),
            _ => self.ordinary(),
        };
        self.last = number;
        number
    }

    /// A number of moderate size and either sign, most of them near one.
    pub fn ordinary(&mut self) -> f64 {
        let magnitude = 2f64.powi(self.below(24) as i32 - 16);
        let sign = if self.below(2) == 0 { 1.0 } else { -1.0 };
        sign * magnitude * (1.0 + self.unit())
    }

    /// Mostly a positive number of moderate size; one in eight times any number.
    pub fn plausible(&mut self) -> f64 {
        if self.below(8) == 0 { self.number() } else { self.ordinary().abs() }
    }

    /// Components that are mostly ordinary, one in four times any.
    pub fn state<const D: usize>(&mut self) -> [f64; D] {
        let wild = self.below(2) == 0;
        let mut y = [0.0; D];
        for component in &mut y {
            *component = if wild && self.below(2) == 0 { self.number() } else { self.ordinary() };
        }
        y
    }
}
