//! The law of an observable in time: bands between quantiles, median and mean.

use mc::study::{Series, Summary};

use super::{
    axis::{Axis, Range, Scale},
    canvas::{Canvas, INK},
    chart::{BELOW, RIGHT},
    frame::Frame,
    legend::{Sample, legend},
    look::BLUE,
    stroke::{Color, Position, Stroke},
    ticks::Ticks,
};
use crate::label::Label;

const WIDTH: f64 = 340.0;
const LEFT: f64 = 52.0;
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

const UNIT: Range = Range { lo: 0.0, hi: 1.0 };

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
    let mut canvas = Canvas::default();
    let top = legend(&mut canvas, entries, LEFT, WIDTH - LEFT - RIGHT);
    let bottom = top + HEIGHT;

    let quantile = |k: usize| move |point: &Summary| point.quantiles.get(k)?.value;
    let shown = |point: &Summary| {
        let quantiles: Vec<_> = point.quantiles.iter().filter_map(|q| q.value).collect();
        quantiles.into_iter().chain(point.mean)
    };
    let times = Range::of(points.iter().map(|point| point.time), UNIT);
    let times = if times.lo < times.hi { times } else { times.padded(0.1) };
    let values = Range::of(points.iter().flat_map(shown), UNIT).padded(0.06);
    let axis = |range, start, end| Axis { scale: Scale::Linear, range, start, end };
    let frame = Frame { x: axis(times, LEFT, WIDTH - RIGHT), y: axis(values, bottom, top) };
    let x = (&Ticks::decimal(times, 6), Some("time t"));
    frame.draw(&mut canvas, x, (&Ticks::decimal(values, 5), Some(&*series.observable)));
    for (low, high) in pairs {
        for run in runs(points, |point| quantile(low)(point).zip(quantile(high)(point))) {
            let lower = run.iter().map(|&(t, (low, _))| frame.place(t, low));
            let upper = run.iter().rev().map(|&(t, (_, high))| frame.place(t, high));
            canvas.area(&lower.chain(upper).collect::<Vec<_>>(), COLOR, OPACITY);
        }
    }
    let mut line = |value: &dyn Fn(&Summary) -> Option<f64>, stroke: Stroke| {
        for run in runs(points, value) {
            let places: Vec<Position> = run.iter().map(|&(t, x)| frame.place(t, x)).collect();
            frame.polyline(&mut canvas, &places, stroke);
        }
    };
    if let Some(median) = median {
        line(&quantile(median), median_line());
    }
    line(&|point| point.mean, mean_line());
    if points.iter().all(|point| point.mean.is_none()) {
        frame.say(&mut canvas, "no data");
    }
    canvas.page((WIDTH, bottom + BELOW), title)
}

/// Pairs of quantiles with levels p and 1 − p, from the outside to the inside.
fn pairs(points: &[Summary]) -> Vec<(usize, usize)> {
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
fn percent(level: f64) -> f64 {
    (1e8 * level).round() / 1e6
}

#[cfg(test)]
pub(super) mod tests {
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
            [
                (0.05, Some(-1.0)),
                (0.25, Some(-0.5)),
                (0.5, Some(0.0)),
                (0.75, Some(0.5)),
                (0.95, high),
            ]
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
}
