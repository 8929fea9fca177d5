//! Products and linear equations of square complex matrices, column by column in slices: loops for
//! small matrices, faer for others. Threads share columns of large ones, in parts of a fixed size,
//! so that bits do not depend on their number.

use faer::{
    Accum, Conj, MatMut, MatRef, Par, c64,
    dyn_stack::{MemBuffer, MemStack, StackReq},
    linalg::{
        lu::partial_pivoting::{factor, solve},
        matmul::matmul_with_conj,
    },
    prelude::{Reborrow, ReborrowMut},
};
use rayon::prelude::*;

/// Largest size for loops: faer takes longer to begin.
const SMALL: usize = 8;
/// Columns of a part.
const PART: usize = 64;

/// Computes columns of matrices of size n, from the number that is given on: all, or parts of those
/// of large matrices.
pub fn columns<T: Send>(n: usize, out: &mut [T], compute: impl Fn(usize, &mut [T]) + Sync) {
    match n {
        ..=PART => compute(0, out),
        _ => {
            let parts = out.par_chunks_mut(n * PART).enumerate();
            parts.for_each(|(part, out)| compute(part * PART, out));
        }
    }
}

/// ab, or ab* if `adjoint`.
pub fn product(n: usize, a: &[c64], b: &[c64], adjoint: bool, out: &mut [c64]) {
    if n <= SMALL {
        for j in 0..n {
            let column = &mut out[j * n..(j + 1) * n];
            column.fill(c64::ZERO);
            for k in 0..n {
                let b = if adjoint { b[k * n + j].conj() } else { b[j * n + k] };
                for i in 0..n {
                    column[i] += a[k * n + i] * b;
                }
            }
        }
        return;
    }
    let (a, mut b, mut conj) = (view(n, a), view(n, b), Conj::No);
    if adjoint {
        (b, conj) = (b.transpose(), Conj::Yes);
    }
    let one = c64::new(1.0, 0.0);
    columns(n, out, |first, out| {
        let count = out.len() / n;
        let b = b.subcols(first, count);
        let out = MatMut::from_column_major_slice_mut(out, n, count);
        matmul_with_conj(out, Accum::Replace, a, Conj::No, b, conj, one, Par::Seq);
    });
}

fn view(n: usize, a: &[c64]) -> MatRef<'_, c64> {
    MatRef::from_column_major_slice(a, n, n)
}

/// Memory for linear equations of a size.
pub struct Equations {
    n: usize,
    permutation: [Vec<usize>; 2],
    /// For each part of the right hand sides; the factors take the first.
    memory: Vec<MemBuffer>,
}

impl Equations {
    /// Memory for n equations with n right hand sides.
    pub fn new(n: usize) -> Self {
        let factor = factor::lu_in_place_scratch::<usize, c64>(n, n, Par::Seq, Default::default());
        let solve = solve::solve_in_place_scratch::<usize, c64>(n, n.min(PART), Par::Seq);
        let each = StackReq::any_of(&[factor, solve]);
        let memory = (0..n.div_ceil(PART)).map(|_| MemBuffer::new(each)).collect();
        Self { n, permutation: [vec![0; n], vec![0; n]], memory }
    }

    /// Replaces b by a⁻¹b, and a by its factors.
    pub fn solve(&mut self, a: &mut [c64], b: &mut [c64]) {
        let n = self.n;
        if n <= SMALL {
            return eliminate(n, a, b);
        }
        let [forward, back] = &mut self.permutation;
        let stack = MemStack::new(&mut self.memory[0]);
        let mut a = MatMut::from_column_major_slice_mut(a, n, n);
        let (_, rows) =
            factor::lu_in_place(a.rb_mut(), forward, back, Par::Seq, stack, Default::default());
        let a = a.rb();
        let part = |(b, memory): (&mut [c64], &mut MemBuffer)| {
            let b = MatMut::from_column_major_slice_mut(b, n, b.len() / n);
            solve::solve_in_place(a, a, rows, b, Par::Seq, MemStack::new(memory));
        };
        match &mut self.memory[..] {
            [memory] => part((b, memory)),
            all => b.par_chunks_mut(n * PART).zip(all).for_each(part),
        }
    }
}

/// Gauss's elimination with the largest pivots of columns.
fn eliminate(n: usize, a: &mut [c64], b: &mut [c64]) {
    for k in 0..n {
        let size = |i: &usize| a[k * n + i].norm_sqr();
        let row = (k..n).max_by(|i, j| size(i).total_cmp(&size(j))).unwrap_or(k);
        if row != k {
            (0..n).for_each(|j| a.swap(j * n + k, j * n + row));
            (0..n).for_each(|j| b.swap(j * n + k, j * n + row));
        }
        let pivot = a[k * n + k].inv();
        for i in k + 1..n {
            let factor = a[k * n + i] * pivot;
            for j in k + 1..n {
                let of = a[j * n + k];
                a[j * n + i] -= factor * of;
            }
            for j in 0..n {
                let of = b[j * n + k];
                b[j * n + i] -= factor * of;
            }
        }
        a[k * n + k] = pivot;
    }
    for column in b.chunks_exact_mut(n) {
        for k in (0..n).rev() {
            column[k] *= a[k * n + k];
            for i in 0..k {
                let of = column[k];
                column[i] -= a[k * n + i] * of;
            }
        }
    }
}
