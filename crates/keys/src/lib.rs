//! **Keys of scene files, with their values: read, checked, placed in the text.**
//!
//! [`parse`] reads the keys of a text into a [`SceneFile`]. Values are still texts there, each with
//! its place ([`At`]). [`Constants`] are the parameters, [`Settings`] those of a run, and a
//! [`Vocabulary`] makes [`Observable`]s of formulas. Errors are [`Wrong`] until the [`Source`] is
//! named; a [`SceneError`] shows the line.
//!
//! ```
//! use keys::{Constants, parse};
//!
//! let text = r#"
//! [system]
//! state = ["q", "p"]
//! B = [["1"]]
//! H0 = "(q^2 + p^2)/2"
//! parameters = { T = 2 }
//! [run]
//! initial = [1, 0]
//! until = "3*T"
//! steps = 64
//! "#;
//! let file = parse(text).map_err(|wrong| wrong.message)?;
//! let constants = Constants::new(&file.system).map_err(|wrong| wrong.message)?;
//! assert_eq!(constants.value(&file.run.until).map_err(|wrong| wrong.message)?, 6.0);
//! # Ok::<(), String>(())
//! ```

mod file;
mod initial;
mod observe;
mod read;
mod run;
mod shorthand;
mod source;
mod values;

pub use file::*;
pub use observe::*;
pub use read::*;
pub use run::*;
pub use shorthand::*;
pub use source::*;
pub use values::*;
