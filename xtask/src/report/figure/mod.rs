//! The figure of a panel as a stand-alone SVG document, readable at the width of a journal column.

mod axis;
mod canvas;
mod convergence;
mod dash;
mod evolution;
mod frame;
mod growth;
mod legend;
mod look;
mod scripts;
mod slope;
mod ticks;
mod work;

use anyhow::Result;
use verify::results::{Kind, Panel};

pub use convergence::QUANTILE;
pub use growth::{GrowthCurve, growth_figure};
pub use work::{WorkPlot, WorkPoint, work_figure};

/// Draws a panel.
pub fn figure(panel: &Panel) -> Result<String> {
    match panel.kind {
        Kind::Strong | Kind::Weak | Kind::Cost => convergence::convergence(panel),
        Kind::Invariant => evolution::evolution(panel),
    }
}
