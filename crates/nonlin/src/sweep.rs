//! One sweep of the fast methods on one path; shared by block and single path, so that both give
//! the same bits.
//!
//! A long first sweep of the fixed-point iteration makes eleven evaluations of ψ and each later one
//! three. The state of a path stays in registers between them and only the last change is tested.
//! Chosen by `cargo bench -p schemes`: with eleven the rigid body at τ = 2⁻⁸ is solved in the first
//! sweep on nearly every block, and a sweep more costs as much as five evaluations.

use crate::elimination::Factored;
use crate::solver::Method;
use crate::{FirstSweep, FixedPoint};

/// A path is done when ‖z − ψ(z)‖₁, as far as it can be foreseen, is below this fraction of ‖z‖₁.
/// Evaluating ψ rounds each component of z by up to half an ulp, so residuals of this size carry no
/// information.
pub(crate) const TOLERANCE: f64 = 2.0 * f64::EPSILON;

/// The test below multiplies two changes; for unknowns of size r the product is as small as (εr)².
/// This power of two keeps it above the smallest number for r down to 10⁻¹⁵⁵, where an underflow to
/// zero would pass for convergence. For r above 10¹⁴⁵ the product of the first changes may
/// overflow, which counts as not done, and rightly so.
const GUARD: f64 = (1u128 << 64) as f64;

/// After a Newton step the residual is of the order of the square of the change; √ε therefore
/// suffices, with a margin of 2⁶ for the constant.
const NEWTON_TOLERANCE: f64 = 1.0 / (1u64 << 32) as f64;

/// The contraction that the two steps of a first Newton sweep show may be smaller than that of the
/// next one, which goes in another direction; this margin for it leaves residuals of 4ε at most on
/// random maps (`tests/contraction.rs`).
const NEWTON_MARGIN: f64 = 256.0;

/// The next iterate and a number that is at most zero when it is the solution, NaN when it has left
/// the numbers.
pub(crate) type Iterate<const D: usize> = ([f64; D], f64);

/// Whether the equation asks for a first sweep unlike the others, which it does for the method that
/// it prefers alone.
#[inline(always)]
pub(crate) fn begins_otherwise<E: FixedPoint<D>, const D: usize>(method: Method) -> bool {
    E::FIRST_SWEEP != FirstSweep::Plain && method == E::METHOD
}

/// The first sweep that the equation asks for, with the method that it prefers.
#[inline(always)]
pub(crate) fn first_sweep<E: FixedPoint<D>, const D: usize>(equation: &E) -> Iterate<D> {
    match (E::FIRST_SWEEP, E::METHOD) {
        (FirstSweep::Plain, method) => sweep(equation, equation.start(), method),
        (FirstSweep::Predicted, _) => predicted_verdict(equation.start(), equation.predict()),
        (FirstSweep::Long, Method::FixedPoint) => verdict(eleven_evaluations(equation)),
        (FirstSweep::Long, Method::Newton) => {
            newton_verdict(equation.start(), newton_twice(equation))
        }
    }
}

/// The first sweep of two paths. Long sweeps alternate between the two: an evaluation is a chain of
/// operations that wait for each other, and two chains fit into the time of one.
#[inline(always)]
pub(crate) fn first_sweeps<E: FixedPoint<D>, const D: usize>(
    one: &E,
    other: &E,
) -> (Iterate<D>, Iterate<D>) {
    match (E::FIRST_SWEEP, E::METHOD) {
        (FirstSweep::Plain | FirstSweep::Predicted, _) => (first_sweep(one), first_sweep(other)),
        (FirstSweep::Long, Method::FixedPoint) => {
            let (one, other) = eleven_in_turn(one, other);
            (verdict(one), verdict(other))
        }
        (FirstSweep::Long, Method::Newton) => {
            let (first, second) = newton_twice_in_turn(one, other);
            (newton_verdict(one.start(), first), newton_verdict(other.start(), second))
        }
    }
}

/// A prediction, accepted if its bound is below the tolerance; the start where it has no bound.
#[inline(always)]
fn predicted_verdict<const D: usize>(
    start: [f64; D],
    (prediction, bound): ([f64; D], f64),
) -> Iterate<D> {
    let has_bound = bound < f64::INFINITY;
    let (mut z, mut size) = (start, 0.0);
    for i in 0..D {
        z[i] = if has_bound { prediction[i] } else { start[i] };
        size += prediction[i].abs();
    }
    // The last product is NaN where a number is infinite, and zero otherwise.
    (z, (bound - size * TOLERANCE) + size * 0.0)
}

/// A later sweep, from z.
#[inline(always)]
pub(crate) fn sweep<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    z: [f64; D],
    method: Method,
) -> Iterate<D> {
    match method {
        Method::FixedPoint => verdict(two_evaluations(equation, equation.map(z))),
        Method::Newton => newton_sweep(equation, z),
    }
}

/// One more sweep from a solution, unless it leads out of the numbers, as Newton's may where I − ψ′
/// is singular.
#[inline(always)]
pub(crate) fn settled_path<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    z: [f64; D],
    method: Method,
) -> [f64; D] {
    let (after, excess) = sweep(equation, z, method);
    let keep = excess.is_finite();
    let mut settled = z;
    for i in 0..D {
        settled[i] = if keep { after[i] } else { z[i] };
    }
    settled
}

/// The last three iterates.
type Tail<const D: usize> = [[f64; D]; 3];

/// Two evaluations from z: the last three iterates.
#[inline(always)]
fn two_evaluations<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> Tail<D> {
    let before = equation.map(z);
    [z, before, equation.map(before)]
}

// Evaluations are written out by functions of three: a loop of long bodies would not be unrolled,
// and then the loop over paths is not vectorised.

#[inline(always)]
fn three_evaluations<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> [f64; D] {
    equation.map(equation.map(equation.map(z)))
}

/// Eleven evaluations from the start.
#[inline(always)]
fn eleven_evaluations<E: FixedPoint<D>, const D: usize>(equation: &E) -> Tail<D> {
    let z = three_evaluations(
        equation,
        three_evaluations(equation, three_evaluations(equation, equation.start())),
    );
    two_evaluations(equation, z)
}

/// Two equations and an iterate of each.
type Pair<'a, E, const D: usize> = ((&'a E, [f64; D]), (&'a E, [f64; D]));

/// An evaluation of each.
#[inline(always)]
fn one_in_turn<'a, E: FixedPoint<D>, const D: usize>(
    ((one, y), (other, z)): Pair<'a, E, D>,
) -> Pair<'a, E, D> {
    ((one, one.map(y)), (other, other.map(z)))
}

#[inline(always)]
fn three_in_turn<E: FixedPoint<D>, const D: usize>(pair: Pair<'_, E, D>) -> Pair<'_, E, D> {
    one_in_turn(one_in_turn(one_in_turn(pair)))
}

/// [`eleven_evaluations`] of two paths from their starts, in turn.
#[inline(always)]
fn eleven_in_turn<E: FixedPoint<D>, const D: usize>(one: &E, other: &E) -> (Tail<D>, Tail<D>) {
    let pair =
        three_in_turn(three_in_turn(three_in_turn(((one, one.start()), (other, other.start())))));
    let before = one_in_turn(pair);
    let next = one_in_turn(before);
    ([pair.0.1, before.0.1, next.0.1], [pair.1.1, before.1.1, next.1.1])
}

/// The last two changes c, c′ give the contraction c′/c and with it the next change, which is the
/// residual: done when c′²/c ≤ tolerance, with c counted as at most ‖z‖.
#[inline(always)]
fn verdict<const D: usize>([previous, before, next]: Tail<D>) -> Iterate<D> {
    // Sums and not maxima: a NaN anywhere makes the sum NaN, and NaN is not at most zero.
    let (mut change, mut change_before, mut size) = (0.0, 0.0, 0.0);
    for i in 0..D {
        change += (next[i] - before[i]).abs();
        change_before += (before[i] - previous[i]).abs();
        size += next[i].abs();
    }
    // A first change c larger than z itself is an excursion and says nothing about contraction.
    let before = if change_before < size { change_before } else { size };
    let allowed = size * (GUARD * TOLERANCE);
    (next, change * GUARD * change - allowed * before)
}

/// The prediction ψ(ψ(start)), a Newton step and a simplified one, which keeps its matrix.
///
/// Newton's step squares the error of the prediction, and the simplified one multiplies it once
/// more: on short steps from 10⁻⁵ through 10⁻¹⁰ to round-off.
#[inline(always)]
fn newton_twice<E: FixedPoint<D>, const D: usize>(equation: &E) -> Tail<D> {
    let z = prediction(equation);
    let (matrix, next) = newton_step(z, equation.jacobian(z));
    [z, next, simplified_step(equation, matrix, next)]
}

#[inline(always)]
fn prediction<E: FixedPoint<D>, const D: usize>(equation: &E) -> [f64; D] {
    equation.map(equation.map(equation.start()))
}

/// [`newton_twice`] of two paths, in turn.
#[inline(always)]
fn newton_twice_in_turn<E: FixedPoint<D>, const D: usize>(
    one: &E,
    other: &E,
) -> (Tail<D>, Tail<D>) {
    let (y, z) = (prediction(one), prediction(other));
    let ((matrix, before), (matrix_other, before_other)) =
        (newton_step(y, one.jacobian(y)), newton_step(z, other.jacobian(z)));
    let next =
        (simplified_step(one, matrix, before), simplified_step(other, matrix_other, before_other));
    ([y, before, next.0], [z, before_other, next.1])
}

/// (I − ψ′(z)), factored, and z − (I − ψ′(z))⁻¹(z − ψ(z)), from ψ(z) and ψ′(z).
#[inline(always)]
fn newton_step<const D: usize>(
    z: [f64; D],
    (value, jacobian): ([f64; D], [[f64; D]; D]),
) -> (Factored<D>, [f64; D]) {
    let matrix = Factored::new(identity_minus(jacobian));
    (matrix, minus(z, matrix.solve(minus(z, value))))
}

/// z − (I − ψ′)⁻¹(z − ψ(z)) with a given matrix.
#[inline(always)]
fn simplified_step<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    matrix: Factored<D>,
    z: [f64; D],
) -> [f64; D] {
    minus(z, matrix.solve(minus(z, equation.map(z))))
}

/// The verdict on a first Newton sweep, from its two changes as in [`verdict`] with a margin; and
/// the start again if it is unfavourable and the changes grew: a prediction that led astray shall
/// not choose the branch.
///
/// A last change that is itself below the tolerance suffices, since both may be round-off.
#[inline(always)]
fn newton_verdict<const D: usize>(
    start: [f64; D],
    [previous, before, next]: Tail<D>,
) -> Iterate<D> {
    let (mut change, mut change_before, mut size) = (0.0, 0.0, 0.0);
    for i in 0..D {
        change += (next[i] - before[i]).abs();
        change_before += (before[i] - previous[i]).abs();
        size += next[i].abs();
    }
    let contracts = change < change_before;
    let before = if change_before < size { change_before } else { size };
    let allowed = size * TOLERANCE;
    let excess = change * GUARD * change - allowed * (GUARD / NEWTON_MARGIN) * before;
    // Differences, since an infinity shall not pass for convergence.
    let done = (excess <= 0.0) | (change - allowed <= 0.0);
    let mut z = next;
    for i in 0..D {
        z[i] = if contracts | done { next[i] } else { start[i] };
    }
    (z, if done { -1.0 } else { 1.0 })
}

/// One Newton iteration.
#[inline(always)]
fn newton_sweep<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> Iterate<D> {
    let (_, next) = newton_step(z, equation.jacobian(z));
    let (mut change, mut size) = (0.0, 0.0);
    for i in 0..D {
        change += (next[i] - z[i]).abs();
        size += next[i].abs();
    }
    (next, change - size * NEWTON_TOLERANCE)
}

#[inline(always)]
fn minus<const D: usize>(mut a: [f64; D], b: [f64; D]) -> [f64; D] {
    for i in 0..D {
        a[i] -= b[i];
    }
    a
}

/// I − ψ′(z) and z − ψ(z).
#[inline(always)]
pub(crate) fn linearised<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    z: [f64; D],
) -> ([[f64; D]; D], [f64; D]) {
    let (value, jacobian) = equation.jacobian(z);
    (identity_minus(jacobian), minus(z, value))
}

#[inline(always)]
fn identity_minus<const D: usize>(mut matrix: [[f64; D]; D]) -> [[f64; D]; D] {
    for i in 0..D {
        for j in 0..D {
            matrix[i][j] = -matrix[i][j];
        }
        matrix[i][i] += 1.0;
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: [f64; 2] = [7.0, -7.0];

    /// Three iterates near (1, 2), whose last two changes have these components.
    fn tail(before: [f64; 2], last: [f64; 2]) -> Tail<2> {
        let previous = [1.0, 2.0];
        let middle = [previous[0] + before[0], previous[1] + before[1]];
        [previous, middle, [middle[0] + last[0], middle[1] + last[1]]]
    }

    /// The size is 3, so that 2ε‖z‖ = 1.33e-15.
    #[test]
    fn the_last_changes_foresee_the_residual() {
        for (before, last, done) in [
            // c′²/c = 1e-15, in either component and shared by both.
            ([1e-3, 0.0], [0.0, 1e-9], true),
            ([0.0, -1e-3], [-1e-9, 0.0], true),
            ([5e-4, -5e-4], [-5e-10, 5e-10], true),
            // 4e-15.
            ([1e-3, 0.0], [0.0, 2e-9], false),
            ([-5e-4, 5e-4], [1e-9, 1e-9], false),
            // Equal changes are no contraction, whatever their size above round-off.
            ([1e-12, 0.0], [1e-12, 0.0], false),
            ([0.0, 0.0], [0.0, 0.0], true),
        ] {
            let iterates = tail(before, last);
            let (z, excess) = verdict(iterates);
            assert_eq!(z, iterates[2]);
            assert_eq!(excess <= 0.0, done, "{before:?} {last:?}: {excess:e}");
        }
        // An excursion: from (1, 2) far away and back to within 7e-8, c′²/c would be 5e-18 beside
        // 1000, and is 1.6e-15 beside 3.
        let (_, excess) = verdict([[1e3, 2.0], [1.0, 2.0], [1.0, 2.0 + 7e-8]]);
        assert!(excess > 0.0);
        for wrong in [f64::NAN, f64::INFINITY] {
            // An iterate before the last two counts as an excursion, whatever it was.
            for place in 1..3 {
                let mut iterates = tail([1e-3, 0.0], [1e-9, 0.0]);
                iterates[place][1] = wrong;
                assert!(verdict(iterates).1.is_nan() || verdict(iterates).1 > 0.0);
            }
        }
    }

    #[test]
    fn a_first_newton_sweep_is_judged_with_a_margin() {
        let (next, again) = (true, false);
        for (before, last, done, goes_on) in [
            // 256 c′²/c = 6e-16, in either component and shared by both.
            ([1e-3, 0.0], [0.0, 5e-11], true, next),
            ([0.0, -1e-3], [-5e-11, 0.0], true, next),
            ([5e-4, -5e-4], [-2.5e-11, 2.5e-11], true, next),
            // 2.6e-15: not done, but on the way.
            ([1e-3, 0.0], [0.0, 1e-10], false, next),
            ([-5e-4, 5e-4], [5e-11, 5e-11], false, next),
            ([0.1, 0.0], [0.05, 0.04], false, next),
            // Grew, in sum or in one component.
            ([0.1, 0.0], [0.05, 0.06], false, again),
            ([0.0, 0.1], [0.0, -0.3], false, again),
            ([0.05, 0.04], [-0.1, 0.0], false, again),
            // Round-off need not shrink.
            ([0.0, 0.0], [0.0, 8.9e-16], true, next),
            ([4.5e-16, 0.0], [0.0, 8.9e-16], true, next),
            ([0.0, 0.0], [0.0, 2.7e-15], false, again),
        ] {
            let iterates = tail(before, last);
            let (z, excess) = newton_verdict(START, iterates);
            assert_eq!(excess <= 0.0, done, "{before:?} {last:?}: {excess:e}");
            assert_eq!(z, if goes_on { iterates[2] } else { START }, "{before:?} {last:?}");
            assert!(excess.abs() == 1.0);
        }
        // An excursion as above: 256 c′² = 4e-15 beside 3 and not beside 1000.
        let (z, excess) = newton_verdict(START, [[1e3, 2.0], [1.0, 2.0], [1.0, 2.0 + 7e-9]]);
        assert!(excess > 0.0 && z == [1.0, 2.0 + 7e-9]);
        for wrong in [f64::NAN, f64::INFINITY] {
            for place in 1..3 {
                let mut iterates = tail([1e-3, 0.0], [1e-12, 0.0]);
                iterates[place][1] = wrong;
                let (z, excess) = newton_verdict(START, iterates);
                assert!(excess > 0.0, "{iterates:?}");
                assert!(z.iter().all(|x| x.is_finite()), "{iterates:?}");
            }
        }
    }

    #[test]
    fn a_prediction_is_accepted_within_the_tolerance() {
        let found = [1.0, -2.0];
        for (bound, done) in
            [(0.0, true), (3.0 * TOLERANCE, true), (3.1 * TOLERANCE, false), (1.0, false)]
        {
            let (z, excess) = predicted_verdict(START, (found, bound));
            assert_eq!((z, excess <= 0.0), (found, done), "{bound:e}");
        }
        for bound in [f64::INFINITY, f64::NAN] {
            let (z, excess) = predicted_verdict(START, (found, bound));
            assert!(z == START && (excess.is_nan() || excess > 0.0), "{bound} {excess}");
        }
        for found in [[f64::INFINITY, 0.0], [0.0, f64::NEG_INFINITY], [f64::NAN, 0.0]] {
            assert!(predicted_verdict(START, (found, 0.0)).1.is_nan());
        }
    }
}
