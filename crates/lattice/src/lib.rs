//! **One path of a large lattice on all threads, and what is measured of it.**
//!
//! [`LargePath`] is one path of a system whose rows hold one path, such as a
//! [`SpinLattice`](systems::lattice::SpinLattice) of ten million spins. [`Follow`] advances it,
//! measures [`Means`] at many times, [`Spectra`] at a few, and keeps all that in a checkpoint.
//!
//! | item | purpose |
//! |---|---|
//! | [`LargePath`] | one path of a large system |
//! | [`Follow`], [`Record`] | a path with what is measured of it, which goes on after a kill |
//! | [`Means`] | magnetisation and energy per spin |
//! | [`Spectra`] | correlations by distance, and structure factors, along the axes |
//!
//! Sums are over pieces that are always the same, and Fourier transforms are those of this crate:
//! the bits depend neither on threads nor on the instruction set.

mod follow;
mod fourier;
mod large_path;
mod measure;

pub use follow::{Follow, Record};
pub use large_path::{LargePath, Work};
pub use measure::{Means, Spectra};
