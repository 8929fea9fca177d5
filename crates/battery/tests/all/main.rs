//! Whether answers are true: coverage, problems with known answers, twins. One program, so that its
//! tests run side by side.

mod coverage;
mod library;
mod page;
mod twins;
