//! **Wiener increments that are the same bits in any block, on any thread, on any machine.**
//!
//! Every path has its own xoshiro256++ stream, keyed by (seed, experiment, path). A [`WienerBlock`] advances the
//! streams of 32 paths together and turns them into normals by Box–Muller; [`WienerPath`] replays one path
//! alone. [`Truncation`] clips increments as implicit schemes need, and [`DyadicLadder`] sums fine increments up
//! to every coarser step of a convergence study, drawn once and stored nowhere.
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
//! | [`Truncation`], [`clip`] | ΔŴ = √τ χ(ΔW/√τ) |
//! | [`DyadicLadder`] | sums of fine increments over all coarser steps |
//! | [`AreaBlock`], [`AreaLadder`], [`join`] | Lévy areas, and those of coarser steps by Chen's relation |

mod area;
mod error;
mod ladder;
mod stream;
mod truncation;
mod wiener;

pub use area::{AreaBlock, AreaLadder, join};
pub use error::NoiseError;
pub use ladder::DyadicLadder;
pub use stream::StreamKey;
pub use truncation::{Truncation, clip};
pub use wiener::{WienerBlock, WienerPath};
