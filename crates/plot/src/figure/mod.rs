//! Figures as stand-alone SVG documents, readable at the width of a journal column.
//!
//! [`convergence`] draws series of errors against the step size; [`comparison`] errors against
//! cost; [`evolution`] an invariant along a path; [`bands`] and [`histogram`] what a study found of
//! an observable, [`against`] and [`multiples`] how it depends on a parameter, [`picture`] and
//! [`strip`] numbers as colours, [`lines()`] any curves in plain coordinates.

mod axis;
mod canvas;
mod cells;
mod chart;
mod convergence;
mod evolution;
mod frame;
mod legend;
mod lines;
mod look;
mod study;
mod sweep;
mod ticks;

pub use cells::{picture, strip};
pub use convergence::{comparison, convergence};
pub use evolution::evolution;
pub use frame::Title;
pub use lines::{Trace, lines};
pub use study::{bands, histogram};
pub use sweep::{Sampled, against, multiples};

#[cfg(test)]
pub(crate) mod tests;
