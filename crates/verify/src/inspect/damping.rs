//! Whether the integral of a damping is the integral of its rate.

use serde::Serialize;
use systems::{Damping, RateIntegrals, RateQuadrature};

use super::finding::Status;

/// The integral of a damping compared with the integral of its rate, by quadrature that is refined
/// until it resolves the rate, on 1024 parts of [0, T] and on two uneven pieces of each, whose
/// integrals must add up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DampingIntegral {
    /// How it is known that they agree to six digits. `Unknown` if they differ in parts only in
    /// which the rate jumps or has a pulse: so does every quadrature, and a wrong formula may.
    pub agrees: Status,
    /// The largest difference on a part.
    pub defect: f64,
    /// That relative to the integral of |γ| over the part, or over an average part if that is more.
    pub relative: f64,
    /// The beginning of the part with that difference.
    pub at: f64,
    /// ∫₀ᵀ by adding up the parts.
    pub given: f64,
    /// ∫₀ᵀ by quadrature of the rate.
    pub expected: f64,
    /// The parts in which the rate jumps, bends or has a pulse.
    pub rough: u32,
    /// The longest step T/2ᵏ for which the integrals of all steps agree to six digits, if a part is
    /// one.
    pub longest_step: Option<f64>,
    /// Times between which the rate was not looked at are at most about this far apart.
    pub resolution: f64,
    /// T.
    pub t_end: f64,
    /// The least ∫₀ᵗ given for a t in [0, T], or less.
    #[serde(skip)]
    pub(super) least: f64,
}

/// Parts of [0, T], a power of two.
const PARTS: u32 = 1024;
/// Relative tolerance: far above the error of a closed form or a quadrature, far below that of a
/// wrong formula.
const AGREEMENT: f64 = 1e-6;
/// Where in a part the two pieces meet.
const UNEVEN: f64 = 0.381_966_011_250_105;

impl DampingIntegral {
    pub(super) fn of(damping: &dyn Damping, t_end: f64) -> Self {
        let time = |n: u32, of: u32| t_end * f64::from(n) / f64::from(of);
        let RateQuadrature { parts, complete, resolution } =
            RateQuadrature::new(damping, t_end, PARTS);
        let sum = |parts: &[RateIntegrals]| {
            parts.iter().fold(RateIntegrals::default(), |sum, part| sum + *part)
        };
        let total = sum(&parts);
        let average = total.size / f64::from(PARTS);
        // An antiderivative rounds by its own size.
        let round_off = 64.0 * f64::EPSILON * total.size;
        let mut found = Self {
            agrees: Status::Found,
            defect: 0.0,
            relative: 0.0,
            at: 0.0,
            given: 0.0,
            expected: total.net,
            rough: parts.iter().map(|part| u32::from(part.rough)).sum(),
            longest_step: None,
            resolution,
            t_end,
            least: 0.0,
        };
        for (n, exact) in (0..PARTS).zip(&parts) {
            let (a, b) = (time(n, PARTS), time(n + 1, PARTS));
            let meet = a + UNEVEN * (b - a);
            let given = damping.integral(a, b);
            let added = damping.integral(a, meet) + damping.integral(meet, b);
            found.least = found.least.min(found.given + exact.negative.min(given));
            found.given += given;
            let difference = (given - exact.net).abs().max((added - exact.net).abs());
            let scale = exact.size.max(average);
            if difference.is_nan() || difference > found.defect {
                (found.defect, found.at) = (difference, a);
                found.relative = if scale > 0.0 { difference / scale } else { f64::INFINITY };
            }
            if difference.is_nan() || difference > AGREEMENT * scale + round_off {
                let because = if exact.rough { Status::Unknown } else { Status::Refuted };
                found.agrees = found.agrees.min(because);
            }
        }
        if !complete {
            found.agrees = found.agrees.min(Status::Unknown);
        }
        let agrees_for = |steps: u32| {
            let parts_of =
                |n: u32| &parts[(n * PARTS / steps) as usize..][..(PARTS / steps) as usize];
            (0..steps).all(|n| {
                let exact = sum(parts_of(n));
                let scale = exact.size.max(total.size / f64::from(steps));
                let given = damping.integral(time(n, steps), time(n + 1, steps));
                (given - exact.net).abs() <= AGREEMENT * scale + round_off
            })
        };
        let finest_first = (0..=PARTS.ilog2()).rev().map(|k| 1 << k);
        let longest = finest_first.take_while(|&steps| agrees_for(steps)).last();
        found.longest_step = longest.map(|steps| t_end / f64::from(steps));
        found
    }
}
