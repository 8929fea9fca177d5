//! **Figures and pages of numerical experiments, for anybody's program.**
//!
//! [`figure`] draws as SVG, [`Document`] makes an HTML page of one file.
//!
//! The figures are written as SVG without a library such as plotters: it rounds coordinates to
//! integers, dashes one by one, and has no indices and exponents in the font of a text. A page of
//! lines, markers and text needs no drawing backend, and the viewer sets the text in its own font.
//!
//! ```
//! use plot::{Document, figure::{Trace, lines}};
//!
//! let times = (0..=200).map(|n| f64::from(n) / 10.0);
//! let points = times.map(|t| (t, (-0.1 * t).exp() * t.cos())).collect();
//! let svg = lines("Damping", "t", "q", &[Trace { name: "q".into(), points }]);
//! assert!(svg.starts_with("<svg") && svg.contains("<polyline"));
//!
//! let mut page = Document::new("my program", "An oscillator");
//! page.section("One path");
//! page.figures([(svg, "The amplitude decays as exp(−t/10).".into())]);
//! assert!(page.html().contains("<figcaption>The amplitude decays"));
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`figure`] | figures as SVG: convergence, evolution, laws, densities, any curves |
//! | [`Series`], [`Kind`], [`series`] | errors, invariants and costs as data of figures |
//! | [`Document`] | HTML pages of one file |
//! | [`provenance`], [`Provenance`] | commit, compiler, processor, command, memory |
//! | [`Label`] | indices and exponents in names of quantities |
//! | [`escape()`] | text made safe for HTML and SVG |

mod document;
mod escape;
pub mod figure;
mod label;
pub mod provenance;
pub mod series;

pub use document::Document;
pub use escape::escape;
pub use label::Label;
pub use provenance::Provenance;
pub use series::{Kind, Series};
