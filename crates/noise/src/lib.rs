//! **Wiener increments that are the same bits in any block, on any thread, on any machine.**
//!
//! Every path has its own xoshiro256++ stream, keyed by (seed, experiment, path). A [`WienerBlock`]
//! advances the streams of 32 paths together and turns them into normals by Box–Muller;
//! [`WienerPath`] replays one path alone. [`Truncation`] clips increments as implicit schemes need,
//! and [`DyadicLadder`] sums fine increments up to every coarser step of a convergence study, drawn
//! once and stored nowhere.
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
//! | item | job |
//! |---|---|
//! | [`StreamKey`] | which stream a path draws from |
//! | [`WienerBlock`], [`WienerPath`] | normal increments for 32 paths, for one path |
//! | [`Noise`], [`BlockNoise`] | increments and Lévy areas of one step |
//! | [`Truncation`], [`clip`] | ΔŴ = √τ χ(ΔW/√τ) |
//! | [`DyadicLadder`] | sums of fine increments over all coarser steps |
//! | [`AreaMethod`] | which approximation of the Lévy areas and how many terms: errors and costs as formulas |
//! | [`AreaSampler`], [`AreaPath`] | Lévy areas given the increments, for 32 paths, for one path |
//! | [`ExactArea`] | the area of two noises from its characteristic function |
//! | [`AreaBlock`], [`AreaLadder`], [`join`] | Lévy areas, and those of coarser steps by Chen's relation |
//! | [`stratonovich`], [`ito`] | iterated integrals of one path |
//!
//! With several noises a method of strong order one needs the Lévy areas, too. Their error may be
//! h^{3/2} in each step:
//!
//! ```
//! use noise::{AreaBlock, AreaMethod, AreaPath, AreaSampler, StreamKey, WienerBlock, stratonovich, strong_order_one_error};
//! use real::Block;
//!
//! let key = StreamKey { seed: 1, experiment: 7 };
//! let tau: f64 = 1.0 / 4096.0;
//! let (method, terms) = AreaMethod::cheapest(strong_order_one_error(tau), tau, 3)?;
//! assert_eq!((method, terms), (AreaMethod::MrongowiusRoessler, 11));
//!
//! let mut noise = WienerBlock::<3>::new(key, 0);
//! let mut sampler = AreaSampler::<3>::new(key, 0, method, terms); // streams of its own
//! let (mut dw, mut areas) = (Block::zero(), AreaBlock::zero());
//! noise.increments(tau.sqrt(), &mut dw);
//! sampler.areas(tau, &dw, &mut areas);
//!
//! // Path 17 alone has the same areas; J_ij + J_ji = W_i W_j.
//! let mut path = AreaPath::<3>::new(key, 17, method, terms);
//! let (w, a) = (dw.path(17), path.areas(tau, dw.path(17)));
//! assert_eq!(a, areas.path(17));
//! let j = stratonovich(w, a);
//! assert!((j[0][2] + j[2][0] - w[0] * w[2]).abs() < 1e-18);
//! # Ok::<(), noise::NoiseError>(())
//! ```

mod area;
mod area_method;
mod area_sampler;
mod error;
mod exact_area;
mod iterated;
mod ladder;
mod step;
mod stream;
mod truncation;
mod wiener;

pub use area::{AreaBlock, AreaLadder, join};
pub use area_method::{AreaMethod, strong_order_one_error};
pub use area_sampler::{AREA_STREAM, AreaPath, AreaSampler};
pub use error::NoiseError;
pub use exact_area::ExactArea;
pub use iterated::{ito, stratonovich};
pub use ladder::DyadicLadder;
pub use step::{BlockNoise, Noise};
pub use stream::StreamKey;
pub use truncation::{Truncation, clip};
pub use wiener::{WienerBlock, WienerPath};
