//! What follows from B, ∇h and their derivatives, for systems with one tile.

use real::{Kernel, Row, WIDTH, dispatch};

use super::{Op, System, Weights};

/// An operation that follows from others, for systems with one tile:
///
/// - ∇̄h(a, b) = Σ wₖ ∇h(a + ηₖ(b − a)) with the nodes and weights of the
///   [rule](super::Description::rule), pair by pair as in [`dgrad::averaged`];
/// - ∂∇̄h(a, b)/∂b·u = Σ wₖ ηₖ ∇²h(a + ηₖ(b − a))·u;
/// - B((a+b)/2)∇̄h(a, b);
/// - ½Σₘ fₘ′fₘ with fₘ = B∇Hₘ and fₘ′u = (∂B·u)∇Hₘ + B∇²Hₘu.
///
/// # Panics
/// For other operations.
pub fn derived<S: System + ?Sized>(
    system: &S,
    op: Op<&[Row]>,
    h: Weights<'_>,
    out: &mut [Row],
    scratch: &mut [Row],
) {
    match op {
        Op::AveragedGradient { a, b } => averaged_gradient(system, a, b, h, out, scratch),
        Op::AveragedHessian { a, b, u } => averaged_hessian(system, [a, b, u], h, out, scratch),
        Op::AveragedField { a, b } => averaged_field(system, a, b, h, out, scratch),
        Op::ItoCorrection { y } => ito_correction(system, y, out, scratch),
        _ => panic!("{} has no {op:?}", system.description().name),
    }
}

fn averaged_gradient<S: System + ?Sized>(
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
    let rule = &system.description().rule;
    let (nodes, weights) = (rule.nodes(), rule.weights());
    for k in 0..nodes.len() / 2 {
        let distance = 0.5 - nodes[k];
        dispatch(Point { a, b, distance: -distance, point });
        system.apply(Op::Gradient { y: point }, all.clone(), h, lower, scratch);
        dispatch(Point { a, b, distance, point });
        system.apply(Op::Gradient { y: point }, all.clone(), h, upper, scratch);
        dispatch(AddPair { sum: out, lower, upper, weight: weights[k], first: k == 0 });
    }
    if nodes.len() % 2 == 1 {
        dispatch(Point { a, b, distance: 0.0, point });
        if nodes.len() == 1 {
            return system.apply(Op::Gradient { y: point }, all, h, out, scratch);
        }
        system.apply(Op::Gradient { y: point }, all, h, lower, scratch);
        dispatch(Add { sum: out, value: lower, weight: weights[nodes.len() / 2] });
    }
}

fn averaged_hessian<S: System + ?Sized>(
    system: &S,
    [a, b, u]: [&[Row]; 3],
    h: Weights<'_>,
    out: &mut [Row],
    scratch: &mut [Row],
) {
    let (point, scratch) = scratch.split_at_mut(a.len());
    let (value, scratch) = scratch.split_at_mut(a.len());
    out.fill([0.0; WIDTH]);
    let rule = &system.description().rule;
    for (&node, &weight) in rule.nodes().iter().zip(rule.weights()) {
        dispatch(Point { a, b, distance: node - 0.5, point });
        system.apply(Op::Hessian { y: point, u }, 0..a.len(), h, value, scratch);
        dispatch(Add { sum: out, value, weight: weight * node });
    }
}

fn averaged_field<S: System + ?Sized>(
    system: &S,
    a: &[Row],
    b: &[Row],
    h: Weights<'_>,
    out: &mut [Row],
    scratch: &mut [Row],
) {
    let all = 0..a.len();
    let (gradient, scratch) = scratch.split_at_mut(a.len());
    system.apply(Op::AveragedGradient { a, b }, all.clone(), h, gradient, scratch);
    let (middle, scratch) = scratch.split_at_mut(a.len());
    dispatch(Point { a, b, distance: 0.0, point: middle });
    system.apply(Op::Structure { y: middle, v: gradient }, all, h, out, scratch);
}

fn ito_correction<S: System + ?Sized>(system: &S, y: &[Row], out: &mut [Row], scratch: &mut [Row]) {
    let description = system.description();
    let (dw, scratch) = scratch.split_at_mut(description.layout.noise_rows);
    let (gradient, scratch) = scratch.split_at_mut(y.len());
    let (field, scratch) = scratch.split_at_mut(y.len());
    let (value, scratch) = scratch.split_at_mut(y.len());
    let (curved, scratch) = scratch.split_at_mut(y.len());
    out.fill([0.0; WIDTH]);
    dw.fill([0.0; WIDTH]);
    for m in 0..description.noises {
        dw[m] = [1.0; WIDTH];
        let h = Weights { dt: 0.0, dw, areas: &[] };
        let mut apply =
            |op: Op<&[Row]>, out: &mut [Row]| system.apply(op, 0..y.len(), h, out, scratch);
        apply(Op::Gradient { y }, gradient);
        apply(Op::Structure { y, v: gradient }, field);
        apply(Op::StructureAlong { y, u: field, v: gradient }, value);
        dispatch(Add { sum: out, value, weight: 0.5 });
        apply(Op::Hessian { y, u: field }, curved);
        apply(Op::Structure { y, v: curved }, value);
        dispatch(Add { sum: out, value, weight: 0.5 });
        dw[m] = [0.0; WIDTH];
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
