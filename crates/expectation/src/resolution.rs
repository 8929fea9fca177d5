//! Whether the steps resolve the motion, the damping and every φ.
//!
//! A rotation with ωτ ≫ 1 has the right size and the wrong phase on the fine and on the coarse path
//! alike, and expectations over it may agree on several levels by aliasing. The states then do not:
//! for each component the root mean square of fine minus coarse, over all paths and coarse times,
//! is divided by that of its motion y − y(0). Two paths of uncorrelated phases give √(2/3) to √2.
//! Each φ is compared in the same way, at eight coarse times.
//!
//! **Paths part** in the end, at any step size, where they do not contract or events decide, and
//! the means of φ agree nevertheless. Then the first part of the time is asked, up to T/8 or T/64:
//! steps that resolve a motion of the same size there are not what parts the paths later.
//!
//! **Exact flows** have the phase of a rotation at any step, so that states agree while noise and
//! damping act on it once in a step only. Then a rate of the motion that is known from elsewhere is
//! asked.

use real::{PathMask, Row, WIDTH};
use stats::{ROUND_OFF, Warning as Message};

use super::{
    level::{Samples, Values},
    report::{Warning, WarningKind},
    rules::{
        BEGUN, DAMPED, ERROR, GAIN, LARGEST_EXPONENT, LARGEST_TURN, MIN_TIMES, RESOLVED, SCATTERED,
        VANISHES,
    },
};
use mc::{DampingResolution, View, add_rows};

/// Number of parts of the time: up to T/64, T/8 and T.
pub const PARTS: usize = 3;
/// The part of the time that this one of `last` coarse times is in, counted from the end.
pub fn part(time: u64, last: u64) -> usize {
    ((last / time).ilog2() as usize / 3).min(PARTS - 1)
}

/// Sums over paths and coarse times, for each component, or each φ, and each place in a block.
#[derive(Clone, Default, serde::Serialize, serde::Deserialize)]
pub struct Motion {
    /// Sums of (fine − coarse)².
    difference: Vec<Row>,
    /// Sums of (fine − start)².
    displacement: Vec<Row>,
    /// Initial values y(0), or φ(y(0)).
    start: Vec<f64>,
    /// Number of summands.
    points: f64,
}

impl Motion {
    pub fn new(start: &[f64]) -> Self {
        let zero = vec![[0.0; WIDTH]; start.len()];
        Self { difference: zero.clone(), displacement: zero, start: start.to_vec(), points: 0.0 }
    }

    /// Adds the states of fine and coarse paths, and of a second fine path and a second coarse one
    /// if there are. Averages take the place of both: without areas the average of fine and swapped
    /// paths is near the coarse path by order one where the fine one is by one half.
    pub fn add(&mut self, view: &View<'_>) {
        if view.runs() < 2 {
            return;
        }
        let second = |run: usize| if run + 2 < view.runs() { run + 2 } else { run };
        let states = [0, second(0), 1, second(1)].map(|run| view.state(run));
        self.add_rows(view.live, (0..).map(|i| states.map(|state| &state[i])));
    }

    /// Adds components or functions on two fine and two coarse paths.
    pub fn add_rows<'r>(&mut self, live: PathMask, rows: impl Iterator<Item = [&'r Row; 4]>) {
        self.points += f64::from(live.len());
        for (i, (&start, rows)) in self.start.iter().zip(rows).enumerate() {
            add_motion(&mut self.difference[i], &mut self.displacement[i], start, rows, live);
        }
    }

    pub fn merge(&mut self, later: &Self) {
        if self.start.is_empty() {
            *self = later.clone();
            return;
        }
        self.points += later.points;
        add_rows(&mut self.difference, &later.difference);
        add_rows(&mut self.displacement, &later.displacement);
    }

    fn sums(&self, i: usize) -> [f64; 2] {
        [&self.difference[i], &self.displacement[i]].map(|lanes| lanes.iter().sum())
    }

    /// Size of component i: Σ start² + (fine − start)².
    fn size(&self, i: usize) -> f64 {
        self.points * (self.start[i] * self.start[i]) + self.sums(i)[1]
    }

    fn largest(&self) -> f64 {
        (0..self.start.len()).map(|i| self.size(i)).fold(0.0, f64::max)
    }

    /// Root mean square of the motion of component i over the size of the largest component.
    fn displacement(&self, i: usize) -> f64 {
        (self.sums(i)[1] / self.largest()).sqrt()
    }

    /// Root mean square of fine minus coarse over that of the motion of component i; zero if it is
    /// round-off of this component, or if its whole motion is round-off of the largest one, as that
    /// of a component that the equations keep at zero.
    pub fn difference(&self, i: usize) -> f64 {
        self.quotient(i, ROUND_OFF * ROUND_OFF * self.largest())
    }

    /// Root mean square of fine minus coarse over that of the motion of φ number k; zero, too, if
    /// both are below the accuracy.
    fn of_function(&self, k: usize, accuracy: f64) -> f64 {
        self.quotient(k, accuracy * accuracy * self.points)
    }

    /// Root of the quotient of both sums of squares; zero if both are `negligible`.
    fn quotient(&self, i: usize, negligible: f64) -> f64 {
        let round_off = ROUND_OFF * ROUND_OFF * self.size(i);
        let [difference, displacement] = self.sums(i);
        if difference <= round_off || difference.max(displacement) <= negligible.max(round_off) {
            0.0
        } else {
            (difference / displacement).sqrt()
        }
    }
}

real::kernel! {
    /// Adds the squares of one component or function.
    fn add_motion(
        difference: &'a mut Row,
        displacement: &'a mut Row,
        start: f64,
        rows: [&'a Row; 4],
        live: PathMask
    ) {
        let [fine, swapped, coarse, other] = rows;
        // The usual case is vectorised.
        let all = live == PathMask::ALL;
        for p in 0..WIDTH {
            if all || live.contains(p) {
                let d = 0.5 * (fine[p] + swapped[p]) - 0.5 * (coarse[p] + other[p]);
                let m = fine[p] - start;
                difference[p] += d * d;
                displacement[p] += m * m;
            }
        }
    }
}

/// Number of coarse times at which φ is compared.
const TIMES: u64 = 8;
/// Number of blocks of which one is compared before the last time: φ may cost more than a step.
const BLOCKS: u64 = 8;

/// Whether φ is compared at this one of `steps` coarse times on the block of this first path. At
/// the last one it is on all.
pub fn compares_at(time: u64, steps: u64, first_path: u64) -> bool {
    let chosen = (first_path / WIDTH as u64).is_multiple_of(BLOCKS);
    time == steps || chosen && time.is_multiple_of((steps / TIMES).max(1))
}

/// The quotients of component i on three levels. Zero if the component moves by errors of the
/// scheme alone, as one does that the equations conserve.
fn quotients(levels: [&Samples; 3], part: usize, i: usize) -> [f64; 3] {
    let motions = levels.map(|samples| &samples.motion[part]);
    let vanishes = vanishes(motions.map(|motion| motion.displacement(i)));
    if vanishes { [0.0; 3] } else { motions.map(|motion| motion.difference(i)) }
}

/// Whether the steps resolve component i in a first part of the time, in which it moves as later.
fn begins_resolved(levels: [&Samples; 3], i: usize) -> bool {
    let size = |part: usize| {
        let motion = &levels[2].motion[part];
        motion.sums(i)[1] / motion.points
    };
    (1..PARTS).any(|part| {
        levels[0].motion[part].points >= MIN_TIMES * levels[0].paths as f64
            && size(part) >= BEGUN * BEGUN * size(0)
            && resolved(quotients(levels, part, i))
    })
}

/// Whether motions on three levels fall to zero.
fn vanishes([a, b, c]: [f64; 3]) -> bool {
    c <= ERROR && c <= VANISHES * b && b <= VANISHES * a
}

/// Warnings of what the steps of the last difference do not resolve: the worst component of the
/// motion, the damping, Hamiltonians near the time `drive`, and every test function of these names.
/// Nothing is known of fewer than three levels.
pub fn unresolved(
    differences: &[Samples],
    (damping, drive, turn): (&DampingResolution<'_>, Option<f64>, f64),
    names: &[&str],
    (accuracy, single): (f64, bool),
) -> Vec<Warning> {
    let [.., a, b, last] = differences else { return Vec::new() };
    let (levels, level) = ([a, b, last], last.level);
    let warning = |kind, what: &str, how: String| {
        let message = Message::new(format!("the steps do not resolve {what}"))
            .with_reason(format!("on level {level} {how}"))
            .with_remedy("take more steps of the coarsest level");
        Warning::of_all(kind, message)
    };
    let differ = |by: f64| format!("fine and coarse paths differ by {by:.1e} of its motion");
    let components = (0..last.motion[0].start.len()).map(|i| (i + 1, quotients(levels, 0, i)));
    let parted = |i: usize, [a, _, c]: [f64; 3]| c > GAIN * a && begins_resolved(levels, i - 1);
    let component = components
        .filter(|&(i, of_all)| !resolved(of_all) && !parted(i, of_all))
        .max_by(|one, other| one.1[2].total_cmp(&other.1[2]));
    let component = component
        .map(|(i, [.., by])| warning(WarningKind::Component(i), &format!("y{i}"), differ(by)));
    let exponent = damping.lasting_exponent(level);
    let is_strong = exponent > LARGEST_EXPONENT;
    let strong = format!("it is e^-{exponent:.1} in one step");
    let strong = is_strong.then(|| warning(WarningKind::StrongDamping, "the damping", strong));
    let largest = last
        .values
        .iter()
        .map(|of| of.fine.mean().abs() + of.fine.variance().sqrt())
        .fold(0.0, f64::max);
    let damping = || {
        let by = damping.unresolved(level).filter(|by| by * largest > DAMPED * accuracy)?;
        let how = format!("its sums over the steps differ from the integral by {by:.1e}");
        Some(warning(WarningKind::Damping, "the damping", how))
    };
    let drive = drive.map(|t| {
        let how = format!("it changes within a step near t = {t:.4} more than from step to step");
        warning(WarningKind::Drive, "a function of t", how)
    });
    let turn = (turn > LARGEST_TURN).then(|| {
        let how = format!("a step has {turn:.1e} radians or e-foldings of it");
        warning(WarningKind::FastMotion, "the fastest motion", how)
    });
    let mut warnings: Vec<_> =
        component.into_iter().chain(strong.or_else(damping)).chain(drive).chain(turn).collect();
    // Of single paths only the means must agree: the bound on the bias is for them.
    let scattered = |k: usize| levels.iter().all(|samples| is_scattered(&samples.values[k]));
    for (k, name) in names.iter().enumerate() {
        if single && scattered(k) {
            continue;
        }
        if let Some(by) = unresolved_function(levels, k, accuracy) {
            warning(WarningKind::Function, "it", differ(by)).add_to(&mut warnings, name);
        }
    }
    warnings
}

/// Difference of fine and coarse paths of the last level in test function number k, if its motion
/// is not resolved, since a φ that multiplies phases needs finer steps than the state; or if it is
/// not the same event on both.
fn unresolved_function(levels: [&Samples; 3], k: usize, accuracy: f64) -> Option<f64> {
    let quotients = levels.map(|level| level.functions.of_function(k, accuracy));
    // An event is the same on fine and coarse paths if this is below √½: see `coupled`.
    let scaled = quotients.map(|quotient| std::f64::consts::FRAC_1_SQRT_2 * quotient);
    let values = &levels[2].values[k];
    let uncoupled = (!coupled(values, accuracy)).then(|| (2.0 * share(values)).sqrt());
    if near(scaled) { uncoupled } else { Some(quotients[2]) }
}

/// Whether φ(fine) − φ(coarse) has a small mean beside its deviation, so that it is not one phase
/// error of all paths.
fn is_scattered(values: &Values) -> bool {
    values.sample.mean().powi(2) <= SCATTERED * values.sample.variance()
}

/// Whether quotients of three levels are as small as by strong order ½ at least: one alone may be
/// small by chance.
fn near([a, b, c]: [f64; 3]) -> bool {
    c.max(GAIN * b).max(GAIN * GAIN * a) <= RESOLVED
}

/// Whether quotients of three levels are near, and fall: far from resolution they may be small and
/// grow.
fn resolved(quotients: [f64; 3]) -> bool {
    let [a, b, c] = quotients;
    c == 0.0 || near(quotients) && c <= GAIN * a.max(b)
}

/// The variance of φ(fine) − φ(coarse) over the sum of both variances; NaN if φ does not vary.
pub fn share(values: &Values) -> f64 {
    values.sample.variance() / (values.fine.variance() + values.coarse.variance())
}

/// Whether φ is the same event on the fine and on the coarse paths: the share is small, or φ
/// spreads by no more than the accuracy.
pub fn coupled(values: &Values, accuracy: f64) -> bool {
    !(share(values) > RESOLVED * RESOLVED && values.varies() && values.spread() > accuracy)
}

#[cfg(test)]
mod tests {
    use real::Block;

    use super::*;
    use crate::tests::show;

    /// The angle of the midpoint rule after n steps of ωτ.
    fn midpoint(angle: f64, n: u32) -> f64 {
        2.0 * f64::from(n) * (0.5 * angle / f64::from(n)).atan()
    }

    /// The quotient for q = cos over the coarse times of 2n fine steps.
    fn quotient(angle: f64, n: u32) -> f64 {
        let mut motion = Motion::new(&[1.0]);
        let step = |n: u32| midpoint(angle, n) / f64::from(n);
        for k in 1..=n {
            let fine = Block([[(f64::from(2 * k) * step(2 * n)).cos(); WIDTH]]);
            let coarse = Block([[(f64::from(k) * step(n)).cos(); WIDTH]]);
            show(&[fine, coarse], 1, PathMask::ALL, &mut |view| motion.add(view));
        }
        motion.difference(0)
    }

    #[test]
    fn a_rotation_is_resolved_when_its_phase_is() {
        // Each ω on [0, 1] with 8 coarsest steps; its phase is wrong by ω³τ²/12.
        for angle in [3.0, 26.7, 55.6, 101.3, 1e4, 1e7] {
            let r: Vec<f64> = (0..16).map(|l| quotient(angle, 8 << l)).collect();
            for last in 2..16 {
                let n = f64::from(8 << (last + 1));
                let phase = (angle - midpoint(angle, 16 << last)).abs();
                let good = resolved([r[last - 2], r[last - 1], r[last]]);
                assert!(!good || phase < 1.0, "{angle} {n}: {phase} {:?}", &r[..=last]);
                assert!(good || phase > 0.02, "{angle} {n}: {phase} {:?}", &r[..=last]);
            }
        }
    }

    #[test]
    fn a_component_that_stays_at_zero_is_round_off() {
        // The first component moves by one, the second by rounding errors that do not agree.
        let mut motion = Motion::new(&[1.0, 0.0]);
        for k in 1..=8 {
            let at = |sign: f64| Block([[1.0 + f64::from(k) / 8.0; WIDTH], [sign * 1e-17; WIDTH]]);
            show(&[at(1.0), at(-1.0)], 1, PathMask::ALL, &mut |view| motion.add(view));
        }
        assert_eq!([motion.difference(0), motion.difference(1)], [0.0, 0.0]);
    }

    #[test]
    fn errors_of_a_scheme_vanish_and_motions_do_not() {
        // Errors of orders ½, 1 and 2 of a component that is kept.
        for order in [0.5f64, 1.0, 2.0] {
            assert!(vanishes([0.0, 1.0, 2.0].map(|level: f64| 0.1 * (-order * level).exp2())));
        }
        for motion in [[0.0; 3], [0.05, 0.05, 0.05], [0.2, 0.1, 0.09], [1.0, 0.5, 0.25]] {
            assert!(!vanishes(motion) || motion[2] == 0.0);
        }
        // Random phases of a rotation, a tenth in size: motions of the same size.
        let motions = [8, 16, 32].map(|n| {
            let mut motion = Motion::new(&[1.0]);
            for k in 1..=n {
                let at = |steps: u32| {
                    let angle = f64::from(k) * midpoint(1e4, steps) / f64::from(steps);
                    Block([[0.9 + 0.1 * angle.cos(); WIDTH]])
                };
                show(&[at(2 * n), at(n)], 1, PathMask::ALL, &mut |view| motion.add(view));
            }
            motion.displacement(0)
        });
        assert!(!vanishes(motions), "{motions:?}");
    }
}
