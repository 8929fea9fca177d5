//! **How often the answers of this workspace are true.**
//!
//! [`library`] asks for orders, errors and expectations of problems with exactly known answers,
//! with many seeds. [`coverage()`] counts how often the intervals of `stats` cover the truth. The
//! program `battery` (`cargo xtask verify`) adds all statements of `lab` for many seeds and the
//! twins, wrong methods that the statements must refute, and writes `docs/verification.md`.

mod coverage;
pub mod library;

pub use coverage::coverage;
