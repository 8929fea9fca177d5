//! How a line is drawn.

/// A place on the page in CSS pixels, from the upper left corner.
pub type Position = (f64, f64);

/// A colour in the notation of SVG.
pub type Color = &'static str;

/// Colour, width, opacity and continuity of a line.
#[derive(Clone, Copy)]
pub struct Stroke {
    /// Colour.
    pub color: Color,
    /// Width in pixels.
    pub width: f64,
    /// 1 is opaque.
    pub opacity: f64,
    /// Whether it is broken into dashes.
    pub dashed: bool,
}

impl Stroke {
    /// An opaque stroke without gaps.
    pub fn new(color: Color, width: f64) -> Self {
        Self { color, width, opacity: 1.0, dashed: false }
    }

    /// The same stroke in dashes.
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    /// The same stroke, partly transparent.
    pub fn faded(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}
