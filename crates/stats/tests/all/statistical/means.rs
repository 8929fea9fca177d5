//! How often intervals of means cover, for laws that are skewed, heavy or rare.

use rand_xoshiro::{
    Xoshiro256PlusPlus,
    rand_core::{Rng, SeedableRng},
};
use stats::{CentralMoments, two_sided};

/// Uniform on (0, 1).
pub struct Words(pub Xoshiro256PlusPlus);

impl Words {
    pub fn uniform(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 + 0.5) * 2f64.powi(-53)
    }

    pub fn exponential(&mut self) -> f64 {
        -self.uniform().ln()
    }

    pub fn normal(&mut self) -> f64 {
        (2.0 * self.exponential()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    pub fn student(&mut self, degrees: u32) -> f64 {
        let squares: f64 = (0..degrees).map(|_| self.normal().powi(2)).sum();
        self.normal() / (squares / f64::from(degrees)).sqrt()
    }

    pub fn event(&mut self, probability: f64) -> f64 {
        f64::from(u8::from(self.uniform() < probability))
    }
}

type Law = (&'static str, fn(&mut Words) -> f64, f64);

/// Laws with their means.
const LAWS: [Law; 16] = [
    ("normal", |w| w.normal(), 0.0),
    ("uniform", |w| w.uniform(), 0.5),
    ("exponential", |w| w.exponential(), 1.0),
    ("minus exponential", |w| -w.exponential(), -1.0),
    ("chi-square 1", |w| w.normal().powi(2), 1.0),
    ("lognormal 0.5", |w| (0.5 * w.normal()).exp(), 1.133_148_453_066_826_4),
    ("lognormal 1", |w| w.normal().exp(), 1.648_721_270_700_128_2),
    ("lognormal 1.5", |w| (1.5 * w.normal()).exp(), 3.080_216_848_918_031_4),
    ("student 3", |w| w.student(3), 0.0),
    ("fourth power", |w| w.normal().powi(4), 3.0),
    ("pareto 2.5", |w| w.uniform().powf(-0.4) - 1.0, 2.0 / 3.0),
    ("event 0.5", |w| w.event(0.5), 0.5),
    ("event 0.05", |w| w.event(0.05), 0.05),
    ("event 0.003", |w| w.event(0.003), 0.003),
    ("atom and 5 % exponential", |w| w.event(0.05) * w.exponential(), 0.05),
    ("atom and 1 % exponential", |w| w.event(0.01) * w.exponential(), 0.01),
];

/// Where Student's interval is right from 100 samples on, to a percent.
const RIGHT: [&str; 6] =
    ["normal", "uniform", "exponential", "lognormal 0.5", "student 3", "event 0.5"];

/// Of all seeds: how many have an interval, and on how many of these it misses; the mean ratio of
/// widths to Student's.
struct Found {
    seeds: f64,
    stated: f64,
    missed: f64,
    ratio: f64,
}

impl Found {
    /// The share of false intervals among those that are stated; among all seeds where hardly any
    /// are.
    fn share(&self) -> f64 {
        self.missed / if self.stated < 0.2 * self.seeds { self.seeds } else { self.stated }
    }

    /// Whether 93 % coverage is not refuted: four standard deviations, one in 3·10⁴ for each law.
    fn covers(&self) -> bool {
        self.share() < 0.07 + 4.0 * (0.07 * 0.93 / self.stated.max(0.2 * self.seeds)).sqrt()
    }
}

type Interval = Option<(f64, f64)>;

/// The twin.
fn student(moments: &CentralMoments, quantile: f64) -> Interval {
    let half = quantile * moments.variance_of_mean().sqrt();
    Some((moments.mean() - half, moments.mean() + half))
}

/// By the rule, and by Student's.
fn measured((_, law, truth): Law, samples: u32, seeds: u64) -> [Found; 2] {
    let mut found =
        [0, 1].map(|_| Found { seeds: seeds as f64, stated: 0.0, missed: 0.0, ratio: 0.0 });
    let quantile = two_sided(0.95, Some(f64::from(samples) - 1.0));
    for seed in 0..seeds {
        let mut words = Words(Xoshiro256PlusPlus::seed_from_u64(seed));
        let mut moments = CentralMoments::default();
        (0..samples).for_each(|_| moments.add(law(&mut words)));
        let normal = student(&moments, quantile);
        let width = |(lo, hi): (f64, f64)| hi - lo;
        for (found, interval) in found.iter_mut().zip([moments.mean_interval(), normal]) {
            let Some((lo, hi)) = interval else { continue };
            found.stated += 1.0;
            found.missed += f64::from(u8::from(!(lo..=hi).contains(&truth)));
            found.ratio += normal.map_or(0.0, |normal| width((lo, hi)) / width(normal));
        }
    }
    found.map(|found| Found { ratio: found.ratio / found.stated, ..found })
}

/// 4000 seeds each; 32 rows with four standard deviations: a false alarm in a thousand sets of
/// seeds.
#[test]
fn intervals_of_means_cover_where_students_do_not() {
    let mut refuted = 0;
    for samples in [100, 1000] {
        for law in LAWS {
            let [rule, twin] = measured(law, samples, 4000);
            let few = 1.0 - rule.stated / rule.seeds;
            assert!(rule.covers(), "{} of {samples}: {}", law.0, rule.share());
            refuted += u32::from(!twin.covers());
            if RIGHT.contains(&law.0) {
                assert!(twin.covers() && rule.ratio < 1.5, "{}: {}", law.0, rule.ratio);
                assert!(few < 0.01, "{}: {few}", law.0);
            }
        }
    }
    // The twin: Student's intervals miss too often on ten rows and more.
    assert!(refuted >= 10, "{refuted}");
}

#[test]
fn an_interval_is_students_and_what_was_not_seen() {
    let of = |values: &[f64]| {
        let mut moments = CentralMoments::default();
        values.iter().for_each(|&x| moments.add(x));
        moments.mean_interval()
    };
    // Student's 4.302 652 73/√3 and 3.688 879 45/3 of a sample at a distance of one.
    let half = (4.302_652_73f64.powi(2) / 3.0 + (3.688_879_45f64 / 3.0).powi(2)).sqrt();
    let (lo, hi) = of(&[1.0, 2.0, 3.0]).unwrap();
    assert!((2.0 - lo - half).abs() < 1e-8 && (hi - 2.0 - half).abs() < 1e-8);
    // Mirrored and scaled with the samples.
    let skewed = [0.0, 0.0, 0.5, 0.0, 7.0, 0.0, 0.0, 2.0, 3.0, 0.0];
    let (lo, hi) = of(&skewed).unwrap();
    let (low, high) = of(&skewed.map(|x| -8.0 * x)).unwrap();
    assert!((low + 8.0 * hi).abs() < 1e-13 && (high + 8.0 * lo).abs() < 1e-13);
    assert!(hi - 1.25 > 1.5 * (1.25 - lo));
    // One event, none, or no second value: nothing is known of others.
    let mut rare = [0.0; 100];
    assert_eq!((of(&rare), of(&[1.0]), of(&[])), (None, None, None));
    rare[3] = 1.0;
    assert_eq!(of(&rare), None);
    rare[4] = 1.0;
    let (lo, hi) = of(&rare).unwrap();
    // Clopper and Pearson: 0.0024 to 0.0704.
    assert!((-0.01..0.0025).contains(&lo) && (0.07..0.2).contains(&hi), "{lo} {hi}");
}

/// Laws with their variances.
const VARIANCES: [Law; 4] = [
    ("normal", |w| w.normal(), 1.0),
    ("uniform", |w| w.uniform(), 1.0 / 12.0),
    ("exponential", |w| w.exponential(), 1.0),
    ("lognormal 0.5", |w| (0.5 * w.normal()).exp(), 0.364_695_845_532_774_7),
];

/// 4000 seeds each: four standard deviations, one in 3·10⁴ for each of 8 shares.
#[test]
fn intervals_of_variances_cover() {
    let (mut refuted, seeds) = (0, 4000);
    for (samples, claim) in [(100, 0.09), (1000, 0.07)] {
        for (name, law, truth) in VARIANCES {
            let (mut missed, mut twin) = (0.0, 0.0);
            for seed in 0..seeds {
                let mut words = Words(Xoshiro256PlusPlus::seed_from_u64(seed));
                let mut moments = CentralMoments::default();
                (0..samples).for_each(|_| moments.add(law(&mut words)));
                let false_one = |(lo, hi): (f64, f64)| !(lo..=hi).contains(&truth);
                missed += f64::from(u8::from(moments.variance_interval().is_none_or(false_one)));
                // The twin: the interval of a normal law.
                let half = 1.96 * moments.variance() * (2.0 / f64::from(samples)).sqrt();
                let normal = (moments.variance() - half, moments.variance() + half);
                twin += f64::from(u8::from(false_one(normal)));
            }
            let most = claim + 4.0 * (claim * (1.0 - claim) / seeds as f64).sqrt();
            let (share, twin) = (missed / seeds as f64, twin / seeds as f64);
            assert!(share < most, "{name} of {samples}: {share}");
            refuted += u32::from(twin > most);
        }
    }
    assert!(refuted >= 4, "{refuted}");
}
