//! What follows from B, ∇h and their derivatives, for systems with one tile.

use real::{Kernel, Row, WIDTH, dispatch};

use super::{System, Weights};

/// States that a derived method keeps beside the scratch of the methods that it calls.
const STATES: usize = 4;

/// Rows of scratch for the methods below, beside what a system needs for its own.
pub fn scratch_rows(rows: usize, noise_rows: usize) -> usize {
    STATES * rows + noise_rows
}

/// ∇̄h(a, b) = Σ wₖ ∇h(a + ηₖ(b − a)) with the nodes of [`System::rule`], pair by pair as in
/// [`dgrad::averaged`].
pub fn averaged_gradient<S: System + ?Sized>(
    system: &S,
    a: &[Row],
    b: &[Row],
    h: Weights<'_>,
    out: &mut [Row],
    scratch: &mut [Row],
) {
    let all = 0..a.len();
    let (point, scratch) = scratch.split_at_mut(a.len());
    let (lower, scratch) = scratch.split_at_mut(a.len());
    let (upper, scratch) = scratch.split_at_mut(a.len());
    let (nodes, weights) = (system.rule().nodes(), system.rule().weights());
    for k in 0..nodes.len() / 2 {
        let distance = 0.5 - nodes[k];
        dispatch(Point { a, b, distance: -distance, point });
        system.gradient(all.clone(), point, h, lower, scratch);
        dispatch(Point { a, b, distance, point });
        system.gradient(all.clone(), point, h, upper, scratch);
        dispatch(AddPair { sum: out, lower, upper, weight: weights[k], first: k == 0 });
    }
    if nodes.len() % 2 == 1 {
        dispatch(Point { a, b, distance: 0.0, point });
        if nodes.len() == 1 {
            return system.gradient(all, point, h, out, scratch);
        }
        system.gradient(all, point, h, lower, scratch);
        dispatch(Add { sum: out, value: lower, weight: weights[nodes.len() / 2] });
    }
}

/// ∂∇̄h(a, b)/∂b·u = Σ wₖ ηₖ ∇²h(a + ηₖ(b − a))·u.
pub fn averaged_hessian<S: System + ?Sized>(
    system: &S,
    a: &[Row],
    b: &[Row],
    u: &[Row],
    h: Weights<'_>,
    out: &mut [Row],
    scratch: &mut [Row],
) {
    let (point, scratch) = scratch.split_at_mut(a.len());
    let (value, scratch) = scratch.split_at_mut(a.len());
    out.fill([0.0; WIDTH]);
    let rule = system.rule();
    for (&node, &weight) in rule.nodes().iter().zip(rule.weights()) {
        dispatch(Point { a, b, distance: node - 0.5, point });
        system.hessian(0..a.len(), point, u, h, value, scratch);
        dispatch(Add { sum: out, value, weight: weight * node });
    }
}

/// point = (a+b)/2 + distance·(b − a).
struct Point<'a> {
    a: &'a [Row],
    b: &'a [Row],
    distance: f64,
    point: &'a mut [Row],
}

impl Kernel for Point<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for ((y, a), b) in self.point.iter_mut().zip(self.a).zip(self.b) {
            let (mut row, b) = (*a, *b);
            for p in 0..WIDTH {
                row[p] = (row[p] + b[p]) * 0.5 + (b[p] - row[p]) * self.distance;
            }
            *y = row;
        }
    }
}

/// sum + weight·value.
struct Add<'a> {
    sum: &'a mut [Row],
    value: &'a [Row],
    weight: f64,
}

impl Kernel for Add<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for (sum, value) in self.sum.iter_mut().zip(self.value) {
            let (mut row, value) = (*sum, *value);
            for p in 0..WIDTH {
                row[p] += value[p] * self.weight;
            }
            *sum = row;
        }
    }
}

/// sum + weight·(lower + upper), where the first pair begins the sum.
struct AddPair<'a> {
    sum: &'a mut [Row],
    lower: &'a [Row],
    upper: &'a [Row],
    weight: f64,
    first: bool,
}

impl Kernel for AddPair<'_> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        for ((sum, lower), upper) in self.sum.iter_mut().zip(self.lower).zip(self.upper) {
            let (mut row, lower, upper) = (*sum, *lower, *upper);
            for p in 0..WIDTH {
                let pair = (lower[p] + upper[p]) * self.weight;
                row[p] = if self.first { pair } else { row[p] + pair };
            }
            *sum = row;
        }
    }
}

/// B((a+b)/2)·∇̄h(a, b).
pub fn averaged_field<S: System + ?Sized>(
    system: &S,
    a: &[Row],
    b: &[Row],
    h: Weights<'_>,
    out: &mut [Row],
    scratch: &mut [Row],
) {
    let (gradient, scratch) = scratch.split_at_mut(a.len());
    system.averaged_gradient(a, b, h, gradient, scratch);
    let (middle, scratch) = scratch.split_at_mut(a.len());
    dispatch(Point { a, b, distance: 0.0, point: middle });
    system.structure(0..a.len(), middle, gradient, out, scratch);
}

/// ½Σₘ fₘ′fₘ with fₘ = B∇Hₘ and fₘ′u = (∂B·u)∇Hₘ + B∇²Hₘu.
pub fn ito_correction<S: System + ?Sized>(
    system: &S,
    y: &[Row],
    out: &mut [Row],
    scratch: &mut [Row],
) {
    let all = 0..y.len();
    let (dw, scratch) = scratch.split_at_mut(system.noise_rows());
    let (gradient, scratch) = scratch.split_at_mut(y.len());
    let (field, scratch) = scratch.split_at_mut(y.len());
    let (value, scratch) = scratch.split_at_mut(y.len());
    let (curved, scratch) = scratch.split_at_mut(y.len());
    out.fill([0.0; WIDTH]);
    dw.fill([0.0; WIDTH]);
    for m in 0..system.noises() {
        dw[m] = [1.0; WIDTH];
        let h = Weights { dt: 0.0, dw };
        system.gradient(all.clone(), y, h, gradient, scratch);
        system.structure(all.clone(), y, gradient, field, scratch);
        system.structure_along(all.clone(), y, field, gradient, value, scratch);
        dispatch(Add { sum: out, value, weight: 0.5 });
        system.hessian(all.clone(), y, field, h, curved, scratch);
        system.structure(all.clone(), y, curved, value, scratch);
        dispatch(Add { sum: out, value, weight: 0.5 });
        dw[m] = [0.0; WIDTH];
    }
}
