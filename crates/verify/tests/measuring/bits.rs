//! Awkward numbers.

/// A deterministic source of numbers that break code; SplitMix64 underneath.
pub struct Bits {
    state: u64,
    last: f64,
}

/// Numbers at which something happens in floating point; of each the negative one as well.
const SPECIAL: [f64; 14] = [
    f64::NAN,
    f64::INFINITY,
    0.0,
    1.0,
    0.5,
    2.0,
    f64::MAX,
    f64::MIN_POSITIVE,
    f64::EPSILON,
    5e-324,
    1e-150,
    1e150,
    1e-308,
    709.79,
];

impl Bits {
    /// The bits of one input of one target.
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

    /// True once in `n` times.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.below(n) == 0
    }

    /// Any number at all: a special one, arbitrary bits, an ordinary one, or a neighbour of the
    /// last.
    pub fn number(&mut self) -> f64 {
        self.last = match self.below(8) {
            0 => self.sign() * SPECIAL[self.below(SPECIAL.len() as u64) as usize],
            1 | 2 => f64::from_bits(self.word()),
            3 => self.last.next_up(),
            4 => self.last.next_down(),
            _ => self.ordinary(),
        };
        self.last
    }

    /// A number of moderate size and either sign, most of them near one.
    pub fn ordinary(&mut self) -> f64 {
        let magnitude = 2f64.powi(self.below(24) as i32 - 16);
        let unit = (self.word() >> 11) as f64 / (1u64 << 53) as f64;
        self.sign() * magnitude * (1.0 + unit)
    }

    /// Mostly a positive number of moderate size; once in `n` times any number.
    pub fn positive(&mut self, n: u64) -> f64 {
        if self.one_in(n) { self.number() } else { self.ordinary().abs() }
    }

    /// Components that are mostly ordinary, one in four times any.
    pub fn state<const D: usize>(&mut self) -> [f64; D] {
        let wild = self.one_in(2);
        [(); D].map(|()| if wild && self.one_in(2) { self.number() } else { self.ordinary() })
    }

    fn sign(&mut self) -> f64 {
        if self.one_in(2) { 1.0 } else { -1.0 }
    }
}
