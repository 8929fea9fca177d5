//! How often laws without a variance or a mean are named, and how often others.

use rand_xoshiro::{Xoshiro256PlusPlus, rand_core::SeedableRng};
use stats::CentralMoments;

use crate::statistical::means::Words;

/// A law, and the least and the largest share of samples of each number that are to be named; with
/// any shift and scale.
type Law = (&'static str, fn(&mut Words) -> f64, [(f64, f64); 3]);

const NUMBERS: [(usize, u64); 3] = [(100, 600), (1000, 600), (5000, 40)];
/// The laws without a false alarm: one in a hundred.
const LIGHT: [(f64, f64); 3] = [(0.0, 0.01); 3];

fn pareto(words: &mut Words, index: f64) -> f64 {
    words.uniform().powf(-1.0 / index)
}

const LAWS: [Law; 17] = [
    ("normal", |w| w.normal(), LIGHT),
    ("exponential", |w| w.exponential(), LIGHT),
    ("lognormal 0.5", |w| (0.5 * w.normal()).exp(), LIGHT),
    ("lognormal 1", |w| w.normal().exp(), [(0.0, 0.02), (0.0, 0.02), (0.0, 0.01)]),
    ("student 5", |w| w.student(5), LIGHT),
    ("rare event", |w| w.event(0.003), LIGHT),
    ("two wells", |w| w.normal() + 8.0 * w.event(0.3), LIGHT),
    ("counts", |w| (2.0 * w.exponential()).floor(), LIGHT),
    ("constant", |_| 0.1, LIGHT),
    (
        "two sizes",
        |w| w.normal() * (0.2 + 2.8 * w.event(0.05)),
        [(0.0, 1.0), (0.0, 1.0), (0.0, 0.01)],
    ),
    ("index 1.67", |w| pareto(w, 5.0 / 3.0), [(0.05, 1.0), (0.85, 1.0), (0.93, 1.0)]),
    ("index 1.67 below", |w| -pareto(w, 5.0 / 3.0), [(0.05, 1.0), (0.85, 1.0), (0.93, 1.0)]),
    (
        "index 1.67 and noise",
        |w| pareto(w, 5.0 / 3.0) + 0.5 * w.normal(),
        [(0.05, 1.0), (0.85, 1.0), (0.93, 1.0)],
    ),
    ("index 1.11", |w| pareto(w, 1.0 / 0.9), [(0.3, 1.0), (0.99, 1.0), (1.0, 1.0)]),
    ("index 0.8", |w| pareto(w, 0.8), [(0.55, 1.0), (0.99, 1.0), (1.0, 1.0)]),
    ("Cauchy", |w| w.normal() / w.normal(), [(0.5, 1.0), (0.99, 1.0), (1.0, 1.0)]),
    (
        "one in a hundred heavy",
        |w| if w.event(0.01) > 0.0 { 3.0 * w.normal() / w.normal() } else { w.normal() },
        [(0.0, 1.0), (0.3, 1.0), (0.9, 1.0)],
    ),
];

/// The share of samples that are named, and of these the share without variance and without mean.
fn named(law: fn(&mut Words) -> f64, number: usize, seeds: u64) -> [f64; 3] {
    let mut found = [0.0; 3];
    for seed in 0..seeds {
        let mut words = Words(Xoshiro256PlusPlus::seed_from_u64(7000 + seed));
        let samples: Vec<f64> = (0..number).map(|_| 1e3 + 2.0 * law(&mut words)).collect();
        let mut moments = CentralMoments::default();
        samples.iter().for_each(|&x| moments.add(x));
        let tail = moments.tail(&samples);
        if tail.is_heavy() {
            let is = [true, !tail.has_variance(), !tail.has_mean()];
            found.iter_mut().zip(is).for_each(|(sum, is)| *sum += f64::from(u8::from(is)));
        }
    }
    [found[0] / seeds as f64, found[1] / found[0], found[2] / found[0]]
}

/// Each share may deviate by four standard errors: one in 3·10⁴ for each of 48.
#[test]
fn heavy_tails_are_named_and_no_others() {
    for (name, law, shares) in LAWS {
        for ((number, seeds), (least, most)) in NUMBERS.into_iter().zip(shares) {
            let [share, no_variance, no_mean] = named(law, number, seeds);
            if std::env::var("SHOW").is_ok() {
                println!("{name} {number}: {share:.4} {no_variance:.3} {no_mean:.3}");
                continue;
            }
            let slack = |share: f64| 4.0 * (share * (1.0 - share) / seeds as f64).sqrt();
            let known = least - slack(least) <= share && share <= most + slack(most);
            assert!(known, "{name} of {number}: {share}");
        }
    }
}

/// A fitted index above two by less than its standard error is perhaps none above two.
#[test]
fn an_index_near_two_is_perhaps_no_variance() {
    let of = |index: f64| {
        // The quantiles of a Pareto law.
        let samples: Vec<f64> =
            (0..5000).map(|k| ((f64::from(k) + 0.5) / 5000.0).powf(-1.0 / index)).collect();
        let mut moments = CentralMoments::default();
        samples.iter().for_each(|&x| moments.add(x));
        moments.tail(&samples).to_string()
    };
    // ξ = 1/α has the error (1 + ξ)/√512 = 0.065; of 512 quantiles ξ is right to some 0.01.
    assert!(of(2.1).starts_with("perhaps no variance (tail index 2."), "{}", of(2.1));
}
