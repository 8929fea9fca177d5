//! Whether the integral of a damping is the integral of its rate.

use std::fmt;

use serde::Serialize;
use systems::{
    Damping,
    probe::{RateIntegrals, rate_integrals},
};

use super::Status;

/// The integral of a damping compared with the integral of its rate, by quadrature that is refined
/// until it resolves the rate, on 1024 parts of [0, T] and on two uneven pieces of each, whose
/// integrals must add up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DampingIntegral {
    /// Whether the two integrals agree to six digits. `Unknown` if they differ only in parts where
    /// the rate jumps, has a pulse or oscillates too fast for the quadrature: there every
    /// quadrature differs, and a wrong formula may.
    pub agrees: Status,
    /// Largest difference of the two integrals over a part.
    pub defect: f64,
    /// Largest difference relative to the integral of |γ| over the part, or over an average part
    /// if that is larger.
    pub relative: f64,
    /// Beginning of the part with the largest difference.
    pub at: f64,
    /// Integral ∫₀ᵀγ by quadrature of the rate.
    pub expected: f64,
    /// Lower bound of the given integral ∫₀ᵗγ over t in [0, T].
    #[serde(skip)]
    pub(crate) least: f64,
    /// Whether rate and integral are zero at every point that was checked.
    #[serde(skip)]
    pub(crate) none: bool,
    /// Whether the rate is finite at both ends of every part, where schemes may read it.
    #[serde(skip)]
    pub(crate) finite: bool,
}

/// Number of parts of [0, T].
const PARTS: u32 = 1024;
/// Relative tolerance: far above the error of a closed form or a quadrature, far below that of a
/// wrong formula. Of an average part it is a billionth of the whole, and more than an
/// antiderivative rounds.
const AGREEMENT: f64 = 1e-6;
/// Point where the two pieces of a part meet, as a fraction of the part.
const UNEVEN: f64 = 0.381_966_011_250_105;

impl DampingIntegral {
    /// Compares the integral of `damping` up to `t_end` with the integral of its rate.
    pub fn of(damping: &dyn Damping, t_end: f64) -> Self {
        let time = |n: u32| t_end * f64::from(n) / f64::from(PARTS);
        let (parts, pole) = rate_integrals(damping, t_end, PARTS);
        let total = parts.iter().fold(RateIntegrals::default(), |sum, part| sum + *part);
        let average = total.size / f64::from(PARTS);
        let finite = (0..=PARTS).all(|n| damping.rate(time(n)).is_finite());
        let mut found = Self { expected: total.net, finite, ..Self::default() };
        let mut sum = 0.0;
        for (n, exact) in (0..PARTS).zip(&parts) {
            let (a, b) = (time(n), time(n + 1));
            let meet = a + UNEVEN * (b - a);
            let given = damping.integral(a, b);
            let added = damping.integral(a, meet) + damping.integral(meet, b);
            found.least = found.least.min(sum + exact.negative.min(given));
            sum += given;
            let difference = (given - exact.net).abs().max((added - exact.net).abs());
            let scale = exact.size.max(average);
            if difference.is_nan() || difference > found.defect {
                (found.defect, found.at) = (difference, a);
                found.relative = if scale > 0.0 { difference / scale } else { f64::INFINITY };
            }
            if difference.is_nan() || difference > AGREEMENT * scale {
                let unresolved = exact.rough && !difference.is_nan();
                found.agrees =
                    found.agrees.min(if unresolved { Status::Unknown } else { Status::Fails });
            }
        }
        if pole.is_some() {
            found.agrees = Status::Fails;
        }
        found.none = total.size == 0.0 && found.defect == 0.0;
        found
    }

    /// Describes the mistake, if the integral is known to be wrong.
    pub fn mistake(&self) -> Option<String> {
        let words = format!("the integral of the damping is not that of its rate: {self}");
        (self.agrees == Status::Fails).then_some(words)
    }
}

impl fmt::Display for DampingIntegral {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { agrees, defect, relative, at, .. } = self;
        match agrees {
            Status::Holds => write!(f, "rate and integral agree to {relative:.0e}"),
            _ => write!(f, "rate and integral DISAGREE by {defect:.1e} from t = {at:.4} on"),
        }
    }
}

#[cfg(test)]
mod tests {
    use systems::{Cosine, DampingFunction};

    use super::*;

    /// A rate and an integral that need not belong together.
    struct Given<R, I>(R, I);

    impl<R: Fn(f64) -> f64 + Send + Sync, I: Fn(f64, f64) -> f64 + Send + Sync> Damping
        for Given<R, I>
    {
        fn rate(&self, t: f64) -> f64 {
            (self.0)(t)
        }
        fn integral(&self, a: f64, b: f64) -> f64 {
            (self.1)(a, b)
        }
        fn describe(&self) -> String {
            "given".into()
        }
    }

    fn of(rate: fn(f64) -> f64, integral: fn(f64, f64) -> f64, t_end: f64) -> DampingIntegral {
        DampingIntegral::of(&Given(rate, integral), t_end)
    }

    fn near(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-9 * expected.abs()
    }

    #[test]
    fn a_kick_is_found_in_its_part_with_its_size() {
        let kick = |a, b| 2.0 * (b - a) + if a <= 0.6 && 0.6 < b { 0.01 } else { 0.0 };
        let found = of(|_| 2.0, kick, 2.0);
        // Part 307 of 1024, in which the rate has the integral 4/1024.
        assert!(found.at == 307.0 / 512.0 && near(found.defect, 0.01), "{found:?}");
        assert!(near(found.relative, 2.56) && near(found.expected, 4.0), "{found:?}");
        assert!(found.finite && !found.none && found.agrees == Status::Unknown);
    }

    #[test]
    fn a_difference_is_relative_to_an_average_part_at_least() {
        // The rate is zero up to ½ and 4 beyond: 2/1024 in an average part, 4/1024 in the others.
        fn rate(t: f64) -> f64 {
            if t < 0.5 { 0.0 } else { 4.0 }
        }
        fn integral(a: f64, b: f64) -> f64 {
            4.0 * (b.max(0.5) - a.max(0.5))
        }
        // Off in the part that begins at ¼, or in that at ¾.
        let off = |at: f64, by: f64| {
            let integral = move |a, b| integral(a, b) + if a == at { by } else { 0.0 };
            DampingIntegral::of(&Given(rate, integral), 1.0)
        };
        for (at, by, parts) in [(0.25, 1.9e-9, 512.0), (0.75, 3.8e-9, 256.0)] {
            let found = off(at, by);
            let relative = found.relative / (by * parts);
            assert!(found.agrees.holds() && (relative - 1.0).abs() < 1e-6, "{found:?}");
        }
        assert!(!off(0.25, 2.1e-9).agrees.holds() && !off(0.75, 4.2e-9).agrees.holds());
    }

    #[test]
    fn pieces_of_a_part_must_add_up() {
        // Right on every part, and not on its pieces.
        let uneven = |a: f64, b: f64| if (1024.0 * a).fract() > 0.0 { 0.0 } else { b - a };
        let found = of(|_| 1.0, uneven, 1.0);
        assert!(found.agrees == Status::Fails, "{found:?}");
        assert!(near(found.relative, 1.0 - UNEVEN), "{found:?}");
    }

    #[test]
    fn the_least_integral_counts_what_is_negative_within_a_part() {
        // ∫cos = sin t, least at 3π/2, which is no end of a part of [0, 6].
        let found = of(f64::cos, |a, b| b.sin() - a.sin(), 6.0);
        assert!(found.least <= -1.0 && found.least > -1.0 - 1e-4, "{found:?}");
        // And −∞ rather than the sums of the parts where the rate is said to be negative.
        let found = of(|t| 1.0 - t, |a, b| (b - a) * (1.0 - 0.5 * (a + b)), 4.0);
        assert!(near(found.least, -4.0), "{found:?}");
    }

    #[test]
    fn what_is_zero_or_not_finite_is_said() {
        let nothing = of(|_| 0.0, |_, _| 0.0, 1.0);
        assert!(nothing.none && nothing.finite && nothing.agrees.holds());
        let integral = of(|_| 0.0, |a, b| b - a, 1.0);
        assert!(!integral.none && integral.relative == f64::INFINITY, "{integral:?}");
        assert_eq!(integral.agrees, Status::Fails);
        assert!(!of(|t| 0.5 / t.sqrt(), |a, b| b.sqrt() - a.sqrt(), 1.0).finite);
        let nowhere = of(|t| if t > 0.5 { f64::NAN } else { 1.0 }, |a, b| b - a, 1.0);
        assert_eq!(nowhere.agrees, Status::Fails, "{nowhere:?}");
    }

    /// A pulse of the integral 1.5 from `start` on, of this width, with its integral.
    fn pulse(start: f64, width: f64) -> impl Damping {
        let height = 1.5 / width;
        let rate = move |t: f64| if t >= start && t < start + width { height } else { 0.0 };
        let until = move |t: f64| height * (t - start).clamp(0.0, width);
        Given(rate, move |a, b| until(b) - until(a))
    }

    #[test]
    fn a_pulse_that_a_quadrature_misses_is_seen_and_its_integral_is_no_mistake() {
        for (start, width) in [(0.37, 1e-4), (0.123_456, 1e-3), (0.5, 0.01), (0.6123, 0.3)] {
            let right = DampingIntegral::of(&pulse(start, width), 1.0);
            assert_eq!(right.agrees, Status::Holds, "{start} {width}: {right}");
            let pulse = pulse(start, width);
            let missed = DampingFunction::new(move |t| pulse.rate(t), 8).unwrap();
            let missed = DampingIntegral::of(&missed, 1.0);
            assert_eq!(missed.agrees, Status::Unknown, "{start} {width}: {missed}");
            assert!((missed.expected - 1.5).abs() < 1e-9, "{missed}");
            assert!(missed.to_string().contains("DISAGREE"));
        }
    }

    #[test]
    fn what_the_quadrature_misses_is_no_mistake() {
        let judge = |damping: &dyn Damping, resolved: bool| {
            let found = DampingIntegral::of(damping, 1.0);
            assert_ne!(found.agrees, Status::Fails, "{found:?}");
            assert!(!resolved || found.agrees == Status::Holds, "{found:?}");
        };
        // Pulses far narrower than the distance of the nodes.
        for width in [1e-6, 1e-7, 1e-8, 1e-9, 1e-12] {
            judge(&pulse(0.371_23, width), width >= 1e-8);
        }
        // Oscillations faster than the nodes.
        for frequency in [1e4, 1e5, 1e6, 1e8] {
            judge(&Cosine::new(1.0, frequency).unwrap(), frequency <= 1e5);
        }
        for periods in [4.0, 1024.0, 3000.0, 1e5] {
            let on = move |t: f64| if (t * periods).fract() < 0.5 { 2.0 } else { 0.0 };
            let until = move |t: f64| {
                let x = t * periods;
                (x.floor() + (2.0 * x.fract()).min(1.0)) / periods
            };
            judge(&Given(on, move |a, b| until(b) - until(a)), false);
        }
    }

    #[test]
    fn a_wrong_integral_is_still_a_mistake() {
        for factor in [1.01, 1.0 + 1e-5, 0.0, -1.0] {
            let until = |t: f64| t + t * t * t / 3.0;
            let smooth = Given(|t: f64| 1.0 + t * t, move |a, b| factor * (until(b) - until(a)));
            let until = |t: f64| (30.0 * t).sin() / 30.0;
            let wave = Given(|t: f64| (30.0 * t).cos(), move |a, b| factor * (until(b) - until(a)));
            for damping in [&smooth as &dyn Damping, &wave] {
                let found = DampingIntegral::of(damping, 1.0);
                assert_eq!(found.agrees, Status::Fails, "{factor}: {found:?}");
            }
        }
    }
}
