//! **Formulas from text, evaluated on 32 points at a time, with their derivatives.**
//!
//! A text is parsed into a [`Graph`] of [`expression`], which has its derivatives, and evaluated as
//! a [`Tape`]. The texts of a [`Definition`] become a [`FormulaSystem`]: `system/expressions` has
//! each operation of a system as expressions, `system/flows` the parts whose flows are known, and
//! `system/program` makes one tape of a scheme's whole formula, or of a composition of flows.
//!
//! ```
//! use formula::{Formula, Names};
//!
//! let names = Names::with_variables(&["p", "q"])?;
//! let energy = Formula::parse("p^2/2 - cos(q)", &names)?;
//! let mut gradient = [0.0; 2];
//! energy.gradient(&[0, 1]).evaluate_one(&[&[3.0, 0.5]], &mut gradient);
//! assert!((gradient[0] - 3.0).abs() + (gradient[1] - 0.5f64.sin()).abs() < 1e-15);
//!
//! let error = Formula::parse("p^2/2 - 2cos(q)", &names).unwrap_err();
//! assert_eq!(error.to_string(), "\
//! line 1, column 10: an operator is missing: write 2*cos
//!   p^2/2 - 2cos(q)
//!            ^^^");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The language
//!
//! | | |
//! |---|---|
//! | numbers | `2`, `.5`, `1e-3` |
//! | names | variables, parameters, `pi`; letters of any alphabet, digits, `_` |
//! | operators | `+ - * / ^`; −x² is −(x²), a^b^c is a^(b^c), 2^-x is 2^(−x) |
//! | functions | `sin cos tan exp ln sqrt abs sinh cosh tanh sinc`, and `min max` of two numbers |
//! | vectors | `a + b`, `2*a`, `cross(a, b)`, `dot(a, b)`, `norm(a)`; `q[i]` is a component, or `q2` for i = 2 |
//! | sums | `sum(i in 1..3, q[i]^2)` |
//!
//! The logarithm is `ln`; there is no `log`, which means several things. A product needs its `*`.
//! `^` with a constant integer is a product by repeated squaring, `x^0.5` is `sqrt(x)`, any other
//! a^b is e^{b ln a}, for a > 0. A text has at most [`MAX_BYTES`] bytes and is nested at most
//! [`MAX_DEPTH`] deep: more is an error. [`Graph`] lists the identities that are applied.
//!
//! | item | purpose |
//! |---|---|
//! | [`Formula`] | a text, its value and derivatives, its degree, and where it has no value |
//! | [`Names`] | variables and parameters |
//! | [`Graph`], [`parse()`] | expressions of several formulas, derivatives from graph to graph |
//! | [`Tape`] | what evaluates them |
//! | [`Definition`], [`FormulaSystem`] | a Poisson system from texts, for `systems::run_time` |
//! | [`FormulaError`] | what is wrong, with line, column and carets |
//! | [`excerpt`], [`nearest()`] | the same for other texts |

mod damping;
mod error;
mod formula;
mod names;
mod parse;
mod system;
mod words;

pub use expression::{Binary, Graph, Id, Node, Tape, Unary};

pub use damping::FormulaDamping;
pub use error::{FormulaError, excerpt};
pub use formula::Formula;
pub use names::{NameError, Names, nearest};
pub use parse::{MAX_BYTES, MAX_DEPTH, parse};
pub use system::{
    Bath, Coordinate, Definition, DefinitionError, Equation, FormulaProgram, FormulaSystem,
    Structure, Which,
};
