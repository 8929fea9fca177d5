//! The legend: rows above the plot, where no curve can reach it.

use super::*;

/// Font size in pixels.
const SIZE: f64 = 10.5;
/// Height of a row in pixels.
const ROW: f64 = 14.0;
/// Distance from one entry to the next.
const GAP: f64 = 9.0;

/// Sample in front of a name in the legend.
pub enum Sample {
    /// A line with a marker.
    Curve(Look),
    /// A line without markers.
    Line(Stroke),
    /// A marker without a line.
    Point(Look),
    /// An area of a colour and an opacity.
    Area(Color, f64),
}

/// Looks of curves, and their legend entries; a single curve has no entry.
pub fn of_curves<'a>(names: impl Iterator<Item = &'a str>) -> (Vec<Look>, Vec<(Sample, &'a str)>) {
    let names: Vec<&str> = names.collect();
    let looks = of_quantities(names.len());
    let shown = names.iter().filter(|_| names.len() > 1);
    (looks.clone(), looks.into_iter().map(Sample::Curve).zip(shown.copied()).collect())
}

/// Draws the entries in rows that begin at `left` and are no wider than `width`, and returns where
/// the plot below may begin.
pub fn legend(
    canvas: &mut Canvas,
    entries: impl IntoIterator<Item = (Sample, Label)>,
    left: f64,
    width: f64,
) -> f64 {
    let (mut x, mut height) = (f64::INFINITY, 0.0);
    for (sample, label) in entries {
        // Long enough for a dash on both sides of a marker.
        let length = if let Sample::Point(_) = sample { 7.0 } else { 17.5 };
        let needed = length + 4.0 + SIZE * label.width() + GAP;
        // The gap behind the last entry of a row may stick out.
        if x + needed > width + GAP {
            (x, height) = (0.0, height + ROW);
        }
        let (start, end, y) = (left + x, left + x + length, height - 0.5 * ROW + 2.0);
        let (line, middle) = ([(start, y), (end, y)], (0.5 * (start + end), y));
        match sample {
            Sample::Curve(look) => {
                canvas.polyline(&line, look.line(1.2));
                canvas.marker(middle, look, look.radius(2.8));
            }
            Sample::Line(stroke) => canvas.polyline(&line, stroke),
            Sample::Area(color, opacity) => {
                let corners = [(start, y - 4.0), (end, y - 4.0), (end, y + 4.0), (start, y + 4.0)];
                canvas.area(&corners, color, opacity);
            }
            Sample::Point(look) => canvas.marker(middle, look, 2.8),
        }
        canvas.label(&label, (end + 4.0, y), SIZE, Align::Left);
        x += needed;
    }
    height + 7.0
}
