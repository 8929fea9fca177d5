//! Which noise belongs to which experiment: the one register of stream numbers.
//!
//! A [`StreamKey`] has a seed and a number. No two experiments of this workspace share a number, so
//! no two share noise. Each family of experiments has a range of its own; its members count on from
//! the first.

use noise::StreamKey;

/// Number of streams of an experiment of the families below [`HARD_CASES`], one for each part.
pub const PARTS: u64 = 16;

/// Stream on which the speed of a path-step is measured, one number.
pub const BENCH: u64 = 0;
/// Panels of the paper, in its order: 1, 2, … times [`PARTS`].
pub const PANELS: u64 = 1;
/// Statements that are measured on their own, times [`PARTS`].
pub const STATEMENTS: u64 = 1000;
/// Figures that are not in the paper, times [`PARTS`].
pub const SUPPLEMENTS: u64 = 2000;
/// Twins, times [`PARTS`].
pub const TWINS: u64 = 3000;

/// Hard cases.
pub const HARD_CASES: u64 = 1 << 33;
/// Growth of the defect over long runs.
pub const GROWTH: u64 = HARD_CASES + (1 << 16);
/// Entries of the library, one number each; expectations need numbers below 2⁴⁰.
pub const LIBRARY: u64 = 1 << 34;
/// Coverage: case number n takes the numbers from n times this on.
pub const COVERAGE: u64 = 1 << 40;

/// The streams of part number `part` of experiment number `experiment`.
///
/// # Panics
/// When there is no such part: it would share its noise with the next experiment.
pub fn key(seed: u64, experiment: u64, part: u64) -> StreamKey {
    assert!(part < PARTS, "part {part} would share its noise with the next experiment");
    StreamKey { seed, experiment: experiment * PARTS + part }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_disjoint() {
        let families = [PANELS, STATEMENTS, SUPPLEMENTS, TWINS, TWINS + 100];
        let ends = families.map(|first| first * PARTS).into_iter();
        let further = [HARD_CASES, GROWTH, LIBRARY, COVERAGE];
        let starts: Vec<u64> = ends.chain(further).collect();
        // Fewer experiments in each family than there are numbers.
        assert!(starts.windows(2).all(|pair| pair[0] + 16 <= pair[1]), "{starts:?}");
    }

    #[test]
    #[should_panic(expected = "would share its noise")]
    fn a_part_too_many_is_refused() {
        let _ = key(1, PANELS, PARTS);
    }
}
