//! Integrals of a rate γ(t) by quadrature that is refined until it resolves the rate.

use dgrad::Rule;

use super::Damping;
use crate::paper::valid;

/// Cells of a part: each has 33 nodes.
const CELLS: u32 = 8;
/// Nodes of the quadrature.
const NODES: usize = 8;
/// Nodes of the first half of [0, 1] and weights of the rule of Clenshaw and Curtis with nine
/// nodes, which has both ends: Gauss's rule does not see a jump beside its first node. The middle
/// counts twice.
const CLOSED: [(f64, f64); 5] = [
    (0.0, 0.007_936_507_936_507_936),
    (0.038_060_233_744_356_62, 0.073_109_324_608_009_08),
    (0.146_446_609_406_726_24, 0.139_682_539_682_539_68),
    (0.308_658_283_817_455_1, 0.180_858_929_360_244_9),
    (0.5, 0.098_412_698_412_698_41),
];
/// Halvings of a cell in which the rate is not smooth; beyond these only round-off of the times is
/// left.
const HALVINGS: u32 = 40;
/// Least length of a cell that is halved, as a part of its time.
const LEAST: f64 = 1e-12;
/// Halvings left between which the cells about a point have less of ∫|γ| than those that are
/// nearer, if it is a pole: about 1/t each halving has the same, and all that are nearer 1.2 times
/// as much; about 1/t^0.9 each has 7 % less, and they half as much.
const FAR: u32 = HALVINGS - 2;
const NEAR: u32 = HALVINGS - 15;
const DIVERGES: f64 = 1.1;
/// Most cells that are halved: each jump takes one for every halving.
const BUDGET: u32 = 40_000;
/// A cell is smooth if halving it changes the integral by no more than this part of ∫|γ|.
const SMOOTH: f64 = 1e-12;
/// Largest difference between a given integral and that of the nodes, as a part of ∫|γ|. A larger
/// one starts the search for a pulse between the nodes.
const AGREEMENT: f64 = 1e-6;
/// A difference that is not below this part of itself after [`HALVINGS`] is at a point.
const POINT: f64 = 1e-6;

/// ∫γ, ∫|γ| and ∫min(γ, 0) over an interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateIntegrals {
    /// ∫γ.
    pub net: f64,
    /// ∫|γ|.
    pub size: f64,
    /// ∫min(γ, 0).
    pub negative: f64,
    /// Whether the rate jumps, bends, has a pulse there, or is not resolved.
    pub rough: bool,
}

impl std::ops::Add for RateIntegrals {
    type Output = Self;

    fn add(self, b: Self) -> Self {
        Self {
            net: self.net + b.net,
            size: self.size + b.size,
            negative: self.negative + b.negative,
            rough: self.rough || b.rough,
        }
    }
}

/// Integrals of a rate over `parts` equal parts of [0, `t_end`], by Gauss–Legendre quadrature on
/// cells that are halved where the rate is not smooth, or where the integral that the damping gives
/// points to a pulse between the nodes. With a time about which the rate has no integral, as about
/// a pole, if there is one: parts that are nearer count as much as those that are farther.
pub fn rate_integrals(
    damping: &dyn Damping,
    t_end: f64,
    parts: u32,
) -> (Vec<RateIntegrals>, Option<f64>) {
    let (rule, near) = (valid(Rule::new(NODES)), (0.0, 0.0));
    let mut quadrature = Refined { damping, rule, budget: BUDGET, near, pole: None };
    let time = |n: u32| t_end * f64::from(n) / f64::from(parts * CELLS);
    let part = |n: u32| {
        (n * CELLS..(n + 1) * CELLS).fold(RateIntegrals::default(), |sum, cell| {
            let (a, b) = (time(cell), time(cell + 1));
            sum + quadrature.integrate(a, b, quadrature.rule(a, b), HALVINGS)
        })
    };
    let mut parts: Vec<_> = (0..parts).map(part).collect();
    let round_off = 64.0 * f64::EPSILON * parts.iter().map(|part| part.size).sum::<f64>();
    for (n, part) in (0..).zip(&mut parts).filter(|(_, part)| !part.rough) {
        let (a, b) = (time(n * CELLS), time((n + 1) * CELLS));
        let difference = (damping.integral(a, b) - part.net).abs();
        if difference > AGREEMENT * part.size + round_off {
            let tolerance = (POINT * difference).max(round_off);
            *part = quadrature.pursue((a, b), *part, tolerance, HALVINGS);
        }
    }
    let infinite = parts.iter().position(|part| !part.net.is_finite());
    let infinite = infinite.map(|n| time(n as u32 * CELLS));
    (parts, quadrature.pole.or(infinite))
}

struct Refined<'a> {
    damping: &'a dyn Damping,
    rule: Rule,
    /// Halvings left.
    budget: u32,
    /// ∫|γ| over all that is nearer, in the cell under way, and its time.
    near: (f64, f64),
    pole: Option<f64>,
}

impl Refined<'_> {
    fn rule(&self, a: f64, b: f64) -> RateIntegrals {
        let nodes = self.rule.nodes().iter().zip(self.rule.weights());
        nodes.fold(RateIntegrals::default(), |sum, (x, w)| {
            let net = (b - a) * w * self.damping.rate(a + (b - a) * x);
            sum + RateIntegrals { net, size: net.abs(), negative: net.min(0.0), rough: false }
        })
    }

    fn closed(&self, a: f64, b: f64) -> f64 {
        let at = |x: f64| self.damping.rate(a + x * (b - a));
        let term = |&(x, w): &(f64, f64)| w * (at(x) + at(1.0 - x));
        (b - a) * CLOSED.iter().map(term).sum::<f64>()
    }

    /// Halves [a, b] until the rule is the same on it, on its halves, and with the ends.
    fn integrate(&mut self, a: f64, b: f64, whole: RateIntegrals, halvings: u32) -> RateIntegrals {
        let middle = 0.5 * (a + b);
        let (left, right) = (self.rule(a, middle), self.rule(middle, b));
        let halves = left + right;
        // Times are rounded: with them rates, by as much as they change.
        let [first, second, third] = [a, middle, b].map(|t| self.damping.rate(t));
        let rounding = f64::EPSILON * b.abs() * ((second - first).abs() + (third - second).abs());
        let rounding = if rounding.is_finite() { rounding } else { 0.0 };
        let smooth = |other: f64| (other - halves.net).abs() <= SMOOTH * halves.size + rounding;
        if smooth(whole.net) && smooth(self.closed(a, b)) {
            return halves;
        }
        let is_point = b - a < LEAST * b;
        if halvings == 0 || is_point || self.budget == 0 || halves.net.is_nan() {
            return RateIntegrals { rough: true, ..halves };
        }
        self.budget -= 1;
        let left = self.integrate(a, middle, left, halvings - 1);
        let sum = left + self.integrate(middle, b, right, halvings - 1);
        if halvings == NEAR {
            self.near = (self.near.0 + sum.size, middle);
        }
        if halvings == FAR {
            let (near, t) = std::mem::take(&mut self.near);
            let is_pole = near > DIVERGES * (sum.size - near);
            self.pole = self.pole.or(is_pole.then_some(t));
        }
        RateIntegrals { rough: true, ..sum }
    }

    /// Looks for a pulse that the quadrature of [a, b] missed, in the half with more of the
    /// difference from the given integral, and so on. The difference of a wrong formula falls with
    /// the interval; that of a pulse does not, until the pulse is seen.
    fn pursue(
        &mut self,
        (a, b): (f64, f64),
        whole: RateIntegrals,
        tolerance: f64,
        halvings: u32,
    ) -> RateIntegrals {
        let difference = (self.damping.integral(a, b) - whole.net).abs();
        if difference.is_nan() || difference <= tolerance {
            return whole;
        }
        if halvings == 0 {
            // It is at a point.
            return RateIntegrals { rough: true, ..whole };
        }
        let middle = 0.5 * (a + b);
        let [(left, by_left), (right, by_right)] = [(a, middle), (middle, b)].map(|(a, b)| {
            let half = self.integrate(a, b, self.rule(a, b), HALVINGS);
            (half, (self.damping.integral(a, b) - half.net).abs())
        });
        if by_left > by_right {
            self.pursue((a, middle), left, tolerance, halvings - 1) + right
        } else {
            left + self.pursue((middle, b), right, tolerance, halvings - 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cosine, DampingFunction};

    #[test]
    fn integrals_of_a_smooth_rate_and_of_a_jump() {
        // γ = cos 7t has ∫ₐᵇ γ = (sin 7b − sin 7a)/7.
        let (cosine, _) = rate_integrals(&Cosine::new(1.0, 7.0).unwrap(), 2.0, 5);
        for (n, part) in (0..5).zip(&cosine) {
            let sine = |n: i32| (7.0 * 0.4 * f64::from(n)).sin() / 7.0;
            assert!((part.net - (sine(n + 1) - sine(n))).abs() < 1e-14, "{n}: {part:?}");
        }
        // −2 up to 1/3, then 1.
        let jump = |t: f64| if t < 1.0 / 3.0 { -2.0 } else { 1.0 };
        let (jump, _) = rate_integrals(&DampingFunction::new(jump, 1).unwrap(), 1.0, 2);
        let [first, second] = jump[..] else { panic!() };
        for (got, exact) in [
            (first.net, -2.0 / 3.0 + 1.0 / 6.0),
            (first.size, 2.0 / 3.0 + 1.0 / 6.0),
            (first.negative, -2.0 / 3.0),
            (second.net, 0.5),
            (second.negative, 0.0),
        ] {
            assert!((got - exact).abs() < 1e-12, "{got} {exact}");
        }
        assert!(first.rough && !second.rough);
    }

    #[test]
    fn a_rate_has_an_integral_about_a_weak_singularity_and_none_about_a_pole() {
        for at in [0.5, 1.0 / 3.0, 0.7, 0.001, 0.001_953_125 * 1.125, 0.5 + 1.0 / 1024.0 / 512.0] {
            for power in [0.25, 0.5, 0.75, 0.9, 1.0, 1.1, 2.0] {
                let rate = move |t: f64| (t - at).abs().powf(-power);
                let damping = DampingFunction::new(rate, 8).unwrap();
                let (parts, pole) = rate_integrals(&damping, 1.0, 64);
                assert_eq!(pole.is_some(), power >= 1.0, "{at} {power}");
                assert!(pole.is_none_or(|t| (t - at).abs() < 1e-4), "{at} {power}");
                // ∫|t − at|^−p has a closed form.
                let exact = [at, 1.0 - at].map(|x| x.powf(1.0 - power) / (1.0 - power));
                let net: f64 = parts.iter().map(|part| part.net).sum();
                let error = net / exact.iter().sum::<f64>() - 1.0;
                assert!(power > 0.5 || error.abs() < 1e-5, "{at} {power}: {error:e}");
            }
        }
    }
}
