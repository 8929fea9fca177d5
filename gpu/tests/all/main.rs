//! Kernels against the processor, by an interpreter of their PTX.

mod bits;
mod interpreter;
mod studies;
