//! Are the increments normal, independent, and truncated as the theory says?
//!
//! Every check has a twin: noise that is wrong on purpose and must be rejected by it.

use noise::{StepNoise, StreamKey, Truncation, WienerPath, WienerRows, clip};
use rand::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;
use real::WIDTH;
use statrs::distribution::{Continuous, ContinuousCDF, Normal};

use crate::statistical::check::{Verdict, kolmogorov_smirnov, of_sum};

const KEYS: [StreamKey; 4] = [key(1, 1), key(2, 1), key(1, 2), key(0, 0)];

const fn key(seed: u64, experiment: u64) -> StreamKey {
    StreamKey { seed, experiment }
}

/// Steps of each of the 32 paths, two noises: 2²⁰ normals a sample. The fourth moment of a sum of
/// twelve uniforms, 2.9, is then 10 standard deviations from 3, twice the critical value.
const STEPS: usize = 1 << 14;

/// Normals of two noises; `noise[m][p][n]` is path p, step n.
#[derive(Clone)]
struct Sample {
    noise: [Vec<Vec<f64>>; 2],
}

impl Sample {
    fn draw(key: StreamKey) -> Self {
        let mut noise = [(); 2].map(|()| vec![Vec::new(); WIDTH]);
        let (mut wiener, mut dw) = (WienerRows::new(key, 0), StepNoise::zero(2));
        for _ in 0..STEPS {
            wiener.increments(1.0, &mut dw.increments);
            for (paths, row) in noise.iter_mut().zip(dw.increments.iter()) {
                paths.iter_mut().zip(row).for_each(|(path, &w)| path.push(w));
            }
        }
        Self { noise }
    }

    /// Every normal replaced by `f` of it.
    fn map(&self, mut f: impl FnMut(f64) -> f64) -> Self {
        let mut sample = self.clone();
        sample.noise.iter_mut().flatten().flatten().for_each(|x| *x = f(*x));
        sample
    }

    fn values(&self) -> impl Iterator<Item = f64> + Clone {
        self.noise.iter().flatten().flatten().copied()
    }

    /// The two normals of one Box–Muller pair.
    fn pairs(&self) -> impl Iterator<Item = (&f64, &f64)> {
        self.noise[0].iter().flatten().zip(self.noise[1].iter().flatten())
    }
}

/// Independent standard normals have the correlation zero.
fn uncorrelated<'a>(pairs: impl Iterator<Item = (&'a f64, &'a f64)>) -> Verdict {
    of_sum(pairs.map(|(x, y)| x * y))
}

/// A check by its name.
type Named = (&'static str, fn(&Sample) -> Verdict);

const OF_A_SAMPLE: [Named; 9] = [
    ("mean", |sample| of_sum(sample.values())),
    ("variance", |sample| of_sum(sample.values().map(|x| x * x - 1.0))),
    ("fourth moment", |sample| of_sum(sample.values().map(|x| x.powi(4) - 3.0))),
    ("Kolmogorov-Smirnov", |sample| {
        let normal = Normal::standard();
        kolmogorov_smirnov(sample.values().collect(), |x| normal.cdf(x))
    }),
    ("between noises", |sample| uncorrelated(sample.pairs())),
    // Noise 2 of a step with noise 1 of the next: seen when one stream feeds both a step apart.
    ("between noises a step apart", |sample| {
        let paths = sample.noise[0].iter().zip(&sample.noise[1]);
        uncorrelated(paths.flat_map(|(x, y)| y.iter().zip(&x[1..])))
    }),
    // Of a pair, which shares its radius.
    ("between squares", |sample| {
        of_sum(sample.pairs().map(|(x, y)| (x * x - 1.0) * (y * y - 1.0)))
    }),
    ("between steps", |sample| {
        uncorrelated(sample.noise.iter().flatten().flat_map(|path| path.iter().zip(&path[1..])))
    }),
    ("between paths", |sample| {
        let neighbours = sample.noise.iter().flat_map(|noise| noise.iter().zip(&noise[1..]));
        uncorrelated(neighbours.flat_map(|(one, next)| one.iter().zip(next)))
    }),
];

#[test]
fn two_keys_are_independent() {
    let samples = KEYS.map(Sample::draw);
    let compared = |one: usize, other: usize| {
        of_sum(samples[one].values().zip(samples[other].values()).map(|(x, y)| x * y))
    };
    for pair in 0..KEYS.len() {
        assert_eq!(compared(pair, (pair + 1) % KEYS.len()), Ok(()), "{pair}");
        // The twin: an experiment that reuses the streams of another.
        assert!(compared(pair, pair).is_err());
    }
}

/// Asserts that each of the named checks rejects.
fn must_reject(twin: &str, sample: &Sample, names: &[&str]) {
    for &wanted in names {
        let (_, check) = OF_A_SAMPLE.into_iter().find(|&(name, _)| name == wanted).unwrap();
        assert!(check(sample).is_err(), "{wanted} does not reject {twin}");
    }
}

#[test]
fn increments_are_independent_normals() {
    for key in KEYS {
        let sample = Sample::draw(key);
        for (name, check) in OF_A_SAMPLE {
            assert_eq!(check(&sample), Ok(()), "{name} of {key:?}");
        }

        // A mean off by 1/64 is 16 standard deviations at 2²⁰ normals.
        let shifted = sample.map(|x| x + 1.0 / 64.0);
        must_reject("a shift", &shifted, &["mean", "Kolmogorov-Smirnov"]);
        let wide = sample.map(|x| x * 1.01);
        must_reject("a scale", &wide, &["variance", "fourth moment"]);
        let clipped = sample.map(|x| x.clamp(-2.0, 2.0));
        let names = ["variance", "fourth moment", "Kolmogorov-Smirnov"];
        must_reject("normals truncated at 2", &clipped, &names);
        let mut generator = Xoshiro256PlusPlus::seed_from_u64(key.path_seed(0));
        let mut uniform = || (generator.next_u64() >> 11) as f64 * 2f64.powi(-53);
        let twelve = sample.map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0);
        must_reject("a sum of twelve uniforms", &twelve, &["fourth moment"]);

        let [first, second] = &sample.noise;
        let with_second = |noise| Sample { noise: [first.clone(), noise] };
        let one_stream = with_second(first.clone());
        must_reject("one stream for two", &one_stream, &["between noises", "between squares"]);
        let late = |path: &Vec<f64>| [&path[1..], &[0.0]].concat();
        let late = with_second(first.iter().map(late).collect());
        must_reject("one stream a step apart", &late, &["between noises a step apart"]);
        // A radius shared by more than one pair: uncorrelated, normal one by one, dependent.
        let signed =
            |(x, y): (&Vec<f64>, &Vec<f64>)| x.iter().zip(y).map(|(x, y)| y.signum() * x).collect();
        let signed = with_second(first.iter().zip(second).map(signed).collect());
        must_reject("a shared size", &signed, &["between squares"]);

        let mut remembered = 0.0;
        let rho: f64 = 0.01;
        let autoregressive = sample.map(|x| {
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

#[test]
fn truncation_takes_away_the_variance_of_the_closed_form() {
    for key in KEYS {
        for tau in [0.5, 0.25, 1.0 / 16.0] {
            let bound = Truncation::new(1).unwrap().bound(tau).unwrap();
            let (mut wiener, mut dw) = (WienerRows::new(key, 0), StepNoise::zero(2));
            let mut clipped = [[0.0; WIDTH]; 2];
            let mut defects = Vec::new();
            for _ in 0..STEPS {
                wiener.increments(tau.sqrt(), &mut dw.increments);
                clip(&dw.increments, bound, &mut clipped);
                let pairs = dw.increments.as_flattened().iter().zip(clipped.as_flattened());
                defects.extend(pairs.map(|(w, c)| w * w - c * c));
            }
            let compared = |claimed| of_sum(defects.iter().map(|defect| defect - claimed));
            let claimed = truncation_defect(1, tau);
            assert_eq!(compared(claimed), Ok(()), "{tau}");
            // The twins: one tail only, and the threshold of k = 2.
            assert!(compared(0.5 * claimed).is_err());
            assert!(compared(truncation_defect(2, tau)).is_err());
        }
    }
}
