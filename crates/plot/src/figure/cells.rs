//! Numbers as colours of cells: joint laws, and lattices at several times.

use super::*;

/// Shades of a colour.
const SHADES: usize = 12;

/// Draws cells in a frame, row by row from below: blue where they are positive, red where they are
/// negative, the darker the larger.
fn draw(canvas: &mut Canvas, frame: &Frame, columns: usize, values: &[f64]) {
    let largest = Range::of(values.iter().map(|x| x.abs()), UNIT).hi;
    let rows = values.len().div_ceil(columns.max(1));
    let width = (frame.x.end - frame.x.start) / columns as f64;
    let height = (frame.y.start - frame.y.end) / rows as f64;
    let place = |k: usize| {
        let (x, y) = ((k % columns) as f64, (k / columns) as f64);
        (frame.x.start + x * width, frame.y.start - (y + 0.5) * height)
    };
    let shade = |x: f64| (SHADES as f64 * x.abs() / largest).ceil().min(SHADES as f64);
    for (color, sign) in [(BLUE, 1.0), (VERMILLION, -1.0)] {
        for level in (1..=SHADES).map(|level| level as f64) {
            let of_level = |k: &usize| values[*k] * sign > 0.0 && shade(values[*k]) == level;
            let boxes: Vec<_> = (0..values.len()).filter(of_level).map(place).collect();
            if !boxes.is_empty() {
                canvas.boxes(&boxes, (width, height), color, level / SHADES as f64);
            }
        }
    }
}

/// A picture of numbers over two axes as an SVG document, in rows from below.
pub fn picture(
    title: &str,
    (x, x_title): ((f64, f64), &str),
    (y, y_title): ((f64, f64), &str),
    columns: usize,
    values: &[f64],
) -> String {
    let [x, y] = [x, y].map(|(lo, hi)| Axis::linear(Range { lo, hi }));
    let mut plain = Plain::new([], 230.0, (x, Some(x_title)), (y, y_title));
    draw(&mut plain.canvas, &plain.frame, columns, values);
    plain.page(title, values.is_empty())
}

/// Least width of a cell in pixels: narrower cells are joined to squares with their means.
const NARROWEST: f64 = 2.0;

/// Means over squares of `side` × `side` cells, which are cut off at the ends.
fn means(columns: usize, values: &[f64], side: usize) -> Vec<f64> {
    let (rows, across) = (values.len().div_ceil(columns.max(1)), columns.div_ceil(side));
    let mean = |k: usize| {
        let (x, y) = (k % across * side, k / across * side);
        let row = |y: usize| (x..columns.min(x + side)).map(move |x| y * columns + x);
        let cells = (y..rows.min(y + side)).flat_map(row).filter_map(|k| values.get(k));
        cells.clone().sum::<f64>() / cells.count() as f64
    };
    (0..across * rows.div_ceil(side)).map(mean).collect()
}

/// Pictures of a plane at several times as an SVG document, each with its name.
pub fn strip(title: &str, columns: usize, pictures: &[(String, Vec<f64>)]) -> String {
    let rows = pictures.first().map_or(1, |(_, values)| values.len().div_ceil(columns.max(1)));
    let height = |width: f64| width * rows as f64 / columns.max(1) as f64;
    let axes = [Axis::linear(UNIT); 2];
    small(title, pictures, axes, (RIGHT, RIGHT), height, |canvas, frame, _, values| {
        let width = frame.x.end - frame.x.start;
        let side = (NARROWEST * columns as f64 / width).ceil().max(1.0) as usize;
        draw(canvas, &frame, columns.div_ceil(side), &means(columns, values, side));
        let none = (&Ticks::default(), None);
        frame.draw(canvas, none, none);
    })
}
