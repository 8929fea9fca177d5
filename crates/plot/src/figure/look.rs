//! Colours, markers and weights of curves: fixed for the known schemes, distinct for every other.
//!
//! Two methods may give the same numbers to the eye. One of such a pair is drawn wide with open
//! markers underneath, the other thin and dashed with small markers on top, so that each shows
//! through the other.

use Layer::{Over, Plain, Under};

use super::*;

/// Corners of a marker of radius one; empty for a circle. The areas are about that of the circle,
/// so that no curve looks more important than another.
pub type Marker = &'static [Position];

pub const CIRCLE: Marker = &[];
const SQUARE: Marker = &[(-0.89, -0.89), (0.89, -0.89), (0.89, 0.89), (-0.89, 0.89)];
const DIAMOND: Marker = &[(0.0, -1.3), (1.3, 0.0), (0.0, 1.3), (-1.3, 0.0)];
const TRIANGLE: Marker = &[(0.0, -1.4), (1.25, 0.85), (-1.25, 0.85)];
const WEDGE: Marker = &[(0.0, 1.4), (1.25, -0.85), (-1.25, -0.85)];
const STAR: Marker = &[
    (0.0, -1.5),
    (0.45, -0.45),
    (1.5, 0.0),
    (0.45, 0.45),
    (0.0, 1.5),
    (-0.45, 0.45),
    (-1.5, 0.0),
    (-0.45, -0.45),
];

/// Layer of a curve among curves that may coincide; ordered from below.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Layer {
    /// Wide pale line, large open markers.
    Under,
    /// Plain line and markers.
    Plain,
    /// Thin dashed line, small markers.
    Over,
}

/// Appearance of a curve.
#[derive(Clone, Copy, PartialEq)]
pub struct Look {
    /// Colour of the line and the marker.
    pub color: Color,
    /// Shape of the marker.
    pub marker: Marker,
    /// Layer of the curve, which decides whether it is seen below or above another one.
    pub layer: Layer,
}

const fn look(color: Color, marker: Marker, layer: Layer) -> Look {
    Look { color, marker, layer }
}

impl Look {
    /// Stroke of the curve, where the line of a plain curve has the width `width`.
    pub fn line(self, width: f64) -> Stroke {
        let plain = Stroke::new(self.color, width);
        match self.layer {
            // Pale, so that dashes of a colour as dark as its own stand out on it.
            Under => Stroke { width: 2.3 * width, opacity: 0.5, ..plain },
            Plain => plain,
            Over => plain.dashed(),
        }
    }

    /// Radius of the markers of the curve, where that of a plain curve is `radius`.
    pub fn radius(self, radius: f64) -> f64 {
        match self.layer {
            Under => 1.35 * radius,
            Plain => radius,
            Over => 0.8 * radius,
        }
    }

    /// Whether the markers of the curve are hollow.
    pub fn hollow(self) -> bool {
        self.layer == Under
    }
}

// The palette of Okabe and Ito, which readers with any colour vision can tell apart.
pub const BLUE: Color = "#0072B2";
pub const VERMILLION: Color = "#D55E00";
const GREEN: Color = "#009E73";
const PURPLE: Color = "#CC79A7";
const ORANGE: Color = "#E69F00";
const SKY: Color = "#56B4E9";
const BLACK: Color = "#000000";

/// Schemes that look the same on every figure.
const SCHEMES: [(&str, Look); 7] = [
    ("sexp", look(BLUE, CIRCLE, Under)),
    ("em", look(VERMILLION, SQUARE, Plain)),
    ("midpoint", look(GREEN, DIAMOND, Over)),
    ("sexp-levy", look(PURPLE, TRIANGLE, Plain)),
    ("heun", look(ORANGE, WEDGE, Plain)),
    ("sexp-li", look(SKY, CIRCLE, Under)),
    ("split", look(BLACK, STAR, Over)),
];

/// Looks of quantities.
const QUANTITIES: [Look; 5] = [
    look(BLACK, CIRCLE, Plain),
    look(ORANGE, SQUARE, Plain),
    look(PURPLE, TRIANGLE, Plain),
    look(SKY, DIAMOND, Plain),
    look(GREEN, WEDGE, Plain),
];

/// Looks of the schemes in `names`, one for each different scheme: an unknown one takes the first
/// look after the first three that no scheme has yet.
pub fn of_schemes(names: &[&str]) -> Vec<Look> {
    let spare = &SCHEMES[3..];
    let free = spare.iter().filter(|(id, _)| !names.contains(id));
    let mut unknown = free.chain(spare.iter().cycle());
    let look = |name| SCHEMES.iter().find(|(id, _)| id == name).or_else(|| unknown.next());
    names.iter().filter_map(look).map(|(_, look)| *look).collect()
}

/// Looks of quantities, repeated where there are more quantities than looks.
pub fn of_quantities(number: usize) -> Vec<Look> {
    QUANTITIES.into_iter().cycle().take(number).collect()
}
