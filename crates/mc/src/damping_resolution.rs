//! Resolution of the damping by the steps of a scheme.
//!
//! A scheme reads the rate γ at the ends and in the middle of a step, or the integral given over
//! its halves. A rate that oscillates or has a pulse within the steps is missed by all step sizes
//! alike, and no comparison of paths shows it. The sums over the steps of each of these readings
//! show it: they differ from ∫γ by quadrature, and by more than a step times the changes of the
//! rate from step to step, which is what a slope or a jump gives. A pulse that is narrower than the
//! quadrature is known to a closed integral alone, which is compared for every scheme.

use nonlin::BlockStatus;
use real::Rows;
use schemes::Step;
use stats::worse;
use systems::{Damping, probe::rate_integrals};

use crate::Setup;

/// Largest number of times at which sums are compared with ∫γ.
const MAX_TIMES: u64 = 1024;
/// Least number of parts of the quadrature.
const MIN_PARTS: u64 = 256;
/// Number of steps from which on steps are not halved for a sum: it takes a second.
const MAX_STEPS: u64 = 1 << 24;
/// Relative error of the quadrature.
const QUADRATURE: f64 = 1e-12;
/// Largest defect of a sum over a step times the changes of the rate: one by a jump anywhere in a
/// step, and room for what turns within steps.
const MOST: f64 = 2.0;
/// Largest defect of a sum in any case: above it e^{−∫γ} is wrong by two thirds.
const LARGEST: f64 = 0.5;

/// Resolution of the damping of a problem, and of its friction, by the steps of a scheme.
pub struct DampingResolution<'a>(Vec<Resolution<'a>>);

/// Resolution of one damping.
struct Resolution<'a> {
    damping: &'a dyn Damping,
    /// Whether the scheme reads rates.
    reads_rates: bool,
    t_end: f64,
    coarsest_steps: u64,
    /// Integrals ∫₀ᵗγ at the times kT/n.
    exact: Vec<f64>,
    /// Integrals ∫|γ| over the parts of the quadrature, which are equal.
    sizes: Vec<f64>,
}

impl<'a> DampingResolution<'a> {
    /// Resolution by `coarsest_steps` steps on [0, T] and by halvings of them.
    pub fn new(setup: &Setup<'a>, coarsest_steps: u64) -> Self {
        let t_end = setup.problem.t_end;
        let of = |(k, damping)| {
            // Friction is exact in every scheme.
            let reads_rates = k == 0 && reads_rates(setup, t_end / coarsest_steps as f64);
            Resolution::new(damping, reads_rates, t_end, coarsest_steps)
        };
        Self(setup.problem.dampings().enumerate().map(of).collect())
    }

    /// The largest ∫|γ| that each of three steps in a row has, nearly, for the coarsest steps
    /// halved `halvings` times. Above one, steps forget what noise and forces do in their first
    /// halves. A pulse within a step or two is none of this: it concerns a part of the time that
    /// vanishes.
    pub fn lasting_exponent(&self, halvings: usize) -> f64 {
        self.0.iter().map(|one| one.lasting_exponent(halvings)).fold(0.0, f64::max)
    }

    /// Largest defect of the damping, if coarsest steps that are halved `halvings` times do not
    /// resolve it; else `None`.
    ///
    /// A defect is the distance from ∫₀ᵗγ of a sum that the scheme sees, or of the integrals given;
    /// the largest is over times t.
    pub fn unresolved(&self, halvings: usize) -> Option<f64> {
        self.0.iter().filter_map(|one| one.unresolved(halvings)).reduce(worse)
    }
}

impl<'a> Resolution<'a> {
    fn new(damping: &'a dyn Damping, reads_rates: bool, t_end: f64, coarsest_steps: u64) -> Self {
        let mut times = coarsest_steps.max(1);
        while times > MAX_TIMES {
            times = if times.is_multiple_of(2) { times / 2 } else { 1 };
        }
        let per_time = MIN_PARTS.div_ceil(times);
        let (parts, _) = rate_integrals(damping, t_end, (times * per_time) as u32);
        let mut sum = 0.0;
        let exact = parts.chunks(per_time as usize).map(|parts| {
            sum += parts.iter().map(|part| part.net).sum::<f64>();
            sum
        });
        let (exact, sizes) = (exact.collect(), parts.iter().map(|part| part.size).collect());
        Self { damping, reads_rates, t_end, coarsest_steps, exact, sizes }
    }

    fn lasting_exponent(&self, halvings: usize) -> f64 {
        let steps = self.coarsest_steps as f64 * (1u64 << halvings) as f64;
        let parts = self.sizes.len() as f64 / steps;
        let chunks = self.sizes.chunks(parts.max(1.0) as usize);
        let sums: Vec<f64> = chunks.map(|chunk| chunk.iter().sum()).collect();
        let row = if parts < 1.0 { 1 } else { sums.len().min(3) };
        let least = |row: &[f64]| row.iter().copied().fold(f64::INFINITY, f64::min);
        sums.windows(row).map(least).fold(0.0, f64::max) * parts.min(1.0)
    }

    fn unresolved(&self, halvings: usize) -> Option<f64> {
        let double = |steps, _| if steps < MAX_STEPS { 2 * steps } else { steps };
        let steps = (0..halvings).fold(self.coarsest_steps, double);
        let (tau, per_time) = (self.t_end / steps as f64, steps / self.exact.len() as u64);
        let (mut sums, mut changes, mut defect) = ([0.0; 4], 0.0, 0.0f64);
        for n in 0..steps {
            // The step size is positive and finite, or no path could run.
            let Ok(step) = Step::new(self.damping, n, tau) else { return Some(f64::NAN) };
            let Step { rate_at_start, rate_at_middle, rate_at_end, .. } = step;
            let integral = step.damping_integral();
            changes += (rate_at_end - rate_at_start).abs();
            let read = if self.reads_rates {
                [rate_at_start, rate_at_middle, rate_at_end].map(|rate| tau * rate)
            } else {
                [integral; 3]
            };
            sums.iter_mut()
                .zip(read.iter().chain([&integral]))
                .for_each(|(sum, term)| *sum += term);
            if (n + 1).is_multiple_of(per_time) {
                let exact = self.exact[(n / per_time) as usize];
                defect = sums.iter().map(|sum| (sum - exact).abs()).fold(defect, worse);
            }
        }
        // A sum of n terms rounds by nε of their sizes at most.
        let size: f64 = self.sizes.iter().sum();
        let round_off = (QUADRATURE + steps as f64 * f64::EPSILON) * size;
        let resolved = defect <= round_off.max(LARGEST.min(MOST * tau * changes + round_off));
        (!resolved).then_some(defect)
    }
}

/// Whether the scheme reads rates: whether its first step changes with them. If it seems to read
/// neither rates nor integrals, as at the origin, it may read both.
fn reads_rates(Setup { problem, scheme }: &Setup<'_>, tau: f64) -> bool {
    let noise = scheme.no_noise(problem.noises);
    let end = |rate: f64, integral: f64| {
        let step = Step::new(&Torn { rate, integral }, 0, tau).ok()?;
        let mut state = scheme.start(&Rows::splat(&problem.y0));
        state.step(&step, &noise, &mut BlockStatus::explicit());
        Some(state.state().iter().map(|row| row[0].to_bits()).collect::<Vec<_>>())
    };
    let plain = end(0.0, 0.0);
    // Large enough to change every digit, small enough that a step succeeds.
    end(0.01 / tau, 0.0) != plain || end(0.0, 0.01) == plain
}

/// A damping whose integrals are not those of its rate.
struct Torn {
    rate: f64,
    integral: f64,
}

impl Damping for Torn {
    fn rate(&self, _: f64) -> f64 {
        self.rate
    }
    fn integral(&self, _: f64, _: f64) -> f64 {
        self.integral
    }
    fn describe(&self) -> String {
        String::new()
    }
}
