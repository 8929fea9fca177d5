//! Vectors and matrices that are mostly zero, and their places.

use std::{collections::BTreeMap, ops::Range};

use expression::{Affine, Graph, Id};

/// Components of a vector that are not zero.
pub type Sparse = BTreeMap<usize, Id>;

/// The components of an affine field that are not zero.
pub type Field = BTreeMap<usize, Affine>;

/// Σ uₖvₖ.
pub fn dot(graph: &mut Graph, u: &Sparse, v: &Sparse) -> Id {
    graph.sum(u.iter().filter_map(|(k, &u)| Some((u, *v.get(k)?))))
}

/// Ranges of these sizes, one after the other.
pub fn consecutive<const N: usize>(sizes: [usize; N]) -> [Range<usize>; N] {
    let mut end = 0;
    sizes.map(|size| {
        end += size;
        end - size..end
    })
}

/// Numbers 0, 1, … in groups that are joined, each to those of its list.
pub fn connected(joined: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut neighbours = joined.to_vec();
    for (i, list) in joined.iter().enumerate() {
        list.iter().for_each(|&j| neighbours[j].push(i));
    }
    let (mut seen, mut groups) = (vec![false; joined.len()], Vec::new());
    for first in 0..joined.len() {
        let (mut open, mut group) = (vec![first], Vec::new());
        while let Some(k) = open.pop() {
            if !std::mem::replace(&mut seen[k], true) {
                group.push(k);
                open.extend(&neighbours[k]);
            }
        }
        group.sort_unstable();
        groups.extend((!group.is_empty()).then_some(group));
    }
    groups
}
