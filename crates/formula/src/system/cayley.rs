//! The linearly implicit step z = y + B((y+z)/2)·v for an affine B, as expressions.
//!
//! With A(v)x = B(x)v − B(0)v the equation is (I − ½A)z = y + ½(B(y)v + B(0)v), as for compiled
//! systems. The matrix is eliminated without pivoting, in the order of [`real::Factored`]. Its
//! zeros are known, so that nothing is computed with them.

use super::MAX_EXPRESSIONS;
use expression::{Graph, Id};

/// The matrix I − ½A(v), row by row.
pub fn matrix(graph: &mut Graph, field: &[Id]) -> Vec<Vec<Id>> {
    let mut matrix = vec![Vec::new(); field.len()];
    let one = graph.constant(1.0);
    for j in 0..field.len() {
        let column = graph.forward(field, &[(j, one)]);
        for (i, &slope) in column.iter().enumerate() {
            let half = graph.scale(slope, -0.5);
            matrix[i].push(if i == j { graph.add(half, one) } else { half });
        }
    }
    matrix
}

/// x with A x = b; none if it takes too many expressions.
pub fn solve(graph: &mut Graph, a: Vec<Vec<Id>>, b: Vec<Id>) -> Option<Vec<Id>> {
    Some(match a.len() {
        2 => {
            let determinant = graph.minor([a[0][0], a[0][1]], [a[1][0], a[1][1]]);
            let adjugate = [[a[1][1], graph.neg(a[0][1])], [graph.neg(a[1][0]), a[0][0]]];
            times_adjugate(graph, &adjugate, &b, determinant)
        }
        3 => {
            let columns =
                [graph.cross(&a[1], &a[2]), graph.cross(&a[2], &a[0]), graph.cross(&a[0], &a[1])];
            let determinant = graph.dot(&a[0], &columns[0]);
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
    let mut x = Vec::new();
    for row in adjugate {
        let row = row.map(|entry| graph.mul(entry, inverse));
        x.push(graph.dot(&row, b));
    }
    x
}

fn eliminate(graph: &mut Graph, mut a: Vec<Vec<Id>>, mut x: Vec<Id>) -> Option<Vec<Id>> {
    let one = graph.constant(1.0);
    for k in 0..x.len() {
        a[k][k] = graph.div(one, a[k][k]);
        if graph.size() > MAX_EXPRESSIONS {
            return None;
        }
        for i in k + 1..x.len() {
            if graph.is_zero(a[i][k]) {
                continue;
            }
            a[i][k] = graph.mul(a[i][k], a[k][k]);
            for j in k + 1..x.len() {
                let product = graph.mul(a[i][k], a[k][j]);
                a[i][j] = graph.sub(a[i][j], product);
            }
        }
    }
    for k in 0..x.len() {
        for i in k + 1..x.len() {
            let product = graph.mul(a[i][k], x[k]);
            x[i] = graph.sub(x[i], product);
        }
    }
    for k in (0..x.len()).rev() {
        for j in k + 1..x.len() {
            let product = graph.mul(a[k][j], x[j]);
            x[k] = graph.sub(x[k], product);
        }
        x[k] = graph.mul(x[k], a[k][k]);
    }
    Some(x)
}
