//! A quantity over the number of steps, in logarithmic coordinates, with the slopes of a random
//! walk and of a bias.

use anyhow::Result;

use super::axis::{Axis, Range, Scale};
use super::canvas::{self, GREY, Stroke};
use super::frame::Frame;
use super::legend::{Legend, Sample};
use super::look;
use super::ticks::Ticks;
use crate::report::label::Label;

/// A curve: positive numbers of steps with what grows.
#[derive(Clone, Debug)]
pub struct GrowthCurve {
    /// Its name in the legend.
    pub name: String,
    /// Points.
    pub points: Vec<(f64, f64)>,
}

const PLOT: (f64, f64) = (430.0, 260.0);
const LEFT: f64 = 50.0;
const RIGHT: f64 = 10.0;
const BELOW: f64 = 33.0;

/// Draws the curves with ε√n and εn beside them.
pub fn growth_figure(title: &str, curves: &[GrowthCurve]) -> Result<String> {
    let looks: Vec<_> = (0..curves.len()).map(look::of_quantity).collect();
    let mut entries: Vec<(Sample, Label)> = curves
        .iter()
        .zip(&looks)
        .map(|(curve, look)| (Sample::Curve(*look), Label::words(&curve.name)))
        .collect();
    let (walk, bias) = (Stroke::new(GREY, 1.0), Stroke::new(GREY, 1.0).dashed());
    entries.push((Sample::Line(walk), Label::words("ε √n")));
    entries.push((Sample::Line(bias), Label::words("ε n")));
    let legend = Legend::new(entries, PLOT.0);
    let top = legend.height() + 7.0;
    let points = || curves.iter().flat_map(|curve| &curve.points);
    let x = Range::of_positive(points().map(|p| p.0), Range { lo: 1.0, hi: 1e7 })
        .times(1.3)
        .with_two_decades();
    let y = Range::of_positive(points().map(|p| p.1), Range { lo: 1e-16, hi: 1e-12 })
        .times(2.0)
        .with_two_decades();
    let y = Range { hi: y.hi.max(f64::EPSILON * x.hi.sqrt()), ..y };
    canvas::page((LEFT + PLOT.0 + RIGHT, top + PLOT.1 + BELOW), title, |canvas| {
        legend.draw(canvas, LEFT, 2.0)?;
        let frame = Frame {
            x: Axis { scale: Scale::Logarithmic, range: x, start: LEFT, end: LEFT + PLOT.0 },
            y: Axis { scale: Scale::Logarithmic, range: y, start: top + PLOT.1, end: top },
        };
        frame.draw(canvas, &Ticks::decades(x, 8), &Ticks::decades(y, 8), true)?;
        frame.title_below(canvas, "steps n")?;
        frame.title_left(canvas, "root mean square distance from the law")?;
        let line = |power: f64| [x.lo, x.hi].map(|n| frame.place(n, f64::EPSILON * n.powf(power)));
        frame.polyline(canvas, &line(0.5), walk)?;
        frame.polyline(canvas, &line(1.0), bias)?;
        for (curve, look) in curves.iter().zip(&looks) {
            let places: Vec<_> = curve.points.iter().map(|p| frame.place(p.0, p.1)).collect();
            frame.polyline(canvas, &places, look.line(1.2))?;
            for at in places.into_iter().filter(|at| frame.holds(*at)) {
                canvas.marker(at, *look, look.radius(2.6), look.hollow())?;
            }
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn awkward_data_still_make_a_figure() -> Result<()> {
        for points in [
            vec![],
            vec![(1.0, 0.0)],
            vec![(f64::NAN, 1.0), (1e9, f64::INFINITY)],
            vec![(1.0, 1e-300), (2.0, 1e300)],
        ] {
            let figure = growth_figure("A & B", &[GrowthCurve { name: "one".into(), points }])?;
            assert!(figure.starts_with("<svg") && figure.trim_end().ends_with("</svg>"));
        }
        Ok(())
    }
}
