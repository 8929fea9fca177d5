//! Normals from random words, by the transform of Box and Muller (1958).

use real::elementary::{half_turn, minus_two_ln, split_unit};

use crate::stream::next_word;

/// Two normals on each of L paths, multiplied by the two scales.
///
/// The bits are those of [`normal_pair`] times the scales. There are three loops because each has
/// one short chain of dependent operations, so that the processor works on several vectors at once,
/// and few enough constants for the registers of AVX2. Between the loops `first` and `second` hold
/// what the logarithm is made of.
#[inline(always)]
pub fn fill_pair<const L: usize>(
    words: &mut [[u64; L]; 4],
    first: &mut [f64; L],
    second: &mut [f64; L],
    first_scale: f64,
    second_scale: f64,
) {
    let mut angle_words = [0; L];
    for p in 0..L {
        let mut state = [words[0][p], words[1][p], words[2][p], words[3][p]];
        (first[p], second[p]) = split_unit(open_unit(next_word(&mut state)));
        angle_words[p] = next_word(&mut state);
        for i in 0..4 {
            words[i][p] = state[i];
        }
    }
    for p in 0..L {
        first[p] = minus_two_ln(first[p], second[p]);
    }
    for p in 0..L {
        let (one, other) = on_circle(first[p], angle_words[p]);
        first[p] = one * first_scale;
        second[p] = other * second_scale;
    }
}

/// Two independent standard normals √(−2 ln u)·(±cos πr, sin πr) from two random words: u is the
/// [`open_unit`] of the first, r and the sign belong to the second, see [`half_circle`].
///
/// The errors are at most 1.5e-15 of the radius. To first order they are 4.3e-16 from the logarithm
/// (half of 3.9 ulp), 5.2e-16 from the direction, and 3.3e-16 from the root and two products.
#[inline(always)]
pub fn normal_pair(radius_word: u64, angle_word: u64) -> (f64, f64) {
    let (l, s) = split_unit(open_unit(radius_word));
    on_circle(minus_two_ln(l, s), angle_word)
}

/// The point on the circle of radius √`square` in the direction of a random word. One division
/// makes both the direction and the radius.
#[inline(always)]
fn on_circle(square: f64, angle_word: u64) -> (f64, f64) {
    let (r, sign) = half_circle(angle_word);
    let (x, y, n) = half_turn(r);
    let scale = square.sqrt() / n;
    (scale * f64::from_bits(x.to_bits() ^ sign), scale * y)
}

/// (k + ½)·2⁻⁵² for k random in 0 .. 2⁵², never 0 and never 1, from the low 52 bits of a random
/// word. The subtraction is exact.
#[inline(always)]
pub fn open_unit(word: u64) -> f64 {
    f64::from_bits((word & FRACTION) | ONE) - (1.0 - 0.5 * f64::EPSILON)
}

/// An odd multiple r of 2⁻⁵² with |r| < ½, from the low 52 bits without the last, and the sign bit
/// of the cosine, from the highest.
///
/// (±cos πr, sin πr) is one of 2⁵² points at equal distances on the circle, each as likely as any
/// other. They are symmetric about both axes, on which none lies.
#[inline(always)]
fn half_circle(word: u64) -> (f64, u64) {
    const SIGN: u64 = 1 << 63;
    (f64::from_bits((word & FRACTION) | (ONE | 1)) - 1.5, word & SIGN)
}

/// The bits of 1.
const ONE: u64 = 1.0f64.to_bits();
/// The bits of the fraction of a number. With [`ONE`] they are a number in [1, 2).
const FRACTION: u64 = (1 << 52) - 1;

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const ROUNDING: f64 = 8.0 * f64::EPSILON;

    #[test]
    fn the_most_extreme_words_give_finite_normals() {
        // Radius √(106 ln 2) at the smallest u = 2⁻⁵³, √(2·2⁻⁵³) at the largest u = 1 − 2⁻⁵³; a few
        // roundings.
        let largest = (106.0 * std::f64::consts::LN_2).sqrt();
        let smallest = f64::EPSILON.sqrt();
        for angle_word in [0, u64::MAX, 1 << 51, 1 << 63, 3 << 50, 0x1234_5678_9abc_def0] {
            for (radius_word, radius) in [(0, largest), (u64::MAX, smallest)] {
                let (one, other) = normal_pair(radius_word, angle_word);
                assert!(one.is_finite() && other.is_finite());
                assert!((one.hypot(other) / radius - 1.0).abs() <= ROUNDING);
            }
        }
        assert!(largest > 8.57 && largest < 8.58);
        // The largest normal is reached with both signs by both: cos π2⁻⁵² rounds to 1.
        let middle = 1 << 51;
        let ends = [middle, middle | 1 << 63, 0, middle - 1].map(|word| normal_pair(0, word));
        assert!(ends[0].0 > 8.57 && ends[1].0 < -8.57);
        assert!(ends[2].1 < -8.57 && normal_pair(0, (1 << 52) - 1).1 > 8.57);
        // Next to an axis the other normal is small and not zero.
        assert!(ends[0].1 > 0.0 && ends[3].1 < 0.0 && ends[0].1 < 1e-14);
    }

    #[test]
    fn uniforms_keep_their_intervals() {
        assert_eq!(open_unit(0), 0.5 * f64::EPSILON);
        assert_eq!(open_unit(u64::MAX), 1.0 - 0.5 * f64::EPSILON);
        assert_eq!(half_circle(0), (f64::EPSILON - 0.5, 0));
        assert_eq!(half_circle(u64::MAX), (0.5 - f64::EPSILON, 1 << 63));
        assert_eq!(half_circle(1 << 51), (f64::EPSILON, 0));
    }

    #[test]
    fn the_map_is_that_of_box_and_muller() {
        // Against the standard sine, cosine and logarithm: their own errors are below
        // 4e-16 of the radius.
        let mut state = [1, 2, 3, 4];
        let mut worst: f64 = 0.0;
        for n in 0..300_000 {
            // Small u and u next to 1 as well.
            let word = next_word(&mut state);
            let word = [word, word >> (n % 50), !(word >> (n % 50))][n % 3];
            let angle_word = next_word(&mut state);
            let (r, sign) = half_circle(angle_word);
            // πr and what is left of it; π itself is rounded by 1.2e-16.
            let angle = PI * r;
            let rest = PI.mul_add(r, -angle) + 1.224_646_799_147_353_2e-16 * r;
            let (sin, cos) = (angle.sin() + rest * angle.cos(), angle.cos() - rest * angle.sin());
            let cos = if sign == 0 { cos } else { -cos };
            let radius = (-2.0 * open_unit(word).ln()).sqrt();
            let (one, other) = normal_pair(word, angle_word);
            worst = worst.max((one / radius - cos).abs()).max((other / radius - sin).abs());
        }
        assert!(worst < 1.5e-15 + 4e-16, "{worst:e}");
    }
}
