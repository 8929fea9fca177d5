//! Dashed lines of slope 1/2 and 1: which ones belong into a panel, where they lie, and where their
//! names fit.

use anyhow::Result;

use super::canvas::{Align, Canvas, GREY, Position, Stroke};
use super::frame::Frame;
use crate::report::label::Label;

/// The line `constant · τ^order` over the steps measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceSlope {
    /// The slope in logarithmic coordinates.
    pub order: f64,
    /// Value at τ = 1.
    pub constant: f64,
}

/// Errors of one curve with the order it shows.
pub struct Trend {
    /// Observed order, if there is one.
    pub order: Option<f64>,
    /// Pairs (τ, error) that stand out from their noise.
    pub points: Vec<(f64, f64)>,
}

/// The distance of a reference line from the nearest measured error, as a factor.
const CLEARANCE: f64 = 1.8;

/// The reference slopes that belong to the curves: below all of them, and above where a second one
/// is needed.
///
/// Of the two orders 1/2 and 1 each curve asks for the nearer one. If both are asked for, the order
/// of the smaller errors lies below.
pub fn reference_slopes(trends: &[Trend]) -> Vec<ReferenceSlope> {
    let mut wanted: Vec<(f64, f64)> = [0.5, 1.0]
        .into_iter()
        .filter_map(|order| {
            let level = trends
                .iter()
                .filter(|t| t.order.map(nearest_order) == Some(order))
                .filter_map(mean_log_error)
                .reduce(f64::min)?;
            Some((order, level))
        })
        .collect();
    wanted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let points = || trends.iter().flat_map(|t| t.points.iter());
    let line = |order: f64, above: bool| {
        let ratios = points().map(|(tau, error)| error / tau.powf(order));
        let constant = if above {
            ratios.reduce(f64::max)? * CLEARANCE
        } else {
            ratios.reduce(f64::min)? / CLEARANCE
        };
        Some(ReferenceSlope { order, constant })
    };
    wanted.iter().enumerate().filter_map(|(place, (order, _))| line(*order, place > 0)).collect()
}

fn nearest_order(order: f64) -> f64 {
    if order < 0.75 { 0.5 } else { 1.0 }
}

fn mean_log_error(trend: &Trend) -> Option<f64> {
    let n = trend.points.len();
    (n > 0).then(|| trend.points.iter().map(|(_, e)| e.ln()).sum::<f64>() / n as f64)
}

/// Slope of the least-squares line through (ln τ, ln error).
pub fn fitted_order(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let logs = || points.iter().map(|(tau, error)| (tau.ln(), error.ln()));
    let (mean_x, mean_y) = logs().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let (xy, xx) = logs().fold((0.0, 0.0), |(xy, xx), p| {
        let dx = p.0 - mean_x;
        (xy + dx * (p.1 - mean_y), xx + dx * dx)
    });
    (xx > 0.0).then_some(xy / xx).filter(|order| order.is_finite())
}

impl ReferenceSlope {
    /// Error on the line at step τ.
    pub fn at(&self, tau: f64) -> f64 {
        self.constant * tau.powf(self.order)
    }

    /// Its name.
    pub fn label(&self) -> Label {
        Label::words(if self.order == 0.5 { "slope 1/2" } else { "slope 1" })
    }

    /// Draws the line across the frame and its name where it is farthest from `obstacles`.
    ///
    /// Line and name become obstacles themselves.
    pub fn draw(
        &self,
        canvas: &mut Canvas,
        frame: &Frame,
        obstacles: &mut Vec<Position>,
    ) -> Result<()> {
        const SIZE: f64 = 10.0;
        let (first, last) = (frame.x.range.lo, frame.x.range.hi);
        let ends = (frame.place(first, self.at(first)), frame.place(last, self.at(last)));
        let Some((from, to)) = frame.clip(ends.0, ends.1) else {
            return Ok(());
        };
        canvas.polyline(&[from, to], Stroke::new(GREY, 1.0).dashed())?;
        let label = self.label();
        let size = (SIZE * label.width(), SIZE);
        if let Some(centre) = roomiest(frame, (from, to), size, obstacles) {
            canvas.label(&label, centre, SIZE, Align::Middle)?;
            obstacles.extend(along(
                (centre.0 - size.0 / 2.0, centre.1),
                (centre.0 + size.0 / 2.0, centre.1),
            ));
        }
        obstacles.extend(along(from, to));
        Ok(())
    }
}

/// Points a few pixels apart along a segment.
pub fn along(from: Position, to: Position) -> impl Iterator<Item = Position> {
    const STEP: f64 = 3.0;
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let steps = (dx.hypot(dy) / STEP).ceil().clamp(1.0, 1000.0);
    (0..=steps as usize)
        .map(move |n| (from.0 + dx * n as f64 / steps, from.1 + dy * n as f64 / steps))
}

/// Centre of the text box beside a rising line that keeps the largest distance from the obstacles.
fn roomiest(
    frame: &Frame,
    (from, to): (Position, Position),
    (width, height): (f64, f64),
    obstacles: &[Position],
) -> Option<Position> {
    const OFFSET: f64 = 3.0;
    let half = (0.5 * width, 0.5 * height);
    let sides = [1.0, -1.0];
    let candidates = along(from, to).flat_map(|p| {
        sides.map(|side| (p.0 + side * (half.0 + OFFSET), p.1 + side * (half.1 + OFFSET)))
    });
    let inside = |c: &Position| {
        frame.holds((c.0 - half.0 - OFFSET, c.1 - half.1 - OFFSET))
            && frame.holds((c.0 + half.0 + OFFSET, c.1 + half.1 + OFFSET))
    };
    let room = |c: &Position| {
        obstacles
            .iter()
            .map(|o| {
                let (dx, dy) = ((o.0 - c.0).abs() - half.0, (o.1 - c.1).abs() - half.1);
                dx.max(0.0).hypot(dy.max(0.0))
            })
            .fold(f64::INFINITY, f64::min)
    };
    candidates.filter(inside).max_by(|a, b| room(a).total_cmp(&room(b)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trend(order: f64, constant: f64) -> Trend {
        let points: Vec<_> =
            (5..13).map(|k| 2f64.powi(-k)).map(|tau| (tau, constant * tau.powf(order))).collect();
        Trend { order: fitted_order(&points), points }
    }

    #[test]
    fn each_order_is_drawn_once_and_clear_of_the_data() {
        let trends = [trend(1.0, 0.1), trend(0.5, 1.0), trend(0.95, 0.3)];
        let slopes = reference_slopes(&trends);
        assert_eq!(slopes.len(), 2);
        assert_eq!((slopes[0].order, slopes[1].order), (1.0, 0.5));
        for (tau, error) in trends.iter().flat_map(|t| &t.points) {
            assert!(slopes[0].at(*tau) < *error && *error < slopes[1].at(*tau));
        }
    }

    #[test]
    fn one_order_gets_one_line_and_no_data_none() {
        let slopes = reference_slopes(&[trend(0.5, 1.0), trend(0.52, 2.0)]);
        assert_eq!(slopes.len(), 1);
        assert_eq!(slopes[0].order, 0.5);
        assert!(reference_slopes(&[]).is_empty());
    }

    #[test]
    fn the_fit_needs_two_steps() {
        assert_eq!(fitted_order(&[(0.1, 1.0)]), None);
        let order = fitted_order(&[(0.1, 1.0), (0.01, 0.1)]);
        assert!((order.unwrap_or(0.0) - 1.0).abs() < 1e-12);
    }
}
