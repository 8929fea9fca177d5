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
const MOST_BARS: usize = 64;

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
    let mut x_title = format!("{observable} at t = {}", summary.time);
    if let Some(histogram) = &summary.histogram {
        let outside = histogram.below + histogram.above;
        if outside > 0 {
            x_title += &format!(", {outside} of {} outside", summary.count);
        }
    }
    let mut plain = Plain::new(entries, HEIGHT, (values, &x_title), (densities, "density"));
    let corners = bars.iter().flat_map(|&(lo, hi, density)| [(lo, density), (hi, density)]);
    let ends = [bars.first().map(|bar| (bar.0, 0.0)), bars.last().map(|bar| (bar.1, 0.0))];
    let outline = ends[0].into_iter().chain(corners).chain(ends[1]);
    let outline: Vec<_> = outline.collect();
    if !bars.is_empty() {
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
fn bars(histogram: &Histogram, summary: &Summary) -> Vec<(f64, f64, f64)> {
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

#[cfg(test)]
mod tests {
    use super::super::bands::tests::summary;
    use super::*;

    #[test]
    fn bars_hold_all_values_inside() {
        for bins in [1, 63, 64, 65, 300, 1000] {
            let counts: Vec<u64> =
                (0..bins).map(|k| u64::from(k > 2 || bins < 4) * (k % 7)).collect();
            let summary = summary(1.0, &[(0.5, Some(0.0))], &counts);
            let bars = bars(summary.histogram.as_ref().unwrap(), &summary);
            assert!(bars.len() <= MOST_BARS + 1, "{bins}");
            let all: f64 = bars.iter().map(|&(lo, hi, density)| (hi - lo) * density).sum();
            assert!(bins == 1 || (all - 1.0).abs() < 1e-12, "{bins}: {all}");
            assert!(bars.windows(2).all(|pair| pair[0].1 == pair[1].0));
        }
    }

    #[test]
    fn awkward_histograms_still_make_a_figure() {
        let empty = summary(1.0, &[], &[0, 0]);
        let mut outside = summary(2.0, &[(0.5, None)], &[0, 5, 0]);
        outside.histogram.as_mut().unwrap().above = 2;
        let initial = Summary { histogram: None, ..empty.clone() };
        for summary in [empty, outside.clone(), initial] {
            let svg = histogram("A & B", "a<b", &summary);
            assert!(svg.starts_with("<svg") && svg.contains("A &amp; B") && svg.contains("a&lt;b"));
            assert!(!svg.contains("NaN"));
        }
        assert!(histogram("", "x", &outside).contains("x at t = 2, 2 of 5 outside"));
    }
}
