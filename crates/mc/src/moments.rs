//! Means, variances and covariances from sums.
//!
//! Sums of squares lose digits only where the mean is many times the standard deviation; what is folded here are
//! errors and differences, whose mean is of the size of their spread or below.

/// Mean and variance of one quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moments {
    count: u64,
    sum: f64,
    sum_of_squares: f64,
}

impl Moments {
    /// Adds a sample.
    pub fn add(&mut self, x: f64) {
        self.count += 1;
        self.sum += x;
        self.sum_of_squares += x * x;
    }

    /// Adds all samples of `other`.
    pub fn merge(&mut self, other: Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.sum_of_squares += other.sum_of_squares;
    }

    /// Number of samples.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Sample mean; NaN without samples.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.sum / self.count as f64
    }

    /// Standard error of the mean; NaN with fewer than two samples.
    #[must_use]
    pub fn standard_error(&self) -> f64 {
        let n = self.count as f64;
        let variance = f64::max(self.sum_of_squares - self.sum * self.sum / n, 0.0) / (n - 1.0);
        (variance / n).sqrt()
    }
}

/// Means and covariances of a vector.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossMoments {
    count: u64,
    sum: Vec<f64>,
    /// Σ xᵢxⱼ for i ≤ j, row by row.
    products: Vec<f64>,
}

impl CrossMoments {
    /// No samples of a vector of the given length.
    #[must_use]
    pub fn new(length: usize) -> Self {
        Self { count: 0, sum: vec![0.0; length], products: vec![0.0; length * (length + 1) / 2] }
    }

    /// Adds a sample.
    ///
    /// # Panics
    /// If `x` has another length.
    pub fn add(&mut self, x: &[f64]) {
        assert_eq!(x.len(), self.sum.len(), "a sample has the length of the vector");
        self.count += 1;
        let mut products = self.products.iter_mut();
        for (i, &xi) in x.iter().enumerate() {
            self.sum[i] += xi;
            for (&xj, product) in x[i..].iter().zip(&mut products) {
                *product += xi * xj;
            }
        }
    }

    /// Adds all samples of `other`, which has the same length.
    pub fn merge(&mut self, other: &Self) {
        self.count += other.count;
        for (sum, &addend) in self.sum.iter_mut().zip(&other.sum) {
            *sum += addend;
        }
        for (product, &addend) in self.products.iter_mut().zip(&other.products) {
            *product += addend;
        }
    }

    /// Number of samples.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Length of the vector.
    #[must_use]
    pub fn length(&self) -> usize {
        self.sum.len()
    }

    /// Sample mean of component i; NaN without samples.
    #[must_use]
    pub fn mean(&self, i: usize) -> f64 {
        self.sum[i] / self.count as f64
    }

    /// Covariance of the sample *means* of components i and j: the sample covariance over the number of samples.
    #[must_use]
    pub fn covariance_of_means(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.min(j), i.max(j));
        let n = self.count as f64;
        let row = i * self.sum.len() - i * (i + 1) / 2;
        (self.products[row + j] - self.sum[i] * self.sum[j] / n) / (n - 1.0) / n
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_the_textbook_ones() {
        let samples = [[1.0, 2.0, 0.5], [3.0, -1.0, 0.5], [2.0, 4.0, 0.25], [5.0, 0.0, 8.0]];
        let (mut all, mut half) = (CrossMoments::new(3), CrossMoments::new(3));
        let mut single = Moments::default();
        for (n, x) in samples.iter().enumerate() {
            if n < 2 {
                all.add(x)
            } else {
                half.add(x)
            }
            single.add(x[2]);
        }
        all.merge(&half);
        assert_eq!((all.count(), all.mean(0), all.mean(1)), (4, 2.75, 1.25));
        for i in 0..3 {
            for j in 0..3 {
                let direct: f64 =
                    samples.iter().map(|x| (x[i] - all.mean(i)) * (x[j] - all.mean(j))).sum::<f64>() / 3.0 / 4.0;
                assert!((all.covariance_of_means(i, j) - direct).abs() < 1e-14, "{i} {j}");
            }
        }
        assert!((single.standard_error().powi(2) - all.covariance_of_means(2, 2)).abs() < 1e-14);
    }
}
