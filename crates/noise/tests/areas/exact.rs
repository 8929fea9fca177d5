//! An oracle: almost exact sampling of the Lévy area of two noises.

use std::f64::consts::TAU;

use noise::{AREA_STREAM, StreamKey};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use statrs::distribution::{DiscreteCDF, Poisson};

use crate::written_out::amplitude;

/// Almost exact sampler of the Lévy area of two Wiener processes on one path, given their increment
/// (Malham and Wiese 2014, *Efficient almost-exact Lévy area sampling*).
///
/// With x = λh/2, the characteristic function of A_12 given W is (Lévy 1951)
///
/// E[e^{iλA} | W] = (x/sinh x)·exp(−(|W|²/2h)(x coth x − 1)).
///
/// The first factor belongs to (h/2π) times a standard logistic variable. In the second factor,
/// x coth x − 1 = 2Σ_{k≥1} x²/(π²k² + x²) = 2Σ_k (1 − φ_k). Here φ_k = 1/(1 + λ²b_k²) is the
/// characteristic function of a Laplace variable of scale b_k = h/(2πk). So the second factor
/// belongs to a sum of Laplace variables, Poisson(|W|²/h) many of each scale b_k. The scales k > p
/// = [`JUMP_SCALES`](Self::JUMP_SCALES) are replaced by one normal variable with their variance
/// 2b_1²(|W|²/h)ψ₁(p+1).
///
/// The replacement changes the exponent by at most (|W|²/h)Σ_{k>p}(λb_k)⁴ ≤ (|W|²/h)x⁴/(3π⁴p³). The
/// distribution functions given W differ by at most (|W|²/h)/(3π⁵p³)·∫₀^∞ x⁴/sinh x dx < 0.0526
/// (|W|²/h)/p³, which is 3.3e-6 on average over W. Variance and skewness are exact. The fourth
/// cumulant is too small by at most 8(h/2π)⁴(|W|²/h)/p³.
pub struct ExactArea {
    words: Xoshiro256PlusPlus,
    tail_amplitude: f64,
}

impl ExactArea {
    /// p, the number of scales whose jumps are drawn one by one.
    pub const JUMP_SCALES: u32 = 32;

    /// The sampler of path `path`, from the words of its area stream.
    pub fn new(key: StreamKey, path: u64) -> Self {
        let key = StreamKey { experiment: key.experiment ^ AREA_STREAM, ..key };
        let words = Xoshiro256PlusPlus::seed_from_u64(key.path_seed(path));
        Self { words, tail_amplitude: amplitude(Self::JUMP_SCALES as usize) }
    }

    /// Uniform in (0, 1).
    fn unit(&mut self) -> f64 {
        open_unit(self.words.next_u64())
    }

    /// A_12 over the next step of size `step` > 0, given its *untruncated* increment `dw`.
    ///
    /// There are 64 jumps on average over W, and at most p times the largest value of the truncated
    /// Poisson variables.
    pub fn area(&mut self, step: f64, dw: [f64; 2]) -> f64 {
        let rate = (dw[0] * dw[0] + dw[1] * dw[1]) / step;
        let u = self.unit();
        let mut sum = u.ln() - (1.0 - u).ln();
        for k in 1..=Self::JUMP_SCALES {
            let count = poisson(self.unit(), rate, (-rate).exp());
            let jumps: f64 = (0..count).map(|_| laplace(self.words.next_u64())).sum();
            sum += jumps / f64::from(k);
        }
        let (radius, angle) = ((-2.0 * self.unit().ln()).sqrt(), TAU * self.unit());
        sum += self.tail_amplitude * rate.sqrt() * radius * angle.cos();
        step / TAU * sum
    }
}

/// Uniform in (0, 1), from the low 52 bits of a word.
fn open_unit(word: u64) -> f64 {
    ((word & ((1 << 52) - 1)) as f64 + 0.5) * 0.5f64.powi(52)
}

/// A Laplace variable of scale one: an exponential variable from the low 52 bits, with a sign from
/// the highest bit.
fn laplace(word: u64) -> f64 {
    let exponential = open_unit(word).ln();
    if word >> 63 == 0 { exponential } else { -exponential }
}

/// A Poisson variable by inversion: the smallest n with `u` < P(N ≤ n), where `none` = e^{−mean} =
/// P(N = 0).
///
/// |W|²/h is at most 4·53·ln 2 < 147, so `none` does not underflow. Rounding could keep the sum of
/// the probabilities below `u`, so n is bounded. By Bernstein's inequality P(N ≥ mean + x) ≤
/// exp(−x²/(2mean + 2x/3)), which is below 2⁻⁶⁰ for x = 28 + √(84 mean).
fn poisson(u: f64, mean: f64, none: f64) -> u32 {
    let most = mean + 28.0 + (84.0 * mean).sqrt();
    let (mut probability, mut rest, mut n) = (none, u - none, 0.0);
    while rest >= 0.0 && n < most {
        n += 1.0;
        probability *= mean / n;
        rest -= probability;
    }
    n as u32
}

#[test]
fn poisson_inverts_the_distribution_function() {
    for mean in [1e-9f64, 0.01, 0.7, 2.0, 12.0, 147.0] {
        let reference = Poisson::new(mean).unwrap();
        let none = (-mean).exp();
        for n in 0..250u32 {
            let below = if n == 0 { 0.0 } else { reference.cdf(u64::from(n) - 1) };
            let above = reference.cdf(u64::from(n));
            // The distribution functions differ by rounding: stay 1e-12 away from the jumps.
            for u in [below + 1e-12, 0.5 * (below + above), above - 1e-12] {
                if u > below + 5e-13 && u < above - 5e-13 {
                    assert_eq!(poisson(u, mean, none), n, "mean {mean}, u = {u}");
                }
            }
        }
    }
}

#[test]
fn poisson_always_ends() {
    for (mean, most) in [(0.0f64, 28), (1e-300, 29), (2.0, 43), (147.0, 287)] {
        assert!(poisson(1.0 - 0.5 * f64::EPSILON, mean, (-mean).exp()) <= most);
        assert_eq!(poisson(0.0, mean, (-mean).exp()), 0);
        // Even with probabilities that do not add up to one.
        assert!(poisson(1.0, mean, 0.0) <= most);
    }
    assert_eq!(poisson(0.5, f64::NAN, f64::NAN), 0);
}

#[test]
fn the_most_extreme_words_give_finite_jumps() {
    for word in [0, 1, u64::MAX, u64::MAX - 1] {
        assert!(laplace(word).is_finite());
    }
    assert_eq!(laplace(0), -laplace(1 << 63));
}
