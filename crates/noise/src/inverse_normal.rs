//! The quantile function of the normal distribution, for random words.

use real::elementary::{minus_two_ln, split_unit};

use crate::box_muller::open_unit;

/// The quantile Φ⁻¹(u) of N(0, 1) at u = (⌊`word` / 2¹¹⌋ + ½)·2⁻⁵³, which is never 0, ½ or 1.
///
/// It has no branch and no table, and vectorises in a loop over words. With t = |2u − 1|, which is
/// exact, and w = −2 ln(1 − t²), Φ⁻¹(u) = ±t·R(w): the fraction t takes the factor that vanishes at
/// u = ½, and R is smooth and grows as √w. R has two polynomials of degree 14 with positive
/// coefficients, so that nothing cancels. Near u = ½ only the absolute error of w counts.
///
/// The coefficients are a least-squares fit of the relative error at 250 Chebyshev nodes of
/// ln(1 + w/4), 0 ≤ w ≤ 106 ln 2, in 90 digits, with weights from the denominator of the fit before
/// (Sanathanan and Koerner 1963). R errs by 7e-17 of itself; the function by 5.6e-16 of itself
/// (the most at 30 000 words, both tails and the middle among them, measured with 40 digits).
///
/// ```
/// use noise::inverse_normal;
///
/// // Φ(1.96) = 0.975; the largest quantile is that of 1 − 2⁻⁵⁴.
/// let word = (0.975 * 2f64.powi(64)) as u64;
/// assert!((inverse_normal(word) - 1.959_963_984_540_054).abs() < 1e-14);
/// assert_eq!(inverse_normal(!word), -inverse_normal(word));
/// assert!((inverse_normal(u64::MAX) - 8.292_361_075_813_596).abs() < 1e-14);
/// ```
#[inline(always)]
pub fn inverse_normal(word: u64) -> f64 {
    let mut normal = [0.0];
    fill_normals(&[word], &mut normal, 1.0);
    normal[0]
}

/// The quantiles of L words, see [`inverse_normal`], times `scale`.
///
/// There are four loops for the reasons of [`fill_pair`](crate::box_muller::fill_pair).
#[inline(always)]
pub fn fill_normals<const L: usize>(words: &[u64; L], normals: &mut [f64; L], scale: f64) {
    let (mut ts, mut ws) = ([0.0; L], [0.0; L]);
    for p in 0..L {
        // t and 1 − t are odd multiples of 2⁻⁵³ without rounding errors.
        let fraction = open_unit(words[p] >> 11);
        let rest = 1.0 - fraction;
        let (t, below) = if words[p] & SIGN == 0 { (rest, fraction) } else { (fraction, rest) };
        ts[p] = t;
        (ws[p], normals[p]) = split_unit(below * (1.0 + t));
    }
    for p in 0..L {
        ws[p] = minus_two_ln(ws[p], normals[p]);
    }
    for p in 0..L {
        normals[p] = polynomial(NUMERATOR, ws[p]);
    }
    for p in 0..L {
        // Negative for words whose top bit is zero.
        let quantile = ts[p] * (normals[p] / polynomial(DENOMINATOR, ws[p]));
        normals[p] = f64::from_bits(quantile.to_bits() ^ (!words[p] & SIGN)) * scale;
    }
}

/// A polynomial of degree 14 in w: four polynomials in w⁴, which makes short chains of dependent
/// operations.
#[inline(always)]
fn polynomial(c: [f64; 15], w: f64) -> f64 {
    let square = w * w;
    let fourth = square * square;
    let mut sums = [c[8] + c[12] * fourth, c[9] + c[13] * fourth, c[10] + c[14] * fourth, c[11]];
    for i in 0..4 {
        sums[i] = c[i + 4] + sums[i] * fourth;
    }
    for i in 0..4 {
        sums[i] = c[i] + sums[i] * fourth;
    }
    (sums[0] + sums[1] * w) + (sums[2] + sums[3] * w) * square
}

/// The top bit of a word, and the sign bit of a number.
const SIGN: u64 = 1 << 63;

const NUMERATOR: [f64; 15] = [
    1.2533141373155003,
    0.26341556906598634,
    0.03806161378702723,
    0.003990212264614554,
    0.00032115690098852794,
    2.0641774336750103e-05,
    1.0714194037337912e-06,
    4.524632248760426e-08,
    1.575529843550705e-09,
    4.596766752548471e-11,
    1.1111142043018773e-12,
    1.9290322043280006e-14,
    3.8219698485347745e-16,
    2.493611596265188e-18,
    2.8252836233368084e-21,
];
const DENOMINATOR: [f64; 15] = [
    1.0,
    0.07927552173327974,
    0.01673362323385281,
    0.0010643822248121498,
    9.754079906051427e-05,
    4.8175709766285256e-06,
    2.4222042555267287e-07,
    9.036016750598143e-09,
    2.7922132170977817e-10,
    7.921850731443482e-12,
    1.4577865976655495e-13,
    2.9831399424136247e-15,
    3.747532149826722e-17,
    1.0944670731545623e-19,
    3.2777220024392517e-23,
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{StreamKey, stream::next_word};

    /// Lines of k and Φ⁻¹((k + ½)·2⁻⁵³) to 30 digits, by mpmath: random k, both tails to their
    /// ends, and the middle to ½ ± 2⁻⁵⁴.
    const QUANTILES: &str = include_str!("../tests/data/quantiles.txt");

    #[test]
    fn quantiles_are_those_of_thirty_digits() {
        for line in QUANTILES.lines() {
            let (k, quantile) = line.split_once(' ').unwrap();
            let (k, quantile): (u64, f64) = (k.parse().unwrap(), quantile.parse().unwrap());
            for low in [0, 0x7ff] {
                let error = (inverse_normal(k << 11 | low) / quantile - 1.0).abs();
                assert!(error <= 1e-15, "{k}: {error:e}");
            }
        }
        assert!(QUANTILES.lines().count() > 180);
    }

    #[test]
    fn quantiles_are_antisymmetric_and_monotone() {
        let mut state = StreamKey { seed: 1, experiment: 1 }.state(0);
        for n in 0..100_000 {
            let word = next_word(&mut state) >> (n % 64);
            assert_eq!(inverse_normal(word), -inverse_normal(!word));
        }
        // A uniform grid, and grids that double their distance from 0, ½ and 1.
        let mut words: Vec<u64> = (0..1 << 16).map(|k| k << 48).collect();
        for shift in 11..63 {
            for k in 0..64 {
                let distance = (1 << shift) + (k << shift >> 6);
                words.extend([distance, (1 << 63) + distance, (1 << 63) - distance, !distance]);
            }
        }
        words.iter_mut().for_each(|word| *word |= 0x7ff);
        words.sort_unstable();
        words.dedup();
        assert!(words.is_sorted_by(|&a, &b| inverse_normal(a) < inverse_normal(b)));
        assert!(inverse_normal(0) == -inverse_normal(u64::MAX) && inverse_normal(0) < -8.29);
    }
}
