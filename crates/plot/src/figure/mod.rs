//! Figures as stand-alone SVG documents, readable at the width of a journal column.
//!
//! [`convergence`] draws series of errors against the step size, [`side_by_side`] any curves in
//! logarithmic coordinates; [`evolution`] an invariant along a path; [`bands`] and [`histogram`]
//! the law of a quantity, [`against`] and [`multiples`] how it depends on a parameter, [`picture`]
//! and [`strip`] numbers as colours, [`maps`] functions on a sphere, [`lines()`] any curves in
//! plain coordinates.

mod axis;
mod canvas;
mod cells;
mod chart;
mod convergence;
mod evolution;
mod frame;
mod globe;
mod law;
mod legend;
mod lines;
mod look;
mod sweep;
mod ticks;

pub use cells::{picture, strip};
pub use chart::{Curve, Measured, Plot, side_by_side};
pub use convergence::convergence;
pub use evolution::evolution;
pub use frame::Title;
pub use globe::{Projection, maps};
pub use law::{Bins, Law, bands, fitted, histogram, multiples};
pub use lines::{Trace, lines};
pub use sweep::{Sampled, against};

// What figures are drawn with.
use crate::label::Label;
use axis::{Axis, Range, UNIT};
use canvas::{Align, Canvas, Color, FAINT, GREY, INK, Position, Stroke};
use chart::{Figure, Line};
use frame::{BELOW, Frame, Plain, RIGHT, small};
use legend::{Sample, legend, of_curves};
use look::{BLUE, CIRCLE, Layer, Look, VERMILLION, of_quantities, of_schemes};
use sweep::ends;
use ticks::Ticks;

#[cfg(test)]
mod tests;
