//! One sweep of the fast methods on one path, for single paths and blocks alike.

use real::Factored;

use crate::{
    FirstSweep, FixedPoint, Method,
    criteria::{GUARD, TOLERANCE, excess},
};

/// After a Newton step the residual is of the order of the squared change. So √ε suffices; the
/// margin for the constant is 2⁶.
const NEWTON_TOLERANCE: f64 = 1.0 / (1u64 << 32) as f64;

/// Margin for the contraction estimate in a long Newton sweep. Its two steps may contract more than
/// the next one, which has another direction. With this margin residuals on random maps are at most
/// 4ε (`tests/iteration/contraction.rs`).
const NEWTON_MARGIN: f64 = 256.0;

/// The next iterate and its excess over the tolerance: at most zero if it has converged, NaN if a
/// number is not finite.
pub type Iterate<const D: usize> = ([f64; D], f64);

// The method is a constant of the type, NEWTON, and conditions on it are constants: what another
// method needs is not compiled.

/// Whether the equation prefers Newton's method.
pub const fn prefers_newton<E: FixedPoint<D>, const D: usize>() -> bool {
    matches!(E::METHOD, Method::Newton)
}

/// Whether the iteration begins with a sweep of its own. It does so only with the method that the
/// equation prefers.
pub const fn has_first_sweep<E: FixedPoint<D>, const D: usize, const NEWTON: bool>() -> bool {
    !matches!(E::FIRST_SWEEP, FirstSweep::Plain) && NEWTON == prefers_newton::<E, D>()
}

/// The first sweep of two paths, by the method that the equation prefers. Long sweeps alternate
/// between the paths: an evaluation is a chain of dependent operations, and a processor executes
/// two such chains in the time of one.
#[inline(always)]
pub fn first_sweeps<E: FixedPoint<D>, const D: usize>(
    one: &E,
    other: &E,
) -> (Iterate<D>, Iterate<D>) {
    if const { !matches!(E::FIRST_SWEEP, FirstSweep::Long) } {
        return (
            test_prediction(one.start(), one.predict()),
            test_prediction(other.start(), other.predict()),
        );
    }
    if const { prefers_newton::<E, D>() } {
        let (first, second) = newton_twice(one, other);
        (test_newton(one.start(), first), test_newton(other.start(), second))
    } else {
        let (one, other) = eleven_evaluations(one, other);
        (test_fixed_point(one), test_fixed_point(other))
    }
}

/// A prediction, accepted if its residual bound is below the tolerance. Without a finite bound the
/// iterate is the start.
#[inline(always)]
fn test_prediction<const D: usize>(
    start: [f64; D],
    (prediction, bound): ([f64; D], f64),
) -> Iterate<D> {
    let z = select(bound < f64::INFINITY, prediction, start);
    let mut size = 0.0;
    for i in 0..D {
        size += prediction[i].abs();
    }
    // The last product is NaN if a number is infinite, and zero otherwise.
    (z, (bound - size * TOLERANCE) + size * 0.0)
}

/// One sweep from z.
#[inline(always)]
pub fn sweep<E: FixedPoint<D>, const D: usize, const NEWTON: bool>(
    equation: &E,
    z: [f64; D],
) -> Iterate<D> {
    if NEWTON {
        return newton_sweep(equation, z);
    }
    let first = equation.map(z);
    let second = equation.map(first);
    test_fixed_point([first, second, equation.map(second)])
}

/// One more sweep from a solution. Its result is discarded if it is not finite: Newton's method may
/// diverge where I − ψ′ is singular.
#[inline(always)]
pub fn settled_path<E: FixedPoint<D>, const D: usize, const NEWTON: bool>(
    equation: &E,
    z: [f64; D],
) -> [f64; D] {
    let (after, excess) = sweep::<E, D, NEWTON>(equation, z);
    select(excess.is_finite(), after, z)
}

/// One or the other vector, without a branch.
#[inline(always)]
fn select<const D: usize>(first: bool, one: [f64; D], mut other: [f64; D]) -> [f64; D] {
    for i in 0..D {
        other[i] = if first { one[i] } else { other[i] };
    }
    other
}

/// The last three iterates.
type Tail<const D: usize> = [[f64; D]; 3];

/// Two equations and an iterate of each.
type Pair<'a, E, const D: usize> = ((&'a E, [f64; D]), (&'a E, [f64; D]));

// Evaluations are written out by functions of three. A loop with a long body would not be unrolled,
// and then the loop over paths is not vectorised.

/// One evaluation of each equation.
#[inline(always)]
fn one_evaluation<'a, E: FixedPoint<D>, const D: usize>(
    ((one, y), (other, z)): Pair<'a, E, D>,
) -> Pair<'a, E, D> {
    ((one, one.map(y)), (other, other.map(z)))
}

#[inline(always)]
fn three_evaluations<E: FixedPoint<D>, const D: usize>(pair: Pair<'_, E, D>) -> Pair<'_, E, D> {
    one_evaluation(one_evaluation(one_evaluation(pair)))
}

/// Eleven evaluations of each equation from its start.
#[inline(always)]
fn eleven_evaluations<E: FixedPoint<D>, const D: usize>(one: &E, other: &E) -> (Tail<D>, Tail<D>) {
    let start = ((one, one.start()), (other, other.start()));
    let pair = three_evaluations(three_evaluations(three_evaluations(start)));
    let before = one_evaluation(pair);
    let next = one_evaluation(before);
    ([pair.0.1, before.0.1, next.0.1], [pair.1.1, before.1.1, next.1.1])
}

/// ‖last change‖₁, ‖change before‖₁ and ‖last iterate‖₁. Sums propagate a NaN, a maximum would not.
#[inline(always)]
fn changes<const D: usize>([previous, before, next]: Tail<D>) -> (f64, f64, f64) {
    let (mut change, mut change_before, mut size) = (0.0, 0.0, 0.0);
    for i in 0..D {
        change += (next[i] - before[i]).abs();
        change_before += (before[i] - previous[i]).abs();
        size += next[i].abs();
    }
    (change, change_before, size)
}

/// The convergence test of fixed-point iteration.
#[inline(always)]
fn test_fixed_point<const D: usize>(tail: Tail<D>) -> Iterate<D> {
    let (change, change_before, size) = changes(tail);
    (tail[2], excess(change, change_before, size))
}

/// ψ(ψ(start)), then a Newton step and a simplified one with the same matrix, for two paths.
///
/// Newton's step squares the error of the first iterate. The simplified step multiplies it by the
/// initial error once more: on short steps from 10⁻⁵ through 10⁻¹⁰ to round-off.
#[inline(always)]
fn newton_twice<E: FixedPoint<D>, const D: usize>(one: &E, other: &E) -> (Tail<D>, Tail<D>) {
    let (y, z) = (one.map(one.map(one.start())), other.map(other.map(other.start())));
    let ((matrix, before), (matrix_other, before_other)) =
        (newton_step(one, y), newton_step(other, z));
    let next =
        (simplified_step(one, matrix, before), simplified_step(other, matrix_other, before_other));
    ([y, before, next.0], [z, before_other, next.1])
}

/// The factored matrix I − ψ′(z) and z − (I − ψ′(z))⁻¹(z − ψ(z)).
#[inline(always)]
fn newton_step<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    z: [f64; D],
) -> (Factored<f64, D>, [f64; D]) {
    let (matrix, defect) = linearised(equation, z);
    let matrix = Factored::new(matrix);
    (matrix, minus(z, matrix.solve(defect)))
}

/// z − (I − ψ′)⁻¹(z − ψ(z)) with a given matrix.
#[inline(always)]
fn simplified_step<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    matrix: Factored<f64, D>,
    z: [f64; D],
) -> [f64; D] {
    minus(z, matrix.solve(minus(z, equation.map(z))))
}

/// The convergence test of a long Newton sweep: the contraction estimate of [`test_fixed_point`]
/// with a margin, or a last change below the tolerance, since both changes may be round-off.
///
/// If the test fails and the changes grew, the iterate is the start, so that a bad first iterate
/// does not choose the branch.
#[inline(always)]
fn test_newton<const D: usize>(start: [f64; D], tail: Tail<D>) -> Iterate<D> {
    let (change, change_before, size) = changes(tail);
    let contracts = change < change_before;
    let before = if change_before < size { change_before } else { size };
    let allowed = size * TOLERANCE;
    let excess = change * GUARD * change - allowed * (GUARD / NEWTON_MARGIN) * before;
    // A difference, so that an infinite change does not count as converged.
    let done = (excess <= 0.0) | (change - allowed <= 0.0);
    (select(contracts | done, tail[2], start), if done { -1.0 } else { 1.0 })
}

/// One Newton iteration.
#[inline(always)]
fn newton_sweep<E: FixedPoint<D>, const D: usize>(equation: &E, z: [f64; D]) -> Iterate<D> {
    let (_, next) = newton_step(equation, z);
    let (change, _, size) = changes([z, z, next]);
    (next, change - size * NEWTON_TOLERANCE)
}

#[inline(always)]
pub fn minus<const D: usize>(mut a: [f64; D], b: [f64; D]) -> [f64; D] {
    for i in 0..D {
        a[i] -= b[i];
    }
    a
}

/// I − ψ′(z) and z − ψ(z).
#[inline(always)]
pub fn linearised<E: FixedPoint<D>, const D: usize>(
    equation: &E,
    z: [f64; D],
) -> ([[f64; D]; D], [f64; D]) {
    let (value, mut matrix) = equation.jacobian(z);
    for i in 0..D {
        for j in 0..D {
            matrix[i][j] = -matrix[i][j];
        }
        matrix[i][i] += 1.0;
    }
    (matrix, minus(z, value))
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

    /// The size is 3, so 2ε‖z‖ = 1.33e-15.
    #[test]
    fn the_last_changes_predict_the_residual() {
        for (before, last, done) in [
            // c′²/c = 1e-15, in either component and shared by both.
            ([1e-3, 0.0], [0.0, 1e-9], true),
            ([0.0, -1e-3], [-1e-9, 0.0], true),
            ([5e-4, -5e-4], [-5e-10, 5e-10], true),
            // 4e-15.
            ([1e-3, 0.0], [0.0, 2e-9], false),
            ([-5e-4, 5e-4], [1e-9, 1e-9], false),
            // Equal changes above round-off show no contraction.
            ([1e-12, 0.0], [1e-12, 0.0], false),
            ([0.0, 0.0], [0.0, 0.0], true),
        ] {
            let iterates = tail(before, last);
            let (z, excess) = test_fixed_point(iterates);
            assert_eq!(z, iterates[2]);
            assert_eq!(excess <= 0.0, done, "{before:?} {last:?}: {excess:e}");
        }
        // An excursion to 1000 and back to within 7e-8. With c = 1000, c′²/c would be 5e-18; with c
        // limited to the size 3 it is 1.6e-15.
        let (_, excess) = test_fixed_point([[1e3, 2.0], [1.0, 2.0], [1.0, 2.0 + 7e-8]]);
        assert!(excess > 0.0);
    }

    #[test]
    fn a_long_newton_sweep_is_tested_with_a_margin() {
        let (next, again) = (true, false);
        for (before, last, done, goes_on) in [
            // 256 c′²/c = 6e-16, in either component and shared by both.
            ([1e-3, 0.0], [0.0, 5e-11], true, next),
            ([0.0, -1e-3], [-5e-11, 0.0], true, next),
            ([5e-4, -5e-4], [-2.5e-11, 2.5e-11], true, next),
            // 2.6e-15: not converged, but contracting.
            ([1e-3, 0.0], [0.0, 1e-10], false, next),
            ([-5e-4, 5e-4], [5e-11, 5e-11], false, next),
            ([0.1, 0.0], [0.05, 0.04], false, next),
            // Growing changes, in sum or in one component.
            ([0.1, 0.0], [0.05, 0.06], false, again),
            ([0.0, 0.1], [0.0, -0.3], false, again),
            ([0.05, 0.04], [-0.1, 0.0], false, again),
            // Round-off need not shrink.
            ([0.0, 0.0], [0.0, 8.9e-16], true, next),
            ([4.5e-16, 0.0], [0.0, 8.9e-16], true, next),
            ([0.0, 0.0], [0.0, 2.7e-15], false, again),
        ] {
            let iterates = tail(before, last);
            let (z, excess) = test_newton(START, iterates);
            assert_eq!(excess <= 0.0, done, "{before:?} {last:?}: {excess:e}");
            assert_eq!(z, if goes_on { iterates[2] } else { START }, "{before:?} {last:?}");
            assert!(excess.abs() == 1.0);
        }
        // An excursion as above: 256 c′²/c = 4e-15 with c = 3.
        let (z, excess) = test_newton(START, [[1e3, 2.0], [1.0, 2.0], [1.0, 2.0 + 7e-9]]);
        assert!(excess > 0.0 && z == [1.0, 2.0 + 7e-9]);
    }

    #[test]
    fn what_is_no_number_has_not_converged() {
        for wrong in [f64::NAN, f64::INFINITY] {
            // The first iterate may be anything: it counts as an excursion.
            for place in 1..3 {
                let mut iterates = tail([1e-3, 0.0], [1e-12, 0.0]);
                iterates[place][1] = wrong;
                let (_, excess) = test_fixed_point(iterates);
                assert!(excess.is_nan() || excess > 0.0, "{iterates:?}");
                let (z, excess) = test_newton(START, iterates);
                assert!(excess > 0.0 && z.iter().all(|x| x.is_finite()), "{iterates:?}");
            }
        }
    }

    #[test]
    fn a_prediction_is_accepted_within_the_tolerance() {
        let found = [1.0, -2.0];
        for (bound, done) in
            [(0.0, true), (3.0 * TOLERANCE, true), (3.1 * TOLERANCE, false), (1.0, false)]
        {
            let (z, excess) = test_prediction(START, (found, bound));
            assert_eq!((z, excess <= 0.0), (found, done), "{bound:e}");
        }
        for bound in [f64::INFINITY, f64::NAN] {
            let (z, excess) = test_prediction(START, (found, bound));
            assert!(z == START && (excess.is_nan() || excess > 0.0), "{bound} {excess}");
        }
        for found in [[f64::INFINITY, 0.0], [0.0, f64::NEG_INFINITY], [f64::NAN, 0.0]] {
            assert!(test_prediction(START, (found, 0.0)).1.is_nan());
        }
    }
}
