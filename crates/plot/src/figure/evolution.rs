//! An invariant along one path: its value with the conformal law above, the relative defect of the
//! law below.

use stats::Point;

use super::{
    axis::{Axis, Range, Scale},
    canvas::INK,
    frame::Frame,
    legend::Sample,
    look,
    plain::{Plain, UNIT},
    stroke::Stroke,
    ticks::Ticks,
};
use crate::{
    Series,
    label::Label,
    series::{main_quantity, relative_defect},
};

/// Where a defect of zero is drawn: below 2⁻⁵³ ≈ 1.1·10⁻¹⁶, the smallest defect of a floating-point
/// number that is not zero.
const FLOOR: f64 = 1e-17;

const VALUE_HEIGHT: f64 = 112.0;
const DEFECT_HEIGHT: f64 = 132.0;
const BETWEEN: f64 = 10.0;

/// Values that differ by less than this part of them are drawn as one.
const ROUNDING: f64 = 1e-9;

/// A point of the path.
struct Sampled {
    time: f64,
    value: f64,
    law: f64,
    defect: f64,
}

/// The figure of an invariant along one path as an SVG document; of several quantities the first
/// is drawn.
pub fn evolution(title: &str, series: &[Series]) -> String {
    let quantity = main_quantity(series);
    let drawn: Vec<&Series> = series.iter().filter(|s| s.quantity == quantity).collect();
    let looks = look::of_schemes(&drawn.iter().map(|s| s.scheme.as_str()).collect::<Vec<_>>());
    let point = |point: &Point| match *point {
        Point::Value { t: time, value, exact: law } if time.is_finite() => {
            Some(Sampled { time, value, law, defect: relative_defect(value, law) })
        }
        _ => None,
    };
    let sampled = |series: &&Series| series.points.iter().filter_map(point).collect();
    let curves: Vec<Vec<Sampled>> = drawn.iter().map(sampled).collect();

    let law = Stroke::new(INK, 0.7);
    let names = drawn.iter().map(|series| Label::words(&series.scheme));
    let entries = looks.iter().map(|look| Sample::Curve(*look)).zip(names);
    let entries = entries.chain([(Sample::Line(law), Label::words("conformal law"))]);
    let times = Range::of(curves.iter().flatten().map(|p| p.time), UNIT).or_padded();
    let (x, y) = ((times, None), (value_range(&curves), quantity));
    let mut plain = Plain::new(entries, VALUE_HEIGHT, x, y);
    let value = plain.frame;
    let (range, end) = (defect_range(&curves), value.y.start + BETWEEN);
    let y = Axis { scale: Scale::Logarithmic, range, start: end + DEFECT_HEIGHT, end };
    let defect = Frame { y, ..value };
    let x = (&Ticks::decimal(times, 6), Some("time t"));
    defect.draw(&mut plain.canvas, x, (&defect_ticks(range), Some("relative defect")));
    plain.frame = defect;
    let canvas = &mut plain.canvas;
    let mut from_below: Vec<_> = curves.iter().zip(looks).enumerate().collect();
    from_below.sort_by_key(|(_, (_, look))| look.layer);
    for (n, (curve, look)) in from_below {
        let values = curve.iter().map(|p| value.place(p.time, p.value));
        // A clamped NaN stays one.
        let floored = |p: &Sampled| p.defect.clamp(FLOOR, f64::INFINITY);
        let defects = curve.iter().map(|p| defect.place(p.time, floored(p)));
        // About ten markers, which no two curves carry at the same times.
        let stride = (curve.len() / 10).max(1);
        let first = (n * stride / 3 + stride / 6) % stride;
        for (frame, path) in [(&value, values.collect::<Vec<_>>()), (&defect, defects.collect())] {
            frame.polyline(canvas, &path, look.line(1.1));
            for at in path.iter().skip(first).step_by(stride).filter(|at| frame.holds(**at)) {
                canvas.marker(*at, look, look.radius(2.6), look.hollow());
            }
        }
    }
    // The law is drawn last and thin, so that it stays visible on the curves that follow it.
    let longest = curves.iter().max_by_key(|curve| curve.len()).into_iter().flatten();
    let path: Vec<_> = longest.map(|p| value.place(p.time, p.law)).collect();
    value.polyline(canvas, &path, law);
    if path.is_empty() {
        value.say(canvas, "no data");
    }
    plain.page(title, false)
}

/// Covers the law and the curves, except where a curve runs away so far that the law would become a
/// flat line.
fn value_range(curves: &[Vec<Sampled>]) -> Range {
    const EXCURSION: f64 = 2.0;
    let law = Range::of(curves.iter().flatten().map(|p| p.law), UNIT);
    let all = Range::of(curves.iter().flatten().flat_map(|p| [p.value, p.law]), UNIT);
    let reach = match EXCURSION * (law.hi - law.lo).max(0.1 * law.hi.abs()) {
        0.0 => f64::INFINITY,
        reach => reach,
    };
    let range = Range { lo: all.lo.max(law.lo - reach), hi: all.hi.min(law.hi + reach) };
    // Rounding errors of a constant are no range.
    let constant = range.hi - range.lo <= ROUNDING * range.hi.abs();
    let range = if constant { Range { lo: range.hi, hi: range.hi } } else { range };
    range.padded(0.06)
}

fn defect_range(curves: &[Vec<Sampled>]) -> Range {
    let defects = curves.iter().flatten().map(|p| p.defect);
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
