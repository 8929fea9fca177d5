//! What follows from B, ∇h and their derivatives, for systems with one tile.

use real::{Row, WIDTH};

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
pub fn derived(
    system: &dyn System,
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
                between(a, b, distance, point);
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
                add(lower, upper, 1.0);
                add(out, lower, weights[k]);
            }
            if nodes.len() % 2 == 1 {
                gradient(0.0, lower);
                add(out, lower, weights[nodes.len() / 2]);
            }
        }
        Op::AveragedHessian { a, b, u } => {
            let [point, value] = [(); 2].map(|()| take(&mut scratch, rows));
            out.fill([0.0; WIDTH]);
            for (&node, &weight) in nodes.iter().zip(weights) {
                between(a, b, node - 0.5, point);
                system.apply(Op::Hessian { y: point, u }, 0..rows, h, value, scratch);
                add(out, value, weight * node);
            }
        }
        Op::AveragedField { a, b } => {
            let gradient = take(&mut scratch, rows);
            system.apply(Op::AveragedGradient { a, b }, 0..rows, h, gradient, scratch);
            let point = take(&mut scratch, rows);
            between(a, b, 0.0, point);
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

real::kernel! {
    /// point = (a+b)/2 + distance·(b − a).
    fn between(a: &'a [Row], b: &'a [Row], distance: f64, point: &'a mut [Row]) {
        for ((y, a), b) in point.iter_mut().zip(a).zip(b) {
            let (mut row, b) = (*a, *b);
            for p in 0..WIDTH {
                row[p] = (row[p] + b[p]) * 0.5 + (b[p] - row[p]) * distance;
            }
            *y = row;
        }
    }
}

real::kernel! {
    /// Adds weight·value to the sum.
    fn add(sum: &'a mut [Row], value: &'a [Row], weight: f64) {
        for (sum, value) in sum.iter_mut().zip(value) {
            let (mut row, value) = (*sum, *value);
            for p in 0..WIDTH {
                row[p] += value[p] * weight;
            }
            *sum = row;
        }
    }
}
