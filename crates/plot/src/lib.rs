//! **Figures and pages of numerical experiments, for anybody's program.**
//!
//! [`figure`] draws any curves as SVG, [`Document`] makes an HTML page of one file, [`files`]
//! writes whole files or none, [`Bars`] shows progress.
//!
//! The figures are written as SVG without a library such as plotters: it rounds coordinates to
//! integers, dashes one by one, and has no indices and exponents in the font of a text. A page of
//! lines, markers and text needs no drawing backend, and the viewer sets the text in its own font.
//!
//! ```
//! use plot::figure::{Curve, Figure, Measured, Plot, Spacing, Style};
//!
//! // Errors against the processor time that they cost.
//! let points = [1.0, 10.0, 100.0].map(|cost| Measured::new(cost, 1.0 / cost));
//! let figure = Figure {
//!     title: "Error against cost".into(),
//!     y_title: "error".into(),
//!     size: (268.0, 214.0),
//!     style: Style::Schemes,
//!     plots: vec![Plot {
//!         x_title: "processor time, s".into(),
//!         spacing: Spacing::Decades,
//!         lines: Vec::new(),
//!         curves: vec![Curve::new("heun", points)],
//!     }],
//! };
//! let svg = figure.svg();
//! assert!(svg.starts_with("<svg") && svg.contains("processor time, s") && svg.contains("heun"));
//! ```
//!
//! | item | job |
//! |---|---|
//! | [`figure`] | figures as SVG: convergence, evolution, error against cost, any curves |
//! | [`Series`], [`Kind`], [`series`] | errors, invariants and costs as data of figures |
//! | [`Document`] | HTML pages of one file |
//! | [`comparison_csv`], [`csv`] | the numbers of a comparison of schemes; fields of any table |
//! | [`files`] | whole files, folders that are checked before the computing |
//! | [`provenance`], [`Provenance`] | commit, compiler, processor, command, memory |
//! | [`Bars`], [`Progress`] | progress on the terminal |
//! | [`Label`] | indices and exponents in names of quantities |
//! | [`escape()`] | text made safe for HTML and SVG |

mod bars;
pub mod csv;
mod document;
mod escape;
pub mod figure;
pub mod files;
mod label;
pub mod provenance;
pub mod series;

pub use bars::{Bars, Progress};
pub use csv::comparison_csv;
pub use document::Document;
pub use escape::escape;
pub use label::Label;
pub use provenance::Provenance;
pub use series::{Kind, Series};
