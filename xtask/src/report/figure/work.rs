//! Errors against what they cost, in logarithmic coordinates: plots side by side under one legend.

use anyhow::Result;

use super::axis::{Axis, Range, Scale};
use super::canvas::{self, Canvas, Position, Stroke};
use super::frame::Frame;
use super::legend::{Legend, Sample};
use super::look::{self, Look};
use super::ticks::Ticks;
use crate::report::label::Label;

/// A measured error and what it costs, with the intervals of both.
#[derive(Clone, Copy, Debug)]
pub struct WorkPoint {
    /// What it costs.
    pub cost: f64,
    /// Upper end of the spread of the cost, the lower one being `cost`.
    pub cost_hi: f64,
    /// The error.
    pub error: f64,
    /// Its interval.
    pub interval: (f64, f64),
}

/// One plot: curves by the id of their scheme.
#[derive(Clone, Debug)]
pub struct WorkPlot {
    /// Title of the horizontal axis.
    pub cost: String,
    /// Whether costs are counts of steps, which are powers of two.
    pub steps: bool,
    /// The curves.
    pub curves: Vec<(String, Vec<WorkPoint>)>,
}

/// In this order, so that a scheme looks the same on every figure.
const SCHEMES: [&str; 5] = ["sexp", "sexp-levy", "midpoint", "heun", "em"];

const PLOT: (f64, f64) = (268.0, 214.0);
const LEFT: f64 = 46.0;
const BETWEEN: f64 = 44.0;
const RIGHT: f64 = 10.0;
const BELOW: f64 = 33.0;
const MARKER_RADIUS: f64 = 2.8;

/// Draws the plots beside each other; `error` is the title of the vertical axis that they share.
pub fn work_figure(title: &str, error: &str, plots: &[WorkPlot]) -> Result<String> {
    let columns = plots.len().max(1) as f64;
    let width = LEFT + columns * PLOT.0 + (columns - 1.0) * BETWEEN + RIGHT;
    let present =
        |id: &&str| plots.iter().any(|plot| plot.curves.iter().any(|(scheme, _)| scheme == id));
    let looks = look::of_schemes(SCHEMES);
    let look =
        |id: &str| SCHEMES.iter().position(|scheme| *scheme == id).map_or(looks[0], |n| looks[n]);
    let entries = SCHEMES
        .iter()
        .filter(|id| present(id))
        .map(|id| (Sample::Curve(look(id)), Label::words(id)))
        .collect();
    let legend = Legend::new(entries, width - LEFT - RIGHT);
    let top = legend.height() + 7.0;
    let points = || plots.iter().flat_map(|plot| &plot.curves).flat_map(|(_, points)| points);
    let errors = Range::of_positive(points().map(|p| p.error), Range { lo: 1e-4, hi: 1.0 })
        .times(1.5)
        .with_two_decades();
    canvas::page((width, top + PLOT.1 + BELOW), title, |canvas| {
        legend.draw(canvas, LEFT, 2.0)?;
        for (n, plot) in plots.iter().enumerate() {
            let start = LEFT + n as f64 * (PLOT.0 + BETWEEN);
            let costs = plot.curves.iter().flat_map(|(_, points)| points).map(|p| p.cost);
            let costs = Range::of_positive(costs, Range { lo: 1.0, hi: 100.0 }).times(1.25);
            let frame = Frame {
                x: Axis { scale: Scale::Logarithmic, range: costs, start, end: start + PLOT.0 },
                y: Axis { scale: Scale::Logarithmic, range: errors, start: top + PLOT.1, end: top },
            };
            let ticks =
                if plot.steps { Ticks::powers_of_two(costs, 8) } else { Ticks::decades(costs, 7) };
            frame.draw(canvas, &ticks, &Ticks::decades(errors, 7), true)?;
            frame.title_below(canvas, &plot.cost)?;
            if n == 0 {
                frame.title_left(canvas, error)?;
            }
            let mut from_below: Vec<&(String, Vec<WorkPoint>)> = plot.curves.iter().collect();
            from_below.sort_by_key(|(scheme, _)| look(scheme).layer);
            for (scheme, points) in from_below {
                curve(canvas, &frame, look(scheme), points)?;
            }
        }
        Ok(())
    })
}

fn curve(canvas: &mut Canvas, frame: &Frame, look: Look, points: &[WorkPoint]) -> Result<()> {
    let places: Vec<Position> = points.iter().map(|p| frame.place(p.cost, p.error)).collect();
    frame.polyline(canvas, &places, look.line(1.2))?;
    let bar = Stroke::new(look.color, 1.0);
    for point in points {
        let (lo, hi) = point.interval;
        frame.polyline(canvas, &[frame.place(point.cost, lo), frame.place(point.cost, hi)], bar)?;
        frame.polyline(
            canvas,
            &[frame.place(point.cost, point.error), frame.place(point.cost_hi, point.error)],
            bar,
        )?;
    }
    for at in places.into_iter().filter(|at| frame.holds(*at)) {
        canvas.marker(at, look, look.radius(MARKER_RADIUS), look.hollow())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn awkward_data_still_make_a_figure() -> Result<()> {
        let point = |cost, error| WorkPoint {
            cost,
            cost_hi: 2.0 * cost,
            error,
            interval: (0.5 * error, 2.0 * error),
        };
        let awkward = [
            vec![],
            vec![point(1.0, 0.1)],
            vec![point(0.0, 0.0), point(f64::NAN, 1.0), point(1.0, f64::INFINITY)],
            vec![point(1.0, f64::MAX), point(1e-300, 1e-300)],
        ];
        for points in awkward {
            let plot = WorkPlot {
                cost: "time".into(),
                steps: false,
                curves: vec![("a stranger".into(), points)],
            };
            let steps = WorkPlot { steps: true, ..plot.clone() };
            let figure = work_figure("A & B", "error", &[plot, steps])?;
            assert!(
                figure.starts_with("<svg")
                    && figure.trim_end().ends_with("</svg>")
                    && figure.contains("A &amp; B")
            );
        }
        Ok(())
    }
}
