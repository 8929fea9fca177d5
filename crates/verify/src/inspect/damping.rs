//! Whether the integral of a damping is the integral of its rate.

use serde::Serialize;
use systems::{Damping, paper::valid};

use super::finding::Status;

/// The integral of a damping compared with the integral of its rate, by quadrature that is refined
/// until it resolves the rate, on 1024 parts of [0, T] and on two uneven pieces of each, whose
/// integrals must add up.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DampingIntegral {
    /// How it is known that they agree to six digits. `Unknown` if they differ in parts only in
    /// which the rate jumps, has a pulse or oscillates too fast for the quadrature: so does every
    /// quadrature, and a wrong formula may.
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
    /// The parts in which the rate jumps, bends, has a pulse or is not resolved.
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
    /// Whether rate and integral are zero wherever they were looked at.
    #[serde(skip)]
    pub(super) none: bool,
    /// Whether the rate is finite at both ends of every part, where schemes may read it.
    #[serde(skip)]
    pub(super) finite: bool,
}

/// Parts of [0, T], a power of two.
const PARTS: u32 = 1024;
/// Cells of a part: each has 33 nodes.
const CELLS: u32 = 8;
/// Nodes of the quadrature.
const NODES: usize = 8;
/// Halvings of a cell in which the rate is not smooth. What is left is round-off of the times.
const HALVINGS: u32 = 40;
/// Most cells that are halved: each jump takes one for every halving.
const BUDGET: u32 = 40_000;
/// Relative tolerance: far above the error of a closed form or a quadrature, far below that of a
/// wrong formula.
const AGREEMENT: f64 = 1e-6;
/// A cell is smooth if halving it changes the integral by no more than this part of ∫|γ|.
const SMOOTH: f64 = 1e-12;
/// A difference that is not below this part of itself after [`HALVINGS`] is at a point.
const POINT: f64 = 1e-6;
/// Where in a part the two pieces meet.
const UNEVEN: f64 = 0.381_966_011_250_105;

/// ∫γ, ∫|γ| and ∫min(γ, 0) over an interval.
#[derive(Clone, Copy, Default)]
struct Integrals {
    net: f64,
    size: f64,
    negative: f64,
}

impl Integrals {
    fn plus(self, b: Self) -> Self {
        let Self { net, size, negative } = self;
        Self { net: net + b.net, size: size + b.size, negative: negative + b.negative }
    }
}

struct Quadrature<'a> {
    rate: &'a dyn Fn(f64) -> f64,
    rule: dgrad::Rule,
    /// Nodes and weights of the rule of Clenshaw and Curtis on [0, 1], which has both ends: Gauss's
    /// rule does not see a jump beside its first node.
    closed: Vec<(f64, f64)>,
    /// Halvings left, and whether one was needed.
    budget: u32,
    halved: bool,
}

impl<'a> Quadrature<'a> {
    fn new(rate: &'a dyn Fn(f64) -> f64) -> Self {
        // w_k = (c_k/n)(1 − Σ_j b_j cos(2πjk/n)/(4j² − 1)) on [−1, 1] (Waldvogel 2006).
        let n = NODES as f64;
        let node = |k: usize| {
            let angle = std::f64::consts::PI * k as f64 / n;
            let sum: f64 = (1..=NODES / 2)
                .map(|j| {
                    let b = if 2 * j == NODES { 1.0 } else { 2.0 };
                    b * (2.0 * j as f64 * angle).cos() / (4 * j * j - 1) as f64
                })
                .sum();
            let c = if k.is_multiple_of(NODES) { 1.0 } else { 2.0 };
            (0.5 * (1.0 - angle.cos()), 0.5 * c / n * (1.0 - sum))
        };
        let closed = (0..=NODES).map(node).collect();
        let rule = valid(dgrad::Rule::new(NODES));
        Self { rate, rule, closed, budget: BUDGET, halved: false }
    }

    fn rule(&self, a: f64, b: f64) -> Integrals {
        let Self { rate, rule, .. } = self;
        Integrals {
            net: rule.integrate(a, b, rate),
            size: rule.integrate(a, b, |t| rate(t).abs()),
            negative: rule.integrate(a, b, |t| rate(t).min(0.0)),
        }
    }

    fn closed(&self, a: f64, b: f64) -> f64 {
        let term = |&(x, w): &(f64, f64)| w * (self.rate)(a + x * (b - a));
        (b - a) * self.closed.iter().map(term).sum::<f64>()
    }

    /// Halves [a, b] until the rule is the same on it, on its halves, and with the ends.
    fn integrate(&mut self, a: f64, b: f64, whole: Integrals, halvings: u32) -> Integrals {
        let middle = 0.5 * (a + b);
        let (left, right) = (self.rule(a, middle), self.rule(middle, b));
        let halves = left.plus(right);
        let smooth = |other: f64| (other - halves.net).abs() <= SMOOTH * halves.size;
        if smooth(whole.net) && smooth(self.closed(a, b)) {
            return halves;
        }
        self.halved = true;
        if halvings == 0 || self.budget == 0 || halves.net.is_nan() {
            return halves;
        }
        self.budget -= 1;
        let left = self.integrate(a, middle, left, halvings - 1);
        left.plus(self.integrate(middle, b, right, halvings - 1))
    }

    /// Looks for a pulse that the quadrature of [a, b] missed, in the half with more of the
    /// difference from the given integral, and so on. The difference of a wrong formula falls with
    /// the interval; that of a pulse does not, until the pulse is seen.
    fn pursue(
        &mut self,
        given: &dyn Fn(f64, f64) -> f64,
        (a, b): (f64, f64),
        whole: Integrals,
        tolerance: f64,
        halvings: u32,
    ) -> Integrals {
        let difference = (given(a, b) - whole.net).abs();
        if difference.is_nan() || difference <= tolerance {
            return whole;
        }
        if halvings == 0 {
            // It is at a point.
            self.halved = true;
            return whole;
        }
        let middle = 0.5 * (a + b);
        let [(left, by_left), (right, by_right)] = [(a, middle), (middle, b)].map(|(a, b)| {
            let rule = self.rule(a, b);
            let half = self.integrate(a, b, rule, HALVINGS);
            (half, (given(a, b) - half.net).abs())
        });
        if by_left > by_right {
            self.pursue(given, (a, middle), left, tolerance, halvings - 1).plus(right)
        } else {
            left.plus(self.pursue(given, (middle, b), right, tolerance, halvings - 1))
        }
    }
}

impl DampingIntegral {
    pub(super) fn of(damping: &dyn Damping, t_end: f64) -> Self {
        let rate = |t| damping.rate(t);
        let mut quadrature = Quadrature::new(&rate);
        let time = |n: u32, of: u32| t_end * f64::from(n) / f64::from(of);
        let mut parts: Vec<(Integrals, bool)> = (0..PARTS)
            .map(|n| {
                quadrature.halved = false;
                let cell = |k| time(n * CELLS + k, PARTS * CELLS);
                let exact = (0..CELLS).fold(Integrals::default(), |sum, k| {
                    let whole = quadrature.rule(cell(k), cell(k + 1));
                    sum.plus(quadrature.integrate(cell(k), cell(k + 1), whole, HALVINGS))
                });
                (exact, quadrature.halved)
            })
            .collect();
        let sum = |parts: &[(Integrals, bool)]| {
            parts.iter().fold(Integrals::default(), |sum, (part, _)| sum.plus(*part))
        };
        // An antiderivative rounds by its own size.
        let round_off = |total: Integrals| 64.0 * f64::EPSILON * total.size;
        let (before, given) = (sum(&parts), |a, b| damping.integral(a, b));
        for (n, (exact, rough)) in (0..PARTS).zip(&mut parts).filter(|(_, (_, rough))| !rough) {
            let (a, b) = (time(n, PARTS), time(n + 1, PARTS));
            let difference = (given(a, b) - exact.net).abs();
            if difference > AGREEMENT * exact.size + round_off(before) {
                let tolerance = (POINT * difference).max(round_off(before));
                quadrature.halved = false;
                *exact = quadrature.pursue(&given, (a, b), *exact, tolerance, HALVINGS);
                *rough = quadrature.halved;
            }
        }
        let total = sum(&parts);
        let average = total.size / f64::from(PARTS);
        let round_off = round_off(total);
        let mut found = Self {
            agrees: Status::Found,
            defect: 0.0,
            relative: 0.0,
            at: 0.0,
            given: 0.0,
            expected: total.net,
            rough: parts.iter().map(|(_, rough)| u32::from(*rough)).sum(),
            longest_step: None,
            resolution: t_end / f64::from(PARTS * CELLS) / (2.0 * NODES as f64),
            t_end,
            least: 0.0,
            none: false,
            finite: (0..=PARTS).all(|n| damping.rate(time(n, PARTS)).is_finite()),
        };
        for (n, &(exact, rough)) in (0..PARTS).zip(&parts) {
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
                let unresolved = rough && !difference.is_nan();
                let because = if unresolved { Status::Unknown } else { Status::Refuted };
                found.agrees = found.agrees.min(because);
            }
        }
        found.none = total.size == 0.0 && found.defect == 0.0;
        let agrees_for = |steps: u32| {
            let parts_of =
                |n: u32| &parts[(n * PARTS / steps) as usize..][..(PARTS / steps) as usize];
            (0..steps).all(|n| {
                let exact = parts_of(n).iter().fold(Integrals::default(), |sum, p| sum.plus(p.0));
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
