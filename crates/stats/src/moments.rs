//! Means, variances and covariances from sums.
//!
//! Sums of squares lose digits only where the mean is many times the standard deviation; what is
//! folded here are errors and differences, whose mean is of the size of their spread or below.

use serde::{Deserialize, Serialize};

use crate::least_squares::{dot, matrix};

/// Number of batches of [`CrossMoments`]: enough that a bootstrap over batches is one over paths
/// for all practical purposes (with up to 256 samples it is one), few enough that memory does not
/// matter.
pub const BATCHES: usize = 256;

/// Number of effective samples, (Σx)²/Σx², below which a mean is not nearly normal.
pub const FEW_SAMPLES: f64 = 30.0;

/// Means and covariances of a vector, and its sums over [`BATCHES`] batches for the bootstrap.
///
/// Sample number n, in the order of adding and merging, belongs to batch n mod [`BATCHES`]. Samples
/// are independent, so any rule that does not look at their values will do; this one does not
/// depend on how the samples were grouped, and memory does not grow with their number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrossMoments {
    count: u64,
    sum: Vec<f64>,
    /// Sums Σ xᵢxⱼ for i ≤ j, row by row.
    products: Vec<f64>,
    /// Sums over the batches that have samples, batch by batch.
    batches: Vec<f64>,
}

impl CrossMoments {
    /// Creates moments of a vector of the given length, without samples.
    pub fn new(length: usize) -> Self {
        let products = vec![0.0; length * (length + 1) / 2];
        Self { count: 0, sum: vec![0.0; length], products, batches: Vec::new() }
    }

    /// Adds a sample.
    ///
    /// # Panics
    /// If `x` has another length.
    pub fn add(&mut self, x: &[f64]) {
        assert_eq!(x.len(), self.sum.len(), "a sample has the length of the vector");
        self.add_to_batch(self.count, x);
        self.count += 1;
        let mut products = self.products.iter_mut();
        for (i, &xi) in x.iter().enumerate() {
            self.sum[i] += xi;
            for (&xj, product) in x[i..].iter().zip(&mut products) {
                *product += xi * xj;
            }
        }
    }

    /// Adds `x` to the batch of sample number n.
    fn add_to_batch(&mut self, n: u64, x: &[f64]) {
        let start = (n % BATCHES as u64) as usize * x.len();
        if self.batches.len() < start + x.len() {
            self.batches.resize(start + x.len(), 0.0);
        }
        add(&mut self.batches[start..], x);
    }

    /// Adds all samples of `other`, which has the same length.
    pub fn merge(&mut self, other: &Self) {
        for (n, sums) in (self.count..).zip(other.batches.chunks_exact(self.sum.len().max(1))) {
            self.add_to_batch(n, sums);
        }
        self.count += other.count;
        add(&mut self.sum, &other.sum);
        add(&mut self.products, &other.products);
    }

    /// Number of samples.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Length of the vector.
    pub fn length(&self) -> usize {
        self.sum.len()
    }

    /// Sample mean of component i; NaN without samples.
    pub fn mean(&self, i: usize) -> f64 {
        self.sum[i] / self.count as f64
    }

    /// Sum Σ xᵢxⱼ for i ≤ j.
    fn product(&self, i: usize, j: usize) -> f64 {
        self.products[i * self.sum.len() - i * (i + 1) / 2 + j]
    }

    /// Covariance of the sample *means* of components i and j: the sample covariance over the
    /// number of samples.
    pub fn covariance_of_means(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.min(j), i.max(j));
        let n = self.count as f64;
        (self.product(i, j) - self.sum[i] * self.sum[j] / n) / (n - 1.0) / n
    }

    /// Standard error of the mean of component i; NaN with fewer than two samples.
    pub fn standard_error(&self, i: usize) -> f64 {
        let variance = self.covariance_of_means(i, i);
        if variance < 0.0 { 0.0 } else { variance.sqrt() }
    }

    /// All sample means.
    pub fn means(&self) -> Vec<f64> {
        (0..self.length()).map(|i| self.mean(i)).collect()
    }

    /// The covariance matrix of the sample means.
    pub fn covariances_of_means(&self) -> Vec<Vec<f64>> {
        matrix(self.length(), |i, j| self.covariance_of_means(i, j))
    }

    /// The moments of the linear combinations Σⱼ rᵢⱼ xⱼ, one for each row r.
    ///
    /// # Panics
    /// If a row has another length than the vector.
    #[must_use]
    pub fn combined(&self, rows: &[Vec<f64>]) -> Self {
        let length = self.length();
        assert!(rows.iter().all(|row| row.len() == length), "a row has the length of the vector");
        let apply = |x: &[f64]| rows.iter().map(|row| dot(row, x)).collect::<Vec<_>>();
        let mut products = Vec::with_capacity(rows.len() * (rows.len() + 1) / 2);
        for (i, row) in rows.iter().enumerate() {
            let column: Vec<f64> = (0..length)
                .map(|k| (0..length).map(|j| row[j] * self.product(j.min(k), j.max(k))).sum())
                .collect();
            products.extend(rows[i..].iter().map(|other| dot(other, &column)));
        }
        let batches = self.batches.chunks_exact(length.max(1)).flat_map(apply).collect();
        Self { count: self.count, sum: apply(&self.sum), products, batches }
    }

    /// Moments of a range of components.
    #[must_use]
    pub fn part(&self, components: std::ops::Range<usize>) -> Self {
        let unit = |k| (0..self.length()).map(|l| f64::from(u8::from(k == l))).collect();
        self.combined(&components.map(unit).collect::<Vec<_>>())
    }

    /// Effective number of samples of component i, (Σx)²/Σx² (Kish, *Survey Sampling*, 1965): the
    /// number of equal samples that would carry the sum of a positive quantity as evenly. All
    /// samples for a constant, a third for squares of centred normals, about one when a single
    /// sample dominates. NaN without samples or when all are zero.
    pub fn effective_samples(&self, i: usize) -> f64 {
        self.sum[i] * self.sum[i] / self.product(i, i)
    }

    /// The batches: number of samples and sum of each. There are [`BATCHES`] of them, or one for
    /// each sample when there are fewer samples.
    pub fn batches(&self) -> impl Iterator<Item = (u64, &[f64])> {
        let (each, one_more) = (self.count / BATCHES as u64, self.count % BATCHES as u64);
        (0..)
            .map(move |b| each + u64::from(b < one_more))
            .zip(self.batches.chunks_exact(self.sum.len().max(1)))
    }
}

/// Adds `addends` to `sums`, component by component.
fn add(sums: &mut [f64], addends: &[f64]) {
    sums.iter_mut().zip(addends).for_each(|(sum, addend)| *sum += addend);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f64, exact: f64) -> bool {
        (found - exact).abs() <= 1e-14 * exact.abs().max(1.0)
    }

    impl CrossMoments {
        pub(crate) fn of<const N: usize>(samples: impl IntoIterator<Item = [f64; N]>) -> Self {
            let mut moments = Self::new(N);
            samples.into_iter().for_each(|x| moments.add(&x));
            moments
        }
    }

    #[test]
    fn moments_are_the_textbook_ones() {
        let samples = [[1.0, 2.0, 0.5], [3.0, -1.0, 0.5], [2.0, 4.0, 0.25], [5.0, 0.0, 8.0]];
        let all = CrossMoments::of(samples);
        assert_eq!((all.count(), all.length(), all.means()), (4, 3, vec![2.75, 1.25, 2.3125]));
        let matrix = all.covariances_of_means();
        for i in 0..3 {
            for j in 0..3 {
                let product = |x: &[f64; 3]| (x[i] - all.mean(i)) * (x[j] - all.mean(j));
                assert!(close(matrix[i][j], samples.iter().map(product).sum::<f64>() / 12.0));
            }
        }
        assert!(close(all.standard_error(2).powi(2), matrix[2][2]));
        // Round-off does not make the variance negative.
        let same = CrossMoments::of([[0.1]; 3]);
        assert!(same.covariance_of_means(0, 0) < 0.0 && same.standard_error(0) == 0.0);
    }

    #[test]
    fn combinations_have_the_moments_of_combined_samples() {
        // Integers, so that nothing is rounded.
        let rows = [vec![1.0, 2.0, -1.0], vec![0.0, 3.0, 1.0]];
        let samples = (0..300).map(|n| [f64::from(n), f64::from(n * n % 13), f64::from(n % 7)]);
        let direct = CrossMoments::of(samples.clone().map(|x| [0, 1].map(|i| dot(&rows[i], &x))));
        assert_eq!(CrossMoments::of(samples).combined(&rows), direct);
    }

    #[test]
    fn effective_samples_are_counted_as_they_carry_the_sum() {
        let sample = |n| [3.0, if n == 50 { 1e6 } else { 1e-3 }];
        let moments = CrossMoments::of((0..100).map(sample));
        assert!(close(moments.effective_samples(0), 100.0));
        assert!((moments.effective_samples(1) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn batches_do_not_depend_on_how_samples_are_grouped() {
        // Integers, so that every order of summation gives the same bits.
        let samples: Vec<[f64; 2]> =
            (0..700).map(|n| [f64::from(n), f64::from(n * n % 97)]).collect();
        let grouped = |size: usize| {
            let mut all = CrossMoments::new(2);
            for group in samples.chunks(size) {
                all.merge(&CrossMoments::of(group.iter().copied()));
            }
            all
        };
        let one = grouped(700);
        assert_eq!(one.batches().map(|(count, _)| count).sum::<u64>(), 700);
        let (count, sums) = one.batches().nth(100).unwrap();
        assert_eq!((count, sums[0]), (3, 100.0 + 356.0 + 612.0));
        assert_eq!(one.batches().nth(200).unwrap().0, 2);
        for size in [1, 3, 128, 255, 256, 257, 300] {
            assert_eq!(grouped(size), one, "{size}");
        }
        assert_eq!(CrossMoments::new(2).batches().count(), 0);
    }
}
