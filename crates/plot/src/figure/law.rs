//! The law of a quantity: along an axis, as bands between quantiles, median and mean; and at one
//! place, as a histogram.

use std::iter::zip;

use real::elementary;

use super::*;

/// The colour of bands, bars and median.
const COLOR: Color = BLUE;
/// Opacity of one band; bands inside of others are darker.
const OPACITY: f64 = 0.22;

const MEAN: Stroke = Stroke::new(INK, 1.1).dashed();
const MEDIAN: Stroke = Stroke::new(COLOR, 1.6);

/// Statistics of a quantity along an axis, each with a number for every place; NaN where that is
/// not known.
#[derive(Clone, Debug, Default)]
pub struct Law {
    /// Places on the axis, such as times.
    pub x: Vec<f64>,
    /// Means.
    pub mean: Vec<f64>,
    /// Lower and upper ends of the 95 % intervals of the means, which are drawn without quantiles.
    pub interval: [Vec<f64>; 2],
    /// Levels of quantiles, and the quantiles.
    pub quantiles: Vec<(f64, Vec<f64>)>,
}

impl Law {
    /// Bands with their names, from the outside to the inside, each from its lower end to its
    /// upper.
    fn bands(&self) -> Vec<(String, [&[f64]; 2])> {
        if self.quantiles.is_empty() {
            let [lo, hi] = &self.interval;
            return vec![("95 % interval".into(), [lo, hi])];
        }
        let lower = self.quantiles.iter().filter(|(level, _)| *level < 0.5);
        let bands = lower.filter_map(|(level, low)| {
            let opposite = |(other, _): &&(f64, Vec<f64>)| (other + level - 1.0).abs() < 1e-9;
            let (other, high) = self.quantiles.iter().find(opposite)?;
            Some((format!("{}–{} %", percent(*level), percent(*other)), [&low[..], high]))
        });
        bands.collect()
    }

    fn median(&self) -> Option<&[f64]> {
        self.quantiles.iter().find(|(level, _)| *level == 0.5).map(|(_, values)| &**values)
    }

    /// All values that are drawn.
    fn shown(&self) -> impl Iterator<Item = f64> {
        let ends = self.interval.iter().filter(|_| self.quantiles.is_empty());
        let quantiles = self.quantiles.iter().map(|(_, values)| values);
        quantiles.chain([&self.mean]).chain(ends).flatten().copied()
    }

    /// Draws bands, median and mean in a frame.
    fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        let points = |values| zip(&self.x, values).map(|(x, y): (&f64, &f64)| (*x, *y));
        for (_, [lower, upper]) in self.bands() {
            let ends: Vec<_> = zip(points(lower), points(upper)).collect();
            // Stretches on which both ends are known.
            let known = ends.split(|(low, high)| !(low.1.is_finite() && high.1.is_finite()));
            for run in known.filter(|run| run.len() > 1) {
                let back = run.iter().rev().map(|(_, high)| *high);
                let corners = run.iter().map(|(low, _)| *low).chain(back);
                canvas.area(&frame.places(corners), COLOR, OPACITY);
            }
        }
        let median = self.median().map(|values| (values, MEDIAN));
        for (values, stroke) in median.into_iter().chain([(&*self.mean, MEAN)]) {
            frame.polyline(canvas, &frame.places(points(values)), stroke);
        }
    }
}

/// Figure of a law along an axis as an SVG document: a band between each two quantiles of levels p
/// and 1 − p, the median and the mean; without quantiles, the band between the ends of the 95 %
/// intervals. Bands and lines are interrupted where a number is not known.
pub fn bands<'a>(title: &str, x_title: &str, y_title: impl Into<Title<'a>>, law: &Law) -> String {
    let (y_title, bands) = (y_title.into(), law.bands());
    let mut entries = Vec::new();
    for (n, (name, _)) in (1..).zip(&bands) {
        let opacity = 1.0 - elementary::powi(1.0 - OPACITY, n);
        entries.push((Sample::Area(COLOR, opacity), &**name));
    }
    entries.extend(law.median().map(|_| (Sample::Line(MEDIAN), "median")));
    let mean = if law.quantiles.is_empty() { "estimate" } else { "mean" };
    entries.push((Sample::Line(MEAN), mean));
    let x = (Axis::of(law.x.iter().copied(), 0.0), Some(x_title));
    let y = (y_title.axis(law.shown(), 0.06), y_title.words);
    let mut plain = Plain::new(entries, 190.0, x, y);
    law.draw(&mut plain.canvas, &plain.frame);
    plain.page(title, !law.mean.iter().any(|mean| mean.is_finite()))
}

/// Figure of measured values with their intervals, beside fitted ones with a band, as an SVG
/// document.
pub fn fitted(title: &str, x: &str, y: &str, law: &Law, data: &[Sampled]) -> String {
    let mut times = Axis::of(law.x.iter().copied(), 0.0);
    times.range = times.range.padded(0.04);
    let values = Axis::of(law.shown().chain(data.iter().flat_map(ends)), 0.06);
    let look = of_quantities(1)[0];
    let entries = [
        (Sample::Area(COLOR, OPACITY), "95 % of the fit"),
        (Sample::Line(MEAN), "fit"),
        (Sample::Point(look), "data"),
    ];
    let mut plain = Plain::new(entries, 190.0, (times, Some(x)), (values, y));
    law.draw(&mut plain.canvas, &plain.frame);
    data.iter().for_each(|value| plain.sampled(value, look));
    plain.page(title, data.is_empty())
}

/// Room for the labels on the left of small plots, and their height.
const LEFT: f64 = 42.0;
const HEIGHT: f64 = 74.0;

/// Small multiples of a quantity in time as an SVG document: bands, median and mean as in
/// [`bands`], a plot for each name, all with the same axes.
pub fn multiples(title: &str, y_title: Title<'_>, panels: &[(String, Law)]) -> String {
    let laws = || panels.iter().map(|(_, law)| law);
    let times = Axis::of(laws().flat_map(|law| &law.x).copied(), 0.0);
    let axes = [times, y_title.axis(laws().flat_map(Law::shown), 0.06)];
    small(
        title,
        panels,
        axes,
        (LEFT, BELOW),
        |_| HEIGHT,
        |canvas, frame, (k, columns), law| {
            let mut y = frame.y.ticks(3);
            if k % columns > 0 {
                y.major.iter_mut().for_each(|(_, label)| *label = Label::default());
                y.factor = None;
            }
            // Nothing stands below it.
            let is_last = k + columns >= panels.len();
            let x_title = is_last.then_some(if k % columns == columns / 2 { "time t" } else { "" });
            frame.draw(canvas, (&frame.x.ticks(3), x_title), (&y, None));
            law.draw(canvas, &frame);
        },
    )
}

/// A level in percent, without digits that are rounding errors.
fn percent(level: f64) -> f64 {
    (1e8 * level).round() / 1e6
}

/// Largest number of bars: more bars are joined in pairs.
const MAX_BARS: usize = 64;

/// Counts of values in bins of one width.
#[derive(Clone, Copy, Debug)]
pub struct Bins<'a> {
    /// The lowest edge.
    pub lo: f64,
    /// Width of a bin.
    pub width: f64,
    /// Number of values in each bin.
    pub counts: &'a [u64],
    /// Number of all values, those outside of the bins too.
    pub all: u64,
}

impl Bins<'_> {
    /// Ends and density of each bar, from the first to the last with a count.
    fn bars(&self) -> Vec<[f64; 3]> {
        let Self { lo, width, counts, all } = *self;
        let mut filled = (0..counts.len()).filter(|&k| counts[k] > 0);
        let Some(first) = filled.next() else { return Vec::new() };
        let last = filled.next_back().unwrap_or(first);
        let mut joined = 1;
        while (last / joined - first / joined) >= MAX_BARS {
            joined *= 2;
        }
        let bars = (first / joined..=last / joined).map(|n| {
            let [first, end] = [n * joined, (n + 1) * joined];
            let [from, to] = [first, end].map(|k| lo + k as f64 * width);
            let count: u64 = counts[first..end.min(counts.len())].iter().sum();
            [from, to, count as f64 / (all as f64 * (to - from))]
        });
        bars.collect()
    }
}

/// Histogram as an SVG document: the density in bins, and lines at the median and the mean where
/// they are known. The title of the axis says how many values are outside of the bins.
pub fn histogram(
    title: &str,
    x_title: &str,
    bins: Bins<'_>,
    median: Option<f64>,
    mean: Option<f64>,
) -> String {
    let lines = [("median", median, MEDIAN), ("mean", mean, MEAN)];
    let entries = lines.map(|(name, _, stroke)| (Sample::Line(stroke), name));
    let bars = bins.bars();
    let values = Axis::of(bars.iter().flat_map(|bar| [bar[0], bar[1]]), 0.04);
    let highest = Range::of(bars.iter().map(|bar| bar[2]), UNIT).hi;
    let hi = 1.06 * if highest > 0.0 { highest } else { 1.0 };
    let densities = Axis::linear(Range { lo: 0.0, hi });
    let outside = bins.all.saturating_sub(bins.counts.iter().sum());
    let mut x_title = x_title.to_owned();
    if outside > 0 {
        x_title += &format!(", {outside} of {} outside", bins.all);
    }
    let mut plain = Plain::new(entries, 170.0, (values, Some(&*x_title)), (densities, "density"));
    if let (Some(first), Some(last)) = (bars.first(), bars.last()) {
        let tops = bars.iter().flat_map(|&[lo, hi, density]| [(lo, density), (hi, density)]);
        let outline = [(first[0], 0.0)].into_iter().chain(tops).chain([(last[1], 0.0)]);
        plain.canvas.area(&plain.frame.places(outline.clone()), COLOR, 0.25);
        plain.line(outline, Stroke::new(COLOR, 0.9));
        for (_, value, stroke) in lines {
            plain.line(value.into_iter().flat_map(|x| [(x, 0.0), (x, hi)]), stroke);
        }
    }
    plain.page(title, bars.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::tests::is_whole;

    /// Quantiles of these levels at six times, the last of which may be unknown at t = 2.
    fn law(levels: &[f64], hole: bool) -> Law {
        let x: Vec<f64> = (0..6).map(f64::from).collect();
        let quantile = |&level: &f64| (level, vec![2.0 * level - 1.0; 6]);
        let mut quantiles: Vec<_> = levels.iter().map(quantile).collect();
        if let Some((_, last)) = quantiles.last_mut().filter(|_| hole) {
            last[2] = f64::NAN;
        }
        Law { x, mean: vec![0.25; 6], quantiles, ..Law::default() }
    }

    #[test]
    fn a_band_is_between_opposite_quantiles_and_ends_where_one_is_not_known() {
        let drawn = |law: &Law| bands("A & B", "time t", "a<b", law);
        let levels = [0.05, 0.25, 0.5, 0.75, 0.95];
        let svg = drawn(&law(&levels, false));
        is_whole(&svg, &["5–95 %", "25–75 %", "median", "mean", "a&lt;b", "A &amp; B"]);
        let areas = |svg: &str| svg.matches("<polygon").count();
        // Two in the legend.
        assert_eq!(areas(&svg), 4);
        assert_eq!(areas(&drawn(&law(&levels, true))), 5);
        let none = Law { mean: vec![f64::NAN; 6], ..law(&[0.3], true) };
        for law in [Law::default(), none, law(&[], false), law(&[0.29, 0.71], true)] {
            is_whole(&drawn(&law), &[]);
        }
        is_whole(&multiples("", "y".into(), &[("a<b".into(), law(&levels, true))]), &["a&lt;b"]);
        assert_eq!((percent(0.29), percent(0.05), percent(0.975)), (29.0, 5.0, 97.5));
    }

    #[test]
    fn bars_hold_all_values_inside() {
        for bins in [1, 63, 64, 65, 300, 1000] {
            let count = |k: u64| u64::from(k > 2 || bins < 4) * (k % 7);
            let counts: Vec<u64> = (0..bins).map(count).collect();
            let all = counts.iter().sum();
            let bars = Bins { lo: -1.0, width: 0.5, counts: &counts, all }.bars();
            assert!(bars.len() <= MAX_BARS + 1, "{bins}");
            let all: f64 = bars.iter().map(|[lo, hi, density]| (hi - lo) * density).sum();
            assert!(bins == 1 || (all - 1.0).abs() < 1e-12, "{bins}: {all}");
            assert!(bars.windows(2).all(|pair| pair[0][1] == pair[1][0]));
        }
        let drawn = |counts, all, median| {
            let bins = Bins { lo: -1.0, width: 0.5, counts, all };
            histogram("A & B", "a<b at t = 2", bins, median, Some(0.25))
        };
        for (counts, all) in [(&[][..], 0), (&[0, 0], 0), (&[0, 5, 0], 7)] {
            is_whole(&drawn(counts, all, None), &["A &amp; B", "a&lt;b"]);
        }
        is_whole(&drawn(&[0, 5, 0], 7, Some(0.0)), &["t = 2, 2 of 7 outside"]);
    }

    #[test]
    fn axes_may_be_logarithmic_and_intervals_are_bands() {
        let x: Vec<f64> = (0..9).map(f64::from).collect();
        let of = |factor: f64| x.iter().map(|t| factor * (-t).exp()).collect::<Vec<_>>();
        let (mean, interval) = (of(1.0), [of(0.5), of(2.0)]);
        let law = Law { x: x.clone(), mean, interval, ..Law::default() };
        let svg = bands("A", "lag", Title { words: "y", logarithmic: true }, &law);
        is_whole(&svg, &["lag", "estimate", "95 % interval", "<polygon"]);
        // A decaying exponential is a straight line.
        let points = |line: &str| -> Vec<f64> {
            let points = line.split("points=\"").nth(1).and_then(|rest| rest.split('"').next());
            points.unwrap().split([' ', ',']).map(|x| x.parse().unwrap()).collect()
        };
        let lines = svg.split("<polyline").skip(1).map(points);
        let places = lines.max_by_key(Vec::len).unwrap();
        assert_eq!(places.len(), 2 * 9);
        let slope = |k: usize| {
            (places[2 * k + 3] - places[2 * k + 1]) / (places[2 * k + 2] - places[2 * k])
        };
        assert!((slope(0) - slope(7)).abs() < 0.02, "{places:?}");
    }
}
