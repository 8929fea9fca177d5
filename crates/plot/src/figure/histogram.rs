//! The histogram of an observable at one time.

use mc::study::{Histogram, Summary};

use super::{
    axis::Range,
    bands::{COLOR, mean_line, median_line},
    legend::Sample,
    plain::{Plain, UNIT},
    stroke::Stroke,
};
use crate::label::Label;

const HEIGHT: f64 = 170.0;

/// Bars are joined, two and two, until there are no more than this.
pub const MOST_BARS: usize = 64;

/// The histogram of an observable with this name at one time as an SVG document: the density in
/// bins, median and mean. Values outside of the bins are counted in the title of the axis.
pub fn histogram(title: &str, observable: &str, summary: &Summary) -> String {
    let median = summary.quantiles.iter().find(|q| q.level == 0.5).and_then(|q| q.value);
    let lines = [("median", median, median_line()), ("mean", summary.mean, mean_line())];
    let entries = lines.iter().map(|(name, _, stroke)| (Sample::Line(*stroke), Label::words(name)));
    let bars = summary.histogram.as_ref().map_or(Vec::new(), |histogram| bars(histogram, summary));
    let values = Range::of(bars.iter().flat_map(|&(lo, hi, _)| [lo, hi]), UNIT).padded(0.04);
    let highest = Range::of(bars.iter().map(|&(_, _, density)| density), UNIT).hi;
    let densities = Range { lo: 0.0, hi: 1.06 * if highest > 0.0 { highest } else { 1.0 } };
    let outside = summary.histogram.as_ref().map_or(0, |found| found.below + found.above);
    let mut x_title = format!("{observable} at t = {}", summary.time);
    if outside > 0 {
        x_title += &format!(", {outside} of {} outside", summary.count);
    }
    let mut plain = Plain::new(entries, HEIGHT, (values, Some(&*x_title)), (densities, "density"));
    if let (Some(first), Some(last)) = (bars.first(), bars.last()) {
        let corners = bars.iter().flat_map(|&(lo, hi, density)| [(lo, density), (hi, density)]);
        let outline: Vec<_> =
            [(first.0, 0.0)].into_iter().chain(corners).chain([(last.1, 0.0)]).collect();
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
pub fn bars(histogram: &Histogram, summary: &Summary) -> Vec<(f64, f64, f64)> {
    let counts = &histogram.counts;
    let filled = |count: &u64| *count > 0;
    let Some((first, last)) = counts.iter().position(filled).zip(counts.iter().rposition(filled))
    else {
        return Vec::new();
    };
    let mut joined = 1;
    while (last / joined - first / joined) >= MOST_BARS {
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
