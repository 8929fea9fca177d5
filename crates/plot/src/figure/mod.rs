//! Figures as stand-alone SVG documents, readable at the width of a journal column.
//!
//! [`Figure`] draws any curves in logarithmic coordinates; [`convergence`] makes one from series of
//! errors; [`evolution`] draws an invariant along a path; [`comparison`] errors against cost;
//! [`bands`] and [`histogram`] what a study found of an observable, [`lines()`] any curves in plain
//! coordinates.

mod axis;
mod bands;
mod canvas;
mod chart;
mod convergence;
mod cost;
mod evolution;
mod frame;
mod histogram;
mod legend;
mod lines;
mod look;
mod plain;
mod scripts;
mod stroke;
mod ticks;

pub use bands::bands;
pub use chart::{Curve, Figure, Line, Measured, Plot, Style};
pub use convergence::convergence;
pub use cost::comparison;
pub use evolution::evolution;
pub use histogram::histogram;
pub use lines::{Trace, lines};
pub use ticks::Spacing;

#[cfg(test)]
pub(crate) mod tests;
