//! Rows of 32 numbers on the heap, for states whose size is known at run time.

use std::ops::{Deref, DerefMut};

use crate::WIDTH;

/// 32 numbers: one component of 32 paths, or 32 components of one path.
pub type Row = [f64; WIDTH];

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

/// Memory that is not there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfMemory {
    /// Number of bytes that were asked for; `usize::MAX` if it exceeds that.
    pub bytes: usize,
}

impl std::fmt::Display for OutOfMemory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "there is no memory for {} bytes", self.bytes)
    }
}

impl std::error::Error for OutOfMemory {}

impl Rows {
    /// `count` rows of zeros.
    ///
    /// # Errors
    /// [`OutOfMemory`] if the allocator has no room for them.
    pub fn zero(count: usize) -> Result<Self, OutOfMemory> {
        let length = count.checked_mul(WIDTH).and_then(|numbers| numbers.checked_add(LINE));
        let bytes = length.and_then(|length| length.checked_mul(size_of::<f64>()));
        let error = OutOfMemory { bytes: bytes.unwrap_or(usize::MAX) };
        let length = length.ok_or(error)?;
        let mut numbers = Vec::new();
        numbers.try_reserve_exact(length).map_err(|_| error)?;
        numbers.resize(length, 0.0);
        let first = numbers.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE);
        Ok(Self { numbers, first, count })
    }

    /// The same `y` on all 32 paths: row i is yᵢ.
    ///
    /// # Errors
    /// As [`zero`](Self::zero).
    pub fn splat(y: &[f64]) -> Result<Self, OutOfMemory> {
        let mut rows = Self::zero(y.len())?;
        rows.iter_mut().zip(y).for_each(|(row, &y)| *row = [y; WIDTH]);
        Ok(rows)
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
            let rows = Rows::zero(count).unwrap();
            assert_eq!((rows.len(), rows.as_ptr().align_offset(64)), (count, 0));
            assert!(rows.iter().all(|row| *row == [0.0; WIDTH]));
        }
        let mut rows = Rows::splat(&[1.0, -2.0]).unwrap();
        rows[1][31] = 5.0;
        assert_eq!((rows[0], rows[1][0], rows[1][31]), ([1.0; WIDTH], -2.0, 5.0));
    }

    #[test]
    fn memory_that_is_not_there_is_named() {
        let error = Rows::zero(1 << 50).unwrap_err();
        assert_eq!(error.bytes, (1 << 58) + 64);
        assert_eq!(Rows::zero(usize::MAX).unwrap_err().bytes, usize::MAX);
    }
}
