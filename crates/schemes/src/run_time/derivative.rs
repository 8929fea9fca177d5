//! The derivative of a recorded formula.

use systems::run_time::Node;

use super::SchemeError;

/// The operations of ∂ψ/∂z·u for a formula ψ(ẑ, z) with the inputs ẑ, z; the inputs of the result
/// are ẑ, z, u. Operations that do not depend on z are kept, their derivatives are zero and not
/// computed.
///
/// # Errors
/// [`SchemeError::Derivative`] for operations at z whose second derivatives would be needed: ½Σ
/// fₘ′fₘ, or the solution of a linear equation.
pub fn derivative(nodes: &[Node], factors: &[f64]) -> Result<(Vec<Node>, Vec<f64>), SchemeError> {
    let mut list = List { nodes: Vec::new(), factors: Vec::new() };
    // The place of each node, and of its derivative unless it is zero.
    let mut place: Vec<usize> = Vec::new();
    let mut slope: Vec<Option<usize>> = Vec::new();
    let direction = 2;
    for input in 0..=direction {
        list.push(Node::Input(input), 1.0);
    }
    for (&node, &factor) in nodes.iter().zip(factors) {
        let (value, along) = match node {
            Node::Input(input) => (input, (input == 1).then_some(direction)),
            Node::Sum(a, b) => {
                let value = list.push(Node::Sum(place[a], place[b]), 1.0);
                (value, list.sum(slope[a], slope[b]))
            }
            Node::Difference(a, b) => {
                let value = list.push(Node::Difference(place[a], place[b]), 1.0);
                let minus = slope[b].map(|b| list.push(Node::Multiple(b), -1.0));
                (value, list.sum(slope[a], minus))
            }
            Node::Multiple(a) => {
                let value = list.push(Node::Multiple(place[a]), factor);
                (value, slope[a].map(|a| list.push(Node::Multiple(a), factor)))
            }
            Node::Structure { y, v } => {
                let (at, times) = (place[y], place[v]);
                let value = list.push(Node::Structure { y: at, v: times }, 1.0);
                let bent =
                    slope[y].map(|u| list.push(Node::StructureAlong { y: at, u, v: times }, 1.0));
                let turned = slope[v].map(|v| list.push(Node::Structure { y: at, v }, 1.0));
                (value, list.sum(bent, turned))
            }
            Node::Gradient { y } => {
                let y_at = place[y];
                let value = list.push(Node::Gradient { y: y_at }, 1.0);
                (value, slope[y].map(|u| list.push(Node::Hessian { y: y_at, u }, 1.0)))
            }
            Node::AveragedGradient { a, b } => {
                list.averaged(place[a], place[b], slope[a], slope[b])
            }
            Node::AveragedField { a, b } => {
                let (a, b, of_a, of_b) = (place[a], place[b], slope[a], slope[b]);
                let (gradient, curved) = list.averaged(a, b, of_a, of_b);
                let twice = list.push(Node::Sum(a, b), 1.0);
                let middle = list.push(Node::Multiple(twice), 0.5);
                let value = list.push(Node::Structure { y: middle, v: gradient }, 1.0);
                let moved = list.sum(of_a, of_b).map(|u| list.push(Node::Multiple(u), 0.5));
                let bent = moved
                    .map(|u| list.push(Node::StructureAlong { y: middle, u, v: gradient }, 1.0));
                let turned = curved.map(|v| list.push(Node::Structure { y: middle, v }, 1.0));
                (value, list.sum(bent, turned))
            }
            Node::Cayley { y, v } if slope[y].or(slope[v]).is_none() => {
                (list.push(Node::Cayley { y: place[y], v: place[v] }, 1.0), None)
            }
            Node::ItoCorrection { y } if slope[y].is_none() => {
                (list.push(Node::ItoCorrection { y: place[y] }, 1.0), None)
            }
            _ => return Err(SchemeError::Derivative),
        };
        place.push(value);
        slope.push(along);
    }
    // The last operation is the result: u times zero if nothing depends on z.
    let result = slope.last().copied().flatten();
    let result = result.map_or((direction, 0.0), |slope| (slope, 1.0));
    list.push(Node::Multiple(result.0), result.1);
    Ok((list.nodes, list.factors))
}

struct List {
    nodes: Vec<Node>,
    factors: Vec<f64>,
}

impl List {
    fn push(&mut self, node: Node, factor: f64) -> usize {
        self.nodes.push(node);
        self.factors.push(factor);
        self.nodes.len() - 1
    }

    /// The sum of two derivatives, either of which may be zero.
    fn sum(&mut self, a: Option<usize>, b: Option<usize>) -> Option<usize> {
        match (a, b) {
            (Some(a), Some(b)) => Some(self.push(Node::Sum(a, b), 1.0)),
            (one, other) => one.or(other),
        }
    }

    /// ∇̄h(a, b) and its derivative. That along a is the one along b with a and b exchanged.
    fn averaged(
        &mut self,
        a: usize,
        b: usize,
        of_a: Option<usize>,
        of_b: Option<usize>,
    ) -> (usize, Option<usize>) {
        let value = self.push(Node::AveragedGradient { a, b }, 1.0);
        let along_b = of_b.map(|u| self.push(Node::AveragedHessian { a, b, u }, 1.0));
        let along_a = of_a.map(|u| self.push(Node::AveragedHessian { a: b, b: a, u }, 1.0));
        (value, self.sum(along_a, along_b))
    }
}
