//! The law of an observable in time: bands between quantiles, median and mean.

use mc::study::{Series, Summary};

use super::{
    axis::Range,
    canvas::INK,
    legend::Sample,
    look::BLUE,
    plain::{Plain, UNIT},
    stroke::{Color, Stroke},
};
use crate::label::Label;

const HEIGHT: f64 = 190.0;

/// Opacity of one band; bands inside of others are darker.
const OPACITY: f64 = 0.22;
/// The colour of bands and median.
pub const COLOR: Color = BLUE;
/// The line of the mean.
pub fn mean_line() -> Stroke {
    Stroke::new(INK, 1.1).dashed()
}
/// The line of the median.
pub fn median_line() -> Stroke {
    Stroke::new(COLOR, 1.6)
}

/// The figure of an observable in time as an SVG document: a band between each two quantiles of
/// levels p and 1 − p, the median and the mean. A band is interrupted where a quantile lies outside
/// of the grid of its histogram.
pub fn bands(title: &str, series: &Series) -> String {
    let points = &series.points;
    let pairs = pairs(points);
    let areas = pairs.iter().enumerate().map(|(n, &(low, high))| {
        let level = |k: usize| percent(points[0].quantiles[k].level);
        let words = format!("{}–{} %", level(low), level(high));
        (Sample::Area(COLOR, 1.0 - (1.0 - OPACITY).powi(n as i32 + 1)), Label::words(&words))
    });
    let median =
        points.first().and_then(|first| first.quantiles.iter().position(|q| q.level == 0.5));
    let median_entry = median.map(|_| (Sample::Line(median_line()), Label::words("median")));
    let mean_entry = (Sample::Line(mean_line()), Label::words("mean"));
    let entries = areas.chain(median_entry).chain([mean_entry]);
    let quantile = |k: usize| move |point: &Summary| point.quantiles.get(k)?.value;
    let shown = |point: &Summary| {
        let quantiles: Vec<_> = point.quantiles.iter().filter_map(|q| q.value).collect();
        quantiles.into_iter().chain(point.mean)
    };
    let times = Range::of(points.iter().map(|point| point.time), UNIT).or_padded();
    let values = Range::of(points.iter().flat_map(shown), UNIT).padded(0.06);
    let mut plain =
        Plain::new(entries, HEIGHT, (times, Some("time t")), (values, &series.observable));
    for (low, high) in pairs {
        for run in runs(points, |point| quantile(low)(point).zip(quantile(high)(point))) {
            let lower = run.iter().map(|&(t, (low, _))| (t, low));
            let upper = run.iter().rev().map(|&(t, (_, high))| (t, high));
            let corners = plain.places(lower.chain(upper));
            plain.canvas.area(&corners, COLOR, OPACITY);
        }
    }
    let mut line = |value: &dyn Fn(&Summary) -> Option<f64>, stroke: Stroke| {
        runs(points, value).into_iter().for_each(|run| plain.line(run, stroke));
    };
    if let Some(median) = median {
        line(&quantile(median), median_line());
    }
    line(&|point| point.mean, mean_line());
    plain.page(title, points.iter().all(|point| point.mean.is_none()))
}

/// Pairs of quantiles with levels p and 1 − p, from the outside to the inside.
pub fn pairs(points: &[Summary]) -> Vec<(usize, usize)> {
    let Some(first) = points.first() else { return Vec::new() };
    let levels: Vec<f64> = first.quantiles.iter().map(|quantile| quantile.level).collect();
    let opposite = |k: usize| {
        let same = |&l: &usize| (levels[l] + levels[k] - 1.0).abs() < 1e-9;
        (0..levels.len()).find(same).map(|l| (k, l))
    };
    (0..levels.len()).filter(|&k| levels[k] < 0.5).filter_map(opposite).collect()
}

/// Stretches of times at which there is a value.
fn runs<T>(points: &[Summary], value: impl Fn(&Summary) -> Option<T>) -> Vec<Vec<(f64, T)>> {
    let mut runs = vec![Vec::new()];
    for point in points {
        match (value(point), runs.last_mut()) {
            (Some(value), Some(run)) => run.push((point.time, value)),
            _ => runs.push(Vec::new()),
        }
    }
    runs.retain(|run| run.len() > 1);
    runs
}

/// A level in percent, without digits that are rounding errors.
pub fn percent(level: f64) -> f64 {
    (1e8 * level).round() / 1e6
}
