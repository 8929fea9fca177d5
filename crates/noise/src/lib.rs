//! **Wiener increments and Lévy areas that are reproducible to the bit, in any block, on any thread
//! and on any machine.**
//!
//! Every path has its own xoshiro256++ stream with the key (seed, experiment, path). A
//! [`WienerRows`] draws normals for 32 paths at once by Box–Muller, and a [`WienerPath`] draws
//! those of one path alone. [`Truncation`] clips increments as implicit schemes require. A
//! [`DyadicLadder`] joins the noise of the finest steps over the coarser steps of a convergence
//! study, so that noise is drawn once and not stored.
//!
//! The way through the crate: key → `stream` (words) → `box_muller` (normals) → `wiener`
//! (increments) → `area_sampler` (Lévy areas, terms by `area_terms`) → `ladder` (joined over steps)
//! → `truncation` and `area`. `sobol` points → `inverse_normal` → `quasi_wiener` (increments by a
//! Brownian bridge). `step` has the noise of one step.
//!
//! ```
//! use noise::{StepNoise, StreamKey, Truncation, WienerPath, WienerRows};
//!
//! let key = StreamKey { seed: 1, experiment: 7 };
//! let tau: f64 = 1.0 / 256.0;
//! let (mut wiener, mut noise) = (WienerRows::new(key, 0), StepNoise::zero(3)); // paths 0..32
//! wiener.increments(tau.sqrt(), &mut noise.increments);
//!
//! // Path 17 alone has the same increments.
//! let mut path = WienerPath::<3>::new(key, 17);
//! assert_eq!(path.increments(tau.sqrt()), noise.path::<3>(17).increments);
//!
//! // |ΔŴ| ≤ √τ·√(2k|log τ|).
//! let bound = Truncation::new(4)?.bound(tau)?;
//! assert_eq!(bound, tau.sqrt() * (8.0 * tau.ln().abs()).sqrt());
//! # Ok::<(), noise::NoiseError>(())
//! ```
//!
//! There is another crate `noise`, for textures. Beside it this one needs a name of its own in
//! `Cargo.toml`, `wiener = { package = "casimir-noise", version = "0.1" }`, and is then `wiener` in
//! the place of `noise`.
//!
//! | item | purpose |
//! |---|---|
//! | [`StreamKey`], [`Purpose`] | identifies the random streams of an experiment, and what for |
//! | [`WienerRows`], [`WienerPath`] | normal increments of 32 paths, of one path |
//! | [`StepNoise`] | increments and Lévy areas of one step on 32 paths |
//! | [`BlockNoise`], [`Noise`] | the same for a compiled kernel, and of one path |
//! | [`QuasiWiener`] | increments from scrambled Sobol points, by a Brownian bridge |
//! | [`ScrambledSobol`], [`inverse_normal`] | the points, and the normal of a word |
//! | [`Truncation`], [`clip`] | truncated increments ΔŴ and areas |
//! | [`DyadicLadder`] | increments and areas of all coarser steps |
//! | [`area_terms`], [`area_error`] | terms of the series of an area, and its error |
//! | [`AreaSampler`], [`AreaPath`] | Lévy areas given the increments, of 32 paths, of one path |
//! | [`join`] | Chen's relation |

pub use real;

mod area;
mod area_sampler;
mod area_terms;
mod box_muller;
mod error;
mod inverse_normal;
mod ladder;
mod quasi_wiener;
mod sobol;
mod step;
mod stream;
mod truncation;
mod wiener;

pub use area::join;
pub use area_sampler::{AreaPath, AreaSampler};
pub use area_terms::{MAX_AREA_TERMS, area_error, area_terms, strong_order_one_error};
pub use error::NoiseError;
pub use inverse_normal::inverse_normal;
pub use ladder::DyadicLadder;
pub use quasi_wiener::QuasiWiener;
pub use sobol::ScrambledSobol;
pub use step::{BlockNoise, Noise, StepNoise, skew};
pub use stream::{GOLDEN, Purpose, StreamKey, mix};
pub use truncation::{Truncation, clip};
pub use wiener::{WienerPath, WienerRows};
