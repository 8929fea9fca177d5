//! Are scrambled Sobol points nets, uniform, independent between scrambles, and are paths of them
//! Wiener processes?
//!
//! Nets are checked exactly, everything else by standardised statistics.

use noise::{QuasiWiener, ScrambledSobol, StreamKey};
use real::{Row, WIDTH};
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::statistical::check::{compare, critical, tail};

const KEYS: [StreamKey; 2] = [key(1, 1), key(2, 77)];

const fn key(seed: u64, experiment: u64) -> StreamKey {
    StreamKey { seed, experiment }
}

/// Whether a standard normal is as extreme as that of no perfect scramble.
fn rejects(z: f64) -> bool {
    compare(z, critical()).is_err()
}

/// Whether independent estimates with the mean `expected` are rejected, by Student's t.
fn rejects_mean(estimates: &[f64], expected: f64) -> bool {
    let count = estimates.len() as f64;
    let mean = estimates.iter().sum::<f64>() / count;
    let variance = estimates.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let critical = StudentsT::new(0.0, 1.0, count - 1.0).unwrap().inverse_cdf(1.0 - tail());
    compare((mean - expected) / (variance / count).sqrt(), critical).is_err()
}

/// The first `bits` bits of a word.
fn cell(word: u64, bits: u32) -> usize {
    word.checked_shr(64 - bits).unwrap_or(0) as usize
}

#[test]
fn every_dimension_is_a_net() {
    for (scramble, first) in [(0, 0), (1, 0), (2, 1 << 30)] {
        let sobol = ScrambledSobol::new(KEYS[0], scramble, ScrambledSobol::DIMENSIONS);
        for m in [0, 1, 2, 3, 5, 8, 10] {
            let mut seen = vec![vec![false; 1 << m]; sobol.dimensions()];
            (first..first + (1 << m)).map(|n| sobol.point(n)).for_each(|point| {
                for (seen, word) in seen.iter_mut().zip(point) {
                    seen[cell(word, m)] = true;
                }
            });
            assert!(seen.iter().flatten().all(|&seen| seen), "scramble {scramble}, 2^{m} points");
        }
    }
}

#[test]
fn the_first_two_dimensions_are_a_net() {
    for scramble in 0..20 {
        let sobol = ScrambledSobol::new(KEYS[1], scramble, 2);
        for m in 0..=12 {
            for a in 0..=m {
                let mut seen = vec![false; 1 << m];
                (0..1 << m).map(|n| sobol.point(n)).for_each(|point| {
                    seen[cell(point[0], a) << (m - a) | cell(point[1], m - a)] = true;
                });
                assert!(seen.iter().all(|&seen| seen), "scramble {scramble}, {a} of {m} digits");
            }
        }
    }
}

/// For nested uniform scrambling the n = 2^m points of a dimension are independent and uniform in
/// their intervals of length 1/n. The mean of u then has the variance 1/(12n³) and the fourth
/// moment of a sum of n independent uniforms, whose excess is −1.2/n.
#[test]
fn the_mean_of_u_has_the_variance_of_nested_uniform_scrambling() {
    const SCRAMBLES: u64 = 8000;
    for key in KEYS {
        for m in 2..=10 {
            let n = f64::from(1 << m);
            let mut squares = [0.0; 3];
            let mut alike = 0.0;
            for scramble in 0..SCRAMBLES {
                let sobol = ScrambledSobol::new(key, scramble, 3);
                let mut sums = [0.0; 3];
                (0..1 << m).map(|n| sobol.point(n)).for_each(|point| {
                    for d in 0..3 {
                        sums[d] += ScrambledSobol::uniform(point[d]) - 0.5;
                    }
                });
                for d in 0..3 {
                    squares[d] += (sums[d] / n).powi(2);
                }
                // A twin: a random shift of all points alike has the variance 1/(12n²).
                let word = sobol.point(0)[0] << m;
                alike += ((ScrambledSobol::uniform(word) - 0.5) / n).powi(2);
            }
            let ratio = |sum: f64| sum / SCRAMBLES as f64 * 12.0 * n.powi(3);
            let error = ((2.0 - 1.2 / n) / SCRAMBLES as f64).sqrt();
            for square in squares {
                assert!(!rejects((ratio(square) - 1.0) / error), "2^{m}: {}", ratio(square));
            }
            assert!(rejects((ratio(alike) - 1.0) / error));
        }
    }
}

/// Whether any of the upper 53 bits of `scrambles` words is not fair.
fn rejected_bits(scrambles: u64, word: impl Fn(u64) -> u64) -> bool {
    let mut counts = [0; 53];
    for scramble in 0..scrambles {
        let word = word(scramble) >> 11;
        counts.iter_mut().enumerate().for_each(|(bit, count)| *count += word >> bit & 1);
    }
    let n = scrambles as f64;
    counts.iter().any(|&count| rejects((count as f64 - 0.5 * n) / (0.25 * n).sqrt()))
}

/// Each of the 53 bits of a coordinate is fair over scrambles; so is each sum modulo 2 of the bits
/// of two dimensions, two scrambles, two keys, two points of a padded dimension, the lower bits of
/// two points, and neighbouring bits. These are 45 × 53 = 2385 bits for each key.
#[test]
fn bits_are_fair_and_independent() {
    const SCRAMBLES: u64 = 20_000;
    for key in KEYS {
        let other = StreamKey { experiment: key.experiment + 1, ..key };
        for point in [0, 1, 12_345] {
            let words: Vec<_> = (0..=SCRAMBLES)
                .map(|scramble| {
                    let sobol = ScrambledSobol::new(key, scramble, 1026);
                    let other = ScrambledSobol::new(other, scramble, 1);
                    let [word, next] = [point, point + 1].map(|p| sobol.point(p));
                    let others = [other.point(point)[0], next[1024], next[2]];
                    ([0, 1, 2, 500, 1024, 1025].map(|d| word[d]), others)
                })
                .collect();
            let rejected = |f: &dyn Fn(usize) -> u64| rejected_bits(SCRAMBLES, |r| f(r as usize));
            for d in [0, 1, 3, 4] {
                assert!(!rejected(&|r| words[r].0[d]));
                assert!(!rejected(&|r| words[r].0[d] ^ words[r + 1].0[d]));
            }
            for (d, e) in [(0, 1), (3, 4), (4, 5)] {
                assert!(!rejected(&|r| words[r].0[d] ^ words[r].0[e]));
            }
            assert!(!rejected(&|r| words[r].0[0] ^ words[r].1[0]));
            assert!(!rejected(&|r| words[r].0[4] ^ words[r].1[1]));
            assert!(!rejected(&|r| words[r].0[0] ^ words[r].0[0] << 1));
            assert!(!rejected(&|r| {
                let lower = (words[r].0[2] ^ words[r].1[2]) & u64::from(u32::MAX);
                lower << 32 | lower
            }));
        }
        // A twin: a bit that is set in 55 of 100 words.
        assert!(rejected_bits(SCRAMBLES, |r| if r % 100 < 55 { u64::MAX } else { 0 }));
    }
}

/// The values W_m at the nodes of a path, row n·M + m at the end of step n.
fn values(increments: &[Row], noises: usize, p: usize) -> Vec<f64> {
    let mut values: Vec<f64> = increments.iter().map(|row| row[p]).collect();
    for row in noises..values.len() {
        values[row] += values[row - noises];
    }
    values
}

/// Means over 2¹⁰ points of all products of two values, for each of 64 scrambles.
fn products(key: StreamKey, steps: u64, noises: usize, t_end: f64) -> Vec<Vec<f64>> {
    let rows = steps as usize * noises;
    let mut means = vec![Vec::new(); rows * rows];
    let mut increments = vec![[0.0; WIDTH]; rows];
    for scramble in 0..64 {
        let noise = QuasiWiener::new(key, scramble, steps, noises, t_end).unwrap();
        let mut sums = vec![0.0; rows * rows];
        for first_point in (0..1 << 10).step_by(WIDTH) {
            noise.block(first_point, &mut increments);
            for p in 0..WIDTH {
                let values = values(&increments, noises, p);
                for i in 0..rows {
                    for j in 0..rows {
                        sums[i * rows + j] += values[i] * values[j];
                    }
                }
            }
        }
        for (means, sum) in means.iter_mut().zip(sums) {
            means.push(sum / f64::from(1 << 10));
        }
    }
    means
}

/// E W_l(s) W_m(t) = min(s, t) for l = m and 0 otherwise: 3 + 10 + 21 + 105 + 136 + 120 products
/// for each key.
#[test]
fn values_have_the_covariance_of_wiener_processes() {
    const T: f64 = 2.5;
    for key in KEYS {
        for (steps, noises) in [(1, 2), (2, 2), (3, 2), (7, 2), (8, 2), (5, 3)] {
            let rows = steps as usize * noises;
            let means = products(key, steps, noises, T);
            for i in 0..rows {
                for j in 0..=i {
                    let same = (i % noises == j % noises) as u8;
                    let node = j / noises + 1;
                    let expected = f64::from(same) * T * node as f64 / steps as f64;
                    let what = format!("{steps} steps, {i} and {j}, {expected}");
                    assert!(!rejects_mean(&means[i * rows + j], expected), "{what}");
                }
            }
            // A twin: another end of time.
            assert!(rejects_mean(&means[rows * rows - 1], 1.02 * T));
        }
    }
}

/// The exponential of the mean of W at the ends of eight steps: E exp(A) = exp(Var A / 2).
#[test]
fn a_smooth_functional_has_a_small_error() {
    const STEPS: usize = 8;
    const POINTS: u64 = 1 << 12;
    let step = 1.0 / STEPS as f64;
    let variance =
        (0..STEPS * STEPS).map(|ij| step * (1 + (ij / STEPS).min(ij % STEPS)) as f64).sum::<f64>()
            / (STEPS * STEPS) as f64;
    let exact = (0.5 * variance).exp();
    for key in KEYS {
        let mut increments = [[0.0; WIDTH]; STEPS];
        let mut means = Vec::new();
        for scramble in 0..64 {
            let noise = QuasiWiener::new(key, scramble, STEPS as u64, 1, 1.0).unwrap();
            let mut sum = 0.0;
            for first_point in (0..POINTS).step_by(WIDTH) {
                noise.block(first_point, &mut increments);
                for p in 0..WIDTH {
                    let mean = values(&increments, 1, p).iter().sum::<f64>() / STEPS as f64;
                    sum += mean.exp();
                }
            }
            means.push(sum / POINTS as f64);
        }
        assert!(!rejects_mean(&means, exact));
        let error = means.iter().map(|mean| (mean - exact).powi(2)).sum::<f64>() / 64.0;
        let random = exact * exact * (variance.exp() - 1.0) / POINTS as f64;
        let ratio = (random / error).sqrt();
        assert!(ratio > 20.0, "{ratio}");
    }
}
