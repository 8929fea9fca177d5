//! Events that the samples of a level may have missed.

use super::level::Samples;

/// No event in N samples: 97.5 % upper limit u of the expected number, −ln 0.025. With k events the
/// interval k ± √(1.96²k + u²) covers a Poisson number with 93 % or more for any mean, and events of
/// several levels with more.
pub const UNSEEN: f64 = 3.688_879_454_113_936;
/// With this many events the normal interval k ± 1.96√k covers as well without u. A variance that so many samples carry is known to √(1/30) of itself,
/// and its root to a tenth.
const EVENTS: f64 = 30.0;

/// What missed events may add to the mean of one test function on one level.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tail {
    /// Half-width times number of samples: [`UNSEEN`]·R, or zero where the samples suffice.
    pub size: f64,
    /// Number of samples that are expected to suffice.
    pub enough: f64,
}

impl Tail {
    /// The tail of n samples with this kurtosis, NaN where none differs, that may spread by
    /// `reach`. N/κ samples carry the variance: the events, if it is due to events.
    fn new(n: f64, kurtosis: f64, reach: f64) -> Self {
        let enough = EVENTS * if kurtosis.is_nan() { n } else { kurtosis };
        Self { size: if n < enough { UNSEEN * reach } else { 0.0 }, enough }
    }
}

/// The tail of test function number k on each of these levels, where φ spreads by `range` on all.
///
/// A single path may spread by `range`. A difference may be as large as the largest of its level
/// and of the level below, where events of the same kind are more frequent; where none differs, as
/// large as `range`. Nor is its kurtosis less than on the level below.
pub fn tails(levels: &[Samples], k: usize, range: f64) -> Vec<Tail> {
    let mut below = (f64::NAN, 0.0);
    let tail = |samples: &Samples| {
        let (n, sample) = (samples.count() as f64, &samples.values[k].sample);
        if samples.coupling.is_none() {
            return Tail::new(n, sample.kurtosis(), range);
        }
        let own = (sample.kurtosis(), sample.largest_deviation());
        let kurtosis = if own.0.is_nan() { own.0 } else { own.0.max(below.0) };
        let reach = own.1.max(below.1);
        below = own;
        Tail::new(n, kurtosis, if reach > 0.0 { reach } else { range })
    };
    levels.iter().map(tail).collect()
}

/// Whether fewer than [`EVENTS`] single paths carry the variance of test function number k, and are
/// not of one size: larger ones may be missing, whose size is not known. φ of two values has events
/// of one size.
pub fn is_heavy(samples: &Samples, k: usize) -> bool {
    let sample = &samples.values[k].sample;
    let few = (samples.count() as f64) < EVENTS * sample.kurtosis();
    samples.coupling.is_none() && few && !sample.is_two_valued()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// P(X ≤ k), X Poisson with mean λ.
    fn poisson(k: i32, mean: f64) -> f64 {
        let terms = (0..=k).scan((-mean).exp(), |term, j| {
            let now = *term;
            *term *= mean / f64::from(j + 1);
            Some(now)
        });
        terms.sum()
    }

    #[test]
    fn poisson_numbers_are_covered_with_the_tail_and_not_without() {
        let covered = |mean: f64, tailed: bool| {
            let inside = |k: i32| {
                let k = f64::from(k);
                let tail = Tail::new(1e6, if k > 0.0 { 1e6 / k } else { f64::NAN }, 1.0).size;
                let tail = if tailed { tail } else { 0.0 };
                (k - mean).abs() <= (1.96 * 1.96 * k + tail * tail).sqrt()
            };
            let probability =
                |k: i32| poisson(k, mean) - if k > 0 { poisson(k - 1, mean) } else { 0.0 };
            (0..200).filter(|&k| inside(k)).map(probability).sum::<f64>()
        };
        for tenths in 1..800 {
            let mean = 0.1 * f64::from(tenths);
            assert!(covered(mean, true) > 0.925, "{mean}: {}", covered(mean, true));
        }
        // The rule before: an interval of no width where no event is seen.
        assert!(covered(1.0, false) < 0.65 && covered(3.0, false) < 0.91);
    }

    #[test]
    fn a_tail_ends_where_thirty_samples_carry_the_variance() {
        assert_eq!(Tail::new(1000.0, 3.0, 5.0), Tail { size: 0.0, enough: 90.0 });
        assert_eq!(Tail::new(1000.0, 40.0, 5.0), Tail { size: 5.0 * UNSEEN, enough: 1200.0 });
        assert_eq!(Tail::new(1000.0, f64::NAN, 0.5), Tail { size: 0.5 * UNSEEN, enough: 3e4 });
    }
}
