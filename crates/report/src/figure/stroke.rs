//! How a line is drawn: colour, width, opacity, and dashes, which plotters does not have.

use plotters::style::RGBColor;

/// A place on the page in CSS pixels, from the upper left corner.
pub type Position = (f64, f64);

/// Colour, width, opacity and continuity of a line.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    /// Colour.
    pub color: RGBColor,
    /// Width in pixels.
    pub width: f64,
    /// 1 is opaque.
    pub opacity: f64,
    /// Whether it is broken into dashes.
    pub dashed: bool,
}

impl Stroke {
    /// An opaque stroke without gaps.
    pub fn new(color: RGBColor, width: f64) -> Self {
        Self { color, width, opacity: 1.0, dashed: false }
    }

    /// The same stroke in dashes.
    pub fn dashed(self) -> Self {
        Self { dashed: true, ..self }
    }

    /// The same stroke, partly transparent.
    pub fn faded(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }
}

/// Length of a dash in pixels.
const DASH: f64 = 4.0;
/// Length of a gap in pixels; round line ends shorten what is seen of it.
const GAP: f64 = 3.2;

/// The dashes of a line through `points`, which bend where the line bends.
pub fn dashes(points: &[Position]) -> Vec<Vec<Position>> {
    let mut dashes = Vec::new();
    let mut dash: Vec<Position> = points.first().copied().into_iter().collect();
    // Whether the pen is down, and how far it goes on before that changes.
    let (mut down, mut left) = (true, DASH);
    for pair in points.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let length = dx.hypot(dy);
        let mut done = 0.0;
        while length - done >= left {
            done += left;
            let at = (from.0 + dx * done / length, from.1 + dy * done / length);
            dash.push(at);
            if down {
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash = vec![at];
            }
            down = !down;
            left = if down { DASH } else { GAP };
        }
        left -= length - done;
        if down {
            dash.push(to);
        }
    }
    if down && dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(points: &[Position]) -> f64 {
        points.windows(2).map(|p| (p[1].0 - p[0].0).hypot(p[1].1 - p[0].1)).sum()
    }

    #[test]
    fn dashes_follow_the_line_round_its_corners() {
        let corner = [(0.0, 0.0), (2.0, 0.0), (2.0, 20.0)];
        let dashes = dashes(&corner);
        assert_eq!(dashes[0], [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)]);
        assert!(dashes.iter().rev().skip(1).all(|dash| (length(dash) - DASH).abs() < 1e-12));
        let gap = (dashes[0][2], dashes[1][0]);
        assert!((length(&[gap.0, gap.1]) - GAP).abs() < 1e-12);
    }

    #[test]
    fn short_and_empty_lines_are_harmless() {
        assert!(dashes(&[]).is_empty());
        assert!(dashes(&[(1.0, 1.0)]).is_empty());
        assert_eq!(dashes(&[(0.0, 0.0), (0.0, 0.0), (1.0, 0.0)]).len(), 1);
    }
}
