//! The derivative of a recorded formula.

use systems::run_time::{Op, Recorded};

use super::{
    SchemeError,
    record::{Operations, Recorder, Symbol},
};

/// An operation, and its derivative unless it is zero.
type Differentiated<'a> = (Symbol<'a>, Option<Symbol<'a>>);

/// The operations of ∂ψ/∂z·u for a formula ψ(ẑ, z) with the inputs ẑ, z; the inputs of the result
/// are ẑ, z, u. Operations that do not depend on z are kept, their derivatives are zero and not
/// computed.
///
/// # Errors
/// [`SchemeError`] for operations at z whose second derivatives would be needed: ½Σ
/// fₘ′fₘ, or the solution of a linear equation.
pub fn derivative(operations: &Operations) -> Result<Recorder, SchemeError> {
    let recorder = Recorder::default();
    let inputs = [0, 1, 2].map(|input| recorder.push(Recorded::Input(input), 1.0));
    let direction = inputs[2];
    let mut known: Vec<Differentiated<'_>> = Vec::new();
    for (&operation, &factor) in operations.nodes.iter().zip(&operations.factors) {
        known.push(match operation {
            Recorded::Input(input) => (inputs[input], (input == 1).then_some(direction)),
            Recorded::Sum(a, b) => sum(known[a], known[b]),
            Recorded::Difference(a, b) => {
                let ((a, of_a), (b, of_b)) = (known[a], known[b]);
                (a - b, plus(of_a, of_b.map(|b| b * -1.0)))
            }
            Recorded::Multiple(a) => multiple(known[a], factor),
            Recorded::Of(op) => apply(&recorder, op.map(|x| known[x]))?,
        });
    }
    // u times zero if nothing depends on z.
    let slope = operations.results.last().and_then(|&result| known[result].1);
    recorder.result(slope.unwrap_or_else(|| direction * 0.0));
    Ok(recorder)
}

/// The sum of two derivatives, either of which may be zero.
fn plus<'a>(a: Option<Symbol<'a>>, b: Option<Symbol<'a>>) -> Option<Symbol<'a>> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a + b),
        (one, other) => one.or(other),
    }
}

fn sum<'a>((a, of_a): Differentiated<'a>, (b, of_b): Differentiated<'a>) -> Differentiated<'a> {
    (a + b, plus(of_a, of_b))
}

fn multiple((a, of_a): Differentiated<'_>, factor: f64) -> Differentiated<'_> {
    (a * factor, of_a.map(|a| a * factor))
}

fn apply<'a>(
    list: &'a Recorder,
    op: Op<Differentiated<'a>>,
) -> Result<Differentiated<'a>, SchemeError> {
    if let Op::AveragedField { a, b } = op {
        let v = apply(list, Op::AveragedGradient { a, b })?;
        return apply(list, Op::Structure { y: multiple(sum(a, b), 0.5), v });
    }
    let value = list.of(op.map(|(x, _)| x));
    if op.arguments().all(|(_, slope)| slope.is_none()) {
        return Ok((value, None));
    }
    let slope = match op {
        Op::Structure { y: (y, along), v: (v, of_v) } => plus(
            along.map(|u| list.of(Op::StructureAlong { y, u, v })),
            of_v.map(|v| list.of(Op::Structure { y, v })),
        ),
        Op::Gradient { y: (y, along) } => along.map(|u| list.of(Op::Hessian { y, u })),
        // The derivative along a is the one along b with a and b exchanged.
        Op::AveragedGradient { a: (a, of_a), b: (b, of_b) } => {
            let along_b = of_b.map(|u| list.of(Op::AveragedHessian { a, b, u }));
            let along_a = of_a.map(|u| list.of(Op::AveragedHessian { a: b, b: a, u }));
            plus(along_a, along_b)
        }
        Op::AreaGradient { y: (y, along) } => along.map(|u| list.of(Op::AreaHessian { y, u })),
        _ => {
            let message = "an implicit formula cannot have `cayley` or `ito_correction` of z, \
                           whose derivatives along z are not known: take them of ẑ";
            return Err(SchemeError(message.into()));
        }
    };
    Ok((value, slope))
}
