//! Tests of fits.

mod statistical;

use fit::{Data, Effort, FitError, FitSettings, Moment, Replicate, Statistic, fit};

/// A search that is stopped gives the best parameters so far, and says so; an error if there are
/// none.
#[test]
fn a_stopped_search_gives_what_it_has() {
    let at = |time: f64| Moment { time, of: 0, statistic: Statistic::Mean, value: time.exp() };
    let data = Data::with_errors([0.5, 1.0, 2.0].map(at).to_vec(), &[1e-3; 3]).unwrap();
    // e^{at} from a = 0: Gauss and Newton's method takes some steps.
    let until = |number: usize| {
        let (settings, mut tried) = (FitSettings::default(), Vec::new());
        let stop = settings.stop.clone();
        let found =
            fit(&data, &[("a".into(), 0.3)], &settings, &mut |theta: &[f64], _: &Effort| {
                if tried.len() == number {
                    stop.now();
                    return Err("stopped");
                }
                tried.push(theta[0]);
                let values = [0.5, 1.0, 2.0].map(|t| (theta[0] * t).exp());
                let slopes = vec![[0.5, 1.0, 2.0].map(|t| t * (theta[0] * t).exp()).to_vec()];
                let (values, coarse) = (values.to_vec(), values.to_vec());
                Ok(vec![Replicate { values, coarse, slopes, covariance: vec![], failed: 0 }])
            });
        (found, tried)
    };
    let (whole, tried) = until(usize::MAX);
    let whole = whole.unwrap();
    assert!(whole.is_good() && (whole.values[0] - 1.0).abs() < 1e-6, "{whole:?}");
    for number in 1..tried.len() {
        let (stopped, so_far) = until(number);
        let stopped = stopped.unwrap();
        assert_eq!(so_far[..], tried[..number]);
        let error = |a: f64| [0.5f64, 1.0, 2.0].map(|t| (a * t).exp() - t.exp()).map(|x| x * x);
        let error = |a: &f64| error(*a).iter().sum::<f64>();
        let best = so_far.iter().min_by(|a, b| error(a).total_cmp(&error(b))).unwrap();
        assert_eq!((stopped.values[0], stopped.is_good()), (*best, false), "{number}");
        assert!(stopped.warnings[0].to_string().contains("stopped before its end"));
    }
    assert!(matches!(until(0).0, Err(FitError::Model("stopped"))));
}
