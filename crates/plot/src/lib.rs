//! **Figures and pages of numerical experiments, for anybody's program.**
//!
//! [`figure`] draws as SVG, [`Document`] makes an HTML page of one file, [`files`] writes whole
//! files or none.
//!
//! The figures are written as SVG without a library such as plotters: it rounds coordinates to
//! integers, dashes one by one, and has no indices and exponents in the font of a text. A page of
//! lines, markers and text needs no drawing backend, and the viewer sets the text in its own font.
//!
//! | item | job |
//! |---|---|
//! | [`figure`] | figures as SVG: convergence, evolution, error against cost, laws, any curves |
//! | [`Series`], [`Kind`], [`series`] | errors, invariants and costs as data of figures |
//! | [`Document`] | HTML pages of one file |
//! | [`files`] | whole files, folders that are checked before the computing |
//! | [`provenance`], [`Provenance`] | commit, compiler, processor, command, memory |
//! | [`Label`] | indices and exponents in names of quantities |
//! | [`escape()`] | text made safe for HTML and SVG |

mod document;
mod escape;
pub mod figure;
pub mod files;
mod label;
pub mod provenance;
pub mod series;

pub use document::Document;
pub use escape::escape;
pub use label::Label;
pub use provenance::Provenance;
pub use series::{Kind, Series};
