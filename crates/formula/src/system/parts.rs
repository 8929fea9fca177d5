//! The parts of a system: which they are, in words, and their flows in a graph of their own.

use std::collections::BTreeMap;

use expression::{Graph, Id};
use systems::run_time::Parts;

use super::{
    expressions::Expressions,
    flows::{Part, Term, parts},
};
use crate::words::{self, Binding};

/// Terms of a part, and Hamiltonians of these, that are written out.
const MAX_TERMS: usize = 4;

impl Expressions {
    /// Finds the parts of the Hamiltonians whose flows are known.
    /// Also gives the terms without a flow, with their graph.
    pub fn find_parts(&mut self, state: &[String]) -> (Result<Parts, String>, Graph, Vec<Term>) {
        let mut apart = self.clone();
        let found = parts(&mut apart);
        let names = self.names(state);
        let mut text = |root: Id, factor: f64| {
            let product = apart.graph.scale(root, factor);
            words::text(&apart.graph, product, &names, Binding::Sum)
        };
        let all: Vec<_> = found.iter().map(by_hamiltonian).collect();
        let of_noise = |m: usize| {
            let mut of = (0..all.len()).filter(|&k| all[k].contains_key(&m));
            of.next().filter(|&k| of.next().is_none() && !found[k].is_rest())
        };
        let rest = found.iter().filter(|part| part.is_rest());
        let rest: Vec<Term> = rest.flat_map(|part| part.terms.clone()).collect();
        let parts = match &rest[..] {
            [term, ..] if found.len() < 2 => {
                Err(format!("no flow of {} is known", text(term.root, 1.0)))
            }
            _ if found.is_empty() => Err("no Hamiltonian depends on y".into()),
            _ => Ok(Parts {
                number: found.len(),
                of_noise: (1..=self.noises).map(of_noise).collect(),
                preferred: false,
                words: found
                    .iter()
                    .zip(&all)
                    .map(|(part, terms)| format!("{} by {}", part.kind(), said(terms, &mut text)))
                    .collect(),
            }),
        };
        let (graph, flows) = &mut self.flows;
        let flow = |part: &Part| graph.copy(Some(&apart.graph), &part.flow, |_| None);
        flows.extend(found.iter().map(flow));
        (parts, apart.graph, rest)
    }
}

/// The terms of a part by the numbers of their Hamiltonians.
fn by_hamiltonian(part: &Part) -> BTreeMap<usize, Vec<&Term>> {
    let mut terms: BTreeMap<usize, Vec<&Term>> = BTreeMap::new();
    part.terms.iter().for_each(|term| terms.entry(term.of).or_default().push(term));
    terms
}

/// The terms of a part in words, the first of each of the first Hamiltonians.
fn said(terms: &BTreeMap<usize, Vec<&Term>>, mut text: impl FnMut(Id, f64) -> String) -> String {
    let mut of = Vec::new();
    for (m, terms) in terms.iter().take(MAX_TERMS) {
        let mut sum = String::new();
        for term in terms.iter().take(MAX_TERMS) {
            let text = text(term.root, term.factor);
            sum += &match (sum.is_empty(), text.strip_prefix('-')) {
                (true, _) => text,
                (_, Some(text)) => format!(" - {text}"),
                (_, None) => format!(" + {text}"),
            };
        }
        let more = terms.len().saturating_sub(MAX_TERMS);
        let more = if more > 0 { format!(" + {more} terms") } else { String::new() };
        of.push(format!("{sum}{more} of H{m}"));
    }
    let more = terms.len() - of.len();
    let more = if more > 0 { format!(", and of {more} more") } else { String::new() };
    of.join(", ") + &more
}
