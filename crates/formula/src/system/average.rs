//! The averaged gradient ∇̄h(a, b) = ∫₀¹ ∇h((1−η)a + ηb) dη as expressions.
//!
//! Each Hamiltonian is taken apart into terms. A sine or cosine of what is affine in y has a closed
//! form without cancellation, as in [`dgrad`]. A polynomial has the Gauss–Legendre nodes that it
//! needs, and everything else has 8. So a sum of polynomials, sines and cosines is exact to
//! round-off.

use dgrad::{Rule, nodes_for_degree};

use super::{MAX_NODES, NODES};
use expression::{Graph, Id, Node, Unary, Weighted, terms};

/// (a+b)/2 + distance·(b − a), in the order of operations of `systems::run_time`.
pub fn point(graph: &mut Graph, a: &[Id], b: &[Id], distance: f64) -> Vec<Id> {
    let component = |(&a, &b): (&Id, &Id)| {
        let (sum, difference) = (graph.add(a, b), graph.sub(b, a));
        let (middle, shift) = (graph.scale(sum, 0.5), graph.scale(difference, distance));
        graph.add(middle, shift)
    };
    a.iter().zip(b).map(component).collect()
}

/// ∇̄h(a, b) for h = Σ weight·Hamiltonian, in y, the first inputs.
pub fn averaged_gradient(graph: &mut Graph, h: &[Weighted], a: &[Id], b: &[Id]) -> Vec<Id> {
    let y: Vec<usize> = (0..a.len()).collect();
    let mut mean = vec![graph.constant(0.0); y.len()];
    // Terms by the number of their nodes.
    let mut groups: Vec<Vec<Weighted>> = vec![Vec::new(); MAX_NODES + 1];
    let terms = terms(graph, h);
    let all: Vec<Id> = graph.ids().collect();
    let degrees = graph.degrees(&all, &y);
    for (term, weight) in terms {
        let part = match graph.node(term) {
            Node::Unary(function @ (Unary::Sin | Unary::Cos), angle)
                if degrees[angle.index()] == Some(1) =>
            {
                averaged_wave(graph, function, (angle, weight), a, b)
            }
            _ => {
                let nodes = match degrees[term.index()] {
                    Some(0) => continue,
                    Some(degree) => nodes_for_degree(degree as usize - 1).min(MAX_NODES),
                    None => NODES,
                };
                groups[nodes].push((term, weight));
                continue;
            }
        };
        add(graph, &mut mean, &part, 1.0);
    }
    for (nodes, group) in groups.iter().enumerate().filter(|(_, group)| !group.is_empty()) {
        let gradient = graph.reverse(group, &y);
        let part = by_quadrature(graph, &gradient, nodes, a, b);
        add(graph, &mut mean, &part, 1.0);
    }
    mean
}

/// Adds weight·part.
pub fn add(graph: &mut Graph, sum: &mut [Id], part: &[Id], weight: f64) {
    for (sum, &part) in sum.iter_mut().zip(part) {
        let weighted = graph.scale(part, weight);
        *sum = graph.add(*sum, weighted);
    }
}

/// The averaged gradient of weight·sin u or weight·cos u for an affine u: the means of cos u and
/// −sin u are their values at the middle times sinc(½(u(b) − u(a))).
fn averaged_wave(
    graph: &mut Graph,
    function: Unary,
    (angle, weight): Weighted,
    a: &[Id],
    b: &[Id],
) -> Vec<Id> {
    let one = graph.constant(1.0);
    let slopes = graph.reverse(&[(angle, one)], &(0..a.len()).collect::<Vec<_>>());
    let distance = |(&a, &b): (&Id, &Id)| {
        let difference = graph.sub(b, a);
        graph.scale(difference, 0.5)
    };
    let distances: Vec<Id> = a.iter().zip(b).map(distance).collect();
    let half = graph.dot(&distances, &slopes);
    let middle = point(graph, a, b, 0.0);
    let angle = at(graph, &[angle], &middle)[0];
    let mean = match function {
        Unary::Sin => graph.unary(Unary::Cos, angle),
        _ => {
            let sin = graph.unary(Unary::Sin, angle);
            graph.neg(sin)
        }
    };
    let sinc = graph.unary(Unary::Sinc, half);
    let product = graph.mul(mean, sinc);
    let mean = graph.mul(product, weight);
    slopes.into_iter().map(|slope| graph.mul(mean, slope)).collect()
}

/// Expressions at another state y.
fn at(graph: &mut Graph, roots: &[Id], state: &[Id]) -> Vec<Id> {
    let rest: Vec<Id> = (state.len()..graph.inputs()).map(|k| graph.input(k)).collect();
    graph.copy(None, roots, &[state, &rest].concat())
}

fn by_quadrature(graph: &mut Graph, gradient: &[Id], nodes: usize, a: &[Id], b: &[Id]) -> Vec<Id> {
    let rule = Rule::new(nodes).expect("a rule has a node or more");
    let at_distance = |graph: &mut Graph, distance: f64| {
        let point = point(graph, a, b, distance);
        at(graph, gradient, &point)
    };
    let mut sum = vec![graph.constant(0.0); gradient.len()];
    for k in 0..nodes.div_ceil(2) {
        let distance = 0.5 - rule.nodes()[k];
        let mut value = at_distance(graph, -distance);
        if 2 * k + 1 != nodes {
            let mirror = at_distance(graph, distance);
            add(graph, &mut value, &mirror, 1.0);
        }
        add(graph, &mut sum, &value, rule.weights()[k]);
    }
    sum
}
