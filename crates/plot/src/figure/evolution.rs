//! An invariant along one path: its value with the conformal law above, the relative defect of the
//! law below.

use stats::Point;

use super::*;
use crate::series::{Series, main_quantity, relative_defect};

/// Value at which a defect of zero is drawn: below 2⁻⁵³ ≈ 1.1·10⁻¹⁶, the smallest nonzero defect of
/// a floating-point number.
const FLOOR: f64 = 1e-17;

const VALUE_HEIGHT: f64 = 112.0;
const DEFECT_HEIGHT: f64 = 132.0;
const BETWEEN: f64 = 10.0;

/// The figure of an invariant along one path as an SVG document; of several quantities the first
/// is drawn.
pub fn evolution(title: &str, series: &[Series]) -> String {
    let quantity = main_quantity(series);
    let drawn: Vec<&Series> = series.iter().filter(|s| s.quantity == quantity).collect();
    let names: Vec<&str> = drawn.iter().map(|series| &*series.scheme).collect();
    let looks = of_schemes(&names);
    // Times, values and laws.
    let point = |point: &Point| match *point {
        Point::Value { t, value, exact } if t.is_finite() => Some([t, value, exact]),
        _ => None,
    };
    let curves = drawn.iter().map(|series| series.points.iter().filter_map(point).collect());
    let curves: Vec<Vec<_>> = curves.collect();
    let all = || curves.iter().flatten();
    let defect = |[_, value, law]: [f64; 3]| relative_defect(value, law);

    let law = Stroke::new(INK, 0.7);
    let entries = looks.iter().map(|look| Sample::Curve(*look)).zip(names);
    let entries = entries.chain([(Sample::Line(law), "conformal law")]);
    let times = Axis::of(all().map(|p| p[0]), 0.0);
    let y = (Axis::linear(value_range(&curves)), quantity);
    let mut plain = Plain::new(entries, VALUE_HEIGHT, (times, None), y);
    let values = plain.frame;
    let largest = Range::of_positive(all().map(|p| defect(*p)), UNIT).hi;
    let range = Range { lo: 0.4 * FLOOR, hi: (4.0 * largest).max(1e-14) };
    let end = values.y.start + BETWEEN;
    let y = Axis { logarithmic: true, range, start: end + DEFECT_HEIGHT, end };
    let defects = Frame { y, ..values };
    // Decades, and a zero at the floor with room around it.
    let mut ticks = Ticks::decades(range, 7);
    ticks.major.retain(|(value, _)| *value > 20.0 * FLOOR);
    ticks.minor.retain(|value| *value > 2.0 * FLOOR);
    ticks.major.push((FLOOR, Label::words("0")));
    let x = (&times.ticks(6), Some("time t"));
    defects.draw(&mut plain.canvas, x, (&ticks, Some("relative defect")));
    plain.frame = defects;
    let canvas = &mut plain.canvas;
    let mut from_below: Vec<_> = curves.iter().zip(looks).enumerate().collect();
    from_below.sort_by_key(|(_, (_, look))| look.layer);
    for (n, (curve, look)) in from_below {
        // A clamped NaN stays one.
        let floored = |p: &[f64; 3]| defects.place(p[0], defect(*p).clamp(FLOOR, f64::INFINITY));
        // About ten markers, which no two curves carry at the same times.
        let stride = (curve.len() / 10).max(1);
        let first = (n * stride / 3 + stride / 6) % stride;
        let path = values.places(curve.iter().map(|p| (p[0], p[1])));
        for (frame, path) in [(values, path), (defects, curve.iter().map(floored).collect())] {
            frame.polyline(canvas, &path, look.line(1.1));
            for at in path.iter().skip(first).step_by(stride).filter(|at| frame.holds(**at)) {
                canvas.marker(*at, look, look.radius(2.6));
            }
        }
    }
    // The law is drawn last and thin, so that it stays visible on the curves that follow it.
    let longest = curves.iter().max_by_key(|curve| curve.len()).into_iter().flatten();
    let path = values.places(longest.map(|p| (p[0], p[2])));
    values.polyline(canvas, &path, law);
    if path.is_empty() {
        values.say(canvas, "no data");
    }
    plain.page(title, false)
}

/// Range of values: covers the law and the curves, except where a curve runs away so far that the
/// law would become a flat line.
fn value_range(curves: &[Vec<[f64; 3]>]) -> Range {
    let law = Range::of(curves.iter().flatten().map(|p| p[2]), UNIT);
    let all = Range::of(curves.iter().flatten().flat_map(|p| [p[1], p[2]]), UNIT);
    let mut reach = 2.0 * (law.hi - law.lo).max(0.1 * law.hi.abs());
    if reach == 0.0 {
        reach = f64::INFINITY;
    }
    let (lo, hi) = (all.lo.max(law.lo - reach), all.hi.min(law.hi + reach));
    // Rounding errors of a constant are no range.
    let constant = hi - lo <= 1e-9 * hi.abs();
    Range { lo: if constant { hi } else { lo }, hi }.padded(0.06)
}
