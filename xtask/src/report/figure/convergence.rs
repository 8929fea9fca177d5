//! Errors against the step size, or cost against accuracy, in logarithmic coordinates.

use anyhow::Result;
use verify::results::{Kind, Panel, Point, Rate, Series};

use super::axis::{Axis, Range, Scale};
use super::canvas::{self, Align, Canvas, INK, Position, Stroke};
use super::frame::{Frame, TITLE_SIZE};
use super::legend::{Legend, Sample};
use super::look::{self, Layer, Look, Marker};
use super::slope::{self, ReferenceSlope, Trend};
use super::ticks::Ticks;
use crate::report::label::Label;
use crate::report::main_quantity;

/// Two-sided 95 % quantile of the normal distribution, for the error bars.
pub const QUANTILE: f64 = 1.96;

const WIDTH: f64 = 340.0;
const PLOT_HEIGHT: f64 = 214.0;
const LEFT: f64 = 46.0;
const RIGHT: f64 = 10.0;
const BELOW: f64 = 33.0;
const MARKER_RADIUS: f64 = 3.0;

/// A measured error, or what an accuracy cost.
#[derive(Clone, Copy, Debug)]
struct Measurement {
    /// The step size, or the accuracy.
    tau: f64,
    value: f64,
    se: f64,
    /// The ends of the interval, where it is not `value` ± 1.96 `se`; of positive values only.
    ends: Option<(f64, f64)>,
}

struct Curve {
    name: Label,
    look: Look,
    rate: Option<Rate>,
    points: Vec<Measurement>,
}

/// The figure of a strong, weak or cost panel as an SVG document.
pub fn convergence(panel: &Panel) -> Result<String> {
    let curves = curves(panel);
    let weak = panel.kind == Kind::Weak;
    let cost = panel.kind == Kind::Cost;
    let trends: Vec<Trend> = curves.iter().filter(|_| !cost).map(|c| c.trend(weak)).collect();
    let slopes = slope::reference_slopes(&trends);
    let legend = Legend::new(entries(&curves, weak), WIDTH - LEFT - RIGHT);
    let top = legend.height() + 7.0;
    let height = top + PLOT_HEIGHT + BELOW;
    let frame = Frame {
        x: Axis {
            scale: Scale::Logarithmic,
            range: step_range(&curves),
            start: LEFT,
            end: WIDTH - RIGHT,
        },
        y: Axis {
            scale: Scale::Logarithmic,
            range: error_range(&curves, &slopes),
            start: top + PLOT_HEIGHT,
            end: top,
        },
    };
    canvas::page((WIDTH, height), &panel.title, |canvas| {
        legend.draw(canvas, LEFT, 2.0)?;
        let steps = if cost {
            Ticks::decades(frame.x.range, 7)
        } else {
            Ticks::powers_of_two(frame.x.range, 8)
        };
        frame.draw(canvas, &steps, &Ticks::decades(frame.y.range, 7), true)?;
        frame.title_below(
            canvas,
            if cost { "half-width ε of the 95 % interval" } else { "step size τ" },
        )?;
        let quantity = main_quantity(panel);
        let title = if weak {
            "|weak error|".to_owned()
        } else if cost {
            "path-steps".to_owned()
        } else {
            format!("RMS error of {quantity}").trim_end_matches(" of ").to_owned()
        };
        frame.title_left(canvas, &title)?;
        let mut obstacles = obstacles(&frame, &curves);
        for line in &slopes {
            line.draw(canvas, &frame, &mut obstacles)?;
        }
        let mut from_below: Vec<(usize, &Curve)> = curves.iter().enumerate().collect();
        from_below.sort_by_key(|(_, curve)| curve.look.layer);
        for (n, curve) in from_below {
            // Bars of weak errors are long and would cover each other: set them side by side.
            let shift =
                if weak { 2.4 * (n as f64 - 0.5 * (curves.len() as f64 - 1.0)) } else { 0.0 };
            curve.draw(canvas, &frame, shift, weak)?;
        }
        if curves.iter().all(|c| c.points.is_empty()) {
            let centre = (0.5 * (LEFT + WIDTH - RIGHT), top + 0.5 * PLOT_HEIGHT);
            canvas.label(&Label::words("no data"), centre, TITLE_SIZE, Align::Middle)?;
        }
        Ok(())
    })
}

/// The curves drawn: of a strong panel those of its main quantity, of a weak panel all.
fn curves(panel: &Panel) -> Vec<Curve> {
    let weak = panel.kind == Kind::Weak;
    let quantity = main_quantity(panel);
    let drawn: Vec<&Series> =
        panel.series.iter().filter(|s| weak || s.quantity == quantity).collect();
    let several_schemes = drawn.windows(2).any(|pair| pair[0].scheme != pair[1].scheme);
    let looks = look::of_schemes(drawn.iter().map(|s| s.scheme.as_str()));
    drawn
        .iter()
        .enumerate()
        .map(|(n, series)| Curve {
            name: match (weak, several_schemes) {
                (false, _) => Label::words(&series.scheme),
                (true, false) => Label::new(&series.quantity),
                (true, true) => Label::new(&format!("{} {}", series.scheme, series.quantity)),
            },
            look: if weak { look::of_quantity(n) } else { looks[n] },
            rate: series.rate.clone().filter(|rate| rate.estimate.is_finite()),
            points: series.points.iter().filter_map(measurement).collect(),
        })
        .collect()
}

fn measurement(point: &Point) -> Option<Measurement> {
    match *point {
        Point::Error { tau, value, se, lo, hi, .. } => {
            let se = if se.is_finite() { se.abs() } else { 0.0 };
            let ends = lo.zip(hi).filter(|(lo, hi)| *lo >= 0.0 && hi.is_finite());
            (tau > 0.0 && tau.is_finite() && value.is_finite()).then_some(Measurement {
                tau,
                value,
                se,
                ends,
            })
        }
        Point::Cost { accuracy, path_steps } => (accuracy > 0.0).then_some(Measurement {
            tau: accuracy,
            value: path_steps as f64,
            se: 0.0,
            ends: None,
        }),
        Point::Value { .. } => None,
    }
}

impl Measurement {
    fn size(&self) -> f64 {
        self.value.abs()
    }

    fn upper(&self) -> f64 {
        self.ends.map_or(self.size() + QUANTILE * self.se, |(_, hi)| hi)
    }

    fn lower(&self) -> f64 {
        self.ends.map_or(self.size() - QUANTILE * self.se, |(lo, _)| lo)
    }
}

impl Curve {
    /// Its name and the order fitted to it.
    fn caption(&self) -> Label {
        match &self.rate {
            Some(rate) => self.name.clone().with_tail(&format!(": {}", order(rate))),
            None => self.name.clone(),
        }
    }

    /// What this curve asks of the reference slopes. A weak order is only ever compared with 1: its
    /// fit is too noisy to choose between two lines.
    fn trend(&self, weak: bool) -> Trend {
        let pairs = |keep: fn(&Measurement) -> bool| -> Vec<(f64, f64)> {
            self.points.iter().filter(|p| keep(p)).map(|p| (p.tau, p.size())).collect()
        };
        let mut points = pairs(|p| p.lower() > 0.0);
        if points.is_empty() {
            points = pairs(|p| p.size() > 0.0);
        }
        let order = if weak {
            Some(1.0)
        } else {
            self.rate.as_ref().map(|rate| rate.estimate).or_else(|| slope::fitted_order(&points))
        };
        Trend { order, points }
    }

    fn draw(&self, canvas: &mut Canvas, frame: &Frame, shift: f64, weak: bool) -> Result<()> {
        // A point below the range shows its whole marker at the floor.
        let radius = self.look.radius(MARKER_RADIUS);
        let floor = frame.y.start - radius;
        let places: Vec<Position> = self
            .points
            .iter()
            .map(|p| frame.place(p.tau, p.size()))
            .map(|(x, y)| (x + shift, y.clamp(frame.y.end, floor)))
            .collect();
        let line = self.look.line(if weak { 0.8 } else { 1.2 });
        let bar = Stroke::new(self.look.color, 1.0);
        frame.polyline(canvas, &places, if weak { line.faded(0.45) } else { line })?;
        for (point, at) in self.points.iter().zip(&places) {
            error_bar(canvas, frame, point, at.0, bar)?;
        }
        for (point, at) in self.points.iter().zip(&places) {
            canvas.marker(*at, self.look, radius, self.look.hollow() || point.value < 0.0)?;
        }
        Ok(())
    }
}

/// Draws the interval of a point; where it reaches zero or leaves the frame it ends at the border,
/// uncapped.
fn error_bar(
    canvas: &mut Canvas,
    frame: &Frame,
    point: &Measurement,
    x: f64,
    stroke: Stroke,
) -> Result<()> {
    const CAP: f64 = 2.2;
    if point.se == 0.0 {
        return Ok(());
    }
    let ends = [point.lower(), point.upper()].map(|v| (x, frame.y.position(v)));
    let Some((low, high)) = frame.clip(ends[0], ends[1]) else {
        return Ok(());
    };
    canvas.polyline(&[low, high], stroke)?;
    for (end, value) in [(low, point.lower()), (high, point.upper())] {
        if (frame.y.range.lo..=frame.y.range.hi).contains(&value) {
            canvas.polyline(&[(x - CAP, end.1), (x + CAP, end.1)], stroke)?;
        }
    }
    Ok(())
}

/// An order with the half-width of its interval, which is never rounded to zero.
fn order(rate: &Rate) -> String {
    let estimate = format!("{:.2}", rate.estimate).replace('-', "−");
    let half_width = 0.5 * (rate.hi - rate.lo);
    if half_width.is_finite() {
        format!("{estimate} ± {:.2}", half_width.max(0.01))
    } else {
        estimate
    }
}

fn entries(curves: &[Curve], weak: bool) -> Vec<(Sample, Label)> {
    let mut entries: Vec<_> = curves.iter().map(|c| (Sample::Curve(c.look), c.caption())).collect();
    if weak {
        let plain = Look { color: INK, marker: Marker::Circle, layer: Layer::Plain };
        entries.push((Sample::Point { look: plain, hollow: false }, Label::words("> 0")));
        entries.push((Sample::Point { look: plain, hollow: true }, Label::words("< 0")));
    }
    entries
}

fn step_range(curves: &[Curve]) -> Range {
    let typical = Range { lo: 2f64.powi(-12), hi: 2f64.powi(-5) };
    let steps = curves.iter().flat_map(|c| c.points.iter().map(|p| p.tau));
    let range = Range::of_positive(steps, typical);
    range.times(if range.lo < range.hi { (range.hi / range.lo).powf(0.04) } else { 2.0 })
}

/// Covers the errors, their bars as far as they stay near the error, and the reference lines.
fn error_range(curves: &[Curve], slopes: &[ReferenceSlope]) -> Range {
    // An error far below its own noise, or a bar that comes close to zero, says nothing at a depth
    // that would squeeze the rest of the figure.
    const DEPTH: f64 = 0.25;
    let errors = curves.iter().flat_map(|c| &c.points).flat_map(|p| {
        [p.size().max(DEPTH * p.se), p.upper(), p.lower().max(DEPTH * p.size().max(p.se))]
    });
    let steps = Range::of_positive(
        curves.iter().flat_map(|c| &c.points).map(|p| p.tau),
        Range { lo: 1.0, hi: 1.0 },
    );
    let lines = slopes.iter().flat_map(|s| [s.at(steps.lo), s.at(steps.hi)]);
    Range::of_positive(errors.chain(lines), Range { lo: 1e-4, hi: 1.0 })
        .times(1.4)
        .with_two_decades()
}

/// Points of everything a name beside a reference line should stay away from.
fn obstacles(frame: &Frame, curves: &[Curve]) -> Vec<Position> {
    let mut obstacles = Vec::new();
    for curve in curves {
        let places: Vec<Position> =
            curve.points.iter().map(|p| frame.place(p.tau, p.size())).collect();
        for pair in places.windows(2) {
            obstacles.extend(slope::along(pair[0], pair[1]));
        }
        for (point, place) in curve.points.iter().zip(&places) {
            let bar =
                (frame.place(point.tau, point.lower()), frame.place(point.tau, point.upper()));
            obstacles.extend(slope::along(bar.0, bar.1));
            obstacles.push(*place);
        }
    }
    obstacles
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_short_and_never_certain() {
        let rate =
            |estimate, lo, hi| Rate { estimate, lo, hi, confidence: 0.95, ..Rate::default() };
        assert_eq!(order(&rate(1.0015, 0.954, 1.049)), "1.00 ± 0.05");
        assert_eq!(order(&rate(0.5, 0.499, 0.501)), "0.50 ± 0.01");
        assert_eq!(order(&rate(-0.1, f64::NAN, 0.3)), "−0.10");
    }
}
