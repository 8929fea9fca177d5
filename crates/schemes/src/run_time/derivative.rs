//! The derivative of a recorded formula.

use systems::run_time::{Op, Recorded};

use super::SchemeError;

/// The number of an operation, and that of its derivative unless it is zero.
type Differentiated = (usize, Option<usize>);

/// The direction u, an input.
const DIRECTION: usize = 2;

/// The operations of ∂ψ/∂z·u for a formula ψ(ẑ, z) with the inputs ẑ, z; the inputs of the result
/// are ẑ, z, u. Operations that do not depend on z are kept, their derivatives are zero and not
/// computed.
///
/// # Errors
/// [`SchemeError::Derivative`] for operations at z whose second derivatives would be needed: ½Σ
/// fₘ′fₘ, or the solution of a linear equation.
pub fn derivative(
    operations: &[Recorded],
    factors: &[f64],
) -> Result<(Vec<Recorded>, Vec<f64>), SchemeError> {
    let mut list = List { operations: Vec::new(), factors: Vec::new() };
    for input in 0..=DIRECTION {
        list.push(Recorded::Input(input), 1.0);
    }
    let mut known: Vec<Differentiated> = Vec::new();
    for (&operation, &factor) in operations.iter().zip(factors) {
        let differentiated = match operation {
            Recorded::Input(input) => (input, (input == 1).then_some(DIRECTION)),
            Recorded::Sum(a, b) => list.sum(known[a], known[b]),
            Recorded::Difference(a, b) => {
                let ((a, of_a), (b, of_b)) = (known[a], known[b]);
                let value = list.push(Recorded::Difference(a, b), 1.0);
                let minus = of_b.map(|b| list.push(Recorded::Multiple(b), -1.0));
                (value, list.sum_of_known(of_a, minus))
            }
            Recorded::Multiple(a) => list.multiple(known[a], factor),
            Recorded::Of(op) => list.apply(op.map(|x| known[x]))?,
        };
        known.push(differentiated);
    }
    // The last operation is the result: u times zero if nothing depends on z.
    let result = known.last().and_then(|result| result.1);
    let (result, factor) = result.map_or((DIRECTION, 0.0), |slope| (slope, 1.0));
    list.push(Recorded::Multiple(result), factor);
    Ok((list.operations, list.factors))
}

struct List {
    operations: Vec<Recorded>,
    factors: Vec<f64>,
}

impl List {
    fn push(&mut self, operation: Recorded, factor: f64) -> usize {
        self.operations.push(operation);
        self.factors.push(factor);
        self.operations.len() - 1
    }

    fn op(&mut self, op: Op<usize>) -> usize {
        self.push(Recorded::Of(op), 1.0)
    }

    /// The sum of two derivatives, either of which may be zero.
    fn sum_of_known(&mut self, a: Option<usize>, b: Option<usize>) -> Option<usize> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.push(Recorded::Sum(a, b), 1.0)),
            (one, other) => one.or(other),
        }
    }

    fn sum(&mut self, (a, of_a): Differentiated, (b, of_b): Differentiated) -> Differentiated {
        (self.push(Recorded::Sum(a, b), 1.0), self.sum_of_known(of_a, of_b))
    }

    fn multiple(&mut self, (a, of_a): Differentiated, factor: f64) -> Differentiated {
        let mut multiple = |x| self.push(Recorded::Multiple(x), factor);
        (multiple(a), of_a.map(multiple))
    }

    fn apply(&mut self, op: Op<Differentiated>) -> Result<Differentiated, SchemeError> {
        if let Op::AveragedField { a, b } = op {
            let v = self.apply(Op::AveragedGradient { a, b })?;
            let twice = self.sum(a, b);
            let y = self.multiple(twice, 0.5);
            return self.apply(Op::Structure { y, v });
        }
        let value = self.op(op.map(|(x, _)| x));
        if op.arguments().all(|(_, slope)| slope.is_none()) {
            return Ok((value, None));
        }
        let slope = match op {
            Op::Structure { y: (y, along), v: (v, of_v) } => {
                let bent = along.map(|u| self.op(Op::StructureAlong { y, u, v }));
                let turned = of_v.map(|v| self.op(Op::Structure { y, v }));
                self.sum_of_known(bent, turned)
            }
            Op::Gradient { y: (y, along) } => along.map(|u| self.op(Op::Hessian { y, u })),
            // The derivative along a is the one along b with a and b exchanged.
            Op::AveragedGradient { a: (a, of_a), b: (b, of_b) } => {
                let along_b = of_b.map(|u| self.op(Op::AveragedHessian { a, b, u }));
                let along_a = of_a.map(|u| self.op(Op::AveragedHessian { a: b, b: a, u }));
                self.sum_of_known(along_a, along_b)
            }
            Op::AreaGradient { y: (y, along) } => along.map(|u| self.op(Op::AreaHessian { y, u })),
            _ => return Err(SchemeError::Derivative),
        };
        Ok((value, slope))
    }
}
