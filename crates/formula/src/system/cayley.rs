//! The linearly implicit step z = y + B((y+z)/2)·v for an affine B, as expressions.
//!
//! With A(v)x = B(x)v − B(0)v the equation is (I − ½A)z = y + ½(B(y)v + B(0)v), as for compiled
//! systems. The matrix is eliminated without pivoting, in the order of [`real::Factored`]. Its
//! zeros are known, so that nothing is computed with them.

use std::collections::BTreeSet;

use super::{MAX_EXPRESSIONS, sparse::Sparse};
use expression::{Graph, Id};

/// x with A x = b, for the rows of A; none if it takes too many expressions.
pub fn solve(graph: &mut Graph, a: Vec<Sparse>, b: Vec<Id>) -> Option<Vec<Id>> {
    let zero = graph.constant(0.0);
    let entry = |i: usize, k: usize| a[i].get(&k).copied().unwrap_or(zero);
    Some(match a.len() {
        2 => {
            let determinant = graph.minor([entry(0, 0), entry(0, 1)], [entry(1, 0), entry(1, 1)]);
            let adjugate =
                [[entry(1, 1), graph.neg(entry(0, 1))], [graph.neg(entry(1, 0)), entry(0, 0)]];
            times_adjugate(graph, &adjugate, &b, determinant)
        }
        3 => {
            let rows = [0, 1, 2].map(|i| [0, 1, 2].map(|k| entry(i, k)));
            let columns = [(1, 2), (2, 0), (0, 1)].map(|(i, k)| graph.cross(&rows[i], &rows[k]));
            let determinant = graph.dot(&rows[0], &columns[0]);
            let adjugate = [0, 1, 2].map(|i| columns.map(|column| column[i]));
            times_adjugate(graph, &adjugate, &b, determinant)
        }
        _ => return eliminate(graph, a, b),
    })
}

/// The entries of the inverse are those of the adjugate, over the determinant.
fn times_adjugate<const N: usize>(
    graph: &mut Graph,
    adjugate: &[[Id; N]; N],
    b: &[Id],
    determinant: Id,
) -> Vec<Id> {
    let one = graph.constant(1.0);
    let inverse = graph.div(one, determinant);
    let component = |row: &[Id; N]| {
        let row = row.map(|entry| graph.mul(entry, inverse));
        graph.dot(&row, b)
    };
    adjugate.iter().map(component).collect()
}

fn eliminate(graph: &mut Graph, mut a: Vec<Sparse>, mut x: Vec<Id>) -> Option<Vec<Id>> {
    let (size, one, zero) = (graph.size(), graph.constant(1.0), graph.constant(0.0));
    // Rows with an entry in each column, below the diagonal.
    let mut below = vec![BTreeSet::new(); x.len()];
    for (i, row) in a.iter().enumerate() {
        row.range(..i).for_each(|(&k, _)| _ = below[k].insert(i));
    }
    for k in 0..x.len() {
        let pivot = graph.div(one, a[k].get(&k).copied().unwrap_or(zero));
        a[k].insert(k, pivot);
        if graph.size() - size > MAX_EXPRESSIONS {
            return None;
        }
        let row: Vec<(usize, Id)> = a[k].range(k + 1..).map(|(&j, &entry)| (j, entry)).collect();
        for i in std::mem::take(&mut below[k]) {
            let factor = graph.mul(a[i][&k], pivot);
            a[i].insert(k, factor);
            for &(j, entry) in &row {
                let other = a[i].entry(j).or_insert(zero);
                *other = graph.sub_product(*other, factor, entry);
                if j < i {
                    below[j].insert(i);
                }
            }
        }
    }
    for i in 0..x.len() {
        for (&k, &factor) in a[i].range(..i) {
            x[i] = graph.sub_product(x[i], factor, x[k]);
        }
    }
    for k in (0..x.len()).rev() {
        for (&j, &entry) in a[k].range(k + 1..) {
            x[k] = graph.sub_product(x[k], entry, x[j]);
        }
        x[k] = graph.mul(x[k], a[k][&k]);
    }
    Some(x)
}
