//! What follows from B, ∇h and their derivatives, for systems with one tile.

use real::{Kernel, Row, WIDTH, dispatch};

use super::{Op, System, Weights};

/// An operation that follows from others, for systems with one tile:
///
/// - ∇̄h(a, b) = Σ wₖ ∇h(a + ηₖ(b − a)) with the nodes and weights of the
///   [rule](super::Description::rule), pair by pair as in [`dgrad::averaged`];
/// - ∂∇̄h(a, b)/∂b·u = Σ wₖ ηₖ ∇²h(a + ηₖ(b − a))·u;
/// - B((a+b)/2)∇̄h(a, b).
///
/// # Panics
/// For other operations.
pub fn derived<S: System + ?Sized>(
    system: &S,
    op: Op<&[Row]>,
    h: Weights<'_>,
    out: &mut [Row],
    mut scratch: &mut [Row],
) {
    let (description, rows) = (system.description(), out.len());
    let (nodes, weights) = (description.rule.nodes(), description.rule.weights());
    match op {
        Op::AveragedGradient { a, b } => {
            let [point, lower, upper] = [(); 3].map(|()| take(&mut scratch, rows));
            let mut gradient = |distance: f64, out: &mut [Row]| {
                dispatch(Point { a, b, distance, point });
                system.apply(Op::Gradient { y: point }, 0..rows, h, out, scratch);
            };
            if nodes.len() == 1 {
                return gradient(0.0, out);
            }
            // −0 changes no sum.
            out.fill([-0.0; WIDTH]);
            for k in 0..nodes.len() / 2 {
                gradient(nodes[k] - 0.5, lower);
                gradient(0.5 - nodes[k], upper);
                dispatch(Add { sum: lower, value: upper, weight: 1.0 });
                dispatch(Add { sum: out, value: lower, weight: weights[k] });
            }
            if nodes.len() % 2 == 1 {
                gradient(0.0, lower);
                dispatch(Add { sum: out, value: lower, weight: weights[nodes.len() / 2] });
            }
        }
        Op::AveragedHessian { a, b, u } => {
            let [point, value] = [(); 2].map(|()| take(&mut scratch, rows));
            out.fill([0.0; WIDTH]);
            for (&node, &weight) in nodes.iter().zip(weights) {
                dispatch(Point { a, b, distance: node - 0.5, point });
                system.apply(Op::Hessian { y: point, u }, 0..rows, h, value, scratch);
                dispatch(Add { sum: out, value, weight: weight * node });
            }
        }
        Op::AveragedField { a, b } => {
            let gradient = take(&mut scratch, rows);
            system.apply(Op::AveragedGradient { a, b }, 0..rows, h, gradient, scratch);
            let point = take(&mut scratch, rows);
            dispatch(Point { a, b, distance: 0.0, point });
            system.apply(Op::Structure { y: point, v: gradient }, 0..rows, h, out, scratch);
        }
        _ => panic!("{} has no {op:?}", description.name),
    }
}

/// The first rows of the scratch, which becomes the rest.
fn take<'a>(scratch: &mut &'a mut [Row], rows: usize) -> &'a mut [Row] {
    let (first, rest) = std::mem::take(scratch).split_at_mut(rows);
    *scratch = rest;
    first
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
