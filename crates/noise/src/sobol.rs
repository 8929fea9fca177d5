//! Sobol points with nested uniform scrambling.

use std::sync::LazyLock;

use real::WIDTH;

use crate::{
    StreamKey,
    box_muller::open_unit,
    stream::{GOLDEN, SplitMix, mix},
};

/// The direction numbers of dimensions 2 to 1024 of new-joe-kuo-6 (Joe and Kuo 2008), a line each:
/// dimension, degree s and inner coefficients a of the polynomial, m₁ … m_s. Their licence is in
/// `data/LICENCE-JOE-KUO`.
const JOE_KUO: &str = include_str!("data/new-joe-kuo-6.1024");

/// Digits of a Sobol number in base 2.
const DIGITS: usize = 32;
/// Digits of the number of a point within a block: WIDTH = 2⁵.
const LOW_DIGITS: usize = WIDTH.trailing_zeros() as usize;

/// The points of randomised quasi-Monte Carlo: the Sobol sequence (Sobol 1967) in base 2 with the
/// direction numbers of Joe and Kuo (2008), with nested uniform scrambling (Owen 1995).
///
/// A coordinate is a word of 64 bits, the digits of a number in [0, 1): see
/// [`uniform`](Self::uniform) and [`inverse_normal`](crate::inverse_normal).
///
/// - The first 2^m points have one coordinate in every interval [k, k+1)·2^−m, in each dimension;
///   so have the points j·2^m … (j+1)·2^m − 1.
/// - The upper 32 bits are scrambled by a hash in which a digit is flipped or not as a function of
///   the digits before it and of two random words (Laine and Karras 2011, Burley 2020, with the
///   constants of Vegdahl 2022 and a word each for the sum and the product). The flips are added to
///   a third random word. So every coordinate is uniform, whatever the hash does, and a mean over
///   points is unbiased over scrambles. The mean of u over n = 2^m points has the variance 1/(12n³)
///   of Owen's scrambling within the error of 0.2 % of its measurement, 4 ≤ n ≤ 1024;
///   `tests/all/statistical/quasi.rs` checks it with 8000 scrambles.
/// - The lower 32 bits are random words of the point.
/// - **Padding**: dimensions above [`DIMENSIONS`](Self::DIMENSIONS) have independent random words
///   instead of Sobol numbers, as in Monte Carlo.
///
/// The words of a point are a function of (seed, experiment, scramble, point) alone, and that of a
/// dimension does not depend on the number of dimensions. Points are in the order of their numbers,
/// not in that of the Gray code.
///
/// ```
/// use noise::{ScrambledSobol, StreamKey};
///
/// let points = ScrambledSobol::new(StreamKey { seed: 1, experiment: 7 }, 0, 2);
/// // In each dimension 32 points have one number in every interval of length 1/32.
/// let uniform = |point| ScrambledSobol::uniform(points.point(point)[1]);
/// let mut cells: Vec<_> = (64..96).map(|point| (32.0 * uniform(point)) as usize).collect();
/// cells.sort();
/// assert!(cells.into_iter().eq(0..32));
/// ```
#[derive(Clone, Debug)]
pub struct ScrambledSobol {
    groups: &'static [Group],
    dimensions: usize,
    /// Random words for the dimensions that have Sobol numbers.
    seeds: Vec<Seeds>,
    /// Seed of the words of all dimensions.
    root: u64,
}

impl ScrambledSobol {
    /// Dimensions that have Sobol numbers.
    pub const DIMENSIONS: usize = 1024;
    /// Number of points of a scramble, 2³².
    pub const POINTS: u64 = 1 << DIGITS;

    /// The points of scramble number `scramble`. Scrambles of a key are independent.
    pub fn new(key: StreamKey, scramble: u64, dimensions: usize) -> Self {
        let root = key.scramble_seed(scramble);
        let sobol = dimensions.min(Self::DIMENSIONS);
        Self {
            groups: &TABLE[..sobol.div_ceil(WIDTH)],
            dimensions,
            seeds: (0..sobol).map(|d| Seeds::new(dimension_words(root, d))).collect(),
            root,
        }
    }

    /// Number of dimensions.
    pub fn dimensions(&self) -> usize {
        self.dimensions
    }

    /// The words of one point.
    ///
    /// # Panics
    /// For points from 2³² on.
    pub fn point(&self, point: u64) -> Vec<u64> {
        let (first, mut high) = (point_number(point), [0; WIDTH]);
        let mut words = vec![[0]; self.dimensions];
        words.iter_mut().enumerate().for_each(|(d, word)| self.fill(d, &mut high, first, word));
        words.into_flattened()
    }

    /// The number (⌊`word` / 2¹²⌋ + ½)·2⁻⁵² of a word, which is never 0 and never 1.
    #[inline(always)]
    pub fn uniform(word: u64) -> f64 {
        open_unit(word >> 12)
    }

    /// The Sobol numbers of point `first` without its lowest five digits, in dimensions
    /// 32g .. 32g + 32; zeros for a group of padded dimensions.
    #[inline(always)]
    fn high_digits(&self, g: usize, first: u32) -> [u32; WIDTH] {
        let mut high = [0; WIDTH];
        if let Some(group) = self.groups.get(g) {
            let mut rest = first >> LOW_DIGITS;
            while rest != 0 {
                let directions = &group.high[rest.trailing_zeros() as usize];
                for d in 0..WIDTH {
                    high[d] ^= directions[d];
                }
                rest &= rest - 1;
            }
        }
        high
    }

    /// Coordinate `d` of L points from point `first` on: one, or a block of them. Dimensions come
    /// in their order, since `high` has the [`high_digits`](Self::high_digits) of the group of the
    /// last one.
    #[inline(always)]
    pub(crate) fn fill<const L: usize>(
        &self,
        d: usize,
        high: &mut [u32; WIDTH],
        first: u32,
        words: &mut [u64; L],
    ) {
        if d.is_multiple_of(WIDTH) {
            *high = self.high_digits(d / WIDTH, first);
        }
        if let Some(seeds) = self.seeds.get(d) {
            // L is 1, or WIDTH for points that begin at a multiple of it.
            let offset = first as usize % WIDTH;
            let low = &self.groups[d / WIDTH].low[d % WIDTH][offset..offset + L];
            let (mut digits, mut random) = ([0; L], [0; L]);
            for p in 0..L {
                digits[p] = seeds.scrambled(high[d % WIDTH] ^ low[p]);
            }
            for p in 0..L {
                random[p] = seeds.random(first.wrapping_add(p as u32));
            }
            for p in 0..L {
                words[p] = u64::from(digits[p]) << DIGITS | u64::from(random[p]);
            }
        } else {
            // SplitMix64 with a random increment, at the number of the point.
            let mut seeds = dimension_words(self.root, d);
            let (sum, factor) = (seeds.next(), seeds.next() | 1);
            for p in 0..L {
                let point = u64::from(first) + p as u64;
                words[p] = mix(sum.wrapping_add(point.wrapping_mul(factor)));
            }
        }
    }
}

/// The number of a point of a scramble, or of the first one of a block.
pub fn point_number(number: u64) -> u32 {
    number.try_into().unwrap_or_else(|_| panic!("a scramble has the points 0 to 2^32 - 1"))
}

/// The random words of the scrambling of a dimension.
#[derive(Clone, Copy, Debug)]
struct Seeds {
    sum: u32,
    factor: u32,
    flips: u32,
    random_sum: u32,
    random_factor: u32,
}

impl Seeds {
    fn new(mut words: SplitMix) -> Self {
        let [one, two, three] = [(); 3].map(|()| words.next());
        Self {
            sum: one as u32,
            factor: (one >> DIGITS) as u32 | 1,
            flips: two as u32,
            random_sum: (two >> DIGITS) as u32,
            random_factor: three as u32 | 1,
        }
    }

    /// The scrambled number of a Sobol number whose first digit is the lowest bit.
    ///
    /// Sums, products and x·c with an even c carry upwards only: a bit of the hash is its own bit
    /// of x, flipped or not by the lower ones.
    #[inline(always)]
    fn scrambled(&self, x: u32) -> u32 {
        let x = x ^ x.wrapping_mul(0x3d20_adea);
        let x = x.wrapping_add(self.sum).wrapping_mul(self.factor);
        let x = x ^ x.wrapping_mul(0x0552_6c56);
        let x = x ^ x.wrapping_mul(0x53a2_2864);
        x.reverse_bits() ^ self.flips
    }

    /// A random word of a point, by the finaliser `lowbias32` of Wellons (2018).
    #[inline(always)]
    fn random(&self, point: u32) -> u32 {
        let x = point.wrapping_mul(self.random_factor).wrapping_add(self.random_sum);
        let x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
        let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        x ^ (x >> 16)
    }
}

/// The words of the scrambling of a dimension.
fn dimension_words(root: u64, dimension: usize) -> SplitMix {
    SplitMix(mix(root.wrapping_add((dimension as u64 + 1).wrapping_mul(GOLDEN))))
}

/// The direction numbers of 32 dimensions, the first digit in the lowest bit.
#[derive(Debug)]
#[repr(align(64))]
struct Group {
    /// Direction numbers of the digits of a point above the lowest five: digit by digit, dimension
    /// innermost.
    high: [[u32; WIDTH]; DIGITS - LOW_DIGITS],
    /// The Sobol numbers of points 0 .. 32: dimension by dimension, point innermost.
    low: [[u32; WIDTH]; WIDTH],
}

static TABLE: LazyLock<Vec<Group>> = LazyLock::new(|| {
    let directions = all_directions();
    let groups = directions.chunks(WIDTH).map(|dimensions| {
        let mut group = Group { high: [[0; WIDTH]; DIGITS - LOW_DIGITS], low: [[0; WIDTH]; WIDTH] };
        for (d, directions) in dimensions.iter().enumerate() {
            for k in LOW_DIGITS..DIGITS {
                group.high[k - LOW_DIGITS][d] = directions[k].reverse_bits();
            }
            group.low[d] = std::array::from_fn(|p| sobol(directions, p as u32).reverse_bits());
        }
        group
    });
    groups.collect()
});

/// Number `point` of the Sobol sequence with these direction numbers, times 2³².
fn sobol(directions: &[u32; DIGITS], point: u32) -> u32 {
    let digits = (0..DIGITS).filter(|k| point >> k & 1 == 1);
    digits.fold(0, |number, k| number ^ directions[k])
}

/// The direction numbers of all dimensions, times 2³². The first is that of van der Corput.
fn all_directions() -> Vec<[u32; DIGITS]> {
    let mut all = vec![std::array::from_fn(|k| 1 << (DIGITS - 1 - k))];
    for line in JOE_KUO.lines() {
        // The title has no numbers.
        let numbers: Vec<u32> = line.split(' ').filter_map(|word| word.parse().ok()).collect();
        if let [_, degree, coefficients, first @ ..] = &numbers[..] {
            all.push(directions(*degree as usize, *coefficients, first));
        }
    }
    all
}

/// The direction numbers of a primitive polynomial of degree s with inner coefficients a, from m₁ …
/// m_s, by the recurrence of Joe and Kuo (2008), equation (2).
fn directions(s: usize, a: u32, m: &[u32]) -> [u32; DIGITS] {
    let mut v = [0; DIGITS];
    for k in 0..DIGITS {
        if k < s {
            v[k] = m[k] << (DIGITS - 1 - k);
        } else {
            v[k] = v[k - s] ^ (v[k - s] >> s);
            for i in 1..s {
                v[k] ^= (a >> (s - 1 - i) & 1) * v[k - i];
            }
        }
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_of_scipy() {
        // scipy.stats.qmc.Sobol(d, scramble=False), in the order of the Gray code: its point i is
        // number i ^ (i >> 1) of the sequence. In units of 2⁻³⁰, the digits that it has.
        let all = all_directions();
        assert_eq!(all.len(), ScrambledSobol::DIMENSIONS);
        for (d, i, pinned) in SCIPY {
            assert_eq!(sobol(&all[d], i ^ (i >> 1)) >> 2, pinned, "{d} {i}");
        }
    }
    const SCIPY: [(usize, u32, u32); 15] = [
        (1, 1000, 103809024),
        (7, 1000, 965738496),
        (63, 1000, 479199232),
        (255, 1000, 267386880),
        (1023, 1000, 766509056),
        (1, 123457, 733093888),
        (7, 123457, 1035149312),
        (63, 123457, 485482496),
        (255, 123457, 1059790848),
        (1023, 123457, 1016799232),
        (1, 87654321, 741178616),
        (7, 87654321, 107809464),
        (63, 87654321, 910680),
        (255, 87654321, 191483336),
        (1023, 87654321, 565772696),
    ];

    #[test]
    fn a_block_has_the_numbers_of_the_sequence() {
        // Seeds that leave all digits as they are would be zeros; here the numbers themselves.
        let all = all_directions();
        let points = ScrambledSobol::new(StreamKey { seed: 0, experiment: 0 }, 0, 1024);
        for first in [0, 32, 96, 1 << 20, u32::MAX - 31, 0x1234_5660] {
            for g in 0..32 {
                let high = points.high_digits(g, first);
                for d in 0..WIDTH {
                    for p in 0..WIDTH {
                        let digits = high[d] ^ points.groups[g].low[d][p];
                        let number = sobol(&all[g * WIDTH + d], first + p as u32);
                        assert_eq!(digits.reverse_bits(), number);
                    }
                }
            }
        }
    }

    #[test]
    fn scrambling_is_nested() {
        // Numbers that agree in k digits and differ in the next do so after scrambling.
        let mut words = dimension_words(1, 0);
        for n in 0..10_000 {
            let seeds = Seeds::new(dimension_words(2, n % 100));
            let (x, k) = (words.next() as u32, n % DIGITS);
            let y = x ^ (1 | (words.next() as u32) << 1) << k;
            let difference = seeds.scrambled(x) ^ seeds.scrambled(y);
            assert_eq!(difference.leading_zeros() as usize, k);
        }
    }
}
