//! The averaged gradient ∇̄h(a, b) = ∫₀¹ ∇h((1−η)a + ηb) dη as expressions.
//!
//! Each Hamiltonian is taken apart into terms. A sine or cosine of what is affine in y has a closed
//! form without cancellation, as in [`dgrad`]. A polynomial has the Gauss–Legendre nodes that it
//! needs, and everything else has 8. So a sum of polynomials, sines and cosines is exact to
//! round-off.

use dgrad::{Rule, nodes_for_degree};

use super::{
    MAX_NODES, NODES,
    sparse::{Sparse, dot},
};
use expression::{Graph, Id, Node, Unary, Weighted, terms};

/// (a+b)/2 + distance·(b − a), in the order of operations of `systems::run_time`.
pub fn point(graph: &mut Graph, a: &[Id], b: &[Id], distance: f64) -> Vec<Id> {
    let component = |(&a, &b): (&Id, &Id)| {
        let (sum, difference) = (graph.add(a, b), graph.sub(b, a));
        let mut point = graph.scale(sum, 0.5);
        graph.add_to(&mut point, difference, distance);
        point
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
    let degree = |graph: &Graph, root| graph.degree(root, |k| k < y.len());
    let mut middle = None;
    for (term, weight) in terms {
        if let Node::Unary(function @ (Unary::Sin | Unary::Cos), angle) = graph.node(term)
            && degree(graph, angle) == Some(1)
        {
            let middle = middle.get_or_insert_with(|| point(graph, a, b, 0.0));
            for (k, part) in averaged_wave(graph, function, (angle, weight), (a, b), middle) {
                mean[k] = graph.add(mean[k], part);
            }
            continue;
        }
        let nodes = match degree(graph, term) {
            Some(0) => continue,
            Some(degree) => nodes_for_degree(degree as usize - 1).min(MAX_NODES),
            None => NODES,
        };
        groups[nodes].push((term, weight));
    }
    for (nodes, group) in groups.iter().enumerate().filter(|(_, group)| !group.is_empty()) {
        let gradient = graph.reverse(group, &y);
        let part = by_quadrature(graph, &gradient, nodes, a, b);
        add_all(graph, &mut mean, &part, 1.0);
    }
    mean
}

/// Adds weight·part, component by component.
pub fn add_all(graph: &mut Graph, sums: &mut [Id], parts: &[Id], weight: f64) {
    sums.iter_mut().zip(parts).for_each(|(sum, &part)| graph.add_to(sum, part, weight));
}

/// The averaged gradient of weight·sin u or weight·cos u for an affine u: the means of cos u and
/// −sin u are their values at the middle times sinc(½(u(b) − u(a))).
fn averaged_wave(
    graph: &mut Graph,
    function: Unary,
    (angle, weight): Weighted,
    (a, b): (&[Id], &[Id]),
    middle: &[Id],
) -> Sparse {
    let one = graph.constant(1.0);
    let slopes = graph.slopes(&[(angle, one)], |k| k < a.len());
    let mut distances = Sparse::new();
    for &k in slopes.keys() {
        let difference = graph.sub(b[k], a[k]);
        distances.insert(k, graph.scale(difference, 0.5));
    }
    let half = dot(graph, &distances, &slopes);
    let angle = at(graph, &[angle], middle)[0];
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
    slopes.into_iter().map(|(k, slope)| (k, graph.mul(mean, slope))).collect()
}

/// Expressions at another state y.
pub fn at(graph: &mut Graph, roots: &[Id], state: &[Id]) -> Vec<Id> {
    graph.copy(None, roots, |k| state.get(k).copied())
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
            add_all(graph, &mut value, &mirror, 1.0);
        }
        add_all(graph, &mut sum, &value, rule.weights()[k]);
    }
    sum
}
