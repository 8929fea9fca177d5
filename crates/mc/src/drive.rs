//! Resolution by the steps of a scheme of what changes with time: Hamiltonians, and functions that
//! paths integrate or follow.
//!
//! A step reads H(t) in its middle. What changes within steps and not from step to step is missed:
//! a pulse between two middles, or a drive whose period divides the step. All step sizes that miss
//! it agree. So at y₀ and at a point beside it each component f of B∇H₀, B∇H₁, … is compared, over
//! eight steps in a row, with itself at random times within the steps:
//!
//! Σ ⟨|f(s) − f(middle)|⟩ ≤ 0.35 · 2 · 8/9 · Σ |f(middle after) − f(middle)|,
//!
//! with nine changes from the step before to the step after.
//!
//! The quotient of both sums is 1/8 where f is smooth, 0.28 at most where it jumps, 0.19 for two
//! steps in a period. Of a faster oscillation it is 4/π over 4 sin(α/2), where α is by how much a
//! step advances its phase: 0.37 or more at τ or at τ/2, for any α. What agrees in mean and in
//! square with what is read is the same within the step. Where functions have bounds over
//! intervals, as formulas do, intervals are halved until bounds leave no room for a pulse between
//! random times.

use std::{array, cell::RefCell, collections::BTreeMap, sync::Arc};

use real::{Bounded, Row, WIDTH, golden};
use systems::run_time::InTime;

use crate::{InTimeAt, Problem};

/// Number of steps that are compared together.
const WINDOW: usize = 8;
/// Number of random times within each step, one in each of equal parts.
const INSIDE: usize = WIDTH / WINDOW;
/// The largest change within steps for a change of one from step to step: between 0.28 and 0.37.
const MOST: f64 = 0.35;
/// Part of the size of a function below which changes do not matter.
const NEGLIGIBLE: f64 = 1e-6;
/// Largest number of intervals that are halved, for one state.
const BUDGET: u32 = 4096;
/// Scale of the distance of the second point from y₀.
const BESIDE: f64 = 0.3;

/// Resolution of functions that change with time by steps.
pub struct DriveResolution<'a> {
    /// Functions of time and the state; y₀ and the point beside it.
    in_time: Vec<Arc<dyn InTimeAt + 'a>>,
    points: [Vec<f64>; 2],
    t_end: f64,
    known: RefCell<BTreeMap<u64, Option<f64>>>,
}

impl<'a> DriveResolution<'a> {
    /// Resolution of what changes with time in a problem.
    pub fn new(Problem { y0, t_end, in_time, .. }: &Problem<'a>) -> Self {
        let place = |i: usize| golden((i + 1) as f64) - 0.5;
        let moved = |(i, y): (usize, &f64)| y + BESIDE * place(i) * y.abs().max(1.0);
        let beside: Vec<f64> = y0.iter().enumerate().map(moved).collect();
        let points = [y0.clone(), beside];
        Self { in_time: in_time.clone(), points, t_end: *t_end, known: RefCell::default() }
    }

    /// A time near which `steps` steps on [0, T], or half of them, do not resolve a function.
    pub fn unresolved(&self, steps: u64) -> Option<f64> {
        let all = self.in_time.iter().flat_map(|of| self.points.iter().map(|y| of.at(y)));
        let search = |steps| all.clone().find_map(|of| search(&*of, self.t_end, steps));
        let find = |n| *self.known.borrow_mut().entry(n).or_insert_with(|| search(n));
        [steps.div_ceil(2), steps].into_iter().find_map(find)
    }
}

/// A time near which `steps` steps on [0, T] do not resolve one of the functions.
fn search(functions: &dyn InTime, t_end: f64, steps: u64) -> Option<f64> {
    let tau = t_end / steps as f64;
    let (mut scales, mut budget) = (Vec::new(), BUDGET);
    let count = steps.min(WINDOW as u64) as usize;
    (0..steps).step_by(WINDOW).find_map(|first| {
        // The last window is as long as the others.
        let first = first.min(steps - count as u64) as f64;
        // Of the step before, of each step, and of the step after. Nothing is read at 0 and T:
        // beyond them is what the second step from there reads. One step alone has no other.
        let [begins, ends] = [first == 0.0, first + count as f64 == steps as f64];
        let place = |k: usize| match k.min(count + 1) {
            0 if begins && count > 1 => 2,
            k if k > count && ends && count > 1 => count - 1,
            k => k,
        };
        let middle = |k: usize| ((first + place(k) as f64 - 0.5) * tau).clamp(0.0, t_end);
        let read = functions.values(&array::from_fn(middle));
        let inside: Row = array::from_fn(|k| {
            let random = golden(first * INSIDE as f64 + k as f64);
            let part = (random + (k % INSIDE) as f64) / INSIDE as f64;
            (first + (k / INSIDE).min(count - 1) as f64 + part) * tau
        });
        let values = functions.values(&inside);
        scales.resize(read.len(), 0.0f64);
        let window = (first * tau, (first + count as f64) * tau);
        let bounds = functions.bounds(interval(window));
        read.iter().zip(&values).zip(&mut scales).enumerate().find_map(|(i, (rows, scale))| {
            let (read, values) = (&rows.0[..count + 2], &rows.1[..count * INSIDE]);
            let all = || read.iter().chain(values).copied();
            let lo = all().fold(f64::INFINITY, f64::min);
            let hi = all().fold(-f64::INFINITY, f64::max);
            *scale = all().fold(*scale, |scale, f| scale.max(f.abs()));
            let changes = read.windows(2).map(|pair| (pair[1] - pair[0]).abs());
            let visible = 2.0 * changes.sum::<f64>() * count as f64 / (count + 1) as f64;
            let apart = |(k, f): (usize, &f64)| {
                (inside[k], (f - read[1 + k / INSIDE]).abs() / INSIDE as f64)
            };
            let mut parts: Vec<_> = values.iter().enumerate().map(apart).collect();
            let seen = (2.0 * lo - hi, 2.0 * hi - lo);
            let is_seen = |bound: &Bounded| {
                seen.0 <= bound.value - bound.error && bound.value + bound.error <= seen.1
            };
            if !bounds.get(i).is_none_or(is_seen) {
                beyond(functions, i, seen, *scale, window, &mut budget, &mut |t, area| {
                    parts.push((t, area / tau));
                });
            }
            let within: f64 = parts.iter().map(|part| part.1).sum();
            let (t, _) = parts.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
            (within > MOST * visible + NEGLIGIBLE * *scale).then_some(t)
        })
    })
}

/// An interval of times as a variable with bounds.
fn interval((a, b): (f64, f64)) -> Bounded {
    Bounded { error: 0.5 * (b - a), ..Bounded::variable(0.5 * (a + b)) }
}

/// Calls `found` with times of a window at which function number i is outside of what was seen,
/// from `lo` to `hi`, and with the area there, by halving intervals until bounds leave no more.
fn beyond(
    functions: &dyn InTime,
    i: usize,
    (lo, hi): (f64, f64),
    scale: f64,
    window: (f64, f64),
    budget: &mut u32,
    found: &mut dyn FnMut(f64, f64),
) {
    let outside = |f: f64| (lo - f).max(f - hi).max(0.0);
    let (mut cells, mut largest) = (vec![window], scale.max(f64::MIN_POSITIVE));
    while let Some((a, b)) = cells.pop() {
        let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
        let Bounded { value, error, .. } = functions.bounds(interval((a, b)))[i];
        let error = if error.is_nan() { f64::INFINITY } else { error };
        let (most, least) = (outside(value - error).max(outside(value + error)), outside(value));
        // Of values, not of bounds, which may be far too large.
        largest = largest.max(value.abs());
        if most * (b - a) <= NEGLIGIBLE * (window.1 - window.0) * largest {
            continue;
        }
        if error <= 0.5 * least || *budget == 0 || half <= f64::EPSILON * middle {
            found(middle, least * (b - a));
        } else {
            *budget -= 1;
            cells.extend([(a, middle), (middle, b)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;

    /// A function without bounds.
    struct Of<F>(F);

    impl<F: Fn(f64) -> f64 + Send + Sync> InTimeAt for Of<F> {
        fn at(&self, _: &[f64]) -> Box<dyn InTime + '_> {
            Box::new(Of(&self.0))
        }
    }

    impl<F: Fn(f64) -> f64 + Send + Sync> InTime for Of<F> {
        fn values(&self, times: &Row) -> Vec<Row> {
            vec![times.map(&self.0)]
        }
    }

    /// Whether 100 or 200 steps on [0, 1] do not resolve it.
    fn missed<'a>(f: impl Fn(f64) -> f64 + Send + Sync + 'a) -> Option<f64> {
        let (in_time, known): (Vec<Arc<dyn InTimeAt + 'a>>, _) =
            (vec![Arc::new(Of(f))], RefCell::default());
        let points = [vec![], vec![]];
        DriveResolution { in_time, points, t_end: 1.0, known }.unresolved(200)
    }

    #[test]
    fn aliases_are_missed_and_waves_of_four_steps_are_not() {
        for k in 0..400 {
            let phase = TAU * golden(f64::from(k));
            let wave = |f: f64| missed(move |t| (TAU * f * t + phase).cos());
            let (slow, fast) = (25.0 * f64::from(k) / 400.0, 150.0 + 7.3 * f64::from(k));
            assert_eq!(wave(slow), None, "{slow} {phase}");
            assert!(wave(fast).is_some(), "{fast} {phase}");
        }
    }

    #[test]
    fn jumps_anywhere_are_resolved_and_short_pulses_that_are_met_are_not() {
        for k in 0..2000 {
            let at = f64::from(k) / 2000.0 + 1e-7;
            // Before the first time that is read and after the last one it may be a pulse.
            let unread = !(0.005..0.995).contains(&at);
            assert!(unread || missed(|t| if t < at { 3.0 } else { -1.0 }).is_none(), "{at}");
        }
        // A third of a step of the longer kind, on a wave: some random time meets it.
        for k in 0..50 {
            let at = golden(f64::from(k)) * 0.98;
            let near = missed(|t| t + if t > at && t < at + 0.0033 { 1.0 } else { 0.0 });
            assert!(near.is_none_or(|t| (t - at).abs() < 0.01), "{at} {near:?}");
        }
        // What only the ends see.
        for width in [1e-3, 1.5e-3] {
            let decay = |t: f64| 1.0 + 1000.0 * (-t / width).exp();
            assert!(missed(decay).is_some_and(|t| t < 0.01), "{width}");
            assert!(missed(|t| decay(1.0 - t)).is_some_and(|t| t > 0.99), "{width}");
            assert!(missed(|t| decay((t - 0.9991).abs())).is_some_and(|t| t > 0.99), "{width}");
        }
        let slow = |t: f64| (-t / 0.05).exp();
        assert!(missed(slow).is_none() && missed(|t| slow(1.0 - t)).is_none());
        // A slope by few steps.
        for steps in [1, 2, 3] {
            assert!(search(&Of(|t: f64| 1.0 + t), 1.0, steps).is_none(), "{steps}");
        }
        let hidden = |t: f64| if t > 0.5 && t < 0.5024 { 1.0 } else { 0.0 };
        assert!(missed(hidden).is_some_and(|t| (t - 0.501).abs() < 0.003));
    }
}
