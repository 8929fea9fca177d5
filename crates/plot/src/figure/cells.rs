//! Numbers as colours of cells: joint laws, and lattices at several times.

use super::{
    axis::{Axis, Range},
    canvas::{Align, Canvas},
    frame::{BELOW, Frame, Plain, RIGHT, UNIT, WIDTH},
    look::{BLUE, VERMILLION},
    ticks::Ticks,
};
use crate::label::Label;

/// Shades of a colour.
const SHADES: usize = 16;

/// Draws cells in a frame, row by row from below: blue where they are positive, red where they are
/// negative, the darker the larger.
fn draw(canvas: &mut Canvas, frame: &Frame, columns: usize, values: &[f64]) {
    let largest = Range::of(values.iter().map(|x| x.abs()), UNIT).hi;
    let rows = values.len().div_ceil(columns.max(1));
    let width = (frame.x.end - frame.x.start) / columns as f64;
    let height = (frame.y.start - frame.y.end) / rows as f64;
    let place = |k: usize| {
        let (x, y) = ((k % columns) as f64, (k / columns) as f64);
        let left = frame.x.start + x * width;
        let bottom = frame.y.start - y * height;
        ((left, bottom - height), (left + width, bottom))
    };
    let shade = |x: f64| (SHADES as f64 * x.abs() / largest).ceil().min(SHADES as f64);
    for (color, sign) in [(BLUE, 1.0), (VERMILLION, -1.0)] {
        for level in 1..=SHADES {
            let of_level = |x: f64| x * sign > 0.0 && shade(x) == level as f64;
            let boxes = values.iter().enumerate().filter(|(_, x)| of_level(**x));
            let boxes: Vec<_> = boxes.map(|(k, _)| place(k)).collect();
            if !boxes.is_empty() {
                canvas.boxes(&boxes, color, level as f64 / SHADES as f64);
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
    let range = |(lo, hi)| Range { lo, hi };
    let none = std::iter::empty();
    let mut plain = Plain::new(none, 230.0, (range(x), Some(x_title)), (range(y), y_title));
    draw(&mut plain.canvas, &plain.frame, columns, values);
    plain.page(title, values.is_empty())
}

/// Pictures in a row, room between them, and above each for its name.
const PICTURES: usize = 3;
const GAP: f64 = 10.0;
const NAME: f64 = 16.0;

/// Pictures of a plane at several times as an SVG document, each with its name.
pub fn strip(title: &str, columns: usize, pictures: &[(String, Vec<f64>)]) -> String {
    let across = PICTURES.min(pictures.len()).max(1);
    let width = (WIDTH - RIGHT - GAP * across as f64) / across as f64;
    let rows = pictures.first().map_or(1, |(_, values)| values.len().div_ceil(columns.max(1)));
    let height = width * rows as f64 / columns.max(1) as f64;
    let mut canvas = Canvas::default();
    for (k, (name, values)) in pictures.iter().enumerate() {
        let left = GAP + (width + GAP) * (k % across) as f64;
        let top = NAME + (NAME + height) * (k / across) as f64;
        let axis = |start, end| Axis { logarithmic: false, range: UNIT, start, end };
        let frame = Frame { x: axis(left, left + width), y: axis(top + height, top) };
        draw(&mut canvas, &frame, columns, values);
        let none = (&Ticks::default(), None);
        frame.draw(&mut canvas, none, none);
        canvas.label(&Label::words(name), (left + 0.5 * width, top - 8.0), 9.0, Align::Middle);
    }
    let down = pictures.len().div_ceil(across) as f64;
    canvas.page((WIDTH, (NAME + height) * down + 0.3 * BELOW), title)
}
