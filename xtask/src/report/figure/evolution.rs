//! An invariant along one path: its value with the conformal law above, the relative defect of the
//! law below.

use anyhow::Result;
use verify::results::{Panel, Point};

use super::axis::{Axis, Range, Scale};
use super::canvas::{self, Align, Canvas, INK, Position, Stroke};
use super::frame::{Frame, TITLE_SIZE};
use super::legend::{Legend, Sample};
use super::look::{self, Look};
use super::ticks::Ticks;
use crate::report::label::Label;
use crate::report::{main_quantity, relative_defect};

/// Where a defect of zero is drawn: below 2⁻⁵³ ≈ 1.1·10⁻¹⁶, the smallest defect of a floating-point
/// number that is not zero.
const FLOOR: f64 = 1e-17;

const WIDTH: f64 = 340.0;
const VALUE_HEIGHT: f64 = 112.0;
const DEFECT_HEIGHT: f64 = 132.0;
const BETWEEN: f64 = 10.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 10.0;
const BELOW: f64 = 33.0;

#[derive(Clone, Copy, Debug)]
struct Sampled {
    t: f64,
    value: f64,
    exact: f64,
}

struct Curve {
    name: Label,
    look: Look,
    points: Vec<Sampled>,
}

/// The figure of an invariant panel as an SVG document.
pub fn evolution(panel: &Panel) -> Result<String> {
    let curves = curves(panel);
    let law = Stroke::new(INK, 0.7);
    let mut entries: Vec<_> =
        curves.iter().map(|c| (Sample::Curve(c.look), c.name.clone())).collect();
    entries.push((Sample::Line(law), Label::words("conformal law")));
    let legend = Legend::new(entries, WIDTH - LEFT - RIGHT);
    let value_top = legend.height() + 7.0;
    let defect_top = value_top + VALUE_HEIGHT + BETWEEN;
    let height = defect_top + DEFECT_HEIGHT + BELOW;

    let times = Range::of(points(&curves).map(|p| p.t), Range { lo: 0.0, hi: 1.0 });
    let times = if times.lo < times.hi { times } else { times.padded(0.1) };
    let x = Axis { scale: Scale::Linear, range: times, start: LEFT, end: WIDTH - RIGHT };
    let stacked = |scale, range, top, height| Frame {
        x,
        y: Axis { scale, range, start: top + height, end: top },
    };
    let value = stacked(Scale::Linear, value_range(&curves), value_top, VALUE_HEIGHT);
    let defect = stacked(Scale::Logarithmic, defect_range(&curves), defect_top, DEFECT_HEIGHT);

    canvas::page((WIDTH, height), &panel.title, |canvas| {
        legend.draw(canvas, LEFT, 2.0)?;
        let ticks = Ticks::decimal(times, 6);
        value.draw(canvas, &ticks, &Ticks::decimal(value.y.range, 5), false)?;
        defect.draw(canvas, &ticks, &defect_ticks(defect.y.range), true)?;
        value.title_left(canvas, main_quantity(panel))?;
        defect.title_left(canvas, "relative defect")?;
        defect.title_below(canvas, "time t")?;
        let mut from_below: Vec<(usize, &Curve)> = curves.iter().enumerate().collect();
        from_below.sort_by_key(|(_, curve)| curve.look.layer);
        for (n, curve) in from_below {
            let values = |p: &Sampled| value.place(p.t, p.value);
            let defects = |p: &Sampled| {
                let size = relative_defect(p.value, p.exact);
                defect.place(p.t, if size < FLOOR { FLOOR } else { size })
            };
            curve.draw(canvas, &value, values, n)?;
            curve.draw(canvas, &defect, defects, n)?;
        }
        // The law is drawn last and thin, so that it stays visible on the curves that follow it.
        if let Some(curve) = curves.iter().max_by_key(|c| c.points.len()) {
            let path: Vec<Position> =
                curve.points.iter().map(|p| value.place(p.t, p.exact)).collect();
            value.polyline(canvas, &path, law)?;
        }
        if points(&curves).next().is_none() {
            let centre = (0.5 * (x.start + x.end), value_top + 0.5 * VALUE_HEIGHT);
            canvas.label(&Label::words("no data"), centre, TITLE_SIZE, Align::Middle)?;
        }
        Ok(())
    })
}

fn curves(panel: &Panel) -> Vec<Curve> {
    let quantity = main_quantity(panel);
    let drawn = || panel.series.iter().filter(|s| s.quantity == quantity);
    let looks = look::of_schemes(drawn().map(|s| s.scheme.as_str()));
    drawn()
        .zip(looks)
        .map(|(series, look)| Curve {
            name: Label::words(&series.scheme),
            look,
            points: series.points.iter().filter_map(sampled).collect(),
        })
        .collect()
}

fn sampled(point: &Point) -> Option<Sampled> {
    match *point {
        Point::Value { t, value, exact } => t.is_finite().then_some(Sampled { t, value, exact }),
        Point::Error { .. } | Point::Cost { .. } => None,
    }
}

fn points(curves: &[Curve]) -> impl Iterator<Item = &Sampled> {
    curves.iter().flat_map(|c| &c.points)
}

/// Covers the law and the curves, except where a curve runs away so far that the law would become a
/// flat line.
fn value_range(curves: &[Curve]) -> Range {
    const EXCURSION: f64 = 2.0;
    let unit = Range { lo: 0.0, hi: 1.0 };
    let law = Range::of(points(curves).map(|p| p.exact), unit);
    let all = Range::of(points(curves).flat_map(|p| [p.value, p.exact]), unit);
    let reach = EXCURSION * (law.hi - law.lo).max(0.1 * law.hi.abs());
    let seen = if reach > 0.0 {
        Range { lo: all.lo.max(law.lo - reach), hi: all.hi.min(law.hi + reach) }
    } else {
        all
    };
    seen.padded(0.06)
}

fn defect_range(curves: &[Curve]) -> Range {
    let defects = points(curves).map(|p| relative_defect(p.value, p.exact));
    let hi = Range::of_positive(defects, Range { lo: FLOOR, hi: 1.0 }).hi;
    Range { lo: 0.4 * FLOOR, hi: (4.0 * hi).max(1e-14) }
}

/// Decades, and a zero at the floor with room around it.
fn defect_ticks(range: Range) -> Ticks {
    let mut ticks = Ticks::decades(range, 7);
    ticks.major.retain(|(value, _)| *value > 20.0 * FLOOR);
    ticks.minor.retain(|value| *value > 2.0 * FLOOR);
    ticks.major.push((FLOOR, Label::words("0")));
    ticks
}

impl Curve {
    /// Draws the curve with about ten markers, which no two curves carry at the same times.
    fn draw(
        &self,
        canvas: &mut Canvas,
        frame: &Frame,
        place: impl Fn(&Sampled) -> Position,
        n: usize,
    ) -> Result<()> {
        let path: Vec<Position> = self.points.iter().map(place).collect();
        frame.polyline(canvas, &path, self.look.line(1.1))?;
        let stride = (path.len() / 10).max(1);
        let first = (n * stride / 3 + stride / 6) % stride;
        for at in path.iter().skip(first).step_by(stride).filter(|at| frame.holds(**at)) {
            canvas.marker(*at, self.look, self.look.radius(2.6), self.look.hollow())?;
        }
        Ok(())
    }
}
