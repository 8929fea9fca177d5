use mc::study::{Grid, Histogram, Place, Quantile};

use super::*;

/// A summary at `time` with quantiles of these levels and values, and a few counts.
pub fn summary(time: f64, quantiles: &[(f64, Option<f64>)], counts: &[u64]) -> Summary {
    let quantile = |&(level, value): &(f64, Option<f64>)| {
        let place = if value.is_some() { Place::Inside } else { Place::AboveGrid };
        Quantile { level, value, lo: value, hi: value, place }
    };
    let grid = Grid { lo: -1.0, width: 0.5, bins: counts.len() as u32 };
    Summary {
        step: 1,
        time,
        count: counts.iter().sum(),
        not_finite: 0,
        mean: Some(0.25),
        mean_interval: None,
        interval_note: None,
        variance: None,
        deviation: None,
        effective: None,
        least: None,
        largest: None,
        quantiles: quantiles.iter().map(quantile).collect(),
        histogram: Some(Histogram { grid, below: 0, counts: counts.to_vec(), above: 0 }),
    }
}

fn series(points: Vec<Summary>) -> Series {
    Series { observable: "a<b".into(), points }
}

#[test]
fn a_band_is_between_opposite_quantiles_and_ends_outside_of_the_grid() {
    let levels = |high: Option<f64>| {
        [(0.05, Some(-1.0)), (0.25, Some(-0.5)), (0.5, Some(0.0)), (0.75, Some(0.5)), (0.95, high)]
    };
    let at = |t: f64, high| summary(t, &levels(high), &[1, 2]);
    let all = (0..6).map(|t| at(f64::from(t), Some(1.0))).collect::<Vec<_>>();
    assert_eq!(pairs(&all), [(0, 4), (1, 3)]);
    let svg = bands("A & B", &series(all.clone()));
    let areas = |svg: &str| svg.matches("<polygon").count();
    // Two in the legend.
    assert_eq!(areas(&svg), 4);
    for words in ["5–95 %", "25–75 %", "median", "mean", "a&lt;b", "A &amp; B"] {
        assert!(svg.contains(words), "{words}");
    }
    let mut gap = all;
    gap[2] = at(2.0, None);
    assert_eq!(areas(&bands("", &series(gap))), 5);
}

#[test]
fn awkward_studies_still_make_a_figure() {
    let none = Summary { mean: None, ..summary(0.0, &[(0.3, None)], &[]) };
    for points in [
        vec![],
        vec![none.clone()],
        vec![summary(0.0, &[], &[])],
        vec![summary(0.0, &[(0.29, Some(1.0)), (0.71, Some(1.0))], &[1]), none],
    ] {
        let svg = bands("", &series(points));
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(!svg.contains("NaN"));
    }
    assert_eq!((percent(0.29), percent(0.05), percent(0.975)), (29.0, 5.0, 97.5));
}
