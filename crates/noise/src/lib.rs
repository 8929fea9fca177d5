//! **Wiener increments and Lévy areas that are reproducible to the bit, in any block, on any thread
//! and on any machine.**
//!
//! Every path has its own xoshiro256++ stream with the key (seed, experiment, path). A
//! [`WienerBlock`] draws normals for 32 paths at once by Box–Muller, and a [`WienerPath`] draws
//! those of one path alone. [`Truncation`] clips increments as implicit schemes require. A
//! [`DyadicLadder`] sums the increments of the finest steps over the coarser steps of a convergence
//! study, so that noise is drawn once and not stored.
//!
//! The way through the crate: key → `stream` (words) → `box_muller` (normals) → `wiener`
//! (increments) → `ladder` (sums over steps) → `truncation`; increments → `area_sampler` (Lévy
//! areas by as many terms as `area_terms` says) → `area` (joined over steps). `sobol` points →
//! `inverse_normal` → `quasi_wiener` (increments by a Brownian bridge). `step` has the noise of one
//! step.
//!
//! ```
//! use noise::{StreamKey, Truncation, WienerBlock, WienerPath};
//! use real::Block;
//!
//! let key = StreamKey { seed: 1, experiment: 7 };
//! let tau: f64 = 1.0 / 256.0;
//! let mut block = WienerBlock::<3>::new(key, 0); // paths 0..32, three noises
//! let mut dw = Block::zero();
//! block.increments(tau.sqrt(), &mut dw);
//!
//! // Path 17 alone has the same increments.
//! let mut path = WienerPath::<3>::new(key, 17);
//! assert_eq!(path.increments(tau.sqrt()), dw.path(17));
//!
//! // |ΔŴ| ≤ √τ·√(2k|log τ|).
//! let bound = Truncation::new(4)?.bound(tau)?;
//! assert_eq!(bound, tau.sqrt() * (8.0 * tau.ln().abs()).sqrt());
//! # Ok::<(), noise::NoiseError>(())
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`StreamKey`] | identifies the random streams of an experiment |
//! | [`WienerBlock`], [`WienerPath`] | normal increments of 32 paths, of one path |
//! | [`WienerRows`] | increments of noises whose number is known at run time only |
//! | [`StepNoise`] | increments and Lévy areas of one step on 32 paths |
//! | [`BlockNoise`], [`Noise`] | the same for a compiled kernel, and of one path |
//! | [`QuasiWiener`] | increments from scrambled Sobol points, by a Brownian bridge |
//! | [`ScrambledSobol`], [`inverse_normal`] | the points, and the normal of a word |
//! | [`Truncation`], [`clip`] | truncated increments ΔŴ |
//! | [`DyadicLadder`], [`AreaLadder`] | increments and areas of all coarser steps |
//! | [`area_terms`], [`area_error`] | terms of the series of an area, and its error |
//! | [`AreaSampler`], [`AreaPath`] | Lévy areas given the increments, of 32 paths, of one path |
//! | [`join`], [`clip_areas`] | Chen's relation, truncated areas |
//! | [`stratonovich`], [`ito`] | iterated integrals of one path |

mod area;
mod area_sampler;
mod area_terms;
mod box_muller;
mod error;
mod inverse_normal;
mod iterated;
mod ladder;
mod quasi_wiener;
mod sobol;
mod step;
mod stream;
mod truncation;
mod wiener;

pub use area::{AreaLadder, clip_areas, join};
pub use area_sampler::{AREA_STREAM, AreaPath, AreaSampler};
pub use area_terms::{MOST_AREA_TERMS, area_error, area_terms, strong_order_one_error};
pub use error::NoiseError;
pub use inverse_normal::inverse_normal;
pub use iterated::{ito, stratonovich};
pub use ladder::DyadicLadder;
pub use quasi_wiener::QuasiWiener;
pub use sobol::ScrambledSobol;
pub use step::{BlockNoise, Noise, StepNoise, skew};
pub use stream::StreamKey;
pub use truncation::{Truncation, clip};
pub use wiener::{WienerBlock, WienerPath, WienerRows};
