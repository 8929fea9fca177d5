//! Geometric Brownian motion with its exact solution.

use noise::{DyadicLadder, StreamKey, WienerBlock};
use real::{Block, WIDTH};

/// dX = aX dt + bX dW (Itô) on [0, 1] with X(0) = 1, solved by Euler–Maruyama and known exactly:
/// X(1) = exp(a − b²/2 + bW(1)).
#[derive(Clone, Copy)]
pub struct Geometric {
    pub drift: f64,
    pub volatility: f64,
    /// Steps 2^−first … 2^−last.
    pub first: u32,
    pub last: u32,
    pub paths: u64,
}

impl Geometric {
    pub fn taus(&self) -> Vec<f64> {
        (self.first..=self.last).map(|exponent| 0.5f64.powi(exponent as i32)).collect()
    }

    /// E[X_N] − E[X(1)] = (1 + aτ)ᴺ − eᵃ.
    pub fn weak_error(&self, tau: f64) -> f64 {
        (1.0 + self.drift * tau).powi((1.0 / tau).round() as i32) - self.drift.exp()
    }

    /// Calls `each` with the numerical solutions at time 1, coarsest first, and the exact one, for
    /// every path.
    pub fn for_each_path(&self, key: StreamKey, mut each: impl FnMut(&[f64], f64)) {
        let top = (self.last - self.first) as usize;
        let steps = 1u64 << self.last;
        let tau = 1.0 / steps as f64;
        let (a, b) = (self.drift, self.volatility);
        for first_path in (0..self.paths).step_by(WIDTH) {
            let mut noise = WienerBlock::<1>::new(key, first_path);
            let mut dw = Block::<1>::zero();
            let mut ladder = DyadicLadder::new(top);
            let mut total = [0.0; WIDTH];
            // Level 0 is the finest.
            let mut states = vec![[1.0; WIDTH]; top + 1];
            for _ in 0..steps {
                noise.increments(tau.sqrt(), &mut dw);
                for p in 0..WIDTH {
                    total[p] += dw.0[0][p];
                }
                for level in 0..=ladder.push(&dw) {
                    let tau = tau * (1u64 << level) as f64;
                    let w = ladder.increment(level).0[0];
                    for p in 0..WIDTH {
                        states[level][p] *= 1.0 + a * tau + b * w[p];
                    }
                }
            }
            for p in 0..WIDTH.min((self.paths - first_path) as usize) {
                let solutions: Vec<f64> = states.iter().rev().map(|state| state[p]).collect();
                each(&solutions, (a - 0.5 * b * b + b * total[p]).exp());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stats::CrossMoments;

    #[test]
    fn closed_forms_of_geometric_brownian_motion() {
        // Means over many paths against the closed forms, in standard errors; 4.5 of them fail with
        // probability 1e-5.
        let motion = Geometric { drift: 0.4, volatility: 0.3, first: 1, last: 5, paths: 40_000 };
        let mut moments = CrossMoments::new(5);
        motion.for_each_path(StreamKey { seed: 5, experiment: 1 }, |solutions, exact| {
            let errors: Vec<f64> = solutions.iter().map(|solution| solution - exact).collect();
            moments.add(&errors);
        });
        for (l, &tau) in motion.taus().iter().enumerate() {
            let se = moments.covariance_of_means(l, l).sqrt();
            let deviation = (moments.mean(l) - motion.weak_error(tau)) / se;
            assert!(deviation.abs() < 4.5, "{tau}: {deviation}");
        }
    }
}
