//! Are the increments normal, independent, and truncated as the theory says?
//!
//! Every check compares a standardised statistic with a two-sided critical value, and every check
//! has a twin: noise that is wrong on purpose and must be rejected by it. The false alarms of the
//! whole file, all seeds together, have probability at most [`FALSE_ALARM`] under the hypothesis of
//! perfect noise: Bonferroni over [`CHECKS`].

use noise::{StreamKey, Truncation, WienerPath, WienerRows, clip};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use real::{Block, WIDTH};
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

/// Probability that perfect noise fails anywhere in this file.
const FALSE_ALARM: f64 = 1e-4;
/// Upper bound of the number of checks: 9 of a sample and 3 of the truncation for each key, and one
/// between keys.
const CHECKS: usize = 13 * KEYS.len();

const KEYS: [StreamKey; 4] = [key(1, 1), key(2, 1), key(1, 2), key(0, 0)];

const fn key(seed: u64, experiment: u64) -> StreamKey {
    StreamKey { seed, experiment }
}

/// Steps of each of the 32 paths, two noises: 2²⁰ normals a sample. The fourth moment of a sum of
/// twelve uniforms, 2.9, is then 10 standard deviations from 3, twice the critical value.
const STEPS: usize = 1 << 14;

/// Normals of two noises; `noise[m][p][n]` is path p, step n.
struct Sample {
    noise: [Vec<Vec<f64>>; 2],
}

impl Sample {
    fn draw(key: StreamKey) -> Self {
        let mut noise = [(); 2].map(|()| vec![Vec::new(); WIDTH]);
        let mut block = WienerRows::new(key, 0);
        let mut dw = Block::<2>::zero();
        for _ in 0..STEPS {
            block.increments(1.0, &mut dw.0);
            for m in 0..2 {
                for p in 0..WIDTH {
                    noise[m][p].push(dw.0[m][p]);
                }
            }
        }
        Self { noise }
    }

    /// Every normal replaced by `f` of it.
    fn map(mut self, mut f: impl FnMut(f64) -> f64) -> Self {
        self.noise.iter_mut().flatten().flatten().for_each(|x| *x = f(*x));
        self
    }

    fn values(&self) -> impl Iterator<Item = f64> + Clone {
        self.noise.iter().flatten().flatten().copied()
    }

    fn paths(&self) -> impl Iterator<Item = &Vec<f64>> + Clone {
        self.noise.iter().flatten()
    }
}

/// A statistic that is close to N(0, 1), or bounded in probability, and the value that it exceeds
/// with probability [`FALSE_ALARM`]/[`CHECKS`] under the hypothesis.
struct Check {
    statistic: f64,
    critical: f64,
}

impl Check {
    fn rejects(&self) -> bool {
        // A NaN is a rejection.
        !matches!(self.statistic.abs().partial_cmp(&self.critical), Some(std::cmp::Ordering::Less))
    }

    /// Σ f(x)/√(n var) for terms with mean 0 under the hypothesis. The critical value is the normal
    /// quantile with the corrections of Cornish and Fisher for the skewness and the excess of one
    /// term.
    fn of_sum(terms: impl Iterator<Item = f64>, variance: f64, skewness: f64, excess: f64) -> Self {
        let (mut n, mut sum) = (0.0, 0.0);
        for term in terms {
            n += 1.0;
            sum += term;
        }
        let z = Normal::standard().inverse_cdf(1.0 - 0.5 * FALSE_ALARM / CHECKS as f64);
        let corrections = skewness.abs() / f64::sqrt(n) * (z * z - 1.0) / 6.0
            + excess / n * (z * z - 3.0) * z / 24.0;
        Self { statistic: sum / f64::sqrt(n * variance), critical: z + corrections }
    }

    /// Σ xy/√n: variance 1, skewness 0, fourth moment 9.
    fn of_correlation(pairs: impl Iterator<Item = (f64, f64)>) -> Self {
        Self::of_sum(pairs.map(|(x, y)| x * y), 1.0, 0.0, 6.0)
    }
}

fn mean(sample: &Sample) -> Check {
    Check::of_sum(sample.values(), 1.0, 0.0, 0.0)
}

/// x² − 1 has variance 2, skewness √8 and excess 12, as χ² with one degree of freedom has.
fn variance(sample: &Sample) -> Check {
    let terms = sample.values().map(|x| x * x - 1.0);
    Check::of_sum(terms, 2.0, 8f64.sqrt(), 12.0)
}

/// x⁴ − 3 with the moments E x⁸ = 105, E x¹² = 10 395 and E x¹⁶ = 2 027 025.
fn fourth_moment(sample: &Sample) -> Check {
    let variance: f64 = 105.0 - 9.0;
    let third = 10_395.0 - 9.0 * 105.0 + 27.0 * 3.0 - 27.0;
    let fourth = 2_027_025.0 - 12.0 * 10_395.0 + 54.0 * 105.0 - 108.0 * 3.0 + 81.0;
    Check::of_sum(
        sample.values().map(|x| x.powi(4) - 3.0),
        variance,
        third / variance.powf(1.5),
        fourth / (variance * variance) - 3.0,
    )
}

/// √n sup|Fₙ − F|: exceeds x with probability at most 2e^{−2x²} for every n (Massart 1990).
fn kolmogorov_smirnov(sample: &Sample) -> Check {
    let mut sorted: Vec<f64> = sample.values().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let normal = Normal::standard();
    let distance = sorted.iter().enumerate().fold(0.0, |distance, (i, &x)| {
        let f = normal.cdf(x);
        f64::max(distance, f64::max(f - i as f64 / n, (i + 1) as f64 / n - f))
    });
    Check {
        statistic: n.sqrt() * distance,
        critical: (0.5 * (2.0 * CHECKS as f64 / FALSE_ALARM).ln()).sqrt(),
    }
}

fn between_noises(sample: &Sample) -> Check {
    let [first, second] = &sample.noise;
    let pairs = first.iter().flatten().zip(second.iter().flatten());
    Check::of_correlation(pairs.map(|(&x, &y)| (x, y)))
}

/// Noise 2 of a step with noise 1 of the next: seen when one stream feeds both a step apart.
fn between_noises_a_step_apart(sample: &Sample) -> Check {
    let [first, second] = &sample.noise;
    let paths = first.iter().zip(second);
    Check::of_correlation(paths.flat_map(|(x, y)| y.iter().zip(&x[1..]).map(|(&y, &x)| (x, y))))
}

/// (x² − 1)(y² − 1)/2 of the two normals of one Box–Muller pair, which share their radius: variance
/// 1, skewness (8/2^{3/2})² = 8, fourth moment 60²/16.
fn between_squares(sample: &Sample) -> Check {
    let [first, second] = &sample.noise;
    let pairs = first.iter().flatten().zip(second.iter().flatten());
    let terms = pairs.map(|(&x, &y)| 0.5 * (x * x - 1.0) * (y * y - 1.0));
    Check::of_sum(terms, 1.0, 8.0, 222.0)
}

fn between_steps(sample: &Sample) -> Check {
    Check::of_correlation(
        sample.paths().flat_map(|path| path.iter().zip(&path[1..]).map(|(&x, &y)| (x, y))),
    )
}

fn between_paths(sample: &Sample) -> Check {
    let neighbours = sample.noise.iter().flat_map(|noise| noise.iter().zip(&noise[1..]));
    Check::of_correlation(
        neighbours.flat_map(|(one, next)| one.iter().zip(next).map(|(&x, &y)| (x, y))),
    )
}

/// A check by its name.
type Named = (&'static str, fn(&Sample) -> Check);

const OF_A_SAMPLE: [Named; 9] = [
    ("mean", mean),
    ("variance", variance),
    ("fourth moment", fourth_moment),
    ("Kolmogorov-Smirnov", kolmogorov_smirnov),
    ("between noises", between_noises),
    ("between noises a step apart", between_noises_a_step_apart),
    ("between squares", between_squares),
    ("between steps", between_steps),
    ("between paths", between_paths),
];

#[test]
fn increments_are_independent_normals() {
    for key in KEYS {
        let sample = Sample::draw(key);
        for (name, check) in OF_A_SAMPLE {
            let check = check(&sample);
            assert!(!check.rejects(), "{name} of {key:?}: {}", check.statistic);
        }
    }
}

#[test]
fn two_keys_are_independent() {
    for pair in 0..KEYS.len() {
        let (one, other) = (KEYS[pair], KEYS[(pair + 1) % KEYS.len()]);
        let (one, other) = (Sample::draw(one), Sample::draw(other));
        let check = Check::of_correlation(one.values().zip(other.values()));
        assert!(!check.rejects(), "{pair}: {}", check.statistic);
        // The twin: an experiment that reuses the streams of another.
        let check = Check::of_correlation(one.values().zip(Sample::draw(KEYS[pair]).values()));
        assert!(check.rejects());
    }
}

/// Asserts that each of the named checks rejects.
fn must_reject(twin: &str, sample: &Sample, names: &[&str]) {
    for &wanted in names {
        let (_, check) = OF_A_SAMPLE.into_iter().find(|&(name, _)| name == wanted).unwrap();
        assert!(check(sample).rejects(), "{wanted} does not reject {twin}");
    }
}

#[test]
fn wrong_distributions_are_rejected() {
    for key in KEYS {
        // A mean off by 1/64 is 16 standard deviations at 2²⁰ normals.
        let shifted = Sample::draw(key).map(|x| x + 1.0 / 64.0);
        must_reject("a shift", &shifted, &["mean", "Kolmogorov-Smirnov"]);

        let wide = Sample::draw(key).map(|x| x * 1.01);
        must_reject("a scale", &wide, &["variance", "fourth moment"]);

        let clipped = Sample::draw(key).map(|x| x.clamp(-2.0, 2.0));
        must_reject(
            "normals truncated at 2",
            &clipped,
            &["variance", "fourth moment", "Kolmogorov-Smirnov"],
        );

        let mut generator = Xoshiro256PlusPlus::seed_from_u64(key.path_seed(0));
        let mut uniform = || (generator.next_u64() >> 11) as f64 * 2f64.powi(-53);
        let twelve = Sample::draw(key).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0);
        must_reject("a sum of twelve uniforms", &twelve, &["fourth moment"]);
    }
}

#[test]
fn wrong_dependence_is_rejected() {
    for key in KEYS {
        let mut one_stream = Sample::draw(key);
        one_stream.noise[1] = one_stream.noise[0].clone();
        must_reject(
            "two noises fed by one stream",
            &one_stream,
            &["between noises", "between squares"],
        );

        let mut late = Sample::draw(key);
        for p in 0..WIDTH {
            late.noise[1][p] = late.noise[0][p][1..].to_vec();
            late.noise[1][p].push(0.0);
        }
        must_reject("one stream a step apart", &late, &["between noises a step apart"]);

        // A radius shared by more than one pair: uncorrelated, normal one by one, dependent.
        let mut signed = Sample::draw(key);
        for p in 0..WIDTH {
            for n in 0..STEPS {
                let sign = signed.noise[1][p][n].signum();
                signed.noise[1][p][n] = sign * signed.noise[0][p][n];
            }
        }
        must_reject("a shared size", &signed, &["between squares"]);

        let mut remembered = 0.0;
        let rho: f64 = 0.01;
        let autoregressive = Sample::draw(key).map(|x| {
            remembered = rho * remembered + (1.0 - rho * rho).sqrt() * x;
            remembered
        });
        must_reject("a memory of 1 %", &autoregressive, &["between steps"]);

        // Paths numbered by halves, so that neighbours share their stream.
        let halves: Vec<Vec<f64>> = (0..WIDTH as u64)
            .map(|p| {
                let mut path = WienerPath::<1>::new(key, p / 2);
                (0..STEPS).map(|_| path.normal()).collect()
            })
            .collect();
        let shared = Sample { noise: [halves.clone(), halves] };
        must_reject("shared streams", &shared, &["between paths"]);
    }
}

/// E[ΔW²] − E[ΔŴ²] = 2τ[(1 − A²)Q(A) + Aφ(A)] with A = √(2k|log τ|), Q = 1 − Φ.
fn truncation_defect(k: u32, tau: f64) -> f64 {
    let normal = Normal::standard();
    let a = (2.0 * f64::from(k) * tau.ln().abs()).sqrt();
    2.0 * tau * ((1.0 - a * a) * normal.sf(a) + a * normal.pdf(a))
}

/// The measured defect against a claimed one, in standard errors of the paired differences.
fn compare_defect(key: StreamKey, tau: f64, claimed: f64) -> Check {
    let bound = Truncation::new(1).unwrap().bound(tau).unwrap();
    let sample = Sample::draw(key);
    let mut differences = Vec::new();
    for n in 0..STEPS {
        let (mut dw, mut clipped) = (Block::<2>::zero(), Block::<2>::zero());
        for m in 0..2 {
            for p in 0..WIDTH {
                dw.0[m][p] = sample.noise[m][p][n] * tau.sqrt();
            }
        }
        clip(&dw.0, bound, &mut clipped.0);
        for (w, c) in dw.0.iter().flatten().zip(clipped.0.iter().flatten()) {
            differences.push(w * w - c * c - claimed);
        }
    }
    let n = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / n;
    let moment = |p| differences.iter().map(|d| (d - mean).powi(p)).sum::<f64>() / n;
    let (variance, third, fourth) = (moment(2), moment(3), moment(4));
    Check::of_sum(
        differences.into_iter(),
        variance,
        third / variance.powf(1.5),
        fourth / (variance * variance) - 3.0,
    )
}

#[test]
fn truncation_takes_away_the_variance_of_the_closed_form() {
    for key in KEYS {
        for tau in [0.5, 0.25, 1.0 / 16.0] {
            let claimed = truncation_defect(1, tau);
            let check = compare_defect(key, tau, claimed);
            assert!(!check.rejects(), "{tau}: {}", check.statistic);
            // The twins: one tail only, and the threshold of k = 2.
            assert!(compare_defect(key, tau, 0.5 * claimed).rejects());
            assert!(compare_defect(key, tau, truncation_defect(2, tau)).rejects());
        }
    }
}
