//! Lines to compare curves with.

use super::canvas::GREY;
use super::stroke::Stroke;

/// The line `constant · x^power`, in grey; the first of a plot is dashed, the second solid.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its name in the legend.
    pub name: String,
    /// Value at x = 1.
    pub constant: f64,
    /// The slope in logarithmic coordinates.
    pub power: f64,
    /// Whether the vertical axis covers it over the range of the data; otherwise it is cut off.
    pub covered: bool,
}

impl Line {
    /// Its value at `x`.
    #[must_use]
    pub fn at(&self, x: f64) -> f64 {
        self.constant * x.powf(self.power)
    }

    /// How the `n`-th line of a plot is drawn.
    pub(super) fn stroke(n: usize) -> Stroke {
        let solid = Stroke::new(GREY, 1.0);
        if n.is_multiple_of(2) { solid.dashed() } else { solid }
    }
}
