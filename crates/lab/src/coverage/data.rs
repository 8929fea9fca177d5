//! Data whose law is known: squared errors of a given order, and geometric Brownian motion with its
//! exact solution.

use noise::{StreamKey, WienerBlock, WienerPath};
use real::{Block, WIDTH};
use stats::CrossMoments;

/// Squared errors C τ^{2p}(1 + bτ)(1 − c τ_ref/τ)Z² of paths, with Z normal and most of its
/// variance shared between the levels of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Synthetic {
    pub order: f64,
    /// b.
    pub curvature: f64,
    /// τ_ref, with c = 1.
    pub reference: Option<f64>,
    pub outliers: Option<Outliers>,
    /// Factor of the squares at every other step size: with another one than 1, no power law.
    pub uneven: f64,
    pub paths: u64,
}

/// Share of the variance of Z that the levels of a path have in common: their squares then have the
/// correlation 0.64, as errors at neighbouring steps have.
const SHARED: f64 = 0.8;

/// Some paths have larger errors on the coarse levels, as those have whose increments are clipped.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outliers {
    /// One path in this many.
    pub one_in: f64,
    /// Factor of the error.
    pub factor: f64,
    /// How many of the coarsest levels are hit.
    pub levels: usize,
}

impl Synthetic {
    pub(super) const fn new(order: f64) -> Self {
        Self { order, curvature: 0.0, reference: None, outliers: None, uneven: 1.0, paths: 400 }
    }

    /// Mean square of the error at a level.
    pub(super) fn mean_square(&self, taus: &[f64], level: usize) -> f64 {
        let hit = self.outliers.filter(|outliers| level < outliers.levels);
        self.scales(taus)[level]
            * hit.map_or(1.0, |hit| 1.0 + (hit.factor * hit.factor - 1.0) / hit.one_in)
    }

    fn scales(&self, taus: &[f64]) -> Vec<f64> {
        let scale =
            |(l, &tau): (usize, &f64)| self.scale(tau) * if l % 2 == 1 { self.uneven } else { 1.0 };
        taus.iter().enumerate().map(scale).collect()
    }

    fn scale(&self, tau: f64) -> f64 {
        let reference = self.reference.map_or(0.0, |reference| reference / tau);
        tau.powf(2.0 * self.order) * (1.0 + self.curvature * tau) * (1.0 - reference)
    }

    pub(super) fn squares(&self, taus: &[f64], key: StreamKey) -> CrossMoments {
        let scales = self.scales(taus);
        let mut squares = CrossMoments::new(taus.len());
        let mut errors = vec![0.0; taus.len()];
        for path in 0..self.paths {
            let mut noise = WienerPath::<1>::new(key, path);
            let shared = noise.normal();
            for (error, scale) in errors.iter_mut().zip(&scales) {
                *error = scale
                    * (SHARED.sqrt() * shared + (1.0 - SHARED).sqrt() * noise.normal()).powi(2);
            }
            if let Some(Outliers { one_in, factor, levels }) = self.outliers {
                // For two independent normals exp(−(x² + y²)/2) is uniform.
                let (x, y) = (noise.normal(), noise.normal());
                if (-0.5 * (x * x + y * y)).exp() < 1.0 / one_in {
                    errors[..levels].iter_mut().for_each(|error| *error *= factor * factor);
                }
            }
            squares.add(&errors);
        }
        squares
    }
}

/// dX = aX dt + bX dW (Itô) on [0, 1] with X(0) = 1, solved by Euler–Maruyama and known exactly:
/// X(1) = exp(a − b²/2 + bW(1)).
#[derive(Clone, Copy, Debug)]
pub(super) struct Geometric {
    pub drift: f64,
    pub volatility: f64,
    /// Adds ½b²(ΔW² − τ) to the factor of a step: the Milstein scheme, of strong order one.
    pub milstein: bool,
    /// Steps 2^−first … 2^−last.
    pub first: u32,
    pub last: u32,
    pub paths: u64,
}

impl Geometric {
    pub(super) fn taus(&self) -> Vec<f64> {
        (self.first..=self.last).map(|exponent| 0.5f64.powi(exponent as i32)).collect()
    }

    /// E|X_N − X(1)|² with τ = 1/N. With A the factor of one numerical and G that of one exact
    /// step, E[A²]ᴺ − 2E[AG]ᴺ + E[G²]ᴺ, where E[A²] = (1 + aτ)² + b²τ (+ ½b⁴τ²), E[AG] = e^{aτ}(1 +
    /// aτ + b²τ (+ ½b⁴τ²)) and E[G²] = e^{(2a + b²)τ}.
    pub(super) fn mean_square(&self, tau: f64) -> f64 {
        let (a, b2) = (self.drift, self.volatility * self.volatility);
        let more = if self.milstein { 0.5 * b2 * b2 * tau * tau } else { 0.0 };
        let numerical = (1.0 + a * tau).powi(2) + b2 * tau + more;
        let mixed = (a * tau).exp() * (1.0 + a * tau + b2 * tau + more);
        let exact = ((2.0 * a + b2) * tau).exp();
        let steps = (1.0 / tau).round() as i32;
        numerical.powi(steps) - 2.0 * mixed.powi(steps) + exact.powi(steps)
    }

    /// E[X_N] − E[X(1)] = (1 + aτ)ᴺ − eᵃ.
    pub(super) fn weak_error(&self, tau: f64) -> f64 {
        (1.0 + self.drift * tau).powi((1.0 / tau).round() as i32) - self.drift.exp()
    }

    /// Calls `each` with the numerical solutions at time 1, coarsest first, and the exact one, for
    /// every path.
    pub(super) fn for_each_path(&self, key: StreamKey, mut each: impl FnMut(&[f64], f64)) {
        let levels = (self.last - self.first) as usize + 1;
        let steps = 1u64 << self.last;
        let tau = 1.0 / steps as f64;
        let (a, b) = (self.drift, self.volatility);
        let correction = if self.milstein { 0.5 * b * b } else { 0.0 };
        for first_path in (0..self.paths).step_by(WIDTH) {
            let mut noise = WienerBlock::<1>::new(key, first_path);
            let mut dw = Block::<1>::zero();
            // Index 0 is the finest level here.
            let mut states = vec![[1.0; WIDTH]; levels];
            let mut sums = vec![[0.0; WIDTH]; levels];
            let mut total = [0.0; WIDTH];
            for n in 1..=steps {
                noise.increments(tau.sqrt(), &mut dw);
                let mut increment = dw.0[0];
                for p in 0..WIDTH {
                    total[p] += increment[p];
                }
                for level in 0..levels {
                    let tau = tau * (1u64 << level) as f64;
                    for p in 0..WIDTH {
                        let w = sums[level][p] + increment[p];
                        increment[p] = w;
                        states[level][p] *= 1.0 + a * tau + b * w + correction * (w * w - tau);
                    }
                    sums[level] = [0.0; WIDTH];
                    if n % (2 << level) != 0 {
                        if level + 1 < levels {
                            for p in 0..WIDTH {
                                sums[level + 1][p] += increment[p];
                            }
                        }
                        break;
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

    #[test]
    fn closed_forms_of_geometric_brownian_motion() {
        // Means over many paths against the closed forms, in standard errors; 4.5 of them fail with
        // probability 1e-5.
        for milstein in [false, true] {
            let motion = Geometric {
                drift: 0.4,
                volatility: 0.3,
                milstein,
                first: 1,
                last: 5,
                paths: 40_000,
            };
            let mut moments = CrossMoments::new(10);
            motion.for_each_path(StreamKey { seed: 5, experiment: 1 }, |solutions, exact| {
                let errors = solutions.iter().map(|solution| solution - exact);
                let both: Vec<f64> =
                    errors.clone().map(|error| error * error).chain(errors).collect();
                moments.add(&both);
            });
            for (l, &tau) in motion.taus().iter().enumerate() {
                for (component, expected) in
                    [(l, motion.mean_square(tau)), (5 + l, motion.weak_error(tau))]
                {
                    let se = moments.covariance_of_means(component, component).sqrt();
                    let deviation = (moments.mean(component) - expected) / se;
                    assert!(deviation.abs() < 4.5, "{milstein} {tau} {component}: {deviation}");
                }
            }
        }
    }
}
