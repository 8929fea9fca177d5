//! **One path of a large lattice on all threads, and what is measured of it.**
//!
//! [`LargePath`] is one path of a system whose rows hold one path, such as a
//! [`SpinLattice`](systems::lattice::SpinLattice) of ten million spins. [`Follow`] advances it,
//! measures [`Means`] at many times, [`Spectra`] at a few, and keeps all that in a checkpoint.
//!
//! ```
//! use std::sync::Arc;
//! use lattice::{Follow, LargePath};
//! use mc::parts::Stop;
//! use noise::{StreamKey, Truncation};
//! use schemes::SexpLi;
//! use systems::{Constant, lattice::{Couplings, Shape, SpinLattice}, run_time::Problem};
//!
//! let couplings = Couplings { exchange: 1.0, ..Couplings::default() };
//! let lattice = SpinLattice::one_path(Shape::periodic(&[20, 20])?, couplings)?;
//! let scheme = SexpLi::at_run_time(&lattice)?;
//! let y0 = [0.0, 0.6, 0.8].repeat(400);
//! let problem = Problem::new(Arc::new(lattice.clone()), Arc::new(Constant::new(0.0)?), y0, 1.0)?;
//! let key = StreamKey { seed: 1, experiment: 0 };
//! let path = LargePath::new(&problem, &scheme, 20, Truncation::new(4)?, key, 0)?;
//! let follow = Follow { lattice: &lattice, steps: 20, every: 10, spectra_every: 20 };
//! let mut keep = |_: u64, _: &_| Ok(());
//! let found = follow.path(path, None, &Stop::default(), &|_| (), &mut keep)?;
//! // The ground state stays, with −J for each of two bonds of a spin.
//! assert_eq!((found.times.len(), found.at.len()), (3, 2));
//! assert!((found.means[2].energy + 2.0).abs() < 1e-14);
//! assert!((found.spectra[1].correlations[0][7] - 1.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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
