//! Random streams: one xoshiro256++ generator per path.

use real::WIDTH;

/// The key of a family of random streams, one xoshiro256++ stream per path (Blackman and Vigna
/// 2019). The stream of path p is a function of (seed, experiment, p) alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamKey {
    /// Master seed of the run.
    pub seed: u64,
    /// Number of the experiment: experiments with the same seed are independent.
    pub experiment: u64,
}

/// The odd constant of SplitMix64: ⌊2⁶⁴/φ⌋ made odd.
pub(crate) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// The bit of the experiment number that separates the streams of tiles from those of paths.
const TILE_STREAM: u64 = 1 << 61;

/// The bit of the experiment number that separates the words of scrambles from the streams of
/// paths.
const SCRAMBLE_STREAM: u64 = 1 << 60;

/// The finaliser of SplitMix64, a bijection of 64-bit words.
#[inline(always)]
pub(crate) fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

impl StreamKey {
    /// The 64-bit seed of the generator of path `path`. For a fixed key it is a bijection of the
    /// path number, so no two paths of an experiment share a stream.
    pub fn path_seed(self, path: u64) -> u64 {
        let experiment = mix(mix(self.seed.wrapping_add(GOLDEN)).wrapping_add(self.experiment));
        mix(experiment.wrapping_add(GOLDEN).wrapping_add(path.wrapping_mul(GOLDEN)))
    }

    /// The key of the streams of the tiles of one large path, with bit 61 of the experiment
    /// number flipped: the seed is that of the path, and tile k has the streams 32k to 32k + 31.
    #[must_use]
    pub fn of_tiles(self, path: u64) -> Self {
        Self { seed: self.path_seed(path), experiment: self.experiment ^ TILE_STREAM }
    }

    /// The 64-bit seed of a scramble of Sobol points: a path seed with bit 60 of the experiment
    /// number flipped.
    pub(crate) fn scramble_seed(self, scramble: u64) -> u64 {
        Self { experiment: self.experiment ^ SCRAMBLE_STREAM, ..self }.path_seed(scramble)
    }

    /// The state of xoshiro256++ after `seed_from_u64` of [`path_seed`](Self::path_seed), which
    /// uses SplitMix64.
    pub(crate) fn state(self, path: u64) -> [u64; 4] {
        let mut counter = self.path_seed(path);
        [(); 4].map(|()| {
            counter = counter.wrapping_add(GOLDEN);
            mix(counter)
        })
    }
}

/// The next word of xoshiro256++ (Blackman and Vigna 2019).
#[inline(always)]
pub(crate) fn next_word(state: &mut [u64; 4]) -> u64 {
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
pub(crate) struct BlockStreams(pub(crate) [[u64; WIDTH]; 4]);

impl BlockStreams {
    /// The streams of paths `first` .. `first + 32`.
    pub(crate) fn new(key: StreamKey, first: u64) -> Self {
        let mut words = [[0; WIDTH]; 4];
        for p in 0..WIDTH {
            let state = key.state(first.wrapping_add(p as u64));
            for i in 0..4 {
                words[i][p] = state[i];
            }
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

    /// Of paths, nor of areas and scrambles.
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
                    assert!(seen.insert(key.of_areas().path_seed(path)));
                }
            }
        }
    }
}
