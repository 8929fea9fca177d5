//! Wiener increments of a block of paths and of one path. Both call the same functions, so they
//! give the same bits.

use real::{Block, Kernel, WIDTH, dispatch, elementary};

use crate::{
    StreamKey,
    stream::{BlockStreams, next_word},
};

/// Increments of M independent Wiener processes on 32 consecutive paths.
///
/// Two words of a path's stream give u ∈ (0, 1) and v ∈ [0, 1). Then √(−2 ln u)·(cos 2πv, sin 2πv)
/// are two independent standard normals (Box and Muller 1958). Since u ≥ 2⁻⁵³, no normal exceeds
/// √(106 ln 2) ≈ 8.57. Normals are used step by step and noise by noise. With odd M every second
/// step begins with a normal left over from the step before.
#[derive(Clone, Debug)]
pub struct WienerBlock<const M: usize> {
    streams: BlockStreams,
    spare: Block<1>,
    has_spare: bool,
}

impl<const M: usize> WienerBlock<M> {
    /// The increments of paths `first_path` .. `first_path + 32`.
    pub fn new(key: StreamKey, first_path: u64) -> Self {
        Self { streams: BlockStreams::new(key, first_path), spare: Block::zero(), has_spare: false }
    }

    /// Writes the next M increments, each N(0, τ), into `dw`; `sqrt_tau` = √τ.
    #[inline]
    pub fn increments(&mut self, sqrt_tau: f64, dw: &mut Block<M>) {
        let mut drawn = 0;
        if self.has_spare && M > 0 {
            for p in 0..WIDTH {
                dw.0[0][p] = self.spare.0[0][p] * sqrt_tau;
            }
            self.has_spare = false;
            drawn = 1;
        }
        if drawn < M {
            self.has_spare = (M - drawn) % 2 == 1;
            dispatch(Fill {
                streams: &mut self.streams,
                spare: &mut self.spare,
                dw,
                drawn,
                sqrt_tau,
            });
        }
    }
}

/// Draws pairs of normals into the rows `drawn..M` of `dw`, and the last of an odd number into
/// `spare`.
struct Fill<'a, const M: usize> {
    streams: &'a mut BlockStreams,
    spare: &'a mut Block<1>,
    dw: &'a mut Block<M>,
    drawn: usize,
    sqrt_tau: f64,
}

impl<const M: usize> Kernel for Fill<'_, M> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let mut rows = &mut self.dw.0[self.drawn..];
        while let [first, second, rest @ ..] = rows {
            fill_pair(&mut self.streams.0, first, second, self.sqrt_tau, self.sqrt_tau);
            rows = rest;
        }
        if let [last] = rows {
            fill_pair(&mut self.streams.0, last, &mut self.spare.0[0], self.sqrt_tau, 1.0);
        }
    }
}

/// Two normals on each of L paths, multiplied by the two scales.
#[inline(always)]
pub(crate) fn fill_pair<const L: usize>(
    words: &mut [[u64; L]; 4],
    first: &mut [f64; L],
    second: &mut [f64; L],
    first_scale: f64,
    second_scale: f64,
) {
    for p in 0..L {
        let mut state = [words[0][p], words[1][p], words[2][p], words[3][p]];
        let (one, other) = box_muller(next_word(&mut state), next_word(&mut state));
        for i in 0..4 {
            words[i][p] = state[i];
        }
        first[p] = one * first_scale;
        second[p] = other * second_scale;
    }
}

/// Two independent standard normals from two random words.
#[inline(always)]
pub(crate) fn box_muller(radius_word: u64, angle_word: u64) -> (f64, f64) {
    let radius = (elementary::ln_unit(open_unit(radius_word)) * -2.0).sqrt();
    let (sin, cos) = elementary::sin_cos_turn(half_open_unit(angle_word));
    (radius * cos, radius * sin)
}

/// 52 random bits as the fraction of a number in [1, 2).
#[inline(always)]
fn one_to_two(word: u64) -> f64 {
    f64::from_bits(0x3ff0_0000_0000_0000 | (word >> 12))
}

/// (k + ½)·2⁻⁵² for k random in 0 .. 2⁵², never 0 and never 1. The subtraction is exact.
#[inline(always)]
pub(crate) fn open_unit(word: u64) -> f64 {
    one_to_two(word) - (1.0 - 0.5 * f64::EPSILON)
}

/// k·2⁻⁵² for k random in 0 .. 2⁵².
#[inline(always)]
fn half_open_unit(word: u64) -> f64 {
    one_to_two(word) - 1.0
}

/// Increments of M independent Wiener processes on one path, with the same bits as that path of a
/// [`WienerBlock`].
#[derive(Clone, Debug)]
pub struct WienerPath<const M: usize> {
    state: [u64; 4],
    spare: Option<f64>,
}

impl<const M: usize> WienerPath<M> {
    /// The increments of path `path`.
    pub fn new(key: StreamKey, path: u64) -> Self {
        Self { state: key.state(path), spare: None }
    }

    /// The next M increments, each N(0, τ); `sqrt_tau` = √τ.
    pub fn increments(&mut self, sqrt_tau: f64) -> [f64; M] {
        std::array::from_fn(|_| self.normal() * sqrt_tau)
    }

    /// The next standard normal of the path.
    pub fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let (first, second) = box_muller(next_word(&mut self.state), next_word(&mut self.state));
        self.spare = Some(second);
        first
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;

    #[test]
    fn the_most_extreme_words_give_finite_normals() {
        // Radius √(106 ln 2) at the smallest u = 2⁻⁵³, √(2·2⁻⁵³) at the largest u = 1 − 2⁻⁵³; a few
        // roundings.
        let largest = (106.0 * std::f64::consts::LN_2).sqrt();
        let smallest = f64::EPSILON.sqrt();
        let rounding = 1.0 + 8.0 * f64::EPSILON;
        for angle_word in [0, u64::MAX, 1 << 62, 1 << 63, 3 << 62, 0x1234_5678_9abc_def0] {
            for (radius_word, radius) in [(0, largest), (u64::MAX, smallest)] {
                let (one, other) = box_muller(radius_word, angle_word);
                assert!(one.is_finite() && other.is_finite());
                assert!(one.abs().max(other.abs()) <= radius * rounding);
                assert_relative_eq!(
                    one.hypot(other),
                    radius,
                    epsilon = 0.0,
                    max_relative = 8.0 * f64::EPSILON
                );
            }
        }
        assert!(largest > 8.57 && largest < 8.58);
        // Quarter turns are exact, so the largest normal is reached with both signs.
        let signs = [0, 1 << 62, 1 << 63, 3 << 62].map(|word| box_muller(0, word));
        assert!(signs[0].0 > 8.57 && signs[1].1 > 8.57);
        assert!(signs[2].0 < -8.57 && signs[3].1 < -8.57);
    }

    #[test]
    fn uniforms_keep_their_intervals() {
        assert_eq!(open_unit(0), 0.5 * f64::EPSILON);
        assert_eq!(open_unit(u64::MAX), 1.0 - 0.5 * f64::EPSILON);
        assert_eq!(half_open_unit(0), 0.0);
        assert_eq!(half_open_unit(u64::MAX), 1.0 - f64::EPSILON);
    }
}
