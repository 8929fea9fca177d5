//! The law of an observable: in time, as bands between quantiles, median and mean; and at one time,
//! as a histogram.

use real::elementary;
use study::Summary;

use super::{
    axis::Range,
    canvas::{Canvas, Color, INK, Stroke},
    frame::{Frame, Plain, Title, UNIT},
    legend::Sample,
    look::BLUE,
};
use crate::label::Label;

/// The colour of bands, bars and median.
const COLOR: Color = BLUE;
/// Opacity of one band; bands inside of others are darker.
const OPACITY: f64 = 0.22;

const MEAN: Stroke = Stroke::new(INK, 1.1).dashed();
const MEDIAN: Stroke = Stroke::new(COLOR, 1.6);

/// Figure of an observable in time as an SVG document: a band between each two quantiles of levels
/// p and 1 − p, the median and the mean; without quantiles, the band between the ends of the 95 %
/// intervals. A band is interrupted where a quantile lies outside of the grid of its histogram.
pub fn bands<'a>(
    title: &str,
    x_title: &str,
    y_title: impl Into<Title<'a>>,
    points: &[Summary],
) -> String {
    let (x_title, y_title) = (Title::from(x_title), y_title.into());
    let levels = levels(points);
    let pairs = pairs(&levels);
    let areas = pairs.iter().enumerate().map(|(n, &(low, high))| {
        let [low, high] = [low, high].map(|k| percent(levels[k]));
        let opacity = 1.0 - elementary::powi(1.0 - OPACITY, n as i32 + 1);
        (Sample::Area(COLOR, opacity), Label::words(&format!("{low}–{high} %")))
    });
    let mut entries: Vec<_> = areas.collect();
    let mut add = |sample, words| entries.push((sample, Label::words(words)));
    if levels.contains(&0.5) {
        add(Sample::Line(MEDIAN), "median");
    }
    add(Sample::Line(MEAN), if levels.is_empty() { "estimate" } else { "mean" });
    if levels.is_empty() {
        add(Sample::Area(COLOR, OPACITY), "95 % interval");
    }
    let [times, values] = ranges(points.iter(), x_title, y_title);
    let mut plain = Plain::new(entries, 190.0, (times, Some(x_title)), (values, y_title));
    draw_bands(&mut plain.canvas, &plain.frame, points);
    plain.page(title, points.iter().all(|point| point.mean.is_none()))
}

/// Levels of the quantiles that `points` have.
fn levels(points: &[Summary]) -> Vec<f64> {
    let first = points.iter().map(|point| &point.quantiles).find(|all| !all.is_empty());
    first.into_iter().flatten().map(|quantile| quantile.level).collect()
}

/// The ranges of times and of values.
pub fn ranges<'a>(
    points: impl Iterator<Item = &'a Summary> + Clone,
    x_title: Title<'_>,
    y_title: Title<'_>,
) -> [Range; 2] {
    let shown = points.clone().flat_map(|point| {
        let ends = point.mean_interval.filter(|_| point.quantiles.is_empty());
        let ends = ends.into_iter().flat_map(|(lo, hi)| [lo, hi]);
        point.quantiles.iter().filter_map(|quantile| quantile.value).chain(point.mean).chain(ends)
    });
    let y = y_title.range(shown, 0.06);
    [x_title.range(points.map(|point| point.time), 0.0), y]
}

/// Draws bands, median and mean in a frame.
pub fn draw_bands(canvas: &mut Canvas, frame: &Frame, points: &[Summary]) {
    let levels = levels(points);
    let quantile = |k: usize| move |point: &Summary| point.quantiles.get(k)?.value;
    let bands = pairs(&levels).into_iter().map(Some).chain(levels.is_empty().then_some(None));
    for band in bands {
        let both = |point: &Summary| match band {
            Some((low, high)) => quantile(low)(point).zip(quantile(high)(point)),
            None => point.mean_interval,
        };
        // Stretches of times at which there are both.
        for run in points.split(|point| both(point).is_none()).filter(|run| run.len() > 1) {
            let ends = |point: &Summary| both(point).map(|both| (point.time, both));
            let ends: Vec<_> = run.iter().filter_map(ends).collect();
            let lower = ends.iter().map(|&(t, (low, _))| frame.place(t, low));
            let upper = ends.iter().rev().map(|&(t, (_, high))| frame.place(t, high));
            canvas.area(&lower.chain(upper).collect::<Vec<_>>(), COLOR, OPACITY);
        }
    }
    // Where there is no value a line is interrupted.
    let mut line = |value: &dyn Fn(&Summary) -> Option<f64>, stroke: Stroke| {
        let place = |point: &Summary| frame.place(point.time, value(point).unwrap_or(f64::NAN));
        frame.polyline(canvas, &points.iter().map(place).collect::<Vec<_>>(), stroke);
    };
    if let Some(median) = levels.iter().position(|level| *level == 0.5) {
        line(&quantile(median), MEDIAN);
    }
    line(&|point| point.mean, MEAN);
}

/// Pairs of levels p and 1 − p, from the outside to the inside.
pub fn pairs(levels: &[f64]) -> Vec<(usize, usize)> {
    let opposite = |k: usize| {
        let l = levels.iter().position(|level| (level + levels[k] - 1.0).abs() < 1e-9)?;
        Some((k, l))
    };
    (0..levels.len()).filter(|&k| levels[k] < 0.5).filter_map(opposite).collect()
}

/// A level in percent, without digits that are rounding errors.
pub fn percent(level: f64) -> f64 {
    (1e8 * level).round() / 1e6
}

/// Largest number of bars: more bars are joined in pairs.
pub const MAX_BARS: usize = 64;

/// The histogram of an observable with this name at one time as an SVG document: the density in
/// bins, median and mean. Values outside of the bins are counted in the title of the axis.
pub fn histogram(title: &str, observable: &str, summary: &Summary) -> String {
    let median = summary.quantiles.iter().find(|q| q.level == 0.5).and_then(|q| q.value);
    let lines = [("median", median, MEDIAN), ("mean", summary.mean, MEAN)];
    let entries = lines.iter().map(|(name, _, stroke)| (Sample::Line(*stroke), Label::words(name)));
    let bars = bars(summary);
    let values = Range::of(bars.iter().flat_map(|&(lo, hi, _)| [lo, hi]), UNIT).padded(0.04);
    let highest = Range::of(bars.iter().map(|&(_, _, density)| density), UNIT).hi;
    let densities = Range { lo: 0.0, hi: 1.06 * if highest > 0.0 { highest } else { 1.0 } };
    let outside = summary.histogram.as_ref().map_or(0, |found| found.below + found.above);
    let mut x_title = format!("{observable} at t = {}", summary.time);
    if outside > 0 {
        x_title += &format!(", {outside} of {} outside", summary.count);
    }
    let mut plain = Plain::new(
        entries,
        170.0,
        (values, Some((&*x_title).into())),
        (densities, "density".into()),
    );
    let mut outline: Vec<_> = bars.iter().flat_map(|&(lo, hi, d)| [(lo, d), (hi, d)]).collect();
    if let (Some(first), Some(last)) = (bars.first(), bars.last()) {
        outline.insert(0, (first.0, 0.0));
        outline.push((last.1, 0.0));
        let corners = plain.places(outline.iter().copied());
        plain.canvas.area(&corners, COLOR, 0.25);
        plain.line(outline, Stroke::new(COLOR, 0.9));
        for (_, value, stroke) in lines {
            let ends = value.map(|x| [0.0, densities.hi].map(|y| (x, y)));
            plain.line(ends.into_iter().flatten(), stroke);
        }
    }
    plain.page(title, bars.is_empty())
}

/// Ends and density of each bar, from the first to the last with a count.
pub fn bars(summary: &Summary) -> Vec<(f64, f64, f64)> {
    let Some(histogram) = &summary.histogram else { return Vec::new() };
    let counts = &histogram.counts;
    let mut filled = (0..counts.len()).filter(|&k| counts[k] > 0);
    let Some(first) = filled.next() else { return Vec::new() };
    let last = filled.next_back().unwrap_or(first);
    let mut joined = 1;
    while (last / joined - first / joined) >= MAX_BARS {
        joined *= 2;
    }
    let bar = |n: usize| {
        let bins = n * joined..(n + 1) * joined;
        let [lo, hi] = [bins.start, bins.end].map(|k| histogram.grid.edge(k as u32));
        let count: u64 = counts[bins.start..bins.end.min(counts.len())].iter().sum();
        (lo, hi, count as f64 / (summary.count as f64 * (hi - lo)))
    };
    (first / joined..=last / joined).map(bar).collect()
}
