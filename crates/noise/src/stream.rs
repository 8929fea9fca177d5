//! Random streams: one xoshiro256++ generator per path.

use real::WIDTH;

use crate::NoiseError;

/// The key of a family of random streams, one xoshiro256++ stream per path (Blackman and Vigna
/// 2019). The stream of path p is a function of (seed, experiment, p) alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamKey {
    /// Master seed of the run.
    pub seed: u64,
    /// Number of the experiment, below 2⁴⁰: experiments with the same seed are independent. The
    /// other bits are those of a [`Purpose`].
    pub experiment: u64,
}

/// 2⁶⁴/φ made odd, the constant of SplitMix64: its multiples modulo 2⁶⁴ are the multiples of the
/// golden ratio modulo one. Of all such sequences this one has the smallest gaps.
pub const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Bits of the number of an experiment.
const EXPERIMENT_BITS: u32 = 40;

/// Purpose of the random numbers of a stream: the bits of the experiment number from 40 on. The
/// families of paths have bits below 57. Each of the others has a bit of its own, and is beside any
/// family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// The paths of an experiment.
    Paths,
    /// Paths of level l < 31 of an expectation.
    Level(u64),
    /// Paths on which the steps of a run are checked.
    StepCheck,
    /// Paths of the pilot of a study.
    Pilot,
    /// Paths of batch n < 2¹⁴ of a chain.
    Batch(u64),
    /// Space-time areas, beside increments.
    SpaceTimeAreas,
    /// Initial values.
    InitialValues,
    /// Scrambles of Sobol points.
    Scrambles,
    /// The tiles of a large path.
    Tiles,
    /// Lévy areas, beside increments: these are the same whether areas are drawn or not.
    Areas,
    /// Normals of a random time change.
    TimeChange,
}

impl Purpose {
    /// Bits of the purpose in the experiment number.
    pub const fn bits(self) -> u64 {
        match self {
            Self::Paths => 0,
            Self::Level(level) => (level + 1) << EXPERIMENT_BITS,
            Self::StepCheck => 1 << 46,
            Self::Pilot => 1 << 47,
            Self::Batch(number) => (1 << 54) + (number << EXPERIMENT_BITS),
            Self::SpaceTimeAreas => 1 << 57,
            Self::InitialValues => 1 << 59,
            Self::Scrambles => 1 << 60,
            Self::Tiles => 1 << 61,
            Self::Areas => 1 << 62,
            Self::TimeChange => 1 << 63,
        }
    }
}

/// The finaliser of SplitMix64 (Steele, Lea and Flood 2014), a bijection of 64-bit words.
#[inline(always)]
pub fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The words of SplitMix64, from a state.
pub struct SplitMix(pub u64);

impl SplitMix {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(GOLDEN);
        mix(self.0)
    }
}

impl StreamKey {
    /// The 64-bit seed of the generator of path `path`. For a fixed key it is a bijection of the
    /// path number, so no two paths of an experiment share a stream.
    pub fn path_seed(self, path: u64) -> u64 {
        let experiment = mix(mix(self.seed.wrapping_add(GOLDEN)).wrapping_add(self.experiment));
        mix(experiment.wrapping_add(GOLDEN).wrapping_add(path.wrapping_mul(GOLDEN)))
    }

    /// The key of a family of paths of this experiment.
    ///
    /// # Errors
    /// [`NoiseError`] unless the number of the experiment is below 2⁴⁰: a larger one has
    /// the streams of something else.
    pub fn paths_of(self, family: Purpose) -> Result<Self, NoiseError> {
        let Self { experiment, .. } = self;
        if experiment >> EXPERIMENT_BITS == 0 {
            return Ok(self.beside(family));
        }
        Err(NoiseError(format!("the experiment number must be below 2^40, got {experiment}")))
    }

    /// The key of the streams with another purpose beside these.
    #[must_use]
    pub const fn beside(self, purpose: Purpose) -> Self {
        Self { experiment: self.experiment ^ purpose.bits(), ..self }
    }

    /// The key of the streams of the tiles of one large path: the seed is that of the path, and
    /// tile k has the streams 32k to 32k + 31.
    #[must_use]
    pub fn of_tiles(self, path: u64) -> Self {
        Self { seed: self.path_seed(path), ..self }.beside(Purpose::Tiles)
    }

    /// The 64-bit seed of a scramble of Sobol points.
    pub(crate) fn scramble_seed(self, scramble: u64) -> u64 {
        self.beside(Purpose::Scrambles).path_seed(scramble)
    }

    /// The state of xoshiro256++ after `seed_from_u64` of [`path_seed`](Self::path_seed), which
    /// uses SplitMix64.
    pub fn state(self, path: u64) -> [u64; 4] {
        let mut words = SplitMix(self.path_seed(path));
        [(); 4].map(|()| words.next())
    }
}

/// The next word of xoshiro256++ (Blackman and Vigna 2019).
#[inline(always)]
pub fn next_word(state: &mut [u64; 4]) -> u64 {
    let result = state[0].wrapping_add(state[3]).rotate_left(23).wrapping_add(state[0]);
    let shifted = state[1] << 17;
    state[2] ^= state[0];
    state[3] ^= state[1];
    state[1] ^= state[2];
    state[0] ^= state[3];
    state[2] ^= shifted;
    state[3] = state[3].rotate_left(45);
    result
}

/// The streams of a block of paths, path index innermost.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(align(64))]
pub struct BlockStreams(pub [[u64; WIDTH]; 4]);

impl BlockStreams {
    /// The streams of paths `first` .. `first + 32`.
    pub fn new(key: StreamKey, first: u64) -> Self {
        let mut words = [[0; WIDTH]; 4];
        for p in 0..WIDTH {
            let state = key.state(first.wrapping_add(p as u64));
            words.iter_mut().zip(state).for_each(|(row, word)| row[p] = word);
        }
        Self(words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro256PlusPlus;

    #[test]
    fn the_stream_is_xoshiro256plusplus_bit_for_bit() {
        for (seed, experiment, path) in
            [(0, 0, 0), (1, 2, 3), (u64::MAX, 5, 4711), (42, u64::MAX, u64::MAX)]
        {
            let key = StreamKey { seed, experiment };
            let mut ours = key.state(path);
            let mut theirs = Xoshiro256PlusPlus::seed_from_u64(key.path_seed(path));
            for _ in 0..1000 {
                assert_eq!(next_word(&mut ours), theirs.next_u64());
            }
        }
    }

    /// The values are those of results that exist: they may not change.
    #[test]
    fn every_purpose_has_bits_of_its_own() {
        use Purpose::{
            Areas, Batch, InitialValues, Level, Paths, Pilot, Scrambles, SpaceTimeAreas, StepCheck,
            Tiles, TimeChange,
        };
        let levels = (0..31).map(Level);
        let batches = (0..1 << 14).map(Batch);
        let families = [Paths, StepCheck, Pilot].into_iter().chain(levels).chain(batches);
        let mut seen = std::collections::HashSet::new();
        for family in families {
            let bits = family.bits();
            assert!(bits < 1 << 57 && bits % (1 << 40) == 0 && seen.insert(bits), "{family:?}");
        }
        let beside = [SpaceTimeAreas, InitialValues, Scrambles, Tiles, Areas, TimeChange];
        assert_eq!(beside.map(Purpose::bits), [57, 59, 60, 61, 62, 63].map(|bit| 1 << bit));
        let some = [Level(0), Level(3), StepCheck, Pilot, Batch(0), Batch(5)].map(Purpose::bits);
        assert_eq!(some, [1 << 40, 1 << 42, 1 << 46, 1 << 47, 1 << 54, (1 << 54) + (5 << 40)]);
    }

    #[test]
    fn an_experiment_that_has_the_streams_of_something_else_is_refused() {
        for purpose in [Purpose::Paths, Purpose::Pilot] {
            let key = |experiment| StreamKey { seed: 1, experiment }.paths_of(purpose);
            assert_eq!(key((1 << 40) - 1).unwrap().experiment, purpose.bits() + (1 << 40) - 1);
            for experiment in [1 << 40, 1 << 46, 1 << 62, u64::MAX] {
                let error = key(experiment).unwrap_err().to_string();
                assert!(error.ends_with(&format!("below 2^40, got {experiment}")), "{error}");
            }
        }
    }

    /// No stream is shared by paths, areas and scrambles.
    #[test]
    fn neighbours_do_not_share_a_stream() {
        let mut seen = std::collections::HashSet::new();
        for seed in 0..10 {
            for experiment in 0..10 {
                let key = StreamKey { seed, experiment };
                for path in 0..200 {
                    assert!(
                        seen.insert(key.path_seed(path)) && seen.insert(key.scramble_seed(path))
                    );
                    assert!(seen.insert(key.beside(Purpose::Areas).path_seed(path)));
                }
            }
        }
    }
}
