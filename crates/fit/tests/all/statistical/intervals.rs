//! Intervals and χ² of a model in closed form, with Monte Carlo errors that are not small
//! beside those of the data.

use fit::{Data, Effort, Fit, FitError, FitSettings, Moment, Replicate, Statistic, fit};
use noise::{StreamKey, WienerPath};

const TIMES: [f64; 4] = [0.5, 1.0, 1.5, 2.0];
/// Errors of the data and of a replicate of 32: means over these have half the variance.
const ERROR: f64 = 0.01;
const OF_REPLICATE: f64 = 4.0 * ERROR;
const TRUTH: [f64; 2] = [1.5, 0.8];
const SETS: u64 = 1000;

/// a e^{−bt} with its derivatives.
fn curve([a, b]: [f64; 2]) -> [Vec<f64>; 3] {
    let of = |f: &dyn Fn(f64) -> f64| TIMES.map(f).to_vec();
    [of(&|t| a * (-b * t).exp()), of(&|t| (-b * t).exp()), of(&|t| -a * t * (-b * t).exp())]
}

/// Normals of a stream.
fn normals(set: u64, stream: u64) -> Vec<f64> {
    let mut path = WienerPath::<4>::new(StreamKey { seed: 3, experiment: set }, stream);
    path.increments(1.0).to_vec()
}

/// What a method does wrong.
#[derive(Clone, Copy, PartialEq)]
enum Wrong {
    Nothing,
    /// Differences of the model on noise of their own.
    NewNoise,
    /// A model that lies this far off, in errors of the data.
    Model(f64),
}

/// Coarse moments that are off by a multiple of a derivative: so is the bound of this parameter.
#[test]
fn the_bias_of_steps_is_in_the_interval() {
    let exact = curve(TRUTH)[0].clone();
    let at = |k| Moment { time: TIMES[k], of: 0, statistic: Statistic::Mean, value: exact[k] };
    let data = Data::with_errors((0..4).map(at).collect(), &[ERROR; 4]).expect("data");
    let mut model = |theta: &[f64], _: &Effort| {
        let [values, by_a, by_b] = curve([theta[0], theta[1]]);
        let coarse = values.iter().zip(&by_b).map(|(y, slope)| y + 1e-3 * slope).collect();
        let (slopes, covariance) = (vec![by_a, by_b], Vec::new());
        Ok::<_, String>(vec![Replicate { values, coarse, slopes, covariance, failed: 0 }])
    };
    let start = [("a".into(), 1.0), ("b".into(), 1.0)];
    let found = fit(&data, &start, &FitSettings::default(), &mut model).expect("a fit");
    assert!(found.bias_bound[0] < 1e-8 && (found.bias_bound[1] - 1e-3).abs() < 1e-8);
    let without = 1.959_963_984_540_054 * found.covariance[1][1].sqrt();
    assert!((found.half_width(1) - without - 1e-3).abs() < 1e-8);
}

fn found(set: u64, wrong: Wrong) -> Result<Fit, FitError<String>> {
    let exact = curve(TRUTH);
    let noise = normals(set, 1000);
    let value = |k: usize| exact[0][k] + ERROR * noise[k];
    let at = |k| Moment { time: TIMES[k], of: 0, statistic: Statistic::Mean, value: value(k) };
    let data = Data::with_errors((0..4).map(at).collect(), &[ERROR; 4]).expect("data");
    let mut model = |theta: &[f64], _: &Effort| {
        let [mut values, by_a, by_b] = curve([theta[0], theta[1]]);
        if let Wrong::Model(off) = wrong {
            values.iter_mut().zip([1.0, -1.0, 1.0, -1.0]).for_each(|(y, s)| *y += s * off * ERROR);
        }
        let replicate = |r: u64| {
            let with = |stream: u64, y: &[f64], size: f64| -> Vec<f64> {
                y.iter().zip(normals(set, stream)).map(|(y, z)| y + size * z).collect()
            };
            let size = if wrong == Wrong::NewNoise { 1e4 * OF_REPLICATE } else { 0.0 };
            let slopes = vec![with(r + 100, &by_a, size), with(r + 200, &by_b, size)];
            let values = with(r, &values, OF_REPLICATE);
            Replicate { coarse: values.clone(), values, slopes, covariance: Vec::new(), failed: 0 }
        };
        Ok((0..32).map(replicate).collect::<Vec<_>>())
    };
    let start = [("a".into(), 1.0), ("b".into(), 1.0)];
    let settings = FitSettings { most: 0, ..FitSettings::default() };
    fit(&data, &start, &settings, &mut model)
}

/// Whether a count of `SETS` is within 4.5 standard errors (7e-6) of a probability.
fn is_of(count: u64, probability: f64) -> bool {
    let n = SETS as f64;
    (count as f64 - n * probability).abs() < 4.5 * (n * probability * (1.0 - probability)).sqrt()
}

#[test]
fn intervals_cover_and_chi_square_is_one() {
    let [mut covered, mut without] = [[0; 2]; 2];
    let [mut small, mut half] = [0; 2];
    for set in 0..SETS {
        let fit = found(set, Wrong::Nothing).expect("a fit");
        for (k, exact) in TRUTH.iter().enumerate() {
            let apart = (fit.values[k] - exact).abs();
            let own = fit.covariance[k][k] - fit.monte_carlo[k].powi(2);
            covered[k] += u64::from(apart < fit.half_width(k));
            without[k] += u64::from(apart < 1.96 * own.sqrt());
        }
        let probability = fit.probability.expect("degrees");
        small += u64::from(probability < 0.05);
        half += u64::from(probability < 0.5);
    }
    // A third of the variance is Monte Carlo: without it 1.96/√(1 + ½) errors cover 89 %.
    for k in 0..2 {
        assert!(is_of(covered[k], 0.95), "{covered:?}");
        assert!(!is_of(without[k], 0.95) && without[k] < covered[k], "{without:?}");
    }
    assert!(is_of(small, 0.05) && is_of(half, 0.5), "{small} {half}");
}

#[test]
fn derivatives_on_new_noise_and_wrong_models_are_refused() {
    for set in 0..100 {
        let new = found(set, Wrong::NewNoise);
        let good = new
            .is_ok_and(|fit| fit.warnings.iter().all(|warning| warning.what.starts_with("Monte")));
        assert!(!good, "{set}");
        // χ² is above 4·16²/1.5 less twice its root and what two parameters take.
        let wrong = found(set, Wrong::Model(16.0)).expect("a fit");
        assert!(wrong.probability < Some(1e-3) && !wrong.is_good(), "{set}: {wrong:?}");
    }
}

#[test]
fn samples_have_their_covariance() {
    // Means and variances of (x, 2x, y) from 400 normals: the second is the first.
    let sample = |n: u64| {
        let z = normals(n, 7);
        (1.0, vec![z[0], 2.0 * z[0], 3.0 + z[1]])
    };
    let data = Data::of_samples((0..400).map(sample).collect()).expect("data");
    assert_eq!(data.moments.len(), 6);
    // 1/n, 2/n, and zero between independent ones; 5 standard errors of a covariance of 400.
    for (i, j, exact) in [(0, 0, 1.0f64), (1, 1, 2.0), (2, 2, 4.0), (4, 5, 0.0), (0, 4, 0.0)] {
        let found = 400.0 * data.covariance[i][j];
        let error = 5.0 * (15.0f64 / 400.0).sqrt() * exact.max(1.0);
        assert!((found - exact).abs() < error, "{i} {j}: {found} {exact}");
    }
}
