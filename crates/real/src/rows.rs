//! Rows of 32 numbers on the heap, for states whose size is known at run time.

use std::ops::{Deref, DerefMut};

use crate::WIDTH;

/// 32 numbers: one component of 32 paths, or 32 components of one path.
pub type Row = [f64; WIDTH];

/// The numbers at place p of N rows, such as the state of path p.
#[inline(always)]
pub fn path<const N: usize, const L: usize>(rows: &[[f64; L]; N], p: usize) -> [f64; N] {
    let mut numbers = [0.0; N];
    for i in 0..N {
        numbers[i] = rows[i][p];
    }
    numbers
}

/// The rows as an array.
///
/// # Panics
/// Unless there are N of them.
#[inline(always)]
pub fn exactly<const N: usize>(rows: &[Row]) -> &[Row; N] {
    rows.try_into().unwrap_or_else(|_| panic!("{N} rows are needed, got {}", rows.len()))
}

/// Numbers in a cache line, to which rows are aligned.
const LINE: usize = 8;

/// Rows on the heap, aligned to a cache line, so that no vector load straddles two lines. It
/// dereferences to a slice of [`Row`].
#[derive(Debug, Default)]
pub struct Rows {
    numbers: Vec<f64>,
    /// Place of the first row in `numbers`, and the number of rows.
    first: usize,
    count: usize,
}

impl Rows {
    /// `count` rows of zeros.
    pub fn zero(count: usize) -> Self {
        let numbers = vec![0.0; count * WIDTH + LINE];
        let first = numbers.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE);
        Self { numbers, first, count }
    }

    /// Rows with the numbers `y` on all 32 paths: row i is yᵢ.
    pub fn splat(y: &[f64]) -> Self {
        let mut rows = Self::zero(y.len());
        rows.iter_mut().zip(y).for_each(|(row, &y)| *row = [y; WIDTH]);
        rows
    }
}

/// A copy has memory of its own, aligned anew.
impl Clone for Rows {
    fn clone(&self) -> Self {
        let mut rows = Self::zero(self.count);
        rows.copy_from_slice(self);
        rows
    }
}

impl Deref for Rows {
    type Target = [Row];
    #[inline]
    fn deref(&self) -> &[Row] {
        let end = self.first + self.count * WIDTH;
        self.numbers[self.first..end].as_chunks().0
    }
}

impl DerefMut for Rows {
    #[inline]
    fn deref_mut(&mut self) -> &mut [Row] {
        let end = self.first + self.count * WIDTH;
        self.numbers[self.first..end].as_chunks_mut().0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_aligned_and_zero() {
        for count in [0, 1, 3, 1000] {
            let rows = Rows::zero(count);
            assert_eq!((rows.len(), rows.as_ptr().align_offset(64)), (count, 0));
            assert!(rows.iter().all(|row| *row == [0.0; WIDTH]));
        }
        let mut rows = Rows::splat(&[1.0, -2.0]);
        rows[1][31] = 5.0;
        assert_eq!((rows[0], rows[1][0], rows[1][31]), ([1.0; WIDTH], -2.0, 5.0));
    }
}
