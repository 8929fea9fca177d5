//! The terms of a sum.

use std::collections::{HashMap, hash_map::Entry};

use crate::{
    Id,
    graph::{
        Binary::{Add, Mul, Sub},
        Graph, Node,
        Unary::Neg,
    },
};

/// A term with its weight.
pub type Weighted = (Id, Id);

/// The terms of Σ weight·expression, each once, with its weight.
pub fn terms(graph: &mut Graph, h: &[Weighted]) -> Vec<Weighted> {
    let mut terms: Vec<Weighted> = Vec::new();
    let mut places: HashMap<Id, usize> = HashMap::new();
    let mut open: Vec<Weighted> = h.iter().rev().copied().collect();
    while let Some((id, weight)) = open.pop() {
        match graph.node(id) {
            Node::Binary(Add, a, b) => open.extend([(b, weight), (a, weight)]),
            Node::Binary(Sub, a, b) => {
                let negative = graph.neg(weight);
                open.extend([(b, negative), (a, weight)]);
            }
            Node::Unary(Neg, a) => open.push((a, graph.neg(weight))),
            Node::Binary(Mul, a, c) if graph.as_constant(c).is_some() => {
                open.push((a, graph.mul(weight, c)));
            }
            _ => match places.entry(id) {
                Entry::Occupied(place) => {
                    let sum = &mut terms[*place.get()].1;
                    *sum = graph.add(*sum, weight);
                }
                Entry::Vacant(place) => {
                    place.insert(terms.len());
                    terms.push((id, weight));
                }
            },
        }
    }
    terms
}
