//! **How often the answers of this workspace are true.**
//!
//! [`library`] asks for orders, errors and expectations of problems with exactly known answers,
//! with many seeds. [`coverage()`] counts how often the intervals of `stats` cover the truth.
//! [`twins`] are wrong methods that the statements of `verify` must refute. The program `battery`
//! (`cargo xtask verify`) asks all of it, and `verify`'s statements for many seeds, and writes the
//! [`page`], `docs/verification.md`.

mod budget;
mod coverage;
pub mod library;
pub mod page;
pub mod twins;

pub use coverage::coverage;
